//! A run that stops before its end: one finding for all holes that it did not reach.
use super::*;
use crate::findings::{HOLE_MISSING, ROW_ANGLE, ROW_GROUP, ROW_MISSING, ROW_PITCH, ROW_SEAM, ROW_SHORT};

/// Findings about rows.
const ROW_KINDS: [&FindingKind; 6] =
    [&ROW_ANGLE, &ROW_GROUP, &ROW_MISSING, &ROW_PITCH, &ROW_SEAM, &ROW_SHORT];

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let is_alarm = |finding: &Diagnostic| finding.severity == Severity::Alarm;
    if comparison.missing.is_empty() || !inspection.extraction.findings.iter().any(is_alarm) {
        return;
    }
    // Rows that were not reached look like a seam or a missing group.
    findings.remove(&ROW_KINDS);
    if let [one] = comparison.missing[..] {
        findings.set_help(Subject::Nominal(one), "find out first why the run stopped before its end");
        return;
    }
    findings.fold(&[&HOLE_MISSING], |_| true);
    let (missing, all) = (comparison.missing.len(), comparison.nominal.len());
    let message = format!("the run stopped before its end: {missing} of {all} holes are missing");
    let mut finding = Diagnostic::new(&HOLE_MISSING, message)
        .help("correct the cause of the stop first: the holes after it were not begun");
    finding.notes.extend(folded_note(missing));
    findings.put_first([finding]);
}
