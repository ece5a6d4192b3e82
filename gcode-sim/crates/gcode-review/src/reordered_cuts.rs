//! Cuts that are gone in one place and made in another: the same ways at another time.
use std::collections::{BTreeMap, BTreeSet};

use super::align::StepPair;
use super::change::Effect;
use super::cut_settings::changed_cut_settings;
use super::descriptions::point;
use super::record::Record;
use super::steps::{Step, near};
use gcode_lang::motion::MAX_AXES;

/// Moves next to one another that the other revision makes at another time, as pairs of steps.
pub(super) struct MoveRun(Vec<(usize, usize)>);

/// Of so many cuts that are alike the one is looked for with most moves before and behind it.
const MOST_ALIKE: usize = 16;

/// Runs of such moves with a cut in each that is of no hole, for holes have an order of their own, on the other side
/// of cuts that both make. Steps of them that were linked with others are linked no more.
pub(super) fn displaced(
    links: &mut Vec<StepPair>,
    old: &Record,
    new: &Record,
    tolerance: f64,
) -> Vec<MoveRun> {
    let sides = (
        RevisionMoves::new(old, links, |link| link.sides().0),
        RevisionMoves::new(new, links, |link| link.sides().1),
    );
    let runs = find(&sides, tolerance);
    let (was, is): (BTreeSet<usize>, BTreeSet<usize>) =
        runs.iter().flat_map(|run| run.0.iter().copied()).unzip();
    let parted = |link: StepPair| match link {
        StepPair::Changed(i, j) if was.contains(&i) || is.contains(&j) => {
            vec![StepPair::Lost(i), StepPair::Added(j)]
        }
        link => vec![link],
    };
    if !runs.is_empty() {
        *links = std::mem::take(links).into_iter().flat_map(parted).collect();
    }
    runs
}

/// The moves of one revision.
struct RevisionMoves<'a> {
    steps: &'a [Step],
    moves: Vec<usize>,
    /// Whether the other revision doesn't make each of them at that time.
    is_free: Vec<bool>,
    /// How many cuts that both make at that time come before each.
    before: Vec<usize>,
    /// The places of the feeds of holes.
    holes: Vec<usize>,
}

impl<'a> RevisionMoves<'a> {
    fn new(record: &'a Record, links: &[StepPair], side: impl Fn(&StepPair) -> Option<usize>) -> Self {
        let moves = links.iter().filter_map(|link| Some((side(link)?, !matches!(link, StepPair::Same(..)))));
        let (moves, is_free): (Vec<usize>, Vec<bool>) =
            moves.filter(|(step, _)| record.steps[*step].is_move()).unzip();
        let cuts = moves.iter().zip(&is_free).scan(0, |cuts, (step, is_free)| {
            let before = *cuts;
            *cuts += usize::from(!is_free && record.steps[*step].kind.rate().is_some());
            Some(before)
        });
        let before = cuts.collect();
        let feeds: BTreeSet<usize> = record.feeds.iter().flatten().copied().collect();
        let holes = (0..moves.len()).filter(|place| feeds.contains(&moves[*place])).collect();
        Self { steps: &record.steps, moves, is_free, before, holes }
    }

    fn step(&self, place: usize) -> &'a Step {
        &self.steps[self.moves[place]]
    }

    /// A cut that is none of a hole, nor on the line of the nearest hole's: its pecks, its feed out.
    fn is_cut(&self, place: usize) -> bool {
        let next = self.holes.partition_point(|hole| *hole < place);
        let near = [next.checked_sub(1), Some(next)].into_iter().flatten();
        let mut near = near.filter_map(|hole| self.holes.get(hole));
        let step = self.step(place);
        step.kind.rate().is_some() && !near.any(|hole| step.is_on_line_of(self.step(*hole)))
    }

    fn free_cuts(&self) -> impl Iterator<Item = usize> {
        (0..self.moves.len()).filter(|place| self.is_free[*place] && self.is_cut(*place))
    }
}

fn find((old, new): &(RevisionMoves<'_>, RevisionMoves<'_>), tolerance: f64) -> Vec<MoveRun> {
    let mut alike: BTreeMap<[i64; MAX_AXES], Vec<usize>> = BTreeMap::new();
    new.free_cuts().for_each(|place| alike.entry(about(new.step(place))).or_default().push(place));
    let (mut known, mut known_now) = (BTreeSet::new(), BTreeSet::new());
    let mut runs = Vec::new();
    for p in old.free_cuts() {
        if known.contains(&p) {
            continue;
        }
        let is_pair = |p: usize, q: usize| {
            let is_free = old.is_free[p] && new.is_free[q] && !known.contains(&p) && !known_now.contains(&q);
            is_free && is_same(old.step(p), new.step(q), tolerance)
        };
        let run = |q: &usize| {
            let back = (1..=p.min(*q)).take_while(|n| is_pair(p - n, q - n)).count();
            let rest = (old.moves.len() - p).min(new.moves.len() - q);
            let on = (0..rest).take_while(|n| is_pair(p + n, q + n)).count();
            (on > 0).then(|| (p - back, q - back, back + on))
        };
        let places = alike.get(&about(old.step(p))).into_iter().flatten();
        let places = places.filter(|q| old.before[p] != new.before[**q]);
        let longest = places.take(MOST_ALIKE).filter_map(run).max_by_key(|(_, _, moves)| *moves);
        let Some((from, from_now, moves)) = longest else { continue };
        known.extend(from..from + moves);
        known_now.extend(from_now..from_now + moves);
        runs.push(MoveRun((0..moves).map(|n| (old.moves[from + n], new.moves[from_now + n])).collect()));
    }
    runs
}

