//! Mirror image of the pattern: the table rotates in the opposite direction, or a mirror image is left in force.
use super::*;
use crate::findings::{MIRROR_IMAGE, ROTARY_SIGN};
use crate::machine::COS_30;

/// Least share of the nominal holes that the mirrored ones must match.
const MIN_AGREEING_SHARE: f64 = 0.8;

/// Least number of holes that only the mirror image has in position: a single one has a wrong sign of its own.
const MIN_EXPLAINED: usize = 2;

/// Cosine of the largest angle between the negated axis and holes that the image turns over: 30°.
const MIN_TURNED_COSINE: f64 = COS_30;

/// A mirror image of the pattern in place of the pattern.
pub(in crate::verify) struct MirrorImage {
    /// Negated axis of the part, 0 to 2 for x, y, z.
    axis: usize,
    /// Number of holes in position after mirroring.
    agreeing: usize,
    /// The nominal and the drilled holes among these.
    pub(super) in_place: BTreeSet<Subject>,
}

impl MirrorImage {
    pub(in crate::verify) fn of(comparison: &Comparison<'_>) -> Option<Self> {
        if comparison.missing.is_empty() || comparison.extra.is_empty() {
            return None;
        }
        let count = |one: &Comparison<'_>| one.pairs.iter().filter(|pair| one.is_in_place(pair)).count();
        let before = count(comparison);
        // A mirror image of a coordinate leaves the direction from which the tool cuts.
        let is_turned_over = |axis: usize| {
            let mut extra = comparison.extra.iter();
            extra.all(|index| MIN_TURNED_COSINE <= comparison.actual[*index].axis[axis].abs())
        };
        [2, 0, 1].into_iter().filter(|axis| !is_turned_over(*axis)).find_map(|axis| {
            let mirrored: Vec<_> = comparison.actual.iter().map(|hole| mirror(hole, axis)).collect();
            let compared =
                Comparison::new(comparison.nominal, &mirrored, comparison.tolerances, comparison.pattern);
            // Only holes in their zones count: a rotated pattern lies near itself in many ways.
            let agreeing = count(&compared);
            if agreeing < before + MIN_EXPLAINED
                || (agreeing as f64) < MIN_AGREEING_SHARE * comparison.nominal.len() as f64
            {
                return None;
            }
            let pairs = compared.pairs.iter().filter(|pair| compared.is_in_place(pair));
            let in_place =
                pairs.flat_map(|pair| [Subject::Nominal(pair.nominal), Subject::Extra(pair.actual)]);
            Some(Self { axis, agreeing, in_place: in_place.collect() })
        })
    }
}

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, .. } = inspection;
    let Some(MirrorImage { axis, agreeing, .. }) = &inspection.mirror_image else { return };
    let fault = format!(
        "the holes are mirrored: with {} negated, {agreeing} of {} are in position",
        ["x", "y", "z"][*axis],
        comparison.nominal.len()
    );
    let finding = match is_wrong_rotation_sign(comparison, machine, *agreeing) {
        true => Diagnostic::new(
            &ROTARY_SIGN,
            format!("{fault}; the rotary table direction is opposite to the one the program assumes"),
        )
        .help(
            "turn the axis by hand: if the table turns as the machine file says, negate the angles of the program, or of the \
             list (90 is towards y); else correct the sign of the table in the machine file, or machine.rotary.sign in the job",
        ),
        false => Diagnostic::new(&MIRROR_IMAGE, format!("{fault}; no rotation of the table has this effect"))
            .help("check for a mirror image (G51.1) left in force, or a wrong sign of a coordinate"),
    };
    let backtrace = comparison.actual[comparison.extra[0]].backtrace.clone();
    findings.add(Subject::Whole, finding.with_backtrace(backtrace));
}

/// Returns true if the opposite direction of a rotary axis of the table puts the holes in position.
fn is_wrong_rotation_sign(comparison: &Comparison<'_>, machine: &Machine, least: usize) -> bool {
    let links = machine.table.0.iter().enumerate();
    links.filter(|(_, link)| matches!(link.motion, LinkMotion::Rotary { .. })).any(|(index, _)| {
        let mut reversed = machine.clone();
        reversed.table.0[index].sign *= -1.0;
        let turned: Vec<_> = comparison
            .actual
            .iter()
            .map(|hole| {
                let at = &hole.axis_position;
                let by = reversed.part_frame(at).inverse() * machine.part_frame(at);
                DrilledHole { entry: by * hole.entry, axis: by.rotation * hole.axis, ..hole.clone() }
            })
            .collect();
        let compared =
            Comparison::new(comparison.nominal, &turned, comparison.tolerances, comparison.pattern);
        least <= compared.pairs.iter().filter(|pair| compared.is_in_place(pair)).count()
    })
}

fn mirror(hole: &DrilledHole, axis: usize) -> DrilledHole {
    let mut mirrored = hole.clone();
    mirrored.entry[axis] = -mirrored.entry[axis];
    let mut out = mirrored.axis.into_inner();
    out[axis] = -out[axis];
    mirrored.axis = Unit::new_unchecked(out);
    mirrored
}
