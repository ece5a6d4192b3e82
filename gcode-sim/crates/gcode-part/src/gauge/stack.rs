//! The stack of a set's blocks nearest to a height, with the fewest blocks.
use super::{GaugeSet, Thickness};
use gcode_lang::units::Mm;

/// Blocks on top of each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stack {
    /// Blocks from the thickest to the thinnest.
    pub blocks: Vec<Thickness>,
}

impl Stack {
    /// Returns the sum of the blocks.
    pub fn thickness(&self) -> Thickness {
        Thickness(self.blocks.iter().map(|block| block.0).sum())
    }
}

impl GaugeSet {
    /// Returns the stack nearest to a height, each block used once at most; all possible stacks compete.
    ///
    /// Criteria, in this order: the least difference; the fewest blocks; of two equally near stacks with
    /// equally many blocks, the lower; of two equally high ones, the one with the thickest block, then the
    /// thickest second block. The stack is empty for a height below half the thinnest block. A height above
    /// the sum of all blocks gets all of them.
    pub(crate) fn nearest_stack(&self, height: Mm) -> Stack {
        let blocks = self.blocks();
        let grid = self.step().0;
        let steps: Vec<usize> = blocks.iter().map(|block| (block.0 / grid) as usize).collect();
        let nominal = (height.0 * 2000.0 / f64::from(grid)).max(0.0);
        // The empty stack is nearer than any stack of more than twice the height.
        let most = steps.iter().sum::<usize>().min((2.0 * nominal) as usize);
        let reached = HeightSet::all_heights(&steps, most);
        let below = (0..=(nominal as usize).min(most)).rev().find(|sum| reached.contains(*sum));
        let above = (nominal as usize + 1..=most).find(|sum| reached.contains(*sum));
        let error = |sum: usize| (sum as f64 - nominal).abs();
        let least = [below, above].into_iter().flatten().map(error).fold(f64::INFINITY, f64::min);
        let nearest: Vec<_> =
            [below, above].into_iter().flatten().filter(|sum| error(*sum) <= least).collect();
        let indices = fewest_blocks(&steps, most, &nearest);
        Stack { blocks: indices.into_iter().map(|index| blocks[index]).collect() }
    }

    /// Returns the lowest height between `from` and `to`, in whole steps of the set, that no stack makes;
    /// `None` if all can be made. The empty stack makes a height of 0.
    pub fn first_gap(&self, from: Mm, to: Mm) -> Option<Thickness> {
        let grid = self.step().0;
        let steps: Vec<usize> = self.blocks().iter().map(|block| (block.0 / grid) as usize).collect();
        let [from, to] = [from, to].map(|height| (height.0 * 2000.0 / f64::from(grid)).round() as usize);
        let reached = HeightSet::all_heights(&steps, to);
        (from..=to).find(|sum| !reached.contains(*sum)).map(|sum| Thickness(sum as u32 * grid))
    }
}

/// Returns the indices of the fewest blocks that make one of the given heights, the thickest first. Each
/// height can be made.
fn fewest_blocks(steps: &[usize], most: usize, heights: &[usize]) -> Vec<usize> {
    let mut counts = std::iter::successors(Some(4), |count| (*count < steps.len()).then_some(count * 2));
    let stack = counts.find_map(|count| {
        let layers = HeightSet::by_count(steps, most, count);
        let least = |sum: usize| layers.iter().position(|layer| layer.contains(sum));
        let (count, sum) = heights.iter().filter_map(|sum| Some((least(*sum)?, *sum))).min()?;
        pick_blocks(steps, &layers[..count], sum)
    });
    stack.unwrap_or_default()
}

/// Returns a stack of height `sum` with as many blocks as `layers`, the thickest first; `None` if none
/// exists.
///
/// A layer contains a remainder also if it needs a block that is used already: then the next block is tried.
fn pick_blocks(steps: &[usize], layers: &[HeightSet], sum: usize) -> Option<Vec<usize>> {
    let Some((rest, fewer)) = layers.split_last() else { return (sum == 0).then(Vec::new) };
    (0..steps.len()).rev().filter(|index| steps[*index] <= sum).find_map(|index| {
        let left = sum - steps[index];
        let mut stack = rest.contains(left).then(|| pick_blocks(&steps[..index], fewer, left))??;
        stack.insert(0, index);
        Some(stack)
    })
}

