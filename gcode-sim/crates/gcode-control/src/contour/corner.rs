//! Corners of a contour: the path of the tool centre round them, and the element that `,R` and `,C` insert.
use super::segment::{Curve, nearest_crossing};
use super::{Point, SAME_DIRECTION, Segment, cross, left_normal};
use gcode_lang::units::Deg;

/// Error: the two parallels do not intersect inside a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NoCrossing;

/// Returns true if the tool passes outside the corner, at a distance to the left.
pub(crate) fn is_outside(a: &Segment, b: &Segment, distance: f64) -> bool {
    let (before, after) = (a.end_direction(), b.start_direction());
    let cross_product = cross(before, after);
    if cross_product.abs() < SAME_DIRECTION {
        before.dot(after) < 0.0
    } else {
        cross_product * distance <= 0.0
    }
}

/// Returns the one to four points of the tool centre path at the corner between two segments.
///
/// The first point is the end of `a`'s parallel, the last the start of `b`'s; distances are to the left.
///
/// Outside, the parallel lines are extended to their intersection. At a corner sharper than 90° they are
/// extended by the radius and joined by a straight line (operator's manual, tool movement in the offset
/// mode). At an arc the tangent replaces the line. Inside, the parallels intersect.
pub(crate) fn corner_points(
    a: &Segment,
    b: &Segment,
    before: f64,
    after: f64,
) -> Result<Vec<Point>, NoCrossing> {
    if before * after < 0.0 {
        return Ok(side_change_points(a, b, before, after));
    }
    let (arriving, leaving) = (a.end_direction(), b.start_direction());
    let (end, start) = (a.parallel_end(before), b.parallel_start(after));
    let is_straight_on = cross(arriving, leaving).abs() < SAME_DIRECTION && arriving.dot(leaving) > 0.0;
    if is_straight_on {
        return Ok(vec![end]);
    }
    if !is_outside(a, b, before) {
        let found = nearest_crossing(a.curve_at_end(before), b.curve_at_start(after), a.end());
        return found.map(|point| vec![point]).ok_or(NoCrossing);
    }
    let mut points = Vec::with_capacity(4);
    if a.is_arc() {
        points.push(end);
    }
    let cosine = arriving.dot(leaving);
    if cosine >= 0.0 {
        points.push(a.end() + left_normal(arriving + leaving) * (before / (1.0 + cosine)));
    } else {
        let radius = before.abs();
        points.push(end + arriving * radius);
        points.push(start - leaving * radius);
    }
    if b.is_arc() {
        points.push(start);
    }
    Ok(points)
}

/// Returns the points of a corner at which the tool changes sides.
///
/// The path passes the intersection of the extended parallels, unless that reverses a segment or lengthens an
/// arc. Otherwise it goes from the end of one parallel to the start of the other.
fn side_change_points(a: &Segment, b: &Segment, before: f64, after: f64) -> Vec<Point> {
    let (end, start) = (a.parallel_end(before), b.parallel_start(after));
    let meets = nearest_crossing(a.curve_at_end(before), b.curve_at_start(after), a.end()).filter(|point| {
        let runs = !a.is_reversed(a.parallel_start(before), *point, before)
            && !b.is_reversed(*point, b.parallel_end(after), after);
        let on_arcs = (!a.is_arc() || !a.is_reversed(*point, end, before))
            && (!b.is_arc() || !b.is_reversed(start, *point, after));
        runs && on_arcs
    });
    meets.map_or_else(|| vec![end, start], |point| vec![point])
}

