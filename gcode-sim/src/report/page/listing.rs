//! The programs line by line, two revisions side by side, with execution counts and the values of variables.
use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};

use super::lines::{Part, Text};
use super::stops::stops;
use super::words::{count, value};
use super::{Page, ReviewSide, heading};
use gcode_control::Value;
use gcode_lang::source::SourceId;
use gcode_review::common_lines;
use gcode_session::{ExecutedBlock, VariableRole, VariableValues};

/// Number of rows of all programs together; beyond it only lines that the page links to are kept.
const MAX_ROWS: usize = 5_000;

/// Executed blocks of one side, by file and line.
struct ExecutedLines<'a> {
    blocks: BTreeMap<(SourceId, u32), Vec<&'a ExecutedBlock>>,
    /// Operator stops that the other side makes differently: the mark, and their number.
    stops: BTreeMap<(SourceId, u32), (&'static str, u64)>,
    /// Lines that holes, findings and those stops link to.
    linked_lines: BTreeSet<(SourceId, u32)>,
}

/// One file of each side, if present.
type TextPair<'a> = Vec<Option<&'a Text>>;

/// One line of each side, counted from 0.
type LinePair = Vec<Option<usize>>;

pub(super) fn listing(page: &Page<'_>, sides: &[ReviewSide<'_>]) -> Markup {
    let done: Vec<ExecutedLines<'_>> = sides.iter().map(|side| executed(page, side)).collect();
    let mut left = MAX_ROWS;
    html! {
        p.note {
            "Executed blocks have a bar and the number of executions. "
            code { "#1 5" } " is a variable's value before the block, " code { "#1 ← 5" } " its value after the block, "
            code { "→ #1 5" } " an argument of the called program; "
            code { "5 … 9 (3×)" } " are the first and the last of several values."
            span.paper {
                @if sides.len() == 1 { " Lines that were not executed are omitted in print." }
                @else { " Lines that neither program executed are omitted in print." }
            }
        }
        @for pair in pairs(sides) {
            (program(&pair, sides, &done, &mut left))
        }
    }
}

fn executed<'a>(page: &Page<'_>, side: &ReviewSide<'a>) -> ExecutedLines<'a> {
    let run = &side.observed.revision.simulation.run;
    let sources = run.control.memory().sources();
    let mut blocks: BTreeMap<(SourceId, u32), Vec<&ExecutedBlock>> = BTreeMap::new();
    for executed in side.observed.trace.blocks() {
        let line = sources.line_column(executed.block).line;
        blocks.entry((executed.block.source, line)).or_default().push(executed);
    }
    let holes = side.observed.revision.simulation.extracted.holes.iter().map(|hole| &hole.backtrace);
    let findings = &side.observed.revision.simulation.extracted.findings;
    let backtraces = holes.chain(findings.iter().filter_map(|finding| finding.backtrace.as_ref()));
    let spans = backtraces.flat_map(|backtrace| {
        std::iter::once(backtrace.block).chain(backtrace.calls.as_ref().map(|call| call.calling_block))
    });
    let mut linked_lines: BTreeSet<_> =
        spans.map(|span| (span.source, sources.line_column(span).line)).collect();
    let mut marked: BTreeMap<(SourceId, u32), (&str, u64)> = BTreeMap::new();
    for stop in stops(page, side) {
        if let (Some(mark), Some(line)) = (stop.mark, side.lines.of_location(&stop.location)) {
            marked.entry(line).or_insert((mark, 0)).1 += 1;
        }
    }
    linked_lines.extend(marked.keys());
    ExecutedLines { blocks, stops: marked, linked_lines }
}

/// Pairs the files that contain the same programs; the main programs always form a pair.
fn pairs<'a>(sides: &[ReviewSide<'a>]) -> Vec<TextPair<'a>> {
    let [old, new] = sides else {
        return sides.iter().flat_map(|side| side.lines.texts.iter().map(|text| vec![Some(text)])).collect();
    };
    let mut free: Vec<&Text> = old.lines.texts.iter().collect();
    let mut pairs: Vec<TextPair<'a>> = Vec::new();
    for (index, text) in new.lines.texts.iter().enumerate() {
        let same = |other: &&Text| {
            let main = other.source == SourceId::default();
            if index == 0 { main } else { !main && other.programs == text.programs }
        };
        let partner = free.iter().position(same).map(|at| free.remove(at));
        pairs.push(vec![partner, Some(text)]);
    }
    pairs.extend(free.into_iter().map(|text| vec![Some(text), None]));
    pairs
}

