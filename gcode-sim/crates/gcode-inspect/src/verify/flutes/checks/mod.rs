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
use crate::flutes::{FirstOccurrence, GrindingPass};
use gcode_lang::diag::{Diagnostic, Site};

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
fn report_passes<'g, T>(
    inspection: &Inspection<'g>,
    fault: impl Fn(&'g GrindingPass) -> Option<(T, FirstOccurrence)>,
    finding: impl FnOnce(T) -> Diagnostic,
) -> Option<Diagnostic> {
    let passes = inspection.actual.passes.iter().enumerate();
    let mut all = passes.filter_map(|(index, pass)| Some((index, fault(pass)?)));
    let (index, (what, FirstOccurrence { backtrace: place, point: at })) = all.next()?;
    let others: Vec<Site> = all.map(|(index, (_, begun))| Site::new(Some(index), begun.point)).collect();
    let finding = finding(what).with_backtrace(place);
    let finding = match others.len() {
        0 => finding,
        more => finding.note(format!("the same applies to {more} more passes")),
    };
    Some(finding.with_sites([Site::new(Some(index), at)]).with_sites(others))
}