/// Returns the intersection of `a`'s parallel with that of a line from `a`'s end: G40 with I J K.
pub(crate) fn wall_corner(a: &Segment, direction: Point, distance: f64) -> Point {
    let direction = direction.normalize();
    let along = Curve::Line { point: a.end() + left_normal(direction) * distance, direction };
    nearest_crossing(a.curve_at_end(distance), along, a.end()).unwrap_or_else(|| a.parallel_end(distance))
}

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
            let angle = Deg::asin(half) * (2.0 * sweep.0.signum());
            Ok(centre + radius_vector * angle.cos() + left_normal(radius_vector) * angle.sin())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    fn line(from: (f64, f64), to: (f64, f64)) -> Segment {
        Segment::Line { from: at(from.0, from.1), to: at(to.0, to.1) }
    }

    /// Arc that begins at (20, 0).
    fn arc(to: (f64, f64), centre: (f64, f64), sweep: f64) -> Segment {
        Segment::Arc {
            from: at(20.0, 0.0),
            to: at(to.0, to.1),
            centre: at(centre.0, centre.1),
            sweep: Deg(sweep),
        }
    }

    fn close(actual: &[Point], nominal: &[(f64, f64)], name: &str) {
        assert_eq!(actual.len(), nominal.len(), "{name}: {actual:?}");
        for (actual, nominal) in actual.iter().zip(nominal) {
            assert!((*actual - at(nominal.0, nominal.1)).norm() < 1e-9, "{name}: {actual:?} {nominal:?}");
        }
    }

    #[test]
    fn the_tool_centre_passes_these_points_at_a_corner() {
        let (east, short) = (line((0.0, 0.0), (20.0, 0.0)), line((16.0, 0.0), (20.0, 0.0)));
        let north = line((20.0, 0.0), (20.0, 20.0));
        let south = line((20.0, 0.0), (20.0, -20.0));
        let on = line((20.0, 0.0), (40.0, 0.0));
        // 135 degrees to the left.
        let back = line((20.0, 0.0), (0.0, 20.0));
        let root = 50.0_f64.sqrt();
        let quarter = arc((10.0, 10.0), (10.0, 0.0), 90.0);
        type Row<'a> = (&'a str, &'a Segment, &'a Segment, (f64, f64), &'a [(f64, f64)]);
        let rows: [Row<'_>; 8] = [
            ("inside a right angle", &east, &north, (5.0, 5.0), &[(15.0, 5.0)]),
            ("outside a right angle", &east, &north, (-5.0, -5.0), &[(25.0, -5.0)]),
            (
                "a sharp corner has a short line",
                &east,
                &back,
                (-5.0, -5.0),
                &[(25.0, -5.0), (20.0 + root, 0.0)],
            ),
            (
                "an arc's tangent replaces the line",
                &east,
                &quarter,
                (-5.0, -5.0),
                &[(25.0, -5.0), (25.0, 0.0)],
            ),
            ("the side changes across the path", &east, &on, (5.0, -5.0), &[(20.0, 5.0), (20.0, -5.0)]),
            ("the side changes where y = 5 meets x = 25", &east, &north, (5.0, -5.0), &[(25.0, 5.0)]),
            ("the side changes where y = 5 meets x = 15", &east, &south, (5.0, -5.0), &[(15.0, 5.0)]),
            // An intersection behind the start would reverse a line of length 4.
            ("the side changes behind the start", &short, &south, (5.0, -5.0), &[(20.0, 5.0), (15.0, 0.0)]),
        ];
        for (name, a, b, (before, after), points) in rows {
            close(&corner_points(a, b, before, after).unwrap(), points, name);
        }
    }

    #[test]
    fn inside_an_arc_that_is_too_small_the_parallels_do_not_meet() {
        // Into a half circle of radius 2 at a right angle, the tool of radius 1.9 inside the corner.
        let (east, half) = (line((0.0, 0.0), (20.0, 0.0)), arc((16.0, 0.0), (18.0, 0.0), 180.0));
        assert_eq!(corner_points(&east, &half, 1.9, 1.9), Err(NoCrossing));
        assert!(corner_points(&east, &half, 0.5, 0.5).is_ok());
    }

    #[test]
    fn a_right_angle_is_rounded_by_a_quarter_and_cut_off_at_equal_lengths() {
        let (east, north) = (line((0.0, 0.0), (20.0, 0.0)), line((20.0, 0.0), (20.0, 20.0)));
        let round = Blend::Round(4.0).blend_between(&east, &north).unwrap().unwrap();
        let Segment::Arc { from, to, centre, sweep } = round.between else { panic!("{round:?}") };
        close(&[from, to, centre], &[(16.0, 0.0), (20.0, 4.0), (16.0, 4.0)], "round");
        assert!((sweep.0 - 90.0).abs() < 1e-9);
        let cut = Blend::Chamfer(4.0).blend_between(&east, &north).unwrap().unwrap();
        close(&[cut.between.start(), cut.between.end()], &[(16.0, 0.0), (20.0, 4.0)], "chamfer");
        assert_eq!((cut.before.start(), cut.after.end()), (east.start(), north.end()));
    }

    #[test]
    fn the_arc_touches_a_line_and_an_arc() {
        // East to (20, 0), then the circle about (20, 10) would be a tangent; about (10, 0) it is a right angle.
        let (east, half) = (line((0.0, 0.0), (20.0, 0.0)), arc((0.0, 0.0), (10.0, 0.0), 180.0));
        let round = Blend::Round(2.0).blend_between(&east, &half).unwrap().unwrap();
        // The centre is 2 above the line and 10 − 2 from the arc's centre: (10 + √(64 − 4), 2).
        let x = 10.0 + 60.0_f64.sqrt();
        let Segment::Arc { centre, from, to, .. } = round.between else { panic!("{round:?}") };
        close(&[centre, from, to], &[(x, 2.0), (x, 0.0), (10.0 + (x - 10.0) * 10.0 / 8.0, 2.5)], "round");
    }

    #[test]
    fn an_element_longer_than_a_segment_does_not_fit_and_a_straight_line_is_no_corner() {
        let (east, north) = (line((0.0, 0.0), (3.0, 0.0)), line((3.0, 0.0), (3.0, 20.0)));
        assert_eq!(Blend::Round(4.0).blend_between(&east, &north), Err(TooShort));
        assert_eq!(Blend::Chamfer(4.0).blend_between(&east, &north), Err(TooShort));
        assert!(Blend::Chamfer(3.0).blend_between(&east, &north).is_ok());
        let back = line((3.0, 0.0), (0.0, 0.0));
        assert_eq!(Blend::Round(1.0).blend_between(&east, &back), Err(TooShort));
        let on = line((3.0, 0.0), (23.0, 0.1));
        assert_eq!(Blend::Round(4.0).blend_between(&east, &on), Ok(None));
    }
}
