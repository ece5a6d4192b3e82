//! Surface of the part as an implicit function: intersections, depths and distances from its values and
//! gradients.
use nalgebra::{Point3, Unit, Vector3};

use super::solid::{Rod, Taper, block_exit, block_face, block_span};
use super::travel_shares::{either, sag, shares_between, shares_within};

/// A convex body; lengths in mm, in the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// Ellipsoid of revolution about y.
    Ellipsoid {
        /// Equatorial radius.
        a: f64,
        /// Polar radius.
        b: f64,
    },
    /// Cylinder of unlimited length about x; the space beyond its ends is unknown.
    Cylinder {
        /// Radius of the cylinder.
        radius: f64,
    },
    /// Box with edges along the axes.
    Block {
        /// Corner with the least coordinates.
        min: Point3<f64>,
        /// Corner with the greatest coordinates.
        max: Point3<f64>,
    },
    /// Cylinder of limited length.
    Rod(Rod),
}

impl Surface {
    /// Returns the implicit function: negative inside, 0 on the surface, positive outside.
    pub fn value(&self, p: &Point3<f64>) -> f64 {
        match *self {
            Self::Ellipsoid { a, b } => {
                let (x, y, z) = (p.x / a, p.y / b, p.z / a);
                x * x + y * y + z * z - 1.0
            }
            Self::Cylinder { radius } => (p.y * p.y + p.z * p.z) / (radius * radius) - 1.0,
            Self::Block { min, max } => block_face(&min, &max, p).0,
            Self::Rod(rod) => rod.face(p).0,
        }
    }

    /// Returns the gradient of [`Self::value`].
    pub fn gradient(&self, p: &Point3<f64>) -> Vector3<f64> {
        match *self {
            Self::Ellipsoid { a, b } => {
                Vector3::new(2.0 * p.x / (a * a), 2.0 * p.y / (b * b), 2.0 * p.z / (a * a))
            }
            Self::Cylinder { radius } => Vector3::new(0.0, 2.0 * p.y, 2.0 * p.z) / (radius * radius),
            Self::Block { min, max } => block_face(&min, &max, p).1,
            Self::Rod(rod) => rod.face(p).1,
        }
    }

    /// Returns the outward unit normal; `None` where the gradient vanishes, as in the centre.
    pub fn normal(&self, p: &Point3<f64>) -> Option<Unit<Vector3<f64>>> {
        Unit::try_new(self.gradient(p), f64::MIN_POSITIVE)
    }

    /// Returns the depth of a point below the surface along the gradient there, mm.
    ///
    /// It is the exact distance for a sphere, near the surface and on an axis of the body. Outside it is
    /// negative and correct to first order.
    pub fn depth(&self, p: &Point3<f64>) -> f64 {
        let value = self.value(p);
        let out = || self.normal(p).unwrap_or(Vector3::y_axis());
        match (value < 0.0).then(|| self.exit(p, &out())).flatten() {
            Some(exit) => (exit - p).norm(),
            None => -value / self.gradient(p).norm(),
        }
    }

    /// Returns true if a point is deeper than `than` mm in the sense of [`Self::depth`]: moved outwards by
    /// that much it is still inside.
    pub fn is_deeper(&self, p: &Point3<f64>, than: f64) -> bool {
        let beyond = || p + self.normal(p).unwrap_or(Vector3::y_axis()).into_inner() * than;
        self.value(p) < 0.0 && self.value(&beyond()) < 0.0
    }

    /// Returns the point where a line leaves the body towards `out`; `None` if it misses the body.
    pub fn exit(&self, on: &Point3<f64>, out: &Unit<Vector3<f64>>) -> Option<Point3<f64>> {
        let at = |t: f64| on + out.into_inner() * t;
        if let Self::Block { min, max } = self {
            return block_exit(min, max, on, out).map(at);
        }
        // From a point inside the body a line has one exit.
        let inside = if self.value(on) < 0.0 { 0.0 } else { self.innermost(on, out) };
        // A tangent line meets the body: the remaining value is rounding.
        if self.value(&at(inside)) > 1e-12 {
            return None;
        }
        let beyond = grow_until(inside, 1.0, |t| self.value(&at(t)) > 0.0);
        Some(at(find_zero(inside, beyond, |t| self.value(&at(t)))))
    }