fn program(
    pair: &TextPair<'_>,
    sides: &[ReviewSide<'_>],
    done: &[ExecutedLines<'_>],
    left: &mut usize,
) -> Markup {
    let Some(named) = pair.iter().rev().flatten().next() else { return html! {} };
    let shown = listed_rows(in_order_of_run(lines(pair), pair), pair, done, left);
    html! {
        h3.program { (named.programs.join(", ")) }
        div.listing.two[sides.len() == 2] {
            div.row.names {
                @for (side, text) in sides.iter().zip(pair) {
                    div.half {
                        @if sides.len() == 2 { (heading(side, sides)) " " }
                        @match text { Some(text) => (text.name), None => "not present" }
                    }
                }
            }
            @for one in &shown {
                @match one {
                    ListingRow::Line(line) => (row(line, pair, sides, done)),
                    ListingRow::Gap(lines) => div.gap {
                        (count(*lines)) " lines are omitted here: a page holds " (MAX_ROWS)
                        " and those with a hole or a finding"
                    },
                    ListingRow::Unreached(lines) => div.gap {
                        (count(*lines)) " lines of programs that the run cannot reach are omitted"
                    },
                }
            }
        }
    }
}

/// A line, or the number of omitted lines.
enum ListingRow {
    Line(LinePair),
    Gap(u64),
    /// Lines of programs that no call can reach.
    Unreached(u64),
}

/// Sorts the lines of a file by what their program is to the run: the main program comes first. Edited lines count as called.
fn in_order_of_run(lines: Vec<LinePair>, pair: &TextPair<'_>) -> Vec<(Part, LinePair)> {
    let part = |line: &LinePair| {
        let halves = || line.iter().zip(pair).map(|(at, text)| Some((text.as_ref()?, (*at)?)));
        let part = halves().flatten().map(|(text, at)| text.part(at)).min().unwrap_or(Part::Main);
        let mut written = halves().map(|half| half.map(|(text, at)| &text.lines[at]));
        let first = written.next();
        if written.all(|other| Some(other) == first) { part } else { part.min(Part::Called) }
    };
    let mut all: Vec<_> = lines.into_iter().map(|line| (part(&line), line)).collect();
    all.sort_by_key(|(part, _)| *part);
    all
}

/// Returns the remaining number of lines, and the linked lines after them.
fn listed_rows(
    lines: Vec<(Part, LinePair)>,
    pair: &TextPair<'_>,
    done: &[ExecutedLines<'_>],
    left: &mut usize,
) -> Vec<ListingRow> {
    let mut all: Vec<ListingRow> = Vec::new();
    for (part, line) in lines {
        if part == Part::Unreached {
            match all.last_mut() {
                Some(ListingRow::Unreached(lines)) => *lines += 1,
                _ => all.push(ListingRow::Unreached(1)),
            }
            continue;
        }
        let is_linked =
            || line.iter().zip(pair).zip(done).any(|((at, text), done)| is_linked(*at, *text, done));
        if *left > 0 || is_linked() {
            *left = left.saturating_sub(1);
            all.push(ListingRow::Line(line));
        } else if let Some(ListingRow::Gap(lines)) = all.last_mut() {
            *lines += 1;
        } else {
            all.push(ListingRow::Gap(1));
        }
    }
    all
}

fn is_linked(at: Option<usize>, text: Option<&Text>, done: &ExecutedLines<'_>) -> bool {
    at.zip(text).is_some_and(|(at, text)| done.linked_lines.contains(&(text.source, at as u32 + 1)))
}

/// Aligns the lines of both files: equal ones side by side, changed ones between them.
fn lines(pair: &TextPair<'_>) -> Vec<LinePair> {
    let [Some(old), Some(new)] = pair.as_slice() else {
        let most = pair.iter().flatten().map(|text| text.lines.len()).max().unwrap_or(0);
        let is_there =
            |at: usize, text: &Option<&Text>| text.filter(|text| at < text.lines.len()).map(|_| at);
        return (0..most).map(|at| pair.iter().map(|text| is_there(at, text)).collect()).collect();
    };
    let mut all = Vec::new();
    let (mut i, mut j) = (0, 0);
    let ends = [(old.lines.len(), new.lines.len())];
    for (to_i, to_j) in common_lines(&old.lines, &new.lines).into_iter().chain(ends) {
        while i < to_i || j < to_j {
            all.push(vec![(i < to_i).then_some(i), (j < to_j).then_some(j)]);
            (i, j) = ((i + 1).min(to_i), (j + 1).min(to_j));
        }
        if to_i < old.lines.len() && to_j < new.lines.len() {
            all.push(vec![Some(to_i), Some(to_j)]);
        }
        (i, j) = (to_i + 1, to_j + 1);
    }
    all
}

/// Contents of one half of a row.
struct ListingCell<'a> {
    text: &'a str,
    count: u64,
    values: Vec<String>,
    stop: Option<String>,
}

fn cell<'a>(at: usize, text: &'a Text, done: &ExecutedLines<'_>) -> ListingCell<'a> {
    let executed = done.blocks.get(&(text.source, at as u32 + 1));
    let blocks = executed.into_iter().flatten();
    let mut values: Vec<String> = blocks
        .clone()
        .flat_map(|block| in_order(&block.values))
        .map(|values| describe_values(&values))
        .collect();
    values.extend(blocks.clone().any(|block| block.is_truncated).then(|| "and more variables".to_owned()));
    let times = blocks.map(|block| block.count).max().unwrap_or(0);
    let stop = done.stops.get(&(text.source, at as u32 + 1)).map(|(mark, stops)| match stops {
        1 => format!("stop {mark}"),
        _ => format!("{} stops {mark}", count(*stops)),
    });
    ListingCell { text: &text.lines[at], count: times, values, stop }
}

/// Sorts the values by role: read, assigned, passed.
fn in_order(values: &[VariableValues]) -> Vec<VariableValues> {
    let mut values = values.to_vec();
    values.sort_by_key(|values| values.role);
    values
}

fn describe_values(values: &VariableValues) -> String {
    let (before, sign) = match values.role {
        VariableRole::Read => ("", ""),
        VariableRole::Assigned => ("", "← "),
        VariableRole::Argument => ("→ ", ""),
    };
    let word = |one: Value| one.as_number().map_or_else(|| "vacant".to_owned(), value);
    let (first, last) = (word(values.first), word(values.last));
    let mut text = format!("{before}#{} {sign}{first}", values.number);
    let constant = first == last && values.range.is_none_or(|(low, high)| low == high);
    if !constant {
        text.push_str(&format!(" … {last} ({}×", values.count));
        if let Some((low, high)) = values.range {
            let outside = |bound: f64| ![values.first, values.last].contains(&Value::Number(bound));
            if outside(low) || outside(high) {
                text.push_str(&format!(", from {} to {}", value(low), value(high)));
            }
        }
        text.push(')');
    }
    text
}

fn row(line: &LinePair, pair: &TextPair<'_>, sides: &[ReviewSide<'_>], done: &[ExecutedLines<'_>]) -> Markup {
    let halves: Vec<Option<ListingCell<'_>>> = line
        .iter()
        .zip(pair)
        .zip(done)
        .map(|((at, text), done)| at.zip(*text).map(|(at, text)| cell(at, text, done)))
        .collect();
    let class = match halves.as_slice() {
        [Some(old), Some(new)] if old.text != new.text => "edited",
        [Some(old), Some(new)] if old.count != new.count || old.values != new.values => "differs",
        [Some(old), Some(new)] if old.stop.is_some() || new.stop.is_some() => "differs",
        [None, _] | [_, None] => "edited",
        _ => "same",
    };
    let idle = halves.iter().flatten().all(|half| half.count == 0);
    html! {
        div.row.(class).idle[idle] {
            @for (index, half) in halves.iter().enumerate() {
                @match (half, line[index], pair[index]) {
                    (Some(half), Some(at), Some(text)) => (cell_markup(half, at as u32 + 1, text, &sides[index])),
                    _ => div.half.nothing {},
                }
            }
        }
    }
}

fn cell_markup(half: &ListingCell<'_>, line: u32, text: &Text, side: &ReviewSide<'_>) -> Markup {
    html! {
        div.half.(side.word).done[half.count > 0] id=(side.lines.anchor(text.source, line)) tabindex="-1" {
            span.line { (line) }
            span.times { @if half.count > 0 { (count(half.count)) "×" } }
            code { (half.text) }
            @if let Some(stop) = &half.stop { strong.mark { (stop) } }
            @if !half.values.is_empty() {
                span.values { @for one in &half.values { span { (one) } " " } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(lines: &[&str]) -> Text {
        let lines = lines.iter().map(|line| (*line).to_owned()).collect();
        Text {
            source: SourceId(0),
            name: "O1.nc".to_owned(),
            programs: vec!["O0001".to_owned()],
            lines,
            parts: Vec::new(),
        }
    }

    #[test]
    fn equal_lines_are_side_by_side() {
        let (old, new) = (text(&["O1", "G0 X1.", "M30"]), text(&["O1", "G0 X2.", "G0 X3.", "M30"]));
        let expected =
            [vec![Some(0), Some(0)], vec![Some(1), Some(1)], vec![None, Some(2)], vec![Some(2), Some(3)]];
        assert_eq!(lines(&vec![Some(&old), Some(&new)]), expected);
        assert_eq!(lines(&vec![None, Some(&old)]).len(), 3);
    }

    /// Line 3 to 4 are the main program, line 5 that of a call, and nothing reaches the first program.
    #[test]
    fn the_main_program_comes_first() {
        let parts = vec![(1, Part::Unreached), (3, Part::Main), (5, Part::Called)];
        let new = Text { parts, ..text(&["%", "O1", "M30", "O2", "M98 P3", "O3"]) };
        let rows = |pair: &TextPair<'_>| {
            let rows = in_order_of_run(lines(pair), pair).into_iter();
            rows.map(|(part, line)| (part, line.last().copied().flatten())).collect::<Vec<_>>()
        };
        let [main, called, unreached] = [Part::Main, Part::Called, Part::Unreached];
        assert_eq!(
            rows(&vec![Some(&new)]),
            [(main, 3), (main, 4), (called, 5), (unreached, 0), (unreached, 1), (unreached, 2)]
                .map(|(part, line)| (part, Some(line)))
        );
        let old = Text { parts: new.parts.clone(), ..text(&["%", "O1", "M02", "O2", "M98 P3", "O3"]) };
        // An edited line is listed in any case.
        assert_eq!(
            rows(&vec![Some(&old), Some(&new)]),
            [(main, 3), (main, 4), (called, 2), (called, 5), (unreached, 0), (unreached, 1)]
                .map(|(part, line)| (part, Some(line)))
        );
    }

    #[test]
    fn values_are_described_by_first_last_and_extremes() {
        let number = Value::Number;
        let one = VariableValues {
            number: 7,
            role: VariableRole::Read,
            count: 1,
            first: number(2.5),
            last: number(2.5),
            range: Some((2.5, 2.5)),
            has_been_vacant: false,
        };
        assert_eq!(describe_values(&one), "#7 2.5");
        assert_eq!(describe_values(&VariableValues { role: VariableRole::Assigned, ..one }), "#7 ← 2.5");
        let several = VariableValues { count: 4, last: number(1.0), range: Some((1.0, 2.5)), ..one };
        assert_eq!(describe_values(&several), "#7 2.5 … 1 (4×)");
        assert_eq!(
            describe_values(&VariableValues { range: Some((-3.0, 2.5)), ..several }),
            "#7 2.5 … 1 (4×, from -3 to 2.5)"
        );
        let vacant = VariableValues { first: Value::Vacant, ..several };
        assert_eq!(describe_values(&vacant), "#7 vacant … 1 (4×, from 1 to 2.5)");
    }
}
