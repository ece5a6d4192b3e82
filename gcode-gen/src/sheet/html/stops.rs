//! The operator stops in order: message, actions, a box to tick.
use gcode_part::job::Job;
use gcode_sim::report::figures::{count, rounded};
use maud::{Markup, html};

use super::{cell, table};
use crate::sheet::Sheet;
use crate::sheet::record::OperatorStop;
use crate::sheet::stop_instructions::instructions;

pub(super) fn stops(sheet: &Sheet<'_>) -> Markup {
    let stops = &sheet.record.stops;
    let waiting = &sheet.record.alarmed_programs;
    if stops.is_empty() {
        return html! {
            h2 { "Operator stops" }
            @if waiting.len() < sheet.package.mains.len() {
                p { "No operator stop between start and end." }
            }
            (unknown(waiting))
        };
    }
    let rows = stops.iter().enumerate().map(|(index, stop)| {
        vec![
            html! { (index + 1) },
            shown(stop),
            html! { @if let Some(tool) = stop.tool { "T" (tool) } },
            html! { ol { @for step in instructions(sheet.job, stop) { li { (step) } } } },
            cell(rounded(stop.elapsed / 60.0, 1)),
            html! { span.tick {} },
        ]
    });
    html! {
        h2 { "Operator stops and actions" }
        @if let Job::Alignment(_) = sheet.job { (order_of_the_work()) }
        p { (count(stops.len(), "stop")) ", in this order. The minutes are the running time before the stop." }
        (table(&["#stop", "the control shows", "tool", "action", "#min", "done"], rows))
        (unknown(waiting))
    }
}

/// Returns the sequence of the alignment programs: each needs the corrections of those before it.
fn order_of_the_work() -> Markup {
    html! {
        p {
            "Sequence: O8210 run-out, O8230 sine table, O8210 again; O8200 chord; O8220 ellipse; then the part's own "
            "programs, which have a sheet of their own. Stops and minutes are the minimum: every further O8230 with its O8210 adds "
            "its own."
        }
        p {
            b { "Marks on the part " } "are measured by hand after the last O8210, with the rotary at 0, in work coordinates of the surface: before O8200 is "
            "started make #578 vacant, then write x, y and z of each candidate, E's from #501 on, F's from #531 on. Without marks #501 to #560 and #578 are "
            "made vacant, and O8200 touches the points itself, which gives Y alone."
        }
    }
}

/// Returns a note on programs that could not be simulated to their ends.
fn unknown(waiting: &[String]) -> Markup {
    html! {
        @if !waiting.is_empty() {
            p {
                "Unknown for " (waiting.join(", ")) ", which ends in an alarm on a part in its nominal position: read its comments."
            }
        }
    }
}

/// Returns the message as the control shows it, and its block and calls.
fn shown(stop: &OperatorStop) -> Markup {
    let at =
        stop.locations.iter().map(|(program, line)| format!("{program} line {line}")).collect::<Vec<_>>();
    html! {
        b { (stop.kind.name()) } " " span.mono { (stop.text) }
        div.note { (at.join(", called from ")) }
    }
}
