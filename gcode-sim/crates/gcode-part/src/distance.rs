//! Exact distance of a point from the part's surface, and the direction of the nearest point.
use nalgebra::{Point3, Unit, Vector3};

use super::solid::{NearestPoint, block_nearest};
use super::surface::{Surface, bisect};

impl Surface {
    /// Returns the distance of `p` from the surface and the normal at its nearest point.
    pub fn nearest(&self, p: &Point3<f64>) -> NearestPoint {
        match *self {
            Self::Ellipsoid { a, b } => nearest_on_ellipsoid(a, b, p),
            Self::Cylinder { radius } => {
                let out = Vector3::new(0.0, p.y, p.z);
                let normal = Unit::try_new(out, f64::MIN_POSITIVE).unwrap_or(Vector3::y_axis());
                NearestPoint { distance: out.norm() - radius, normal }
            }
            Self::Block { min, max } => block_nearest(&min, &max, p),
            Self::Rod(rod) => rod.nearest(p),
        }
    }

    /// Returns the fraction, 0 to 1, of a straight travel at which the surface is nearest.
    ///
    /// Along a line the distance from a convex body is a convex function: it falls up to that point and rises
    /// after it.
    pub fn nearest_between(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        let along = to - from;
        let leaving = |t: f64| self.nearest(&(from + along * t)).normal.dot(&along) >= 0.0;
        match (leaving(0.0), leaving(1.0)) {
            (true, _) => 0.0,
            (false, true) => bisect(0.0, 1.0, leaving),
            (false, false) => 1.0,
        }
    }
}

/// Returns the nearest point of an ellipsoid of revolution about y with semi-axes `a` and `b`.
///
/// The foot q of the perpendicular satisfies p − q = t·(q.x/a², q.y/b², q.z/a²), so q.x = p.x·a²/(a² + t) and
/// so on. The condition that q lies on the surface is one equation for t whose left side falls as t grows;
/// the nearest foot is its largest root.
///
/// The equation is solved for s = t + m², m the smaller semi-axis: that loses no digits where s is small,
/// deep inside.
fn nearest_on_ellipsoid(a: f64, b: f64, p: &Point3<f64>) -> NearestPoint {
    let m = a.min(b);
    let (round, along) = (a * a - m * m, b * b - m * m);
    let rho = libm::hypot(p.x, p.z);
    let outside = |s: f64| {
        let (x, y) = (a * rho / (s + round), b * p.y / (s + along));
        x * x + y * y <= 1.0
    };
    let short = if a <= b { rho } else { p.y.abs() };
    let s = bisect(m * short, libm::hypot(a * rho, b * p.y).max(f64::MIN_POSITIVE), outside);
    let t = s - m * m;
    // p − q is t times this slope.
    let slope = Vector3::new(p.x / (s + round), p.y / (s + along), p.z / (s + round));
    match Unit::try_new_and_get(slope, 1e-9 / m) {
        Some((normal, length)) if !is_on_long_axis(s, m, short) => {
            NearestPoint { distance: t * length, normal }
        }
        _ => nearest_from_long_axis(a, b, p),
    }
}

/// Returns true between the centres of curvature on the long axis, where two feet are equally near and the
/// equation has no root above 0.
fn is_on_long_axis(s: f64, m: f64, short: f64) -> bool {
    s < 1e-9 * m * m && short < 1e-9 * m
}

