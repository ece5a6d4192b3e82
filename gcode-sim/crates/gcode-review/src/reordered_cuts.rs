//! Cuts that a revision makes earlier or later along the same paths.
use std::collections::{BTreeMap, BTreeSet};

use super::align::Alignment;
use super::change::{Effect, grouped};
use super::common_sequence::shared;
use super::cut_settings::changed_cut_settings;
use super::descriptions::point;
use super::kinds;
use super::links::{Links, StepPair};
use super::position_cells::PositionCells;
use super::record::Record;
use super::step_list::StepList;
use super::steps::{Step, StepKind, near};
use gcode_lang::motion::{MAX_AXES, Position};

/// Consecutive moves that the other revision makes at another time, as pairs of steps.
pub(super) struct MoveRun(Vec<(usize, usize)>);

/// Number of equal cuts among which the one with the longest run is searched.
const MOST_ALIKE: usize = 16;

/// Returns runs of reordered moves, each with a cut that is of no hole, on the other side of cuts that both make.
/// Their steps lose other links.
pub(super) fn reordered_runs(links: &mut Links, old: &Record, new: &Record, tolerance: f64) -> Vec<MoveRun> {
    let [was, is] = [(old, 0), (new, 1)].map(|(record, side)| RevisionMoves::new(record, links, side));
    let runs = find(&was, &is, tolerance);
    let (was, is): (BTreeSet<usize>, BTreeSet<usize>) =
        runs.iter().flat_map(|run| run.0.iter().copied()).unzip();
    let split = |link: StepPair| match link {
        StepPair::Changed(i, j) if was.contains(&i) || is.contains(&j) => {
            vec![StepPair::Lost(i), StepPair::Added(j)]
        }
        link => vec![link],
    };
    if !runs.is_empty() {
        *links = links.iter().flat_map(split).collect();
    }
    runs
}

/// The moves of one revision that the other does not make at that time.
struct RevisionMoves<'a> {
    steps: &'a StepList,
    free: Vec<FreeMove>,
    /// Feeds of holes.
    holes: Vec<usize>,
}

/// A move that the other revision does not make at that time.
struct FreeMove {
    step: usize,
    /// Number of moves before it.
    index: usize,
    /// Number of cuts before it that both make at that time.
    before: usize,
}

impl<'a> RevisionMoves<'a> {
    fn new(record: &'a Record, links: &Links, side: usize) -> Self {
        let steps = &record.steps;
        let mut all = Self { steps, free: Vec::new(), holes: Vec::new() };
        if links.differences().next().is_none() {
            return all;
        }
        let (mut index, mut before) = (0, 0);
        for link in links.iter() {
            let Some(step) = link.sides()[side].filter(|step| steps.is_move(*step)) else { continue };
            if link.is_same() {
                before += usize::from(steps.kind(step).rate().is_some());
            } else {
                all.free.push(FreeMove { step, index, before });
            }
            index += 1;
        }
        let feeds: BTreeSet<usize> = record.feeds.iter().flatten().copied().collect();
        all.holes = feeds.into_iter().filter(|step| steps.is_move(*step)).collect();
        all
    }

    fn step(&self, index: usize) -> Step<'a> {
        self.steps.at(self.free[index].step)
    }

    /// Returns true if the free moves between two are all moves between them.
    fn is_run(&self, first: usize, last: usize) -> bool {
        self.free[last].index - self.free[first].index == last - first
    }

    /// Returns true for a cut that is neither of a hole nor on the line of the nearest one, such as a peck.
    fn is_cut(&self, index: usize) -> bool {
        let next = self.holes.partition_point(|hole| *hole < self.free[index].step);
        let near = [next.checked_sub(1), Some(next)].into_iter().flatten();
        let mut near = near.filter_map(|hole| self.holes.get(hole));
        let step = self.step(index);
        step.kind.rate().is_some() && !near.any(|hole| step.is_on_line_of(&self.steps.at(*hole)))
    }

    /// Returns what a free move does, and its end.
    fn end(&self, index: usize) -> (&'a StepKind, Position) {
        let step = self.free[index].step;
        (self.steps.kind(step), self.steps.end(step))
    }
}

