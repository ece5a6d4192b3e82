//! Alignment of the steps of two runs, so that one inserted move does not make all later ones different.
//!
//! Three stages: the longest common sequence of equal steps (E. Myers, *An O(ND) Difference Algorithm and Its
//! Variations*); in the gaps between them moves with equal displacements; then the pairs with the nearest end
//! points.
use super::record::{BlockLocation, Record};
use super::steps::{Step, StepKind, difference};
use gcode_lang::motion::{Axes, MAX_AXES};

/// A step of one run, or a pair of steps, one of each run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepPair {
    Same(usize, usize),
    /// A pair that differs.
    Changed(usize, usize),
    Lost(usize),
    Added(usize),
}

impl StepPair {
    /// Returns the numbers of the steps, old and new.
    pub(super) fn sides(self) -> [Option<usize>; 2] {
        match self {
            Self::Same(i, j) | Self::Changed(i, j) => [Some(i), Some(j)],
            Self::Lost(i) => [Some(i), None],
            Self::Added(j) => [None, Some(j)],
        }
    }

    /// Returns true if one run alone makes the step.
    pub(super) fn is_unpaired(self) -> bool {
        matches!(self, Self::Lost(_) | Self::Added(_))
    }
}

/// Two records, and which step of one is which of the other.
#[derive(Clone, Copy)]
pub(super) struct Alignment<'a> {
    pub records: [&'a Record; 2],
    pub links: &'a [StepPair],
    /// Largest deviation that is no difference, mm or degrees.
    pub tolerance: f64,
}

impl<'a> Alignment<'a> {
    pub(super) fn axes(&self) -> &'a Axes {
        &self.records[0].axes
    }

    /// Returns the steps by their numbers, old and new.
    pub(super) fn steps(&self, numbers: [Option<usize>; 2]) -> [Option<&'a Step>; 2] {
        [0, 1].map(|side| Some(&self.records[side].steps[numbers[side]?]))
    }

    /// Returns the blocks of steps by their numbers, old and new.
    pub(super) fn blocks(&self, numbers: [Option<usize>; 2]) -> [Option<&'a BlockLocation>; 2] {
        [0, 1].map(|side| Some(self.records[side].block(numbers[side]?)))
    }

    /// Returns the step of a link; the old one of two.
    pub(super) fn step(&self, link: StepPair) -> Option<&'a Step> {
        let [old, new] = self.steps(link.sides());
        old.or(new)
    }

    /// Iterates over the numbers of paired steps, old and new.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        self.links.iter().filter_map(|link| {
            let [i, j] = link.sides();
            i.zip(j)
        })
    }
}

/// Largest number of lost and added steps of a search for the fewest; beyond it the search continues piece by
/// piece.
const MOST_EDITS: usize = 1_000;

/// Number of lost and added steps of each piece: those of some dozens of holes.
const EDITS_AHEAD: usize = 200;

/// Largest number of possible pairs of a gap that is searched for the nearest end points; larger gaps are paired in
/// order.
const MOST_PAIRS: usize = 10_000;

/// Aligns like [`align`]; if one run alone stops (old, new), later steps of the other are lost or added.
pub(super) fn align_until_stop(
    old: &[Step],
    new: &[Step],
    stops: (bool, bool),
    tolerance: f64,
) -> Vec<StepPair> {
    let same = |i: usize, j: usize| old[i].is_same(&new[j], tolerance);
    let (rows, columns) = match stops {
        (false, true) => (reach(old.len(), new.len(), same), new.len()),
        (true, false) => (old.len(), reach(new.len(), old.len(), |j, i| same(i, j))),
        _ => (old.len(), new.len()),
    };
    let mut links = align(&old[..rows], &new[..columns], tolerance);
    links.extend((rows..old.len()).map(StepPair::Lost));
    links.extend((columns..new.len()).map(StepPair::Added));
    links
}

