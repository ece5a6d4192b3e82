//! A move as drawings show it: its kind, its points on the part, and whether its ends have a place there.
use crate::holes::unknown_axes::without_assumed;
use crate::machine::{AxisMotion, Machine, Pose, Setup};
use gcode_lang::motion::{MAX_AXES, PlanarArc, UnknownAxes};

/// Kind of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathKind {
    /// Rapid move.
    Rapid,
    /// Feed or arc.
    Feed,
    /// Probing move, G31.
    Probe,
}

/// Calls `each` with poses of the tool on the part along a motion, from start to end; of a grinder with the points of the
/// wheel's contact.
pub fn for_each_drawn_pose(
    machine: &Machine,
    setup: &Setup,
    travel: &AxisMotion<'_>,
    tolerance: f64,
    mut each: impl FnMut(Pose),
) {
    let Some(wheel) = &machine.wheel else {
        return machine.for_each_pose(travel, setup, tolerance, each);
    };
    let rotary = (0..MAX_AXES).filter(|axis| machine.axes.is_rotary(*axis));
    let turned: f64 = rotary.map(|axis| (travel.to[axis] - travel.from[axis]).abs()).sum();
    let sweep = travel.arc.map_or(0.0, |arc| arc.sweep.0.abs());
    // A chord of 3° is 1.4 µm off a circle of 4 mm, a burr's.
    let chords = ((turned + sweep) / 3.0).ceil().clamp(1.0, 1000.0) as u32;
    for part in 0..=chords {
        let tip = machine.contact(wheel, &travel.position(f64::from(part) / f64::from(chords)));
        each(Pose { tip, axis: None });
    }
}

/// Returns the axes that a motion moves, as bits.
pub fn moved_axes(travel: &AxisMotion<'_>) -> u8 {
    let is_moved = |axis: &usize| {
        travel.from[*axis] != travel.to[*axis] || travel.arc.is_some_and(|arc| is_in_plane(arc, *axis))
    };
    (0..MAX_AXES).filter(is_moved).fold(0, |axes, axis| axes | 1u8 << axis)
}

/// Returns true if both ends of a move are known on the part. An axis that moves has to be known. An axis that stands counts only in
/// a rapid, and only if G28, G30, G53 or G92 put it there; a feed, and an axis never commanded, are drawn at the supposed position.
pub fn is_placed(machine: &Machine, unknown: UnknownAxes, kind: PathKind, moved: u8) -> bool {
    let unknown = without_assumed(unknown.only(machine.used_axes()), machine);
    let elsewhere = if kind == PathKind::Rapid { unknown.at_machine_position | unknown.shifted } else { 0 };
    unknown.all() & moved | elsewhere == 0
}

/// Returns true if an axis is one of the plane of an arc.
pub(crate) fn is_in_plane(arc: &PlanarArc, axis: usize) -> bool {
    arc.plane.0 == axis || arc.plane.1 == axis
}
