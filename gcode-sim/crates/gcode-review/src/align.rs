//! Alignment of the steps of two runs, so that one inserted move does not make all later ones different.
//!
//! Three stages: the longest common sequence of equal steps; in the gaps between them moves with equal
//! displacements; then the pairs with the nearest end points.
use std::borrow::Cow;

use super::block_location::BlockLocation;
use super::common_sequence::{
    EqualRun, MOST_EDITS, Middle, append, common, common_of_shared, common_or_far, piece_by_piece, search,
};
use super::links::{Links, StepPair};
use super::position_cells::PositionCells;
use super::record::Record;
use super::step_list::StepList;
use super::steps::{Step, StepKind, difference, is_same};
use gcode_lang::motion::{Axes, MAX_AXES, Position};

/// Two records, and which step of one is which of the other.
#[derive(Clone, Copy)]
pub(super) struct Alignment<'a> {
    pub records: [&'a Record; 2],
    pub links: &'a Links,
    /// Largest deviation that is no difference, mm or degrees.
    pub tolerance: f64,
}

impl<'a> Alignment<'a> {
    pub(super) fn axes(&self) -> &'a Axes {
        &self.records[0].axes
    }

    /// Returns the steps by their numbers, old and new.
    pub(super) fn steps(&self, numbers: [Option<usize>; 2]) -> [Option<Step<'a>>; 2] {
        [0, 1].map(|side| Some(self.records[side].steps.at(numbers[side]?)))
    }

    /// Returns the blocks of steps by their numbers, old and new.
    pub(super) fn blocks(&self, numbers: [Option<usize>; 2]) -> [Option<Cow<'a, BlockLocation>>; 2] {
        [0, 1].map(|side| Some(self.records[side].block(numbers[side]?)))
    }

    /// Returns the step of a link; the old one of two.
    pub(super) fn step(&self, link: StepPair) -> Option<Step<'a>> {
        let [old, new] = self.steps(link.sides());
        old.or(new)
    }

    /// Iterates over the numbers of paired steps, old and new.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.links.paired_runs().flat_map(|(i, j, length)| (0..length).map(move |n| (i + n, j + n)))
    }
}

/// Largest number of possible pairs of a gap that is searched for the nearest end points; larger gaps are paired in
/// order.
const MOST_PAIRS: usize = 10_000;

/// Consecutive steps of a list.
#[derive(Clone, Copy)]
pub(super) struct StepRange<'a> {
    list: &'a StepList,
    first: usize,
    end: usize,
}

impl<'a> StepRange<'a> {
    pub(super) fn new(list: &'a StepList, range: std::ops::Range<usize>) -> Self {
        Self { list, first: range.start, end: range.end }
    }

    fn len(self) -> usize {
        self.end - self.first
    }

    fn at(self, number: usize) -> Step<'a> {
        self.list.at(self.first + number)
    }

    /// Returns what a step does, and its end.
    fn end(self, number: usize) -> (&'a StepKind, Position) {
        (self.kind(number), self.list.end(self.first + number))
    }

    fn kind(self, number: usize) -> &'a StepKind {
        self.list.kind(self.first + number)
    }

    /// Returns true for the same action, see [`steps::is_same`](super::steps::is_same).
    fn is_same(self, number: usize, other: StepRange<'_>, of_other: usize, tolerance: f64) -> bool {
        let kinds = [self.kind(number), other.kind(of_other)];
        is_same(kinds, tolerance, || [self.end(number).1, other.end(of_other).1])
    }
}

/// Steps of both runs.
type BothSteps<'a> = (StepRange<'a>, StepRange<'a>);

/// Aligns like [`align`]; if one run alone stops (old, new), later steps of the other are lost or added.
pub(super) fn align_until_stop(old: &StepList, new: &StepList, stops: (bool, bool), tolerance: f64) -> Links {
    let [all, all_now] = [old, new].map(|list| StepRange::new(list, 0..list.len()));
    let same = |i: usize, j: usize| all.is_same(i, all_now, j, tolerance);
    let (rows, columns) = match stops {
        (false, true) => (reach(old.len(), new.len(), same), new.len()),
        (true, false) => (old.len(), reach(new.len(), old.len(), |j, i| same(i, j))),
        _ => (old.len(), new.len()),
    };
    let mut links = align((StepRange::new(old, 0..rows), StepRange::new(new, 0..columns)), tolerance);
    links.push_run(StepPair::Lost(rows), old.len() - rows);
    links.push_run(StepPair::Added(columns), new.len() - columns);
    links
}