/// Returns the nearest point for a point on the long axis, deep inside the body.
///
/// For a flat body (b < a) the long axis is any line of the equatorial plane. The nearest foot lies to the
/// side: its coordinate along the long axis is p·l²/(l² − m²).
fn nearest_from_long_axis(a: f64, b: f64, p: &Point3<f64>) -> NearestPoint {
    let flat = b < a;
    let (long, m) = if flat { (a, b) } else { (b, a) };
    let far = if flat { libm::hypot(p.x, p.z) } else { p.y.abs() };
    let gap = long * long - m * m;
    let foot = if gap > 0.0 { far * long * long / gap } else { 0.0 };
    let height = m * (1.0 - (foot / long) * (foot / long)).max(0.0).sqrt();
    let along = if far > 0.0 {
        if flat { Vector3::new(p.x, 0.0, p.z) / far } else { Vector3::new(0.0, p.y / far, 0.0) }
    } else {
        Vector3::zeros()
    };
    let side = if flat { Vector3::y() } else { Vector3::x() };
    let out = along * (foot / (long * long)) + side * (height / (m * m));
    NearestPoint { distance: -libm::hypot(foot - far, height), normal: Unit::new_normalize(out) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn on_the_axes_the_distance_is_a_difference_of_radii() {
        let body = Surface::Ellipsoid { a: 1000.0, b: 400.0 };
        for (p, distance, normal) in [
            ([0.0, 403.0, 0.0], 3.0, [0.0, 1.0, 0.0]),
            ([0.0, 399.5, 0.0], -0.5, [0.0, 1.0, 0.0]),
            ([0.0, -410.0, 0.0], 10.0, [0.0, -1.0, 0.0]),
            ([1003.0, 0.0, 0.0], 3.0, [1.0, 0.0, 0.0]),
            ([0.0, 0.0, -1003.0], 3.0, [0.0, 0.0, -1.0]),
            ([0.0, 0.0, 0.0], -400.0, [0.0, 1.0, 0.0]),
        ] {
            let found = body.nearest(&Point3::from(p));
            assert!((found.distance - distance).abs() < 1e-9, "{p:?}: {found:?}");
            assert!((found.normal.into_inner() - Vector3::from(normal)).norm() < 1e-9, "{p:?}: {found:?}");
        }
        let sphere = Surface::Ellipsoid { a: 5.0, b: 5.0 };
        assert!((sphere.nearest(&Point3::new(3.0, 4.0, 12.0)).distance - 8.0).abs() < 1e-12, "√169 − 5");
        let tall = Surface::Ellipsoid { a: 300.0, b: 900.0 };
        assert!((tall.nearest(&Point3::origin()).distance + 300.0).abs() < 1e-9);
        let cylinder = Surface::Cylinder { radius: 50.0 };
        let found = cylinder.nearest(&Point3::new(7.0, 30.0, -40.5));
        assert!((found.distance - (libm::hypot(30.0, 40.5) - 50.0)).abs() < 1e-12);
    }

    #[test]
    fn a_travel_past_the_body_is_nearest_abeam() {
        let sphere = Surface::Ellipsoid { a: 10.0, b: 10.0 };
        let nearest = |from: [f64; 3], to: [f64; 3]| sphere.nearest_between(&from.into(), &to.into());
        assert!((nearest([-20.0, 12.0, 0.0], [30.0, 12.0, 0.0]) - 0.4).abs() < 1e-12);
        assert_eq!(nearest([1.0, 12.0, 0.0], [30.0, 12.0, 0.0]), 0.0);
        assert_eq!(nearest([-20.0, 12.0, 0.0], [-1.0, 12.0, 0.0]), 1.0);
    }

    proptest! {
        /// A point moved along a surface normal has that distance: always outside, and inside up to the
        /// smallest radius of curvature.
        #[test]
        fn along_the_normal_the_distance_is_the_travel(
            (a, b) in (1.0..2000.0, 1.0..2000.0f64),
            (latitude, azimuth) in (-1.57..1.57, -4.0..4.0f64),
            part in -0.99..3.0f64,
        ) {
            let (a, b): (f64, f64) = (a, b);
            let surface = Surface::Ellipsoid { a, b };
            let r = a * libm::cos(latitude);
            let foot = Point3::new(r * libm::cos(azimuth), b * libm::sin(latitude), r * libm::sin(azimuth));
            let normal = surface.normal(&foot).unwrap();
            // The curvature radii of an ellipsoid are at least (short axis)²/(long axis).
            let least = a.min(b) * a.min(b) / a.max(b);
            let gone = part * least;
            let found = surface.nearest(&(foot + normal.into_inner() * gone));
            prop_assert!((found.distance - gone).abs() < 1e-9 * a.max(b), "{:?} for {}", found, gone);
            prop_assert!((found.normal.into_inner() - normal.into_inner()).norm() < 1e-6, "{:?}", found);
        }

        /// No other point of the surface is nearer.
        #[test]
        fn no_other_point_is_nearer(
            (a, b) in (1.0..50.0, 1.0..50.0f64),
            p in prop::array::uniform3(-80.0..80.0f64),
            (latitude, azimuth) in (-1.57..1.57, -4.0..4.0f64),
        ) {
            let (a, b): (f64, f64) = (a, b);
            let surface = Surface::Ellipsoid { a, b };
            let r = a * libm::cos(latitude);
            let other = Point3::new(r * libm::cos(azimuth), b * libm::sin(latitude), r * libm::sin(azimuth));
            let p = Point3::from(p);
            let found = surface.nearest(&p);
            prop_assert!(found.distance.abs() <= (p - other).norm() + 1e-9);
            let foot = p - found.normal.into_inner() * found.distance;
            prop_assert!(surface.value(&foot).abs() < 1e-9, "the foot is on the surface: {:?}", found);
        }
    }
}