    /// Returns the shares of a straight travel between which it is in the body, deeper than `skin`; a negative skin is
    /// outside.
    pub fn piece(&self, from: &Point3<f64>, to: &Point3<f64>, skin: f64) -> Option<[f64; 2]> {
        let along = to - from;
        match *self {
            Self::Ellipsoid { a, b } => {
                let scale = Vector3::new(a - skin, b - skin, a - skin);
                shares_within(
                    [0.0, 1.0],
                    from.coords.component_div(&scale),
                    along.component_div(&scale),
                    (1.0, 0.0),
                )
            }
            Self::Cylinder { radius } => {
                let across = |v: Vector3<f64>| Vector3::new(0.0, v.y, v.z);
                shares_within([0.0, 1.0], across(from.coords), across(along), (radius - skin, 0.0))
            }
            Self::Block { min, max } => (0..3).try_fold([0.0, 1.0], |shares, i| {
                shares_between(shares, (from[i], along[i]), (min[i] + skin, max[i] - skin))
            }),
            Self::Rod(rod) => {
                rod.piece(from, to, (skin, rod.length - skin), Taper::cylinder(rod.radius - skin))
            }
        }
    }

    /// Returns shares of two travels outside which no point between them is in the body, deeper than `skin`. Near an edge of the
    /// body, and by their distance, they may be too many.
    pub fn span(&self, travels: [&[Point3<f64>; 2]; 2], skin: f64) -> Option<[f64; 2]> {
        let radius = match *self {
            Self::Block { min, max } => {
                let skin = Vector3::repeat(skin);
                return block_span(&(min + skin), &(max - skin), travels);
            }
            Self::Rod(rod) => return rod.span(travels, (skin, rod.length - skin), rod.radius - skin),
            Self::Ellipsoid { a, b } => a.min(b) * a.min(b) / a.max(b),
            Self::Cylinder { radius } => radius,
        };
        let skin = skin - sag(travels, radius);
        either(travels, |[from, to]| self.piece(from, to, skin))
    }

    /// Returns true for a body with flat faces, as stock has it.
    pub fn has_flat_faces(&self) -> bool {
        matches!(self, Self::Block { .. } | Self::Rod(_))
    }

    /// Returns the corners of a box that holds the body; they may be infinitely far.
    pub fn bounds(&self) -> [Point3<f64>; 2] {
        let about_origin = |half: Vector3<f64>| [Point3::from(-half), Point3::from(half)];
        match *self {
            Self::Ellipsoid { a, b } => about_origin(Vector3::new(a, b, a)),
            Self::Cylinder { radius } => about_origin(Vector3::new(f64::INFINITY, radius, radius)),
            Self::Block { min, max } => [min, max],
            Self::Rod(rod) => {
                let end = rod.base + rod.axis.into_inner() * rod.length;
                let margin = rod.axis.map(|along| rod.radius * (1.0 - along * along).max(0.0).sqrt());
                [rod.base.inf(&end) - margin, rod.base.sup(&end) + margin]
            }
        }
    }

    /// Returns true if rotation about this axis leaves the body unchanged, to rounding.
    pub fn is_round(&self, on: &Point3<f64>, about: &Unit<Vector3<f64>>) -> bool {
        let (own, centre, all) = match *self {
            Self::Ellipsoid { a, b } => (Vector3::y_axis(), Point3::origin(), a == b),
            Self::Cylinder { .. } => (Vector3::x_axis(), Point3::origin(), false),
            Self::Block { .. } => return false,
            Self::Rod(rod) => (rod.axis, rod.base, false),
        };
        let along = all || own.cross(about).norm() < 1e-12;
        along && (on - centre).cross(about).norm() < 1e-9
    }

    /// Returns a lower bound of the distance from a straight travel, mm; negative if the bound is not
    /// positive.
    ///
    /// For a convex function no value between two points is below both tangents, and the distance to a point
    /// of the body is at least the value over the slope.
    pub fn clearance(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        let along = to - from;
        let (low, high) = (self.value(from), self.value(to));
        let (at_from, at_to) = (self.gradient(from), self.gradient(to));
        let (falling, rising) = (at_from.dot(&along), at_to.dot(&along));
        let least = if falling >= 0.0 || rising <= 0.0 {
            low.min(high)
        } else {
            // Where the tangents low + falling·t and high − rising·(1 − t) meet.
            low + falling * ((high - low - rising) / (falling - rising))
        };
        least / at_from.norm().max(at_to.norm())
    }

