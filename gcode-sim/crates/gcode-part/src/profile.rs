//! Tooth bottom of a burr as a body of revolution: distances, normals and meridians.
use nalgebra::{Point3, Unit, Vector2, Vector3};

use super::surface::bisect;
use crate::job::{BurrShape, Nose};
use gcode_lang::units::Deg;

/// Body of revolution about x with the tip towards −x; the cylinder ends at x = 0. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    radius: f64,
    /// Arcs of the nose in the half plane (x, distance from the axis), from the cylinder to the tip.
    arcs: [Circle; 2],
}

/// A circle in the half plane (x, distance from the axis).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Circle {
    centre: Vector2<f64>,
    radius: f64,
}

impl Profile {
    /// Builds the profile of a burr.
    pub fn new(shape: &BurrShape) -> Self {
        let radius = shape.radius;
        let arcs = match shape.nose {
            Nose::Ball => [Circle { centre: Vector2::zeros(), radius }; 2],
            Nose::Arcs { large, small } => {
                // The cylinder's line is tangent to the large circle at its end.
                let first = Circle { centre: Vector2::new(0.0, radius - large), radius: large };
                // A circle centred on the axis touches the large one from inside where the distance of the
                // centres is the difference of the radii; bisection along the axis.
                let inside = |x: f64| (Vector2::new(x, 0.0) - first.centre).norm() + small < large;
                let aside = bisect(0.0, large, |aside| !inside(-aside));
                [first, Circle { centre: Vector2::new(-aside, 0.0), radius: small }]
            }
        };
        Self { radius, arcs }
    }

    /// Returns the radius of the cylinder.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the x of the tip.
    pub fn pole(&self) -> f64 {
        let last = self.arcs[1];
        last.centre.x - last.radius
    }

    /// Returns the circle of a point beyond the cylinder; the arcs meet on the line through both centres.
    fn circle(&self, at: Vector2<f64>) -> Circle {
        let [first, second] = self.arcs;
        let between = second.centre - first.centre;
        let out = at - first.centre;
        // True on the tip's side of that line.
        let beyond = 0.0 < between.x * out.y - between.y * out.x;
        if beyond || between.norm() == 0.0 { second } else { first }
    }

    /// Returns the distance of `p` from the surface, mm; negative inside.
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        let at = half_plane(p);
        if at.x >= 0.0 {
            return at.y - self.radius;
        }
        let circle = self.circle(at);
        (at - circle.centre).norm() - circle.radius
    }

    /// Returns the point of the surface nearest to `p`.
    pub fn foot(&self, p: &Point3<f64>) -> Point3<f64> {
        p - self.normal(p).into_inner() * self.distance(p)
    }

    /// Returns the outward unit normal at the point of the surface nearest to `p`.
    pub fn normal(&self, p: &Point3<f64>) -> Unit<Vector3<f64>> {
        let at = half_plane(p);
        let out = if at.x >= 0.0 { Vector2::y() } else { (at - self.circle(at).centre).normalize() };
        Unit::new_normalize(Vector3::x() * out.x + radial(p) * out.y)
    }

    /// Returns the direction of the meridian at `p`, towards the tip, and the direction around the axis that
    /// makes a right-hand flute with it.
    pub fn directions(&self, p: &Point3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let around = radial(p).cross(&Vector3::x());
        (self.normal(p).cross(&around), around)
    }

    /// Returns the polar angle of the normal at `p`, measured from the tip: 90° on the cylinder.
    pub fn polar(&self, p: &Point3<f64>) -> Deg {
        let normal = self.normal(p);
        Deg::atan2(libm::hypot(normal.y, normal.z), -normal.x)
    }

    /// Returns the point of the surface whose normal has this polar angle, in the plane z = 0 with y below 0.
    pub fn point_at_polar(&self, polar: Deg) -> Point3<f64> {
        let out = Vector2::new(-polar.cos(), polar.sin());
        let there = |circle: Circle| circle.centre + out * circle.radius;
        let [first, second] = self.arcs.map(there);
        // The outermost point of a convex body in that direction.
        let own = self.circle(first) == self.arcs[0];
        let at = if own { first } else { second };
        Point3::new(at.x, -at.y, 0.0)
    }
}

