//! Through holes on one axis, as in the ears of a clevis: strokes through several of them, and into the next one.
use super::features::Judgement;
use super::*;
use crate::findings::{FEATURE_EXTRA, HOLE_TWICE};
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
        let other = comparison.pair_of(next.index).filter(|other| other.actual != pair.actual);
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
    /// Reports a tool that goes through this hole and on through one that follows, after it has drilled that by a stroke of its own.
    fn drilled_again(
        &self,
        index: usize,
        next: &Hole,
        drilled: &DrilledHole,
        machine: &Machine,
    ) -> Option<Diagnostic> {
        let other = &self.comparison.actual[self.comparison.pair_of(index)?.actual];
        let strokes = |drilled| {
            let cuts = Cut::all(next, drilled, machine).into_iter();
            let is_whole = |cut: &Cut<'_>| !exceeds(next.depth, cut.full_depth(0.0).unwrap_or(cut.tip));
            cuts.filter(move |cut| !cut.is_circle() && !cut.is_thread() && is_whole(cut)).collect::<Vec<_>>()
        };
        if std::ptr::eq(drilled, other) {
            return None;
        }
        let (through, own) = (strokes(drilled), strokes(other));
        let is_again = |cut: &&Cut<'_>| own.iter().any(|own| cut.follows(own) && cut.is_same_size(&own.pass));
        let cut = through.iter().find(is_again)?;
        let message = format!(
            "hole {} is drilled a second time: {} goes through it again behind hole {}",
            self.comparison.id(index),
            cut.name(),
            self.id
        );
        let finding = Diagnostic::new(&HOLE_TWICE, message).with_severity(Severity::Warning);
        let finding = finding.with_backtrace(cut.pass.backtrace.clone());
        Some(
            finding.help("end the stroke before the next hole, or remove the call or block that drills that"),
        )
    }

    /// Reports the cuts of a through hole that are wider than a hole that follows it, and reach into that.
    pub(super) fn judge_next_holes(&mut self, drilled: &DrilledHole, machine: &Machine) {
        let tolerances = self.comparison.tolerances;
        for Follower { index, hole: next, .. } in &self.followers {
            let again = self.drilled_again(*index, next, drilled, machine);
            self.findings.extend(again);
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
