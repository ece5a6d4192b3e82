//! Differences of two runs: all of them, also those that follow from others.
use std::collections::BTreeSet;

use super::align::Alignment;
use super::arcs::reshaped;
use super::change::Effect;
use super::hole_groups::HoleEffect;
use super::links::StepPair;
use super::modal_conditions::ModalAspect;
use super::redundant_commands::{is_redundant, redundant_commands};
use super::reordered_cuts::ReorderedCuts;
use super::shifted_events::{shifted_events, take_with_runs};
use super::steps::{Step, StepKind, difference, near};
use super::tool_setup::relied_on_changes;
use super::{end_state, initial_commands};
use gcode_lang::motion::Position;

/// One difference of two runs.
pub(super) enum Difference {
    /// Of a run: its end, its start, the order of its cuts, the state that a cut relies on.
    Run(Effect),
    /// Of holes.
    Holes(HoleEffect),
    /// Of a step or of two that are paired, by their numbers, old and new.
    Step(StepDifference, [Option<usize>; 2]),
}

/// Difference of a step.
pub(super) enum StepDifference {
    /// A move is made under another modal condition.
    Condition(ModalAspect),
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

/// Passes on all differences: outcome, name and start, then those of holes, of steps, and of the final state.
///
/// If the outcomes differ, the final states are not compared; with a run that never ends, the outcome is the only
/// difference, because the iteration that corresponds to the other's end is unknown.
pub(super) fn differences(
    alignment: &Alignment<'_>,
    holes: Vec<HoleEffect>,
    cuts: &ReorderedCuts<'_>,
    mut each: impl FnMut(Difference),
) {
    let Alignment { records, tolerance, .. } = *alignment;
    let outcome = end_state::outcome(records);
    let ends = records.map(|record| record.outcome());
    let is_to_the_end = outcome.is_none() || ends == ["end", "end"];
    if !is_to_the_end && ends.contains(&"limit") {
        outcome.into_iter().map(Difference::Run).for_each(each);
        return;
    }
    outcome.into_iter().chain(end_state::program(records)).map(Difference::Run).for_each(&mut each);
    initial_commands::compare(alignment).into_iter().map(Difference::Run).for_each(&mut each);
    holes.into_iter().map(Difference::Holes).for_each(&mut each);
    conditions(alignment, &mut each);
    let relied = steps(alignment, cuts, &mut each);
    cuts.effects().into_iter().chain(relied).map(Difference::Run).for_each(&mut each);
    if is_to_the_end {
        end_state::compare(records, tolerance).into_iter().map(Difference::Run).for_each(each);
    }
}

/// Passes on the moves whose modal conditions differ, with H2 for H1 even if both are 0 in a run without a table.
fn conditions(alignment: &Alignment<'_>, each: &mut impl FnMut(Difference)) {
    let [old, new] = alignment.records;
    let differs = |numbers: (usize, usize)| {
        let under = (&old.conditions[numbers.0], &new.conditions[numbers.1]);
        let differs = |aspect: &ModalAspect| {
            let (was, is) = (&under.0.word(*aspect).text, &under.1.word(*aspect).text);
            // A cycle in one revision alone is a difference of its holes.
            was != is && !was.is_empty() && !is.is_empty()
        };
        (numbers, ModalAspect::ALL.into_iter().filter(differs).collect::<Vec<_>>())
    };
    let mut last = ((usize::MAX, usize::MAX), Vec::new());
    for (i, j) in alignment.pairs() {
        let numbers = (old.steps.condition(i), new.steps.condition(j));
        if last.0 != numbers {
            last = differs(numbers);
        }
        if !last.1.is_empty() && old.steps.is_move(i) {
            let condition = |aspect: &ModalAspect| {
                Difference::Step(StepDifference::Condition(*aspect), [Some(i), Some(j)])
            };
            last.1.iter().map(condition).for_each(&mut *each);
        }
    }
}

/// Passes on all differences of steps in their order, and returns the changed commands that cuts relied on. Steps of
/// reordered cuts are part of these; a command of what is in force already is no difference.
fn steps(
    alignment: &Alignment<'_>,
    cuts: &ReorderedCuts<'_>,
    each: &mut impl FnMut(Difference),
) -> Vec<Effect> {
    let Alignment { records: [old, new], links, .. } = *alignment;
    let mut explained: BTreeSet<usize> = redundant_commands(alignment).collect();
    let mut shifted = shifted_events(alignment);
    explained.extend(take_with_runs(&mut shifted, links, cuts));
    let is_unpaired = |k: usize| links.get(k).is_some_and(StepPair::is_unpaired);
    let is_free = |k: usize| is_unpaired(k) && !shifted.contains_key(&k);
    let relied = relied_on_changes(alignment, is_free);
    let is_of_step = |(k, effect): &&(usize, Effect)| {
        let step = links.get(*k).and_then(|link| alignment.step(link));
        step.and_then(|step| step.kind.change()).is_some_and(|kind| kind.code == effect.code)
    };
    explained.extend(relied.iter().filter(is_of_step).map(|(k, _)| *k));
    for (k, link) in links.iter().enumerate() {
        let sides = link.sides();
        let mut add = |kind| each(Difference::Step(kind, sides));
        if let StepPair::Same(i, j) = link {
            if let (Some(was), Some(is)) = (old.steps.kind(i).rate(), new.steps.kind(j).rate())
                && is_other_rate(was, is)
            {
                feed(&old.steps.at(i), &new.steps.at(j)).into_iter().for_each(add);
            }
            continue;
        }
        let [was, is] = alignment.steps(sides);
        let both = was.zip(is);
        match (shifted.get(&k), both) {
            (Some(None), _) => {}
            (Some(Some((i, j, word))), _) => {
                if !(is_redundant(&old.steps, *i) && is_redundant(&new.steps, *j)) {
                    each(Difference::Step(StepDifference::Shifted(word), [Some(*i), Some(*j)]));
                }
            }
            (None, None) if !explained.contains(&k) && !cuts.contains(&link) => add(StepDifference::Unpaired),
            (None, None) => {}
            (None, Some((was, is))) => {
                if was.is_move() {
                    moved(&was, &is, alignment.tolerance, &mut add);
                } else {
                    add(command(&was, &is));
                }
                feed(&was, &is).into_iter().for_each(add);
            }
        }
    }
    relied.into_iter().map(|(_, effect)| effect).collect()
}

fn is_other_rate(was: f64, is: f64) -> bool {
    (was - is).abs() > 1e-6 * was.abs().max(is.abs())
}

/// Returns the difference of two feeds. In G93 a move takes its time, and is slower if its path is shorter.
fn feed(old: &Step<'_>, new: &Step<'_>) -> Option<StepDifference> {
    let (was, is) = (old.kind.rate()?, new.kind.rate()?);
    let (before, now) = (old.length() / was, new.length() / is);
    let is_other_length = (old.length() - new.length()).abs() > 1e-9;
    let is_as_long = is_other_length && (before - now).abs() <= 1e-5 * before;
    (is_other_rate(was, is) && !is_as_long).then_some(StepDifference::Feed { was, is })
}

/// Adds the differences of a move without its feed.
fn moved(old: &Step<'_>, new: &Step<'_>, tolerance: f64, add: &mut impl FnMut(StepDifference)) {
    if old.kind.name() != new.kind.name() {
        add(StepDifference::MoveKind);
    }
    let shift = difference(&new.to, &old.to);
    let is_moved = !near(&shift, &Position::default(), tolerance);
    if let (StepKind::Arc(a, _), StepKind::Arc(b, _)) = (old.kind, new.kind) {
        let is_moved = is_moved || !near(&new.from, &old.from, tolerance);
        let text = reshaped((old, a), (new, b), is_moved, tolerance);
        text.map(StepDifference::ArcShape).into_iter().for_each(&mut *add);
    }
    if is_moved {
        add(StepDifference::EndPoint(shift));
    }
}

fn command(old: &Step<'_>, new: &Step<'_>) -> StepDifference {
    match (old.kind, new.kind) {
        (StepKind::Spindle(was, a), StepKind::Spindle(is, b)) if was == is => {
            StepDifference::Speed { was: *a, is: *b }
        }
        _ => StepDifference::Command,
    }
}
