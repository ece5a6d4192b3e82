//! Reading of a fixed indicator when an ellipsoid is tilted under it.
//!
//! Source: figure 5 of *Improved Processing Technology of Positioning Pin Hole on Melon Mold*.
use nalgebra::{Point3, Unit, Vector3};

use super::surface::Surface;
use gcode_lang::units::{Deg, Mm};

/// Change of an indicator's reading at (x, y, 0), measured along x, when the part is tilted about z through
/// its centre, x towards y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedEllipsoid {
    /// Distance of the surface from the axis of revolution before the tilt.
    pub radius: Mm,
    /// Exact outward displacement of the surface.
    pub change: Mm,
    /// First-order term, δ·y·(a²/b² − 1), δ in rad.
    pub first_order: Mm,
    /// Second-order term, δ²/2·(a²/b² − 1)·(y²·a²/b² − r²)/r, with r the radius. On the equator it is −(a²/b²
    /// − 1)·r·δ²/2.
    pub second_order: Mm,
}

/// Returns the change of an indicator's reading at height `y` for a tilt; `None` if the indicator passes
/// above or below the part.
///
/// For a sphere the change is 0, and for any part the first order is 0 at its equator: the sensitivity grows
/// with the distance from there.
pub fn tilted_ellipsoid(a: Mm, b: Mm, y: Mm, tilt: Deg) -> Option<TiltedEllipsoid> {
    let body = Surface::Ellipsoid { a: a.0, b: b.0 };
    // In the part's frame the indicator rotates in the opposite direction.
    let reach = |turned: Deg| {
        let (cos, sin) = (turned.cos(), turned.sin());
        let on = Point3::new(y.0 * sin, y.0 * cos, 0.0);
        let out = Unit::new_normalize(Vector3::new(cos, -sin, 0.0));
        body.exit(&on, &out).map(|found| (found - on).dot(&out))
    };
    let (radius, after) = (reach(Deg::ZERO)?, reach(tilt)?);
    let delta = tilt.to_rad();
    let flat = a.0 * a.0 / (b.0 * b.0);
    let bend = (flat - 1.0) * (y.0 * y.0 * flat - radius * radius) / radius;
    Some(TiltedEllipsoid {
        radius: Mm(radius),
        change: Mm(after - radius),
        first_order: Mm(delta * y.0 * (flat - 1.0)),
        second_order: Mm(delta * delta / 2.0 * bend),
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(a: f64, b: f64, y: f64, tilt: f64) -> TiltedEllipsoid {
        tilted_ellipsoid(Mm(a), Mm(b), Mm(y), Deg(tilt)).unwrap()
    }

    /// a = 1000, b = 500: a²/b² = 4, and 1° is 0.017 453 293.
    ///
    /// At y = 200 the radius is 1000·√(1 − 0.16) = 916.515 139. First order: 0.017 453 293·200·3. Second: 0.000 152 308 7·3·(4·40
    /// 000 − 840 000)/916.515 139. Exactly, from x²(cos² + 4 sin²) − 6·y·x·sin·cos + y²(sin² + 4 cos²) = 1000².
    /// Below the equator the sign is reversed. On the equator the first order is 0: 1000/√(1 + 3·sin² 1°) =
    /// 999.543 433. A tall part: a²/b² − 1 = −0.75.
    #[test]
    fn one_degree_worked_out_by_hand() {
        for (a, b, y, tilt, expected) in [
            (1000.0, 500.0, 200.0, 1.0, [916.515_139, 10.471_975_5, -0.339_012_2, 10.121_487_2]),
            (1000.0, 500.0, 200.0, -1.0, [916.515_139, -10.471_975_5, -0.339_012_2, -10.799_094_5]),
            (1000.0, 500.0, -200.0, 1.0, [916.515_139, -10.471_975_5, -0.339_012_2, -10.799_094_5]),
            (1000.0, 500.0, 0.0, 1.0, [1000.0, 0.0, -0.456_926_1, -0.456_566_9]),
            (500.0, 1000.0, 200.0, 1.0, [489.897_949, -2.617_993_9, 0.053_630_1, -2.564_426_9]),
        ] {
            let found = at(a, b, y, tilt);
            let found = [found.radius, found.first_order, found.second_order, found.change];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found.0 - expected).abs() < 5e-7, "{found:?} is not {expected}");
            }
        }
    }

    /// Figure 5: 1113.76 − 1113.41 = 0.35 mm at y = 200 for 1°. With a = 1133.267 and b = 1082.596, nearly a
    /// sphere, both radii result; with the proportions of a flatter dome the change is sixteen times as
    /// large.
    #[test]
    fn figure_5_is_a_possible_reading() {
        let tilt = at(1_133.266_655, 1_082.596_426, 200.0, -1.0);
        assert!((tilt.radius.0 - 1113.76).abs() < 1e-3 && (tilt.change.0 + 0.35).abs() < 1e-5, "{tilt:?}");
        let flat = at(1158.8, 724.3, 200.0, -1.0);
        assert!((flat.radius.0 - 1113.747).abs() < 1e-3 && (flat.change.0 + 5.683).abs() < 1e-3, "{flat:?}");
    }

    #[test]
    fn past_the_pole_there_is_no_reading() {
        assert_eq!(tilted_ellipsoid(Mm(1000.0), Mm(500.0), Mm(501.0), Deg(0.0)), None);
        assert_eq!(at(1000.0, 1000.0, 200.0, 5.0).first_order, Mm::ZERO);
    }

    proptest! {
        /// The remainder after both orders grows with the third power of the angle.
        #[test]
        fn the_orders_are_those_of_the_exact_change(
            (a, flatness) in (100.0..2000.0, 0.5..2.0f64),
            part in -0.6..0.6f64,
            tilt in -0.5..0.5f64,
        ) {
            let (a, b): (f64, f64) = (a, a / flatness);
            let found = at(a, b, part * b, tilt);
            let delta = tilt.to_radians();
            let rest = found.change.0 - found.first_order.0 - found.second_order.0;
            let third_order = delta.abs() * delta * delta;
            prop_assert!(rest.abs() < 40.0 * a * third_order + 1e-9 * a, "{} of {:?}", rest, found);
        }
    }
}
