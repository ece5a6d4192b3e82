//! Axes of nominal holes, found from passes of a program, and their distances from each other.
use nalgebra::{Point3, Unit, Vector3};

use super::entry_planes::PARALLEL_COSINE;
use super::hole::Hole;
use super::point_tree::PointTree;

/// Distance at which holes are no longer close, mm, besides rounding.
const CLOSE: f64 = 1.0 - 1e-6;

/// Distance below which two holes have one axis, mm.
const SAME_AXIS: f64 = 1e-6;

/// Least depth of a pass that cuts a hole, mm.
const MIN_DEPTH: f64 = 0.01;

/// Axis of a nominal hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalAxis {
    /// Where the axis meets the surface.
    pub entry: Point3<f64>,
    /// Direction out of the part.
    pub out: Vector3<f64>,
    /// Distance to the nearest parallel axis, mm; infinite from 1 mm on.
    pub spacing: f64,
    /// Radius of the hole at its widest, mm; `None` if unknown.
    pub radius: Option<f64>,
}

/// Axes of all nominal holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NominalAxes {
    axes: Vec<NominalAxis>,
    /// The entries.
    tree: PointTree,
    /// Depth of the deepest hole, mm.
    max_depth: f64,
    has_close: bool,
}

impl NominalAxes {
    /// Returns the axes of a list of holes.
    pub fn of(holes: &[Hole]) -> Self {
        let axis = |hole: &Hole| NominalAxis {
            entry: hole.entry.into(),
            out: hole.axis.into(),
            spacing: f64::INFINITY,
            radius: hole.widest_diameter().map(|diameter| diameter / 2.0),
        };
        let mut axes: Vec<NominalAxis> = holes.iter().map(axis).collect();
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
        Self { axes, tree, max_depth, has_close }
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
        self.nearest_of(pass, out, within, |_| true)
    }

    /// Returns the nearest axis of a hole whose entry is above the bottom of a pass; `None` above `within` mm.
    pub fn nearest_above(
        &self,
        [start, bottom]: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
        within: f64,
    ) -> Option<&NominalAxis> {
        let is_above = |axis: &NominalAxis| MIN_DEPTH < (axis.entry - bottom).dot(&axis.out);
        self.nearest_of([start, bottom], out, within, is_above).map(|(axis, _)| axis)
    }

    fn nearest_of(
        &self,
        [start, bottom]: [&Point3<f64>; 2],
        out: &Unit<Vector3<f64>>,
        within: f64,
        is_counted: impl Fn(&NominalAxis) -> bool,
    ) -> Option<(&NominalAxis, f64)> {
        let top = start + out.into_inner() * self.max_depth;
        let margin = Vector3::repeat(within);
        let (low, high) = (top.inf(bottom) - margin, top.sup(bottom) + margin);
        let mut best: Option<(&NominalAxis, f64)> = None;
        self.tree.in_box(&low, &high, &mut |index| {
            let axis = &self.axes[index];
            let distance =
                axis.distance(bottom, out).filter(|distance| *distance <= within && is_counted(axis));
            if let Some(distance) = distance
                && best.is_none_or(|(_, least)| distance < least)
            {
                best = Some((axis, distance));
            }
        });
        best
    }
}

impl NominalAxis {
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
    }
}
