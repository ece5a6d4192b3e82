//! Drilling cycles that cut nothing, as beside the stock: where a hole is missing, its finding names them.
use super::*;
use gcode_lang::motion::Backtrace;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, extraction, .. } = inspection;
    if !comparison.missing.is_empty() {
        return;
    }
    // A tool of unknown diameter may cut at its side.
    let place = |backtrace: &Backtrace| (backtrace.block.source, backtrace.block.start);
    let extra: BTreeSet<_> =
        comparison.extra.iter().map(|index| place(&comparison.actual[*index].backtrace)).collect();
    let is_extra =
        |finding: &Diagnostic| finding.backtrace.as_ref().is_some_and(|own| extra.contains(&place(own)));
    for finding in extraction.cycles_in_air.iter().filter(|finding| !is_extra(finding)) {
        findings.add(Subject::Motion, finding.clone());
    }
}
