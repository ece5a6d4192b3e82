//! Axes of nominal holes, found from passes of a program, and their distances from each other.
use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use super::entry_planes::PARALLEL_COSINE;
use super::feature::{Feature, FeatureKind};
use super::hole::{Hole, SAME_LEVEL};
use super::limits::NOISE;
use super::point_tree::PointTree;

/// Distance at which holes are no longer close, mm, besides rounding.
const CLOSE: f64 = 1.0 - 1e-6;

/// Distance below which two holes have one axis, mm.
const SAME_AXIS: f64 = 1e-6;

/// Largest difference between the diameter of a step and that of the pass that cuts it, mm.
const SAME_DIAMETER: f64 = 0.05;

/// Largest difference between the depth of a step and that of the pass of unknown diameter that cuts it, mm.
const SAME_DEPTH: f64 = 0.1;

/// Least depth of a pass that cuts a hole, mm.
const MIN_DEPTH: f64 = 0.01;

/// Axis of a nominal hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalAxis {
    /// Where the axis meets the surface.
    pub entry: Point3<f64>,
    /// Direction out of the part.
    pub out: Vector3<f64>,
    /// Depth of the hole, mm.
    pub depth: f64,
    /// Distance to the nearest parallel axis, mm; infinite from 1 mm on.
    pub spacing: f64,
    /// Radius of the hole at its widest, mm; `None` if unknown.
    pub radius: Option<f64>,
    /// Thread of the hole; `None` without one.
    pub thread: Option<NominalThread>,
}

/// Metal of the thread of a nominal hole, mm. Depths count from the entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalThread {
    /// Radius of the hole before it is threaded: that of its widest feature that is narrower, at least the minor radius.
    pub core: f64,
    /// Major radius.
    pub major: f64,
    /// Pitch; 0 if the list has none.
    pub pitch: f64,
    /// Depths at which it begins, below wider features, and ends.
    pub span: [f64; 2],
}

impl NominalThread {
    /// Returns the thread of a hole, the deepest of several.
    fn of(hole: &Hole) -> Option<Self> {
        let taps = hole.features.iter().filter(|feature| feature.kind == FeatureKind::Tap);
        let tap = taps.reduce(|deepest, tap| if deepest.bottom() < tap.bottom() { tap } else { deepest })?;
        let pitch = tap.pitch.unwrap_or(0.0);
        let others = || hole.features.iter().filter(|feature| feature.kind != FeatureKind::Tap);
        // ISO 724: the minor diameter of an internal thread.
        let minor = tap.diameter - 1.082_532 * pitch;
        let narrower = others().map(|feature| feature.diameter).filter(|own| *own < tap.diameter);
        let wider = others().filter(|feature| tap.diameter <= feature.diameter);
        Some(Self {
            core: narrower.fold(minor, f64::max) / 2.0,
            major: tap.diameter / 2.0,
            pitch,
            span: [wider.map(Feature::bottom).fold(0.0, f64::max), tap.bottom()],
        })
    }
}

/// Step of a stepped hole that a list has as several holes on one axis.
#[derive(Clone, Debug, PartialEq)]
struct ListedStep {
    entry: Point3<f64>,
    depth: f64,
    /// Diameters of the hole and its features, mm.
    diameters: Vec<f64>,
}

/// Axes of all nominal holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NominalAxes {
    /// Those of the holes, and behind them those of the through holes from their far sides.
    axes: Vec<NominalAxis>,
    /// Number of the holes.
    hole_count: usize,
    /// The entries.
    tree: PointTree,
    /// Depth of the deepest hole, mm.
    max_depth: f64,
    has_close: bool,
    /// Largest major radius of a thread, mm; 0 without threads.
    max_thread: f64,
    /// Steps of each stepped hole, the uppermost first, with those of the axes that it has.
    stacks: Vec<Vec<ListedStep>>,
    stack_of: BTreeMap<usize, usize>,
}

impl NominalAxes {
    /// Returns the number of holes.
    pub fn len(&self) -> usize {
        self.hole_count
    }

    /// Returns true without any hole.
    pub fn is_empty(&self) -> bool {
        self.axes.is_empty()
    }

