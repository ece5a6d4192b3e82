//! Sets of gauge blocks that job files can name, and the blocks in each box.
//!
//! DIN EN ISO 3650 defines a block and leaves the composition of sets to the makers. The sets here are the
//! usual ones: sets 1 to 4 of GB/T 6093 (91, 83, 46 and 38 blocks), and those that catalogues list under 32,
//! 47, 76, 87, 88, 103 and 112.
use std::fmt;

/// Thickness of a block or a stack, in half micrometres; every block is a whole number of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Thickness(pub u32);

impl Thickness {
    /// Returns the thickness in mm.
    pub fn mm(self) -> f64 {
        f64::from(self.0) / 2000.0
    }
}

impl fmt::Display for Thickness {
    /// Writes mm as engraved on the block: `1.0005`, `1.01`, `2.5`, `100`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{}.{:04}", self.0 / 2000, self.0 % 2000 * 5);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// Blocks in equal steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Series {
    /// Thinnest block.
    pub(crate) first: Thickness,
    /// Difference between neighbouring blocks.
    pub(crate) step: Thickness,
    /// Number of blocks, at least 1.
    pub(crate) count: u32,
}

impl Series {
    /// Returns the blocks from the thinnest to the thickest.
    pub(crate) fn blocks(self) -> impl Iterator<Item = Thickness> {
        (0..self.count).map(move |n| Thickness(self.first.0 + self.step.0 * n))
    }
}

/// A box of gauge blocks, one of each thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GaugeSet {
    /// Name in job files.
    pub name: &'static str,
    /// Series from the finest blocks to the thickest; no block is in two of them.
    pub(crate) series: &'static [Series],
}

/// Returns a series of one block, in half micrometres.
const fn single(block: u32) -> Series {
    series(block, block, 1)
}

const fn series(first: u32, step: u32, count: u32) -> Series {
    Series { first: Thickness(first), step: Thickness(step), count }
}

/// 1.0005
const HALF_MICRON: Series = single(2001);
/// 1.001 … 1.009
const MICRONS: Series = series(2002, 2, 9);
/// 1.005
const FIVE_MICRONS: Series = single(2010);
/// 1.01 … 1.09
const HUNDREDTHS: Series = series(2020, 20, 9);
/// 1.01 … 1.49
const HUNDREDTHS_TO_HALF: Series = series(2020, 20, 49);
/// 1.1 … 1.9
const TENTHS: Series = series(2200, 200, 9);
/// 0.5, 1
const HALF_AND_ONE: Series = series(1000, 1000, 2);
/// 1.5 … 1.9
const TENTHS_FROM_HALF: Series = series(3000, 200, 5);
/// 2, 2.5 … 9.5
const HALVES_FROM_TWO: Series = series(4000, 1000, 16);
/// 0.5, 1 … 9.5
const HALVES: Series = series(1000, 1000, 19);
/// 0.5, 1 … 24.5
const HALVES_TO_25: Series = series(1000, 1000, 49);
/// 1 … 9
const ONES: Series = series(2000, 2000, 9);
/// 1 … 24
const ONES_TO_25: Series = series(2000, 2000, 24);
/// 10, 20 … 100
const TENS: Series = series(20_000, 20_000, 10);
/// 25, 50, 75, 100
const QUARTERS: Series = series(50_000, 50_000, 4);

