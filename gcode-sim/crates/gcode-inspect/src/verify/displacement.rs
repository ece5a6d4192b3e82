//! Displacement of each drilled hole as an error of the machine's axes: many holes may share one.
use nalgebra::{Point3, Vector3};

use super::Comparison;
use super::position::Deviation;
use super::rows::full_azimuth;
use crate::flutes::wrap_angle;
use crate::holes::DrilledHole;
use crate::machine::Machine;
use gcode_lang::motion::AxisIndex;
use gcode_lang::units::Deg;
use gcode_part::{Hole, Pattern};

/// Largest tilt of a hole that only errors of the slides displace.
const TILT_TOLERANCE: Deg = Deg(0.01);

/// Largest remainder that an error of a table axis leaves unexplained, mm; also degrees of azimuth.
const UNEXPLAINED: f64 = 0.02;

/// A nominal hole, the drilled one intended for it, and the error between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct HoleDisplacement {
    pub nominal: usize,
    pub actual: usize,
    /// Actual − nominal along the slides, perpendicular to the hole, mm; 0 if a rotary axis explains it.
    pub offset: Vector3<f64>,
    /// The rotary axis that is off, and its error.
    pub rotation: Option<(AxisIndex, Deg)>,
    /// True if the pair was matched by position, false if by its order in the row.
    pub is_matched: bool,
}

impl HoleDisplacement {
    fn of(
        comparison: &Comparison<'_>,
        machine: &Machine,
        (nominal, actual, is_matched): (usize, usize, bool),
    ) -> Option<Self> {
        let (hole, drilled) = (&comparison.nominal[nominal], &comparison.actual[actual]);
        let deviation = Deviation::new(hole, &drilled.bottom(), &drilled.axis)?;
        let (offset, rotation) = if deviation.tilt < TILT_TOLERANCE {
            let frame = machine.part_frame(&drilled.axis_position);
            (frame.rotation * (deviation.entry - Point3::from(hole.entry)), None)
        } else {
            let mut errors =
                machine.table.0.iter().map(|link| rotation_error(hole, drilled, machine, link.axis));
            (Vector3::zeros(), Some(errors.find_map(|error| error)?))
        };
        Some(Self { nominal, actual, offset, rotation, is_matched })
    }

    /// Returns true if two displacements agree within rounding.
    pub(super) fn is_same_error(&self, other: &Self) -> bool {
        let same_rotation = match (self.rotation, other.rotation) {
            (None, None) => true,
            (Some((axis, by)), Some((other, and))) => axis == other && (by - and).abs().0 < UNEXPLAINED,
            _ => false,
        };
        same_rotation && (self.offset - other.offset).norm() < UNEXPLAINED
    }
}

/// Returns the error of a table axis that explains the whole displacement of a hole; `None` if no angle does.
pub(super) fn rotation_error(
    hole: &Hole,
    drilled: &DrilledHole,
    machine: &Machine,
    axis: AxisIndex,
) -> Option<(AxisIndex, Deg)> {
    let frame_at = |by: f64| {
        let mut at = drilled.axis_position;
        at[axis] += by;
        machine.part_frame(&at)
    };
    let frame = frame_at(0.0);
    let (tip, out) = (frame * drilled.bottom(), frame.rotation * drilled.axis);
    let direction = Vector3::from(hole.axis);
    let nominal_direction = frame.rotation * direction;
    // Change of the nominal direction per degree of the axis, along the deviation of the direction.
    let slope = (frame_at(0.5).rotation * direction - frame_at(-0.5).rotation * direction)
        .dot(&(nominal_direction - out.into_inner()));
    if slope == 0.0 {
        return None;
    }
    let angle = Deg::acos(nominal_direction.dot(&out).clamp(-1.0, 1.0)).0.copysign(slope);
    let corrected = frame_at(-angle);
    let deviation = Deviation::new(
        hole,
        &corrected.inverse_transform_point(&tip),
        &corrected.rotation.inverse_transform_unit_vector(&out),
    )?;
    (deviation.zone_diameter() < UNEXPLAINED && deviation.tilt < TILT_TOLERANCE).then_some((axis, Deg(angle)))
}

/// Returns the displacements of all nominal holes whose drilled hole is known.
pub(super) fn displacements(comparison: &Comparison<'_>, machine: &Machine) -> Vec<HoleDisplacement> {
    let near = comparison.pairs.iter().map(|pair| (pair.nominal, pair.actual, true));
    let by_rows = comparison.pattern.map(|pattern| pairs_by_row(comparison, pattern)).unwrap_or_default();
    let far = by_rows.into_iter().map(|(nominal, actual)| (nominal, actual, false));
    near.chain(far).filter_map(|pair| HoleDisplacement::of(comparison, machine, pair)).collect()
}

/// Pairs the missing holes of a row with as many extra holes nearest to that row, in their order along x: the row is
/// too far off for its holes to be matched.
fn pairs_by_row(comparison: &Comparison<'_>, pattern: &Pattern) -> Vec<(usize, usize)> {
    let rows = pattern.rows as usize;
    let mut missing = vec![Vec::new(); rows];
    for nominal in &comparison.missing {
        let entry = Point3::from(comparison.nominal[*nominal].entry);
        missing[pattern.row_of(&entry)].push((entry, *nominal));
    }
    let mut extra = vec![Vec::new(); rows];
    for actual in &comparison.extra {
        if let Some(at) = comparison.crossing(*actual)
            && comparison.nominal_on_line_of(*actual).is_none()
        {
            extra[pattern.row_of(&at)].push((at, *actual));
        }
    }
    let mut pairs = Vec::new();
    for (mut missing, mut extra) in missing.into_iter().zip(extra) {
        if missing.len() == extra.len() && have_one_azimuth(&extra) {
            for row in [&mut missing, &mut extra] {
                row.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
            }
            pairs.extend(missing.iter().zip(&extra).map(|((_, nominal), (_, actual))| (*nominal, *actual)));
        }
    }
    pairs
}

/// Returns true if there are holes, all of one azimuth.
fn have_one_azimuth(holes: &[(Point3<f64>, usize)]) -> bool {
    let Some((first, _)) = holes.first() else { return false };
    let off = |at: &Point3<f64>| wrap_angle((full_azimuth(at) - full_azimuth(first)).0);
    holes.iter().all(|(at, _)| off(at).abs() < UNEXPLAINED)
}
