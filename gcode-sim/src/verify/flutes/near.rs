//! The least distance between two paths, in a straight line: of the paths themselves, whatever was wanted.
use nalgebra::{Point3, Vector3};

/// Between two paths of straight pieces, their ends counted in, and on which piece of the first; `None` where one has none.
///
/// From a piece `d` away the path has to run on by `d` less the best so far before it can come nearer: so far the search
/// goes on without looking.
pub(super) fn distance(one: &[Point3<f64>], other: &[Point3<f64>]) -> Option<(f64, usize)> {
    let (here, there) = (lengths(one), lengths(other));
    let mut best: Option<(f64, usize)> = None;
    let mut i = 0;
    while i + 1 < one.len() {
        let mut near: Option<f64> = None;
        let mut j = 0;
        while j + 1 < other.len() {
            let apart = pieces([one[i], one[i + 1]], [other[j], other[j + 1]]);
            near = Some(near.map_or(apart, |near| near.min(apart)));
            j = skip(&there, j, apart - near.unwrap_or(apart));
        }
        let near = near?;
        let (least, _) = *best.insert(best.filter(|(least, _)| *least <= near).unwrap_or((near, i)));
        i = skip(&here, i, near - least);
    }
    best
}

/// The way along the path to each point.
fn lengths(path: &[Point3<f64>]) -> Vec<f64> {
    let mut way = 0.0;
    let steps = path.windows(2).map(|pair| {
        way += (pair[1] - pair[0]).norm();
        way
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// The first piece behind `from` that ends more than `way` beyond its end.
fn skip(lengths: &[f64], from: usize, way: f64) -> usize {
    let end = lengths[from + 1];
    (from + 1).max(lengths.partition_point(|length| *length <= end + way).saturating_sub(1))
}

/// Between two straight pieces.
fn pieces(one: [Point3<f64>; 2], other: [Point3<f64>; 2]) -> f64 {
    let (u, v, between) = (one[1] - one[0], other[1] - other[0], one[0] - other[0]);
    let ends = [
        to_piece(&one[0], &other),
        to_piece(&one[1], &other),
        to_piece(&other[0], &one),
        to_piece(&other[1], &one),
    ];
    let nearest_end = ends.into_iter().fold(f64::INFINITY, f64::min);
    crossing(&u, &v, &between).map_or(nearest_end, |apart| apart.min(nearest_end))
}

/// Where the common perpendicular of both lines meets both pieces, its length.
fn crossing(u: &Vector3<f64>, v: &Vector3<f64>, between: &Vector3<f64>) -> Option<f64> {
    let (a, b, c) = (u.dot(u), u.dot(v), v.dot(v));
    let (d, e) = (u.dot(between), v.dot(between));
    let square = a * c - b * b;
    if square <= 1e-12 * a * c {
        return None;
    }
    let (s, t) = ((b * e - c * d) / square, (a * e - b * d) / square);
    let on = |part: f64| (0.0..=1.0).contains(&part);
    (on(s) && on(t)).then(|| (between + u * s - v * t).norm())
}

fn to_piece(point: &Point3<f64>, piece: &[Point3<f64>; 2]) -> f64 {
    let (along, from) = (piece[1] - piece[0], point - piece[0]);
    let square = along.norm_squared();
    let part = if square == 0.0 { 0.0 } else { (from.dot(&along) / square).clamp(0.0, 1.0) };
    (from - along * part).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(points: &[[f64; 3]]) -> Vec<Point3<f64>> {
        points.iter().map(|at| Point3::from(*at)).collect()
    }

    /// Crossing 3 above each other; end to end 5 (3, 4) apart; parallel 2 apart.
    #[test]
    fn between_the_points_too() {
        let line = path(&[[-10.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [10.0, 0.0, 0.0]]);
        let over = path(&[[1.0, -7.0, 3.0], [1.0, 9.0, 3.0]]);
        assert_eq!(distance(&line, &over), Some((3.0, 1)));
        assert_eq!(distance(&over, &line), Some((3.0, 0)));
        let beyond = path(&[[13.0, 4.0, 0.0], [20.0, 4.0, 0.0], [20.0, 40.0, 0.0]]);
        assert_eq!(distance(&line, &beyond), Some((5.0, 1)));
        let beside = path(&[[-3.0, 2.0, 0.0], [3.0, 2.0, 0.0]]);
        assert_eq!(distance(&line, &beside), Some((2.0, 0)));
        assert_eq!(distance(&line, &line[..1]), None);
    }

    /// A path that comes near only after a long way and a bend: 0.5 at its third point.
    #[test]
    fn what_is_skipped_was_farther() {
        let line = path(&[[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]]);
        let bent = path(&[[0.0, 30.0, 0.0], [30.0, 30.0, 0.0], [50.0, 0.5, 0.0], [60.0, 30.0, 0.0]]);
        assert_eq!(distance(&line, &bent), Some((0.5, 0)));
        assert_eq!(distance(&bent, &line), Some((0.5, 1)));
    }
}