/// Returns the free cuts of both revisions to whose ends the other one may have a free move too.
fn shared_cuts(revisions: [&RevisionMoves<'_>; 2], tolerance: f64) -> [Vec<usize>; 2] {
    let cells = PositionCells::new(tolerance);
    let key = |side: usize, index: usize| {
        let (kind, end) = revisions[side].end(index);
        cells.key(kind, &end)
    };
    let keys = |side: usize, index: usize| {
        let (kind, end) = revisions[side].end(index);
        cells.keys(kind, &end)
    };
    let mut cuts = shared(revisions.map(|moves| moves.free.len()), (key, keys));
    for (side, indices) in cuts.iter_mut().enumerate() {
        indices.retain(|index| revisions[side].is_cut(*index));
    }
    cuts
}

fn find(old: &RevisionMoves<'_>, new: &RevisionMoves<'_>, tolerance: f64) -> Vec<MoveRun> {
    let mut alike: BTreeMap<[i64; MAX_AXES], Vec<usize>> = BTreeMap::new();
    let [cuts, cuts_now] = shared_cuts([old, new], tolerance);
    cuts_now.into_iter().for_each(|index| alike.entry(about(&new.step(index))).or_default().push(index));
    let (mut known, mut known_now) = (BTreeSet::new(), BTreeSet::new());
    let mut runs = Vec::new();
    for p in cuts {
        if known.contains(&p) {
            continue;
        }
        let is_pair = |p: usize, q: usize| {
            let is_known = known.contains(&p) || known_now.contains(&q);
            !is_known && is_same(&old.step(p), &new.step(q), tolerance)
        };
        let run = |q: &usize| {
            let is_back = |n: &usize| old.is_run(p - n, p) && new.is_run(q - n, *q) && is_pair(p - n, q - n);
            let back = (1..=p.min(*q)).take_while(is_back).count();
            let rest = (old.free.len() - p).min(new.free.len() - q);
            let is_on = |n: &usize| old.is_run(p, p + n) && new.is_run(*q, q + n) && is_pair(p + n, q + n);
            let on = (0..rest).take_while(is_on).count();
            (on > 0).then(|| (p - back, q - back, back + on))
        };
        let candidates = alike.get(&about(&old.step(p))).into_iter().flatten();
        let candidates = candidates.filter(|q| old.free[p].before != new.free[**q].before);
        let longest = candidates.take(MOST_ALIKE).filter_map(run).max_by_key(|(_, _, moves)| *moves);
        let Some((from, from_now, moves)) = longest else { continue };
        known.extend(from..from + moves);
        known_now.extend(from_now..from_now + moves);
        runs.push(MoveRun(
            (0..moves).map(|n| (old.free[from + n].step, new.free[from_now + n].step)).collect(),
        ));
    }
    runs
}

/// Returns true for equal moves; a cut has to start at the same point as well.
fn is_same(old: &Step<'_>, new: &Step<'_>, tolerance: f64) -> bool {
    old.is_same(new, tolerance) && (old.is_rapid() || near(&old.from, &new.from, tolerance))
}

/// Returns the end point of a step in hundredths, offset so that round values are not on a limit.
fn about(step: &Step<'_>) -> [i64; MAX_AXES] {
    std::array::from_fn(|axis| ((step.to[axis] + 0.001_7) * 100.0).floor() as i64)
}

/// Reordered runs and the rapids beside them.
pub(super) struct ReorderedCuts<'a> {
    runs: &'a [MoveRun],
    alignment: Alignment<'a>,
    /// Steps of the runs and of the rapids that stay beside them, old and new.
    steps: [BTreeSet<usize>; 2],
}

impl<'a> ReorderedCuts<'a> {
    pub(super) fn new(runs: &'a [MoveRun], alignment: Alignment<'a>) -> Self {
        let (was, is) = runs.iter().flat_map(|run| run.0.iter().copied()).unzip();
        let mut cuts = Self { runs, alignment, steps: [was, is] };
        if !runs.is_empty() {
            cuts.keep_rapids();
        }
        cuts
    }