    /// Returns the axes of a list of holes.
    pub fn of(holes: &[Hole]) -> Self {
        let mut axes: Vec<NominalAxis> = holes.iter().map(NominalAxis::of).collect();
        let tree = PointTree::new(axes.iter().map(|axis| axis.entry));
        let mut has_close = false;
        tree.pairs(CLOSE, &mut |one, other| {
            let Some(distance) = axes[one].distance(&axes[other].entry, &axes[other].out) else { return };
            if SAME_AXIS < distance && distance < CLOSE {
                has_close = true;
                for index in [one, other] {
                    axes[index].spacing = axes[index].spacing.min(distance);
                }
            }
        });
        let max_depth = holes.iter().map(|hole| hole.depth).fold(0.0, f64::max);
        let max_thread = axes.iter().filter_map(|axis| Some(axis.thread?.major)).fold(0.0, f64::max);
        let (stacks, stack_of) = stacks(holes);
        let hole_count = holes.len();
        for index in (0..hole_count).filter(|index| holes[*index].through) {
            let far = NominalAxis::of(&holes[index].from_far_side());
            axes.push(NominalAxis { spacing: axes[index].spacing, ..far });
        }
        let tree = match axes.len() == hole_count {
            true => tree,
            false => PointTree::new(axes.iter().map(|axis| axis.entry)),
        };
        Self { axes, hole_count, tree, max_depth, has_close, max_thread, stacks, stack_of }
    }

    /// Returns true if the list has the steps of a hole as several holes.
    pub fn has_steps(&self) -> bool {
        !self.stacks.is_empty()
    }

    /// Returns the step of a stepped hole that a pass of this diameter cuts: one as wide, of an unknown diameter one as deep, else
    /// the lowest that it enters; 0 at any other hole.
    pub fn step(
        &self,
        pass: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
        within: f64,
        diameter: Option<f64>,
    ) -> usize {
        let at = self.nearest_of(pass, out, within, |_| true);
        let Some(stack) = at.and_then(|(index, _)| self.stacks.get(*self.stack_of.get(&index)?)) else {
            return 0;
        };
        let below = |step: &ListedStep| (step.entry - pass[1]).dot(out);
        let off = |step: &ListedStep| (below(step) - step.depth).abs();
        let is_made = |step: &ListedStep| match diameter {
            Some(own) => step.diameters.iter().any(|other| (own - other).abs() <= SAME_DIAMETER),
            None => off(step) <= SAME_DEPTH,
        };
        let steps = || stack.iter().enumerate();
        let made = steps().filter(|(_, step)| is_made(step));
        let mut entered = steps().filter(|(_, step)| SAME_LEVEL < below(step));
        let nearest = made.min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
        nearest.or(entered.next_back()).map_or(0, |(index, _)| index)
    }

    /// Returns true if any hole has a thread.
    pub fn has_threads(&self) -> bool {
        0.0 < self.max_thread
    }

    /// Returns the threaded hole that a motion along `out` is in, with its axis' distance; `None` beside the threads.
    pub fn threaded(
        &self,
        motion: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
    ) -> Option<(&NominalAxis, &NominalThread, f64)> {
        let (index, distance) =
            self.nearest_of(motion, out, self.max_thread, |axis| axis.thread.is_some())?;
        let axis = &self.axes[index];
        axis.thread.as_ref().filter(|thread| distance < thread.major).map(|thread| (axis, thread, distance))
    }

    /// Returns true if two axes are less than 1 mm apart.
    pub fn has_close(&self) -> bool {
        self.has_close
    }

    /// Returns the axis nearest to a pass along `out` that may begin in the hole, with its distance; `None` above `within` mm.
    pub fn nearest(
        &self,
        pass: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
        within: f64,
    ) -> Option<(&NominalAxis, f64)> {
        self.nearest_of(pass, out, within, |_| true).map(|(index, distance)| (&self.axes[index], distance))
    }

    /// Returns the entry of the nearest hole in which a pass begins; `None` above `within` mm.
    pub fn entered(
        &self,
        pass: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
        within: f64,
    ) -> Option<Point3<f64>> {
        let begins_in = |axis: &NominalAxis| {
            let depth = (axis.entry - pass[0]).dot(&axis.out);
            MIN_DEPTH < depth && depth < axis.depth
        };
        self.nearest_of(pass, out, within, begins_in).map(|(index, _)| self.axes[index].entry)
    }

    /// Returns the nearest axis of a hole whose entry is above the bottom of a pass; `None` above `within` mm.
    pub fn nearest_above(
        &self,
        [start, bottom]: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
        within: f64,
    ) -> Option<&NominalAxis> {
        let is_above = |axis: &NominalAxis| MIN_DEPTH < (axis.entry - bottom).dot(&axis.out);
        self.nearest_of([start, bottom], out, within, is_above).map(|(index, _)| &self.axes[index])
    }

