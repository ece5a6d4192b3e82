//! The rotary turns the same way in the job and in the machine file.
use nalgebra::{Unit, Vector3};

use super::{HoleFinding, HoleInspection};
use crate::findings::AXIS_SIGNS;
use crate::machine::{LinkMotion, Machine};
use gcode_lang::diag::Diagnostic;
use gcode_part::Reference;
use gcode_part::Surface;

/// Of an axis that stands more askew than this to the part's nobody can say which way it turns.
const MIN_ALIGNMENT: f64 = 0.5;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut Vec<HoleFinding>) {
    findings.extend(finding(inspection.reference, inspection.machine).map(HoleFinding::of_motion));
}

fn finding(reference: &Reference, machine: &Machine) -> Option<Diagnostic> {
    let rotary = reference.process_limits.rotary?;
    let about = match reference.surface? {
        Surface::Ellipsoid { .. } => Vector3::y_axis(),
        Surface::Cylinder { .. } => Vector3::x_axis(),
    };
    let sign = sign_about(machine, rotary.letter, &about)?;
    let job = f64::from(rotary.sign);
    (sign != job).then(|| {
        let letter = rotary.letter;
        let message =
            format!("{letter} has sign {sign} in the machine file and {job} in the job: the directions are opposite");
        Diagnostic::new(&AXIS_SIGNS, message)
            .note("the results are for the machine file's direction; programs emitted from the job assume the job's")
            .help("rotate the part by hand, observe its direction and correct the wrong sign")
    })
}

/// Which way a positive command turns the part about an axis of its own; `None` where that axis doesn't.
fn sign_about(machine: &Machine, letter: char, own: &Unit<Vector3<f64>>) -> Option<f64> {
    let axis = machine.axes.find(letter as u8)?;
    let link = machine.table.0.iter().find(|link| link.axis == axis)?;
    let LinkMotion::Rotary { about, .. } = &link.motion else { return None };
    let along = machine.part.frame().rotation.inverse_transform_unit_vector(about).dot(own);
    (MIN_ALIGNMENT < along.abs()).then(|| link.sign * along.signum())
}
