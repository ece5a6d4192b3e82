//! Shares of a straight travel, from 0 at its start to 1 at its end, between which a point of it is within bounds.
use nalgebra::{Point3, Vector3};

/// Returns the largest depth to which points between two travels may enter a cylinder of a radius that both miss, mm.
pub(super) fn sag([one, other]: [&[Point3<f64>; 2]; 2], radius: f64) -> f64 {
    let width = (one[0] - other[0]).norm().max((one[1] - other[1]).norm());
    width * width / (4.0 * radius)
}

/// Returns the shares that one of two travels has, and those between them.
pub(super) fn either(
    travels: [&[Point3<f64>; 2]; 2],
    shares: impl Fn(&[Point3<f64>; 2]) -> Option<[f64; 2]>,
) -> Option<[f64; 2]> {
    let [one, other] = travels.map(shares);
    match (one, other) {
        (Some(one), Some(other)) => Some([one[0].min(other[0]), one[1].max(other[1])]),
        (one, other) => one.or(other),
    }
}

/// Returns the shares that are in two pieces.
pub fn common_shares(one: [f64; 2], other: [f64; 2]) -> Option<[f64; 2]> {
    let both = [one[0].max(other[0]), one[1].min(other[1])];
    (both[0] <= both[1]).then_some(both)
}

/// Returns the shares of a travel, within some, between which a coordinate is between two bounds. It begins at a value and
/// grows by a gain.
pub fn shares_between(
    [first, last]: [f64; 2],
    (start, gain): (f64, f64),
    (low, high): (f64, f64),
) -> Option<[f64; 2]> {
    if gain.abs() < 1e-12 {
        return (low < start && start < high).then_some([first, last]);
    }
    let (a, b) = ((low - start) / gain, (high - start) / gain);
    let (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
    (first < last).then_some([first, last])
}

/// Returns the shares of a travel, within some, between which it is nearer to the origin than a radius. The radius begins at a
/// value and grows by a gain; below 0 nothing is nearer.
pub fn shares_within(
    shares: [f64; 2],
    from: Vector3<f64>,
    along: Vector3<f64>,
    (radius, gain): (f64, f64),
) -> Option<[f64; 2]> {
    let [first, last] = shares_between(shares, (radius, gain), (0.0, f64::INFINITY))?;
    // a·t² + 2·b·t + c ≤ 0
    let a = along.norm_squared() - gain * gain;
    let b = from.dot(&along) - radius * gain;
    let c = from.norm_squared() - radius * radius;
    if a.abs() < 1e-18 && b.abs() < 1e-9 {
        return (c <= 0.0).then_some([first, last]);
    }
    let root = b * b - a * c;
    if root < 0.0 {
        return (a < 0.0).then_some([first, last]);
    }
    // Neither root is a difference of nearly equal numbers.
    let sum = -(b + root.sqrt().copysign(b));
    let (one, other) = (
        if a == 0.0 { f64::INFINITY.copysign(sum) } else { sum / a },
        if sum == 0.0 { 0.0 } else { c / sum },
    );
    let (low, high) = (one.min(other), one.max(other));
    let (first, last) = match (a < 0.0, gain < 0.0) {
        (false, _) => (first.max(low), last.min(high)),
        // A steep travel enters a cone that widens along it and leaves one that narrows.
        (true, false) => (first.max(high), last),
        (true, true) => (first, last.min(low)),
    };
    (first < last).then_some([first, last])
}
