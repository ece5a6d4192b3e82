//! Nominal entries outside the stock: stock and reference are in different frames, or one of them is wrong.
use super::*;
use crate::findings::STOCK_MISMATCH;
use gcode_part::Reference;

/// Largest distance of an entry from the stock, mm: coordinates in a list are rounded.
const MAX_GAP: f64 = 0.1;

/// Returns the stock that the reference or the machine file states.
fn stated(reference: &Reference, machine: &Machine) -> Option<Surface> {
    reference.stock.as_ref().or(machine.stock.as_ref()).and_then(|stock| stock.body(None))
}

/// Returns the ids of the blind holes whose bottoms are outside the stock: they break through, or the stock is too thin.
pub(in crate::verify) fn deeper_than_stock<'i>(inspection: &'i HoleInspection<'i>) -> Vec<&'i str> {
    let HoleInspection { comparison, reference, machine, .. } = inspection;
    let Some(stock) = stated(reference, machine) else { return Vec::new() };
    let is_deeper = |hole: &Hole| {
        let bottom = Point3::from(hole.entry) - Vector3::from(hole.axis) * hole.depth;
        !hole.through && exceeds(stock.nearest(&bottom).distance, MAX_GAP)
    };
    let deeper = comparison.nominal.iter().enumerate().filter(|(_, hole)| is_deeper(hole));
    deeper.map(|(index, _)| comparison.id(index)).collect()
}

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, reference, machine, .. } = inspection;
    let Some(stock) = stated(reference, machine) else { return };
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
