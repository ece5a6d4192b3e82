//! A table that turns the other way than the program believes mirrors the pattern: said once, instead of hole by
//! hole only.
use nalgebra::Unit;

use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::holes::Found;

/// So many of the wanted holes must agree with the mirrored ones.
const MOST: f64 = 0.8;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    if comparison.missing.is_empty() || comparison.extra.is_empty() {
        return;
    }
    for (axis, name) in [(2, 'z'), (0, 'x'), (1, 'y')] {
        let turned: Vec<_> = comparison.found.iter().map(|found| mirror(found, axis)).collect();
        let again = Comparison::new(comparison.wanted, &turned, comparison.tolerances, comparison.pattern);
        // In their zones: a pattern turned round lies near itself in many ways.
        let agree = in_place(&again);
        if agree <= in_place(comparison) || (agree as f64) < MOST * comparison.wanted.len() as f64 {
            continue;
        }
        let message = format!(
            "the holes lie mirrored: with {name} turned round {agree} of {} would be there; the rotary table turns the \
             other way than the program believes",
            comparison.wanted.len()
        );
        let place = comparison.found[comparison.extra[0]].place.clone();
        let finding = Diagnostic::error("rotary-sign", message)
            .help("turn round the table's sign in the machine file, or machine.rotary.sign in the job")
            .at(place);
        objections.push(Objection::whole(finding));
        return;
    }
}

fn in_place(comparison: &Comparison<'_>) -> usize {
    comparison.pairs.iter().filter(|pair| pair.deviation.phi() <= comparison.tolerances.position).count()
}

fn mirror(found: &Found, axis: usize) -> Found {
    let mut mirrored = found.clone();
    mirrored.entry[axis] = -mirrored.entry[axis];
    let mut out = mirrored.axis.into_inner();
    out[axis] = -out[axis];
    mirrored.axis = Unit::new_unchecked(out);
    mirrored
}
