//! Metal round the holes of a list: each nominal entry lies on the surface, so the material below it is known near its
//! hole.
use std::sync::Arc;

use nalgebra::{Point3, Unit, Vector3};

use super::hole::Hole;
use super::point_tree::PointTree;
use super::solid::Rod;
use super::surface::Surface;

/// Thickness of the wall round a hole that is known to be metal, mm.
const WALL: f64 = 1.0;

/// Cosine of the largest angle between axes that count as parallel: 5°.
pub const PARALLEL_COSINE: f64 = 0.996_194_698_091_745_5;

/// What is known to be metal before a program runs.
#[derive(Clone, Debug, Default)]
pub struct Metal {
    /// Stock, or the surface of the part.
    pub body: Option<Surface>,
    /// Metal round the nominal holes; `None` without a reference.
    pub entries: Option<Arc<EntryPlanes>>,
}

impl From<Option<Surface>> for Metal {
    fn from(body: Option<Surface>) -> Self {
        Self { body, entries: None }
    }
}

/// Metal round the holes of a list.
#[derive(Debug)]
pub struct EntryPlanes {
    collars: Vec<Collar>,
    ids: Vec<String>,
    /// Middles of the collars.
    middles: PointTree,
    /// Largest distance of a collar's point from its middle.
    reach: f64,
    /// The same along each axis.
    extent: Vector3<f64>,
    /// Direction of all axes if they agree, and the height of the highest entry along it.
    top: Option<(Unit<Vector3<f64>>, f64)>,
}

/// Metal round one hole: a cylinder from the plane of the nominal entry to the bottom, with the hole in it.
#[derive(Clone, Copy, Debug)]
pub struct Collar {
    /// The cylinder, its base at the bottom of the hole.
    pub rod: Rod,
    /// Radius inside which the metal belongs to the hole, mm.
    pub hole_radius: f64,
    /// The reference states the hole's diameter.
    pub has_diameter: bool,
}

impl EntryPlanes {
    /// Returns the metal round these holes.
    pub fn of(holes: &[Hole]) -> Self {
        let collars: Vec<Collar> = holes.iter().map(Collar::of).collect();
        let middle =
            |collar: &Collar| collar.rod.base + collar.rod.axis.into_inner() * (collar.rod.length / 2.0);
        let reach = |collar: &Collar| libm::hypot(collar.rod.length / 2.0, collar.rod.radius);
        Self {
            middles: PointTree::new(collars.iter().map(middle)),
            reach: collars.iter().map(reach).fold(0.0, f64::max),
            extent: collars.iter().map(|collar| extent(&collar.rod)).fold(Vector3::zeros(), |a, b| a.sup(&b)),
            top: top(&collars),
            ids: holes.iter().map(|hole| hole.id.clone().unwrap_or_default()).collect(),
            collars,
        }
    }

    /// Returns the number of holes.
    pub fn len(&self) -> usize {
        self.collars.len()
    }

    /// Returns true without a hole.
    pub fn is_empty(&self) -> bool {
        self.collars.is_empty()
    }

    /// Returns the metal round a hole.
    pub fn collar(&self, index: usize) -> &Collar {
        &self.collars[index]
    }

    /// Returns the id of a hole.
    pub fn id(&self, index: usize) -> &str {
        &self.ids[index]
    }

    /// Calls `each` with the holes whose metal may reach into the box from `low` to `high`.
    pub fn near(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        if !self.is_above_all(low, high) {
            self.around(low, high, each);
        }
    }

    /// Returns true if the box from `low` to `high` is above every entry, where all holes have one direction.
    pub fn is_above_all(&self, low: &Point3<f64>, high: &Point3<f64>) -> bool {
        self.top.is_some_and(|(out, top)| {
            top < (0..3).map(|i| (out[i] * low[i]).min(out[i] * high[i])).sum::<f64>()
        })
    }

    /// Returns a lower bound of the distance from the metal round any hole, mm.
    pub fn nearest_metal(&self, p: &Point3<f64>) -> f64 {
        self.middles.nearest(p).map_or(f64::INFINITY, |(_, distance)| distance - self.reach)
    }

    /// Calls `each` with the holes whose metal, or the space above it, may reach into the box from `low` to `high`.
    pub fn around(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        self.middles.in_box(&(low - self.extent), &(high + self.extent), each);
    }
}

/// Returns the largest distance of a rod's point from its middle along each axis.
fn extent(rod: &Rod) -> Vector3<f64> {
    rod.axis.map(|along| along.abs() * rod.length / 2.0 + rod.radius * (1.0 - along * along).max(0.0).sqrt())
}

/// Returns the direction of all axes if they agree, and the height of the highest entry along it.
fn top(collars: &[Collar]) -> Option<(Unit<Vector3<f64>>, f64)> {
    let out = collars.first()?.rod.axis;
    let agree = collars.iter().all(|collar| (collar.rod.axis.into_inner() - out.into_inner()).amax() < 1e-9);
    let height = |collar: &Collar| collar.rod.base.coords.dot(&out) + collar.rod.length;
    agree.then(|| (out, collars.iter().map(height).fold(f64::NEG_INFINITY, f64::max)))
}

impl Collar {
    fn of(hole: &Hole) -> Self {
        let axis = Unit::new_normalize(Vector3::from(hole.axis));
        let base = Point3::from(hole.entry) - axis.into_inner() * hole.depth;
        let radius = hole.widest_diameter().map(|diameter| diameter / 2.0);
        Self {
            rod: Rod { base, axis, length: hole.depth, radius: radius.unwrap_or(0.0) + WALL },
            hole_radius: radius.unwrap_or(WALL),
            has_diameter: radius.is_some(),
        }
    }

