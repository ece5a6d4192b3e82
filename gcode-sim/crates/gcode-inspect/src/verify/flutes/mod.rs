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
pub use verdict::{Angles, FluteVerdict, Law, WantedFlutes, in_words};

use nalgebra::Point3;

use crate::flutes::{GrindingResult, Trace};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_lang::source::Span;
use gcode_lang::units::Deg;
use gcode_part::Flutes;

/// What the checks look at.
pub struct Inspection<'g> {
    pub wanted: &'g Flutes,
    pub ground: &'g GrindingResult,
    /// The flutes round the burr.
    pub round: FluteSpacing,
    pub helix: HelixRange,
    /// `None` where nothing is ground.
    pub speed: Option<SpeedRange>,
    /// How far above the tooth bottom all flutes are ground, alike all along, where that is too much, mm.
    pub depth: Option<f64>,
    /// What all flutes have instead of the wanted helix angle, all along.
    pub instead: Option<CommonDeviation>,
}

impl Inspection<'_> {
    /// `all 6 flutes are`, `the flute is`.
    fn all_flutes(&self) -> String {
        match self.round.flutes.len() {
            1 => "the flute is".to_owned(),
            all => format!("all {all} flutes are"),
        }
    }

    /// A pass counted from 0, in words: by the flute it grinds where each flute has one pass.
    fn name(&self, pass: usize) -> String {
        let what = if self.round.again.is_empty() { "flute" } else { "pass" };
        format!("{what} {}", pass + 1)
    }
}

/// The helix angles along all flutes.
#[derive(Clone, Debug)]
pub struct HelixRange {
    pub least: Deg,
    pub most: Deg,
    /// Off the wanted angle, of all passes and of each.
    pub worst: Option<WorstHelix>,
    pub of_passes: Vec<WorstHelix>,
}

#[derive(Clone, Copy, Debug)]
pub struct WorstHelix {
    /// Counted from 0.
    pub pass: usize,
    pub polar: Deg,
    /// On the burr, mm.
    pub at: Point3<f64>,
    pub found: Deg,
    pub wanted: Deg,
    /// The first and the last sample of the stretch, counted from 0.
    ends: [usize; 2],
}

impl WorstHelix {
    pub fn off(&self) -> Deg {
        (self.found - self.wanted).abs()
    }

    /// By more than the arithmetic's own rounding.
    fn is_worse(&self, than: &Self) -> bool {
        than.off().0 + 1e-6 < self.off().0
    }

    /// The block that goes farthest off the law there, or a gauge length beside it. One point out of place makes two
    /// moves wrong, there and back: the first of them is its block.
    pub fn place<'g>(&self, trace: &'g Trace, gauge: f64) -> Option<&'g Backtrace> {
        let samples = &trace.samples;
        let [first, last] = self.ends.map(|end| samples[end].along);
        let (low, high) = (first.min(last) - gauge, first.max(last) + gauge);
        let mut blocks: Vec<(&Backtrace, f64)> = Vec::new();
        for pair in samples.windows(2).filter(|pair| (low..=high).contains(&pair[1].along)) {
            let off = (pair[1].around - pair[1].wanted) - (pair[0].around - pair[0].wanted);
            let place = trace.place(&pair[1]);
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
    fn only(angle: Deg) -> Self {
        Self { least: angle, most: angle, worst: None, of_passes: Vec::new() }
    }

    fn of(wanted: &Flutes, ground: &GrindingResult) -> Option<Self> {
        let gauge = wanted.gauge;
        let mut range: Option<Self> = None;
        for (pass, ground) in ground.passes.iter().enumerate() {
            let mut worst: Option<WorstHelix> = None;
            for window in ground.trace.windows(gauge) {
                let here = WorstHelix {
                    pass,
                    polar: window.middle.polar,
                    at: window.middle.at,
                    found: window.helix,
                    wanted: window.wanted,
                    ends: window.ends,
                };
                let range = range.get_or_insert_with(|| Self::only(window.helix));
                range.least = if window.helix < range.least { window.helix } else { range.least };
                range.most = if range.most < window.helix { window.helix } else { range.most };
                if worst.is_none_or(|worst| here.is_worse(&worst)) {
                    worst = Some(here);
                }
            }
            if let Some((range, here)) = range.as_mut().zip(worst) {
                range.of_passes.push(here);
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
        wanted,
        ground,
        round: FluteSpacing::of(wanted, &ground.passes),
        helix: measured.clone().unwrap_or_else(|| HelixRange::only(Deg::ZERO)),
        speed: SpeedRange::of(wanted, &ground.passes),
        depth: common::depth(wanted, &ground.passes),
        instead: CommonDeviation::of(wanted, &ground.passes),
    };
    let mut findings: Vec<Diagnostic> = ground.findings.clone();
    for check in checks::ALL {
        check(&inspection, &mut findings);
    }
    verdict::verdict(&inspection, measured.is_some(), findings, locate)
}
