//! How far a hole is from its place, as an axis of the machine that stands wrong would make it: what many holes have in
//! common is told once.
use nalgebra::{Point3, Vector3};

use super::Comparison;
use super::position::Deviation;
use crate::holes::DrilledHole;
use crate::machine::Machine;
use gcode_lang::motion::AxisIndex;
use gcode_lang::units::Deg;
use gcode_part::Hole;
use gcode_part::{Pattern, azimuth};

/// A drilled hole leans by less than this where only slides are wrong.
const TILT_TOLERANCE: Deg = Deg(0.01);

/// What an axis of the table that stood wrong leaves unexplained, in mm and as many hundredths of a degree.
const UNEXPLAINED: f64 = 0.02;

/// One wanted hole and the drilled one that was meant for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct HoleDisplacement {
    pub nominal: usize,
    pub actual: usize,
    /// What was drilled less what is wanted, along the slides, across the hole, mm; where a rotary axis explains it, 0.
    pub offset: Vector3<f64>,
    /// The rotary axis that stood wrong, and by how much.
    pub rotation: Option<(AxisIndex, Deg)>,
    /// Whether the pair was matched by nearness; else by its place in its row.
    pub is_matched: bool,
}

impl HoleDisplacement {
    fn of(
        comparison: &Comparison<'_>,
        machine: &Machine,
        wanted: usize,
        found: usize,
        near: bool,
    ) -> Option<Self> {
        let (hole, drilled) = (&comparison.nominal[wanted], &comparison.actual[found]);
        let deviation = Deviation::new(hole, &drilled.bottom(), &drilled.axis)?;
        let plain = deviation.entry - Point3::from(hole.entry);
        let aside = machine.part_frame(&drilled.axis_position).rotation * plain;
        if deviation.tilt < TILT_TOLERANCE {
            return Some(Self {
                nominal: wanted,
                actual: found,
                offset: aside,
                rotation: None,
                is_matched: near,
            });
        }
        let turned =
            machine.table.0.iter().find_map(|link| rotation_error(hole, drilled, machine, link.axis))?;
        Some(Self {
            nominal: wanted,
            actual: found,
            offset: Vector3::zeros(),
            rotation: Some(turned),
            is_matched: near,
        })
    }

    /// The same within what rounding makes of it.
    pub(super) fn is_same_error(&self, other: &Self) -> bool {
        let turned = match (self.rotation, other.rotation) {
            (None, None) => true,
            (Some((axis, by)), Some((other, and))) => axis == other && (by - and).abs().0 < UNEXPLAINED,
            _ => false,
        };
        turned && (self.offset - other.offset).norm() < UNEXPLAINED
    }
}

/// How far an axis of the table stood beyond where this hole belongs, where that explains all of it.
fn rotation_error(
    hole: &Hole,
    drilled: &DrilledHole,
    machine: &Machine,
    axis: AxisIndex,
) -> Option<(AxisIndex, Deg)> {
    let frame = machine.part_frame(&drilled.axis_position);
    let (tip, out) = (frame * drilled.bottom(), frame.rotation * drilled.axis);
    // How the wanted direction goes while the axis turns by a degree, here.
    let turned_by = |by: f64| {
        let mut at = drilled.axis_position;
        at[axis] += by;
        machine.part_frame(&at)
    };
    let wanted = Vector3::from(hole.axis);
    let nominal_direction = frame.rotation * wanted;
    let slope = (turned_by(0.5).rotation * wanted - turned_by(-0.5).rotation * wanted)
        .dot(&(nominal_direction - out.into_inner()));
    if slope == 0.0 {
        return None;
    }
    let angle = Deg::acos(nominal_direction.dot(&out).clamp(-1.0, 1.0)).0.copysign(slope);
    let corrected = turned_by(-angle);
    let deviation = Deviation::new(
        hole,
        &corrected.inverse_transform_point(&tip),
        &corrected.rotation.inverse_transform_unit_vector(&out),
    )?;
    (deviation.zone_diameter() < UNEXPLAINED && deviation.tilt < TILT_TOLERANCE).then_some((axis, Deg(angle)))
}

/// Every wanted hole with the drilled one meant for it, where both are known.
pub(super) fn displacements(comparison: &Comparison<'_>, machine: &Machine) -> Vec<HoleDisplacement> {
    let near = comparison.pairs.iter().map(|pair| (pair.nominal, pair.actual, true));
    let by_rows = comparison.pattern.map(|pattern| pairs_by_row(comparison, pattern)).unwrap_or_default();
    let far = by_rows.into_iter().map(|(wanted, found)| (wanted, found, false));
    let off = |(wanted, found, near)| HoleDisplacement::of(comparison, machine, wanted, found, near);
    near.chain(far).filter_map(off).collect()
}

/// Rows that stand too far off for their holes to be matched: where as many holes too many stand nearest to a row as
/// are missing in it, they are meant for it in their order.
fn pairs_by_row(comparison: &Comparison<'_>, pattern: &Pattern) -> Vec<(usize, usize)> {
    let rows = pattern.rows as usize;
    let mut missing = vec![Vec::new(); rows];
    for wanted in &comparison.missing {
        let hole = &comparison.nominal[*wanted];
        missing[pattern.row_of(&Point3::from(hole.entry))].push((hole.entry[0], *wanted));
    }
    let mut extra = vec![Vec::new(); rows];
    for found in &comparison.extra {
        let hole = &comparison.actual[*found];
        let Some(at) = pattern.crossing(&hole.bottom(), &hole.axis) else { continue };
        if comparison.nominal_on_line_of(*found).is_none() {
            extra[pattern.row_of(&at)].push((at.x, *found));
        }
    }
    let mut pairs = Vec::new();
    for (mut wanted, mut found) in missing.into_iter().zip(extra) {
        if wanted.len() != found.len() || !have_one_azimuth(comparison, pattern, &found) {
            continue;
        }
        wanted.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.extend(wanted.iter().zip(&found).map(|((_, wanted), (_, found))| (*wanted, *found)));
    }
    pairs
}

/// Whether these were drilled at one azimuth.
fn have_one_azimuth(comparison: &Comparison<'_>, pattern: &Pattern, found: &[(f64, usize)]) -> bool {
    let azimuths = found.iter().filter_map(|(_, found)| {
        let hole = &comparison.actual[*found];
        Some(azimuth(&pattern.crossing(&hole.bottom(), &hole.axis)?))
    });
    let mut azimuths = azimuths.peekable();
    let Some(first) = azimuths.peek().copied() else { return false };
    let apart = |other: Deg| ((other - first).0 + 180.0).rem_euclid(360.0) - 180.0;
    azimuths.all(|other| apart(other).abs() < UNEXPLAINED)
}