    /// Returns the depth of a point below the entry plane, mm.
    pub fn depth(&self, p: &Point3<f64>) -> f64 {
        self.rod.length - (p - self.rod.base).dot(&self.rod.axis)
    }

    /// Returns the distance of a point from the axis, mm.
    pub fn from_axis(&self, p: &Point3<f64>) -> f64 {
        let to = p - self.rod.base;
        (to - self.rod.axis.into_inner() * to.dot(&self.rod.axis)).norm()
    }

    /// Returns true if a point is in the collar, deeper than `skin` below the entry plane.
    pub fn contains(&self, p: &Point3<f64>, skin: f64) -> bool {
        let depth = self.depth(p);
        skin < depth && depth <= self.rod.length && self.from_axis(p) <= self.rod.radius
    }

    /// Returns true if a straight travel is parallel to the hole.
    pub fn is_parallel(&self, along: &Vector3<f64>) -> bool {
        PARALLEL_COSINE * along.norm() <= along.dot(&self.rod.axis).abs()
    }

    /// Returns the ends of the piece of a straight travel that is in the collar, deeper than `skin` below the entry
    /// plane.
    pub fn piece(&self, from: &Point3<f64>, to: &Point3<f64>, skin: f64) -> Option<[Point3<f64>; 2]> {
        let along = to - from;
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        // Between the plane at the depth of `skin` and the bottom.
        let (start, gain) = (self.depth(from), -along.dot(&self.rod.axis));
        if gain.abs() < 1e-12 {
            if start <= skin || self.rod.length < start {
                return None;
            }
        } else {
            let (a, b) = ((skin - start) / gain, (self.rod.length - start) / gain);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
        // Inside the mantle: a·t² + 2·b·t + c ≤ 0.
        let square = |v: Vector3<f64>| v - self.rod.axis.into_inner() * v.dot(&self.rod.axis);
        let (away, across) = (square(from - self.rod.base), square(along));
        let (a, b) = (across.norm_squared(), away.dot(&across));
        let c = away.norm_squared() - self.rod.radius * self.rod.radius;
        if a < 1e-18 {
            if c > 0.0 {
                return None;
            }
        } else {
            let root = b * b - a * c;
            if root < 0.0 {
                return None;
            }
            let root = root.sqrt();
            (first, last) = (first.max((-b - root) / a), last.min((-b + root) / a));
        }
        (first < last).then(|| [from + along * first, from + along * last])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hole(entry: [f64; 3], axis: [f64; 3], diameter: Option<f64>) -> Hole {
        Hole { entry, axis, depth: 15.0, diameter, ..Hole::default() }
    }

    fn piece(hole: &Hole, from: [f64; 3], to: [f64; 3]) -> Option<[[f64; 3]; 2]> {
        let piece = Collar::of(hole).piece(&from.into(), &to.into(), 0.01)?;
        Some(piece.map(|p| [p.x, p.y, p.z].map(|v| (v * 1e6).round() / 1e6 + 0.0)))
    }

    /// Φ6 and 15 deep at x 10: metal to radius 4, z −15 to 0.
    #[test]
    fn a_travel_is_clipped_to_the_metal_round_a_hole() {
        let up = hole([10.0, 0.0, 0.0], [0.0, 0.0, 1.0], Some(6.0));
        let across = piece(&up, [0.0, 0.0, -1.0], [60.0, 0.0, -1.0]);
        assert_eq!(across, Some([[6.0, 0.0, -1.0], [14.0, 0.0, -1.0]]));
        assert_eq!(piece(&up, [0.0, 0.0, 0.0], [60.0, 0.0, 0.0]), None, "on the surface");
        assert_eq!(piece(&up, [0.0, 4.001, -1.0], [60.0, 4.001, -1.0]), None, "beside it");
        assert_eq!(piece(&up, [0.0, 0.0, -16.0], [60.0, 0.0, -16.0]), None, "below it");
        let down = piece(&up, [10.0, 3.5, 2.0], [10.0, 3.5, -8.0]);
        assert_eq!(down, Some([[10.0, 3.5, -0.01], [10.0, 3.5, -8.0]]));
        // Half way down at 45° the travel is at radius 4: x 14, z −5.
        let slanting = piece(&up, [9.0, 0.0, 0.0], [29.0, 0.0, -20.0]);
        assert_eq!(slanting, Some([[9.01, 0.0, -0.01], [14.0, 0.0, -5.0]]));
        assert_eq!(
            piece(&hole([10.0, 0.0, 0.0], [0.0, 0.0, 1.0], None), [0.0, 1.001, -1.0], [60.0, 1.001, -1.0]),
            None
        );
    }

    #[test]
    fn only_holes_that_a_box_reaches_are_near() {
        let up = [0.0, 0.0, 1.0];
        let planes =
            EntryPlanes::of(&[hole([10.0, 0.0, 0.0], up, Some(6.0)), hole([40.0, 0.0, -5.0], up, None)]);
        let near = |low: [f64; 3], high: [f64; 3]| {
            let mut found = Vec::new();
            planes.near(&low.into(), &high.into(), &mut |index| found.push(index));
            found.sort_unstable();
            found
        };
        assert_eq!(near([-50.0, -50.0, 0.001], [90.0, 90.0, 5.0]), [0_usize; 0], "above every entry");
        assert_eq!(near([-50.0, -50.0, -1.0], [90.0, 90.0, 5.0]), [0]);
        assert_eq!(near([-50.0, -50.0, -6.0], [90.0, 90.0, 5.0]), [0, 1]);
        assert_eq!(near([55.0, 0.0, -1.0], [56.0, 0.0, -1.0]), [0_usize; 0]);
    }
}
