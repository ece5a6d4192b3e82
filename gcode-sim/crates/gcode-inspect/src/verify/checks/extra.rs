//! Drilled holes that the reference does not have, and holes drilled twice.
use super::*;
use crate::findings::{HOLE_EXTRA, HOLE_TWICE};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for index in &comparison.extra {
        let (kind, help) = match comparison.nominal_on_line_of(*index) {
            Some(_) => (&HOLE_TWICE, "remove the second call: the same tool drills this hole twice"),
            None => (&HOLE_EXTRA, "remove it from the program, or correct its position"),
        };
        let finding = Diagnostic::new(kind, explain(comparison, *index))
            .help(help)
            .with_backtrace(comparison.actual[*index].backtrace.clone());
        findings.add(Subject::Extra(*index), finding);
    }
}

/// Returns the sentence on an extra hole, for the finding and the verdict.
pub(in crate::verify) fn explain(comparison: &Comparison<'_>, extra: usize) -> String {
    if let Some(nominal) = comparison.nominal_on_line_of(extra) {
        return format!("hole {} is drilled a second time", comparison.id(nominal));
    }
    let p = comparison.actual[extra].entry;
    format!(
        "extra hole at x {:.3} y {:.3} z {:.3} on the part: the reference has no hole there",
        p.x, p.y, p.z
    )
}
