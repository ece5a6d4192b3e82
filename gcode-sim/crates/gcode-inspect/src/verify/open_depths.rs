//! Depths that a list of holes leaves out: those of the program's holes.
use super::{Comparison, Tolerances};
use crate::holes::HoleExtraction;
use gcode_part::Reference;

/// Depths of the holes whose list leaves them out.
#[derive(Clone, Debug, Default)]
pub struct OpenDepths {
    /// Depth of each by its index, mm.
    pub depths: Vec<(usize, f64)>,
    /// Holes at which the program makes none: their depth is the least of the others.
    pub unmatched: Vec<usize>,
}

impl OpenDepths {
    /// Returns the depths of the holes that a run has made.
    pub fn of(reference: &Reference, extraction: &HoleExtraction) -> Self {
        let tolerances = Tolerances::of(reference, None);
        let comparison = Comparison::new(&reference.holes, &extraction.holes, tolerances, None);
        let is_open = |index: &usize| reference.open_depths.binary_search(index).is_ok();
        let depths = comparison.matched().filter(|(pair, ..)| is_open(&pair.nominal));
        let mut depths: Vec<(usize, f64)> = depths
            .map(|(pair, nominal, _)| (pair.nominal, nominal.depth + pair.deviation.depth_error))
            .filter(|(_, depth)| 0.0 < *depth)
            .collect();
        let unmatched: Vec<usize> = comparison.missing.iter().copied().filter(is_open).collect();
        if let Some(least) = depths.iter().map(|(_, depth)| *depth).reduce(f64::min) {
            depths.extend(unmatched.iter().map(|index| (*index, least)));
        }
        Self { depths, unmatched }
    }
}
