//! Where in the new revision a reader looks for what is gone.
use super::align::StepPair;
use super::change::Change;
use super::record::{BlockLocation, Record};

/// Of a change that only the old revision has a block of, the block of the new one that is done next to it.
pub(super) fn set_anchor(change: &mut Change, old: &Record, new: &Record, links: &[StepPair]) {
    if let (Some(was), None) = (&change.old, &change.new) {
        change.anchor = find_anchor(was, old, new, links);
    }
}

/// The block before it that is still there, else the one behind it.
fn find_anchor(was: &BlockLocation, old: &Record, new: &Record, links: &[StepPair]) -> Option<BlockLocation> {
    let is_it = |link: &StepPair| link.sides().0.is_some_and(|i| old.places[old.steps[i].place] == *was);
    let at = links.iter().position(is_it)?;
    let mut sides = links[..at].iter().rev().chain(&links[at..]).map(|link| link.sides());
    let step = sides.find_map(|(i, j)| i.and(j))?;
    new.places.get(new.steps[step].place).cloned()
}
