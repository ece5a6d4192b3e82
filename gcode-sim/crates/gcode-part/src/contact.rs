//! Contact of a moved part of a tool with a convex body.
use std::ops::ControlFlow;

use nalgebra::{Point3, Unit, Vector3};

use super::solid::Taper;
use super::surface::{Surface, bisect};

/// Distance that counts as contact, mm.
const CONTACT: f64 = 1e-6;

/// Distance of two points that counts as none, mm.
const SAME_POINT: f64 = 1e-9;

/// Number of projections onto the body that decide most travels.
const FEW_PROJECTIONS: u32 = 16;

/// Largest number of projections at one place of the travel.
const MAX_PROJECTIONS: u32 = 2000;

/// Least ratio of a step to the one before at which its geometric series is summed.
const SLOW: f64 = 0.8;

/// Largest number of halvings of the travel.
const MAX_HALVED: u32 = 40;

/// Cylinder or frustum of a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Centre of the end face from which the axis points into the body.
    pub base: Point3<f64>,
    /// Direction of its axis.
    pub axis: Unit<Vector3<f64>>,
    /// Length along the axis, mm.
    pub length: f64,
    /// Radius by the height above the base.
    pub taper: Taper,
}

impl Surface {
    /// Returns true if a frustum touches the body while it moves by `along`, false if it certainly does not.
    ///
    /// Body and swept frustum are convex: alternating projections onto them converge to their nearest points (von
    /// Neumann), slowly where they meet at a small angle; the limit of equally shrinking steps is tried (Aitken). The
    /// distance between body and frustum is a convex function of the share of the travel, so that the sign of its slope
    /// tells in which half the least one lies. What is undecided after 40 halvings counts as contact.
    pub fn touches(&self, frustum: &Frustum, along: &Vector3<f64>) -> bool {
        let decided = |p: &Point3<f64>| self.foot_of_gap(p, frustum, along);
        let mut p = frustum.base;
        for _ in 0..FEW_PROJECTIONS {
            match decided(&p) {
                ControlFlow::Continue(foot) => p = frustum.project_swept(&foot, along),
                ControlFlow::Break(touches) => return touches,
            }
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..MAX_HALVED {
            let part = f64::midpoint(low, high);
            let moved = Frustum { base: frustum.base + along * part, ..*frustum };
            let (mut gap, mut last_step) = (Vector3::zeros(), f64::INFINITY);
            p = moved.project(&p);
            for _ in 0..MAX_PROJECTIONS {
                let foot = match decided(&p) {
                    ControlFlow::Continue(foot) => foot,
                    ControlFlow::Break(touches) => return touches,
                };
                let before = std::mem::replace(&mut p, moved.project(&foot));
                gap = p - foot;
                let step = p - before;
                if step.norm() < SAME_POINT {
                    break;
                }
                let ratio = step.norm() / last_step;
                last_step = step.norm();
                if SLOW < ratio && ratio < 1.0 {
                    let limit = moved.project(&(p + step * (ratio / (1.0 - ratio))));
                    if self.nearest(&limit).distance < self.nearest(&p).distance {
                        (p, last_step) = (limit, f64::INFINITY);
                    }
                }
            }
            (low, high) = if gap.dot(along) > 0.0 { (low, part) } else { (part, high) };
        }
        true
    }

    /// Returns the point of the body that is nearest to a point of the swept frustum; or whether they touch, if that decides it. A
    /// plane between them proves that they don't.
    fn foot_of_gap(
        &self,
        p: &Point3<f64>,
        frustum: &Frustum,
        along: &Vector3<f64>,
    ) -> ControlFlow<bool, Point3<f64>> {
        let nearest = self.nearest(p);
        if nearest.distance <= CONTACT {
            return ControlFlow::Break(true);
        }
        let foot = p - nearest.normal.into_inner() * nearest.distance;
        let least = frustum.least_along(&nearest.normal) + along.dot(&nearest.normal).min(0.0);
        match foot.coords.dot(&nearest.normal) + CONTACT < least {
            true => ControlFlow::Break(false),
            false => ControlFlow::Continue(foot),
        }
    }
}

impl Frustum {
    /// Returns the least coordinate in a direction.
    fn least_along(&self, direction: &Vector3<f64>) -> f64 {
        let along = self.axis.dot(direction);
        let across = (direction - self.axis.into_inner() * along).norm();
        let end = |height: f64| height * along - self.taper.at(height) * across;
        self.base.coords.dot(direction) + end(0.0).min(end(self.length))
    }

