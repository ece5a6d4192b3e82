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
use gcode_lang::diag::Severity;
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

/// The verdict on a program. `locate` names the program and the line of a block.
pub fn verify(
    extracted: &HoleExtraction,
    reference: &Reference,
    tolerances: Tolerances,
    machine: &Machine,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Verdict {
    let pattern = reference.pattern.as_ref();
    let comparison = Comparison::new(&reference.holes, &extracted.holes, tolerances, pattern);
    let rounding = RoundingDeviation::of(&comparison, machine);
    let mut objections = Vec::new();
    checks::mirrored::check(&comparison, machine, &mut objections);
    for check in checks::ALL {
        check(&comparison, &mut objections);
    }
    checks::air::check(&comparison, reference.surface, &mut objections);
    checks::through::check(&comparison, reference.surface, &mut objections);
    checks::tool_short::check(&comparison, machine, &mut objections);
    let stopped = extracted.findings.iter().any(|finding| finding.severity == Severity::Alarm);
    checks::stopped::check(&comparison, stopped, &mut objections);
    checks::common_shift::check(&comparison, machine, &mut objections);
    let (reaches, conduct) = (&extracted.length_mismatches, &reference.process_limits);
    checks::reach::check(&comparison, reaches, conduct, machine, &mut objections);
    let mut motion = extracted.findings.clone();
    motion.extend(checks::signs::finding(reference, machine));
    motion.extend(checks::clearance::findings(&extracted.close_motions, &reference.process_limits));
    motion.extend(checks::cutting::findings(&extracted.cut_conditions, &reference.process_limits, machine));
    let mut verdict = verdict::verdict(&comparison, &rounding, objections, &motion, locate);
    if let Some(pattern) = pattern {
        verdict.set_neighbours(neighbours::neighbours(&comparison, pattern));
    }
    verdict.not_checked = not_checked::lines(&comparison, extracted, reference, machine, locate);
    verdict
}
