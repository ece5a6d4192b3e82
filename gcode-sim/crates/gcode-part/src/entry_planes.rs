//! Metal round the holes of a list: each nominal entry lies on the surface, so the material below it is known near its
//! hole.
use std::sync::Arc;

use nalgebra::{Point3, Unit, Vector3};

use super::facing::facing_depths;
use super::feature::{DepthTo, Feature, FeatureKind};
use super::hole::Hole;
use super::limits::NOISE;
use super::point_tree::PointTree;
use super::solid::{Rod, Taper};
use super::surface::Surface;
use super::travel_shares::shares_between;

/// Thickness of the wall round a hole that is known to be metal, mm.
const WALL: f64 = 1.0;

/// Largest length by which the full diameter of a tool may pass the far side of a through hole, mm: the lead of a tap or a
/// reamer, and some clearance.
pub const MAX_BREAK_THROUGH: f64 = 10.0;

/// Width by which a cone may break the edge of a hole without a countersink, mm.
pub const MAX_EDGE_BREAK: f64 = 0.5;

/// Length of a drill's point of 118° in diameters: a finishing tool need not reach below the drill's full diameter.
pub const POINT_LENGTH: f64 = 0.300_430;

/// Cosine of the largest angle between axes that count as parallel: 5°.
pub const PARALLEL_COSINE: f64 = 0.996_194_698_091_745_5;

/// What is known to be metal before a program runs.
#[derive(Clone, Debug, Default)]
pub struct Metal {
    /// Stock, or the surface of the part.
    pub body: Option<Surface>,
    /// Metal round the nominal holes; `None` without a reference.
    pub entries: Option<Arc<EntryPlanes>>,
    /// What feeds may remove of the body besides the holes.
    pub pockets: Vec<Surface>,
    /// What is empty in the body before the program runs.
    pub voids: Vec<Surface>,
}

impl From<Option<Surface>> for Metal {
    fn from(body: Option<Surface>) -> Self {
        Self { body, ..Self::default() }
    }
}

/// Metal round the holes of a list.
#[derive(Debug)]
pub struct EntryPlanes {
    collars: Vec<Collar>,
    ids: Vec<String>,
    /// The reference doesn't state the diameter of some hole.
    has_open: bool,
    /// Middles of the collars.
    pub(super) middles: PointTree,
    /// Largest distance of a collar's point from its middle.
    reach: f64,
    /// Largest length by which the room of a hole leaves its collar, mm.
    pub(super) room: f64,
    /// The same along each axis.
    pub(super) extent: Vector3<f64>,
    /// Direction of all axes if they agree, and the height of the highest entry along it.
    pub(super) top: Option<(Unit<Vector3<f64>>, f64)>,
}

/// Metal round one hole: a cylinder from the plane of the nominal entry to the bottom, with the hole in it, and the floor
/// of a hole that goes through nothing.
#[derive(Clone, Debug)]
pub struct Collar {
    /// The cylinder, its base at the bottom of the hole.
    pub rod: Rod,
    /// Radius inside which the metal at the entry belongs to the hole, mm.
    pub hole_radius: f64,
    /// Radius of its narrowest feature before it is threaded, mm.
    narrowest_radius: f64,
    /// Cylinders and cones that the hole consists of, each from the entry.
    pub steps: Vec<Step>,
    /// The reference states the hole's diameter.
    pub has_diameter: bool,
    /// The hole breaks out on the far side.
    pub is_through: bool,
}

/// Cylinder or cone of a hole; above the entry it is as wide as there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Radius by the depth below the entry.
    pub taper: Taper,
    /// Largest depth of a feed below the entry, mm: with the tolerance, or the room below the far side.
    pub max_depth: f64,
}

impl Step {
    /// Returns the radius at a depth below the entry, mm.
    pub fn radius(&self, depth: f64) -> f64 {
        self.taper.at(depth.clamp(0.0, self.max_depth))
    }
}

