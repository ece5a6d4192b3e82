//! Comparison of the drilled holes with the nominal ones: matching, deviations, findings and the verdict.
mod assumption;
mod bore_at_end;
mod causes;
mod checks;
mod completion;
mod conclusion;
mod displacement;
pub mod flutes;
mod followers;
mod hole_cuts;
mod hole_finding;
mod matching;
mod mill_size;
mod neighbours;
mod not_checked;
mod on_axis;
mod open_depths;
mod outline;
mod position;
mod rounding;
mod rows;
#[cfg(test)]
mod tests;
mod transformation;
mod verdict;
mod verdict_finding;
mod voids;

pub use assumption::{denied_assumptions, denied_words};
pub use completion::{AnyVerdict, VerdictParts};
pub use conclusion::{Answer, Conclusion, Ending, SummaryWords, stop_sentence};
pub use matching::{Comparison, HolePair};
pub use neighbours::{Distance, HoleNeighbours, Neighbours};
pub use open_depths::OpenDepths;
pub use position::Deviation;
pub use verdict::{ExtraHole, HoleGeometry, HoleVerdict, Verdict};
pub use verdict_finding::{Finding, PartPoint};

use std::collections::BTreeMap;

use self::checks::features::{FeatureFindings, judge_all};
use self::checks::mirrored::MirrorImage;
use self::hole_finding::{HoleFindings, Subject};
use self::not_checked::NotChecked;
use self::rounding::RoundingDeviation;
use self::rows::PatternRows;
use self::transformation::Transformation;
use self::voids::Blank;
use crate::findings::{FEED_BESIDE_HOLE, START_UNKNOWN};
use crate::holes::HoleExtraction;
use crate::machine::Machine;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_lang::shares;
use gcode_lang::source::Span;
use gcode_part::{Hole, Overlap, Reference, Stock, Surface, overlaps};
use nalgebra::{Point3, Vector3};

/// Tolerance of the diameter of a hole, either way, mm.
const DIAMETER_TOLERANCE: f64 = 0.05;

/// Tolerances of a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerances {
    /// Diameter of the zone in which the axis must lie (ISO 1101), mm.
    pub position: f64,
    /// Depth, either way, mm.
    pub depth: f64,
    /// Diameter, either way, mm; applies where the diameter of the finishing tool is known.
    pub diameter: f64,
}

impl Tolerances {
    /// Returns the tolerances of the reference; `specified` overrides its position tolerance. The defaults are Φ0.1 for
    /// the position, as in the paper, and ±0.1 for the depth.
    pub fn of(reference: &Reference, specified: Option<f64>) -> Self {
        Self {
            position: specified.or(reference.position).unwrap_or(0.1),
            depth: reference.depth_tolerance(),
            diameter: DIAMETER_TOLERANCE,
        }
    }
}

/// Input of the checks.
struct HoleInspection<'a> {
    comparison: Comparison<'a>,
    /// Nominal holes that overlap; none with a pattern, which is checked with its job.
    overlaps: Vec<Overlap>,
    /// Rows in which the holes were drilled; `None` without a pattern, with too few rows, and if all holes are in place.
    rows: Option<PatternRows<'a>>,
    /// The mirror image of the pattern that was drilled instead of it.
    mirror_image: Option<MirrorImage>,
    /// One other mistake that moves all holes.
    transformation: Option<Transformation>,
    /// Findings on the features of the holes that have any.
    features: Vec<FeatureFindings>,
    extraction: &'a HoleExtraction,
    reference: &'a Reference,
    machine: &'a Machine,
}

/// Compares the holes of a program with the reference. `locate` returns the program and the line of a block.
pub fn verify(
    extraction: &HoleExtraction,
    reference: &Reference,
    tolerances: Tolerances,
    machine: &Machine,
    locate: &(dyn Fn(Span) -> (String, u32) + Sync),
) -> Verdict {
    let pattern = reference.pattern.as_ref();
    let nominal = &reference.holes;
    let (overlaps, mut comparison) = shares::both(
        nominal.len(),
        || if pattern.is_none() { overlaps(nominal) } else { Vec::new() },
        || Comparison::new(nominal, &extraction.holes, tolerances, pattern),
    );
    comparison.reject_second_finishing(machine);
    let body = reference.body(machine.stock.as_ref());
    let stock = reference.stock.as_ref().or(machine.stock.as_ref());
    let voids = stock.map(Stock::voids).unwrap_or_default();
    if let Some(body) = &body {
        comparison.leave_out_air_feeds(body, &voids, machine);
    }
    let rows = pattern.and_then(|pattern| PatternRows::of(&comparison, pattern));
    let mirror_image = MirrorImage::of(&comparison);
    let transformation = match mirror_image {
        Some(_) => None,
        None => Transformation::of(&comparison, machine, &extraction.feeds_in_air),
    };
    let openings: Vec<Surface> =
        stock.map(Stock::pockets).into_iter().flatten().chain(voids.iter().copied()).collect();
    let blank = Blank { body, openings: &openings, voids: &voids };
    let features = judge_all(&comparison, blank, machine);
    let inspection = HoleInspection {
        comparison,
        overlaps,
        rows,
        mirror_image,
        transformation,
        features,
        extraction,
        reference,
        machine,
    };
    let mut findings = HoleFindings::default();
    // A check of its own names the holes of unknown positions.
    let block = |backtrace: &Backtrace| (backtrace.block.source, backtrace.block.start);
    let mut unknown_by_block: BTreeMap<_, Vec<&Backtrace>> = BTreeMap::new();
    for hole in extraction.holes.iter().filter(|hole| !hole.unknown_axes.is_none()) {
        unknown_by_block.entry(block(&hole.backtrace)).or_default().push(&hole.backtrace);
    }
    let is_of_hole = |finding: &Diagnostic| {
        let backtrace = finding.backtrace.as_ref().filter(|_| finding.kind == &START_UNKNOWN);
        backtrace
            .is_some_and(|own| unknown_by_block.get(&block(own)).is_some_and(|holes| holes.contains(&own)))
    };
    for finding in extraction.findings.iter().filter(|finding| !is_of_hole(finding)) {
        match finding.kind == &FEED_BESIDE_HOLE && reference.holes.is_empty() {
            true => findings.add_summed(
                Subject::Motion,
                finding.clone(),
                "a feed outside the stated pockets".to_owned(),
            ),
            false => findings.add(Subject::Motion, finding.clone()),
        }
    }
    let comparison = &inspection.comparison;
    let beside_checks = || {
        let rounding = RoundingDeviation::of(comparison, machine);
        (rounding, not_checked::list(&inspection, locate))
    };
    let ((rounding, not_checked), ()) = shares::both(comparison.pairs.len(), beside_checks, || {
        checks::ALL.iter().for_each(|check| check(&inspection, &mut findings));
    });
    let mut verdict = verdict::verdict(comparison, &rounding, findings.into_list(), locate);
    if let Some(pattern) = pattern {
        verdict.set_neighbours(neighbours::neighbours(comparison, pattern));
    }
    verdict.words.gaps = not_checked::gaps(&not_checked);
    verdict.not_checked = not_checked.iter().map(NotChecked::sentence).collect();
    verdict.parts().update_summary();
    verdict
}

/// Returns the nominal bottom of a hole.
fn bottom(hole: &Hole) -> Point3<f64> {
    Point3::from(hole.entry) - Vector3::from(hole.axis) * hole.depth
}

/// Formats a range of lengths in mm; one number if both ends agree.
fn format_range(min: f64, max: f64) -> String {
    if max - min < 0.001 { format!("{max:.3}") } else { format!("{min:.3} to {max:.3}") }
}
