//! The checks on flutes: one file each, one line here.
mod count;
mod dive;
mod ends;
mod head;
mod helix;
mod index;
mod spacing;
mod surface;

use super::Inspection;
use crate::diag::Diagnostic;
use crate::flutes::Pass;

type Check = fn(&Inspection<'_>, &mut Vec<Diagnostic>);

pub(super) const ALL: &[Check] = &[
    count::check,
    surface::check,
    helix::check,
    index::check,
    ends::check,
    spacing::check,
    head::check,
    dive::check,
];

/// The first of what is wrong with passes, and in words how many more there are: a loop makes every flute wrong alike.
fn one_and_others<'g>(
    mut wrong: impl Iterator<Item = (&'g Pass, String)>,
) -> Option<((&'g Pass, String), Option<String>)> {
    let first = wrong.next()?;
    let others = wrong.count();
    Some((first, (0 < others).then(|| format!("and so with {others} more of the passes"))))
}
