//! Through holes on one axis, as in the ears of a clevis: strokes through several of them, and into the next one.
use super::features::Judgement;
use super::*;
use crate::findings::FEATURE_EXTRA;
use crate::holes::DrilledHole;
use crate::machine::Machine;
use crate::verify::followers::Follower;
use crate::verify::hole_cuts::Cut;
use crate::verify::outline::Outline;

/// Returns the cuts of the holes that follow a through hole and begin above it: one stroke drills both ears of a clevis, and
/// another tool finishes the first.
pub(super) fn strokes_through<'c>(
    comparison: &'c Comparison<'_>,
    pair: &HolePair,
    followers: &[Follower],
    machine: &Machine,
) -> Vec<Cut<'c>> {
    let hole = &comparison.nominal[pair.nominal];
    let mut cuts = Vec::new();
    for next in followers {
        let is_other = |other: &&HolePair| other.nominal == next.index && other.actual != pair.actual;
        let other = comparison.pairs.iter().find(is_other);
        let Some(drilled) = other.map(|other| &comparison.actual[other.actual]) else { continue };
        if 0.0 < drilled.axis.dot(&Vector3::from(hole.axis)) {
            // A tap may turn in the wider hole.
            let begins_above = |cut: &Cut<'_>| !cut.is_thread() && !exceeds(cut.start, 0.0);
            cuts.extend(Cut::all(hole, drilled, machine).into_iter().filter(begins_above));
        }
    }
    cuts
}

impl Judgement<'_> {
    /// Reports the cuts of a through hole that are wider than a hole that follows it, and reach into that.
    pub(super) fn judge_next_holes(&mut self, drilled: &DrilledHole, machine: &Machine) {
        let tolerances = self.comparison.tolerances;
        for Follower { index, hole: next, .. } in &self.followers {
            let Some(outline) = Outline::of(next, tolerances.depth) else { continue };
            let excess = |cut: &Cut<'_>| {
                let shape = cut.shape().filter(|_| exceeds(cut.tip, tolerances.depth))?;
                Some(-2.0 * outline.margin(&shape)).filter(|excess| exceeds(*excess, tolerances.diameter))
            };
            let cuts = Cut::all(next, drilled, machine);
            let is_into = |cut: &Cut<'_>| 0.0 < cut.pass.axis.dot(&Vector3::from(next.axis));
            let wide = cuts.iter().filter(|cut| is_into(cut)).filter_map(|cut| Some((cut, excess(cut)?)));
            let Some((cut, excess)) = wide.max_by(|a, b| a.0.tip.total_cmp(&b.0.tip)) else { continue };
            let message = format!(
                "hole {}: {} goes on into hole {} and cuts {excess:.3} mm wider than that, {:.3} mm deep",
                self.id,
                cut.name(),
                self.comparison.id(*index),
                cut.tip
            );
            let finding =
                Diagnostic::new(&FEATURE_EXTRA, message).with_backtrace(cut.pass.backtrace.clone()).help(
                    "end the stroke before the next hole, or add the feature to that hole in the reference",
                );
            self.findings.push(finding);
        }
    }
}
