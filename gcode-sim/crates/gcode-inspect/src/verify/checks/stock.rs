//! Nominal holes outside the stock: stock and reference are in different frames, or one of them is wrong.
use super::*;
use crate::findings::STOCK_MISMATCH;

/// Largest distance of an entry from the stock, mm: coordinates in a list are rounded.
const MAX_GAP: f64 = 0.1;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, reference, machine, .. } = inspection;
    let Some(stock) = reference.stock.as_ref().or(machine.stock.as_ref()).and_then(|stock| stock.body(None))
    else {
        return;
    };
    let entry = |hole: &Hole| Some(Point3::from(hole.entry));
    let frames =
        "give stock and holes in the same frame, that of the part, and the stock the size of the part";
    if report(comparison, findings, ("entry", frames), &stock, entry) {
        return;
    }
    // The bottom of a through hole is on the far side.
    let bottom = |hole: &Hole| {
        let bottom = Point3::from(hole.entry) - Vector3::from(hole.axis) * hole.depth;
        (!hole.through).then_some(bottom)
    };
    let through =
        "correct the depth or the stock; a hole through the part is `through`, and its depth the thickness";
    report(comparison, findings, ("bottom", through), &stock, bottom);
}

/// Reports the holes of which a point lies outside the stock; returns true if there are any.
fn report(
    comparison: &Comparison<'_>,
    findings: &mut HoleFindings,
    (name, help): (&str, &str),
    stock: &Surface,
    point: impl Fn(&Hole) -> Option<Point3<f64>>,
) -> bool {
    let gap = |hole: &Hole| point(hole).map(|p| (p, stock.nearest(&p).distance));
    let outside = |(index, hole)| gap(hole).filter(|(_, gap)| exceeds(*gap, MAX_GAP)).map(|gap| (index, gap));
    let outside: Vec<_> = comparison.nominal.iter().enumerate().filter_map(outside).collect();
    let Some((first, (p, gap))) = outside.first() else { return false };
    let others = match outside.len() - 1 {
        0 => String::new(),
        1 => ", and that of another hole outside it too".to_owned(),
        count => format!(", and those of {count} other holes outside it too"),
    };
    let message = format!(
        "the {name} of hole {} at x {:.3} y {:.3} z {:.3} lies {gap:.3} mm outside the stock{others}",
        comparison.id(*first),
        p.x,
        p.y,
        p.z
    );
    findings.add(Subject::Whole, Diagnostic::new(&STOCK_MISMATCH, message).help(help));
    true
}
