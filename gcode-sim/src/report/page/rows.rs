//! Rows of the table of holes: against a reference, of two revisions, or of one program.
use std::collections::BTreeMap;

use super::words::shown;
use super::{ReviewSide, heading};
use crate::report::figures::{rounded, signed};
use crate::report::hole_changes::{self, remarks};
use gcode_draw::HoleStatus;
use gcode_inspect::findings::{FEATURE_DEPTH, HOLE_DEPTH};
use gcode_inspect::holes::DrilledHole;
use gcode_inspect::verify::{ExtraHole, Finding, HoleVerdict, Verdict};
use gcode_part::Reference;
use gcode_review::Paired;

/// State of a hole, most important first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum HoleRowState {
    Bad,
    Missing,
    Extra,
    Changed,
    /// In tolerance, but changed.
    Altered,
    Good,
    Same,
    Unjudged,
}

impl HoleRowState {
    /// Returns the CSS class of the state, and the status that the drawing shows.
    fn shown(self) -> (&'static str, HoleStatus) {
        match self {
            Self::Bad => ("bad", HoleStatus::Bad),
            Self::Missing => ("missing", HoleStatus::Missing),
            Self::Extra => ("extra", HoleStatus::Extra),
            Self::Changed => ("changed", HoleStatus::Bad),
            Self::Altered => ("altered", HoleStatus::Bad),
            Self::Good => ("good", HoleStatus::Good),
            Self::Same => ("same", HoleStatus::Good),
            Self::Unjudged => ("unjudged", HoleStatus::Unjudged),
        }
    }

    pub(super) fn class(self) -> &'static str {
        self.shown().0
    }

    pub(super) fn status(self) -> HoleStatus {
        self.shown().1
    }

    pub(super) fn needs_attention(self) -> bool {
        !matches!(self, Self::Good | Self::Same | Self::Unjudged)
    }
}

/// One cell: text, sort value and links.
#[derive(Clone, Debug, Default)]
pub(super) struct Cell {
    pub text: String,
    pub value: Option<f64>,
    /// Anchor and name of each link.
    pub links: Vec<(String, String)>,
}

impl Cell {
    fn number(value: f64, decimals: usize) -> Self {
        Self { text: rounded(value, decimals), value: Some(value), links: Vec::new() }
    }

    fn optional(value: Option<f64>, decimals: usize) -> Self {
        value.map_or_else(Self::default, |value| Self::number(value, decimals))
    }

    fn signed(value: Option<f64>) -> Self {
        value.map_or_else(Self::default, |value| Self { text: signed(value), ..Self::number(value, 4) })
    }
}

#[derive(Clone, Debug)]
pub(super) struct HoleTableRow {
    pub id: String,
    pub state: HoleRowState,
    pub words: String,
    pub cells: Vec<Cell>,
    /// Index of the hole on each side.
    pub holes: Vec<Option<usize>>,
}

/// Returns links to the block that finished a hole and to the call of its program.
fn block_cell(side: &ReviewSide<'_>, found: &DrilledHole) -> Cell {
    let run = &side.observed.revision.simulation.run;
    let mut links = Vec::new();
    let calls = found.backtrace.calls.as_ref().map(|call| call.calling_block);
    for span in std::iter::once(found.backtrace.block).chain(calls) {
        let (program, line) = run.locate(span);
        links.push((side.lines.of_span(run, span), format!("{}:{line}", shown(&program))));
    }
    let text = String::new();
    Cell { text, value: None, links }
}

fn drilled_hole<'a>(side: &ReviewSide<'a>, hole: usize) -> &'a DrilledHole {
    &side.observed.revision.simulation.extracted.holes[hole]
}

/// Returns `Block`, or `Old block` and `New block`.
fn side_title(name: &str, side: &ReviewSide<'_>, sides: &[ReviewSide<'_>]) -> String {
    if sides.len() == 1 {
        name.to_owned()
    } else {
        format!("{} {}", heading(side, sides), name.to_lowercase())
    }
}

/// Returns the tools of each hole of each side; a repeated pass on another hole has its own tool.
pub(super) fn tools_of(sides: &[ReviewSide<'_>]) -> Vec<Vec<Vec<u32>>> {
    let of = |side: &ReviewSide<'_>| {
        let holes = &side.observed.revision.simulation.extracted.holes;
        let made = side.observed.revision.record.made_by().into_iter().zip(holes);
        made.map(|(tools, hole)| if tools.is_empty() { hole.tool.into_iter().collect() } else { tools })
            .collect()
    };
    sides.iter().map(of).collect()
}

/// Returns the cells for position, depth, diameter and tools of a hole.
fn description_cells(found: Option<&DrilledHole>, tools: &[u32]) -> Vec<Cell> {
    let entry = |axis: usize| Cell::optional(found.map(|found| found.entry[axis]), 3);
    vec![
        entry(0),
        entry(1),
        entry(2),
        Cell::optional(found.map(|found| found.depth), 3),
        Cell::optional(found.and_then(|found| found.diameter), 2),
        Cell {
            text: hole_changes::tools(tools),
            value: tools.last().copied().map(f64::from),
            links: Vec::new(),
        },
    ]
}

