//! A honeycomb that ends too early in x, as with a length that is too small: one finding.
use super::*;
use crate::findings::{HOLE_MISSING, ROW_GROUP, ROW_SHORT};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    if comparison.pattern.is_none() || comparison.missing.is_empty() {
        return;
    }
    let x = |nominal: usize| comparison.nominal[nominal].entry[0];
    let Some(last) = comparison.pairs.iter().max_by(|a, b| x(a.nominal).total_cmp(&x(b.nominal))) else {
        return;
    };
    let end = x(last.nominal);
    // The length is the only fault if all missing holes are beyond the last one, and none is extra.
    let is_beyond = comparison.missing.iter().all(|nominal| end < x(*nominal));
    if !is_beyond || !comparison.extra.is_empty() {
        return;
    }
    let folded = findings.fold(&[&HOLE_MISSING], |_| true);
    let farthest = comparison.missing.iter().map(|nominal| x(*nominal)).fold(end, f64::max);
    let holes = match comparison.missing.len() {
        1 => "1 hole is",
        missing => &format!("{missing} holes are"),
    };
    let message = format!(
        "the pattern ends too early: the last hole is at x {end:.3}; beyond it, up to x {farthest:.3}, {holes} missing"
    );
    let finding =
        Diagnostic::new(&ROW_SHORT, message).help("check the length in the call, and its decimal point");
    // A short pattern looks like a missing group.
    findings.remove(&[&ROW_GROUP]);
    findings.put_first([finish_group_finding(finding, folded, &comparison.actual[last.actual].backtrace)]);
}