    fn nearest_of(
        &self,
        [start, bottom]: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
        within: f64,
        is_counted: impl Fn(&NominalAxis) -> bool,
    ) -> Option<(usize, f64)> {
        let top = start + out.into_inner() * self.max_depth;
        let margin = Vector3::repeat(within);
        let (low, high) = (top.inf(bottom) - margin, top.sup(bottom) + margin);
        // A hole that begins at the far side of another one is meant there.
        let mut best: [Option<(usize, f64)>; 2] = [None; 2];
        self.tree.in_box(&low, &high, &mut |index| {
            let axis = &self.axes[index];
            let distance =
                axis.distance(bottom, out).filter(|distance| *distance <= within && is_counted(axis));
            let best = &mut best[usize::from(self.hole_count <= index)];
            if let Some(distance) = distance
                && best.is_none_or(|(_, least)| distance < least)
            {
                *best = Some((index, distance));
            }
        });
        best[0].or(best[1])
    }
}

/// Returns the steps of each stepped hole, and the stepped hole of each of its axes.
fn stacks(holes: &[Hole]) -> (Vec<Vec<ListedStep>>, BTreeMap<usize, usize>) {
    let (mut stacks, mut stack_of) = (Vec::new(), BTreeMap::new());
    if holes.iter().all(|hole| diameters(hole).eq(diameters(&holes[0]))) {
        return (stacks, stack_of);
    }
    // Holes on one axis have one foot of the perpendicular from the origin.
    let foot = |hole: &Hole| {
        let (entry, axis) = (Vector3::from(hole.entry), Vector3::from(hole.axis));
        Point3::from(entry - axis * entry.dot(&axis))
    };
    let feet = PointTree::new(holes.iter().map(foot));
    let mut partners: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut opposite: Vec<(usize, usize)> = Vec::new();
    feet.pairs(SAME_AXIS, &mut |one, other| {
        if ListedStep::is_on_axis_of(&holes[one], &holes[other]) {
            partners.entry(one.min(other)).or_default().push(one.max(other));
        }
        let both = [(one, other), (other, one)].into_iter();
        opposite
            .extend(both.filter(|(one, other)| ListedStep::is_at_far_side_of(&holes[*one], &holes[*other])));
    });
    for (first, others) in partners {
        if stack_of.contains_key(&first) {
            continue;
        }
        let mut members = others;
        members.push(first);
        let height =
            |index: &usize| Vector3::from(holes[*index].entry).dot(&Vector3::from(holes[*index].axis));
        let bottom = |index: &usize| height(index) - holes[*index].depth;
        members.sort_by(|a, b| bottom(b).total_cmp(&bottom(a)));
        stack_of.extend(members.iter().map(|index| (*index, stacks.len())));
        stacks.push(members.iter().map(|index| ListedStep::of(&holes[*index])).collect());
    }
    // From its far side a through hole is the lowest step of the holes there.
    for (hole, through) in opposite {
        let stack = *stack_of.entry(hole).or_insert_with(|| {
            stacks.push(vec![ListedStep::of(&holes[hole])]);
            stacks.len() - 1
        });
        stacks[stack].push(ListedStep::of(&holes[through].from_far_side()));
    }
    (stacks, stack_of)
}

/// Returns the diameters of a hole and its features.
fn diameters(hole: &Hole) -> impl Iterator<Item = f64> + '_ {
    hole.diameter.into_iter().chain(hole.features.iter().map(|feature| feature.diameter))
}

impl ListedStep {
    fn of(hole: &Hole) -> Self {
        Self { entry: hole.entry.into(), depth: hole.depth, diameters: diameters(hole).collect() }
    }

    /// Returns true if two holes on one line have one direction and different diameters.
    fn is_on_axis_of(one: &Hole, other: &Hole) -> bool {
        let cosine = Vector3::from(one.axis).dot(&Vector3::from(other.axis));
        1.0 - NOISE < cosine && one.widest_diameter() != other.widest_diameter()
    }

    /// Returns true if a hole begins at the far side of a through hole of another diameter on its line, and is less deep.
    fn is_at_far_side_of(hole: &Hole, through: &Hole) -> bool {
        let out = Vector3::from(through.axis);
        let cosine = Vector3::from(hole.axis).dot(&out);
        let far = Point3::from(through.entry) - out * through.depth;
        let above = (Point3::from(hole.entry) - far).dot(&out).abs();
        through.through
            && cosine < -1.0 + NOISE
            && above <= through.depth / 2.0
            && hole.depth < through.depth
            && !diameters(&through.from_far_side()).eq(diameters(&hole.from_far_side()))
    }
}

