//! Conclusion of a verdict: answer, end of the run, and one line of words. Every output states this value.
use schemars::JsonSchema;
use serde::Serialize;

use super::hole_finding::{HoleFinding, Subject};
use super::verdict_finding::Finding;
use crate::findings::{HOLE_MISSING, HOLE_TWICE};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::source::Span;
use gcode_part::Assumption;

/// The result of the checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Answer {
    /// No finding is an error.
    Pass,
    /// A finding is an error or an alarm.
    Fail,
}

impl Answer {
    /// Returns the answer to these findings.
    pub(super) fn to<'f>(mut findings: impl Iterator<Item = &'f Diagnostic>) -> Self {
        if findings.any(|finding| Severity::Error <= finding.severity) { Self::Fail } else { Self::Pass }
    }

    /// Returns the answer in capitals.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "PASS",
            Self::Fail => "FAIL",
        }
    }
}

/// End of the run that a verdict is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Ending {
    /// The program's end.
    End,
    /// An alarm stopped the control.
    Alarm,
    /// A limit of blocks, moves or time.
    Limit,
}

impl Ending {
    /// Returns the end of a run with these findings.
    pub(super) fn of<'f>(mut findings: impl Iterator<Item = &'f Diagnostic>) -> Self {
        match findings.find(|finding| finding.severity == Severity::Alarm) {
            None => Self::End,
            Some(finding) if finding.kind == &LIMIT => Self::Limit,
            Some(_) => Self::Alarm,
        }
    }
}

/// Conclusion of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conclusion<'v> {
    /// The answer.
    pub answer: Answer,
    /// The end of the run.
    pub ending: Ending,
    /// The reasons in one line, without the answer.
    pub summary: &'v str,
}

impl Conclusion<'_> {
    /// Returns `FAIL: 1 of 2 holes in tolerance, 1 missing`.
    pub fn line(&self) -> String {
        format!("{}: {}", self.answer.word(), self.summary)
    }
}

/// Words of a verdict's one line, in their order.
#[derive(Clone, Debug, Default)]
pub struct SummaryWords {
    /// Alarm or limit that ended the run.
    pub(super) stop: Option<String>,
    /// Errors that the comparison doesn't see: a missing end, denied assumptions.
    pub(super) added_errors: Vec<String>,
    /// Titles of the errors that no number counts.
    pub(super) errors: Option<String>,
    /// Numbers of holes or flutes.
    pub(super) counts: String,
    /// Names of what the verdict does not cover.
    pub(super) gaps: Vec<String>,
}

/// Largest number of assumptions in a summary.
const MAX_ASSUMED: usize = 3;

impl SummaryWords {
    /// Returns the reasons for an answer in one line. A pass is followed by all that its reader has to know: the kinds of the
    /// warnings, the assumptions, and what is not checked.
    pub(super) fn line(&self, answer: Answer, findings: &[Finding], assumptions: &[Assumption]) -> String {
        let Self { stop, added_errors, errors, counts, gaps } = self;
        let mut words: Vec<String> = stop.iter().chain(added_errors).chain(errors).cloned().collect();
        words.push(counts.clone());
        if answer == Answer::Pass {
            words.extend(warnings(findings));
            words.extend(assumed(assumptions));
        }
        words.extend((!gaps.is_empty()).then(|| format!("not checked: {}", gaps.join(", "))));
        words.join("; ")
    }
}

/// Returns `warnings: hole-twice (3 times), second-start`.
fn warnings(findings: &[Finding]) -> Option<String> {
    let is_shown = |one: &&Finding| !one.is_folded && one.severity == Severity::Warning.name();
    let warnings = findings.iter().filter(is_shown);
    let codes = counted(warnings.map(|finding| finding.code.as_ref()));
    (!codes.is_empty()).then(|| format!("warnings: {}", codes.join(", ")))
}

/// Returns `assumes #510, G55, H3 and 2 more`.
fn assumed(assumptions: &[Assumption]) -> Option<String> {
    let first: Vec<&str> = assumptions.iter().take(MAX_ASSUMED).map(|one| one.what.as_str()).collect();
    let more = match assumptions.len() - first.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!first.is_empty()).then(|| format!("assumes {}{more}", first.join(", ")))
}

/// Returns each word once, in the order of their first places, with its number if that is not 1: `hole-twice (3 times)`.
fn counted<'w>(words: impl Iterator<Item = &'w str>) -> Vec<String> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for word in words {
        match counts.iter_mut().find(|(known, _)| *known == word) {
            Some((_, count)) => *count += 1,
            None => counts.push((word, 1)),
        }
    }
    let shown = |(word, count): (&str, usize)| match count {
        1 => word.to_owned(),
        _ => format!("{word} ({count} times)"),
    };
    counts.into_iter().map(shown).collect()
}

/// Returns the sentence on an alarm or a limit that ended the run; `None` if it reached its end.
pub fn stop_sentence<'f>(
    mut findings: impl Iterator<Item = &'f Diagnostic>,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Option<String> {
    let stop = findings.find(|finding| finding.severity == Severity::Alarm)?;
    if stop.kind == &LIMIT {
        return Some(stop.message.clone());
    }
    let place = stop.backtrace.as_ref().map(|backtrace| {
        let (program, line) = locate(backtrace.block);
        format!(" in {program} line {line}")
    });
    Some(format!("alarm {}{}: {}", stop.code(), place.unwrap_or_default(), stop.message))
}

/// Largest number of kinds of errors in a summary.
const MAX_KINDS: usize = 3;

/// Returns the titles of the errors that no number of holes in the summary counts, with the number of each.
pub(super) fn uncounted_errors(findings: &[HoleFinding]) -> Option<String> {
    let is_counted = |one: &&HoleFinding| match one.subject {
        Subject::Nominal(_) | Subject::Extra(_) => true,
        Subject::Whole | Subject::Motion => [&HOLE_MISSING, &HOLE_TWICE].contains(&one.finding.kind),
    };
    let errors = findings.iter().filter(|one| one.finding.severity == Severity::Error);
    let words = |one| -> &str {
        let HoleFinding { finding, summary, .. }: &HoleFinding = one;
        summary.as_deref().unwrap_or(finding.kind.title)
    };
    let kinds = counted(errors.filter(|one| !is_counted(one)).map(words));
    let mut words: Vec<String> = kinds.iter().take(MAX_KINDS).cloned().collect();
    match kinds.len().saturating_sub(MAX_KINDS) {
        0 => {}
        1 => words.push("1 more kind of error".to_owned()),
        more => words.push(format!("{more} more kinds of errors")),
    }
    (!words.is_empty()).then(|| words.join(", "))
}

/// Returns `5 of 6 holes in tolerance, 1 missing, 2 extra`; without nominal holes what is judged instead.
pub(super) fn hole_counts(good: usize, missing: usize, extra: usize, nominal: usize) -> String {
    if nominal == 0 {
        let made = match extra {
            0 => String::new(),
            1 => "1 hole that no reference has; ".to_owned(),
            _ => format!("{extra} holes that no reference has; "),
        };
        return format!("{made}the motion in the stated stock is judged, no hole is compared (no reference)");
    }
    let noun = if nominal == 1 { "hole" } else { "holes" };
    let others = [(missing, "missing"), (extra, "extra")];
    let others = others.into_iter().filter(|(number, _)| *number != 0);
    let others: String = others.map(|(number, word)| format!(", {number} {word}")).collect();
    format!("{good} of {nominal} {noun} in tolerance{others}")
}
