//! Lines along which points of the tool move: together they are as wide as the tool, to 0.01 mm up to a diameter of 16.
use nalgebra::{Point3, Unit, Vector3};

use super::axis_box::directions_across;
use super::metal::{KnownMetal, PointInMetal};
use crate::machine::{TOUCH_DEPTH, ToolPart};
use gcode_lang::units::Deg;

/// Largest distance between two circles of points inside the tool or on its cone, mm.
const RING_WIDTH: f64 = 1.0;

/// Largest number of such circles.
const MAX_RINGS: u32 = 6;

/// Distance of a circle of points on a cone from the level below which it is widest, mm.
const BELOW_LEVEL: f64 = 2.0 * TOUCH_DEPTH;

/// Returns the offsets from the tool's axis to points of its rim; the chords between them are inside by at most
/// [`TOUCH_DEPTH`], and at radii above 8.3 mm by 0.0012 of the radius. One of them is in the direction of the travel, unless that is along the axis, and two are square to it.
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

/// Returns the lines along which points of a part of the tool move: on its lower end, inside its rim too if it moves along
/// itself, and on its side where it crosses the metal; and the lines up its side at both ends of a travel.
fn lines(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    [from, to]: &[Point3<f64>; 2],
    metal: &KnownMetal,
) -> Vec<[Point3<f64>; 2]> {
    let along = to - from;
    let out = axis.into_inner();
    let top = metal.top_of(part, from, axis).max(metal.top_of(part, to, axis));
    let at_ends = [from, to].into_iter().flat_map(|tip| sides(part, axis, (tip, &along), top));
    let mut lines: Vec<[Point3<f64>; 2]> = at_ends.collect();
    let mut add = |height: f64, radius: f64| {
        let offsets = rim(axis, &along, radius).into_iter().map(|offset| offset + out * height);
        lines.extend(offsets.map(|offset| [from + offset, to + offset]));
    };
    let [low, high] = [part.from, top].map(|height| part.taper.at(height));
    let is_cone = part.taper.slope != 0.0;
    if 0.0 < low {
        add(part.from, low);
    }
    if (along - out * along.dot(&out)).norm() < TOUCH_DEPTH {
        for radius in rings(0.0, low) {
            add(part.from, radius);
        }
        for radius in rings(low, high).filter(|_| is_cone) {
            add((radius - part.taper.radius) / part.taper.slope, radius);
        }
    } else if is_cone {
        let levels = metal.levels(&[*from, *to], axis, high, [part.from, top]);
        for between in levels.windows(2) {
            let [below, above] =
                [between[0], (between[1] - BELOW_LEVEL).max(between[0])].map(|h| part.taper.at(h));
            for radius in rings(below, above).chain([above]).filter(|radius| 0.0 < *radius) {
                add((radius - part.taper.radius) / part.taper.slope, radius);
            }
        }
    } else {
        // The lower end may be below all metal.
        for height in metal.heights(&[*from, *to], axis, low, [part.from, top]) {
            add(height, low);
        }
    }
    lines.push([from, to].map(|tip| tip + out * part.from));
    lines
}

/// Returns the deepest point of a part of the tool on its travel, of those that `cut` finds on a line.
pub(super) fn deepest(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    travel: &[Point3<f64>; 2],
    metal: &KnownMetal,
    cut: impl Fn(&[Point3<f64>; 2]) -> Option<PointInMetal>,
) -> Option<PointInMetal> {
    let found = lines(part, axis, travel, metal).iter().filter_map(&cut).reduce(PointInMetal::deeper)?;
    let along = travel[1] - travel[0];
    if part.taper.slope == 0.0 || along.norm() < TOUCH_DEPTH {
        return Some(found);
    }
    // A cone is deeper up its side than where a circle on it enters the metal.
    let share = (found.point - travel[0]).dot(&along) / along.norm_squared();
    let tip = travel[0] + along * share.clamp(0.0, 1.0);
    let up = sides(part, axis, (&tip, &along), part.to);
    Some(up.iter().filter_map(cut).fold(found, PointInMetal::deeper))
}

/// Returns radii between two, as far apart as circles of points may be.
fn rings(from: f64, to: f64) -> impl Iterator<Item = f64> {
    let count = (((to - from) / RING_WIDTH).ceil() as u32).clamp(1, MAX_RINGS);
    (1..count).map(move |ring| from + (to - from) * f64::from(ring) / f64::from(count))
}

/// Returns the lines up the side of a part of the tool, up to a height, where its tip is; `along` is the direction of a travel.
fn sides(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    (tip, along): (&Point3<f64>, &Vector3<f64>),
    top: f64,
) -> Vec<[Point3<f64>; 2]> {
    if top <= part.from {
        return Vec::new();
    }
    let directions = ring(axis, along, 1.0, rim_count(part.radius()));
    let point = |direction: &Vector3<f64>, h: f64| tip + direction * part.taper.at(h) + axis.into_inner() * h;
    directions.iter().map(|direction| [part.from, top].map(|height| point(direction, height))).collect()
}
