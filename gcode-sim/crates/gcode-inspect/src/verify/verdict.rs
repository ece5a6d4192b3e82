//! The verdict on a program: every hole with its deviations, missing and extra holes, and the findings.
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::completion::{AnyVerdict, VerdictParts};
use super::conclusion::{
    Answer, Conclusion, Ending, SummaryWords, hole_counts, stop_sentence, uncounted_errors,
};
use super::hole_finding::{HoleFinding, Subject};
use super::rounding::RoundingDeviation;
use super::verdict_finding::{Finding, finding_of, limit_per_kind, origin};
use super::{Comparison, HoleNeighbours, HolePair, Neighbours};
use crate::findings::{HOLE_DEPTH, HOLE_NOT_THROUGH};
use crate::holes::DrilledHole;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::CallChain;
use gcode_lang::source::Span;
use gcode_part::{Assumption, Hole, Origin, Total};

/// The result of `verify --format json`. Nothing is rounded.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Verdict {
    /// The kind of the numbers.
    pub basis: &'static str,
    /// Diameter of the zone of position, mm.
    pub tolerance: f64,
    /// Either way, mm.
    pub depth_tolerance: f64,
    /// The answer.
    pub verdict: Answer,
    /// The end of the run.
    pub outcome: Ending,
    /// The reasons for the answer in one line.
    pub summary: String,
    /// Findings about the program's text that probably explain the answer, one sentence each.
    pub likely_causes: Vec<String>,
    /// The largest phi; null without a hole.
    pub worst: Option<f64>,
    /// The cause of the worst, in words.
    pub worst_from: Option<String>,
    /// The largest phi that rounding to the least increment alone can cause at any hole.
    pub rounding: Option<f64>,
    /// The nominal holes that are drilled.
    pub holes: Vec<HoleVerdict>,
    /// The ids of missing holes.
    pub missing: Vec<String>,
    /// The drilled holes without a nominal one.
    pub extra: Vec<ExtraHole>,
    /// All findings.
    pub findings: Vec<Finding>,
    /// The distances of neighbours, for a part where they matter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<Neighbours>,
    /// Sentences on what the verdict does not cover.
    pub not_checked: Vec<String>,
    /// Values that the run read and nothing in the program set, and the holes that each can touch.
    pub assumptions: Vec<Assumption>,
    /// True without a reference: only the motion is judged.
    #[serde(skip)]
    pub is_of_motion: bool,
    /// The words of the summary.
    #[serde(skip)]
    pub words: SummaryWords,
    /// Indices of the spring passes among the drilled holes, with the ids of their nominal holes.
    #[serde(skip)]
    pub repeated: Vec<(usize, String)>,
    /// The findings with their locations, for the printed report.
    #[serde(skip)]
    pub diagnostics: Vec<Diagnostic>,
}

/// A nominal hole that was drilled.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct HoleVerdict {
    /// The id in the reference.
    pub id: String,
    /// Diameter of the smallest zone that contains the axis, mm.
    #[serde(rename = "phi")]
    pub position_deviation: f64,
    /// Distance of the axes at the entry, mm.
    pub at_entry: f64,
    /// Distance of the axes at the bottom, mm.
    pub at_bottom: f64,
    /// Actual minus nominal depth, mm.
    pub depth_error: f64,
    /// True without an error among the findings.
    pub ok: bool,
    /// Between the axes, degrees.
    pub tilt: f64,
    /// The excess of phi over the tolerance; 0 inside.
    pub out_of_tolerance: f64,
    /// The phi that rounding alone can cause here.
    pub rounding: f64,
    /// The hole of the reference.
    pub nominal: HoleGeometry,
    /// The drilled hole.
    pub actual: HoleGeometry,
    /// The block that finishes it.
    pub from: Origin,
    /// The calls that led to that block, innermost first.
    pub calls: Vec<Origin>,
    /// The codes of its errors.
    #[serde(rename = "objections")]
    pub error_codes: Vec<&'static str>,
    /// Its neighbours, for a part where they matter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbours: Option<HoleNeighbours>,
    /// Index among the drilled holes.
    #[serde(skip)]
    pub drilled_index: usize,
    /// True if the hole goes through the part: a tool may go further.
    #[serde(skip)]
    pub is_through: bool,
    /// Index of the drilled hole from the far side of a through hole.
    #[serde(skip)]
    pub far_side_index: Option<usize>,
}

impl HoleVerdict {
    /// Returns true if a through hole goes through, from one side or from both, and no farther than tolerated.
    pub fn is_breakthrough(&self) -> bool {
        let is_of_depth = |code: &&str| [HOLE_DEPTH.code, HOLE_NOT_THROUGH.code].contains(code);
        let is_drilled_through = 0.0 <= self.depth_error || self.far_side_index.is_some();
        self.is_through && is_drilled_through && !self.error_codes.iter().any(is_of_depth)
    }
}

