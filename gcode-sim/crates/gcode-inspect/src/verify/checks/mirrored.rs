//! A table that turns the other way than the program believes mirrors the pattern, and so does a mirror image left on: said
//! once, instead of hole by hole only.
use nalgebra::Unit;

use super::{Comparison, HoleFinding, HoleInspection};
use crate::findings::{MIRROR_IMAGE, ROTARY_SIGN};
use crate::holes::DrilledHole;
use crate::machine::{LinkMotion, Machine};
use crate::verify::HolePair;
use gcode_lang::diag::Diagnostic;

/// So many of the wanted holes must agree with the mirrored ones.
const MIN_AGREEING_SHARE: f64 = 0.8;

/// What is mirrored, and what of it that explains.
pub(super) struct MirrorImage {
    /// x, y, z of the part, counted from 0.
    axis: usize,
    /// How many holes are in their places then.
    agreeing: usize,
    /// Of each wanted hole and of each drilled one whether it is.
    pub nominal: Vec<bool>,
    pub actual: Vec<bool>,
}

impl MirrorImage {
    pub(super) fn of(comparison: &Comparison<'_>) -> Option<Self> {
        if comparison.missing.is_empty() || comparison.extra.is_empty() {
            return None;
        }
        [2, 0, 1].into_iter().find_map(|axis| {
            let turned: Vec<_> = comparison.actual.iter().map(|found| mirror(found, axis)).collect();
            let compared =
                Comparison::new(comparison.nominal, &turned, comparison.tolerances, comparison.pattern);
            // In their zones: a pattern turned round lies near itself in many ways.
            let agree = count_in_place(&compared);
            if agree <= count_in_place(comparison)
                || (agree as f64) < MIN_AGREEING_SHARE * comparison.nominal.len() as f64
            {
                return None;
            }
            let mut image = Self {
                axis,
                agreeing: agree,
                nominal: vec![false; compared.nominal.len()],
                actual: vec![false; turned.len()],
            };
            for pair in compared.pairs.iter().filter(|pair| is_in_place(&compared, pair)) {
                image.nominal[pair.nominal] = true;
                image.actual[pair.actual] = true;
            }
            Some(image)
        })
    }
}

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let HoleInspection { comparison, machine, .. } = inspection;
    let Some(MirrorImage { axis, agreeing: agree, .. }) = MirrorImage::of(comparison) else { return };
    let name = ["x", "y", "z"][axis];
    let lie = format!(
        "the holes are mirrored: with {name} negated, {agree} of {} are in position",
        comparison.nominal.len()
    );
    let finding = match is_wrong_rotation_sign(comparison, machine, axis) {
        true => Diagnostic::new(
            &ROTARY_SIGN,
            format!("{lie}; the rotary table direction is opposite to the one the program assumes"),
        )
        .help("reverse the table's sign in the machine file, or machine.rotary.sign in the job"),
        false => Diagnostic::new(&MIRROR_IMAGE, format!("{lie}; no rotation of the table has this effect"))
            .help("check for a mirror image (G51.1) left in force, or a wrong sign of a coordinate"),
    };
    let place = comparison.actual[comparison.extra[0]].backtrace.clone();
    objections.push(HoleFinding::unlocated(finding.with_backtrace(place)));
}

/// Whether a table that turns the other way mirrors the part so: it turned between the holes, and about another axis.
fn is_wrong_rotation_sign(comparison: &Comparison<'_>, machine: &Machine, axis: usize) -> bool {
    let part = machine.part.frame();
    machine.table.0.iter().any(|link| {
        let LinkMotion::Rotary { about, .. } = &link.motion else { return false };
        let own = part.rotation.inverse_transform_unit_vector(about);
        let turned = comparison.actual.iter().any(|found| found.axis_position[link.axis] != 0.0);
        turned && own[axis].abs() < std::f64::consts::FRAC_1_SQRT_2
    })
}

fn is_in_place(comparison: &Comparison<'_>, pair: &HolePair) -> bool {
    pair.deviation.zone_diameter() <= comparison.tolerances.position
}

fn count_in_place(comparison: &Comparison<'_>) -> usize {
    comparison.pairs.iter().filter(|pair| is_in_place(comparison, pair)).count()
}

fn mirror(found: &DrilledHole, axis: usize) -> DrilledHole {
    let mut mirrored = found.clone();
    mirrored.entry[axis] = -mirrored.entry[axis];
    let mut out = mirrored.axis.into_inner();
    out[axis] = -out[axis];
    mirrored.axis = Unit::new_unchecked(out);
    mirrored
}
