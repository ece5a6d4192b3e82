//! What two runs do differently step by step: every raw difference, whatever else says it too.
use std::collections::BTreeSet;

use super::align::StepPair;
use super::arcs::reshaped;
use super::change::Effect;
use super::descriptions::code;
use super::record::Record;
use super::redundant_commands::{is_redundant, redundant_commands};
use super::reordered_cuts::ReorderedCuts;
use super::shifted_events::{shifted_events, take_with_runs};
use super::steps::{Step, StepKind, difference, near};
use super::tool_setup::relied_on_changes;
use gcode_lang::motion::Position;

/// One thing that is different about a step, or about two that are paired.
pub(super) struct Difference {
    pub kind: DifferenceKind,
    /// The steps, by their numbers in the old and the new run.
    pub steps: [Option<usize>; 2],
}

pub(super) enum DifferenceKind {
    /// A move ends at another point, off by this much.
    EndPoint(Position),
    /// A move is a rapid where it was a feed, or of another kind.
    MoveKind,
    /// An arc has another sense, radius or centre; in words.
    ArcShape(String),
    /// A cut is made at another feed, mm/min.
    Feed { was: f64, is: f64 },
    /// The spindle turns as before at another speed.
    Speed { was: f64, is: f64 },
    /// A command has other values.
    Command,
    /// One run alone makes the step.
    Unpaired,
    /// A command is given earlier or later, with that word.
    Shifted(&'static str),
}

/// All differences of steps, in their order, and what cuts relied on. What is part of cuts in another
/// order belongs to these; a command of what is in force already is none.
pub(super) fn differences(
    (old, new): (&Record, &Record),
    links: &[StepPair],
    cuts: &ReorderedCuts<'_>,
    tolerance: f64,
) -> (Vec<Difference>, Vec<Effect>) {
    let steps = (&old.steps[..], &new.steps[..]);
    let mut told: BTreeSet<usize> = redundant_commands(links, steps.0, steps.1).collect();
    let mut shifted = shifted_events(links, steps, tolerance);
    told.extend(take_with_runs(&mut shifted, links, cuts));
    let is_unpaired = |k: usize| matches!(links[k], StepPair::Lost(_) | StepPair::Added(_));
    let untold = |k: usize| is_unpaired(k) && !shifted.contains_key(&k);
    let relied = relied_on_changes(links, untold, (old, new), tolerance);
    let is_said = |(k, effect): &(usize, Effect)| {
        let (i, j) = links[*k].sides();
        let step = i.map(|i| &steps.0[i]).or(j.map(|j| &steps.1[j]));
        step.is_some_and(|step| code(&step.kind) == effect.code)
    };
    told.extend(relied.iter().filter(|one| is_said(one)).map(|(k, _)| *k));
    let mut all = Vec::new();
    for (k, link) in links.iter().enumerate() {
        let (i, j) = link.sides();
        let mut add = |kind| all.push(Difference { kind, steps: [i, j] });
        match (shifted.get(&k), *link) {
            (Some(None), _) => {}
            (Some(Some((i, j, word))), _) => {
                if !(is_redundant(steps.0, *i) && is_redundant(steps.1, *j)) {
                    all.push(Difference { kind: DifferenceKind::Shifted(word), steps: [Some(*i), Some(*j)] });
                }
            }
            (None, _) if told.contains(&k) || cuts.contains(link) => {
                paired(steps, *link).filter_map(feed).for_each(add);
            }
            (None, StepPair::Lost(_) | StepPair::Added(_)) => add(DifferenceKind::Unpaired),
            (None, StepPair::Same(..)) => paired(steps, *link).filter_map(feed).for_each(add),
            (None, StepPair::Changed(i, j)) => {
                let (was, is) = (&steps.0[i], &steps.1[j]);
                if was.is_move() {
                    moved(was, is, tolerance, &mut add)
                } else {
                    add(command(was, is))
                }
                feed((was, is)).into_iter().for_each(add);
            }
        }
    }
    (all, relied.into_iter().map(|(_, effect)| effect).collect())
}

/// The steps of a link that has both.
fn paired<'a>(
    (old, new): (&'a [Step], &'a [Step]),
    link: StepPair,
) -> impl Iterator<Item = (&'a Step, &'a Step)> {
    let (i, j) = link.sides();
    i.zip(j).map(|(i, j)| (&old[i], &new[j])).into_iter()
}

/// Another feed. In G93 a move takes its time, and is slower where its way is shorter.
fn feed((old, new): (&Step, &Step)) -> Option<DifferenceKind> {
    let (was, is) = (old.kind.rate()?, new.kind.rate()?);
    let (before, now) = (old.length() / was, new.length() / is);
    let is_way = (old.length() - new.length()).abs() > 1e-9;
    let is_as_long = is_way && (before - now).abs() <= 1e-5 * before;
    let is_other = (was - is).abs() > 1e-6 * was.abs().max(is.abs());
    (is_other && !is_as_long).then_some(DifferenceKind::Feed { was, is })
}

/// What is different about a move but for its feed.
fn moved(old: &Step, new: &Step, tolerance: f64, add: &mut impl FnMut(DifferenceKind)) {
    if old.kind.one() != new.kind.one() {
        add(DifferenceKind::MoveKind);
    }
    let way = difference(&new.to, &old.to);
    let is_moved = !near(&way, &Position::default(), tolerance);
    if let (StepKind::Arc(a, _), StepKind::Arc(b, _)) = (&old.kind, &new.kind) {
        let is_moved = is_moved || !near(&new.from, &old.from, tolerance);
        reshaped((old, a), (new, b), is_moved, tolerance)
            .map(DifferenceKind::ArcShape)
            .into_iter()
            .for_each(&mut *add);
    }
    if is_moved {
        add(DifferenceKind::EndPoint(way));
    }
}

fn command(old: &Step, new: &Step) -> DifferenceKind {
    match (&old.kind, &new.kind) {
        (StepKind::Spindle(was, a), StepKind::Spindle(is, b)) if was == is => {
            DifferenceKind::Speed { was: *a, is: *b }
        }
        _ => DifferenceKind::Command,
    }
}
