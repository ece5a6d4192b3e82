//! Convex bodies with flat faces: the distance of their farthest face, the exact distance, and where a travel is in
//! them.
use nalgebra::{Point3, Unit, Vector3};

use super::travel_shares::{common_shares, either, sag, shares_between, shares_within};

/// Rounding by which a line that touches a box is beside it, mm.
const TANGENT: f64 = 1e-12;

/// Distance from a surface, and the normal at the nearest point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPoint {
    /// Distance in mm; negative inside the body.
    pub distance: f64,
    /// Outward normal of the surface at the nearest point.
    pub normal: Unit<Vector3<f64>>,
}

/// Returns the largest distance of `p` from the faces of a box, and the outward normal of that face.
pub(super) fn block_face(min: &Point3<f64>, max: &Point3<f64>, p: &Point3<f64>) -> (f64, Vector3<f64>) {
    let faces = (0..3).flat_map(|i| [(p[i] - max[i], i, 1.0), (min[i] - p[i], i, -1.0)]);
    let (value, axis, sign) = faces.fold((f64::NEG_INFINITY, 0, 1.0), |a, b| if a.0 < b.0 { b } else { a });
    let mut normal = Vector3::zeros();
    normal[axis] = sign;
    (value, normal)
}

/// Returns the length along a line at which it leaves a box; `None` if it passes beside it.
pub(super) fn block_exit(
    min: &Point3<f64>,
    max: &Point3<f64>,
    on: &Point3<f64>,
    out: &Vector3<f64>,
) -> Option<f64> {
    let (mut enters, mut leaves) = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..3 {
        if out[i].abs() < f64::MIN_POSITIVE {
            if (min[i] - on[i]).max(on[i] - max[i]) > TANGENT {
                return None;
            }
            continue;
        }
        let (one, other) = ((min[i] - on[i]) / out[i], (max[i] - on[i]) / out[i]);
        (enters, leaves) = (enters.max(one.min(other)), leaves.min(one.max(other)));
    }
    (enters - TANGENT <= leaves).then_some(leaves)
}

/// Returns the distance of `p` from a box.
pub(super) fn block_nearest(min: &Point3<f64>, max: &Point3<f64>, p: &Point3<f64>) -> NearestPoint {
    let beyond = p - p.sup(min).inf(max);
    nearest(beyond, || block_face(min, max, p))
}

/// Radius of a body of revolution that changes evenly along its axis: of a cylinder, or of a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Radius at height 0, mm.
    pub radius: f64,
    /// Gain of the radius per mm of height.
    pub slope: f64,
}

impl Taper {
    /// Returns the radius of a cylinder.
    pub fn cylinder(radius: f64) -> Self {
        Self { radius, slope: 0.0 }
    }

    /// Returns the radius at a height, mm.
    pub fn at(&self, height: f64) -> f64 {
        // An infinite height has no product with 0.
        if self.slope == 0.0 { self.radius } else { self.radius + self.slope * height }
    }

    /// Returns the taper of a surface that is farther out everywhere, mm square to the surface.
    pub fn grown(&self, by: f64) -> Self {
        Self { radius: self.radius + by * libm::hypot(1.0, self.slope), ..*self }
    }
}

/// Cylinder of limited length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    /// Centre of the end face from which the axis points into the body.
    pub base: Point3<f64>,
    /// Direction of its axis.
    pub axis: Unit<Vector3<f64>>,
    /// Length along the axis, mm.
    pub length: f64,
    /// Radius, mm.
    pub radius: f64,
}

impl Rod {
    /// Returns the height above the base, the direction away from the axis and the distance from it.
    pub(super) fn cylindrical(&self, p: &Point3<f64>) -> (f64, Vector3<f64>, f64) {
        let from_base = p - self.base;
        let height = from_base.dot(&self.axis);
        let away = from_base - self.axis.into_inner() * height;
        match Unit::try_new_and_get(away, f64::MIN_POSITIVE) {
            Some((away, distance)) => (height, away.into_inner(), distance),
            None => (height, self.perpendicular(), 0.0),
        }
    }

    fn perpendicular(&self) -> Vector3<f64> {
        let least = self.axis.iamin();
        let mut beside = Vector3::zeros();
        beside[least] = 1.0;
        self.axis.cross(&beside).normalize()
    }

    /// Returns the largest distance of `p` from mantle and end faces, and the outward normal there.
    pub(super) fn face(&self, p: &Point3<f64>) -> (f64, Vector3<f64>) {
        let (height, away, distance) = self.cylindrical(p);
        let axis = self.axis.into_inner();
        let end = if 2.0 * height < self.length { (-height, -axis) } else { (height - self.length, axis) };
        if end.0 < distance - self.radius { (distance - self.radius, away) } else { end }
    }

    /// Returns the distance of `p` from the cylinder.
    pub fn nearest(&self, p: &Point3<f64>) -> NearestPoint {
        let (height, away, distance) = self.cylindrical(p);
        let axis = self.axis.into_inner();
        let beyond =
            axis * (height - height.clamp(0.0, self.length)) + away * (distance - self.radius).max(0.0);
        nearest(beyond, || self.face(p))
    }
}

