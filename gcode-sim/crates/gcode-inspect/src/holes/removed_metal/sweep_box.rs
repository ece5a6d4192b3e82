//! Boxes about sweeps in little memory, and the shares of a strip that may be in one.
use nalgebra::{Point3, Vector3};

use crate::holes::box_tree::Bounds;
use crate::holes::strip::Strip;

/// Margin for rounding, mm.
const MARGIN: f64 = 1e-6;

/// Rounding of a share.
const SHARE_NOISE: f64 = 1e-9;

/// Box that holds all that a sweep removes; one without an end has infinite corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct SweepBox([[f32; 2]; 3]);

impl SweepBox {
    /// Returns the box about a tool whose tip moves between two points; `top` is the height of its end.
    pub(super) fn new(
        [from, to]: [&Point3<f64>; 2],
        axis: &Vector3<f64>,
        top: f64,
        margin: &Vector3<f64>,
    ) -> Self {
        Self(std::array::from_fn(|i| {
            let up = if axis[i] == 0.0 { 0.0 } else { axis[i] * top };
            let (low, high) = (from[i].min(to[i]), from[i].max(to[i]));
            let margin = margin[i] + MARGIN;
            [below(low + up.min(0.0) - margin), -below(-(high + up.max(0.0) + margin))]
        }))
    }
}

/// Returns the nearest number that is not greater.
fn below(value: f64) -> f32 {
    let near = value as f32;
    if value < f64::from(near) { near.next_down() } else { near }
}

/// A strip that is compared with many boxes.
pub(super) struct StripReach {
    /// Start and gain of each coordinate of both edges.
    coordinates: [[(f64, f64); 3]; 2],
}

impl StripReach {
    pub(super) fn of(strip: &Strip) -> Self {
        let coordinates = strip.edges.map(|[from, to]| std::array::from_fn(|i| (from[i], to[i] - from[i])));
        Self { coordinates }
    }

    /// Returns shares outside which not both edges are in a box; `None` if they never are.
    pub(super) fn shares_in(&self, SweepBox(sides): &SweepBox) -> Option<[f64; 2]> {
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for edge in &self.coordinates {
            for ((start, gain), side) in edge.iter().zip(sides) {
                let [low, high] = side.map(f64::from);
                if gain.abs() < f64::MIN_POSITIVE {
                    if *start < low || high < *start {
                        return None;
                    }
                    continue;
                }
                let (a, b) = ((low - start) / gain, (high - start) / gain);
                (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
            }
        }
        (first <= last + SHARE_NOISE).then_some([first - SHARE_NOISE, last + SHARE_NOISE])
    }
}

/// Returns the corners of a box about the part of a strip between two shares.
pub(super) fn bounds_between(strip: &Strip, [first, last]: [f64; 2]) -> Bounds {
    let edges = strip.edges.map(|[from, to]| [first, last].map(|share| from + (to - from) * share));
    let [low, high] = Strip { edges, ..*strip }.bounds();
    let margin = Vector3::repeat(MARGIN);
    [low - margin, high + margin]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point(p: [f64; 3]) -> Point3<f64> {
        Point3::from(p)
    }

    proptest! {
        /// Wherever both edges are in the box, the share is among those returned.
        #[test]
        fn no_share_in_the_box_is_missed(
            ends in prop::array::uniform4(prop::array::uniform3(-9.0..9.0f64)),
            tips in prop::array::uniform2(prop::array::uniform3(-9.0..9.0f64)),
            axis in prop::sample::select(vec![[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8]]),
            top in prop::sample::select(vec![4.0, f64::INFINITY]),
            flat in prop::bool::ANY,
        ) {
            let mut ends = ends.map(point);
            if flat {
                ends.iter_mut().for_each(|p| p.z = 1.0);
            }
            let [from, to] = tips.map(point);
            let axis = Vector3::from(axis);
            let sweep_box = SweepBox::new([&from, &to], &axis, top, &Vector3::repeat(2.0));
            let strip = Strip::between([ends[0], ends[1]], [ends[2], ends[3]]);
            let found = StripReach::of(&strip).shares_in(&sweep_box);
            let up = axis.map(|one| if one == 0.0 { 0.0 } else { one * top });
            for step in 0..=100 {
                let share = f64::from(step) / 100.0;
                let is_in = strip.edges.iter().all(|[a, b]| {
                    let p = a + (b - a) * share;
                    (0..3).all(|i| {
                        let low = from[i].min(to[i]) + up[i].min(0.0) - 2.0;
                        let high = from[i].max(to[i]) + up[i].max(0.0) + 2.0;
                        low <= p[i] && p[i] <= high
                    })
                });
                let is_found = found.is_some_and(|[first, last]| first <= share && share <= last);
                prop_assert!(!is_in || is_found, "{} {:?}", share, found);
            }
        }
    }
}