/// Returns the number of steps of a longer run that are compared with one of `short` steps that stops: up to the
/// first end with the fewest edits, and the rest of the short run.
fn reach(long: usize, short: usize, same: impl Fn(usize, usize) -> bool) -> usize {
    let ends = |x: usize, y: usize| y == short || x == long;
    let Ok(pairs) = search((long, short), MOST_EDITS, &same, ends) else { return long };
    let (behind, last) = pairs.last().map_or((0, 0), |run| (run.old + run.length, run.new + run.length));
    (behind + short - last).min(long)
}

/// Returns all steps of both runs in an order that keeps both, with the fewest lost and added; tool by tool if that
/// adds none.
pub(super) fn align((old, new): BothSteps<'_>, tolerance: f64) -> Links {
    let whole = [(old.len(), new.len())];
    let mut links = between((old, new), &whole, tolerance);
    if links.differences().next().is_some() {
        let (was, is) = (tool_changes(old), tool_changes(new));
        let tools = common(was.len(), is.len(), |i, j| old.kind(was[i]) == new.kind(is[j]));
        let mut stops: Vec<(usize, usize)> = tools.into_iter().map(|(i, j)| (was[i], is[j])).collect();
        // The search between two tool changes about all differences would be the same one.
        if !links.are_beside_differences(&stops) {
            stops.extend(whole);
            let by_tool = between((old, new), &stops, tolerance);
            let edits = |links: &Links| edits(links, (old, new));
            if edits(&by_tool) <= edits(&links) {
                links = by_tool;
            }
        }
        links = keep_moves_paired((old, new), tolerance, &links);
    }
    links
}

fn tool_changes(steps: StepRange<'_>) -> Vec<usize> {
    (0..steps.len()).filter(|step| matches!(steps.kind(*step), StepKind::Tool(_))).collect()
}

/// Counts lost and added steps; a tool change counts as three, so that moves stay with their tool.
fn edits(links: &Links, (old, new): BothSteps<'_>) -> usize {
    let of = |kind: &StepKind| if matches!(kind, StepKind::Tool(_)) { 3 } else { 1 };
    let each = |(_, link): (usize, StepPair)| match link {
        StepPair::Same(..) => 0,
        StepPair::Lost(i) => of(old.kind(i)),
        StepPair::Added(j) => of(new.kind(j)),
        StepPair::Changed(i, j) => of(old.kind(i)) + of(new.kind(j)),
    };
    links.differences().map(each).sum()
}

/// Links the steps from stop to stop, each a pair of equal steps; the last one is where both end.
fn between((old, new): BothSteps<'_>, stops: &[(usize, usize)], tolerance: f64) -> Links {
    let cells = PositionCells::new(tolerance);
    let mut links = Links::default();
    let (mut i, mut j) = (0, 0);
    for &(stop_i, stop_j) in stops {
        let (from_i, from_j) = (i, j);
        let is_same = |a: usize, b: usize| old.is_same(from_i + a, new, from_j + b, tolerance);
        let step = |side: usize, index: usize| match side {
            0 => old.end(from_i + index),
            _ => new.end(from_j + index),
        };
        let key = |side: usize, index: usize| {
            let (kind, end) = step(side, index);
            cells.key(kind, &end)
        };
        let keys = |side: usize, index: usize| {
            let (kind, end) = step(side, index);
            cells.keys(kind, &end)
        };
        let same = common_of_shared([stop_i - from_i, stop_j - from_j], is_same, (key, keys));
        for EqualRun { old: a, new: b, length } in same {
            let (to_i, to_j) = (from_i + a, from_j + b);
            align_gap((old, i..to_i), (new, j..to_j), tolerance, &mut links);
            links.push_run(StepPair::Same(to_i, to_j), length);
            (i, j) = (to_i + length, to_j + length);
        }
        align_gap((old, i..stop_i), (new, j..stop_j), tolerance, &mut links);
        if stop_i < old.len() && stop_j < new.len() {
            links.push(StepPair::Same(stop_i, stop_j));
        }
        (i, j) = (stop_i + 1, stop_j + 1);
    }
    links
}

