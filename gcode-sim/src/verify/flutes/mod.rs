//! Holds the flutes a program grinds against the wanted ones: on the surface, at the helix angle, evenly spaced, all
//! there. The wheel is one point: how wide it grinds, and whether its body gouges a neighbour, is not modelled.
mod checks;
mod round;
mod verdict;

pub use round::Round;
pub use verdict::{Angles, FluteVerdict, Law, WantedFlutes};

use crate::diag::Diagnostic;
use crate::flutes::{Ground, gauge};
use crate::part::flutes::Flutes;
use crate::source::Span;
use crate::units::Deg;

/// What the checks look at.
pub struct Inspection<'g> {
    pub wanted: &'g Flutes,
    pub ground: &'g Ground,
    /// The flutes round the burr.
    pub round: Round,
    pub helix: HelixRange,
}

/// The helix angles along all flutes.
#[derive(Clone, Copy, Debug)]
pub struct HelixRange {
    pub least: Deg,
    pub most: Deg,
    /// Off the wanted angle: pass and sample counted from 0, found, wanted, by the other law.
    pub worst: Option<WorstHelix>,
}

#[derive(Clone, Copy, Debug)]
pub struct WorstHelix {
    pub pass: usize,
    pub polar: Deg,
    pub found: Deg,
    pub wanted: Deg,
    pub other: Deg,
}

impl WorstHelix {
    pub fn off(&self) -> Deg {
        (self.found - self.wanted).abs()
    }
}

impl HelixRange {
    fn of(wanted: &Flutes, ground: &Ground) -> Option<Self> {
        let gauge = gauge(wanted);
        let mut range: Option<Self> = None;
        for (pass, ground) in ground.passes.iter().enumerate() {
            for window in ground.trace.windows(gauge) {
                let here = WorstHelix {
                    pass,
                    polar: window.middle.polar,
                    found: window.helix,
                    wanted: window.wanted,
                    other: window.other,
                };
                let range =
                    range.get_or_insert(Self { least: window.helix, most: window.helix, worst: None });
                range.least = if window.helix < range.least { window.helix } else { range.least };
                range.most = if range.most < window.helix { window.helix } else { range.most };
                if range.worst.is_none_or(|worst| worst.off() < here.off()) {
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
    ground: &Ground,
    locate: &dyn Fn(Span) -> (String, u32),
) -> FluteVerdict {
    let none = HelixRange { least: Deg::ZERO, most: Deg::ZERO, worst: None };
    let measured = HelixRange::of(wanted, ground);
    let inspection = Inspection {
        wanted,
        ground,
        round: Round::of(wanted, &ground.passes),
        helix: measured.unwrap_or(none),
    };
    let mut findings: Vec<Diagnostic> = ground.findings.clone();
    for check in checks::ALL {
        check(&inspection, &mut findings);
    }
    verdict::verdict(&inspection, measured.is_some(), findings, locate)
}