    /// Returns the point of the frustum that is nearest to `p`.
    fn project(&self, p: &Point3<f64>) -> Point3<f64> {
        let from_base = p - self.base;
        let height = from_base.dot(&self.axis);
        let away = from_base - self.axis.into_inner() * height;
        let aside = away.norm();
        let mut height = height;
        let mut reach = self.taper.at(height.clamp(0.0, self.length));
        if reach < aside {
            // The foot of the perpendicular on the side.
            let Taper { radius, slope } = self.taper;
            height = (height + slope * (aside - radius)) / (1.0 + slope * slope);
            reach = self.taper.at(height.clamp(0.0, self.length));
        }
        let height = height.clamp(0.0, self.length);
        let across = if reach < aside { away * (reach / aside) } else { away };
        self.base + self.axis.into_inner() * height + across
    }

    /// Returns the point of the frustum, moved by a part of `along`, that is nearest to `p`.
    fn project_swept(&self, p: &Point3<f64>, along: &Vector3<f64>) -> Point3<f64> {
        // The distance is a convex function of the part.
        let is_past = |part: f64| {
            let moved = p - along * part;
            (moved - self.project(&moved)).dot(along) <= 0.0
        };
        let part = match (is_past(0.0), is_past(1.0)) {
            (true, _) => 0.0,
            (false, true) => bisect(0.0, 1.0, is_past),
            (false, false) => 1.0,
        };
        self.project(&(p - along * part)) + along * part
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Rod;

    fn upright(x: f64, y: f64, z: f64, radius: f64) -> Frustum {
        let taper = Taper::cylinder(radius);
        Frustum { base: Point3::new(x, y, z), axis: Vector3::z_axis(), length: 10.0, taper }
    }

    /// The block ends at x 80, y 80 and z 0. At x 83 a cylinder of 6 touches its face. A cylinder about 82, 82 is
    /// 2·SQRT[2] = 2.8284 from its edge.
    #[test]
    fn a_cylinder_touches_a_face_and_an_edge_at_its_radius() {
        let block = Surface::Block { min: Point3::new(0.0, 0.0, -25.0), max: Point3::new(80.0, 80.0, 0.0) };
        let still = Vector3::zeros();
        for (rod, is_contact) in [
            (upright(82.999, 40.0, -5.0, 3.0), true),
            (upright(83.001, 40.0, -5.0, 3.0), false),
            (upright(40.0, 40.0, -0.001, 3.0), true),
            (upright(40.0, 40.0, 0.001, 3.0), false),
            (upright(82.0, 82.0, -5.0, 2.829), true),
            (upright(82.0, 82.0, -5.0, 2.828), false),
        ] {
            assert_eq!(block.touches(&rod, &still), is_contact, "{rod:?}");
        }
    }

    /// A rod of 2 about x 4 lies inside a cylinder of 20 whose axis and mantle miss it.
    #[test]
    fn a_body_narrower_than_the_cylinder_is_found() {
        let pin = Surface::Rod(Rod {
            base: Point3::new(4.0, 0.0, -20.0),
            axis: Vector3::z_axis(),
            length: 20.0,
            radius: 1.0,
        });
        let still = Vector3::zeros();
        assert!(pin.touches(&upright(0.0, 0.0, -5.0, 10.0), &still));
        assert!(!pin.touches(&upright(-7.01, 0.0, -5.0, 10.0), &still));
        assert!(pin.touches(&upright(-6.99, 0.0, -5.0, 10.0), &still));
    }

    /// Along y the cylinder passes the face at x 80; its ends are 30 mm and more from the block.
    #[test]
    fn a_swept_cylinder_touches_between_its_ends() {
        let block = Surface::Block { min: Point3::new(0.0, 0.0, -25.0), max: Point3::new(80.0, 80.0, 0.0) };
        let along = Vector3::new(0.0, 160.0, 0.0);
        assert!(block.touches(&upright(82.999, -40.0, -5.0, 3.0), &along));
        assert!(!block.touches(&upright(83.001, -40.0, -5.0, 3.0), &along));
        // Towards x the travel ends 3.001 mm before the face.
        let across = |end: f64| Vector3::new(end - 120.0, 0.0, 0.0);
        assert!(!block.touches(&upright(120.0, 40.0, -5.0, 3.0), &across(83.001)));
        assert!(block.touches(&upright(120.0, 40.0, -5.0, 3.0), &across(82.999)));
    }

    /// A travel of 80 that comes down to z −8, and one that enters the side face by 1 mm, at every slope; the other way too.
    #[test]
    fn a_travel_that_enters_at_a_small_angle_touches() {
        let block = Surface::Block { min: Point3::new(0.0, 0.0, -40.0), max: Point3::new(100.0, 80.0, 0.0) };
        for height in [0.01, 0.5, 1.0, 2.0, 5.0, 20.0, 60.0] {
            for depth in [0.001, 0.01, 1.0, 8.0, 30.0] {
                let down = Vector3::new(80.0, 0.0, -height - depth);
                let above = upright(10.0, 65.0, height, 4.5);
                assert!(block.touches(&above, &down), "{height} {depth}");
                let back = Frustum { base: above.base + down, ..above };
                assert!(block.touches(&back, &-down), "{height} {depth}");
                assert!(!block.touches(&above, &Vector3::new(80.0, 0.0, 0.001 - height)), "{height}");
                let beside = upright(95.0, -4.5 - height, -5.0, 4.5);
                assert!(
                    block.touches(&beside, &Vector3::new(-90.0, height + depth, 0.0)),
                    "{height} {depth}"
                );
                assert!(!block.touches(&beside, &Vector3::new(-90.0, height - 0.001, 0.0)), "{height}");
            }
        }
    }

    proptest! {
        /// The least distance of a moved cylinder from a block, by many places on its travel, is that of an interval and a disk.
        #[test]
        fn a_travel_touches_a_block_where_one_of_its_places_does(
            from in [-60.0..60.0_f64, -60.0..60.0, -30.0..30.0],
            along in [-120.0..120.0_f64, -120.0..120.0, -40.0..40.0],
            // Most travels are nearly level.
            flatness in prop_oneof![Just(1.0_f64), 0.0..0.1],
            radius in 0.1..15.0_f64,
        ) {
            let block =
                Surface::Block { min: Point3::new(-30.0, -20.0, -10.0), max: Point3::new(30.0, 20.0, 0.0) };
            let frustum = upright(from[0], from[1], from[2], radius);
            let along = [along[0], along[1], along[2] * flatness];
            let beyond = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
            let distance = |step: i32| {
                let [x, y, z] = std::array::from_fn(|i| from[i] + along[i] * f64::from(step) / 4000.0);
                let aside = libm::hypot(beyond(x, -30.0, 30.0), beyond(y, -20.0, 20.0)) - radius;
                aside.max(beyond(z, -20.0, 0.0))
            };
            let least = (0..=4000).map(distance).fold(f64::INFINITY, f64::min);
            let touches = block.touches(&frustum, &Vector3::from(along));
            if least <= 0.0 {
                prop_assert!(touches);
            } else if 0.01 < least {
                prop_assert!(!touches, "{least}");
            }
        }
    }

    /// A cylinder of 6 over an ellipsoid of 20 by 10 touches its flank with its rim: at y 3 the flank has the radius
    /// 20·SQRT[1-0.09] = 19.0788.
    #[test]
    fn the_rim_touches_a_flank() {
        let body = Surface::Ellipsoid { a: 20.0, b: 10.0 };
        let over = |x: f64| Frustum {
            base: Point3::new(x, 3.0, 0.0),
            axis: Vector3::y_axis(),
            length: 10.0,
            taper: Taper::cylinder(3.0),
        };
        assert!(body.touches(&over(22.078), &Vector3::zeros()));
        assert!(!body.touches(&over(22.080), &Vector3::zeros()));
    }

    /// A cone of 90° with its tip at z −5 is 5 wide at z 0: beside a block that ends at x 0 its side is (x − 5)/SQRT[2] away,
    /// and swept along y it is the same. A point 3 above the tip on the axis is inside.
    #[test]
    fn a_cone_touches_an_edge_with_its_side() {
        let block =
            Surface::Block { min: Point3::new(-50.0, -10.0, -20.0), max: Point3::new(0.0, 10.0, 0.0) };
        let cone = |x: f64, y: f64| Frustum {
            base: Point3::new(x, y, -5.0),
            axis: Vector3::z_axis(),
            length: 8.0,
            taper: Taper { radius: 0.0, slope: 1.0 },
        };
        assert!(block.touches(&cone(4.999, 0.0), &Vector3::zeros()));
        assert!(!block.touches(&cone(5.001, 0.0), &Vector3::zeros()));
        assert!(block.touches(&cone(4.999, -40.0), &Vector3::new(0.0, 80.0, 0.0)));
        assert!(!block.touches(&cone(5.001, -40.0), &Vector3::new(0.0, 80.0, 0.0)));
        assert!(!block.touches(&cone(4.0, -40.0), &Vector3::new(0.0, 25.0, 0.0)));
        let projected = |p: [f64; 3]| cone(0.0, 0.0).project(&Point3::from(p));
        assert_eq!(projected([0.0, 1.0, -2.0]), Point3::new(0.0, 1.0, -2.0));
        assert_eq!(projected([4.0, 0.0, -5.0]), Point3::new(2.0, 0.0, -3.0));
        assert_eq!(projected([9.0, 0.0, 4.0]), Point3::new(8.0, 0.0, 3.0));
        assert_eq!(projected([-1.0, -1.0, -9.0]), Point3::new(0.0, 0.0, -5.0));
        assert_eq!(projected([2.0, 0.0, 7.0]), Point3::new(2.0, 0.0, 3.0));
    }
}