/// Pairs a move that is lost and added on either side of one equal command: the command is the one that is
/// reordered.
fn keep_moves_paired((old, new): BothSteps<'_>, tolerance: f64, links: &Links) -> Links {
    let mut all = Links::default();
    let mut links = links.iter();
    let mut next = [links.next(), links.next(), links.next()];
    while let [Some(first), ..] = next {
        if let [Some(_), Some(between), Some(last)] = next
            && let Some(reordered) = reordered([first, between, last], &all, (old, new), tolerance)
        {
            next = reordered.map(Some);
        }
        all.extend_by(next[0]);
        next = [next[1], next[2], links.next()];
    }
    all
}

/// Returns the links of a lost and an added move about one equal command with the move as the pair.
fn reordered(
    [first, between, last]: [StepPair; 3],
    before: &Links,
    (old, new): BothSteps<'_>,
    tolerance: f64,
) -> Option<[StepPair; 3]> {
    let (i, j) = match (first, last) {
        (StepPair::Lost(i), StepPair::Added(j)) | (StepPair::Added(j), StepPair::Lost(i)) => (i, j),
        _ => return None,
    };
    let StepPair::Same(other_i, other_j) = between else { return None };
    let is_move = old.kind(i).is_move() && old.is_same(i, new, j, tolerance);
    // A tool change after an unpaired step keeps its pair.
    let is_of_pass =
        matches!(old.kind(other_i), StepKind::Tool(_)) && before.last().is_some_and(StepPair::is_unpaired);
    if !is_move || old.kind(other_i).is_move() || is_of_pass {
        return None;
    }
    let (lost, added) = (StepPair::Lost(other_i), StepPair::Added(other_j));
    let is_added_first = matches!(first, StepPair::Added(_));
    Some(if is_added_first {
        [lost, StepPair::Same(i, j), added]
    } else {
        [added, StepPair::Same(i, j), lost]
    })
}

/// Steps of one run, and those between two equal pairs.
type StepGap<'a> = (StepRange<'a>, std::ops::Range<usize>);

/// Links the steps between two equal pairs.
fn align_gap((old, range_i): StepGap<'_>, (new, range_j): StepGap<'_>, tolerance: f64, links: &mut Links) {
    let (first_i, first_j) = (range_i.start, range_j.start);
    let is_parallel = |i: usize, j: usize| old.at(first_i + i).is_parallel(&new.at(first_j + j), tolerance);
    let parallel = common_or_far((range_i.len(), range_j.len()), &is_parallel, |middle| {
        let Middle { before, rows, columns } = middle;
        let (from_i, from_j) = (first_i + before, first_j + before);
        // Where nearly all moves differ, equal displacements are chance.
        match rows.abs_diff(columns) <= MOST_EDITS {
            true => pairs_in_order((old, from_i..from_i + rows), (new, from_j..from_j + columns), tolerance),
            false => piece_by_piece((rows, columns), |i, j| is_parallel(before + i, before + j)),
        }
    });
    let (mut i, mut j) = (first_i, first_j);
    let ends = [EqualRun { old: range_i.len(), new: range_j.len(), length: 0 }];
    for EqualRun { old: to_i, new: to_j, length } in parallel.into_iter().chain(ends) {
        let (to_i, to_j) = (first_i + to_i, first_j + to_j);
        let mut pair = |link: StepPair| match link {
            // Beyond the limits of the search equal steps are found here.
            StepPair::Changed(i, j) if old.is_same(i, new, j, tolerance) => {
                links.push(StepPair::Same(i, j));
            }
            _ => links.push(link),
        };
        nearest((old, i..to_i), (new, j..to_j), &mut pair);
        links.push_run(StepPair::Changed(to_i, to_j), length);
        (i, j) = (to_i + length, to_j + length);
    }
}

