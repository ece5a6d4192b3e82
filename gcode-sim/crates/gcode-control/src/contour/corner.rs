//! Path of the tool centre around a corner, from the parallel of one segment to that of the next.
use super::crossing::{Curve, nearest_crossing};
use super::{Point, SAME_DIRECTION, Segment, cross, left_normal};

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

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::units::Deg;

    fn line(from: (f64, f64), to: (f64, f64)) -> Segment {
        Segment::Line { from: Point::new(from.0, from.1), to: Point::new(to.0, to.1) }
    }

    fn close(found: &[Point], wanted: &[(f64, f64)]) {
        assert_eq!(found.len(), wanted.len(), "{found:?}");
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((*found - Point::new(wanted.0, wanted.1)).norm() < 1e-9, "{found:?} {wanted:?}");
        }
    }

    #[test]
    fn a_right_angle_has_one_point_on_either_side() {
        let (east, north) = (line((0.0, 0.0), (20.0, 0.0)), line((20.0, 0.0), (20.0, 20.0)));
        close(&corner_points(&east, &north, 5.0, 5.0).unwrap(), &[(15.0, 5.0)]);
        close(&corner_points(&east, &north, -5.0, -5.0).unwrap(), &[(25.0, -5.0)]);
    }

    #[test]
    fn a_sharp_corner_is_gone_round_by_a_short_line() {
        // 135 degrees to the left, the tool on the right: east, then north-west.
        let (east, back) = (line((0.0, 0.0), (20.0, 0.0)), line((20.0, 0.0), (0.0, 20.0)));
        let half = 0.5_f64.sqrt();
        let start = (20.0 + 5.0 * half + 5.0 * half, 5.0 * half - 5.0 * half);
        close(&corner_points(&east, &back, -5.0, -5.0).unwrap(), &[(25.0, -5.0), start]);
    }

    #[test]
    fn an_arc_s_tangent_takes_the_place_of_the_line() {
        // East, then a quarter to the left that begins going north, the tool on the right.
        let east = line((0.0, 0.0), (20.0, 0.0));
        let (from, to, centre) = (Point::new(20.0, 0.0), Point::new(10.0, 10.0), Point::new(10.0, 0.0));
        let quarter = Segment::Arc { from, to, centre, sweep: Deg(90.0) };
        close(&corner_points(&east, &quarter, -5.0, -5.0).unwrap(), &[(25.0, -5.0), (25.0, 0.0)]);
    }

    #[test]
    fn inside_an_arc_too_far_away_nothing_meets() {
        // Into a half circle of radius 2 at a right angle, the tool of radius 1.9 inside the corner.
        let east = line((0.0, 0.0), (20.0, 0.0));
        let (from, centre) = (Point::new(20.0, 0.0), Point::new(18.0, 0.0));
        let half = Segment::Arc { from, to: Point::new(16.0, 0.0), centre, sweep: Deg(180.0) };
        assert_eq!(corner_points(&east, &half, 1.9, 1.9), Err(NoCrossing));
        assert!(corner_points(&east, &half, 0.5, 0.5).is_ok());
    }

    #[test]
    fn the_side_changes_where_the_parallels_meet_or_across_the_path() {
        let (east, on) = (line((0.0, 0.0), (20.0, 0.0)), line((20.0, 0.0), (40.0, 0.0)));
        close(&corner_points(&east, &on, 5.0, -5.0).unwrap(), &[(20.0, 5.0), (20.0, -5.0)]);
        // North after east, from the left to the right: the parallels y = 5 and x = 25.
        let north = line((20.0, 0.0), (20.0, 20.0));
        close(&corner_points(&east, &north, 5.0, -5.0).unwrap(), &[(25.0, 5.0)]);
        // An intersection behind the start would reverse a line of length 4.
        let south = line((20.0, 0.0), (20.0, -20.0));
        let short = line((16.0, 0.0), (20.0, 0.0));
        close(&corner_points(&east, &south, 5.0, -5.0).unwrap(), &[(15.0, 5.0)]);
        close(&corner_points(&short, &south, 5.0, -5.0).unwrap(), &[(20.0, 5.0), (15.0, 0.0)]);
    }
}