impl NominalAxis {
    fn of(hole: &Hole) -> Self {
        Self {
            entry: hole.entry.into(),
            out: hole.axis.into(),
            depth: hole.depth,
            spacing: f64::INFINITY,
            radius: hole.widest_diameter().map(|diameter| diameter / 2.0),
            thread: NominalThread::of(hole),
        }
    }

    /// Returns the distance of the entry from a parallel line through a point; `None` for a line in another direction.
    fn distance(&self, point: &Point3<f64>, out: &Vector3<f64>) -> Option<f64> {
        let between = self.entry - point;
        (PARALLEL_COSINE <= self.out.dot(out)).then(|| (between - out * between.dot(out)).norm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hole(x: f64, z: f64) -> Hole {
        let entry = [x, 0.0, z];
        Hole { entry, axis: [0.0, 0.0, 1.0], depth: 10.0, ..Hole::default() }
    }

    #[test]
    fn each_axis_has_its_own_spacing() {
        let far = NominalAxes::of(&[hole(0.0, 0.0), hole(1.0, 0.0), hole(1.0, -0.5)]);
        assert!(!far.has_close(), "1 mm apart, and two holes on one axis");
        let axes = NominalAxes::of(&[hole(0.0, 0.0), hole(0.45, 0.5), hole(1.2, 0.0), hole(5.0, 0.0)]);
        let spacings: Vec<f64> = axes.axes.iter().map(|axis| axis.spacing).collect();
        assert!(axes.has_close());
        assert!((spacings[0] - 0.45).abs() < 1e-12 && (spacings[2] - 0.75).abs() < 1e-12, "{spacings:?}");
        assert!(spacings[3].is_infinite());
    }

    /// From Z−8 to Z−9, 8 mm below the entries and nowhere near them.
    #[test]
    fn a_pass_that_begins_in_the_hole_finds_its_axis() {
        let axes = NominalAxes::of(&[hole(0.0, 0.0), hole(0.45, 0.0)]);
        let pass = |x: f64| [Point3::new(x, 0.0, -8.0), Point3::new(x, 0.0, -9.0)];
        let nearest = |x: f64| {
            let [start, bottom] = pass(x);
            axes.nearest([&start, &bottom], &Vector3::z_axis(), 1.0).map(|(axis, at)| (axis.entry.x, at))
        };
        let (entry, at) = nearest(0.4).unwrap();
        assert!(entry == 0.45 && (at - 0.05).abs() < 1e-12);
        assert_eq!(nearest(1.5), None);
        let above = |z: f64| {
            let at = Point3::new(0.0, 0.0, z);
            axes.nearest_above([&at, &at], &Vector3::z_axis(), 1.0).is_some()
        };
        assert!(above(-0.02) && !above(-0.005) && !above(1.0), "the entry is at 0");
        let entered = |z: f64| {
            let (start, bottom) = (Point3::new(0.0, 0.0, z), Point3::new(0.0, 0.0, z - 2.0));
            axes.entered([&start, &bottom], &Vector3::z_axis(), 0.4).map(|entry| entry.z)
        };
        assert_eq!([entered(-9.9), entered(-0.02)], [Some(0.0); 2], "10 deep");
        assert_eq!([entered(-10.0), entered(0.0)], [None; 2], "at the bottom, and at the entry");
    }

    /// Φ12×5 over Φ6 from there to 15: a Φ12 that goes to 5.3 is the step's, an Φ8 to 5.05 too, and to 5.2 it is the hole's.
    #[test]
    fn a_pass_belongs_to_the_step_of_its_diameter_or_depth() {
        let step =
            |z: f64, depth: f64, diameter: f64| Hole { depth, diameter: Some(diameter), ..hole(0.0, z) };
        let axes = NominalAxes::of(&[step(-5.0, 10.0, 6.0), step(0.0, 5.0, 12.0)]);
        let of = |z: f64, diameter| {
            let (start, bottom) = (Point3::new(0.0, 0.0, 2.0), Point3::new(0.0, 0.0, z));
            axes.step([&start, &bottom], &Vector3::z_axis(), 0.5, diameter)
        };
        assert!(axes.has_steps());
        assert_eq!([of(-15.0, Some(6.0)), of(-8.0, Some(6.0)), of(-4.0, Some(6.0))], [1, 1, 1]);
        assert_eq!([of(-5.0, Some(12.0)), of(-5.3, Some(12.0))], [0, 0]);
        assert_eq!(
            [of(-5.05, Some(8.0)), of(-5.2, Some(8.0)), of(-5.0, None), of(-15.0, None)],
            [0, 1, 0, 1]
        );
        assert!(!NominalAxes::of(&[hole(0.0, 0.0), hole(0.0, -20.0)]).has_steps(), "one diameter");
    }
}
