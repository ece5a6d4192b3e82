//! Intersections of lines and circles.
use super::{Point, cross, left_normal};

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
            if sine.abs() < super::SAME_DIRECTION {
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

    fn point(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn three_four_five() {
        let circle = Curve::Circle { centre: point(0.0, 0.0), radius: 5.0 };
        let line = Curve::Line { point: point(3.0, -9.0), direction: point(0.0, 1.0) };
        assert_eq!(nearest_crossing(circle, line, point(0.0, 9.0)), Some(point(3.0, 4.0)));
        assert_eq!(nearest_crossing(line, circle, point(0.0, -9.0)), Some(point(3.0, -4.0)));
        let other = Curve::Circle { centre: point(6.0, 0.0), radius: 5.0 };
        assert_eq!(nearest_crossing(circle, other, point(0.0, 9.0)), Some(point(3.0, 4.0)));
    }

    #[test]
    fn what_is_apart_does_not_cross() {
        let circle = Curve::Circle { centre: point(0.0, 0.0), radius: 1.0 };
        let line = Curve::Line { point: point(2.0, 0.0), direction: point(0.0, 1.0) };
        let parallel = Curve::Line { point: point(3.0, 0.0), direction: point(0.0, -1.0) };
        assert_eq!(nearest_crossing(circle, line, point(0.0, 0.0)), None);
        assert_eq!(nearest_crossing(line, parallel, point(0.0, 0.0)), None);
    }
}
