//! Commands of spindle, coolant and tool length that repeat what is in force: adding or removing one has no effect.
use super::align::Alignment;
use super::kinds;
use super::steps::{Step, StepKind};
use gcode_lang::motion::SpindleDirection;

/// Returns the links of lost and added commands that are in force before and after their place in both revisions.
pub(super) fn redundant_commands<'a>(alignment: &Alignment<'a>) -> impl Iterator<Item = usize> + use<'a> {
    let alignment = *alignment;
    let counts = alignment.links.iter().scan([0, 0], |counts, link| {
        let sides = link.sides();
        *counts = [0, 1].map(|side| sides[side].map_or(counts[side], |step| step + 1));
        Some(*counts)
    });
    let is_repeated = move |(k, counts): &(usize, [usize; 2])| {
        let link = alignment.links[*k];
        let is_in_force = |step: &Step| {
            (0..2).all(|side| is_in_force(&step.kind, &alignment.records[side].steps, counts[side]))
        };
        link.is_unpaired() && alignment.step(link).is_some_and(is_in_force)
    };
    counts.enumerate().filter(is_repeated).map(|(k, _)| k)
}

/// Returns true if the spindle turns in the same direction before a spindle command, whose block may be an S alone.
pub(super) fn is_speed_alone(steps: &[Step], at: usize) -> bool {
    let StepKind::Spindle(direction, _) = steps[at].kind else { return false };
    let before = steps[..at].iter().rev().take_while(|step| !interrupts(step));
    let before = before.map(|step| &step.kind).find(|kind| kind.change() == Some(&kinds::SPINDLE));
    direction != SpindleDirection::Off
        && matches!(before, Some(StepKind::Spindle(other, _)) if *other == direction)
}

/// Returns true if a step commands what is in force before it.
pub(super) fn is_redundant(steps: &[Step], at: usize) -> bool {
    is_last(&steps[at].kind, &steps[..at])
}

/// Returns true if a command is in force after the first steps and the commands up to the next move.
fn is_in_force(kind: &StepKind, steps: &[Step], at: usize) -> bool {
    let at_once = steps[at..].iter().take_while(|step| !interrupts(step) && !step.is_move());
    is_last(kind, &steps[..at + at_once.count()])
}

/// Returns true if a command is the last of its kind.
fn is_last(kind: &StepKind, steps: &[Step]) -> bool {
    let is_length = matches!(kind, StepKind::Length(_));
    let is_modal = is_length || matches!(kind, StepKind::Spindle(..) | StepKind::Coolant(..));
    let mut before = steps.iter().rev().take_while(|step| is_length || !interrupts(step));
    let is_alike = |step: &&Step| std::mem::discriminant(&step.kind) == std::mem::discriminant(kind);
    is_modal && before.find(is_alike).is_some_and(|step| step.kind == *kind)
}

/// Returns true for a tool change, a stop and an M code of the machine builder: some stop spindle and coolant.
fn interrupts(step: &Step) -> bool {
    let change = step.kind.change();
    matches!(step.kind, StepKind::Tool(_)) || [&kinds::STOP, &kinds::M_CODE].map(Some).contains(&change)
}
