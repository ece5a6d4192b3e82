//! Holds the flutes a program grinds against the wanted ones: on the surface, at the helix angle, evenly spaced, all
//! there. The wheel is one point: how wide it grinds, and whether its body gouges a neighbour, is not modelled.
mod cause;
mod checks;
mod common;
mod path_distance;
mod spacing;
mod speed;
mod verdict;

pub use common::CommonDeviation;
pub use spacing::FluteSpacing;
pub use speed::{SpeedRange, WorstSpeed};
pub use verdict::{FluteVerdict, HelixSample, LawAngles, NominalFlutes, describe_kind};

use nalgebra::Point3;

use crate::flutes::{GrindingResult, Trace};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_lang::source::Span;
use gcode_lang::units::Deg;
use gcode_part::Flutes;

/// What the checks look at.
pub struct Inspection<'g> {
    pub nominal: &'g Flutes,
    pub actual: &'g GrindingResult,
    /// The flutes round the burr.
    pub spacing: FluteSpacing,
    pub helix: HelixRange,
    /// `None` where nothing is ground.
    pub speed: Option<SpeedRange>,
    /// How far above the tooth bottom all flutes are ground, alike all along, where that is too much, mm.
    pub common_height: Option<f64>,
    /// What all flutes have instead of the wanted helix angle, all along.
    pub common_deviation: Option<CommonDeviation>,
}

impl Inspection<'_> {
    /// `all 6 flutes are`, `the flute is`.
    fn flutes_with_verb(&self) -> String {
        match self.spacing.flutes.len() {
            1 => "the flute is".to_owned(),
            all => format!("all {all} flutes are"),
        }
    }

    /// A pass counted from 0, in words: by the flute it grinds where each flute has one pass.
    fn pass_name(&self, pass: usize) -> String {
        let what = if self.spacing.repeated.is_empty() { "flute" } else { "pass" };
        format!("{what} {}", pass + 1)
    }
}

/// The helix angles along all flutes.
#[derive(Clone, Debug)]
pub struct HelixRange {
    pub min: Deg,
    pub max: Deg,
    /// Off the wanted angle, of all passes and of each.
    pub worst: Option<WorstHelix>,
    pub worst_by_pass: Vec<WorstHelix>,
}

#[derive(Clone, Copy, Debug)]
pub struct WorstHelix {
    /// Counted from 0.
    pub pass: usize,
    pub polar: Deg,
    /// On the burr, mm.
    pub point: Point3<f64>,
    pub actual: Deg,
    pub nominal: Deg,
    /// The first and the last sample of the stretch, counted from 0.
    sample_range: [usize; 2],
}

impl WorstHelix {
    pub fn error(&self) -> Deg {
        (self.actual - self.nominal).abs()
    }

    /// By more than the arithmetic's own rounding.
    fn is_worse(&self, than: &Self) -> bool {
        than.error().0 + 1e-6 < self.error().0
    }

    /// The block that goes farthest off the law there, or a gauge length beside it. One point out of place makes two
    /// moves wrong, there and back: the first of them is its block.
    pub fn backtrace<'g>(&self, trace: &'g Trace, gauge: f64) -> Option<&'g Backtrace> {
        let samples = &trace.samples;
        let [first, last] = self.sample_range.map(|end| samples[end].along);
        let (low, high) = (first.min(last) - gauge, first.max(last) + gauge);
        let mut blocks: Vec<(&Backtrace, f64)> = Vec::new();
        for pair in samples.windows(2).filter(|pair| (low..=high).contains(&pair[1].along)) {
            let off = (pair[1].around - pair[1].nominal_around) - (pair[0].around - pair[0].nominal_around);
            let place = trace.backtrace(&pair[1]);
            match blocks.last_mut().filter(|(last, _)| std::ptr::eq(*last, place)) {
                Some((_, sum)) => *sum += off,
                None => blocks.push((place, off)),
            }
        }
        let most = blocks.iter().map(|(_, off)| off.abs()).fold(0.0, f64::max);
        blocks.iter().find(|(_, off)| 0.9 * most <= off.abs()).map(|(place, _)| *place)
    }
}

impl HelixRange {
    fn single(angle: Deg) -> Self {
        Self { min: angle, max: angle, worst: None, worst_by_pass: Vec::new() }
    }

    fn of(wanted: &Flutes, ground: &GrindingResult) -> Option<Self> {
        let gauge = wanted.gauge;
        let mut range: Option<Self> = None;
        for (pass, ground) in ground.passes.iter().enumerate() {
            let mut worst: Option<WorstHelix> = None;
            for window in ground.trace.windows(gauge) {
                let candidate = WorstHelix {
                    pass,
                    polar: window.middle.polar,
                    point: window.middle.point,
                    actual: window.helix,
                    nominal: window.nominal_helix,
                    sample_range: window.ends,
                };
                let range = range.get_or_insert_with(|| Self::single(window.helix));
                range.min = if window.helix < range.min { window.helix } else { range.min };
                range.max = if range.max < window.helix { window.helix } else { range.max };
                if worst.is_none_or(|worst| candidate.is_worse(&worst)) {
                    worst = Some(candidate);
                }
            }
            if let Some((range, here)) = range.as_mut().zip(worst) {
                range.worst_by_pass.push(here);
                if range.worst.is_none_or(|worst| here.is_worse(&worst)) {
                    range.worst = Some(here);
                }
            }
        }
        range
    }
}

/// The verdict on a program. `locate` names the program and the line of a block.
pub fn verify_flutes(
    wanted: &Flutes,
    ground: &GrindingResult,
    locate: &dyn Fn(Span) -> (String, u32),
) -> FluteVerdict {
    let measured = HelixRange::of(wanted, ground);
    let inspection = Inspection {
        nominal: wanted,
        actual: ground,
        spacing: FluteSpacing::of(wanted, &ground.passes),
        helix: measured.clone().unwrap_or_else(|| HelixRange::single(Deg::ZERO)),
        speed: SpeedRange::of(wanted, &ground.passes),
        common_height: common::common_height(wanted, &ground.passes),
        common_deviation: CommonDeviation::of(wanted, &ground.passes),
    };
    let mut findings: Vec<Diagnostic> = ground.findings.clone();
    for check in checks::ALL {
        check(&inspection, &mut findings);
    }
    verdict::verdict(&inspection, measured.is_some(), findings, locate)
}