/// A hole in inspection terms; the entry of the actual hole is where its axis crosses the plane of the nominal
/// entry.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct HoleGeometry {
    /// Point of the axis at the surface.
    pub entry: [f64; 3],
    /// Unit vector out of the part.
    pub axis: [f64; 3],
    /// Diameter, mm; null if unknown.
    pub diameter: Option<f64>,
    /// Depth, mm.
    pub depth: f64,
}

/// An extra hole.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ExtraHole {
    /// The drilled hole.
    #[serde(flatten)]
    pub hole: Hole,
    /// The reason in words.
    pub why: String,
    /// Index among the drilled holes.
    #[serde(skip)]
    pub drilled_index: usize,
}

/// Makes the verdict of the findings; those about motion come last.
pub(super) fn verdict(
    comparison: &Comparison<'_>,
    rounding: &RoundingDeviation<'_>,
    mut findings: Vec<HoleFinding>,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Verdict {
    findings.sort_by_key(|one| one.subject == Subject::Motion);
    let holes = hole_verdicts(comparison, rounding, error_codes_by_hole(comparison, &findings), locate);
    let extra = |index: &usize| ExtraHole {
        hole: comparison.actual[*index].hole(locate),
        why: super::checks::extra::explain(comparison, *index),
        drilled_index: *index,
    };
    let repeated = |index: &usize| {
        let nominal = comparison.nominal_on_line_of(*index).map_or("?", |nominal| comparison.id(nominal));
        (*index, nominal.to_owned())
    };
    let as_data = |one: &HoleFinding| {
        let hole = if let Subject::Nominal(index) = one.subject { Some(comparison.id(index)) } else { None };
        let data = finding_of(&one.finding, hole, one.subject == Subject::Motion, locate);
        Finding { is_folded: one.is_folded, ..data }
    };
    let good = holes.iter().filter(|hole| hole.ok).count();
    let counts =
        hole_counts(good, comparison.missing.len(), comparison.extra.len(), comparison.nominal.len());
    let all = || findings.iter().map(|one| &one.finding);
    let words = SummaryWords {
        stop: stop_sentence(all(), locate),
        errors: uncounted_errors(&findings),
        counts,
        ..SummaryWords::default()
    };
    let worst = (0..holes.len())
        .max_by(|a, b| holes[*a].position_deviation.total_cmp(&holes[*b].position_deviation).then(b.cmp(a)));
    Verdict {
        basis: "predicted by simulation, not measured",
        tolerance: comparison.tolerances.position,
        depth_tolerance: comparison.tolerances.depth,
        verdict: Answer::to(all()),
        outcome: Ending::of(all()),
        summary: String::new(),
        is_of_motion: comparison.nominal.is_empty(),
        words,
        likely_causes: Vec::new(),
        worst: worst.map(|index| holes[index].position_deviation),
        worst_from: worst.map(|index| worst_from(&holes[index], &rounding.axis_shares(index))),
        rounding: rounding.position_deviations.iter().copied().reduce(f64::max),
        missing: comparison.missing.iter().map(|index| comparison.id(*index).to_owned()).collect(),
        extra: comparison.extra.iter().map(extra).collect(),
        repeated: comparison.repeated.iter().map(repeated).collect(),
        findings: findings.iter().map(as_data).collect(),
        neighbours: None,
        not_checked: Vec::new(),
        assumptions: Vec::new(),
        holes,
        diagnostics: limit_per_kind(findings.into_iter().filter(|one| !one.is_folded).map(|one| one.finding)),
    }
}

fn is_error(one: &HoleFinding) -> bool {
    Severity::Error <= one.finding.severity
}

/// Returns the codes of the errors of each nominal hole.
fn error_codes_by_hole(comparison: &Comparison<'_>, findings: &[HoleFinding]) -> Vec<Vec<&'static str>> {
    let mut codes_by_hole = vec![Vec::new(); comparison.nominal.len()];
    for one in findings.iter().filter(|one| is_error(one)) {
        if let Subject::Nominal(nominal) = one.subject {
            codes_by_hole[nominal].push(one.finding.kind.code);
        }
    }
    codes_by_hole
}

/// Returns the verdicts on the holes that were drilled, in the order of their pairs.
fn hole_verdicts(
    comparison: &Comparison<'_>,
    rounding: &RoundingDeviation<'_>,
    mut codes_by_hole: Vec<Vec<&'static str>>,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Vec<HoleVerdict> {
    let pairs = comparison.matched().zip(&rounding.position_deviations);
    let verdict = |((pair, nominal, drilled), rounding): ((&HolePair, &Hole, &DrilledHole), &f64)| {
        let (deviation, phi) = (&pair.deviation, pair.deviation.zone_diameter());
        let error_codes = std::mem::take(&mut codes_by_hole[pair.nominal]);
        HoleVerdict {
            id: comparison.id(pair.nominal).to_owned(),
            position_deviation: phi,
            at_entry: deviation.at_entry,
            at_bottom: deviation.at_bottom,
            depth_error: deviation.depth_error,
            ok: error_codes.is_empty(),
            tilt: deviation.tilt.0,
            out_of_tolerance: if comparison.is_in_place(pair) {
                0.0
            } else {
                phi - comparison.tolerances.position
            },
            rounding: *rounding,
            is_through: nominal.through,
            nominal: HoleGeometry {
                entry: nominal.entry,
                axis: nominal.axis,
                diameter: nominal.diameter,
                depth: nominal.depth,
            },
            actual: HoleGeometry {
                entry: deviation.entry.coords.into(),
                axis: drilled.axis.into_inner().into(),
                diameter: comparison.finishing(pair).diameter,
                depth: nominal.depth + deviation.depth_error,
            },
            from: origin(drilled.backtrace.block, drilled.tool, locate),
            calls: calls(&drilled.backtrace.calls, locate),
            error_codes,
            neighbours: None,
            drilled_index: pair.actual,
            far_side_index: pair.from_far_side,
        }
    };
    pairs.map(verdict).collect()
}

impl Verdict {
    /// Returns the value from which every output states the verdict.
    pub fn conclusion(&self) -> Conclusion<'_> {
        Conclusion { answer: self.verdict, ending: self.outcome, summary: &self.summary }
    }

    /// Returns the names of the drilled holes by their index: ids, and `extra 1` for those without a nominal hole.
    pub fn hole_names(&self) -> BTreeMap<usize, String> {
        let matched = self.holes.iter().flat_map(|hole| {
            let both = [Some(hole.drilled_index), hole.far_side_index];
            both.into_iter().flatten().map(|index| (index, hole.id.clone()))
        });
        let extra = self.extra.iter().enumerate();
        let extra = extra.map(|(place, hole)| (hole.drilled_index, format!("extra {}", place + 1)));
        let mut names: BTreeMap<usize, String> = BTreeMap::new();
        for (index, name) in matched.chain(extra).chain(self.repeated.iter().cloned()) {
            // One hole of the program may make two of the list.
            let joined = names.get(&index).map(|other| format!("{other}, {name}"));
            names.insert(index, joined.unwrap_or(name));
        }
        names
    }

    /// Adds the neighbours of each hole, by drilled hole, and their summary.
    pub(super) fn set_neighbours(&mut self, (around, summary): (Vec<Option<HoleNeighbours>>, Neighbours)) {
        for hole in &mut self.holes {
            hole.neighbours = around[hole.drilled_index];
        }
        self.neighbours = Some(summary);
    }
}

impl AnyVerdict for Verdict {
    fn parts(&mut self) -> VerdictParts<'_> {
        VerdictParts {
            total: Total::Holes(self.holes.len() + self.extra.len()),
            answer: &mut self.verdict,
            summary: &mut self.summary,
            words: &mut self.words,
            likely_causes: &mut self.likely_causes,
            findings: &mut self.findings,
            diagnostics: &mut self.diagnostics,
            assumptions: &mut self.assumptions,
        }
    }
}

/// Describes the worst deviation: the end of the hole, the distance, and the share of rounding.
fn worst_from(hole: &HoleVerdict, shares: &[(String, f64)]) -> String {
    let (end, off) = match hole.at_bottom > hole.at_entry {
        true => ("bottom", hole.at_bottom),
        false => ("entry", hole.at_entry),
    };
    let shares: Vec<_> =
        shares.iter().map(|(name, displacement)| format!("{name} {displacement:.4}")).collect();
    let shares = if shares.is_empty() { String::new() } else { format!(" ({})", shares.join(", ")) };
    // The margin is for the arithmetic itself.
    let side = if hole.position_deviation <= hole.rounding + 1e-6 { "within" } else { "beyond" };
    format!(
        "hole {}, off by {off:.4} mm at its {end}, {side} the effect of rounding; rounding alone causes at most Φ{:.4} there{shares}",
        hole.id, hole.rounding
    )
}

/// Returns the origins of the calls, innermost first.
fn calls(calls: &CallChain, locate: &dyn Fn(Span) -> (String, u32)) -> Vec<Origin> {
    let chain = std::iter::successors(calls.as_deref(), |call| call.outer_calls.as_deref());
    chain.map(|call| origin(call.calling_block, None, locate)).collect()
}
