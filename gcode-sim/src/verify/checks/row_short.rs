//! Where a honeycomb ends too early, as with a length that is too small, that is told instead of what it looks
//! like.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::verify::objection::{at_the_call, behind, fold};

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    let (Some(_), Some(_)) = (comparison.pattern, comparison.missing.first()) else { return };
    let x = |wanted: usize| comparison.wanted[wanted].entry[0];
    let Some(last) = comparison.pairs.iter().max_by(|a, b| x(a.wanted).total_cmp(&x(b.wanted))) else {
        return;
    };
    let end = x(last.wanted);
    // All that is missing lies beyond it, and nothing else is wrong: then nothing but the length is.
    let beyond = comparison.missing.iter().all(|wanted| end < x(*wanted));
    if !beyond || !comparison.extra.is_empty() {
        return;
    }
    let folded = fold(objections, &["hole-missing"], |_| true);
    let farthest = comparison.missing.iter().map(|wanted| x(*wanted)).fold(end, f64::max);
    let message = format!(
        "the pattern ends too early: the last hole is at x {end:.3}; beyond it, up to x {farthest:.3}, {} missing",
        match comparison.missing.len() {
            1 => "1 hole is".to_owned(),
            missing => format!("{missing} holes are"),
        }
    );
    let mut finding =
        Diagnostic::error("row-short", message).help("check the length in the call, and its decimal point");
    finding.notes.extend(behind(folded));
    // A missing group is what that looks like.
    objections.retain(|objection| objection.finding.code != "row-group");
    objections.insert(0, Objection::whole(at_the_call(finding, &comparison.found[last.found].place)));
}
