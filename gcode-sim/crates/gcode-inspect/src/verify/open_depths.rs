//! Depths that a list of holes leaves out: those of the program's holes.
use super::{Comparison, Tolerances};
use crate::holes::HoleExtraction;
use gcode_part::Reference;

/// Returns the depth of each hole whose list leaves it out, by its index: that of the matched hole of the program, mm. A hole
/// without a match gets the least of them.
pub fn open_depths(reference: &Reference, extraction: &HoleExtraction) -> Vec<(usize, f64)> {
    let tolerances = Tolerances::of(reference, None);
    let comparison = Comparison::new(&reference.holes, &extraction.holes, tolerances, None);
    let is_open = |index: &usize| reference.open_depths.binary_search(index).is_ok();
    let depths = comparison.matched().filter(|(pair, ..)| is_open(&pair.nominal));
    let mut depths: Vec<(usize, f64)> = depths
        .map(|(pair, nominal, _)| (pair.nominal, nominal.depth + pair.deviation.depth_error))
        .filter(|(_, depth)| 0.0 < *depth)
        .collect();
    if let Some(least) = depths.iter().map(|(_, depth)| *depth).reduce(f64::min) {
        let missing = comparison.missing.iter().copied().filter(is_open);
        depths.extend(missing.map(|index| (index, least)));
    }
    depths
}
