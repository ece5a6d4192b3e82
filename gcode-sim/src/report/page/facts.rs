//! The head of the page: the answer, and both runs in numbers.
use maud::{Markup, html};

use super::messages;
use super::words::{count, duration, shown};
use super::{Page, ReviewSide, heading};
use crate::report::figures;
use gcode_inspect::verify::Answer;
use gcode_part::Total;

/// Returns the answer in one or two lines.
pub(super) fn answer(page: &Page<'_>, sides: &[ReviewSide<'_>]) -> Markup {
    let difference = page.old.map(|(_, difference)| difference);
    html! {
        @if let Some(difference) = difference {
            @let changes = difference.compared.changes.len();
            p.answer.yes[changes == 0].no[changes != 0] {
                @if changes == 0 { "No difference on the part or in the control's final state" } @else { (figures::count(changes, "change")) }
            }
        }
        @if let Some(difference) = difference && !difference.unexecuted.is_empty() {
            p.answer {
                "Executed by neither run, effect unknown: "
                a href="#unexecuted" { (figures::count(difference.unexecuted.len(), "changed block")) }
            }
        }
        @for side in sides {
            @let record = &side.observed.revision.record;
            @if let Some(verdict) = side.observed.verdict {
                @let conclusion = verdict.conclusion();
                p.answer.yes[conclusion.answer == Answer::Pass].no[conclusion.answer == Answer::Fail] {
                    @if sides.len() == 2 { (heading(side, sides)) ": " }
                    (conclusion.answer.word()) ", " (shown(conclusion.summary))
                }
                @for cause in &verdict.likely_causes { p.note { "Likely cause: " (shown(cause)) } }
            } @else {
                @if record.outcome() != "end" {
                    p.answer.no {
                        @if sides.len() == 2 { (heading(side, sides)) ": " }
                        "stopped, " (shown(record.words()))
                    }
                }
                @if page.old.is_none() && let Some(worst) = messages::worst_findings(side) {
                    p.answer.no[messages::has_errors(side)] { a href="#messages" { (worst) } }
                }
            }
        }
        @let assumed: usize = sides.iter().map(|side| assumptions(page, side).len()).sum();
        @if 0 < assumed { p.note { a href="#assumptions" { "Assumes " (figures::count(assumed, "value")) } " that the program does not set" } }
    }
}

/// Returns what the results of a side assume; a comparison of two programs without a reference assumes nothing.
fn assumptions(page: &Page<'_>, side: &ReviewSide<'_>) -> Vec<String> {
    if let Some(verdict) = side.observed.verdict {
        let total = Total::Holes(verdict.holes.len() + verdict.extra.len());
        return verdict.assumptions.iter().map(|assumption| assumption.sentence(total)).collect();
    }
    if page.old.is_some() {
        return Vec::new();
    }
    let simulation = &side.observed.revision.simulation;
    let found = simulation.dependencies(side.observed.request);
    let numbered = found.numbered(&simulation.run);
    numbered.iter().map(|(assumption, _)| assumption.sentence(Total::Holes(found.count()))).collect()
}

/// Returns the table of both runs in numbers.
pub(super) fn summary(page: &Page<'_>, sides: &[ReviewSide<'_>]) -> Markup {
    let row = |name: &str, value: &dyn Fn(&ReviewSide<'_>) -> String| {
        html! {
            tr {
                th scope="row" { (name) }
                @for side in sides { td { (value(side)) } }
            }
        }
    };
    let totals = |side: &ReviewSide<'_>| side.observed.revision.record.totals.clone();
    html! {
        div.scroll {
            table.facts {
                @if sides.len() == 2 {
                    thead { tr { td {} @for side in sides { th scope="col" { (heading(side, sides)) } } } }
                }
                tbody {
                    (row("Program", &|side| shown(&side.observed.request.name)))
                    (row("Run", &|side| shown(side.observed.revision.record.words())))
                    (row("Holes", &|side| count(totals(side).holes as u64)))
                    (row("Moves", &|side| count(totals(side).moves)))
                    (row("Blocks executed", &|side| count(totals(side).blocks)))
                    (row("Time, without acceleration", &|side| duration(totals(side).seconds)))
                    (row("Operator stops", &|side| count(side.observed.revision.simulation.run.control.stops().len() as u64)))
                    @if sides.iter().any(|side| side.observed.verdict.is_some()) {
                        (row("Worst position", &worst))
                        @if sides.iter().any(|side| side.observed.verdict.is_some_and(|v| !v.not_checked.is_empty())) {
                            (row("Not checked", &|side| side.observed.verdict.map_or_else(String::new, |v| v.not_checked.join("; "))))
                        }
                    }
                }
            }
        }
        @if sides.iter().any(|side| !assumptions(page, side).is_empty()) {
            div #assumptions {
                @for side in sides {
                    @for assumption in assumptions(page, side) {
                        p.note {
                            @if sides.len() == 2 { (heading(side, sides)) ": assumes " } @else { "Assumes " }
                            (shown(&assumption))
                        }
                    }
                }
            }
        }
        @if let Some((_, difference)) = page.old {
            p.note {
                "Differences of up to " (difference.tolerance)
                " (mm, and degrees for rotary axes) count as equal. Sequence numbers, spaces, comments and the way "
                "numbers are written are ignored."
            }
        }
    }
}

/// Returns `Φ0.0012, tolerance Φ0.1: hole 3`.
fn worst(side: &ReviewSide<'_>) -> String {
    let Some(verdict) = side.observed.verdict else { return String::new() };
    let Some(worst) = verdict.worst else { return "no hole found".to_owned() };
    let from = verdict.worst_from.as_deref().unwrap_or_default();
    format!("Φ{}, tolerance Φ{}: {}", figures::rounded(worst, 4), verdict.tolerance, shown(from))
}
