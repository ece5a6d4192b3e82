//! Messages of each run: operator stops, alarms, findings and printed lines.
use std::cmp::Reverse;
use std::collections::BTreeSet;

use maud::{Markup, html};

use super::changed::chain;
use super::stops::{Stop, stops};
use super::words::{shown, value};
use super::{Page, ReviewSide, heading};
use crate::report::figures;
use gcode_control::printable;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::StopKind;
use gcode_review::BlockLocation;

/// Number of messages of one kind that are listed.
const MAX_LISTED: usize = 200;

pub(super) fn messages(page: &Page<'_>, sides: &[ReviewSide<'_>]) -> Markup {
    html! {
        div.sides {
            @for side in sides {
                div {
                    @if sides.len() == 2 { h3 { (heading(side, sides)) } }
                    (findings(side, sides))
                    (stop_list(side, &stops(page, side)))
                    (printed_lines(side))
                }
            }
        }
    }
}

/// Returns the findings of a run or of its verdict, most severe first.
fn findings_of<'a>(side: &ReviewSide<'a>) -> Vec<&'a Diagnostic> {
    let revision = side.observed.revision;
    let mut all: Vec<&Diagnostic> = match side.observed.verdict {
        Some(verdict) => verdict.diagnostics.iter().collect(),
        None => revision.simulation.findings_without_reference().collect(),
    };
    all.extend(&revision.truncation);
    all.sort_by_key(|finding| Reverse(finding.severity));
    all
}

/// Returns the numbers of errors and warnings, `2 errors, 1 warning`; `None` without any.
pub(super) fn worst_findings(side: &ReviewSide<'_>) -> Option<String> {
    figures::finding_counts(findings_of(side).into_iter())
}

/// Returns true if a run has an error; warnings and notes, as on ordinary milling, are no fault.
pub(super) fn has_errors(side: &ReviewSide<'_>) -> bool {
    findings_of(side).first().is_some_and(|worst| Severity::Error <= worst.severity)
}

fn findings(side: &ReviewSide<'_>, sides: &[ReviewSide<'_>]) -> Markup {
    let all = findings_of(side);
    let other = sides.iter().find(|other| other.word != side.word);
    let key = |side: &ReviewSide<'_>, finding: &Diagnostic| {
        let backtrace = finding.backtrace.as_ref();
        let block = backtrace
            .map(|backtrace| BlockLocation::of(&side.observed.revision.simulation.run, backtrace).block);
        (finding.code(), finding.message.clone(), block)
    };
    let known: Option<BTreeSet<_>> =
        other.map(|other| findings_of(other).into_iter().map(|finding| key(other, finding)).collect());
    let is_new =
        |finding: &Diagnostic| known.as_ref().is_some_and(|known| !known.contains(&key(side, finding)));
    let mark = |finding: &Diagnostic| {
        let word = other.map_or("", |other| other.word);
        html! { @if is_new(finding) { " " strong.mark { "not in the " (word) " program" } } }
    };
    let one = |finding: &Diagnostic| {
        html! {
            (shown(&finding.message)) (mark(finding))
            @if let Some(backtrace) = &finding.backtrace {
                div.place { (chain(&BlockLocation::of(&side.observed.revision.simulation.run, backtrace), side.lines)) }
            }
        }
    };
    html! {
        h4 { "Alarms and findings" }
        @if all.is_empty() { p { "None." } }
        ul.findings {
            @for alike in groups(all.get(..MAX_LISTED).unwrap_or(&all)) {
                @let finding = alike[0];
                li class=(finding.severity.name()) {
                    strong { (finding.severity.name()) } " " code.code { (shown(&finding.code())) } " "
                    @if alike.len() > 1 { "(" (alike.len()) "×) " }
                    (one(finding))
                    @for note in &finding.notes { div.more { (shown(note)) } }
                    @if let (Some(help), true) = (&finding.help, finding.severity != Severity::Note) {
                        div.more { "Remedy: " (shown(help)) }
                    }
                    @if alike.len() > 1 { ul { @for finding in &alike[1..] { li { (one(finding)) } } } }
                }
            }
        }
        (truncation_note(all.len(), "findings"))
    }
}

/// Groups warnings and notes of one code at the first of them; errors stay separate.
fn groups<'a>(all: &[&'a Diagnostic]) -> Vec<Vec<&'a Diagnostic>> {
    let mut groups: Vec<Vec<&Diagnostic>> = Vec::new();
    for finding in all {
        let is_alike = |first: &Diagnostic| {
            finding.severity < Severity::Error
                && first.severity == finding.severity
                && first.kind == finding.kind
                && (&first.help, &first.notes) == (&finding.help, &finding.notes)
        };
        match groups.iter_mut().find(|group| is_alike(group[0])) {
            Some(group) => group.push(finding),
            None => groups.push(vec![finding]),
        }
    }
    groups
}

fn stop_list(side: &ReviewSide<'_>, known: &[Stop<'_>]) -> Markup {
    let all = side.observed.revision.simulation.run.control.stops();
    html! {
        h4 { "Operator stops" }
        @if all.is_empty() { p { "None." } }
        ol.stops {
            @for (number, stop) in all.iter().take(MAX_LISTED).enumerate() {
                li {
                    code {
                        @match stop.kind {
                            StopKind::M00 => "M00",
                            StopKind::M01 => "M01",
                            StopKind::Message => "#3006",
                        }
                    }
                    " " (shown(&stop.text))
                    @for (number, number_value) in &stop.variables { ", #" (number) " = " (value(*number_value)) }
                    @if let Some(stop) = known.get(number) {
                        @if let Some(mark) = stop.mark { " " strong.mark { (mark) } }
                        div.place { (chain(&stop.location, side.lines)) }
                    }
                }
            }
        }
        (truncation_note(all.len(), "stops"))
    }
}

fn printed_lines(side: &ReviewSide<'_>) -> Markup {
    let all = side.observed.revision.simulation.run.control.output();
    html! {
        @if !all.is_empty() {
            h4 { "Printed" }
            pre { @for line in all.iter().take(MAX_LISTED) { (shown(&printable(line))) "\n" } }
            (truncation_note(all.len(), "printed lines"))
        }
    }
}

fn truncation_note(all: usize, what: &str) -> Markup {
    html! { @if MAX_LISTED < all { p.note { "The first " (MAX_LISTED) " of " (all) " " (what) " are listed." } } }
}