impl Rod {
    /// Returns the shares of a straight travel between which it is within a radius of this axis and between two heights above
    /// the base.
    pub fn piece(
        &self,
        from: &Point3<f64>,
        to: &Point3<f64>,
        heights: (f64, f64),
        taper: Taper,
    ) -> Option<[f64; 2]> {
        let (to_start, along) = (from - self.base, to - from);
        let (start, gain) = (to_start.dot(&self.axis), along.dot(&self.axis));
        let shares = shares_between([0.0, 1.0], (start, gain), heights)?;
        let axis = self.axis.into_inner();
        let radius = (taper.at(start), taper.slope * gain);
        shares_within(shares, to_start - axis * start, along - axis * gain, radius)
    }
}

impl Rod {
    /// Returns shares of two travels outside which no point between them is within a radius of this axis and between two heights
    /// above the base.
    pub(super) fn span(
        &self,
        travels: [&[Point3<f64>; 2]; 2],
        (low, high): (f64, f64),
        radius: f64,
    ) -> Option<[f64; 2]> {
        let axis = self.axis.into_inner();
        let height = |p: &Point3<f64>| (p - self.base).dot(&axis);
        let between = |low: f64, high: f64| {
            either(travels, |[from, to]| {
                shares_between([0.0, 1.0], (height(from), (to - from).dot(&axis)), (low, high))
            })
        };
        let radius = radius + sag(travels, radius);
        let near = either(travels, |[from, to]| {
            let (start, along) = (from - self.base, to - from);
            let across = |v: Vector3<f64>| v - axis * v.dot(&axis);
            shares_within([0.0, 1.0], across(start), across(along), (radius, 0.0))
        });
        common_shares(common_shares(between(low, f64::INFINITY)?, between(f64::NEG_INFINITY, high)?)?, near?)
    }
}

/// Returns the shares of a box's span: outside them no point between two travels is between the corners.
pub(super) fn block_span(
    min: &Point3<f64>,
    max: &Point3<f64>,
    travels: [&[Point3<f64>; 2]; 2],
) -> Option<[f64; 2]> {
    (0..3).try_fold([0.0, 1.0], |shares, i| {
        let between = |low: f64, high: f64| {
            either(travels, |[from, to]| shares_between([0.0, 1.0], (from[i], to[i] - from[i]), (low, high)))
        };
        common_shares(
            common_shares(shares, between(min[i], f64::INFINITY)?)?,
            between(f64::NEG_INFINITY, max[i])?,
        )
    })
}