/// Returns the number of steps of a longer run that are compared with one of `short` steps that stops: up to the
/// first end with the fewest edits, and the rest of the short run.
fn reach(long: usize, short: usize, same: impl Fn(usize, usize) -> bool) -> usize {
    let ends = |x: usize, y: usize| y == short || x == long;
    let Ok(pairs) = search((long, short), MOST_EDITS, &same, ends) else { return long };
    let (behind, last) = pairs.last().map_or((0, 0), |(x, y)| (x + 1, y + 1));
    (behind + short - last).min(long)
}

/// Returns all steps of both runs in an order that keeps both, with the fewest lost and added; tool by tool if that
/// adds none.
pub(super) fn align(old: &[Step], new: &[Step], tolerance: f64) -> Vec<StepPair> {
    let whole = [(old.len(), new.len())];
    let mut links = between((old, new), &whole, tolerance);
    if links.iter().any(|link| !matches!(link, StepPair::Same(..))) {
        let (was, is) = (tool_changes(old), tool_changes(new));
        let tools = common(was.len(), is.len(), |i, j| old[was[i]].kind == new[is[j]].kind);
        let mut stops: Vec<(usize, usize)> = tools.into_iter().map(|(i, j)| (was[i], is[j])).collect();
        stops.extend(whole);
        let by_tool = between((old, new), &stops, tolerance);
        let edits = |links: &[StepPair]| edits(links, (old, new));
        if edits(&by_tool) <= edits(&links) {
            links = by_tool;
        }
    }
    keep_moves_paired((old, new), tolerance, &mut links);
    links
}

fn tool_changes(steps: &[Step]) -> Vec<usize> {
    (0..steps.len()).filter(|step| matches!(steps[*step].kind, StepKind::Tool(_))).collect()
}

/// Counts lost and added steps; a tool change counts as three, so that moves stay with their tool.
fn edits(links: &[StepPair], (old, new): (&[Step], &[Step])) -> usize {
    let of = |step: &Step| if matches!(step.kind, StepKind::Tool(_)) { 3 } else { 1 };
    let each = |link: &StepPair| match *link {
        StepPair::Same(..) => 0,
        StepPair::Lost(i) => of(&old[i]),
        StepPair::Added(j) => of(&new[j]),
        StepPair::Changed(i, j) => of(&old[i]) + of(&new[j]),
    };
    links.iter().map(each).sum()
}

/// Links the steps from stop to stop, each a pair of equal steps; the last one is where both end.
fn between((old, new): (&[Step], &[Step]), stops: &[(usize, usize)], tolerance: f64) -> Vec<StepPair> {
    let mut links = Vec::with_capacity(old.len().max(new.len()));
    let (mut i, mut j) = (0, 0);
    for &(stop_i, stop_j) in stops {
        let (from_i, from_j) = (i, j);
        let same = common(stop_i - from_i, stop_j - from_j, |a, b| {
            old[from_i + a].is_same(&new[from_j + b], tolerance)
        });
        let same = same.into_iter().map(|(a, b)| (from_i + a, from_j + b));
        for (to_i, to_j) in same.chain([(stop_i, stop_j)]) {
            align_gap((old, i..to_i), (new, j..to_j), tolerance, &mut links);
            if to_i < old.len() && to_j < new.len() {
                links.push(StepPair::Same(to_i, to_j));
            }
            (i, j) = (to_i + 1, to_j + 1);
        }
    }
    links
}

