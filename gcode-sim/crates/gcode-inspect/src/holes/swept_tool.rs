//! Parts of the tool on the paths of its tip: strips that hold the surface of all that a part sweeps.
//!
//! Metal is connected, so that the tool meets it at this surface first. The rim of a part is a polygon with its corners on the
//! circle: its sides are inside by at most 0.01 mm, and at radii above 8.3 mm by 0.0012 of the radius.
use nalgebra::{Point3, Unit, Vector3};

use super::axis_box::directions_across;
use super::metal::{KnownMetal, PointInMetal};
use super::near_metal::{Contact, Judged, NearMetal};
use super::strip::{Line, Strip};
use crate::machine::{TOUCH_DEPTH, ToolPart};
use gcode_lang::units::Deg;
use gcode_part::Taper;

/// Deviation of a direction along the tool, or square to it, over a whole travel, mm.
const SQUARE: f64 = 0.1 * TOUCH_DEPTH;

/// Number of strips across the lower end of a part.
const DISC_STRIPS: i32 = 16;

/// Depth of the middle of a hole's known wall below its outside, mm.
const WALL_MIDDLE: f64 = 0.5;

/// All paths of the tip: straight ones, or those in a prism about the tool.
#[derive(Clone, Copy, Debug)]
pub(super) struct TipPaths {
    start: Point3<f64>,
    travel: Vector3<f64>,
    /// Second side of the lower face, square to the tool; 0 of a line.
    aside: Vector3<f64>,
    /// Height along the tool, mm; 0 of a line.
    rise: f64,
}

impl TipPaths {
    /// Returns one straight path.
    pub(super) fn line([from, to]: &Line) -> Self {
        Self { start: *from, travel: to - from, aside: Vector3::zeros(), rise: 0.0 }
    }

    /// Returns the paths in the box with these sides; `None` if one of several is oblique to the tool.
    pub(super) fn in_box(
        mut start: Point3<f64>,
        sides: &[Vector3<f64>],
        axis: &Unit<Vector3<f64>>,
    ) -> Option<Self> {
        if let [along] = sides {
            return Some(Self::line(&[start, start + along]));
        }
        let (mut rise, mut across) = (0.0, Vec::new());
        for side in sides {
            let height = side.dot(axis);
            let aside = side - axis.into_inner() * height;
            if aside.norm() <= SQUARE {
                start += axis.into_inner() * height.min(0.0);
                rise += height.abs();
            } else if height.abs() <= SQUARE {
                across.push(aside);
            } else {
                return None;
            }
        }
        across.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        match across[..] {
            [] => Some(Self::line(&[start, start + axis.into_inner() * rise])),
            [travel] => Some(Self { start, travel, aside: Vector3::zeros(), rise }),
            [travel, aside] => Some(Self { start, travel, aside, rise }),
            _ => None,
        }
    }

    fn end(&self) -> Point3<f64> {
        self.start + self.travel
    }
}

/// Returns the faces of the box with these sides; `None` if there are more than three.
pub(super) fn faces(start: Point3<f64>, sides: &[Vector3<f64>]) -> Option<Vec<Strip>> {
    let face = |at: Point3<f64>, a: &Vector3<f64>, b: &Vector3<f64>| {
        let (along, across) = if b.norm() < a.norm() { (a, b) } else { (b, a) };
        Strip::between([at, at + along], [at + across, at + across + along])
    };
    match sides {
        [a] => Some(vec![Strip::line([start, start + a])]),
        [a, b] => Some(vec![face(start, a, b)]),
        [a, b, c] => {
            let pairs = [(a, b, c), (b, c, a), (c, a, b)];
            Some(pairs.iter().flat_map(|(a, b, c)| [face(start, a, b), face(start + *c, a, b)]).collect())
        }
        _ => None,
    }
}

/// Returns the offsets from the tool's axis to points of its rim. One of them is in the direction of the travel, unless that is
/// along the axis, and two are square to it.
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

