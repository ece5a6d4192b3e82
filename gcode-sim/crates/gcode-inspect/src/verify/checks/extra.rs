//! Drilled holes that the reference does not have, and holes drilled twice.
use super::*;
use crate::findings::{HOLE_EXTRA, HOLE_TWICE};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let mut left_over: Vec<usize> = comparison.extra.iter().chain(&comparison.repeated).copied().collect();
    left_over.sort_unstable();
    for index in left_over {
        let finding = match comparison.nominal_on_line_of(index) {
            Some(_) => Diagnostic::new(&HOLE_TWICE, explain(comparison, index))
                .help(
                    "remove the second call or block: the same tool drills this hole twice; a cycle's block that only \
                     prepares the points below it has K0 (L0 on a Haas)",
                ),
            None if comparison.nominal.is_empty() => Diagnostic::new(&HOLE_EXTRA, explain(comparison, index))
                .help(
                    "give --reference with the holes of the drawing: `gcode-sim new reference --from` writes those that \
                     the program makes, to be corrected; if this is milling, state it in [[stock.pocket]]",
                ),
            None => Diagnostic::new(&HOLE_EXTRA, explain(comparison, index))
                .help("remove it from the program, or correct its position"),
        };
        let severity = match comparison.repeated.binary_search(&index) {
            Ok(_) => Severity::Warning,
            Err(_) => finding.severity,
        };
        let backtrace = comparison.actual[index].backtrace.clone();
        findings.add(Subject::Extra(index), finding.with_severity(severity).with_backtrace(backtrace));
    }
}

/// Returns the sentence on an extra hole, for the finding and the verdict.
pub(in crate::verify) fn explain(comparison: &Comparison<'_>, extra: usize) -> String {
    if let Some(nominal) = comparison.nominal_on_line_of(extra) {
        return format!("hole {} is drilled a second time", comparison.id(nominal));
    }
    let p = comparison.actual[extra].entry;
    let lacking = match comparison.nominal.is_empty() {
        true => "no reference has it",
        false => "the reference has no hole there",
    };
    format!("extra hole at x {:.3} y {:.3} z {:.3} on the part: {lacking}", p.x, p.y, p.z)
}