/// Pairs a move that is lost and added on either side of one equal command: the command is the one that is
/// reordered.
fn keep_moves_paired((old, new): (&[Step], &[Step]), tolerance: f64, links: &mut [StepPair]) {
    for first in 0..links.len() {
        let is_other = |link: &StepPair| matches!(link, StepPair::Same(i, _) if !old[*i].is_move());
        let between = links[first + 1..].iter().take_while(|link| is_other(link)).count();
        let Some(last) = links.get(first + 1 + between).copied() else { return };
        let (i, j) = match (links[first], last) {
            (StepPair::Lost(i), StepPair::Added(j)) | (StepPair::Added(j), StepPair::Lost(i)) => (i, j),
            _ => continue,
        };
        let is_move = old[i].is_move() && old[i].is_same(&new[j], tolerance);
        // With more than one command between them, more steps would lose their pair than gain one.
        let StepPair::Same(other_i, other_j) = links[first + 1] else { continue };
        // A tool change after an unpaired step keeps its pair.
        let is_of_pass = matches!(old[other_i].kind, StepKind::Tool(_))
            && first.checked_sub(1).is_some_and(|before| links[before].is_unpaired());
        if !is_move || between != 1 || is_of_pass {
            continue;
        }
        let (lost, added) = (StepPair::Lost(other_i), StepPair::Added(other_j));
        let gone_first = matches!(links[first], StepPair::Added(_));
        (links[first], links[first + 1], links[first + 2]) = if gone_first {
            (lost, StepPair::Same(i, j), added)
        } else {
            (added, StepPair::Same(i, j), lost)
        };
    }
}

type Side<'a> = (&'a [Step], std::ops::Range<usize>);

/// Links the steps between two equal pairs.
fn align_gap((old, range_i): Side<'_>, (new, range_j): Side<'_>, tolerance: f64, links: &mut Vec<StepPair>) {
    let (first_i, first_j) = (range_i.start, range_j.start);
    let parallel = common(range_i.len(), range_j.len(), |i, j| {
        old[first_i + i].is_parallel(&new[first_j + j], tolerance)
    });
    let (mut i, mut j) = (first_i, first_j);
    let ends = [(range_i.len(), range_j.len())];
    for (to_i, to_j) in parallel.into_iter().chain(ends).map(|(i, j)| (first_i + i, first_j + j)) {
        let first = links.len();
        nearest((old, i..to_i), (new, j..to_j), links);
        // Beyond the limits of the search equal steps are found here.
        for link in &mut links[first..] {
            if let StepPair::Changed(i, j) = *link
                && old[i].is_same(&new[j], tolerance)
            {
                *link = StepPair::Same(i, j);
            }
        }
        if to_i < range_i.end {
            links.push(StepPair::Changed(to_i, to_j));
        }
        (i, j) = (to_i + 1, to_j + 1);
    }
}

/// Links the remaining steps: as many pairs as possible, with the nearest end points.
fn nearest((old, range_i): Side<'_>, (new, range_j): Side<'_>, links: &mut Vec<StepPair>) {
    let (rows, columns) = (range_i.len(), range_j.len());
    if rows == columns || rows == 0 || columns == 0 || rows * columns > MOST_PAIRS {
        in_order((old, range_i), (new, range_j), links);
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
            let apart = step_distance(&old[range_i.start + r], &new[range_j.start + c]);
            let pair = apart.map_or(f64::INFINITY, |mm| mm + cost[(r + 1) * width + c + 1]);
            let skip = unpaired + cost[(r + 1) * width + c].min(cost[r * width + c + 1]);
            cost[r * width + c] = pair.min(skip);
        }
    }
    let (mut r, mut c) = (0, 0);
    while r < rows || c < columns {
        let (i, j) = (range_i.start + r, range_j.start + c);
        let best = cost[r * width + c];
        if r < rows
            && c < columns
            && step_distance(&old[i], &new[j]).is_some_and(|mm| mm + cost[(r + 1) * width + c + 1] <= best)
        {
            links.push(StepPair::Changed(i, j));
            (r, c) = (r + 1, c + 1);
        } else if r < rows && unpaired + cost[(r + 1) * width + c] <= best {
            links.push(StepPair::Lost(i));
            r += 1;
        } else {
            links.push(StepPair::Added(j));
            c += 1;
        }
    }
}

/// Pairs steps of one kind of change as they come.
fn in_order((old, range_i): Side<'_>, (new, range_j): Side<'_>, links: &mut Vec<StepPair>) {
    let (mut i, mut j) = (range_i.start, range_j.start);
    while i < range_i.end && j < range_j.end {
        if old[i].kind.change() == new[j].kind.change() {
            links.push(StepPair::Changed(i, j));
            (i, j) = (i + 1, j + 1);
        } else if range_i.end - i >= range_j.end - j {
            links.push(StepPair::Lost(i));
            i += 1;
        } else {
            links.push(StepPair::Added(j));
            j += 1;
        }
    }
    links.extend((i..range_i.end).map(StepPair::Lost));
    links.extend((j..range_j.end).map(StepPair::Added));
}