/// Returns the distance along `beyond`, the way out of the body to a point; inside it is that of the nearest face.
fn nearest(beyond: Vector3<f64>, face: impl Fn() -> (f64, Vector3<f64>)) -> NearestPoint {
    match Unit::try_new_and_get(beyond, f64::MIN_POSITIVE) {
        Some((normal, distance)) => NearestPoint { distance, normal },
        None => {
            let (distance, normal) = face();
            NearestPoint { distance, normal: Unit::new_unchecked(normal) }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Surface;

    /// A box from 0 to 10 in each direction. The line through (2, 5, 5) along (0.6, 0.8, 0) leaves it at y = 10, 5/0.8 along; the
    /// one through (−1, 5, 5) along y passes 1 mm beside it, that through (0, 50, 5) along its face.
    #[test]
    fn a_line_leaves_a_box_or_passes_beside_it() {
        let (min, max) = (Point3::origin(), Point3::new(10.0, 10.0, 10.0));
        let exit = |p: [f64; 3], out: [f64; 3]| block_exit(&min, &max, &Point3::from(p), &Vector3::from(out));
        assert!((exit([2.0, 5.0, 5.0], [0.6, 0.8, 0.0]).unwrap() - 6.25).abs() < 1e-12);
        assert_eq!(exit([-1.0, 5.0, 5.0], [0.0, 1.0, 0.0]), None);
        assert_eq!(exit([0.0, 50.0, 5.0], [0.0, 1.0, 0.0]), Some(-40.0), "behind the point");
        // Through the edge at (10, 0), and 0.001 beside it.
        assert!((exit([9.0, -1.0, 5.0], [0.6, 0.6, 0.0]).unwrap() - 1.0 / 0.6).abs() < 1e-12);
        assert_eq!(exit([9.001, -1.0, 5.0], [0.6, 0.6, 0.0]), None);
    }

    fn bodies() -> [Surface; 2] {
        let block =
            Surface::Block { min: Point3::new(-10.0, -20.0, -5.0), max: Point3::new(30.0, 20.0, 0.0) };
        let axis = Unit::new_normalize(Vector3::new(0.0, 0.6, 0.8));
        let rod = Rod { base: Point3::new(1.0, 2.0, 3.0), axis, length: 20.0, radius: 5.0 };
        [block, Surface::Rod(rod)]
    }

    #[test]
    fn faces_edges_and_corners_are_at_the_distances_worked_out_by_hand() {
        let [block, _] = bodies();
        let rod = Rod { base: Point3::origin(), axis: Vector3::z_axis(), length: 20.0, radius: 5.0 };
        for (body, p, distance) in [
            (block, [0.0, 0.0, 7.0], 7.0),
            (block, [33.0, 24.0, -1.0], 5.0),
            (block, [32.0, 23.0, 6.0], 7.0),
            (block, [0.0, 0.0, -1.0], -1.0),
            (block, [29.5, 0.0, -1.0], -0.5),
            (Surface::Rod(rod), [8.0, 0.0, 24.0], 5.0),
            (Surface::Rod(rod), [0.0, 9.0, 10.0], 4.0),
            (Surface::Rod(rod), [0.0, 0.0, 10.0], -5.0),
            (Surface::Rod(rod), [1.0, 0.0, 1.0], -1.0),
        ] {
            let found = body.nearest(&Point3::from(p));
            assert!((found.distance - distance).abs() < 1e-12, "{p:?}: {found:?}");
        }
    }

    /// The cone x² + y² = z² from z 0 on. A line at x 3 is in it from z 3; one at z 5 for 5 on both sides; one along its side
    /// and 0.1 inside from its own begin on; one on the axis from below from z 0.
    #[test]
    fn a_line_is_in_a_cone_between_the_heights_worked_out_by_hand() {
        let rod = Rod { base: Point3::origin(), axis: Vector3::z_axis(), length: 20.0, radius: 9.0 };
        let cone = Taper { radius: 0.0, slope: 1.0 };
        let piece = |from: [f64; 3], to: [f64; 3]| {
            let piece = rod.piece(&from.into(), &to.into(), (f64::NEG_INFINITY, f64::INFINITY), cone)?;
            Some(piece.map(|share| (share * 1e9).round() / 1e9))
        };
        assert_eq!(piece([3.0, 0.0, -10.0], [3.0, 0.0, 10.0]), Some([0.65, 1.0]));
        assert_eq!(piece([-10.0, 0.0, 5.0], [10.0, 0.0, 5.0]), Some([0.25, 0.75]));
        assert_eq!(piece([-10.0, 3.0, 5.0], [10.0, 3.0, 5.0]), Some([0.3, 0.7]));
        assert_eq!(piece([2.9, 0.0, 3.0], [7.9, 0.0, 8.0]), Some([0.0, 1.0]));
        assert_eq!(piece([3.1, 0.0, 3.0], [8.1, 0.0, 8.0]), None);
        assert_eq!(piece([0.0, 0.0, -4.0], [0.0, 0.0, 4.0]), Some([0.5, 1.0]));
        assert_eq!(piece([0.0, 0.0, 4.0], [0.0, 0.0, -4.0]), Some([0.0, 0.5]));
        assert_eq!(piece([3.0, 0.0, -10.0], [3.0, 0.0, -2.0]), None);
        let narrowing = Taper { radius: 4.0, slope: -1.0 };
        let down = rod.piece(&[1.0, 0.0, 8.0].into(), &[1.0, 0.0, -2.0].into(), (0.0, 20.0), narrowing);
        assert_eq!(down.map(|piece| piece.map(|share| (share * 1e9).round() / 1e9)), Some([0.5, 0.8]));
    }

    #[test]
    fn a_rapid_through_a_block_is_deepest_half_way_in() {
        let [block, _] = bodies();
        let (from, to) = (Point3::new(-30.0, 0.0, -2.0), Point3::new(50.0, 0.0, -2.0));
        assert!((block.depth(&block.deepest_between(&from, &to)) - 2.0).abs() < 1e-9);
        let above = |z| block.deepest_between(&Point3::new(-30.0, 0.0, z), &Point3::new(50.0, 0.0, z));
        assert!((block.depth(&above(3.0)) + 3.0).abs() < 1e-9);
        let exit = block.exit(&Point3::new(5.0, 5.0, -4.0), &Vector3::z_axis()).unwrap();
        assert!((exit - Point3::new(5.0, 5.0, 0.0)).norm() < 1e-12, "{exit}");
    }

    proptest! {
        /// The distance is convex: it is nowhere below its tangent, and the foot of the perpendicular is on the surface.
        #[test]
        fn the_distance_lies_above_its_tangents(
            p in prop::array::uniform3(-60.0..60.0f64),
            q in prop::array::uniform3(-60.0..60.0f64),
        ) {
            let (p, q) = (Point3::from(p), Point3::from(q));
            for body in bodies() {
                let (at, other) = (body.nearest(&p), body.nearest(&q));
                prop_assert!(at.distance + at.normal.dot(&(q - p)) <= other.distance + 1e-9);
                let foot = p - at.normal.into_inner() * at.distance;
                prop_assert!(body.nearest(&foot).distance.abs() < 1e-9);
                prop_assert_eq!(body.value(&p) < 0.0, at.distance < 0.0);
            }
        }
    }
}
