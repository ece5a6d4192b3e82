//! Straight lines and arcs of a contour with their parallels, and intersections of these.
use super::{Point, SAME_DIRECTION, cross, left_normal};
use gcode_lang::units::Deg;

/// Shortest length that counts, mm.
const MIN_LENGTH: f64 = 1e-9;

/// Element of a contour. The end of an arc may deviate slightly from its radius, as on a control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Segment {
    Line {
        from: Point,
        to: Point,
    },
    Arc {
        from: Point,
        to: Point,
        centre: Point,
        /// Angle swept; positive is counterclockwise.
        sweep: Deg,
    },
}

impl Segment {
    pub(crate) fn start(&self) -> Point {
        match *self {
            Self::Line { from, .. } | Self::Arc { from, .. } => from,
        }
    }

    pub(crate) fn end(&self) -> Point {
        match *self {
            Self::Line { to, .. } | Self::Arc { to, .. } => to,
        }
    }

    pub(crate) fn is_arc(&self) -> bool {
        matches!(self, Self::Arc { .. })
    }

    /// Returns the unit vector of the direction at the start.
    pub(crate) fn start_direction(&self) -> Point {
        self.direction(self.start())
    }

    /// Returns the unit vector of the direction at the end.
    pub(crate) fn end_direction(&self) -> Point {
        self.direction(self.end())
    }

    fn direction(&self, at: Point) -> Point {
        match *self {
            Self::Line { from, to } => (to - from).normalize(),
            Self::Arc { centre, sweep, .. } => left_normal(at - centre).normalize() * sweep.0.signum(),
        }
    }

    /// Returns the point at a distance to the left of the start.
    pub(crate) fn parallel_start(&self, distance: f64) -> Point {
        self.start() + left_normal(self.start_direction()) * distance
    }

    /// Returns the point at a distance to the left of the end.
    pub(crate) fn parallel_end(&self, distance: f64) -> Point {
        self.end() + left_normal(self.end_direction()) * distance
    }

    /// Returns true for an arc that is too small for a parallel at this distance.
    pub(crate) fn is_too_small(&self, distance: f64) -> bool {
        let Self::Arc { from, to, centre, sweep } = *self else { return false };
        [from, to].into_iter().any(|at| parallel_radius(centre, sweep, at, distance) < -MIN_LENGTH)
    }

    /// Returns true if a point lies on the parallel of an arc at its start; always true for a line.
    pub(crate) fn is_parallel_start(&self, point: Point, distance: f64) -> bool {
        match *self {
            Self::Line { .. } => true,
            Self::Arc { centre, from, sweep, .. } => {
                let radius = parallel_radius(centre, sweep, from, distance);
                ((point - centre).norm() - radius).abs() < 1e-6
            }
        }
    }

    /// Returns the line or circle that contains the parallel at the start of the segment.
    pub(super) fn curve_at_start(&self, distance: f64) -> Curve {
        self.curve(self.start(), distance)
    }

    /// Returns the line or circle that contains the parallel at the end of the segment.
    pub(super) fn curve_at_end(&self, distance: f64) -> Curve {
        self.curve(self.end(), distance)
    }

    fn curve(&self, at: Point, distance: f64) -> Curve {
        match *self {
            Self::Line { .. } => {
                let direction = self.start_direction();
                Curve::Line { point: at + left_normal(direction) * distance, direction }
            }
            // A followed arc has a negative radius by rounding only: see [`Segment::is_too_small`].
            Self::Arc { centre, sweep, .. } => {
                let radius = parallel_radius(centre, sweep, at, distance).max(0.0);
                Curve::Circle { centre, radius }
            }
        }
    }

    /// Returns true if the path from `start` to `end` on the parallel runs against the segment.
    pub(crate) fn is_reversed(&self, start: Point, end: Point, distance: f64) -> bool {
        match *self {
            Self::Line { .. } => self.start_direction().dot(end - start) < -MIN_LENGTH,
            Self::Arc { sweep, .. } => self.sweep_between(start, end, distance).0 * sweep.0.signum() < -1e-7,
        }
    }

