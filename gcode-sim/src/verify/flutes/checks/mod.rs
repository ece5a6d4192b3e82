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

use nalgebra::Point3;

use super::Inspection;
use crate::diag::{Diagnostic, Site};
use crate::flutes::Pass;

type Check = fn(&Inspection<'_>, &mut Vec<Diagnostic>);

pub(super) const ALL: &[Check] = &[
    offset::check,
    signs::check,
    count::check,
    surface::check,
    helix::check,
    index::check,
    ends::check,
    spacing::check,
    head::check,
    turning::check,
    speed::check,
    dive::check,
];

/// One finding on all passes that are wrong, in the words of the first: a loop makes every flute wrong alike. `wrong` says
/// what of a pass is, and where on the burr.
fn on_passes<'g>(
    inspection: &Inspection<'g>,
    code: &str,
    wrong: impl Fn(&'g Pass) -> Option<(String, Point3<f64>)>,
) -> Option<Diagnostic> {
    let passes = inspection.ground.passes.iter().enumerate();
    let mut all = passes.filter_map(|(index, pass)| Some((index, pass, wrong(pass)?)));
    let (index, pass, (message, at)) = all.next()?;
    let others: Vec<Site> = all.map(|(index, _, (_, at))| Site { pass: Some(index), at }).collect();
    let finding = Diagnostic::error(code, message).at(pass.place.clone());
    let finding = match others.len() {
        0 => finding,
        more => finding.note(format!("and so with {more} more of the passes")),
    };
    Some(finding.on([Site { pass: Some(index), at }]).on(others))
}
