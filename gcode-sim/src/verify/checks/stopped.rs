//! Where the run stopped before its end, what it left out says nothing more: one sentence, and nothing of rows.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::verify::objection::{behind, fold};

pub(in crate::verify) fn check(comparison: &Comparison<'_>, stopped: bool, objections: &mut Vec<Objection>) {
    if !stopped || comparison.missing.is_empty() {
        return;
    }
    // Rows that were not reached look like a seam or a missing group.
    objections.retain(|objection| !objection.finding.code.starts_with("row-"));
    if let [one] = comparison.missing.as_slice() {
        for objection in objections.iter_mut().filter(|objection| objection.wanted == Some(*one)) {
            objection.finding.help = Some("find out first why the run stopped before its end".to_owned());
        }
        return;
    }
    fold(objections, &["hole-missing"], |_| true);
    let (missing, all) = (comparison.missing.len(), comparison.wanted.len());
    let message = format!("the run stopped before its end: {missing} of {all} holes are missing");
    let mut finding = Diagnostic::error("hole-missing", message)
        .help("correct the cause of the stop first: the holes after it were not begun");
    finding.notes.extend(behind(missing));
    objections.insert(0, Objection::whole(finding));
}
