//! Holds the holes a program makes against the wanted ones: which is which, how far off, and whether that will do.
mod causes;
mod checks;
mod displacement;
pub mod flutes;
mod hole_finding;
mod matching;
mod neighbours;
mod not_checked;
pub(crate) mod position;
mod rounding;
mod rows;
#[cfg(test)]
mod tests;
mod verdict;

pub use hole_finding::HoleFinding;
pub use matching::{Comparison, HolePair};
pub use neighbours::{Distance, HoleNeighbours, Neighbours};
pub use verdict::{Answer, ExtraHole, Finding, HoleGeometry, HoleVerdict, PartPoint, Verdict};

use self::rounding::RoundingDeviation;
use crate::holes::HoleExtraction;
use crate::machine::Machine;
use gcode_lang::source::Span;
use gcode_part::Reference;

/// What a hole may be off by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Diameter of the zone in which the axis must lie (ISO 1101), mm.
    pub position: f64,
    /// Either way, mm.
    pub depth: f64,
    /// Either way, mm; held against where the finishing tool's diameter is known.
    pub diameter: f64,
}

impl Tolerances {
    /// What was asked for goes before what the reference says; without either, the paper's Φ0.1.
    pub fn of(reference: &Reference, specified: Option<f64>) -> Self {
        Self {
            position: specified.or(reference.position).unwrap_or(0.1),
            depth: reference.depth.unwrap_or(0.1),
            diameter: 0.05,
        }
    }
}

/// What the checks look at.
struct HoleInspection<'a> {
    comparison: Comparison<'a>,
    extraction: &'a HoleExtraction,
    reference: &'a Reference,
    machine: &'a Machine,
}

/// The verdict on a program. `locate` names the program and the line of a block.
pub fn verify(
    extraction: &HoleExtraction,
    reference: &Reference,
    tolerances: Tolerances,
    machine: &Machine,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Verdict {
    let pattern = reference.pattern.as_ref();
    let comparison = Comparison::new(&reference.holes, &extraction.holes, tolerances, pattern);
    let inspection = HoleInspection { comparison, extraction, reference, machine };
    let motion = extraction.findings.iter().cloned();
    let mut findings: Vec<HoleFinding> = motion.map(HoleFinding::of_motion).collect();
    for check in checks::ALL {
        check(&inspection, &mut findings);
    }
    let comparison = &inspection.comparison;
    let rounding = RoundingDeviation::of(comparison, machine);
    let mut verdict = verdict::verdict(comparison, &rounding, findings, locate);
    if let Some(pattern) = pattern {
        verdict.set_neighbours(neighbours::neighbours(comparison, pattern));
    }
    verdict.not_checked = not_checked::lines(comparison, extraction, reference, machine, locate);
    verdict
}
