//! The neighbour of a removed block in the new revision.
use super::align::Alignment;
use super::change::Change;
use super::links::StepPair;

/// Gives a change that only the old revision has a block of its neighbouring block in the new one: the block before
/// it that is still there, else the one after it.
pub(super) fn set_anchor(change: &mut Change, alignment: &Alignment<'_>) {
    let (Some(was), None) = (&change.old, &change.new) else { return };
    let [old, new] = alignment.records;
    let Some(number) = old.blocks.find(was) else { return };
    let is_anchor = |link: StepPair| link.sides()[0].is_some_and(|i| old.steps.block_number(i) == number);
    let links = alignment.links;
    let Some(at) = links.iter().position(is_anchor) else { return };
    let partner = |number: usize| links.get(number).and_then(|link| link.sides()[0].and(link.sides()[1]));
    let step = (0..at).rev().chain(at..links.len()).find_map(partner);
    change.anchor = step.map(|step| new.block(step).into_owned());
}
