//! The checks on flutes: one file each, one line here. All of them share the imports of this file.
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
mod start_unknown;
mod surface;
mod turning;
mod twice;
mod wheel;

use gcode_part::exceeds;
use nalgebra::Point3;

use super::Inspection;
use crate::flutes::{FirstOccurrence, GrindingPass, Sample, other_law};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity, Site};
use gcode_part::Flutes;

/// A check adds its findings.
type Check = fn(&Inspection<'_>, &mut Vec<Diagnostic>);

/// The checks, in the order of their findings.
pub(super) const ALL: &[Check] = &[
    start_unknown::check,
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

/// Returns one finding for all passes with a fault, in the words of the first: a loop repeats it in every flute. `fault`
/// returns the fault of a pass, its block and its point on the burr.
fn report_passes<'g, T>(
    inspection: &Inspection<'g>,
    fault: impl Fn(&'g GrindingPass) -> Option<(T, FirstOccurrence)>,
    finding: impl FnOnce(T) -> Diagnostic,
) -> Option<Diagnostic> {
    let passes = inspection.actual.passes.iter().enumerate();
    let mut faults = passes.filter_map(|(index, pass)| Some((index, fault(pass)?)));
    let (index, (first, FirstOccurrence { backtrace, point })) = faults.next()?;
    let others: Vec<Site> = faults.map(|(index, (_, at))| Site::new(Some(index), at.point)).collect();
    let note = (!others.is_empty()).then(|| format!("the same applies to {} more passes", others.len()));
    let finding = note.into_iter().fold(finding(first).with_backtrace(backtrace), Diagnostic::note);
    Some(finding.with_sites([Site::new(Some(index), point)]).with_sites(others))
}