/// Returns how far apart two steps of one kind of change end; a rapid is no likely pair of a feed.
fn step_distance(a: &Step, b: &Step) -> Option<f64> {
    if a.kind.change() != b.kind.change() {
        return None;
    }
    let shift = difference(&a.to, &b.to);
    let distance = (0..MAX_AXES).map(|axis| shift[axis].abs()).sum::<f64>();
    let other_kind = std::mem::discriminant(&a.kind) != std::mem::discriminant(&b.kind);
    Some(distance + if other_kind { 1e3 } else { 0.0 })
}

/// Returns the longest common sequence of two lists of these lengths as pairs of indices; a long one if there are
/// more than [`MOST_EDITS`] edits.
pub(super) fn common(old: usize, new: usize, same: impl Fn(usize, usize) -> bool) -> Vec<(usize, usize)> {
    let shorter = old.min(new);
    let before = (0..shorter).take_while(|k| same(*k, *k)).count();
    let after = (0..shorter - before).take_while(|k| same(old - 1 - k, new - 1 - k)).count();
    let (rows, columns) = (old - before - after, new - before - after);
    let mut pairs: Vec<_> = (0..before).map(|k| (k, k)).collect();
    if rows > 0 && columns > 0 {
        let middle = longest_or_long(rows, columns, |i, j| same(before + i, before + j));
        pairs.extend(middle.into_iter().map(|(i, j)| (before + i, before + j)));
    }
    pairs.extend((0..after).rev().map(|k| (old - 1 - k, new - 1 - k)));
    pairs
}

/// Pairs of equal indices.
type Pairs = Vec<(usize, usize)>;

/// Searches piece by piece if there are too many edits; each piece ends at the farthest point of [`EDITS_AHEAD`]
/// edits.
fn longest_or_long(rows: usize, columns: usize, same: impl Fn(usize, usize) -> bool) -> Pairs {
    let ends = |x: usize, y: usize| x == rows && y == columns;
    if let Ok(pairs) = search((rows, columns), MOST_EDITS, &same, ends) {
        return pairs;
    }
    let mut all = Pairs::new();
    let (mut i, mut j) = (0, 0);
    while i < rows && j < columns {
        let left = (rows - i, columns - j);
        let piece = search(left, EDITS_AHEAD, |a, b| same(i + a, j + b), |x, y| (x, y) == left);
        let (pairs, (x, y)) = piece.map_or_else(|far| far, |pairs| (pairs, left));
        all.extend(pairs.into_iter().map(|(a, b)| (i + a, j + b)));
        (i, j) = (i + x, j + y);
    }
    all
}

/// Searches like Myers: for every number of edits up to `most` the farthest point on each diagonal, up to the first
/// end.
///
/// # Errors
/// The pairs up to the farthest point of all, and that point, if no end is in reach.
fn search(
    (rows, columns): (usize, usize),
    most: usize,
    same: impl Fn(usize, usize) -> bool,
    is_end: impl Fn(usize, usize) -> bool,
) -> Result<Pairs, (Pairs, (usize, usize))> {
    let (n, m) = (rows as isize, columns as isize);
    let most = (rows + columns).min(most) as isize;
    let index = |k: isize| (k + most + 1) as usize;
    let mut farthest = vec![0_isize; 2 * most as usize + 3];
    let mut history: Vec<Vec<isize>> = Vec::new();
    let (mut reached, mut by) = ((0, 0), 0);
    for edits in 0..=most {
        history.push(farthest[index(-edits - 1)..=index(edits + 1)].to_vec());
        for k in (-edits..=edits).step_by(2) {
            let down = k == -edits || k != edits && farthest[index(k - 1)] < farthest[index(k + 1)];
            let mut x = if down { farthest[index(k + 1)] } else { farthest[index(k - 1)] + 1 };
            while x < n && x - k < m && same(x as usize, (x - k) as usize) {
                x += 1;
            }
            farthest[index(k)] = x;
            if let (Ok(row), Ok(column)) = (usize::try_from(x), usize::try_from(x - k))
                && row <= rows
                && column <= columns
            {
                if is_end(row, column) {
                    return Ok(trace(&history, x, x - k));
                }
                if reached.0 + reached.1 < row + column {
                    (reached, by) = ((row, column), history.len());
                }
            }
        }
    }
    Err((trace(&history[..by], reached.0 as isize, reached.1 as isize), reached))
}

