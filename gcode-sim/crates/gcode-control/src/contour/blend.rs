//! Rounding and chamfering of a corner: the element that `,R` and `,C` insert between two segments.
use super::crossing::nearest_crossing;
use super::{Point, Segment, cross, left_normal};
use gcode_lang::units::Deg;

/// Element that replaces a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Blend {
    /// Arc of this radius, tangent to both segments.
    Round(f64),
    /// Straight line between the points at this distance from the corner.
    Chamfer(f64),
}

/// Two segments with the element that replaces their corner.
///
/// A segment that is used up completely has length 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BlendedCorner {
    pub before: Segment,
    pub between: Segment,
    pub after: Segment,
}

/// Error: a segment is too short for the element at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooShort;

/// Largest change of direction that is not a corner (operator's manual, optional chamfering and corner R).
const MIN_CORNER_ANGLE: Deg = Deg(1.0);

impl Blend {
    /// Inserts the element between two segments; `None` if they do not form a corner.
    pub(crate) fn blend_between(self, a: &Segment, b: &Segment) -> Result<Option<BlendedCorner>, TooShort> {
        let (arriving, leaving) = (a.end_direction(), b.start_direction());
        let rotation = Deg::atan2(cross(arriving, leaving), arriving.dot(leaving));
        let size = match self {
            Self::Round(size) | Self::Chamfer(size) => size,
        };
        if rotation.abs() <= MIN_CORNER_ANGLE || size == 0.0 {
            return Ok(None);
        }
        let (from, to, centre) = match self {
            Self::Round(radius) => {
                let inside = radius * rotation.0.signum();
                let middle = nearest_crossing(a.curve_at_end(inside), b.curve_at_start(inside), a.end());
                let middle = middle.ok_or(TooShort)?;
                (nearest_point(a, a.end(), middle), nearest_point(b, b.start(), middle), Some(middle))
            }
            Self::Chamfer(length) => {
                (point_along(a, a.end(), -length)?, point_along(b, b.start(), length)?, None)
            }
        };
        let before = a.ending_at(from).ok_or(TooShort)?;
        let after = b.beginning_at(to).ok_or(TooShort)?;
        let between = match centre {
            None => Segment::Line { from, to },
            Some(centre) => {
                let (first, last) = (from - centre, to - centre);
                let sweep = Deg::atan2(cross(first, last), first.dot(last));
                Segment::Arc { from, to, centre, sweep }
            }
        };
        Ok(Some(BlendedCorner { before, between, after }))
    }
}

/// Returns the point of a segment nearest to another point; `end` determines the radius of an arc.
fn nearest_point(segment: &Segment, end: Point, of: Point) -> Point {
    match *segment {
        Segment::Line { from, .. } => {
            let direction = segment.start_direction();
            from + direction * direction.dot(of - from)
        }
        Segment::Arc { centre, .. } => centre + (of - centre).normalize() * (end - centre).norm(),
    }
}

/// Returns the point of a segment at a distance from one of its ends, negative for backwards.
fn point_along(segment: &Segment, end: Point, distance: f64) -> Result<Point, TooShort> {
    match *segment {
        Segment::Line { .. } => Ok(end + segment.start_direction() * distance),
        Segment::Arc { centre, sweep, .. } => {
            // The distance is a chord: from the corner to the end of the chamfer.
            let radius_vector = end - centre;
            let half = distance / (2.0 * radius_vector.norm());
            if half.abs() > 1.0 {
                return Err(TooShort);
            }
            let turn = Deg::asin(half) * (2.0 * sweep.0.signum());
            Ok(centre + radius_vector * turn.cos() + left_normal(radius_vector) * turn.sin())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: (f64, f64), to: (f64, f64)) -> Segment {
        Segment::Line { from: Point::new(from.0, from.1), to: Point::new(to.0, to.1) }
    }

    fn close(found: Point, wanted: (f64, f64)) {
        assert!((found - Point::new(wanted.0, wanted.1)).norm() < 1e-9, "{found:?} {wanted:?}");
    }

    #[test]
    fn a_right_angle_is_rounded_by_a_quarter_and_cut_off_at_equal_lengths() {
        let (east, north) = (line((0.0, 0.0), (20.0, 0.0)), line((20.0, 0.0), (20.0, 20.0)));
        let round = Blend::Round(4.0).blend_between(&east, &north).unwrap().unwrap();
        let Segment::Arc { from, to, centre, sweep } = round.between else { panic!("{round:?}") };
        close(from, (16.0, 0.0));
        close(to, (20.0, 4.0));
        close(centre, (16.0, 4.0));
        assert!((sweep.0 - 90.0).abs() < 1e-9);
        let cut = Blend::Chamfer(4.0).blend_between(&east, &north).unwrap().unwrap();
        close(cut.between.start(), (16.0, 0.0));
        close(cut.between.end(), (20.0, 4.0));
        assert_eq!((cut.before.start(), cut.after.end()), (east.start(), north.end()));
    }

    #[test]
    fn the_arc_touches_a_line_and_an_arc() {
        // East to (20, 0), then the circle about (20, 10) would be a tangent; about (10, 0) it is a right
        // angle.
        let east = line((0.0, 0.0), (20.0, 0.0));
        let (from, centre) = (Point::new(20.0, 0.0), Point::new(10.0, 0.0));
        let arc = Segment::Arc { from, to: Point::new(0.0, 0.0), centre, sweep: Deg(180.0) };
        let round = Blend::Round(2.0).blend_between(&east, &arc).unwrap().unwrap();
        // The centre is 2 above the line and 10 − 2 from the arc's centre: (10 + √(64 − 4), 2).
        let x = 10.0 + 60.0_f64.sqrt();
        let Segment::Arc { centre: middle, from, to, .. } = round.between else { panic!("{round:?}") };
        close(middle, (x, 2.0));
        close(from, (x, 0.0));
        close(to, (10.0 + (x - 10.0) * 10.0 / 8.0, 2.5));
    }

    #[test]
    fn what_is_longer_than_the_segment_does_not_fit() {
        let (east, north) = (line((0.0, 0.0), (3.0, 0.0)), line((3.0, 0.0), (3.0, 20.0)));
        assert_eq!(Blend::Round(4.0).blend_between(&east, &north), Err(TooShort));
        assert_eq!(Blend::Chamfer(4.0).blend_between(&east, &north), Err(TooShort));
        assert!(Blend::Chamfer(3.0).blend_between(&east, &north).is_ok());
        let back = line((3.0, 0.0), (0.0, 0.0));
        assert_eq!(Blend::Round(1.0).blend_between(&east, &back), Err(TooShort));
    }

    #[test]
    fn going_straight_on_is_no_corner() {
        let (east, on) = (line((0.0, 0.0), (20.0, 0.0)), line((20.0, 0.0), (40.0, 0.1)));
        assert_eq!(Blend::Round(4.0).blend_between(&east, &on), Ok(None));
    }
}
