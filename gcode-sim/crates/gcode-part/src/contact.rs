//! Contact of a moved cylinder with a convex body.
use nalgebra::{Point3, Vector3};

use super::solid::Rod;
use super::surface::Surface;

/// Distance that counts as contact, mm.
const CONTACT: f64 = 1e-6;

/// Largest number of projections onto the body.
const MAX_PROJECTIONS: u32 = 400;

impl Surface {
    /// Returns true if a cylinder touches the body while it moves by `along`.
    ///
    /// Body and swept cylinder are convex: alternating projections onto them converge to their nearest points (von
    /// Neumann). A plane between them proves that they do not meet.
    pub fn touches(&self, rod: &Rod, along: &Vector3<f64>) -> bool {
        let mut p = rod.base;
        for _ in 0..MAX_PROJECTIONS {
            let nearest = self.nearest(&p);
            if nearest.distance <= CONTACT {
                return true;
            }
            let foot = p - nearest.normal.into_inner() * nearest.distance;
            let least = rod.least_along(&nearest.normal) + along.dot(&nearest.normal).min(0.0);
            if foot.coords.dot(&nearest.normal) + CONTACT < least {
                return false;
            }
            let t = Self::Rod(*rod).nearest_between(&foot, &(foot - along));
            p = rod.project(&(foot - along * t)) + along * t;
        }
        false
    }
}

impl Rod {
    /// Returns the least coordinate of the cylinder in a direction.
    fn least_along(&self, direction: &Vector3<f64>) -> f64 {
        let along = self.axis.dot(direction);
        let across = (direction - self.axis.into_inner() * along).norm();
        self.base.coords.dot(direction) + (self.length * along).min(0.0) - self.radius * across
    }

    /// Returns the point of the cylinder that is nearest to `p`.
    fn project(&self, p: &Point3<f64>) -> Point3<f64> {
        let nearest = self.nearest(p);
        p - nearest.normal.into_inner() * nearest.distance.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn upright(x: f64, y: f64, z: f64, radius: f64) -> Rod {
        Rod { base: Point3::new(x, y, z), axis: Vector3::z_axis(), length: 10.0, radius }
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
        let pin = Surface::Rod(Rod { length: 20.0, ..upright(4.0, 0.0, -20.0, 1.0) });
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

    /// A cylinder of 6 over an ellipsoid of 20 by 10 touches its flank with its rim: at y 3 the flank has the radius
    /// 20·SQRT[1-0.09] = 19.0788.
    #[test]
    fn the_rim_touches_a_flank() {
        let body = Surface::Ellipsoid { a: 20.0, b: 10.0 };
        let over = |x: f64| Rod {
            base: Point3::new(x, 3.0, 0.0),
            axis: Vector3::y_axis(),
            length: 10.0,
            radius: 3.0,
        };
        assert!(body.touches(&over(22.078), &Vector3::zeros()));
        assert!(!body.touches(&over(22.080), &Vector3::zeros()));
    }
}