/// A set of heights up to `max`, in steps of the set's grid, one bit each.
#[derive(Clone)]
struct HeightSet {
    words: Vec<u64>,
    max: usize,
}

impl HeightSet {
    fn empty(most: usize) -> Self {
        Self { words: vec![0; most / 64 + 1], max: most }
    }

    /// Returns the set that contains height 0 alone.
    fn empty_stack(most: usize) -> Self {
        let mut sums = Self::empty(most);
        sums.words[0] = 1;
        sums
    }

    /// Returns all heights that stacks of the blocks can have.
    fn all_heights(steps: &[usize], most: usize) -> Self {
        let mut sums = Self::empty_stack(most);
        for block in steps {
            let without = sums.clone();
            sums.add_block(&without, *block);
        }
        sums
    }

    /// Returns the heights of stacks of 0, 1, 2 … `count` blocks, a layer each.
    fn by_count(steps: &[usize], most: usize, count: usize) -> Vec<Self> {
        let mut layers = vec![Self::empty(most); count + 1];
        layers[0] = Self::empty_stack(most);
        for block in steps {
            // From the top layer down, so that the layer below does not contain the block yet.
            for fewer in (0..count).rev() {
                let (low, high) = layers.split_at_mut(fewer + 1);
                high[0].add_block(&low[fewer], *block);
            }
        }
        layers
    }

    /// Adds every height of `below` with one block on top.
    fn add_block(&mut self, below: &Self, block: usize) {
        let (whole, bits) = (block / 64, block % 64);
        for (at, word) in below.words.iter().enumerate() {
            if *word == 0 {
                continue;
            }
            if let Some(into) = self.words.get_mut(at + whole) {
                *into |= word << bits;
            }
            if let Some(into) = self.words.get_mut(at + whole + 1).filter(|_| bits > 0) {
                *into |= word >> (64 - bits);
            }
        }
    }

