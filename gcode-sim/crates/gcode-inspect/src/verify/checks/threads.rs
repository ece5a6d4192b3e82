//! Threads: the hole is drilled deeper than its thread, before it, and feed and speed give the pitch.
use super::features::Judgement;
use super::*;
use crate::findings::{TAP_DRILL, TAP_PITCH};
use crate::verify::stack::{Cut, assign};
use gcode_part::{FeatureKind, NOISE};

/// Largest relative deviation of the pitch: rounding of F.
const PITCH_TOLERANCE: f64 = 0.005;

/// Adds the findings on the threads of a hole.
pub(super) fn judge(judged: &mut Judgement<'_>) {
    let (nominal, id) = (judged.nominal, judged.id);
    if !judged.near.iter().any(Cut::is_tap) {
        return;
    }
    let drilled = (0..judged.near.len()).filter_map(|cut| drilled_depth(nominal, id, &judged.near, cut));
    let findings: Vec<_> = drilled.chain(pitches(judged.comparison, nominal, id, &judged.near)).collect();
    judged.findings.extend(findings);
}

/// Reports a thread that ends no higher than what is drilled before it. A thread in a hole that the program doesn't drill is
/// left open.
fn drilled_depth(nominal: &Hole, id: &str, cuts: &[Cut<'_>], index: usize) -> Option<Diagnostic> {
    let tap = cuts.get(index).filter(|cut| cut.is_tap())?;
    cuts.iter().find(|cut| !cut.is_tap())?;
    let depth = |cut: &Cut<'_>| cut.full_depth(nominal.diameter.unwrap_or(0.0)).unwrap_or(cut.tip);
    let before = cuts[..index].iter().filter(|cut| !cut.is_tap()).map(depth);
    let drilled = before.fold(0.0, f64::max);
    let is_open = nominal.through && !exceeds(nominal.depth, drilled);
    if is_open || tap.tip + NOISE < drilled {
        return None;
    }
    let message = format!(
        "hole {id}: {} taps {:.3} mm deep where {drilled:.3} mm are drilled before it",
        tap.name(),
        tap.tip
    );
    let finding = Diagnostic::new(&TAP_DRILL, message).with_backtrace(tap.pass.backtrace.clone());
    Some(finding.help(
        "drill deeper than the thread, before the tap, by the point of the drill and the lead of the tap",
    ))
}

/// Reports the threads whose feed per revolution is not the pitch.
fn pitches(comparison: &Comparison<'_>, nominal: &Hole, id: &str, cuts: &[Cut<'_>]) -> Vec<Diagnostic> {
    let made_by = assign(&nominal.features, cuts, comparison.tolerances);
    let threads =
        nominal.features.iter().zip(made_by).filter(|(feature, _)| feature.kind == FeatureKind::Tap);
    let finding = |(feature, cut): (&gcode_part::Feature, Option<usize>)| {
        let (cut, nominal) = (&cuts[cut?], feature.pitch?);
        let (feed, speed) = (cut.pass.cut.feed?.0, cut.pass.cut.speed.0);
        let actual = feed / speed;
        if !exceeds((actual - nominal).abs(), PITCH_TOLERANCE * nominal) {
            return None;
        }
        let message = format!(
            "hole {id}: {} feeds {actual:.4} mm a revolution (F{} at S{speed}), the pitch is {nominal}",
            cut.name(),
            cutting::round_thousandth(feed)
        );
        let finding = Diagnostic::new(&TAP_PITCH, message).with_backtrace(cut.pass.backtrace.clone());
        Some(finding.help(format!(
            "command F{} at S{speed}, or correct the pitch",
            cutting::round_thousandth(nominal * speed)
        )))
    };
    threads.filter_map(finding).collect()
}