    /// Adds pairs of a lost and an added rapid that are equal, with nothing but reordered moves between them.
    fn keep_rapids(&mut self) {
        let Alignment { links, tolerance, .. } = self.alignment;
        let mut unpaired = [Vec::new(), Vec::new()];
        for link in links.iter() {
            let sides = link.sides();
            let Some(step) = self.alignment.step(link).filter(|_| !self.contains(&link)) else { continue };
            if !(link.is_unpaired() && step.is_rapid()) {
                if step.is_move() {
                    unpaired = [Vec::new(), Vec::new()];
                }
                continue;
            }
            let side = usize::from(sides[0].is_none());
            let others = &self.alignment.records[1 - side].steps;
            let equal = unpaired[1 - side]
                .iter()
                .position(|other: &usize| others.at(*other).is_same(&step, tolerance));
            let number = sides[side].unwrap_or(0);
            match equal {
                Some(index) => {
                    self.steps[1 - side].insert(unpaired[1 - side].remove(index));
                    self.steps[side].insert(number);
                }
                None => unpaired[side].push(number),
            }
        }
    }

    /// Returns true if a link is of a step that is made at another time.
    pub(super) fn contains(&self, link: &StepPair) -> bool {
        match link {
            StepPair::Lost(i) => self.steps[0].contains(i),
            StepPair::Added(j) => self.steps[1].contains(j),
            StepPair::Same(..) | StepPair::Changed(..) => false,
        }
    }

    /// Returns true if the next cut after two steps is the same one of a run: they set tool, spindle or coolant for
    /// it.
    pub(super) fn is_before_run(&self, i: usize, j: usize) -> bool {
        let [old, new] = self.alignment.records;
        let cut = |steps: &StepList, from: usize| {
            (from..steps.len()).find(|step| steps.kind(*step).rate().is_some())
        };
        let cuts = cut(&old.steps, i).zip(cut(&new.steps, j));
        cuts.is_some_and(|cuts| self.runs.iter().any(|run| run.0.contains(&cuts)))
    }

    /// Returns one effect for all runs whose conditions differ alike.
    pub(super) fn effects(&self) -> Vec<Effect> {
        let steps = &self.alignment.records[0].steps;
        let is_cut = |(i, _): &(usize, usize)| steps.kind(*i).rate().is_some();
        let cuts = |run: &MoveRun| run.0.iter().copied().filter(is_cut).collect::<Vec<_>>();
        let all: Vec<(usize, usize)> = self.runs.iter().flat_map(cuts).collect();
        let mut with = changed_cut_settings(&self.alignment, &all).into_iter();
        let runs = self.runs.iter().map(|run| {
            let mut texts: Vec<String> = with.by_ref().take(cuts(run).len()).flatten().collect();
            texts.dedup();
            (texts.iter().map(|text| format!(", {text}")).collect::<String>(), run)
        });
        grouped(runs).iter().map(|(with, runs)| self.effect(runs, with)).collect()
    }

    fn effect(&self, runs: &[&MoveRun], with: &str) -> Effect {
        let (i, j) = runs[0].0[0];
        let old = self.alignment.records[0].steps.at(i);
        let is_first = |link: &StepPair| [StepPair::Lost(i), StepPair::Added(j)].contains(link);
        let mut unpaired = self.alignment.links.unpaired().map(|(_, link)| link);
        let is_later = unpaired.find(is_first) == Some(StepPair::Lost(i));
        let when = if is_later { "later" } else { "earlier" };
        let one = format!("{} to {}", old.kind.one(), point(&old, self.alignment.axes()));
        let moves: usize = runs.iter().map(|run| run.0.len()).sum();
        let what = match (runs.len(), moves) {
            (1, 1) => format!("{one} is executed {when} than before"),
            (1, n) => format!("{n} moves are executed {when} than before, the first {one}"),
            (runs, n) => {
                format!(
                    "{n} moves in {runs} places are executed in a different order, the first {one}, {when}"
                )
            }
        };
        Effect::new(&kinds::MOVE_ORDER, what + with, self.alignment.blocks([Some(i), Some(j)]))
    }
}
