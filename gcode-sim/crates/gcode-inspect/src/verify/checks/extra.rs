//! Nothing may be drilled that nobody asked for.
use nalgebra::Point3;

use super::{Comparison, HoleFinding, HoleInspection};
use crate::findings::{HOLE_EXTRA, HOLE_TWICE};
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    for index in &comparison.extra {
        let twice = comparison.nominal_on_line_of(*index).is_some();
        let (kind, help) = match twice {
            true => (&HOLE_TWICE, "remove the second call: the same tool drills this hole twice"),
            false => (&HOLE_EXTRA, "remove it from the program, or correct its position"),
        };
        let finding = Diagnostic::new(kind, explain(comparison, *index))
            .help(help)
            .with_backtrace(comparison.actual[*index].backtrace.clone());
        objections.push(HoleFinding::of_extra(*index, finding));
    }
}

/// In one sentence, for the finding and for the verdict.
pub(crate) fn explain(comparison: &Comparison<'_>, extra: usize) -> String {
    let found = &comparison.actual[extra];
    if let Some(wanted) = comparison.nominal_on_line_of(extra) {
        return format!("hole {} is drilled a second time", comparison.id(wanted));
    }
    let Point3 { coords: p } = found.entry;
    format!(
        "extra hole at x {:.3} y {:.3} z {:.3} on the part: the reference has no hole there",
        p.x, p.y, p.z
    )
}
