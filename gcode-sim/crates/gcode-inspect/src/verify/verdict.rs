//! The answer: every hole with its numbers, what is missing and what is too many, and why.
use std::borrow::Cow;
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::rounding::{AxisRounding, RoundingDeviation};
use super::{Comparison, HoleFinding, HoleNeighbours, Neighbours};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity, Site};
use gcode_lang::motion::{Call, CallChain};
use gcode_lang::source::Span;
use gcode_part::{Hole, Origin};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Answer {
    Pass,
    Fail,
}

/// The result of `verify --format json`. Nothing is rounded.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Verdict {
    /// The kind of the numbers.
    pub basis: &'static str,
    /// Diameter of the zone of position, mm.
    pub tolerance: f64,
    /// Either way, mm.
    pub depth_tolerance: f64,
    pub verdict: Answer,
    /// The largest phi; null without a hole.
    pub worst: Option<f64>,
    /// The cause of the worst, in words.
    pub worst_from: Option<String>,
    /// The largest phi that rounding to the least increment alone can cause at any hole.
    pub rounding: Option<f64>,
    pub holes: Vec<HoleVerdict>,
    /// The ids of missing holes.
    pub missing: Vec<String>,
    pub extra: Vec<ExtraHole>,
    pub findings: Vec<Finding>,
    /// The distances of neighbours, for a part where they matter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<Neighbours>,
    /// What the verdict does not cover, in words.
    pub not_checked: Vec<String>,
    /// The findings with their places, for people.
    #[serde(skip)]
    pub diagnostics: Vec<Diagnostic>,
}

/// A nominal hole that was drilled.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct HoleVerdict {
    pub id: String,
    #[serde(rename = "phi")]
    pub position_deviation: f64,
    pub at_entry: f64,
    pub at_bottom: f64,
    pub depth_error: f64,
    pub ok: bool,
    /// Between the axes, degrees.
    pub tilt: f64,
    /// The excess of phi over the tolerance; 0 inside.
    pub out_of_tolerance: f64,
    /// The phi that rounding alone can cause here.
    pub rounding: f64,
    pub nominal: HoleGeometry,
    pub actual: HoleGeometry,
    pub from: Origin,
    /// The calls that led to that block, innermost first.
    pub calls: Vec<Origin>,
    /// The codes of its findings.
    pub objections: Vec<&'static str>,
    /// Its neighbours, for a part where they matter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<HoleNeighbours>,
    /// Which of the holes that the program makes it is, counted from 0.
    #[serde(skip)]
    pub drilled_index: usize,
}

/// A hole in inspection terms; the entry of the actual hole is where its axis crosses the plane of the nominal
/// entry.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct HoleGeometry {
    pub entry: [f64; 3],
    pub axis: [f64; 3],
    pub diameter: Option<f64>,
    pub depth: f64,
}

/// An extra hole.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ExtraHole {
    #[serde(flatten)]
    pub hole: Hole,
    pub why: String,
    /// Which of the holes that the program makes it is, counted from 0.
    #[serde(skip)]
    pub drilled_index: usize,
}

/// A finding as data.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Finding {
    #[serde(skip)]
    pub kind: &'static FindingKind,
    pub code: Cow<'static, str>,
    pub severity: &'static str,
    pub message: String,
    pub help: Option<String>,
    pub notes: Vec<String>,
    /// The finding is about motion, not about the resulting holes.
    pub from_motion: bool,
    /// The id of the nominal hole.
    pub hole: Option<String>,
    pub from: Option<Origin>,
    /// For a finding on flutes: positions on the part, the worst first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sites: Vec<PartPoint>,
}

/// A position on the part, mm.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct PartPoint {
    /// Counted from 1; null without a pass: a missing flute, a rapid between two of them.
    pub pass: Option<usize>,
    pub at: [f64; 3],
}

impl From<&Site> for PartPoint {
    fn from(site: &Site) -> Self {
        Self { pass: site.pass.map(|pass| pass + 1), at: site.point }
    }
}

