//! The neighbour of a removed block in the new revision.
use super::align::Alignment;
use super::change::Change;

/// Gives a change that only the old revision has a block of its neighbouring block in the new one: the block before
/// it that is still there, else the one after it.
pub(super) fn set_anchor(change: &mut Change, alignment: &Alignment<'_>) {
    let (Some(was), None) = (&change.old, &change.new) else { return };
    let [old, new] = alignment.records;
    let is_anchor = |[i, _]: &[Option<usize>; 2]| i.is_some_and(|i| old.block(i) == was);
    let sides: Vec<[Option<usize>; 2]> = alignment.links.iter().map(|link| link.sides()).collect();
    let Some(at) = sides.iter().position(is_anchor) else { return };
    let step = sides[..at].iter().rev().chain(&sides[at..]).find_map(|[i, j]| i.and(*j));
    change.anchor = step.map(|step| new.block(step).clone());
}