impl EntryPlanes {
    /// Returns the metal round these holes; their depths have a tolerance.
    pub fn of(holes: &[Hole], depth_tolerance: f64) -> Self {
        let collar = |(hole, facing): (&Hole, Option<f64>)| match facing {
            Some(depth) => Collar::of(&Hole { depth, through: true, ..hole.clone() }, depth_tolerance),
            None => Collar::of(hole, depth_tolerance),
        };
        let collars: Vec<Collar> = holes.iter().zip(facing_depths(holes)).map(collar).collect();
        let reach =
            |collar: &Collar| libm::hypot(collar.rod.length / 2.0 + collar.floor(), collar.rod.radius);
        Self {
            middles: PointTree::new(collars.iter().map(Collar::middle)),
            reach: collars.iter().map(reach).fold(0.0, f64::max),
            room: collars.iter().map(|collar| collar.max_depth() - collar.rod.length).fold(WALL, f64::max),
            extent: collars.iter().map(extent).fold(Vector3::zeros(), |a, b| a.sup(&b)),
            top: top(&collars),
            has_open: collars.iter().any(|collar| !collar.has_diameter),
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

    /// Returns true if the reference doesn't state the diameter of some hole.
    pub fn has_open(&self) -> bool {
        self.has_open
    }

    /// Returns the metal round a hole.
    pub fn collar(&self, index: usize) -> &Collar {
        &self.collars[index]
    }

    /// Returns the id of a hole.
    pub fn id(&self, index: usize) -> &str {
        &self.ids[index]
    }

    /// Returns true if the box from `low` to `high` is above every entry, where all holes have one direction.
    pub fn is_above_all(&self, low: &Point3<f64>, high: &Point3<f64>) -> bool {
        self.top.is_some_and(|(out, top)| {
            top < (0..3).map(|i| (out[i] * low[i]).min(out[i] * high[i])).sum::<f64>()
        })
    }

    /// Returns two corners of the box that holds the metal round all holes; the origin without any.
    pub fn bounds(&self) -> [Point3<f64>; 2] {
        let of_collar = |collar: &Collar| {
            let (middle, extent) = (collar.middle(), extent(collar));
            [middle - extent, middle + extent]
        };
        let boxes = self.collars.iter().map(of_collar);
        let all = boxes.reduce(|[low, high], [p, q]| [low.inf(&p), high.sup(&q)]);
        all.unwrap_or([Point3::origin(); 2])
    }

    /// Calls `each` with the holes whose metal, or the space above it, may reach into the box from `low` to `high`.
    pub fn around(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        self.middles.in_box(&(low - self.extent), &(high + self.extent), each);
    }

    /// Returns a lower bound of the distance from the metal round any hole, mm.
    pub fn nearest_metal(&self, p: &Point3<f64>) -> f64 {
        self.middles.nearest(p).map_or(f64::INFINITY, |(_, distance)| distance - self.reach)
    }
}

/// Returns the largest distance of a point of the metal round a hole from the middle of its rod, along each axis.
fn extent(collar: &Collar) -> Vector3<f64> {
    let (rod, length) = (&collar.rod, collar.rod.length / 2.0 + collar.floor());
    rod.axis.map(|along| along.abs() * length + rod.radius * (1.0 - along * along).max(0.0).sqrt())
}

/// Returns the direction of all axes if they agree, and the height of the highest entry along it.
fn top(collars: &[Collar]) -> Option<(Unit<Vector3<f64>>, f64)> {
    let out = collars.first()?.rod.axis;
    let agree = collars.iter().all(|collar| (collar.rod.axis.into_inner() - out.into_inner()).amax() < 1e-9);
    let height = |collar: &Collar| collar.rod.base.coords.dot(&out) + collar.rod.length;
    agree.then(|| (out, collars.iter().map(height).fold(f64::NEG_INFINITY, f64::max)))
}

impl Collar {
    fn of(hole: &Hole, depth_tolerance: f64) -> Self {
        let axis = Unit::new_normalize(Vector3::from(hole.axis));
        let base = Point3::from(hole.entry) - axis.into_inner() * hole.depth;
        let radius = hole.widest_diameter().map(|diameter| diameter / 2.0);
        Self {
            rod: Rod { base, axis, length: hole.depth, radius: radius.unwrap_or(0.0) + WALL },
            hole_radius: radius.unwrap_or(WALL),
            narrowest_radius: narrowest_radius(hole, radius.unwrap_or(WALL)),
            steps: steps(hole, radius.unwrap_or(WALL), depth_tolerance),
            has_diameter: radius.is_some(),
            is_through: hole.through,
        }
    }

    /// Returns the middle of the rod.
    fn middle(&self) -> Point3<f64> {
        self.rod.base + self.rod.axis.into_inner() * (self.rod.length / 2.0)
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
        skin < depth && depth <= self.rod.length + self.floor() && self.from_axis(p) <= self.rod.radius
    }

    /// Returns true if a straight travel is parallel to the hole.
    pub fn is_parallel(&self, along: &Vector3<f64>) -> bool {
        PARALLEL_COSINE * along.norm() <= along.dot(&self.rod.axis).abs()
    }

    /// Returns the shares of a straight travel between which it is in the collar, deeper than `skin` below the entry
    /// plane.
    pub fn piece(&self, from: &Point3<f64>, to: &Point3<f64>, skin: f64) -> Option<[f64; 2]> {
        let taper = Taper::cylinder(self.rod.radius);
        self.rod.piece(from, to, (-self.floor(), self.rod.length - skin), taper)
    }

    /// Returns shares of two travels outside which no point between them is in the collar, deeper than `skin` below the entry
    /// plane.
    pub fn span(&self, travels: [&[Point3<f64>; 2]; 2], skin: f64) -> Option<[f64; 2]> {
        self.rod.span(travels, (-self.floor(), self.rod.length - skin), self.rod.radius)
    }

    /// Returns the thickness of the metal below the bottom, mm.
    pub fn floor(&self) -> f64 {
        if self.is_through { 0.0 } else { WALL }
    }

    /// Returns the shares of a straight travel between which it is in a step of the hole, down to a depth, and above it.
    pub fn pieces_of_step(&self, from: &Point3<f64>, to: &Point3<f64>, step: &Step) -> [Option<[f64; 2]>; 2] {
        let (entry, bottom) = (self.rod.length, self.rod.length - step.max_depth);
        let Taper { radius, slope } = step.taper;
        let above = Taper::cylinder(radius);
        if slope == 0.0 {
            return [self.rod.piece(from, to, (bottom, f64::INFINITY), above), None];
        }
        let cone = Taper { radius: radius + slope * entry, slope: -slope };
        [
            self.rod.piece(from, to, (bottom, entry), cone),
            self.rod.piece(from, to, (entry, f64::INFINITY), above),
        ]
    }

    /// Returns the shares of a straight travel between which it is below the entry plane.
    pub fn piece_below_entry(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<[f64; 2]> {
        let gain = (to - from).dot(&self.rod.axis);
        shares_between([0.0, 1.0], (-self.depth(from), gain), (f64::NEG_INFINITY, 0.0))
    }

    /// Returns the room of a cone that breaks the edge at the entry; `None` where the reference has a countersink or no diameter.
    /// `slope` is the gain of the tool's radius per mm of height.
    pub fn edge_break(&self, slope: f64) -> Option<Step> {
        let has_edge = self.has_diameter && self.steps.iter().all(|step| step.taper.slope == 0.0);
        let taper = Taper { radius: self.hole_radius + MAX_EDGE_BREAK, slope: -slope };
        (has_edge && 0.0 < slope).then(|| Step { taper, max_depth: MAX_EDGE_BREAK / slope })
    }

    /// Returns the radius of the narrowest feature before it is threaded, mm.
    pub fn narrowest(&self) -> f64 {
        self.narrowest_radius.min(self.hole_radius)
    }

    /// Returns the radius of the widest of the features that end where a stroke on the axis does, mm; `None` if none does.
    pub fn radius_ending_at(&self, depth: f64) -> Option<f64> {
        let end = |step: &&Step| match self.is_far(step) {
            true => (self.rod.length <= depth + NOISE).then_some(0.0),
            false => Some((step.max_depth - depth).abs()).filter(|gap| *gap <= SAME_END),
        };
        let nearest = self.steps.iter().filter_map(|step| end(&step)).reduce(f64::min)?;
        let made = self.steps.iter().filter(|step| end(step).is_some_and(|gap| gap <= nearest + NOISE));
        made.map(|step| step.taper.radius.min(self.hole_radius)).reduce(f64::max)
    }

    /// Returns true if two strokes on the axis end where the same feature does; depths below the entry, mm.
    pub fn is_same_end(&self, one: f64, other: f64) -> bool {
        let is_beyond = |depth: f64| self.is_through && self.rod.length <= depth + NOISE;
        (one - other).abs() <= SAME_END || is_beyond(one) && is_beyond(other)
    }

    /// Returns true for a step that ends on the far side.
    fn is_far(&self, step: &Step) -> bool {
        self.is_through && self.rod.length + MAX_BREAK_THROUGH <= step.max_depth + NOISE
    }

    /// Returns the largest depth of a feed in the hole, mm.
    pub fn max_depth(&self) -> f64 {
        self.steps.iter().map(|step| step.max_depth).fold(0.0, f64::max)
    }
}

/// Returns the cylinders and cones of a hole; `radius` is that of a hole without features.
fn steps(hole: &Hole, radius: f64, tolerance: f64) -> Vec<Step> {
    let step = |radius: f64, depth: f64| {
        let is_far = hole.through && hole.depth <= depth + NOISE;
        let room = if is_far { MAX_BREAK_THROUGH + POINT_LENGTH * 2.0 * radius } else { tolerance };
        Step { taper: Taper::cylinder(radius), max_depth: depth + room }
    };
    let of_feature = |feature: &Feature| {
        let (radius, bottom) = (feature.diameter / 2.0, feature.bottom());
        if feature.kind == FeatureKind::Countersink && feature.angle.is_some() && 0.0 < bottom {
            let slope = -radius / bottom;
            let taper = Taper { radius: radius - slope * tolerance, slope };
            return Step { taper, max_depth: bottom + tolerance };
        }
        let below = match (feature.kind, feature.to) {
            // A thread mill comes in along half a turn, where the hole is deeper than its thread.
            (FeatureKind::Tap, _) => (feature.pitch.unwrap_or(0.0) / 2.0).min(hole.depth - bottom).max(0.0),
            (_, DepthTo::Full) => POINT_LENGTH * feature.diameter,
            (_, DepthTo::Point) => 0.0,
        };
        step(radius, bottom + below)
    };
    if hole.features.is_empty() {
        return vec![step(radius, hole.depth)];
    }
    let mut all: Vec<Step> = hole.features.iter().map(of_feature).collect();
    let deepest = hole.features.iter().map(Feature::bottom).fold(0.0, f64::max);
    if deepest + NOISE < hole.depth {
        // Below its features a hole is at most as wide as its narrowest one.
        all.push(step(narrowest_radius(hole, radius), hole.depth));
    }
    all
}

/// Returns the radius of the narrowest feature before it is threaded; `radius` is that of a hole without features.
fn narrowest_radius(hole: &Hole, radius: f64) -> f64 {
    let before_thread = |feature: &Feature| feature.diameter / 2.0 - feature.pitch.unwrap_or(0.0) / 4.0;
    hole.features.iter().map(before_thread).fold(radius, f64::min)
}

/// Difference in depth up to which a stroke ends where a feature does, its point included, mm.
pub const SAME_END: f64 = 1.0;

#[cfg(test)]
mod tests {
    use super::super::entry_search::EntrySearch;
    use super::*;

    fn hole(entry: [f64; 3], axis: [f64; 3], diameter: Option<f64>) -> Hole {
        Hole { entry, axis, depth: 15.0, diameter, ..Hole::default() }
    }

    fn piece(hole: &Hole, from: [f64; 3], to: [f64; 3]) -> Option<[[f64; 3]; 2]> {
        let (from, to) = (Point3::from(from), Point3::from(to));
        let piece = Collar::of(hole, 0.1).piece(&from, &to, 0.01)?.map(|share| from + (to - from) * share);
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

    /// A drill of 6 through 19 may end 10 mm and its point, 1.803, below the far side; the counterbore of 20 ends at 5.1. The
    /// cone of Φ16 and 90° is 8 deep and may be 0.1 deeper; below it the hole of unknown width goes on to its depth.
    #[test]
    fn each_feature_of_a_hole_has_its_room() {
        let features = |texts: &[&str]| texts.iter().map(|text| Feature::parse(text).unwrap()).collect();
        let up = |through, texts: &[&str]| Hole {
            depth: 19.0,
            through,
            features: features(texts),
            ..hole([0.0; 3], [0.0, 0.0, 1.0], None)
        };
        let steps = |hole: &Hole| -> Vec<[f64; 2]> {
            let rounded = |s: &Step| [s.taper.radius, s.max_depth].map(|v| (v * 1e3).round() / 1e3);
            Collar::of(hole, 0.1).steps.iter().map(rounded).collect()
        };
        let bored = ["drill 6 19", "counterbore 20 5"];
        assert_eq!(steps(&up(false, &bored)), [[3.0, 19.1], [10.0, 5.1]]);
        assert_eq!(steps(&up(true, &bored)), [[3.0, 30.803], [10.0, 5.1]]);
        assert_eq!(steps(&up(false, &["drill 6 19 to=full"])), [[3.0, 20.903]]);
        let countersunk = up(false, &["countersink 16 angle=90"]);
        assert_eq!(steps(&countersunk), [[8.1, 8.1], [8.0, 19.1]]);
        let cone = Collar::of(&countersunk, 0.1).steps[0];
        assert_eq!(
            [-5.0, 0.0, 3.0, 8.1].map(|depth| (cone.radius(depth) * 1e6).round() / 1e6),
            [8.1, 8.1, 5.1, 0.0]
        );
        let collar = Collar::of(&countersunk, 0.1);
        let line = [Point3::new(5.0, 0.0, 4.0), Point3::new(5.0, 0.0, -6.0)];
        let pieces = collar.pieces_of_step(&line[0], &line[1], &cone);
        let rounded = pieces.map(|piece| piece.unwrap().map(|share| (share * 1e6).round() / 1e6));
        assert_eq!(rounded, [[0.4, 0.71], [0.0, 0.4]]);
    }

    #[test]
    fn only_holes_that_a_box_reaches_are_near() {
        let up = [0.0, 0.0, 1.0];
        let holes = [hole([10.0, 0.0, 0.0], up, Some(6.0)), hole([40.0, 0.0, -5.0], up, None)];
        let planes = EntrySearch::from(Arc::new(EntryPlanes::of(&holes, 0.1)));
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
