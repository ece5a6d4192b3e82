//! The table of holes, with deviations if there is a reference, else with changes.
use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};

use super::rows::{HoleRowState, HoleTableRow, found_rows, judged_rows, paired_rows, tools_of};
use super::words::count;
use super::{Page, ReviewSide};

/// Number of unremarkable rows that are shown and printed at first; a button shows the others.
const SHOWN: usize = 200;
/// Number of printed rows, in the order on screen; page.css uses the same number.
const PRINTED: usize = 300;
/// Number of rows on the page.
const MOST_ROWS: usize = 5_000;

/// The table and the states of its holes for the drawing.
#[derive(Debug)]
pub(super) struct HoleTable {
    columns: Vec<String>,
    rows: Vec<HoleTableRow>,
    /// Number of rows omitted from the page.
    cut: usize,
}

impl HoleTable {
    pub(super) fn new(page: &Page<'_>, sides: &[ReviewSide<'_>]) -> Self {
        let verdicts: Option<Vec<_>> =
            sides.iter().map(|side| side.observed.verdict.map(|verdict| (*side, verdict))).collect();
        let tools = tools_of(sides);
        let pairs = page.old.map_or(&[][..], |(_, difference)| &difference.compared.holes);
        let (columns, mut rows) = match (page.reference, verdicts, page.old) {
            (Some(reference), Some(judged), _) => judged_rows(reference, &judged, sides, (pairs, &tools)),
            (_, _, Some(_)) => paired_rows(pairs, sides, &tools),
            _ => found_rows(sides, &tools),
        };
        let cut = rows.len().saturating_sub(MOST_ROWS);
        if cut > 0 {
            // Remarkable rows come first, each group in its own order.
            rows.sort_by_key(|row| !row.state.needs_attention());
            rows.truncate(MOST_ROWS);
        }
        Self { columns, rows, cut }
    }

    /// Returns row, name and state of each hole of a side.
    pub(super) fn of_side(&self, index: usize) -> BTreeMap<usize, (usize, &str, HoleRowState)> {
        let rows = self.rows.iter().enumerate();
        rows.filter_map(|(number, row)| Some((row.holes[index]?, (number, row.id.as_str(), row.state))))
            .collect()
    }

    pub(super) fn markup(&self, page: &Page<'_>) -> Markup {
        let calm = self.rows.iter().enumerate().filter(|(_, row)| !row.state.needs_attention());
        let hidden: BTreeSet<usize> = calm.skip(SHOWN).map(|(number, _)| number).collect();
        let seen = self.rows.len() - hidden.len();
        html! {
            @if self.rows.is_empty() { p { "The program makes no holes." } } @else {
                p.note {
                    "Lengths in mm, in the part's frame. "
                    @if page.reference.is_some() {
                        "φ is twice the largest distance between the actual and the nominal axis over the hole's depth (ISO 1101). "
                    } @else {
                        "Without a reference a hole begins where the cutting feed begins, and its depth counts from there. "
                    }
                    span.screen { "Click a row to go to the block that made the hole, a column head to sort." }
                }
                @if self.cut > 0 {
                    p.note { (count(self.cut as u64)) " rows are omitted: a page holds " (MOST_ROWS) ", the most relevant first." }
                }
                @if PRINTED < seen {
                    p.note.paper {
                        "The first " (PRINTED) " of " (count(seen as u64)) " rows are printed, in the order of the screen; the others are on the screen only."
                    }
                }
                div.scroll {
                    table.holes {
                        thead { tr {
                            @for (index, name) in ["Hole", "State"].into_iter().chain(self.columns.iter().map(String::as_str)).enumerate() {
                                th scope="col" aria-sort="none" data-column=(index) { button type="button" { (name) } }
                            }
                        } }
                        tbody {
                            @for (number, row) in self.rows.iter().enumerate() {
                                (row.markup(number, &self.columns, hidden.contains(&number)))
                            }
                        }
                    }
                }
                @if !hidden.is_empty() {
                    p.note #hidden-rows {
                        (count(hidden.len() as u64)) " more holes are neither shown nor printed; all holes with a difference or a fault are shown. "
                        button type="button" #show-rows { "Show all" }
                    }
                }
            }
        }
    }
}

impl HoleTableRow {
    fn markup(&self, number: usize, columns: &[String], more: bool) -> Markup {
        let to = self.cells.iter().rev().find_map(|cell| cell.links.first()).map(|(anchor, _)| anchor);
        html! {
            tr id={ "hole-" (number) } class=(self.state.class()) data-row=(number) hidden[more] {
                th scope="row" data-value=(self.id) {
                    @match to { Some(to) => a.go href={ "#" (to) } { (self.id) }, None => (self.id) }
                }
                td.state { (self.words) }
                @for (cell, name) in self.cells.iter().zip(columns) {
                    td.number[cell.value.is_some()].block[!cell.links.is_empty()] data-value=[cell.value] data-name=(name) {
                        (cell.text)
                        @for (index, (anchor, name)) in cell.links.iter().enumerate() {
                            @if index > 0 { " ← " }
                            a href={ "#" (anchor) } { (name) }
                        }
                    }
                }
            }
        }
    }
}