    /// Returns the sweep of an arc's parallel between two points of it; 0 for a line.
    pub(crate) fn sweep_between(&self, start: Point, end: Point, distance: f64) -> Deg {
        let Self::Arc { centre, sweep, from, to } = *self else { return Deg::ZERO };
        let lost = |own: Point, new: Point| {
            // A parallel of radius 0 rotates through the angle of its arc.
            if parallel_radius(centre, sweep, own, distance) < MIN_LENGTH {
                return 0.0;
            }
            let (own, new) = (own - centre, new - centre);
            Deg::atan2(cross(own, new), own.dot(new)).0
        };
        let first = lost(from, start);
        let last = lost(to, end);
        Deg(sweep.0 - first + last)
    }

    /// Returns the segment up to a point on it; `None` if the point is outside the segment. A length of 0 is
    /// allowed.
    pub(super) fn ending_at(&self, end: Point) -> Option<Self> {
        match *self {
            Self::Line { from, to } => {
                let along = self.start_direction().dot(end - from);
                (-MIN_LENGTH..=(to - from).norm() + MIN_LENGTH)
                    .contains(&along)
                    .then_some(Self::Line { from, to: end })
            }
            Self::Arc { from, centre, sweep, .. } => {
                let new = self.sweep_between(from, end, 0.0);
                (new.0 * sweep.0 >= 0.0).then_some(Self::Arc { from, to: end, centre, sweep: new })
            }
        }
    }

    /// Returns the segment from a point on it; `None` if the point is outside the segment.
    pub(super) fn beginning_at(&self, start: Point) -> Option<Self> {
        self.reversed().ending_at(start).map(|segment| segment.reversed())
    }

    fn reversed(&self) -> Self {
        match *self {
            Self::Line { from, to } => Self::Line { from: to, to: from },
            Self::Arc { from, to, centre, sweep } => Self::Arc { from: to, to: from, centre, sweep: -sweep },
        }
    }

    /// Returns true if the segment is longer than [`MIN_LENGTH`].
    pub(crate) fn has_length(&self) -> bool {
        match *self {
            Self::Line { from, to } => (to - from).norm() > MIN_LENGTH,
            Self::Arc { from, centre, sweep, .. } => {
                (from - centre).norm() * sweep.abs().to_rad() > MIN_LENGTH
            }
        }
    }
}

/// Returns the radius of an arc's parallel at one of its ends; negative if the arc is too small.
fn parallel_radius(centre: Point, sweep: Deg, at: Point, distance: f64) -> f64 {
    (at - centre).norm() - distance * sweep.0.signum()
}

/// Infinite line or full circle.
#[derive(Clone, Copy, Debug)]
pub(super) enum Curve {
    Line {
        point: Point,
        /// Unit vector.
        direction: Point,
    },
    Circle {
        centre: Point,
        radius: f64,
    },
}

/// Largest gap at which two curves still touch: rounding of the computation.
const TOUCH_TOLERANCE: f64 = 1e-9;

/// Returns the intersection nearest to a point; `None` without an intersection.
pub(super) fn nearest_crossing(a: Curve, b: Curve, to: Point) -> Option<Point> {
    let all = crossings(a, b);
    let distance = |p: &Point| (*p - to).norm();
    all.into_iter().flatten().min_by(|p, q| distance(p).total_cmp(&distance(q)))
}

fn crossings(a: Curve, b: Curve) -> [Option<Point>; 2] {
    match (a, b) {
        (Curve::Line { point, direction }, Curve::Line { point: other, direction: along }) => {
            let sine = cross(direction, along);
            if sine.abs() < SAME_DIRECTION {
                return [None, None];
            }
            [Some(point + direction * (cross(other - point, along) / sine)), None]
        }
        (Curve::Line { point, direction }, Curve::Circle { centre, radius })
        | (Curve::Circle { centre, radius }, Curve::Line { point, direction }) => {
            let foot = point + direction * direction.dot(centre - point);
            chord_points(foot, direction, radius, (foot - centre).norm())
        }
        (Curve::Circle { centre, radius }, Curve::Circle { centre: other, radius: second }) => {
            let centre_offset = other - centre;
            let centre_distance = centre_offset.norm();
            if centre_distance < TOUCH_TOLERANCE {
                return [None, None];
            }
            let axis = centre_offset / centre_distance;
            // Distance from the first centre to the line through both intersections.
            let along = (centre_distance * centre_distance + radius * radius - second * second)
                / (2.0 * centre_distance);
            chord_points(centre + axis * along, left_normal(axis), radius, along.abs())
        }
    }
}

