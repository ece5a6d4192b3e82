//! Cuts of a through hole that go on into the next hole on its axis, as in the ears of a clevis.
use super::features::Judgement;
use super::*;
use crate::findings::FEATURE_EXTRA;
use crate::holes::DrilledHole;
use crate::machine::Machine;
use crate::verify::hole_cuts::Cut;
use crate::verify::outline::Outline;

impl Judgement<'_> {
    /// Reports the cuts of a through hole that are wider than a hole that follows it, and reach into that.
    pub(super) fn judge_next_holes(&mut self, drilled: &DrilledHole, machine: &Machine) {
        if !self.nominal.through {
            return;
        }
        let tolerances = self.comparison.tolerances;
        for (index, next, _) in self.comparison.followers(self.nominal) {
            let Some(outline) = Outline::of(&next, tolerances.depth) else { continue };
            let excess = |cut: &Cut<'_>| {
                let shape = cut.shape().filter(|_| exceeds(cut.tip, tolerances.depth))?;
                Some(-2.0 * outline.margin(&shape)).filter(|excess| exceeds(*excess, tolerances.diameter))
            };
            let cuts = Cut::all(&next, drilled, machine);
            let is_into = |cut: &Cut<'_>| 0.0 < cut.pass.axis.dot(&Vector3::from(next.axis));
            let wide = cuts.iter().filter(|cut| is_into(cut)).filter_map(|cut| Some((cut, excess(cut)?)));
            let Some((cut, excess)) = wide.max_by(|a, b| a.0.tip.total_cmp(&b.0.tip)) else { continue };
            let message = format!(
                "hole {}: {} goes on into hole {} and cuts {excess:.3} mm wider than that, {:.3} mm deep",
                self.id,
                cut.name(),
                self.comparison.id(index),
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
