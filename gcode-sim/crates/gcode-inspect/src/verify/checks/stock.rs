//! Nominal entries outside the stock: stock and reference are in different frames, or one of them is wrong.
use super::*;
use crate::findings::STOCK_MISMATCH;

/// Largest distance of an entry from the stock, mm: coordinates in a list are rounded.
const MAX_GAP: f64 = 0.1;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, reference, machine, .. } = inspection;
    let Some(stock) = reference.stock.or(machine.stock).and_then(|stock| stock.body(None)) else { return };
    let gap = |hole: &Hole| stock.nearest(&Point3::from(hole.entry)).distance;
    let outside = comparison.nominal.iter().enumerate().filter(|(_, hole)| exceeds(gap(hole), MAX_GAP));
    let outside: Vec<(usize, &Hole)> = outside.collect();
    let Some((first, hole)) = outside.first() else { return };
    let [x, y, z] = hole.entry;
    let others = match outside.len() - 1 {
        0 => String::new(),
        1 => ", and that of another hole outside it too".to_owned(),
        count => format!(", and those of {count} other holes outside it too"),
    };
    let message = format!(
        "the entry of hole {} at x {x:.3} y {y:.3} z {z:.3} lies {:.3} mm outside the stock{others}",
        comparison.id(*first),
        gap(hole)
    );
    findings.add(
        Subject::Whole,
        Diagnostic::new(&STOCK_MISMATCH, message).help(
            "give stock and holes in the same frame, that of the part, and the stock the size of the part",
        ),
    );
}
