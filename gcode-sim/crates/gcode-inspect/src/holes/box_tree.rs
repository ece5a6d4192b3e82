//! Boxes of things in the order of time: a tree over their numbers. Feeds that follow each other are near each other.
use nalgebra::Point3;

/// Number of boxes below one box.
const FAN: usize = 8;

/// Corners of a box.
pub(super) type Bounds = [Point3<f64>; 2];

/// Boxes about groups of things, about groups of these groups, and so on up to one box about all.
#[derive(Debug, Default)]
pub(super) struct BoxTree {
    /// `levels[0][i]` is the box about the things from 8·i on, `levels[1][i]` the one about those from 64·i on.
    levels: Vec<Vec<Bounds>>,
}

impl BoxTree {
    /// Widens the boxes about a thing; a new one has the next number.
    pub(super) fn enclose(&mut self, number: usize, bounds: Bounds) {
        let mut place = number / FAN;
        for level in 0.. {
            if level == self.levels.len() {
                let below =
                    level.checked_sub(1).and_then(|below| self.levels[below].iter().copied().reduce(union));
                self.levels.push(below.into_iter().collect());
            }
            let boxes = &mut self.levels[level];
            match boxes.get_mut(place) {
                Some(known) => *known = union(*known, bounds),
                None => boxes.push(bounds),
            }
            if place == 0 {
                return;
            }
            place /= FAN;
        }
    }

    /// Calls `visit` with the numbers of groups of eight whose box meets `bounds`, the last ones first, while it returns true.
    pub(super) fn near(&self, bounds: &Bounds, visit: &mut impl FnMut(usize) -> bool) {
        if let Some(top) = self.levels.len().checked_sub(1) {
            let count = self.levels[top].len();
            self.descend(top, 0..count, bounds, visit);
        }
    }

    fn descend(
        &self,
        level: usize,
        places: std::ops::Range<usize>,
        bounds: &Bounds,
        visit: &mut impl FnMut(usize) -> bool,
    ) -> bool {
        places.rev().filter(|place| is_met(&self.levels[level][*place], bounds)).all(|place| match level {
            0 => visit(place),
            _ => {
                let end = self.levels[level - 1].len().min((place + 1) * FAN);
                self.descend(level - 1, place * FAN..end, bounds, visit)
            }
        })
    }
}

/// Returns the numbers of the things in a group of eight.
pub(super) fn group(place: usize) -> std::ops::Range<usize> {
    place * FAN..(place + 1) * FAN
}

fn union([low, high]: Bounds, [other_low, other_high]: Bounds) -> Bounds {
    [low.inf(&other_low), high.sup(&other_high)]
}

/// All coordinates are compared, which is faster than a branch for each.
fn is_met([low, high]: &Bounds, [other_low, other_high]: &Bounds) -> bool {
    (0..3).fold(true, |met, i| met & (low[i] <= other_high[i]) & (other_low[i] <= high[i]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Every thing whose box meets the bounds is in a group that is visited, each once, the last ones first.
        #[test]
        fn all_that_is_near_is_visited(
            corners in prop::collection::vec(prop::array::uniform3(-50.0..50.0f64), 1..700),
            at in prop::array::uniform3(-50.0..50.0f64),
            size in 0.0..20.0f64,
        ) {
            let mut tree = BoxTree::default();
            let bounds = |corner: &[f64; 3], size: f64| {
                let low = Point3::from(*corner);
                [low, low.map(|value| value + size)]
            };
            for (number, corner) in corners.iter().enumerate() {
                tree.enclose(number, bounds(corner, 1.0));
                // A thing that grows.
                tree.enclose(number, bounds(corner, 3.0));
            }
            let wanted = bounds(&at, size);
            let mut visited = Vec::new();
            tree.near(&wanted, &mut |place| {
                visited.push(place);
                true
            });
            prop_assert!(visited.windows(2).all(|pair| pair[1] < pair[0]), "{visited:?}");
            for (number, corner) in corners.iter().enumerate() {
                let is_near = is_met(&bounds(corner, 3.0), &wanted);
                prop_assert!(!is_near || visited.iter().any(|place| group(*place).contains(&number)), "{number}");
            }
            let mut first = Vec::new();
            tree.near(&wanted, &mut |place| {
                first.push(place);
                false
            });
            prop_assert_eq!(first.as_slice(), &visited[..visited.len().min(1)]);
        }
    }
}
