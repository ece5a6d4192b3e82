//! Differences of two runs: all of them, also those that follow from others.
use std::collections::BTreeSet;

use super::align::{Alignment, StepPair};
use super::arcs::reshaped;
use super::change::Effect;
use super::hole_groups::HoleEffect;
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

/// Returns all differences: outcome, name and start, then those of holes, of steps, and of the final state.
///
/// If the outcomes differ, the final states are not compared; with a run that never ends, the outcome is the only
/// difference, because the iteration that corresponds to the other's end is unknown.
pub(super) fn differences(
    alignment: &Alignment<'_>,
    holes: Vec<HoleEffect>,
    cuts: &ReorderedCuts<'_>,
) -> Vec<Difference> {
    let Alignment { records, tolerance, .. } = *alignment;
    let outcome = end_state::outcome(records);
    let ends = records.map(|record| record.outcome());
    let is_to_the_end = outcome.is_none() || ends == ["end", "end"];
    if !is_to_the_end && ends.contains(&"limit") {
        return outcome.into_iter().map(Difference::Run).collect();
    }
    let mut all: Vec<Difference> = outcome.into_iter().map(Difference::Run).collect();
    all.extend(end_state::program(records).map(Difference::Run));
    all.extend(initial_commands::compare(alignment).into_iter().map(Difference::Run));
    all.extend(holes.into_iter().map(Difference::Holes));
    all.extend(conditions(alignment));
    let (steps, relied) = steps(alignment, cuts);
    all.extend(steps);
    all.extend(cuts.effects().into_iter().chain(relied).map(Difference::Run));
    if is_to_the_end {
        all.extend(end_state::compare(records, tolerance).into_iter().map(Difference::Run));
    }
    all
}

/// Returns the moves whose modal conditions differ, with H2 for H1 even if both are 0 in a run without a table.
fn conditions(alignment: &Alignment<'_>) -> Vec<Difference> {
    let [old, new] = alignment.records;
    let mut all = Vec::new();
    for (i, j) in alignment.pairs().filter(|(i, _)| old.steps[*i].is_move()) {
        for aspect in ModalAspect::ALL {
            let (was, is) = (&old.under(i).word(aspect).text, &new.under(j).word(aspect).text);
            // A cycle in one revision alone is a difference of its holes.
            if was != is && !was.is_empty() && !is.is_empty() {
                all.push(Difference::Step(StepDifference::Condition(aspect), [Some(i), Some(j)]));
            }
        }
    }
    all
}

/// Returns all differences of steps in their order, and the changed commands that cuts relied on. Steps of
/// reordered cuts are part of these; a command of what is in force already is no difference.
fn steps(alignment: &Alignment<'_>, cuts: &ReorderedCuts<'_>) -> (Vec<Difference>, Vec<Effect>) {
    let Alignment { records: [old, new], links, .. } = *alignment;
    let mut explained: BTreeSet<usize> = redundant_commands(alignment).collect();
    let mut shifted = shifted_events(alignment);
    explained.extend(take_with_runs(&mut shifted, links, cuts));
    let is_free = |k: usize| links[k].is_unpaired() && !shifted.contains_key(&k);
    let relied = relied_on_changes(alignment, is_free);
    let is_of_step = |(k, effect): &&(usize, Effect)| {
        let change = alignment.step(links[*k]).and_then(|step| step.kind.change());
        change.is_some_and(|kind| kind.code == effect.code)
    };
    explained.extend(relied.iter().filter(is_of_step).map(|(k, _)| *k));
    let mut all = Vec::new();
    for (k, link) in links.iter().enumerate() {
        let sides = link.sides();
        let mut add = |kind| all.push(Difference::Step(kind, sides));
        let [was, is] = alignment.steps(sides);
        let both = was.zip(is);
        match (shifted.get(&k), both) {
            (Some(None), _) => {}
            (Some(Some((i, j, word))), _) => {
                if !(is_redundant(&old.steps, *i) && is_redundant(&new.steps, *j)) {
                    all.push(Difference::Step(StepDifference::Shifted(word), [Some(*i), Some(*j)]));
                }
            }
            (None, None) if !explained.contains(&k) && !cuts.contains(link) => add(StepDifference::Unpaired),
            (None, Some((was, is))) if matches!(link, StepPair::Changed(..)) => {
                if was.is_move() {
                    moved(was, is, alignment.tolerance, &mut add);
                } else {
                    add(command(was, is));
                }
                feed(was, is).into_iter().for_each(add);
            }
            (None, both) => both.and_then(|(was, is)| feed(was, is)).into_iter().for_each(add),
        }
    }
    (all, relied.into_iter().map(|(_, effect)| effect).collect())
}

/// Returns the difference of two feeds. In G93 a move takes its time, and is slower if its path is shorter.
fn feed(old: &Step, new: &Step) -> Option<StepDifference> {
    let (was, is) = (old.kind.rate()?, new.kind.rate()?);
    let (before, now) = (old.length() / was, new.length() / is);
    let is_other_length = (old.length() - new.length()).abs() > 1e-9;
    let is_as_long = is_other_length && (before - now).abs() <= 1e-5 * before;
    let is_other = (was - is).abs() > 1e-6 * was.abs().max(is.abs());
    (is_other && !is_as_long).then_some(StepDifference::Feed { was, is })
}

/// Adds the differences of a move without its feed.
fn moved(old: &Step, new: &Step, tolerance: f64, add: &mut impl FnMut(StepDifference)) {
    if old.kind.name() != new.kind.name() {
        add(StepDifference::MoveKind);
    }
    let shift = difference(&new.to, &old.to);
    let is_moved = !near(&shift, &Position::default(), tolerance);
    if let (StepKind::Arc(a, _), StepKind::Arc(b, _)) = (&old.kind, &new.kind) {
        let is_moved = is_moved || !near(&new.from, &old.from, tolerance);
        let text = reshaped((old, a), (new, b), is_moved, tolerance);
        text.map(StepDifference::ArcShape).into_iter().for_each(&mut *add);
    }
    if is_moved {
        add(StepDifference::EndPoint(shift));
    }
}

fn command(old: &Step, new: &Step) -> StepDifference {
    match (&old.kind, &new.kind) {
        (StepKind::Spindle(was, a), StepKind::Spindle(is, b)) if was == is => {
            StepDifference::Speed { was: *a, is: *b }
        }
        _ => StepDifference::Command,
    }
}
