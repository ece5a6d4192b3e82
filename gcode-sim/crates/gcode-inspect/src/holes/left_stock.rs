//! The stock without its voids as convex bodies, for searches that need distances.
//!
//! What is left of a box without another box are up to six boxes that overlap, each as large as can be. A cube in the metal is
//! then in one of them, so that a point at the depth d is in one at d/√3 or more. The round voids stay in the bodies: where one
//! holds a box, no body reaches into that.
use nalgebra::{Point3, Vector3};

use super::box_tree::Bounds;
use super::removed_metal::RemovedMetal;
use crate::machine::TOUCH_DEPTH;
use gcode_part::{NearestPoint, Surface};

/// Largest number of boxes into which voids divide the stock; the others count as round ones do.
const MAX_BOXES: usize = 100;

/// Bodies whose union is the stock without its voids that are boxes.
#[derive(Debug, Default)]
pub(super) struct LeftStock {
    /// Boxes of the metal; in a stock that is no box only what is in both is metal.
    boxes: Vec<Bounds>,
    /// A stock that is no box.
    round: Option<Surface>,
}

impl LeftStock {
    /// Returns the bodies that are left of a stock.
    pub(super) fn new(stock: &Surface, voids: &[Surface]) -> Self {
        let mut boxes = vec![stock.bounds()];
        for void in voids {
            let Surface::Block { min, max } = void else { continue };
            let left = without(&boxes, &[*min, *max]);
            if left.len() <= MAX_BOXES {
                boxes = left;
            }
        }
        let round = (!matches!(stock, Surface::Block { .. })).then_some(*stock);
        if round.is_some() && boxes == [stock.bounds()] {
            boxes.clear();
        }
        Self { boxes, round }
    }

    /// Calls `each` with the distance of a point from every body that may reach into the box about it with these half sides.
    pub(super) fn for_each(
        &self,
        p: &Point3<f64>,
        reach: &Vector3<f64>,
        removed: &RemovedMetal,
        each: &mut dyn FnMut(NearestPoint),
    ) {
        if removed.is_in_void(&[p - reach, p + reach]) {
            return;
        }
        let round = self.round.map(|stock| stock.nearest(p));
        if let (true, Some(round)) = (self.boxes.is_empty(), round) {
            each(round);
        }
        for [min, max] in &self.boxes {
            let own = Surface::Block { min: *min, max: *max }.nearest(p);
            // Of two bodies what is in both is no nearer than either.
            each(round.filter(|round| own.distance < round.distance).unwrap_or(own));
        }
    }
}

/// Returns the largest boxes that are left of some without another.
fn without(boxes: &[Bounds], void: &Bounds) -> Vec<Bounds> {
    let mut left: Vec<Bounds> = Vec::new();
    for [low, high] in boxes {
        if (0..3).any(|i| void[1][i] <= low[i] || high[i] <= void[0][i]) {
            left.push([*low, *high]);
            continue;
        }
        for i in 0..3 {
            if low[i] < void[0][i] {
                let mut end = *high;
                end[i] = void[0][i];
                left.push([*low, end]);
            }
            if void[1][i] < high[i] {
                let mut begin = *low;
                begin[i] = void[1][i];
                left.push([begin, *high]);
            }
        }
    }
    let holds =
        |[low, high]: &Bounds, [begin, end]: &Bounds| (0..3).all(|i| low[i] <= begin[i] && end[i] <= high[i]);
    let is_needed = |index: usize, own: &Bounds| {
        let mut others = left.iter().enumerate();
        !others.any(|(other, by)| other != index && holds(by, own) && (other < index || !holds(own, by)))
    };
    left.iter().enumerate().filter(|(index, own)| is_needed(*index, own)).map(|(_, own)| *own).collect()
}

