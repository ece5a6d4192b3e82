//! Commands of spindle, coolant and tool length that repeat what is in force: adding or removing one has no effect.
use super::align::Alignment;
use super::kinds;
use super::links::StepPair;
use super::step_list::StepList;
use super::steps::StepKind;
use gcode_lang::motion::SpindleDirection;

/// Returns the links of lost and added commands that are in force before and after their place in both revisions.
pub(super) fn redundant_commands<'a>(alignment: &Alignment<'a>) -> impl Iterator<Item = usize> + use<'a> {
    let Alignment { records, links, .. } = *alignment;
    let is_repeated = move |(k, link): &(usize, StepPair)| {
        let [lost, added] = link.sides();
        let Some(kind) = lost.map(|i| records[0].steps.kind(i)).or(added.map(|j| records[1].steps.kind(j)))
        else {
            return false;
        };
        // A move, or a command that has no state, is no repetition.
        is_modal(kind) && {
            let counts = links.counts_up_to(*k);
            (0..2).all(|side| is_in_force(kind, &records[side].steps, counts[side]))
        }
    };
    links.unpaired().filter(is_repeated).map(|(k, _)| k)
}

/// Returns true if the spindle turns in the same direction before a spindle command, whose block may be an S alone.
pub(super) fn is_speed_alone(steps: &StepList, at: usize) -> bool {
    let StepKind::Spindle(direction, _) = steps.kind(at) else { return false };
    let before = (0..at).rev().map(|step| steps.kind(step)).take_while(|kind| !interrupts(kind));
    let mut before = before;
    let before = before.find(|kind| kind.change() == Some(&kinds::SPINDLE));
    *direction != SpindleDirection::Off
        && matches!(before, Some(StepKind::Spindle(other, _)) if other == direction)
}

/// Returns true if a step commands what is in force before it.
pub(super) fn is_redundant(steps: &StepList, at: usize) -> bool {
    is_last(steps.kind(at), steps, at)
}

/// Returns true if a command is in force after the first steps and the commands up to the next move.
fn is_in_force(kind: &StepKind, steps: &StepList, at: usize) -> bool {
    let next = (at..steps.len()).map(|step| steps.kind(step));
    let at_once = next.take_while(|kind| !interrupts(kind) && !kind.is_move());
    is_last(kind, steps, at + at_once.count())
}

/// Returns true for a command whose state stays in force.
fn is_modal(kind: &StepKind) -> bool {
    matches!(kind, StepKind::Length(_) | StepKind::Spindle(..) | StepKind::Coolant(..))
}

/// Returns true if a command is the last of its kind among the first steps.
fn is_last(kind: &StepKind, steps: &StepList, count: usize) -> bool {
    let is_length = matches!(kind, StepKind::Length(_));
    let before = (0..count).rev().map(|step| steps.kind(step));
    let mut before = before.take_while(|kind| is_length || !interrupts(kind));
    let is_alike = |other: &&StepKind| std::mem::discriminant(*other) == std::mem::discriminant(kind);
    is_modal(kind) && before.find(is_alike).is_some_and(|other| other == kind)
}

/// Returns true for a tool change, a stop and an M code of the machine builder: some stop spindle and coolant.
fn interrupts(kind: &StepKind) -> bool {
    let change = kind.change();
    matches!(kind, StepKind::Tool(_)) || [&kinds::STOP, &kinds::M_CODE].map(Some).contains(&change)
}
