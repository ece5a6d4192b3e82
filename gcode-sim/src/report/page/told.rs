//! What the operator and the control have to say: stops, alarms, findings and printed lines of each run.
use maud::{Markup, html};

use super::changed::chain;
use super::stops::{Stop, stops};
use super::words::{shown, value};
use super::{Page, Side, heading};
use crate::changes::Where;
use crate::diag::{Diagnostic, Severity};
use crate::exec::printable;
use crate::motion::StopKind;

/// More of a kind than this aren't listed.
const MOST: usize = 200;

pub(super) fn told(page: &Page<'_>, sides: &[Side<'_>]) -> Markup {
    html! {
        div.sides {
            @for side in sides {
                div {
                    @if sides.len() == 2 { h3 { (heading(side, sides)) } }
                    (findings(side))
                    (listed(side, &stops(page, side)))
                    (printed(side))
                }
            }
        }
    }
}

fn findings(side: &Side<'_>) -> Markup {
    let of_run = &side.seen.revision.simulation.extracted.findings;
    let all: Vec<&Diagnostic> = match side.seen.verdict {
        Some(verdict) => verdict.diagnostics.iter().collect(),
        None => of_run.iter().collect(),
    };
    html! {
        h4 { "Alarms and findings" }
        @if all.is_empty() { p { "None." } }
        ul.findings {
            @for finding in all.iter().take(MOST) {
                li class=(finding.severity.name()) {
                    strong { (finding.severity.name()) } " " code.code { (shown(&finding.code)) } " "
                    (shown(&finding.message))
                    @if let Some(place) = &finding.place {
                        div.place { (chain(&Where::of(&side.seen.revision.simulation.run, place), side.lines)) }
                    }
                    @for note in &finding.notes { div.more { (shown(note)) } }
                    @if let (Some(help), true) = (&finding.help, finding.severity != Severity::Note) {
                        div.more { "Remedy: " (shown(help)) }
                    }
                }
            }
        }
        (rest(all.len(), "findings"))
    }
}

fn listed(side: &Side<'_>, known: &[Stop<'_>]) -> Markup {
    let all = side.seen.revision.simulation.run.control.stops();
    html! {
        h4 { "Operator stops" }
        @if all.is_empty() { p { "None." } }
        ol.stops {
            @for (number, stop) in all.iter().take(MOST).enumerate() {
                li {
                    code {
                        @match stop.kind {
                            StopKind::M00 => "M00",
                            StopKind::M01 => "M01",
                            StopKind::Message => "#3006",
                        }
                    }
                    " " (shown(&stop.text))
                    @for (number, number_value) in &stop.named { ", #" (number) " = " (value(*number_value)) }
                    @if let Some(stop) = known.get(number) {
                        @if let Some(mark) = stop.mark { " " strong.mark { (mark) } }
                        div.place { (chain(stop.place, side.lines)) }
                    }
                }
            }
        }
        (rest(all.len(), "stops"))
    }
}

fn printed(side: &Side<'_>) -> Markup {
    let all = side.seen.revision.simulation.run.control.output();
    html! {
        @if !all.is_empty() {
            h4 { "Printed" }
            pre { @for line in all.iter().take(MOST) { (shown(&printable(line))) "\n" } }
            (rest(all.len(), "printed lines"))
        }
    }
}

fn rest(all: usize, what: &str) -> Markup {
    html! { @if MOST < all { p.note { "The first " (MOST) " of " (all) " " (what) " are listed." } } }
}
