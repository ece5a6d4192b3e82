//! Lines along which points of the tool move: together they are as wide as the tool, to 0.01 mm.
use nalgebra::{Point3, Unit, Vector3};

use super::axis_box::directions_across;
use super::metal::KnownMetal;
use crate::machine::{TOUCH_DEPTH, ToolCylinder};
use gcode_lang::units::Deg;

/// Largest distance between two circles of points inside the tool, mm.
const RING_WIDTH: f64 = 1.0;

/// Largest number of such circles.
const MAX_RINGS: u32 = 6;

/// Returns the offsets from the tool's axis to points of its rim; the chords between them are inside by at most
/// [`TOUCH_DEPTH`]. Two of them are square to the travel.
pub(super) fn rim(axis: &Unit<Vector3<f64>>, along: &Vector3<f64>, radius: f64) -> Vec<Vector3<f64>> {
    ring(axis, along, radius, rim_count(radius))
}

/// Returns the number of points of a rim: a multiple of 4.
fn rim_count(radius: f64) -> u32 {
    let half = Deg::acos((1.0 - TOUCH_DEPTH / radius.max(TOUCH_DEPTH)).max(0.0));
    4 * ((45.0 / half.0).ceil() as u32).clamp(2, 16)
}

/// Returns the offsets from an axis to points round it; one is in the direction of `along`, unless that is along the axis.
pub(crate) fn ring(
    axis: &Unit<Vector3<f64>>,
    along: &Vector3<f64>,
    radius: f64,
    count: u32,
) -> Vec<Vector3<f64>> {
    let across = (along - axis.into_inner() * along.dot(axis)).try_normalize(1e-9);
    let [u, v] = match across {
        Some(across) => [across, axis.cross(&across)],
        None => directions_across(axis),
    };
    let point = |step: u32| {
        let angle = Deg(360.0 / f64::from(count) * f64::from(step));
        u * (radius * angle.cos()) + v * (radius * angle.sin())
    };
    (0..count).map(point).collect()
}

/// Returns the lines of the lower end of a part of the tool, those inside its rim included if it moves along itself, those
/// of its side where it crosses the metal, and the lines up its side at both ends of a travel.
pub(super) fn lines(
    part: &ToolCylinder,
    axis: &Unit<Vector3<f64>>,
    [from, to]: &[Point3<f64>; 2],
    metal: &KnownMetal,
) -> Vec<[Point3<f64>; 2]> {
    let along = to - from;
    let out = axis.into_inner();
    let top = metal.top_of(part, from, axis).max(metal.top_of(part, to, axis));
    let mut offsets = rim(axis, &along, part.radius);
    let up =
        |tip: &Point3<f64>, offset: &Vector3<f64>| [tip + offset + out * part.from, tip + offset + out * top];
    let mut lines = Vec::new();
    if part.from < top {
        lines.extend(offsets.iter().flat_map(|offset| [up(from, offset), up(to, offset)]));
    }
    let at_height =
        |height: f64| move |offset: &Vector3<f64>| [from + offset + out * height, to + offset + out * height];
    let is_along_itself = (along - out * along.dot(&out)).norm() < TOUCH_DEPTH;
    if is_along_itself {
        let count = ((part.radius / RING_WIDTH).ceil() as u32).clamp(1, MAX_RINGS);
        for inner in 1..count {
            let radius = part.radius * f64::from(inner) / f64::from(count);
            offsets.extend(ring(axis, &along, radius, rim_count(radius)));
        }
    } else {
        // The lower end may be below all metal.
        for height in metal.heights(&[*from, *to], axis, part.radius, [part.from, top]) {
            lines.extend(offsets.iter().map(at_height(height)));
        }
    }
    offsets.push(Vector3::zeros());
    lines.extend(offsets.iter().map(at_height(part.from)));
    lines
}
