//! Every wanted hole must be there.
use nalgebra::{Point3, Vector3};

use super::{HoleFinding, HoleInspection};
use crate::findings::HOLE_MISSING;
use gcode_lang::diag::Diagnostic;
use gcode_part::PointTree;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    // A hole drilled twice is known; it isn't the missing one in a wrong place.
    let extra = comparison.extra.iter().copied();
    let extra = extra.filter(|index| comparison.nominal_on_line_of(*index).is_none());
    let extra: Vec<usize> = extra.collect();
    let tree = PointTree::new(extra.iter().map(|index| comparison.actual[*index].bottom()));
    for wanted in &comparison.missing {
        let hole = &comparison.nominal[*wanted];
        let end = Point3::from(hole.entry) - Vector3::from(hole.axis) * hole.depth;
        let message = format!("hole {} is missing", comparison.id(*wanted));
        let finding = Diagnostic::new(&HOLE_MISSING, message);
        let finding = match tree.nearest(&end) {
            Some((near, distance)) => {
                let found = &comparison.actual[extra[near]];
                let off = found.bottom() - end;
                finding
                    .note(format!(
                        "the nearest extra hole ends {distance:.3} mm away; actual − nominal: x {:+.3}, y \
                         {:+.3}, z {:+.3} mm",
                        off.x, off.y, off.z
                    ))
                    .help("if that hole is the intended one, correct its position; otherwise add the missing hole")
                    .with_backtrace(found.backtrace.clone())
            }
            None => finding.help("add the hole to the program"),
        };
        objections.push(HoleFinding::of_nominal(*wanted, finding));
    }
}