    fn contains(&self, sum: usize) -> bool {
        sum <= self.max && self.words[sum / 64] >> (sum % 64) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::sets::Series;
    use super::*;

    fn set(name: &str) -> GaugeSet {
        GaugeSet::ALL.into_iter().find(|set| set.name == name).unwrap()
    }

    fn stack(name: &str, height: f64) -> String {
        let blocks = set(name).nearest_stack(Mm(height)).blocks;
        blocks.iter().map(Thickness::to_string).collect::<Vec<_>>().join(" + ")
    }

    /// By the digits from the last one, as in a workshop; none of these can be made of fewer blocks.
    #[test]
    fn stacks_that_are_known() {
        let mut everything = set("metric-32").blocks();
        everything.reverse();
        let everything = everything.iter().map(Thickness::to_string).collect::<Vec<_>>().join(" + ");
        for (name, height, blocks) in [
            ("metric-87", 41.125, "30 + 9 + 1.12 + 1.005"),
            ("metric-112", 58.345, "50 + 6 + 1.34 + 1.005"),
            ("metric-46", 58.345, "50 + 5 + 1.3 + 1.04 + 1.005"),
            ("metric-87", 100.0, "100"),
            ("metric-87", 0.0, ""),
            // Nearer to the empty stack than to 0.5.
            ("metric-87", 0.249, ""),
            ("metric-87", 0.251, "0.5"),
            // Two blocks whose last digit is 7 make at most 2.107 or 2.107 + 0.1·n: a set of 46 has a gap
            // here.
            ("metric-46", 2.217, "1.2 + 1.02"),
            // Midway between 50 and 50.001 no stack is nearer; one block is fewer than 50.001 = 40 + 9 +
            // 1.001.
            ("metric-87", 50.0005, "50"),
            ("metric-88", 50.0005, "40 + 9 + 1.0005"),
            // More than 25 + 50 + 75 + 100.
            ("metric-103", 274.5, "100 + 75 + 50 + 25 + 24.5"),
            ("metric-32", 999.0, &everything),
        ] {
            assert_eq!(stack(name, height), blocks, "{height} by {name}");
        }
    }

    /// By hand, set of 87: 1.001 to 1.010 are blocks, 1.011 is not, and no two blocks are as thin; the
    /// thinnest is 0.5.
    #[test]
    fn low_heights_have_gaps() {
        let set = set("metric-87");
        let gap = |from, to| set.first_gap(Mm(from), Mm(to));
        assert_eq!(gap(1.0, 1.5), Some(Thickness(2022)));
        assert_eq!(gap(1.0, 1.01), None);
        assert_eq!(gap(0.0, 0.4), Some(Thickness(2)));
        assert_eq!(gap(0.0, 0.0), None);
        assert_eq!(gap(4.0, 130.0), None);
    }

    #[test]
    fn a_tie_in_everything_goes_to_the_lower() {
        const PAIR: GaugeSet = GaugeSet {
            name: "pair",
            series: &[Series { first: Thickness(2000), step: Thickness(2000), count: 2 }],
        };
        assert_eq!(PAIR.nearest_stack(Mm(1.5)).blocks, [Thickness(2000)], "1 or 2");
        assert_eq!(PAIR.nearest_stack(Mm(2.5)).blocks, [Thickness(4000)], "2 or 1 + 2: fewer blocks");
        assert_eq!(PAIR.nearest_stack(Mm(0.5)).blocks, [], "nothing or 1");
    }

    /// Twelve blocks: 4096 stacks, all of which are tried.
    const DOZEN: GaugeSet = GaugeSet {
        name: "dozen",
        series: &[
            Series { first: Thickness(2001), step: Thickness(1), count: 1 },
            Series { first: Thickness(2002), step: Thickness(4), count: 3 },
            Series { first: Thickness(2020), step: Thickness(20), count: 3 },
            Series { first: Thickness(1000), step: Thickness(1000), count: 4 },
            Series { first: Thickness(20_000), step: Thickness(1), count: 1 },
        ],
    };

    /// The best of all subsets, in the order that [`GaugeSet::nearest_stack`] documents.
    fn by_trying(height: f64) -> Vec<Thickness> {
        let mut blocks = DOZEN.blocks();
        blocks.reverse();
        let subset = |bits: u32| -> Vec<Thickness> {
            let chosen = blocks.iter().enumerate().filter(|(n, _)| bits >> n & 1 == 1);
            chosen.map(|(_, block)| *block).collect()
        };
        let all = (0..1_u32 << blocks.len()).map(subset);
        let best = all.min_by(|one, other| {
            let height_of = |stack: &[Thickness]| stack.iter().map(|block| block.0).sum::<u32>();
            let error = |stack: &[Thickness]| (f64::from(height_of(stack)) - height * 2000.0).abs();
            let first = error(one).total_cmp(&error(other)).then(one.len().cmp(&other.len()));
            first.then(height_of(one).cmp(&height_of(other))).then_with(|| other.cmp(one))
        });
        best.unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn no_stack_is_nearer_or_has_fewer_blocks(quarter_microns in 0..120_000_u32) {
            let height = f64::from(quarter_microns) / 4000.0;
            prop_assert_eq!(DOZEN.nearest_stack(Mm(height)).blocks, by_trying(height), "{}", height);
        }

        /// For the largest set: the stack is as high as its blocks, none is used twice, and every height is
        /// reached to half a micron.
        #[test]
        fn a_set_of_112_makes_every_height_to_half_a_micron(height in 5.0..60.0) {
            let set = set("metric-112");
            let mut blocks = set.nearest_stack(Mm(height)).blocks;
            let sum: f64 = blocks.iter().map(|block| block.mm()).sum();
            prop_assert!((sum - height).abs() <= 0.000_25 + 1e-9, "{} for {}", sum, height);
            prop_assert!(blocks.len() <= 6, "{:?}", blocks);
            blocks.dedup();
            let known = set.blocks();
            prop_assert!(blocks.iter().all(|block| known.contains(block)));
        }
    }
}
