//! Feeds that end above the part, over missing holes: one finding with their height.
use super::*;
use crate::findings::{HOLE_EXTRA, HOLE_IN_AIR, HOLE_MISSING};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let Some(surface) = inspection.reference.surface else { return };
    if comparison.missing.is_empty() {
        return;
    }
    let entry = |nominal: &usize| Point3::from(comparison.nominal[*nominal].entry);
    let tree = PointTree::new(comparison.missing.iter().map(entry));
    let mut explained = BTreeSet::new();
    let (mut low, mut high, mut feeds) = (f64::INFINITY, 0.0f64, Vec::new());
    for extra in &comparison.extra {
        let hole = &comparison.actual[*extra];
        let bottom = hole.bottom();
        let Some(top) = surface.exit(&bottom, &hole.axis) else { continue };
        let above = (bottom - top).dot(&hole.axis);
        let aimed = tree.nearest(&top).filter(|(_, off)| !exceeds(*off, comparison.tolerances.position));
        if let (Some((nearest, _)), true) = (aimed, 0.0 < above) {
            explained.extend([Subject::Nominal(comparison.missing[nearest]), Subject::Extra(*extra)]);
            (low, high) = (low.min(above), high.max(above));
            feeds.push(hole);
        }
    }
    let Some(first) = feeds.first() else { return };
    let folded = findings.fold(&[&HOLE_MISSING, &HOLE_EXTRA], |subject| explained.contains(&subject));
    let count = if feeds.len() == 1 { "1 feed" } else { &format!("{} feeds", feeds.len()) };
    let message = format!(
        "{count} along the tool axis ended {} mm above the surface, over missing holes",
        format_range(low, high)
    );
    let finding = Diagnostic::new(&HOLE_IN_AIR, message).help(
        "check the zero along the tool axis (the work offset), the tool length and its offset, and the depth",
    );
    findings.put_first([finish_group_finding(finding, folded, &first.backtrace)]);
}