    /// Returns the deepest point of a straight travel; for a travel that touches the body only at an end,
    /// that end.
    pub fn deepest_between(&self, from: &Point3<f64>, to: &Point3<f64>) -> Point3<f64> {
        let Some(along) = Unit::try_new(to - from, 1e-9) else { return *from };
        // The slope grows along the travel, because the body is convex.
        if self.gradient(from).dot(&along) >= 0.0 {
            return *from;
        }
        if self.gradient(to).dot(&along) <= 0.0 {
            return *to;
        }
        from + along.into_inner() * self.innermost(from, &along)
    }

    /// Returns the parameter of least value along a line. The slope changes sign there, once, because the
    /// body is convex.
    fn innermost(&self, on: &Point3<f64>, along: &Unit<Vector3<f64>>) -> f64 {
        let slope = |t: f64| self.gradient(&(on + along.into_inner() * t)).dot(along);
        let high = grow_until(0.0, 1.0, |t| slope(t) > 0.0);
        let low = grow_until(0.0, -1.0, |t| slope(t) <= 0.0);
        find_zero(low, high, slope)
    }
}

/// Returns the first of `from` + `step`·1, 2, 4, 8 … for which `reached` is true.
fn grow_until(from: f64, mut step: f64, reached: impl Fn(f64) -> bool) -> f64 {
    while !reached(from + step) && step.abs() < 1e12 {
        step *= 2.0;
    }
    from + step
}

/// Returns the point between `low` (value ≤ 0) and `high` (value > 0) where the value changes sign, to the
/// last bit.
///
/// The result is that of [`bisect`], in a few evaluations instead of fifty. Each step takes the zero of the
/// chord; the value at an end that stays is halved (the Illinois method). After forty chords the search
/// bisects.
fn find_zero(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let (mut below, mut above) = (value(low), value(high));
    let (mut was_above, mut chords) = (None, 40_u32);
    loop {
        let middle = low + (high - low) / 2.0;
        if middle <= low || middle >= high {
            return middle;
        }
        // If one end is the zero already, a step beside it moves the other end there.
        let least = 2.0 * f64::EPSILON * low.abs().max(high.abs());
        let chord = low - below * ((high - low) / (above - below));
        let by_chord = chords > 0 && high - low > 2.0 * least && chord.is_finite();
        let t = if by_chord { chord.clamp(low + least, high - least) } else { middle };
        chords = chords.saturating_sub(1);
        let at = value(t);
        let is_above = at > 0.0;
        let again = was_above == Some(is_above);
        if is_above {
            (high, above) = (t, at);
            below /= if again { 2.0 } else { 1.0 };
        } else {
            (low, below) = (t, at);
            above /= if again { 2.0 } else { 1.0 };
        }
        was_above = Some(is_above);
    }
}