/// Pairs differing moves in their order. The surplus of one side is left out where the others then end nearest to their partners.
fn pairs_in_order((old, range_i): StepGap<'_>, (new, range_j): StepGap<'_>, tolerance: f64) -> Vec<EqualRun> {
    let (rows, columns) = (range_i.len(), range_j.len());
    let surplus = [rows.saturating_sub(columns), columns.saturating_sub(rows)];
    let paired = rows.min(columns);
    let apart = |i: usize, j: usize| {
        step_distance(old.end(range_i.start + i), new.end(range_j.start + j)).unwrap_or(UNLIKE)
    };
    // How much farther the pairs before a place end than those behind the surplus would.
    let (mut farther, mut nearest, mut split) = (0.0, 0.0, 0);
    for k in (0..paired).take_while(|_| surplus != [0, 0]) {
        farther += apart(k, k) - apart(k + surplus[0], k + surplus[1]);
        if farther < nearest {
            (nearest, split) = (farther, k + 1);
        }
    }
    let mut runs = Vec::new();
    for k in 0..paired {
        let [skip_i, skip_j] = if k < split { [0, 0] } else { surplus };
        let (i, j) = (range_i.start + k + skip_i, range_j.start + k + skip_j);
        let are_moves = old.kind(i).is_move() && new.kind(j).is_move();
        let is_pair = are_moves && !old.is_same(i, new, j, tolerance);
        append(&mut runs, (k + skip_i, k + skip_j, usize::from(is_pair)));
    }
    runs
}

/// Distance of two steps that are no likely pair, mm.
const UNLIKE: f64 = 1e3;

/// Links the remaining steps: as many pairs as possible, with the nearest end points.
fn nearest((old, range_i): StepGap<'_>, (new, range_j): StepGap<'_>, link: &mut impl FnMut(StepPair)) {
    let (rows, columns) = (range_i.len(), range_j.len());
    if rows == columns || rows == 0 || columns == 0 || rows * columns > MOST_PAIRS {
        in_order((old, range_i), (new, range_j), link);
        return;
    }
    // cost[r][c] is the least cost of the steps from r and c on. An unpaired step costs more than any distance.
    let unpaired = 1e12;
    let width = columns + 1;
    let mut cost = vec![0.0; (rows + 1) * width];
    for r in (0..=rows).rev() {
        for c in (0..=columns).rev() {
            if r == rows || c == columns {
                cost[r * width + c] = unpaired * ((rows - r) + (columns - c)) as f64;
                continue;
            }
            let apart = step_distance(old.end(range_i.start + r), new.end(range_j.start + c));
            let pair = apart.map_or(f64::INFINITY, |mm| mm + cost[(r + 1) * width + c + 1]);
            let skip = unpaired + cost[(r + 1) * width + c].min(cost[r * width + c + 1]);
            cost[r * width + c] = pair.min(skip);
        }
    }
    let (mut r, mut c) = (0, 0);
    while r < rows || c < columns {
        let (i, j) = (range_i.start + r, range_j.start + c);
        let best = cost[r * width + c];
        let is_best = |mm: f64| mm + cost[(r + 1) * width + c + 1] <= best;
        if r < rows && c < columns && step_distance(old.end(i), new.end(j)).is_some_and(is_best) {
            link(StepPair::Changed(i, j));
            (r, c) = (r + 1, c + 1);
        } else if r < rows && unpaired + cost[(r + 1) * width + c] <= best {
            link(StepPair::Lost(i));
            r += 1;
        } else {
            link(StepPair::Added(j));
            c += 1;
        }
    }
}

/// Pairs steps of one kind of change as they come.
fn in_order((old, range_i): StepGap<'_>, (new, range_j): StepGap<'_>, link: &mut impl FnMut(StepPair)) {
    let (mut i, mut j) = (range_i.start, range_j.start);
    while i < range_i.end && j < range_j.end {
        if old.kind(i).change() == new.kind(j).change() {
            link(StepPair::Changed(i, j));
            (i, j) = (i + 1, j + 1);
        } else if range_i.end - i >= range_j.end - j {
            link(StepPair::Lost(i));
            i += 1;
        } else {
            link(StepPair::Added(j));
            j += 1;
        }
    }
    (i..range_i.end).for_each(|i| link(StepPair::Lost(i)));
    (j..range_j.end).for_each(|j| link(StepPair::Added(j)));
}

