//! Comparison of ground flutes with the nominal ones: contact, helix angle, spacing and number.
//!
//! The wheel is one point: the width of its groove, and contact of its body with a neighbour, are not modelled.
mod cause;
mod checks;
mod common;
mod measured_range;
mod path_distance;
mod spacing;
mod verdict;

pub use verdict::{FluteVerdict, HelixSample, LawAngles, NominalFlutes, describe_kind};

use self::common::CommonDeviation;
use self::measured_range::{MeasuredRange, WorstStretch};
use self::spacing::FluteSpacing;
use crate::flutes::GrindingResult;
use gcode_lang::diag::Diagnostic;
use gcode_lang::source::Span;
use gcode_part::Flutes;

/// Input of the checks.
struct Inspection<'g> {
    nominal: &'g Flutes,
    actual: &'g GrindingResult,
    spacing: FluteSpacing,
    /// Helix angle and speed; `None` without a flute.
    helix: Option<MeasuredRange>,
    speed: Option<MeasuredRange>,
    /// Height of all flutes above the tooth bottom, if it is the same all along and too large, mm.
    common_height: Option<f64>,
    /// Deviation of the helix angle that all flutes share, all along.
    common_deviation: Option<CommonDeviation>,
}

impl Inspection<'_> {
    fn worst_helix(&self) -> Option<WorstStretch> {
        self.helix.as_ref()?.worst()
    }

    /// Returns `all 6 flutes have` or `the flute has`, by the plural and the singular of a verb.
    fn all_flutes(&self, plural: &str, singular: &str) -> String {
        match self.spacing.flutes.len() {
            1 => format!("the flute {singular}"),
            all => format!("all {all} flutes {plural}"),
        }
    }

    /// Returns the name of a pass, counted from 0: that of its flute if each flute has one pass.
    fn pass_name(&self, pass: usize) -> String {
        let noun = if self.spacing.repeated.is_empty() { "flute" } else { "pass" };
        format!("{noun} {}", pass + 1)
    }
}

/// Compares the flutes of a program with the nominal ones. `locate` returns the program and the line of a block.
pub fn verify_flutes(
    nominal: &Flutes,
    actual: &GrindingResult,
    locate: &dyn Fn(Span) -> (String, u32),
) -> FluteVerdict {
    let passes = &actual.passes;
    let inspection = Inspection {
        nominal,
        actual,
        spacing: FluteSpacing::of(nominal, passes),
        helix: MeasuredRange::of_helix(nominal.gauge, passes),
        speed: MeasuredRange::of_speed(nominal.gauge, nominal.speed, passes),
        common_height: common::common_height(nominal, passes),
        common_deviation: CommonDeviation::of(nominal, passes),
    };
    let mut findings: Vec<Diagnostic> = actual.findings.clone();
    for check in checks::ALL {
        check(&inspection, &mut findings);
    }
    verdict::verdict(&inspection, findings, locate)
}
