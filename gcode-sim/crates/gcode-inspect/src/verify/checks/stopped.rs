//! Where the run stopped before its end, what it left out says nothing more: one sentence, and nothing of rows.
use super::{HoleFinding, HoleInspection};
use crate::findings::{HOLE_MISSING, ROW_ANGLE, ROW_GROUP, ROW_MISSING, ROW_PITCH, ROW_SEAM, ROW_SHORT};
use crate::verify::hole_finding::{fold, folded_note};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};

/// Findings about rows.
const ROW_KINDS: [&FindingKind; 6] =
    [&ROW_ANGLE, &ROW_GROUP, &ROW_MISSING, &ROW_PITCH, &ROW_SEAM, &ROW_SHORT];

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let is_alarm = |finding: &Diagnostic| finding.severity == Severity::Alarm;
    if comparison.missing.is_empty() || !inspection.extraction.findings.iter().any(is_alarm) {
        return;
    }
    // Rows that were not reached look like a seam or a missing group.
    objections.retain(|objection| !objection.is_one_of(&ROW_KINDS));
    if let [one] = comparison.missing.as_slice() {
        for objection in objections.iter_mut().filter(|objection| objection.nominal == Some(*one)) {
            objection.finding.help = Some("find out first why the run stopped before its end".to_owned());
        }
        return;
    }
    fold(objections, &[&HOLE_MISSING], |_| true);
    let (missing, all) = (comparison.missing.len(), comparison.nominal.len());
    let message = format!("the run stopped before its end: {missing} of {all} holes are missing");
    let mut finding = Diagnostic::new(&HOLE_MISSING, message)
        .help("correct the cause of the stop first: the holes after it were not begun");
    finding.notes.extend(folded_note(missing));
    objections.insert(0, HoleFinding::unlocated(finding));
}