/// Returns true if a convex body, grown by a touch, holds a box.
pub(super) fn holds_box(body: &Surface, [low, high]: &Bounds) -> bool {
    let [least, greatest] = body.bounds();
    (0..3).all(|i| least[i] - TOUCH_DEPTH <= low[i] && high[i] <= greatest[i] + TOUCH_DEPTH)
        && (0..8).all(|corner| {
            let at = |i: usize| if corner >> i & 1 == 0 { low[i] } else { high[i] };
            body.nearest(&Point3::new(at(0), at(1), at(2))).distance <= TOUCH_DEPTH
        })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn block([min, max]: &Bounds) -> Surface {
        Surface::Block { min: *min, max: *max }
    }

    /// A flange of 100 × 100 from z −20 to 0 with a hub of 30 × 30 to z 40: of five boxes four are the flange and the hub down to its
    /// underside. 5 mm over the flange and 25 mm beside the hub the flange is nearer; at z 30, 8 mm beside the hub, the hub is.
    #[test]
    fn a_hub_stands_on_its_flange() {
        let stock =
            Surface::Block { min: Point3::new(-50.0, -50.0, -20.0), max: Point3::new(50.0, 50.0, 40.0) };
        let voids = [
            ([-51.0, -51.0, 0.0], [-15.0, 51.0, 41.0]),
            ([15.0, -51.0, 0.0], [51.0, 51.0, 41.0]),
            ([-51.0, -51.0, 0.0], [51.0, -15.0, 41.0]),
            ([-51.0, 15.0, 0.0], [51.0, 51.0, 41.0]),
        ]
        .map(|(min, max)| block(&[Point3::from(min), Point3::from(max)]));
        let left = LeftStock::new(&stock, &voids);
        assert_eq!(left.boxes.len(), 2, "{left:?}");
        let removed = RemovedMetal::new(stock.bounds(), Vec::new());
        let nearest = |p: [f64; 3]| {
            let mut least = f64::INFINITY;
            left.for_each(&Point3::from(p), &Vector3::zeros(), &removed, &mut |at| {
                least = least.min(at.distance)
            });
            least
        };
        assert_eq!(nearest([40.0, 0.0, 5.0]), 5.0);
        assert_eq!(nearest([23.0, 0.0, 30.0]), 8.0);
        assert_eq!(nearest([14.0, 0.0, 20.0]), -1.0);
        assert_eq!(nearest([40.0, 0.0, -2.0]), -2.0);
    }

    proptest! {
        /// A point is in one of the boxes if and only if it is in the stock and in no void, and a point whose distance from voids and
        /// faces along the axes is d is at the depth d in one.
        #[test]
        fn the_metal_is_the_same(
            sizes in prop::collection::vec((prop::array::uniform3(0..9i32), prop::array::uniform3(1..6i32)), 0..5),
            p in prop::array::uniform3(0.0..10.0f64),
        ) {
            let stock = [Point3::origin(), Point3::from([10.0; 3])];
            let voids: Vec<Bounds> = sizes
                .iter()
                .map(|(low, size)| {
                    let (low, size) = (low.map(f64::from), size.map(f64::from));
                    [Point3::from(low), Point3::from([0, 1, 2].map(|i| low[i] + size[i]))]
                })
                .collect();
            let p = Point3::from(p);
            let boxes = voids.iter().fold(vec![stock], |boxes, void| without(&boxes, void));
            // Half the side of the largest cube about the point in the metal.
            let outside = |[low, high]: &Bounds| {
                (0..3).map(|i| (low[i] - p[i]).max(p[i] - high[i])).fold(f64::NEG_INFINITY, f64::max)
            };
            let half = voids.iter().map(outside).fold(-outside(&stock), f64::min);
            let depth = boxes.iter().map(|own| -block(own).nearest(&p).distance).fold(f64::NEG_INFINITY, f64::max);
            match 0.0 < half {
                true => prop_assert!(half <= depth + 1e-9, "{depth}, not {half}"),
                false => prop_assert!(depth <= 1e-9, "{depth} in a void"),
            }
        }
    }
}
