//! Cuts of one tool from both sides of a through hole: the second repeats the first, and threads meet only in step.
use super::features::Judgement;
use super::threads::LEAD_TOLERANCE;
use super::*;
use crate::findings::{HOLE_TWICE, TAP_PITCH};
use crate::verify::checks::tap_motion::MAX_STEP;
use crate::verify::hole_cuts::Cut;

impl Judgement<'_> {
    /// Reports what is cut again, or out of step, from the other side of a through hole.
    pub(super) fn judge_both_sides(&mut self) {
        let pairs = || self.near.iter().flat_map(|near| self.far.iter().map(move |far| (near, far)));
        let twice = pairs().find_map(|(near, far)| self.twice(near, far));
        let beside = pairs().find_map(|(near, far)| self.out_of_step(near, far));
        self.findings.extend(twice.into_iter().chain(beside));
    }

    /// Reports a tool that goes through the whole hole from both sides: a warning, but for a tap, whose second thread never meets
    /// the first.
    fn twice(&self, near: &Cut<'_>, far: &Cut<'_>) -> Option<Diagnostic> {
        let is_whole = |cut: &Cut<'_>| {
            let reached = cut.full_depth(cut.pass.diameter.unwrap_or(0.0)).unwrap_or(cut.tip);
            !exceeds(self.nominal.depth, reached)
        };
        let is_tap = |cut: &Cut<'_>| cut.is_thread() && cut.thread.is_none();
        let are_taps = is_tap(near) && is_tap(far);
        let is_stroke = !near.is_circle() && !far.is_circle();
        if !is_stroke || !near.is_same_size(&far.pass) || !(are_taps || is_whole(near) && is_whole(far)) {
            return None;
        }
        let later = if near.follows(far) { near } else { far };
        let (id, name) = (self.id, later.name());
        let (message, help) = match are_taps {
            true => (
                format!(
                    "hole {id} is tapped a second time, from its other side, by {name} and the threads do not meet"
                ),
                "tap the hole from one side only",
            ),
            false => (
                format!(
                    "hole {id} is drilled a second time, from its other side: {name} goes through it again"
                ),
                "remove the second call or block: the same tool drills this hole through from both sides",
            ),
        };
        let finding = Diagnostic::new(&HOLE_TWICE, message).help(help);
        let severity = if are_taps { Severity::Error } else { Severity::Warning };
        Some(finding.with_severity(severity).with_backtrace(later.pass.backtrace.clone()))
    }

    /// Reports a thread that is milled from both sides and goes on beside itself.
    fn out_of_step(&self, near: &Cut<'_>, far: &Cut<'_>) -> Option<Diagnostic> {
        let (one, other) = near.thread.zip(far.thread)?;
        let is_even = one.uneven_lead.is_none() && other.uneven_lead.is_none();
        // Another lead has its own finding.
        if !is_even || exceeds((one.lead - other.lead).abs(), LEAD_TOLERANCE) {
            return None;
        }
        // From the other side heights count the other way, and angles from the opposite direction: half a turn more.
        let pitch = one.lead.abs();
        let off = (one.phase + other.phase + one.lead / 2.0).rem_euclid(pitch);
        let off = off.min(pitch - off);
        if !exceeds(off, MAX_STEP) {
            return None;
        }
        let (first, later) = if near.follows(far) { (far, near) } else { (near, far) };
        let message = format!(
            "hole {}: from the other side {} mills the thread {off:.3} mm beside that of {}, limit {MAX_STEP}",
            self.id,
            later.name(),
            first.name().trim_end_matches(',')
        );
        let finding = Diagnostic::new(&TAP_PITCH, message).with_backtrace(later.pass.backtrace.clone());
        Some(
            finding.help(format!(
                "begin the helix from one side {off:.3} mm higher or lower: both are one thread"
            )),
        )
    }
}
