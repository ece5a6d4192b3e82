//! The checks on flutes: one file each, one line here.
mod count;
mod dive;
mod ends;
mod head;
mod helix;
mod index;
mod offset;
mod signs;
mod spacing;
mod speed;
mod surface;
mod turning;
mod twice;
mod wheel;

use super::Inspection;
use crate::diag::{Diagnostic, Site};
use crate::flutes::{Begun, Pass};

type Check = fn(&Inspection<'_>, &mut Vec<Diagnostic>);

pub(super) const ALL: &[Check] = &[
    offset::check,
    signs::check,
    count::check,
    twice::check,
    surface::check,
    helix::check,
    index::check,
    ends::check,
    spacing::check,
    head::check,
    turning::check,
    wheel::check,
    speed::check,
    dive::check,
];

/// One finding on all passes that are wrong, in the words of the first: a loop makes every flute wrong alike. `wrong` says
/// what of a pass is, at which block and where on the burr.
fn on_passes<'g, T>(
    inspection: &Inspection<'g>,
    wrong: impl Fn(&'g Pass) -> Option<(T, Begun)>,
    told: impl FnOnce(T) -> Diagnostic,
) -> Option<Diagnostic> {
    let passes = inspection.ground.passes.iter().enumerate();
    let mut all = passes.filter_map(|(index, pass)| Some((index, wrong(pass)?)));
    let (index, (what, Begun { place, at })) = all.next()?;
    let others: Vec<Site> = all.map(|(index, (_, begun))| Site { pass: Some(index), at: begun.at }).collect();
    let finding = told(what).at(place);
    let finding = match others.len() {
        0 => finding,
        more => finding.note(format!("the same applies to {more} more passes")),
    };
    Some(finding.on([Site { pass: Some(index), at }]).on(others))
}
