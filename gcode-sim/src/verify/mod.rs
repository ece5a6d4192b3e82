//! Holds the holes a program makes against the wanted ones: which is which, how far off, and whether that will do.
mod causes;
mod checks;
pub mod flutes;
mod matching;
mod neighbours;
mod objection;
mod off;
pub mod position;
mod rounding;
mod rows;
#[cfg(test)]
mod tests;
mod verdict;

use std::collections::BTreeMap;

pub use matching::{Comparison, Pair};
pub use neighbours::{Around, Distance, Neighbours};
pub use objection::Objection;
pub use rounding::{Rounding, Share};
pub use verdict::{Answer, Extra, Finding, HoleVerdict, OnPart, Placed, Verdict};

use crate::diag::Severity;
use crate::holes::Extracted;
use crate::machine::{HeadKind, Machine};
use crate::part::reference::Reference;
use crate::source::Span;
use crate::units::Deg;

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
    pub fn of(reference: &Reference, asked: Option<f64>) -> Self {
        Self {
            position: asked.or(reference.position).unwrap_or(0.1),
            depth: reference.depth.unwrap_or(0.1),
            diameter: 0.05,
        }
    }
}

/// The verdict on a program. `locate` names the program and the line of a block.
pub fn verify(
    extracted: &Extracted,
    reference: &Reference,
    tolerances: Tolerances,
    machine: &Machine,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Verdict {
    let pattern = reference.pattern.as_ref();
    let comparison = Comparison::new(&reference.holes, &extracted.holes, tolerances, pattern);
    let rounding = rounding::shares(&comparison, machine);
    let mut objections = Vec::new();
    for check in checks::ALL {
        check(&comparison, &mut objections);
    }
    checks::through::check(&comparison, reference.surface, &mut objections);
    checks::tool_short::check(&comparison, machine, &mut objections);
    let stopped = extracted.findings.iter().any(|finding| finding.severity == Severity::Alarm);
    checks::stopped::check(&comparison, stopped, &mut objections);
    checks::alike::check(&comparison, machine, &mut objections);
    let mut motion = extracted.findings.clone();
    motion.extend(checks::clearance::findings(&extracted.passings, reference.clearance));
    let mut verdict = verdict::verdict(&comparison, rounding, objections, &motion, locate);
    if let Some(pattern) = pattern {
        verdict.say_neighbours(neighbours::neighbours(&comparison, pattern));
    }
    verdict.not_checked = not_checked(&comparison, reference, machine);
    verdict
}

/// What a pass says nothing about, in words: nobody should take it for checked.
fn not_checked(comparison: &Comparison<'_>, reference: &Reference, machine: &Machine) -> Vec<String> {
    let mut all = Vec::new();
    all.extend(diameters(comparison, machine));
    let along_feed = comparison.pairs.iter().all(|pair| comparison.found[pair.found].off_tool == Deg::ZERO);
    if machine.head.kind == HeadKind::Free && along_feed {
        all.push("head angles: the head is not known, each axis is taken along its feed".to_owned());
    }
    if reference.surface.is_none() {
        all.push("rapid motion through the part: the reference has no surface, as a job file has".to_owned());
    }
    all
}

/// Whose diameters aren't checked: by which tools, where the tool table has others.
fn diameters(comparison: &Comparison<'_>, machine: &Machine) -> Vec<String> {
    let unknown = |pair: &&Pair| {
        comparison.wanted[pair.wanted].diameter.is_some() && comparison.found[pair.found].diameter.is_none()
    };
    let mut made: BTreeMap<Option<u32>, Vec<&str>> = BTreeMap::new();
    for pair in comparison.pairs.iter().filter(unknown) {
        let tool = comparison.found[pair.found].tool.filter(|_| !machine.tools.is_empty());
        made.entry(tool).or_default().push(comparison.id(pair.wanted));
    }
    let words = |(tool, ids): (Option<u32>, Vec<&str>)| match (tool, ids.as_slice()) {
        (None, _) if machine.tools.is_empty() => "diameters: the machine has no tool table".to_owned(),
        (None, ids) => format!("the diameter of {} made before any tool was put in", some(ids)),
        (Some(tool), ids) => {
            format!("the diameter of {} made by T{tool}, which the machine file doesn't describe", some(ids))
        }
    };
    made.into_iter().map(words).collect()
}

/// `hole 1,` or `63 holes (r0h0 the first),`.
fn some(ids: &[&str]) -> String {
    match ids {
        [one] => format!("hole {one},"),
        [first, ..] => format!("{} holes ({first} the first),", ids.len()),
        [] => String::new(),
    }
}