/// Returns how far apart two steps of one kind of change end; a rapid is no likely pair of a feed.
fn step_distance(
    (kind, end): (&StepKind, Position),
    (other_kind, other_end): (&StepKind, Position),
) -> Option<f64> {
    if kind.change() != other_kind.change() {
        return None;
    }
    let shift = difference(&end, &other_end);
    let distance = (0..MAX_AXES).map(|axis| shift[axis].abs()).sum::<f64>();
    let is_other_kind = std::mem::discriminant(kind) != std::mem::discriminant(other_kind);
    Some(distance + if is_other_kind { 1e3 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of a run after the stop of the other are not compared.
    #[test]
    fn a_run_that_stops_is_compared_up_to_there() {
        let reach = |long: &str, short: &str| {
            let (long, short) = (long.as_bytes(), short.as_bytes());
            reach(long.len(), short.len(), |i, j| long[i] == short[j])
        };
        assert_eq!(reach("ABCABC", "ABC"), 3);
        assert_eq!(reach("ABCDEABX", "ABX"), 3, "X stands for C");
        assert_eq!(reach("ABCD", "ACD"), 4);
        assert_eq!(reach("AB", "ABCD"), 2);
        assert_eq!(reach("", "AB"), 0);
    }

    /// Returns the numbers of steps that differ in two programs, and of those that one alone has, old and new.
    fn differing(points: [Vec<[f64; 2]>; 2]) -> ([usize; 2], [usize; 2]) {
        let [old, new] = points.map(|points| {
            let moves = points.iter().map(|[x, y]| format!("X{x:.3}Y{y:.3}\n")).collect::<String>();
            let text = format!("O1\nG90G1F100.\n{moves}M30\n");
            let machine = gcode_inspect::machine::Machine::default();
            let request = gcode_session::Request::new("O1.nc", text.into_bytes(), machine);
            crate::Revision::of(&request, &mut gcode_lang::program::NoLibrary, None).unwrap().record
        });
        let diff = crate::RevisionDiff::new(&old, &new, 1e-4);
        (diff.steps.map(|steps| steps.len()), diff.unpaired_steps.map(|steps| steps.len()))
    }

    /// All 1,500 points are another; many displacements are equal to that of another move by chance.
    #[test]
    fn as_many_moves_that_all_differ_are_paired_in_order() {
        let points = |shift: f64, wave: f64| {
            let of = |n: usize| {
                let y = 0.01 * (n * n * 7 % 23) as f64 + wave * (n % 2) as f64;
                [0.1 * n as f64 + shift, y]
            };
            (1..=1500).map(of).collect()
        };
        assert_eq!(differing([points(0.0, 0.0), points(0.003, 0.01)]), ([1500; 2], [0; 2]));
    }

    /// Of 1,500 points that all are another, one revision alone has the 700th.
    #[test]
    fn a_surplus_move_among_moves_that_all_differ_is_unpaired() {
        let points = |shift: f64, left_out: usize| {
            let of = |n: usize| [0.1 * n as f64 + shift, 0.01 * (n * n * 7 % 23) as f64];
            (1..=1500).filter(|n| *n != left_out).map(of).collect()
        };
        assert_eq!(differing([points(0.0, 700), points(0.003, 0)]), ([1499, 1500], [0, 1]));
        assert_eq!(differing([points(0.0, 0), points(0.003, 700)]), ([1500, 1499], [1, 0]));
    }

    /// Of 2,400 moves each fourth goes to the same point; more than a thousand others differ.
    #[test]
    fn equal_moves_among_many_others_are_found() {
        let points = |shift: f64| {
            let of = |n: usize| {
                [0.1 * n as f64, if n.is_multiple_of(4) { 1.0 } else { 1.0 + shift * (1 + n % 3) as f64 }]
            };
            (1..=2400).map(of).collect()
        };
        assert_eq!(differing([points(0.0), points(0.01)]), ([1800; 2], [0; 2]));
    }
}
