//! A table that turns the other way than the program believes mirrors the pattern, and so does a mirror image left on: said
//! once, instead of hole by hole only.
use nalgebra::Unit;

use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::holes::Found;
use crate::machine::{LinkMotion, Machine};
use crate::verify::Pair;

/// So many of the wanted holes must agree with the mirrored ones.
const MOST: f64 = 0.8;

/// What is mirrored, and what of it that explains.
pub(super) struct Mirrored {
    /// x, y, z of the part, counted from 0.
    axis: usize,
    /// How many holes are in their places then.
    agree: usize,
    /// Of each wanted hole and of each drilled one whether it is.
    pub wanted: Vec<bool>,
    pub found: Vec<bool>,
}

impl Mirrored {
    pub(super) fn of(comparison: &Comparison<'_>) -> Option<Self> {
        if comparison.missing.is_empty() || comparison.extra.is_empty() {
            return None;
        }
        [2, 0, 1].into_iter().find_map(|axis| {
            let turned: Vec<_> = comparison.found.iter().map(|found| mirror(found, axis)).collect();
            let again =
                Comparison::new(comparison.wanted, &turned, comparison.tolerances, comparison.pattern);
            // In their zones: a pattern turned round lies near itself in many ways.
            let agree = in_place(&again);
            if agree <= in_place(comparison) || (agree as f64) < MOST * comparison.wanted.len() as f64 {
                return None;
            }
            let mut explained = Self {
                axis,
                agree,
                wanted: vec![false; again.wanted.len()],
                found: vec![false; turned.len()],
            };
            for pair in again.pairs.iter().filter(|pair| is_in_place(&again, pair)) {
                explained.wanted[pair.wanted] = true;
                explained.found[pair.found] = true;
            }
            Some(explained)
        })
    }
}

pub(in crate::verify) fn check(
    comparison: &Comparison<'_>,
    machine: &Machine,
    objections: &mut Vec<Objection>,
) {
    let Some(Mirrored { axis, agree, .. }) = Mirrored::of(comparison) else { return };
    let name = ["x", "y", "z"][axis];
    let lie = format!(
        "the holes are mirrored: with {name} negated, {agree} of {} are in position",
        comparison.wanted.len()
    );
    let finding = match turns_across(comparison, machine, axis) {
        true => Diagnostic::error(
            "rotary-sign",
            format!("{lie}; the rotary table direction is opposite to the one the program assumes"),
        )
        .help("reverse the table's sign in the machine file, or machine.rotary.sign in the job"),
        false => {
            Diagnostic::error("mirror-image", format!("{lie}; no rotation of the table has this effect"))
                .help("check for a mirror image (G51.1) left in force, or a wrong sign of a coordinate")
        }
    };
    let place = comparison.found[comparison.extra[0]].place.clone();
    objections.push(Objection::whole(finding.at(place)));
}

/// Whether a table that turns the other way mirrors the part so: it turned between the holes, and about another axis.
fn turns_across(comparison: &Comparison<'_>, machine: &Machine, axis: usize) -> bool {
    let part = machine.part.frame();
    machine.table.0.iter().any(|link| {
        let LinkMotion::Turn { about, .. } = &link.motion else { return false };
        let own = part.rotation.inverse_transform_unit_vector(about);
        let turned = comparison.found.iter().any(|found| found.at[link.axis] != 0.0);
        turned && own[axis].abs() < std::f64::consts::FRAC_1_SQRT_2
    })
}

fn is_in_place(comparison: &Comparison<'_>, pair: &Pair) -> bool {
    pair.deviation.phi() <= comparison.tolerances.position
}

fn in_place(comparison: &Comparison<'_>) -> usize {
    comparison.pairs.iter().filter(|pair| is_in_place(comparison, pair)).count()
}

fn mirror(found: &Found, axis: usize) -> Found {
    let mut mirrored = found.clone();
    mirrored.entry[axis] = -mirrored.entry[axis];
    let mut out = mirrored.axis.into_inner();
    out[axis] = -out[axis];
    mirrored.axis = Unit::new_unchecked(out);
    mirrored
}
