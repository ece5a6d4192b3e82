//! The changes between two revisions, each with its blocks and the calls that led to them.
use maud::{Markup, html};

use super::lines::Lines;
use super::words::shown;
use super::{Difference, MOST_CHANGES, ReviewSide, listed};
use gcode_review::{BlockLocation, Effect, UnexecutedChange};

pub(super) fn changes(difference: &Difference<'_>, sides: &[ReviewSide<'_>]) -> Markup {
    let all = &difference.compared.changes;
    html! {
        @if all.is_empty() {
            p { "No difference on the part or in the control's final state." }
        }
        @if MOST_CHANGES < all.len() {
            p.note {
                "The first " (MOST_CHANGES) " of " (all.len()) " changes are listed; "
                code { "gcode-sim diff --format json" } " lists them all."
            }
        }
        ol.changes {
            @for change in listed(all) {
                li {
                    code.code { (change.code) } " " (shown(&change.message))
                    (both(&change.old, &change.new, sides))
                    @if !change.also.is_empty() { (also(&change.also, sides)) }
                }
            }
        }
        @if !difference.unexecuted.is_empty() {
            h3 #unexecuted { "Changed blocks that neither run executed" }
            p.note { "Their effect is unknown: for example a guard that did not trigger or a branch not taken." }
            ol.changes {
                @for UnexecutedChange { old, new } in listed(difference.unexecuted) {
                    li { (both(old, new, sides)) }
                }
            }
            @if MOST_CHANGES < difference.unexecuted.len() {
                p.note { "The first " (MOST_CHANGES) " of " (difference.unexecuted.len()) " are listed." }
            }
        }
    }
}

/// Lists the further effects of the same edit.
fn also(effects: &[Effect], sides: &[ReviewSide<'_>]) -> Markup {
    html! {
        ul.also {
            @for Effect { code, message, old, new } in listed(effects) {
                li { "also " code.code { (code) } " " (shown(message)) (both(old, new, sides)) }
            }
        }
    }
}

/// Returns the block of the old and of the new revision.
fn both(old: &Option<BlockLocation>, new: &Option<BlockLocation>, sides: &[ReviewSide<'_>]) -> Markup {
    let of = |word: &str| sides.iter().find(|side| side.word == word).map(|side| side.lines);
    html! {
        @for (word, location) in [("old", old), ("new", new)] {
            @if let (Some(location), Some(lines)) = (location, of(word)) {
                div.place { span.word { (word) } " " (chain(location, lines)) }
            }
        }
    }
}

/// Returns a block and the calls that led to it, each a link to its line.
pub(super) fn chain(location: &BlockLocation, lines: &Lines) -> Markup {
    html! {
        (block(location, lines))
        @for call in &location.calls { div.call { "called from " (block(call, lines)) } }
    }
}

fn block(location: &BlockLocation, lines: &Lines) -> Markup {
    let name = format!("{}:{}", shown(&location.program), location.line);
    html! {
        @match lines.of_location(location) {
            Some((source, line)) => a href={ "#" (lines.anchor(source, line)) } { (name) },
            None => (name),
        }
        " " code { (shown(&location.block)) }
    }
}