pub(super) fn verdict(
    comparison: &Comparison<'_>,
    rounding: &RoundingDeviation<'_>,
    mut findings: Vec<HoleFinding>,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Verdict {
    findings.sort_by_key(|finding| finding.is_motion);
    let mut codes_by_hole: Vec<Vec<&'static str>> = vec![Vec::new(); comparison.nominal.len()];
    let failed = |finding: &Diagnostic| Severity::Error <= finding.severity;
    for HoleFinding { nominal, finding, .. } in findings.iter().filter(|one| failed(&one.finding)) {
        if let Some(nominal) = *nominal {
            codes_by_hole[nominal].push(finding.kind.code);
        }
    }
    let holes: Vec<HoleVerdict> = comparison
        .pairs
        .iter()
        .zip(&rounding.position_deviations)
        .map(|(pair, rounding)| {
            let objections = std::mem::take(&mut codes_by_hole[pair.nominal]);
            hole_verdict(comparison, pair, *rounding, objections, locate)
        })
        .collect();
    let fails = findings.iter().any(|one| failed(&one.finding));
    let worst = (0..holes.len())
        .max_by(|a, b| holes[*a].position_deviation.total_cmp(&holes[*b].position_deviation).then(b.cmp(a)));
    Verdict {
        basis: "predicted by simulation, not measured",
        tolerance: comparison.tolerances.position,
        depth_tolerance: comparison.tolerances.depth,
        verdict: if fails { Answer::Fail } else { Answer::Pass },
        worst: worst.map(|index| holes[index].position_deviation),
        worst_from: worst.map(|index| worst_from(&holes[index], &rounding.axis_shares(index))),
        rounding: rounding.position_deviations.iter().copied().reduce(f64::max),
        missing: comparison.missing.iter().map(|index| comparison.id(*index).to_owned()).collect(),
        extra: comparison.extra.iter().map(|index| extra_hole(comparison, *index, locate)).collect(),
        findings: findings
            .iter()
            .map(|one| {
                let hole = one.nominal.map(|index| comparison.id(index));
                finding_of(&one.finding, hole, one.is_motion, locate)
            })
            .collect(),
        neighbours: None,
        not_checked: Vec::new(),
        holes,
        diagnostics: limit_per_kind(findings.into_iter().filter(|one| !one.is_folded).map(|one| one.finding)),
    }
}

/// A finding as data, about the wanted hole of this id.
pub(super) fn finding_of(
    finding: &Diagnostic,
    hole: Option<&str>,
    from_motion: bool,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Finding {
    let origin = finding.backtrace.as_ref().map(|place| locate(place.block));
    Finding {
        kind: finding.kind,
        code: finding.code(),
        severity: finding.severity.name(),
        message: finding.message.clone(),
        help: finding.help.clone(),
        notes: finding.notes.clone(),
        from_motion,
        hole: hole.map(str::to_owned),
        from: origin.map(|(program, line)| Origin { program, line, tool: None }),
        sites: finding.sites.iter().map(Into::into).collect(),
    }
}

impl Verdict {
    /// Whether anything but notes is told.
    pub fn has_findings(&self) -> bool {
        self.diagnostics.iter().any(|finding| Severity::Warning <= finding.severity)
    }

    /// Adds what is told of the program's text, which leaves the answer as it is: before all that it may explain.
    pub fn add_likely_causes(&mut self, causes: Vec<Diagnostic>, locate: &dyn Fn(Span) -> (String, u32)) {
        self.findings.splice(0..0, causes.iter().map(|slip| finding_of(slip, None, true, locate)));
        let alarms =
            self.diagnostics.iter().take_while(|finding| finding.severity == Severity::Alarm).count();
        self.diagnostics.splice(alarms..alarms, limit_per_kind(causes.into_iter()));
    }

    /// Adds what is round each hole, and the summary.
    pub(super) fn set_neighbours(&mut self, (around, summary): (Vec<Option<HoleNeighbours>>, Neighbours)) {
        for hole in &mut self.holes {
            hole.neighbours = around[hole.drilled_index];
        }
        self.neighbours = Some(summary);
    }
}

/// As many of each kind as people read; the last of them says how many more there are.
pub(super) fn limit_per_kind(findings: impl Iterator<Item = Diagnostic>) -> Vec<Diagnostic> {
    const MAX_SHOWN: usize = 8;
    let mut kinds: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut shown: Vec<Diagnostic> = Vec::new();
    for finding in findings {
        let (count, last) = kinds.entry(finding.kind.code).or_insert((0, 0));
        *count += 1;
        if *count <= MAX_SHOWN {
            *last = shown.len();
            shown.push(finding);
        }
    }
    for (count, last) in kinds.into_values().filter(|(count, _)| MAX_SHOWN < *count) {
        shown[last]
            .notes
            .push(format!("and {} more of this kind; --format json lists them all", count - MAX_SHOWN));
    }
    // What stopped the run explains what else is wrong.
    shown.sort_by_key(|finding| finding.severity != Severity::Alarm);
    shown
}

fn hole_verdict(
    comparison: &Comparison<'_>,
    pair: &super::HolePair,
    rounding: f64,
    objections: Vec<&'static str>,
    locate: &dyn Fn(Span) -> (String, u32),
) -> HoleVerdict {
    let (wanted, found, deviation) =
        (&comparison.nominal[pair.nominal], &comparison.actual[pair.actual], &pair.deviation);
    let phi = deviation.zone_diameter();
    let (program, line) = locate(found.backtrace.block);
    HoleVerdict {
        id: comparison.id(pair.nominal).to_owned(),
        position_deviation: phi,
        at_entry: deviation.at_entry,
        at_bottom: deviation.at_bottom,
        depth_error: deviation.depth_error,
        ok: objections.is_empty(),
        tilt: deviation.tilt.0,
        out_of_tolerance: (phi - comparison.tolerances.position).max(0.0),
        rounding,
        nominal: HoleGeometry {
            entry: wanted.entry,
            axis: wanted.axis,
            diameter: wanted.diameter,
            depth: wanted.depth,
        },
        actual: HoleGeometry {
            entry: deviation.entry.coords.into(),
            axis: found.axis.into_inner().into(),
            diameter: found.diameter,
            depth: wanted.depth + deviation.depth_error,
        },
        from: Origin { program, line, tool: found.tool },
        calls: calls(&found.backtrace.calls, locate),
        objections,
        neighbours: None,
        drilled_index: pair.actual,
    }
}

fn extra_hole(
    comparison: &Comparison<'_>,
    index: usize,
    locate: &dyn Fn(Span) -> (String, u32),
) -> ExtraHole {
    let found = &comparison.actual[index];
    ExtraHole {
        hole: found.hole(locate),
        why: super::checks::extra::explain(comparison, index),
        drilled_index: index,
    }
}

/// In one line: which end, how far, and how much of it rounding is to blame for.
fn worst_from(hole: &HoleVerdict, shares: &[AxisRounding]) -> String {
    let (end, off) = match hole.at_bottom > hole.at_entry {
        true => ("bottom", hole.at_bottom),
        false => ("entry", hole.at_entry),
    };
    let shares: Vec<_> = shares.iter().map(|s| format!("{} {:.4}", s.name(), s.displacement)).collect();
    let shares = if shares.is_empty() { String::new() } else { format!(" ({})", shares.join(", ")) };
    // What can be explained by rounding is compared with room for the arithmetic itself.
    let blame = match hole.position_deviation <= hole.rounding + 1e-6 {
        true => "within the effect of rounding",
        false => "beyond the effect of rounding",
    };
    format!(
        "hole {}, off by {off:.4} mm at its {end}, {blame}; rounding alone causes at most Φ{:.4} there{shares}",
        hole.id, hole.rounding
    )
}

/// The chain of calls, one place each.
fn calls(calls: &CallChain, locate: &dyn Fn(Span) -> (String, u32)) -> Vec<Origin> {
    let chain = std::iter::successors(calls.as_deref(), |call| call.outer_calls.as_deref());
    let place = |call: &Call| {
        let (program, line) = locate(call.calling_block);
        Origin { program, line, tool: None }
    };
    chain.map(place).collect()
}
