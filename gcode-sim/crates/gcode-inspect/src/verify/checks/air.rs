//! Feeds that end above the part make no hole in it: said once of all that point at a hole that is missing, with how far
//! above.
use nalgebra::Point3;

use super::{HoleFinding, HoleInspection};
use crate::findings::{HOLE_EXTRA, HOLE_IN_AIR, HOLE_MISSING};
use crate::verify::hole_finding::{fold, folded_note, locate_at_call};
use gcode_lang::diag::Diagnostic;
use gcode_part::PointTree;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let Some(surface) = inspection.reference.surface else { return };
    if comparison.missing.is_empty() {
        return;
    }
    let entry = |wanted: &usize| Point3::from(comparison.nominal[*wanted].entry);
    let tree = PointTree::new(comparison.missing.iter().map(entry));
    let mut wanted = vec![false; comparison.nominal.len()];
    let mut drilled = vec![false; comparison.actual.len()];
    let (mut low, mut high, mut first) = (f64::INFINITY, 0.0f64, None);
    for extra in &comparison.extra {
        let hole = &comparison.actual[*extra];
        let bottom = hole.bottom();
        let Some(top) = surface.exit(&bottom, &hole.axis) else { continue };
        let above = (bottom - top).dot(&hole.axis);
        let aimed = tree.nearest(&top).filter(|(_, off)| *off <= comparison.tolerances.position);
        if let (Some((nearest, _)), true) = (aimed, 0.0 < above) {
            wanted[comparison.missing[nearest]] = true;
            drilled[*extra] = true;
            (low, high) = (low.min(above), high.max(above));
            first = first.or(Some(*extra));
        }
    }
    let Some(first) = first else { return };
    let folded = fold(objections, &[&HOLE_MISSING, &HOLE_EXTRA], |objection| {
        objection.nominal.is_some_and(|index| wanted[index])
            || objection.extra.is_some_and(|index| drilled[index])
    });
    let count = drilled.iter().filter(|is| **is).count();
    let feeds = if count == 1 { "1 feed".to_owned() } else { format!("{count} feeds") };
    let far = match high - low < 0.001 {
        true => format!("{high:.3} mm"),
        false => format!("{low:.3} to {high:.3} mm"),
    };
    let message = format!("{feeds} along the tool axis ended {far} above the surface, over missing holes");
    let mut finding = Diagnostic::new(&HOLE_IN_AIR, message).help(
        "check the zero along the tool axis (the work offset), the tool length and its offset, and the depth",
    );
    finding.notes.extend(folded_note(folded));
    objections
        .insert(0, HoleFinding::unlocated(locate_at_call(finding, &comparison.actual[first].backtrace)));
}