/// Returns the points of a circle on a line at distance `height` from its centre.
///
/// `foot` is the foot of the perpendicular from the centre.
fn chord_points(foot: Point, direction: Point, radius: f64, height: f64) -> [Option<Point>; 2] {
    if height > radius + TOUCH_TOLERANCE {
        return [None, None];
    }
    let half = ((radius - height) * (radius + height)).max(0.0).sqrt();
    [Some(foot + direction * half), Some(foot - direction * half)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quarter(sweep: f64) -> Segment {
        // From (10, 0) about the origin.
        let to = if sweep > 0.0 { Point::new(0.0, 10.0) } else { Point::new(0.0, -10.0) };
        Segment::Arc { from: Point::new(10.0, 0.0), to, centre: Point::default(), sweep: Deg(sweep) }
    }

    #[test]
    fn left_of_a_counterclockwise_arc_is_inside() {
        assert!((quarter(90.0).parallel_start(3.0) - Point::new(7.0, 0.0)).norm() < 1e-12);
        assert!((quarter(90.0).parallel_end(3.0) - Point::new(0.0, 7.0)).norm() < 1e-12);
        assert!((quarter(-90.0).parallel_start(3.0) - Point::new(13.0, 0.0)).norm() < 1e-12);
        assert!((quarter(-90.0).parallel_end(-3.0) - Point::new(0.0, -7.0)).norm() < 1e-12);
    }

    #[test]
    fn an_arc_is_too_small_inside_only() {
        assert!(quarter(90.0).is_too_small(10.1) && !quarter(90.0).is_too_small(10.0));
        assert!(!quarter(90.0).is_too_small(-99.0) && quarter(-90.0).is_too_small(-10.1));
    }

    #[test]
    fn a_shortened_parallel_sweeps_less() {
        let start = Point::new(7.0 * Deg(30.0).cos(), 7.0 * Deg(30.0).sin());
        let end = Point::new(0.0, 7.0);
        assert!((quarter(90.0).sweep_between(start, end, 3.0).0 - 60.0).abs() < 1e-9);
        assert!(!quarter(90.0).is_reversed(start, end, 3.0));
        let before = Point::new(7.0 * Deg(20.0).cos(), 7.0 * Deg(20.0).sin());
        assert!(quarter(90.0).is_reversed(start, before, 3.0));
    }

    #[test]
    fn a_full_circle_stays_full() {
        let (from, centre) = (Point::new(10.0, 0.0), Point::default());
        let circle = Segment::Arc { from, to: from, centre, sweep: Deg(-360.0) };
        let at = circle.parallel_start(-4.0);
        assert!((circle.sweep_between(at, at, -4.0).0 + 360.0).abs() < 1e-9);
    }

    fn point(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn a_line_and_a_circle_intersect_circles() {
        let circle = Curve::Circle { centre: point(0.0, 0.0), radius: 5.0 };
        let line = Curve::Line { point: point(3.0, -9.0), direction: point(0.0, 1.0) };
        assert_eq!(nearest_crossing(circle, line, point(0.0, 9.0)), Some(point(3.0, 4.0)));
        assert_eq!(nearest_crossing(line, circle, point(0.0, -9.0)), Some(point(3.0, -4.0)));
        let other = Curve::Circle { centre: point(6.0, 0.0), radius: 5.0 };
        assert_eq!(nearest_crossing(circle, other, point(0.0, 9.0)), Some(point(3.0, 4.0)));
    }

    #[test]
    fn separate_curves_do_not_intersect() {
        let circle = Curve::Circle { centre: point(0.0, 0.0), radius: 1.0 };
        let line = Curve::Line { point: point(2.0, 0.0), direction: point(0.0, 1.0) };
        let parallel = Curve::Line { point: point(3.0, 0.0), direction: point(0.0, -1.0) };
        assert_eq!(nearest_crossing(circle, line, point(0.0, 0.0)), None);
        assert_eq!(nearest_crossing(line, parallel, point(0.0, 0.0)), None);
    }
}