const DESCRIPTION_COLUMNS: [&str; 6] = ["X", "Y", "Z", "Depth", "Φ", "Tools"];

/// Index of the tools among these cells.
const TOOL: usize = 5;

pub(super) fn found_rows(
    sides: &[ReviewSide<'_>],
    tools: &[Vec<Vec<u32>>],
) -> (Vec<String>, Vec<HoleTableRow>) {
    let Some(side) = sides.last() else { return (Vec::new(), Vec::new()) };
    let holes = side.observed.revision.simulation.extracted.holes.iter().enumerate();
    let rows = holes.map(|(number, hole)| {
        let mut cells = description_cells(Some(hole), tools.last().map_or(&[], |tools| &tools[number]));
        cells.push(block_cell(side, hole));
        let words = "not verified".to_owned();
        HoleTableRow {
            id: (number + 1).to_string(),
            state: HoleRowState::Unjudged,
            words,
            cells,
            holes: vec![Some(number)],
        }
    });
    (DESCRIPTION_COLUMNS.map(str::to_owned).into_iter().chain(["Block".to_owned()]).collect(), rows.collect())
}

/// Returns the rows of two revisions.
pub(super) fn paired_rows(
    pairs: &[Paired],
    sides: &[ReviewSide<'_>],
    tools: &[Vec<Vec<u32>>],
) -> (Vec<String>, Vec<HoleTableRow>) {
    let [old, new] = sides else { return (Vec::new(), Vec::new()) };
    let mut columns = DESCRIPTION_COLUMNS.map(str::to_owned).to_vec();
    columns.extend(["Moved", "Tilted °", "Deeper"].map(str::to_owned));
    columns.extend([side_title("Block", old, sides), side_title("Block", new, sides)]);
    let row = |pair: &Paired| {
        let (was, is) =
            (pair.old.map(|hole| drilled_hole(old, hole)), pair.new.map(|hole| drilled_hole(new, hole)));
        let both = pair.old.is_some() && pair.new.is_some();
        let made = |side: usize, hole: Option<usize>| hole.map_or(&[][..], |hole| &tools[side][hole]);
        let (before, now) = (made(0, pair.old), made(1, pair.new));
        let mut cells = description_cells(is.or(was), if is.is_some() { now } else { before });
        if both && before != now {
            let [before, now] = [before, now].map(hole_changes::tools);
            cells[TOOL].text = format!("{before} → {now}");
        }
        cells.extend([
            Cell::optional(both.then_some(pair.moved), 4),
            Cell::optional(both.then_some(pair.tilted.0), 4),
            Cell::signed(both.then_some(pair.deeper)),
            was.map_or_else(Cell::default, |hole| block_cell(old, hole)),
            is.map_or_else(Cell::default, |hole| block_cell(new, hole)),
        ]);
        let remarks = remarks(pair, was.zip(Some(before)), is.zip(Some(now))).join("; ");
        let (id, state, words) = match (pair.old, pair.new) {
            (Some(hole), None) => (format!("{}", hole + 1), HoleRowState::Missing, "lost".to_owned()),
            (None, Some(hole)) => (format!("new {}", hole + 1), HoleRowState::Extra, "added".to_owned()),
            (Some(hole), Some(_)) if pair.changed => {
                (format!("{}", hole + 1), HoleRowState::Changed, remarks)
            }
            (hole, _) => {
                let id = hole.map_or_else(String::new, |hole| (hole + 1).to_string());
                (id, HoleRowState::Same, "same".to_owned())
            }
        };
        HoleTableRow { id, state, words, cells, holes: vec![pair.old, pair.new] }
    };
    (columns, pairs.iter().map(row).collect())
}

/// Returns a row for each nominal hole with its deviations on each side, and the rows of extra holes.
pub(super) fn judged_rows(
    reference: &Reference,
    judged: &[(ReviewSide<'_>, &Verdict)],
    sides: &[ReviewSide<'_>],
    (pairs, tools): (&[Paired], &[Vec<Vec<u32>>]),
) -> (Vec<String>, Vec<HoleTableRow>) {
    let changed: BTreeMap<usize, &Paired> =
        pairs.iter().filter(|pair| pair.changed).filter_map(|pair| Some((pair.new?, pair))).collect();
    // Returns the changes of a hole on the new side.
    let different = |hole: &HoleVerdict| {
        let pair = changed.get(&hole.drilled_index)?;
        let [old, new] = sides else { return None };
        let made = |side, number: usize, side_index: usize| {
            (drilled_hole(side, number), tools[side_index][number].as_slice())
        };
        let was = pair.old.map(|hole| made(old, hole, 0));
        Some(remarks(pair, was, pair.new.map(|hole| made(new, hole, 1)))).filter(|words| !words.is_empty())
    };
    let by_id: Vec<BTreeMap<&str, &HoleVerdict>> =
        judged.iter().map(|(_, v)| v.holes.iter().map(|hole| (hole.id.as_str(), hole)).collect()).collect();
    let mut columns: Vec<String> = sides.iter().map(|side| side_title("φ", side, sides)).collect();
    columns.extend((sides.len() == 2).then(|| "Change of φ".to_owned()));
    columns.extend(["Deviation at entry", "Deviation at bottom", "Depth error", "Tilt °"].map(str::to_owned));
    columns.extend(sides.iter().map(|side| side_title("Block", side, sides)));
    let nominal = reference.holes.iter().map(|hole| {
        let id = hole.id.as_deref().unwrap_or_default();
        let found_by: Vec<Option<&HoleVerdict>> = by_id.iter().map(|holes| holes.get(id).copied()).collect();
        let is = found_by.last().copied().flatten();
        let mut cells: Vec<Cell> =
            found_by.iter().map(|hole| Cell::optional(hole.map(|hole| hole.position_deviation), 4)).collect();
        if let [was, is] = found_by.as_slice() {
            cells.push(Cell::signed(
                was.zip(*is).map(|(was, is)| is.position_deviation - was.position_deviation),
            ));
        }
        cells.extend([
            Cell::optional(is.map(|hole| hole.at_entry), 4),
            Cell::optional(is.map(|hole| hole.at_bottom), 4),
            match is {
                Some(hole) if hole.is_breakthrough() => {
                    Cell { text: "through".to_owned(), ..Cell::default() }
                }
                _ => Cell::signed(is.map(|hole| hole.depth_error)),
            },
            Cell::optional(is.map(|hole| hole.tilt), 4),
        ]);
        cells.extend(judged.iter().zip(&found_by).map(|((side, _), hole)| {
            hole.map_or_else(Cell::default, |hole| block_cell(side, drilled_hole(side, hole.drilled_index)))
        }));
        let (state, words) = match (is, is.and_then(different)) {
            (None, _) => (HoleRowState::Missing, "missing".to_owned()),
            (Some(hole), Some(words)) if hole.ok => {
                (HoleRowState::Altered, format!("in tolerance, but: {}", words.join("; ")))
            }
            (Some(hole), None) if hole.ok => {
                let is_again = |(_, verdict): &(_, &Verdict)| verdict.repeated.iter().any(|(_, of)| of == id);
                let again = if judged.last().is_some_and(is_again) { "; drilled a second time" } else { "" };
                (HoleRowState::Good, format!("in tolerance{again}"))
            }
            (Some(hole), _) => (HoleRowState::Bad, faults(hole, judged.last().map(|(_, verdict)| *verdict))),
        };
        let holes = found_by.iter().map(|hole| hole.map(|hole| hole.drilled_index)).collect();
        HoleTableRow { id: shown(id), state, words, cells, holes }
    });
    let mut rows: Vec<HoleTableRow> = nominal.collect();
    for (side_index, (side, verdict)) in judged.iter().enumerate() {
        rows.extend(extra_rows(side_index, side, verdict, columns.len(), sides));
    }
    (columns, rows)
}

/// Returns the rows of extra holes.
fn extra_rows(
    side_index: usize,
    side: &ReviewSide<'_>,
    verdict: &Verdict,
    columns: usize,
    sides: &[ReviewSide<'_>],
) -> Vec<HoleTableRow> {
    let of_old = sides.len() == 2 && side_index == 0;
    let row = |(number, extra): (usize, &ExtraHole)| {
        let mut cells = vec![Cell::default(); columns - sides.len()];
        let block = block_cell(side, drilled_hole(side, extra.drilled_index));
        cells.extend(
            (0..sides.len()).map(|at| if at == side_index { block.clone() } else { Cell::default() }),
        );
        let mut holes = vec![None; sides.len()];
        holes[side_index] = Some(extra.drilled_index);
        let (of, words) = if of_old { ("old ", "extra in the old") } else { ("", "extra") };
        let id = format!("{of}extra {}", number + 1);
        HoleTableRow {
            id,
            state: HoleRowState::Extra,
            words: format!("{words}: {}", shown(&extra.why)),
            cells,
            holes,
        }
    };
    verdict.extra.iter().enumerate().map(row).collect()
}
/// Returns the faults of a hole in words, each once. Its depth error is that of the whole hole: a wrong depth has the
/// words of its finding, which may be about one of its features.
fn faults(hole: &HoleVerdict, verdict: Option<&Verdict>) -> String {
    let title = |code: &&'static str| {
        let finding = verdict?.diagnostics.iter().find(|finding| finding.kind.code == *code)?;
        Some(finding.kind.title)
    };
    let own = |code: &&'static str| {
        let of_depth = [HOLE_DEPTH.code, FEATURE_DEPTH.code].contains(code);
        let is_own = |one: &&Finding| one.code == *code && one.hole.as_deref() == Some(hole.id.as_str());
        let finding = verdict?.findings.iter().filter(|_| of_depth).find(is_own)?;
        Some(finding.message.as_str())
    };
    let mut words: Vec<&str> = Vec::new();
    for code in &hole.error_codes {
        let word = own(code).or_else(|| title(code)).unwrap_or(code);
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words.join("; ")
}