/// A cut is another one where it begins elsewhere.
fn is_same(old: &Step, new: &Step, tolerance: f64) -> bool {
    old.is_same(new, tolerance) && (old.is_rapid() || near(&old.from, &new.from, tolerance))
}

/// Where a step ends, in hundredths; no even value lies between two of them.
fn about(step: &Step) -> [i64; MAX_AXES] {
    std::array::from_fn(|axis| ((step.to[axis] + 0.001_7) * 100.0).floor() as i64)
}

/// What is told of such runs.
pub(super) struct ReorderedCuts<'a> {
    runs: &'a [MoveRun],
    old: &'a Record,
    new: &'a Record,
    /// The moves of all of them, and the rapids that stay beside them.
    was: BTreeSet<usize>,
    is: BTreeSet<usize>,
}

impl<'a> ReorderedCuts<'a> {
    pub(super) fn new(
        runs: &'a [MoveRun],
        links: &[StepPair],
        (old, new): (&'a Record, &'a Record),
        tolerance: f64,
    ) -> Self {
        let (was, is) = runs.iter().flat_map(|run| run.0.iter().copied()).unzip();
        let mut displaced = Self { runs, old, new, was, is };
        if !runs.is_empty() {
            displaced.keep_rapids(links, tolerance);
        }
        displaced
    }

    /// A rapid that is gone and one that is new, with nothing between them but what is displaced, are one that stays.
    fn keep_rapids(&mut self, links: &[StepPair], tolerance: f64) {
        let (mut gone, mut come): (Vec<usize>, Vec<usize>) = Default::default();
        for link in links {
            let (i, j) = link.sides();
            let is_same = |i: usize, j: usize| self.old.steps[i].is_same(&self.new.steps[j], tolerance);
            let pair = match *link {
                _ if self.contains(link) => None,
                StepPair::Lost(i) if self.old.steps[i].is_rapid() => {
                    gone.push(i);
                    come.iter().find(|j| is_same(i, **j)).map(|j| (i, *j))
                }
                StepPair::Added(j) if self.new.steps[j].is_rapid() => {
                    come.push(j);
                    gone.iter().find(|i| is_same(**i, j)).map(|i| (*i, j))
                }
                _ => {
                    let is_move = i.map(|i| &self.old.steps[i]).or(j.map(|j| &self.new.steps[j]));
                    if is_move.is_some_and(Step::is_move) {
                        gone.clear();
                        come.clear();
                    }
                    None
                }
            };
            if let Some((i, j)) = pair {
                gone.retain(|known| *known != i);
                come.retain(|known| *known != j);
                self.was.insert(i);
                self.is.insert(j);
            }
        }
    }

    /// Whether a link is of a step that is made at another time.
    pub(super) fn contains(&self, link: &StepPair) -> bool {
        match link {
            StepPair::Lost(i) => self.was.contains(i),
            StepPair::Added(j) => self.is.contains(j),
            StepPair::Same(..) | StepPair::Changed(..) => false,
        }
    }

    /// Whether the next cut behind a step is the same one of a run, before and now: tool, spindle and coolant of
    /// these moves.
    pub(super) fn is_before_run(&self, i: usize, j: usize) -> bool {
        let cut =
            |steps: &[Step], from: usize| (from..steps.len()).find(|step| steps[*step].kind.rate().is_some());
        let cuts = cut(&self.old.steps, i).zip(cut(&self.new.steps, j));
        cuts.is_some_and(|cuts| self.runs.iter().any(|run| run.0.contains(&cuts)))
    }

    /// One entry for all runs that are made otherwise by the same because of their time, or not at all.
    pub(super) fn effects(&self, links: &[StepPair]) -> Vec<Effect> {
        let is_cut = |(i, _): &(usize, usize)| self.old.steps[*i].kind.rate().is_some();
        let cuts = |run: &MoveRun| run.0.iter().copied().filter(is_cut).collect::<Vec<_>>();
        let all: Vec<(usize, usize)> = self.runs.iter().flat_map(cuts).collect();
        let mut with = changed_cut_settings(self.old, self.new, &all).into_iter();
        let mut groups: Vec<(String, Vec<&MoveRun>)> = Vec::new();
        for run in self.runs {
            let mut texts: Vec<String> = with.by_ref().take(cuts(run).len()).flatten().collect();
            texts.dedup();
            let text: String = texts.iter().map(|text| format!(", {text}")).collect();
            match groups.iter_mut().find(|(known, _)| *known == text) {
                Some((_, runs)) => runs.push(run),
                None => groups.push((text, vec![run])),
            }
        }
        groups.iter().map(|(with, runs)| self.effect(runs, with, links)).collect()
    }

    fn effect(&self, runs: &[&MoveRun], with: &str, links: &[StepPair]) -> Effect {
        let (i, j) = runs[0].0[0];
        let (old, new) = (&self.old.steps[i], &self.new.steps[j]);
        let is_first = |link: &&StepPair| {
            matches!(link, StepPair::Lost(step) if *step == i)
                || matches!(link, StepPair::Added(step) if *step == j)
        };
        let is_later = matches!(links.iter().find(is_first), Some(StepPair::Lost(_)));
        let when = if is_later { "later" } else { "earlier" };
        let one = format!("{} to {}", old.kind.one(), point(old, &self.old.axes));
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
        Effect::new("move-order", what + with)
            .with_old(self.old.places.get(old.place))
            .with_new(self.new.places.get(new.place))
    }
}