/// Returns the point between `low` and `high` where `above` changes from false to true, to the last bit.
pub fn bisect(mut low: f64, mut high: f64, above: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = low + (high - low) / 2.0;
        if middle <= low || middle >= high {
            return middle;
        }
        if above(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_line_leaves_a_sphere_by_pythagoras() {
        let sphere = Surface::Ellipsoid { a: 5.0, b: 5.0 };
        let up = Vector3::y_axis();
        let exit = sphere.exit(&Point3::new(3.0, -80.0, 0.0), &up).unwrap();
        assert!((exit - Point3::new(3.0, 4.0, 0.0)).norm() < 1e-14, "{exit}");
        assert!(sphere.exit(&Point3::new(5.1, 0.0, 0.0), &up).is_none());
        let touching = sphere.exit(&Point3::new(5.0, 9.0, 0.0), &up).unwrap();
        assert!((touching - Point3::new(5.0, 0.0, 0.0)).norm() < 1e-6, "{touching}");
    }

    #[test]
    fn depth_is_the_distance_to_the_surface() {
        let sphere = Surface::Ellipsoid { a: 100.0, b: 100.0 };
        for (y, depth) in [(99.9, 0.1), (40.0, 60.0), (-97.0, 3.0), (0.0, 100.0)] {
            let found = sphere.depth(&Point3::new(0.0, y, 0.0));
            assert!((found - depth).abs() < 1e-9, "{found} at {y}");
        }
        let flat = Surface::Ellipsoid { a: 1000.0, b: 400.0 };
        assert!((flat.depth(&Point3::new(0.0, 322.0, 0.0)) - 78.0).abs() < 1e-9);
        assert!((sphere.depth(&Point3::new(0.0, 100.1, 0.0)) + 0.1).abs() < 1e-3);
    }

    proptest! {
        #[test]
        fn deeper_than_is_asked_as_depth_counts(
            (a, b) in (1.0..300.0f64, 1.0..300.0f64),
            (x, y, z) in (-1.2..1.2f64, -1.2..1.2f64, -1.2..1.2f64),
            than in 0.0..20.0f64,
        ) {
            let p = Point3::new(x * a, y * b, z * a);
            for surface in [Surface::Ellipsoid { a, b }, Surface::Cylinder { radius: a }] {
                let depth = surface.depth(&p);
                prop_assume!((depth - than).abs() > 1e-9);
                prop_assert_eq!(surface.is_deeper(&p, than), than < depth);
            }
        }
    }

    #[test]
    fn a_way_past_the_body_is_deepest_in_its_middle() {
        let sphere = Surface::Ellipsoid { a: 10.0, b: 10.0 };
        let (from, to) = (Point3::new(-20.0, 6.0, 0.0), Point3::new(30.0, 6.0, 0.0));
        assert!((sphere.deepest_between(&from, &to) - Point3::new(0.0, 6.0, 0.0)).norm() < 1e-6);
        let away = Point3::new(0.0, 10.0, 0.0);
        assert_eq!(sphere.deepest_between(&away, &Point3::new(0.0, 50.0, 0.0)), away);
    }

    proptest! {
        #[test]
        fn chords_lead_where_halves_do(a in 0.0..1e-3, b in -1.0..1.0, c in 0.0..1.0) {
            let value = |t: f64| a * t * t + b * t - c;
            let high = grow_until(0.0, 1.0, |t| value(t) > 0.0);
            prop_assume!(value(high) > 0.0);
            let steps = std::cell::Cell::new(0);
            let by_chords = find_zero(0.0, high, |t| {
                steps.set(steps.get() + 1);
                value(t)
            });
            let by_halves = bisect(0.0, high, |t| value(t) > 0.0);
            prop_assert!((by_chords - by_halves).abs() <= 1e-12 * high.max(1.0), "{by_chords} {by_halves}");
            prop_assert!(steps.get() <= 45, "{} steps", steps.get());
        }

        /// The lower bound is never too large: no point of the body is nearer.
        #[test]
        fn clearance_is_kept(
            (a, b) in (1.0..50.0, 1.0..50.0f64),
            ends in prop::array::uniform6(-120.0..120.0),
            (t, latitude, azimuth) in (0.0..1.0, -1.57..1.57, -4.0..4.0f64),
        ) {
            let (a, b): (f64, f64) = (a, b);
            let surface = Surface::Ellipsoid { a, b };
            let (from, to) = (Point3::new(ends[0], ends[1], ends[2]), Point3::new(ends[3], ends[4], ends[5]));
            let r = a * libm::cos(latitude);
            let body = Point3::new(r * libm::cos(azimuth), b * libm::sin(latitude), r * libm::sin(azimuth));
            let on_travel: Point3<f64> = from + (to - from) * t;
            prop_assert!(surface.clearance(&from, &to) <= (on_travel - body).norm() + 1e-9);
        }

        /// A line through a point of the surface at a given latitude leaves the body there.
        #[test]
        fn a_line_is_left_at_the_point_it_was_laid_through(
            (a, b) in (1.0..2000.0, 1.0..2000.0),
            (latitude, azimuth) in (0.01..1.57, -9.0..9.0f64),
        ) {
            let (a, b): (f64, f64) = (a, b);
            let surface = Surface::Ellipsoid { a, b };
            let r = a * libm::cos(latitude);
            let p = Point3::new(r * libm::cos(azimuth), b * libm::sin(latitude), r * libm::sin(azimuth));
            let exit = surface.exit(&Point3::new(p.x, 0.0, p.z), &Vector3::y_axis()).unwrap();
            prop_assert!((exit - p).norm() < 1e-9 * a.max(b), "{} {}", exit, p);
        }
    }
}