/// Returns the coordinates in the half plane: x, and the distance from the axis.
fn half_plane(p: &Point3<f64>) -> Vector2<f64> {
    Vector2::new(p.x, libm::hypot(p.y, p.z))
}

/// Returns the unit vector away from the axis; −y for a point on the axis.
fn radial(p: &Point3<f64>) -> Vector3<f64> {
    Vector3::new(0.0, p.y, p.z).try_normalize(0.0).unwrap_or(-Vector3::y())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(nose: Nose) -> BurrShape {
        BurrShape { radius: 6.0, length: 25.0, nose, tip_angle: 5.0, tooth_depth: 0.0 }
    }

    #[test]
    fn a_cylinder_with_a_half_ball() {
        let profile = Profile::new(&shape(Nose::Ball));
        let cases = [
            ([10.0, 0.0, 6.5], 0.5, 90.0),
            ([3.0, -5.0, 0.0], -1.0, 90.0),
            // 3-4-5: 7.5 from the centre; its normal is (−0.6, 0.8).
            ([-4.5, 6.0, 0.0], 1.5, 53.130_102_354_155_98),
            ([-6.0, 0.0, 0.0], 0.0, 0.0),
        ];
        for (p, distance, polar) in cases {
            let p = Point3::from(p);
            assert!((profile.distance(&p) - distance).abs() < 1e-12, "{p}");
            assert!((profile.polar(&p).0 - polar).abs() < 1e-9, "{p}: {:?}", profile.polar(&p));
        }
        assert_eq!(profile.pole(), -6.0);
    }

    /// Radii 14 and 4: centres (0, −8) and (−6, 0), meeting at (−8.4, 3.2), where the normal is (−0.6, 0.8).
    #[test]
    fn two_arcs_worked_by_hand() {
        let profile = Profile::new(&shape(Nose::Arcs { large: 14.0, small: 4.0 }));
        assert!((profile.pole() + 10.0).abs() < 1e-12, "{}", profile.pole());
        let cases = [
            // On the large arc, on the line from its centre through (−7, 16.124…): 1 outside.
            ([-15.0 * 0.28, 15.0 * 0.96 - 8.0, 0.0], 1.0),
            ([-8.4, 0.0, -3.2], 0.0),
            ([-6.0 - 5.0 * 0.8, 5.0 * 0.6, 0.0], 1.0),
            ([-9.5, 0.0, 0.0], -0.5),
        ];
        for (p, distance) in cases {
            let p = Point3::from(p);
            assert!((profile.distance(&p) - distance).abs() < 1e-12, "{p}: {}", profile.distance(&p));
        }
        let junction = profile.point_at_polar(Deg(53.130_102_354_155_98));
        assert!((junction - Point3::new(-8.4, -3.2, 0.0)).norm() < 1e-9, "{junction}");
        let small = profile.point_at_polar(Deg(30.0));
        assert!((small - Point3::new(-6.0 - 4.0 * 0.75f64.sqrt(), -2.0, 0.0)).norm() < 1e-9, "{small}");
    }

    #[test]
    fn right_hand_is_the_direction_of_a_screw() {
        let profile = Profile::new(&shape(Nose::Ball));
        let (tip, around) = profile.directions(&Point3::new(5.0, -6.0, 0.0));
        assert!((tip + Vector3::x()).norm() < 1e-12, "{tip}");
        // A right-hand screw thread rotates right-handed about x towards +x, so towards −x it rotates the
        // other way: from −y towards +z.
        assert!((around - Vector3::z()).norm() < 1e-12, "{around}");
    }
}
