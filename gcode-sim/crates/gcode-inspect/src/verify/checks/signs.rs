//! Direction of the rotary table: the same in the job and in the machine file.
use super::*;
use crate::findings::AXIS_SIGNS;
use gcode_part::Reference;

/// Least cosine between the table's axis and the part's: beyond it the direction is undefined.
const MIN_ALIGNMENT: f64 = 0.5;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    if let Some(finding) = finding(inspection.reference, inspection.machine) {
        findings.add(Subject::Motion, finding);
    }
}

fn finding(reference: &Reference, machine: &Machine) -> Option<Diagnostic> {
    let rotary = reference.process_limits.rotary?;
    let about = match reference.surface? {
        Surface::Ellipsoid { .. } => Vector3::y_axis(),
        Surface::Cylinder { .. } => Vector3::x_axis(),
        Surface::Rod(rod) => rod.axis,
        Surface::Block { .. } => return None,
    };
    let (letter, job) = (rotary.letter, f64::from(rotary.sign));
    let sign = sign_about(machine, letter, &about).filter(|sign| *sign != job)?;
    let message = format!(
        "{letter} has sign {sign} in the machine file and {job} in the job: the directions are opposite"
    );
    let finding = Diagnostic::new(&AXIS_SIGNS, message).note(
        "the results are for the machine file's direction; programs emitted from the job assume the job's",
    );
    Some(finding.help("rotate the part by hand, observe its direction and correct the wrong sign"))
}

/// Returns the direction in which a positive command rotates the part about its axis `own`; `None` if it does not.
fn sign_about(machine: &Machine, letter: char, own: &Unit<Vector3<f64>>) -> Option<f64> {
    let axis = machine.axes.find(letter as u8)?;
    let link = machine.table.0.iter().find(|link| link.axis == axis)?;
    let LinkMotion::Rotary { about, .. } = &link.motion else { return None };
    let along = machine.part.frame().rotation.inverse_transform_unit_vector(about).dot(own);
    (MIN_ALIGNMENT < along.abs()).then(|| link.sign * along.signum())
}