impl GaugeSet {
    /// All sets, by the number of blocks.
    pub const ALL: [Self; 11] = [
        Self {
            name: "metric-32",
            series: &[FIVE_MICRONS, HUNDREDTHS, TENTHS, ONES, series(20_000, 20_000, 3), single(120_000)],
        },
        Self { name: "metric-38", series: &[FIVE_MICRONS, HUNDREDTHS, TENTHS, ONES, TENS] },
        Self { name: "metric-46", series: &[MICRONS, HUNDREDTHS, TENTHS, ONES, TENS] },
        Self { name: "metric-47", series: &[FIVE_MICRONS, HUNDREDTHS, TENTHS, ONES_TO_25, QUARTERS] },
        Self {
            name: "metric-76",
            series: &[
                FIVE_MICRONS,
                HUNDREDTHS_TO_HALF,
                HALVES,
                series(20_000, 20_000, 4),
                series(100_000, 50_000, 3),
            ],
        },
        Self {
            name: "metric-83",
            series: &[
                FIVE_MICRONS,
                HUNDREDTHS_TO_HALF,
                HALF_AND_ONE,
                TENTHS_FROM_HALF,
                HALVES_FROM_TWO,
                TENS,
            ],
        },
        Self { name: "metric-87", series: &[MICRONS, HUNDREDTHS_TO_HALF, HALVES, TENS] },
        Self { name: "metric-88", series: &[HALF_MICRON, MICRONS, HUNDREDTHS_TO_HALF, HALVES, TENS] },
        Self {
            name: "metric-91",
            series: &[MICRONS, HUNDREDTHS_TO_HALF, HALF_AND_ONE, TENTHS_FROM_HALF, HALVES_FROM_TWO, TENS],
        },
        Self { name: "metric-103", series: &[FIVE_MICRONS, HUNDREDTHS_TO_HALF, HALVES_TO_25, QUARTERS] },
        Self {
            name: "metric-112",
            series: &[HALF_MICRON, MICRONS, HUNDREDTHS_TO_HALF, HALVES_TO_25, QUARTERS],
        },
    ];

    /// Returns all blocks, from the thinnest to the thickest.
    pub fn blocks(&self) -> Vec<Thickness> {
        let mut blocks: Vec<_> = self.series.iter().copied().flat_map(Series::blocks).collect();
        blocks.sort_unstable();
        blocks
    }

    /// Returns the greatest common divisor of the blocks; every possible stack is a multiple of it.
    pub fn step(&self) -> Thickness {
        Thickness(self.blocks().iter().fold(0, |step, block| common_divisor(step, block.0)))
    }

    /// Returns the thickness of all blocks together.
    pub fn total(&self) -> Thickness {
        Thickness(self.blocks().iter().map(|block| block.0).sum())
    }
}

fn common_divisor(one: u32, other: u32) -> u32 {
    if other == 0 { one } else { common_divisor(other, one % other) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number in a set's name is the number of its blocks, all different.
    #[test]
    fn the_number_in_a_sets_name_is_that_of_its_blocks() {
        for set in GaugeSet::ALL {
            let mut blocks = set.blocks();
            assert_eq!(format!("metric-{}", blocks.len()), set.name);
            blocks.dedup();
            assert_eq!(format!("metric-{}", blocks.len()), set.name, "two are alike");
        }
    }

    #[test]
    fn blocks_are_named_as_they_are_engraved() {
        for (half_microns, engraved) in
            [(2001, "1.0005"), (2002, "1.001"), (2010, "1.005"), (1000, "0.5"), (200_000, "100"), (0, "0")]
        {
            assert_eq!(Thickness(half_microns).to_string(), engraved);
            assert_eq!(Thickness(half_microns).mm(), engraved.parse::<f64>().unwrap());
        }
    }

    /// By hand: 9·1.005 + 49·1.25 + 19·5 + 10·55 = 9.045 + 61.25 + 95 + 550.
    #[test]
    fn a_set_of_87_reaches_715_millimetres() {
        let set = GaugeSet::ALL.into_iter().find(|set| set.name == "metric-87").unwrap();
        assert_eq!(set.total().to_string(), "715.295");
        assert_eq!(set.step().to_string(), "0.001");
        let steps = GaugeSet::ALL.map(|set| set.step().to_string());
        // 1.0005 is in the sets of 88 and 112; 1.005 without 1.001 … is in those of 32, 38, 47, 76, 83 and
        // 103.
        let half = [
            "0.005", "0.005", "0.001", "0.005", "0.005", "0.005", "0.001", "0.0005", "0.001", "0.005",
            "0.0005",
        ];
        assert_eq!(steps, half);
        let edges: Vec<_> =
            set.series.iter().map(|s| format!("{} {}", s.first, s.blocks().last().unwrap())).collect();
        assert_eq!(edges, ["1.001 1.009", "1.01 1.49", "0.5 9.5", "10 100"]);
    }
}