/// Returns the directions from the axis to the outline of a part, each with the shift of its centre.
fn outline(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    paths: &TipPaths,
) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let (none, aside) = (Vector3::zeros(), paths.aside);
    if part.radius() <= 0.0 {
        return if aside == none { vec![(none, none)] } else { vec![(none, none), (none, aside)] };
    }
    let directions = ring(axis, &paths.travel, 1.0, rim_count(part.radius()));
    if aside == none {
        return directions.into_iter().map(|direction| (direction, none)).collect();
    }
    // Round both circles and the lines between them.
    let is_far = |direction: &Vector3<f64>| 0.0 <= direction.dot(&aside);
    let mut all = Vec::new();
    let mut was_far = directions.last().is_some_and(is_far);
    for direction in directions {
        let shift = |is_far: bool| if is_far { aside } else { none };
        let far = is_far(&direction);
        if far != was_far {
            all.push((direction, shift(was_far)));
        }
        all.push((direction, shift(far)));
        was_far = far;
    }
    all
}

/// Returns strips that hold the surface of all that a part of the tool sweeps: those of its lower end, and those from there up to
/// where the metal ends.
fn strips(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    paths: &TipPaths,
    metal: &KnownMetal,
) -> (Vec<Strip>, Vec<Strip>) {
    let out = axis.into_inner();
    let low = part.taper.at(part.from);
    let [start, end] = [paths.start, paths.end()].map(|tip| tip + out * part.from);
    let along = paths.travel.dot(&out);
    let lower = if along < 0.0 { end } else { start };
    let is_across = TOUCH_DEPTH < (paths.travel - out * along).norm();
    let length = match is_across {
        _ if metal.is_endless(part) => f64::INFINITY,
        // The height of a cone is that of its place at the lower end; `risen` is the rest.
        true if part.taper.slope != 0.0 => part.to - part.from,
        true => part.to - part.from + paths.rise,
        // Along its axis a part sweeps no more than its place at the lower end, but for a cylinder that is shorter than the way.
        false => (part.to - part.from).max(if part.taper.slope == 0.0 { along.abs() } else { 0.0 }),
    };
    let outline = outline(part, axis, paths);
    let line = |(direction, shift): &(Vector3<f64>, Vector3<f64>)| {
        [start, end].map(|base| base + direction * low + shift)
    };
    let up = |(direction, _): &(Vector3<f64>, Vector3<f64>)| direction * part.taper.slope + out;
    let (mut strips, mut flanks): (Vec<Strip>, Vec<Strip>) = (Vec::new(), Vec::new());
    if is_across {
        let rim: Vec<Line> = outline.iter().map(line).collect();
        strips.extend(between(&rim, 0.0 < low));
        for (line, up) in rim.iter().zip(outline.iter().map(up)) {
            let Some((shares, heights)) = metal.removed.above_line(line, &up) else { continue };
            let below = shares.map(|share| line[0] + (line[1] - line[0]) * share);
            let top = [0, 1].map(|end| below[end] + up * length.min(heights[end]));
            flanks.push(Strip::between(below, top));
        }
    } else {
        let side = |at: &(Vector3<f64>, Vector3<f64>)| {
            let (base, up) = (lower + at.0 * low, up(at));
            [base, base + up * length.min(metal.removed.height_of_metal(&base, &up))]
        };
        strips.extend(between(&outline.iter().map(side).collect::<Vec<_>>(), true));
    }
    if 0.0 < low && (along < -TOUCH_DEPTH || !is_across && along <= 0.0) {
        strips.extend(disc(&end, axis, low));
    }
    (strips, flanks)
}

/// Returns the strips between successive lines, and between the last and the first of a ring.
fn between(lines: &[Line], is_ring: bool) -> Vec<Strip> {
    match lines {
        [one] => vec![Strip::line(*one)],
        _ => {
            let count = if is_ring && 2 < lines.len() { lines.len() } else { lines.len().saturating_sub(1) };
            let next = lines.iter().cycle().skip(1);
            lines.iter().zip(next).take(count).map(|(one, other)| Strip::between(*one, *other)).collect()
        }
    }
}

/// Returns strips that fill a disc.
fn disc(centre: &Point3<f64>, axis: &Unit<Vector3<f64>>, radius: f64) -> impl Iterator<Item = Strip> {
    let [u, v] = directions_across(axis).map(|direction| direction * radius);
    let centre = *centre;
    (-DISC_STRIPS / 2..DISC_STRIPS / 2).map(move |index| {
        let sides = [index, index + 1].map(|side| f64::from(2 * side) / f64::from(DISC_STRIPS));
        let width = sides.map(|side| libm::sqrt(1.0 - side * side)).into_iter().fold(1.0, f64::min);
        let [one, other] = sides.map(|side| [-width, width].map(|along| centre + u * along + v * side));
        Strip::between(one, other)
    })
}

