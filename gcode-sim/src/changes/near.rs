//! Where in the new revision a reader looks for what is gone.
use super::align::Link;
use super::change::Change;
use super::record::{Record, Where};

/// Of a change that only the old revision has a block of, the block of the new one that is done next to it.
pub(super) fn note(change: &mut Change, old: &Record, new: &Record, links: &[Link]) {
    if let (Some(was), None) = (&change.old, &change.new) {
        change.near = near(was, old, new, links);
    }
}

/// The block before it that is still there, else the one behind it.
fn near(was: &Where, old: &Record, new: &Record, links: &[Link]) -> Option<Where> {
    let is_it = |link: &Link| link.sides().0.is_some_and(|i| old.places[old.steps[i].place] == *was);
    let at = links.iter().position(is_it)?;
    let mut sides = links[..at].iter().rev().chain(&links[at..]).map(|link| link.sides());
    let step = sides.find_map(|(i, j)| i.and(j))?;
    new.places.get(new.steps[step].place).cloned()
}
