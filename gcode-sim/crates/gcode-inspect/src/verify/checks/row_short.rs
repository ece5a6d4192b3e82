//! Where a honeycomb ends too early, as with a length that is too small, that is told instead of what it looks
//! like.
use super::{HoleFinding, HoleInspection};
use crate::findings::{HOLE_MISSING, ROW_GROUP, ROW_SHORT};
use crate::verify::hole_finding::{fold, folded_note, locate_at_call};
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let (Some(_), Some(_)) = (comparison.pattern, comparison.missing.first()) else { return };
    let x = |wanted: usize| comparison.nominal[wanted].entry[0];
    let Some(last) = comparison.pairs.iter().max_by(|a, b| x(a.nominal).total_cmp(&x(b.nominal))) else {
        return;
    };
    let end = x(last.nominal);
    // All that is missing lies beyond it, and nothing else is wrong: then nothing but the length is.
    let beyond = comparison.missing.iter().all(|wanted| end < x(*wanted));
    if !beyond || !comparison.extra.is_empty() {
        return;
    }
    let folded = fold(objections, &[&HOLE_MISSING], |_| true);
    let farthest = comparison.missing.iter().map(|wanted| x(*wanted)).fold(end, f64::max);
    let message = format!(
        "the pattern ends too early: the last hole is at x {end:.3}; beyond it, up to x {farthest:.3}, {} missing",
        match comparison.missing.len() {
            1 => "1 hole is".to_owned(),
            missing => format!("{missing} holes are"),
        }
    );
    let mut finding =
        Diagnostic::new(&ROW_SHORT, message).help("check the length in the call, and its decimal point");
    finding.notes.extend(folded_note(folded));
    // A missing group is what that looks like.
    objections.retain(|objection| objection.finding.kind != &ROW_GROUP);
    objections.insert(
        0,
        HoleFinding::unlocated(locate_at_call(finding, &comparison.actual[last.actual].backtrace)),
    );
}