/// Finds the metal that a part of the tool meets on the paths of its tip.
pub(super) fn contact(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    paths: &TipPaths,
    metal: &KnownMetal,
    judged: Judged<'_>,
) -> Contact {
    match contact_at_surface(part, axis, paths, metal, judged) {
        Contact::Clear => {
            let others = inside_walls(part, axis, paths, metal).into_iter().chain(risen(part, paths));
            let mut contacts = others.map(|other| contact_at_surface(&other, axis, paths, metal, judged));
            contacts.find(|contact| !matches!(contact, Contact::Clear)).unwrap_or(Contact::Clear)
        }
        found => found,
    }
}

/// Returns the widest circle of a cone, which sweeps a cylinder where the tip rises.
fn risen(part: &ToolPart, paths: &TipPaths) -> Option<ToolPart> {
    let Taper { slope, .. } = part.taper;
    let height = if 0.0 < slope { part.to } else { part.from };
    let circle =
        ToolPart { from: height, to: height, taper: Taper::cylinder(part.taper.at(height)), ..*part };
    (slope != 0.0 && 0.0 < paths.rise).then_some(circle)
}

/// Returns the cylinders inside a part that end in the walls of the holes which it covers whole: without a body the metal ends
/// at their outside.
fn inside_walls(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    paths: &TipPaths,
    metal: &KnownMetal,
) -> Vec<ToolPart> {
    let mut inner = Vec::new();
    if metal.body.is_some() || part.taper.slope != 0.0 {
        return inner;
    }
    let (radius, up) = (part.radius(), axis.into_inner() * part.from);
    let (start, end) = (paths.start + up, paths.end() + up);
    let margin = Vector3::repeat(radius);
    metal.around(&[start.inf(&end) - margin, start.sup(&end) + margin], &mut |collar| {
        let own = collar.from_axis(&end) + collar.rod.radius - WALL_MIDDLE;
        if collar.is_parallel(axis) && own + WALL_MIDDLE <= radius + TOUCH_DEPTH {
            inner.push(ToolPart { taper: Taper::cylinder(own), ..*part });
        }
    });
    inner.sort_by(|a, b| a.taper.radius.total_cmp(&b.taper.radius));
    inner.dedup_by(|a, b| (a.taper.radius - b.taper.radius).abs() < TOUCH_DEPTH);
    inner
}

/// Returns true if the outline of a part meets metal at one of its corners.
pub(super) fn is_at_outline(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    travel: &Line,
    metal: &KnownMetal,
    judged: Judged<'_>,
) -> bool {
    let (strips, flanks) = strips(part, axis, &TipPaths::line(travel), metal);
    let near = NearMetal::of_strips(metal, strips.iter().chain(&flanks), judged);
    let edges = strips.iter().chain(&flanks).flat_map(|strip| &strip.edges);
    edges.into_iter().any(|edge| near.on_line(edge).is_some())
}

/// Finds the metal that the surface of a part meets.
fn contact_at_surface(
    part: &ToolPart,
    axis: &Unit<Vector3<f64>>,
    paths: &TipPaths,
    metal: &KnownMetal,
    judged: Judged<'_>,
) -> Contact {
    let (mut strips, flanks) = strips(part, axis, paths, metal);
    let near = NearMetal::of_strips(metal, strips.iter().chain(&flanks), judged);
    let is_on_first = part.taper.slope == 0.0 && near.is_open_along(axis);
    strips.extend(flanks.into_iter().map(|flank| Strip { is_on_first, ..flank }));
    let contact = near.contact(&strips);
    let Contact::Metal(found) = contact else { return contact };
    if part.taper.slope == 0.0 || paths.travel.norm() < TOUCH_DEPTH {
        return contact;
    }
    // A cone is deeper up its side than where a circle on it enters the metal.
    let share = (found.point - paths.start).dot(&paths.travel) / paths.travel.norm_squared();
    let tip = paths.start + paths.travel * share.clamp(0.0, 1.0);
    let point = |direction: &Vector3<f64>, h: f64| tip + direction * part.taper.at(h) + axis.into_inner() * h;
    let sides = ring(axis, &paths.travel, 1.0, rim_count(part.radius())).into_iter();
    let sides = sides.map(|direction| [part.from, part.to].map(|height| point(&direction, height)));
    Contact::Metal(sides.filter_map(|side| near.on_line(&side)).fold(found, PointInMetal::deeper))
}