/// Collects the diagonal steps on the way back through the farthest points.
fn trace(history: &[Vec<isize>], n: isize, m: isize) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    let (mut x, mut y) = (n, m);
    for (edits, farthest) in history.iter().enumerate().rev() {
        let edits = edits as isize;
        let at = |k: isize| farthest[(k + edits + 1) as usize];
        let k = x - y;
        let down = k == -edits || k != edits && at(k - 1) < at(k + 1);
        let (before_x, before_y) = match (edits, down) {
            (0, _) => (0, 0),
            (_, true) => (at(k + 1), at(k + 1) - k - 1),
            (_, false) => (at(k - 1), at(k - 1) - k + 1),
        };
        let (start_x, start_y) = match (edits, down) {
            (0, _) => (0, 0),
            (_, true) => (before_x, before_y + 1),
            (_, false) => (before_x + 1, before_y),
        };
        while x > start_x && y > start_y {
            (x, y) = (x - 1, y - 1);
            pairs.push((x as usize, y as usize));
        }
        (x, y) = (before_x, before_y);
    }
    pairs.reverse();
    pairs
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pairs(old: &str, new: &str) -> Vec<(usize, usize)> {
        let (old, new) = (old.as_bytes(), new.as_bytes());
        common(old.len(), new.len(), |i, j| old[i] == new[j])
    }

    /// The example of the paper: ABCABBA and CBABAC have a common sequence of four.
    #[test]
    fn the_papers_example_has_four_in_common() {
        assert_eq!(pairs("ABCABBA", "CBABAC").len(), 4);
    }

    #[test]
    fn one_inserted_step_leaves_the_others_paired() {
        assert_eq!(pairs("ABCD", "ABXCD"), [(0, 0), (1, 1), (2, 3), (3, 4)]);
        assert_eq!(pairs("ABXCD", "ABCD"), [(0, 0), (1, 1), (3, 2), (4, 3)]);
        assert_eq!(pairs("", "AB"), []);
    }

    /// A thousand holes more pecks than the fewest edits are searched for.
    #[test]
    fn steps_that_come_in_every_hole_leave_the_others_paired() {
        let (old, new) = ("abc".repeat(1000), "axxbxxc".repeat(1000));
        assert_eq!(pairs(&old, &new).len(), 3000);
        assert_eq!(pairs(&new, &old).len(), 3000);
        assert_eq!(pairs(&"a".repeat(1500), &"b".repeat(1500)), []);
    }

    /// Length of the longest common sequence by dynamic programming.
    fn longest(a: &[u8], b: &[u8]) -> usize {
        let mut table = vec![vec![0; b.len() + 1]; a.len() + 1];
        for i in 0..a.len() {
            for j in 0..b.len() {
                table[i + 1][j + 1] =
                    if a[i] == b[j] { table[i][j] + 1 } else { table[i][j + 1].max(table[i + 1][j]) };
            }
        }
        table[a.len()][b.len()]
    }

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

    proptest! {
        #[test]
        fn the_common_sequence_is_common_and_the_longest(old in "[ABC]{0,30}", new in "[ABC]{0,30}") {
            let found = pairs(&old, &new);
            prop_assert!(found.iter().all(|(i, j)| old.as_bytes()[*i] == new.as_bytes()[*j]));
            prop_assert!(found.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 < w[1].1));
            prop_assert_eq!(found.len(), longest(old.as_bytes(), new.as_bytes()));
        }
    }
}
