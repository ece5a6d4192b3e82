//! Walls of milled holes: edges shorter than the hole is deep cut it in steps that meet.
use super::features::Judgement;
use super::tap_motion::MAX_STEP;
use super::*;
use crate::findings::FEATURE_DEPTH;
use crate::verify::hole_cuts::Cut;
use gcode_part::{Feature, FeatureKind};

impl<'c> Judgement<'c> {
    /// Reports a cylinder whose wall the edges of a mill leave in part uncut, above the deepest circle or between two.
    pub(super) fn judge_wall(&mut self, feature: &Feature) {
        if matches!(feature.kind, FeatureKind::Tap | FeatureKind::Countersink) {
            return;
        }
        let Some(([from, to], cut)) = self.uncut_wall(feature) else { return };
        let message = format!(
            "hole {}: the {} has no wall from {from:.3} to {to:.3} mm below the entry: there the edges of {} do not cut",
            self.id,
            feature.describe(),
            cut.name().trim_end_matches(',')
        );
        let finding = Diagnostic::new(&FEATURE_DEPTH, message).with_backtrace(cut.pass.backtrace.clone());
        self.findings.push(finding.help(
            "mill from the entry to the bottom in steps no higher than flute_length, or correct it in the machine file",
        ));
    }

    /// Returns the uppermost depths between which nothing cuts a cylinder to its width, and the mill of short edges below them.
    fn uncut_wall(&self, feature: &Feature) -> Option<([f64; 2], Cut<'c>)> {
        let limit = self.comparison.tolerances.diameter;
        let cuts = || self.near.iter().map(|cut| (cut, false)).chain(self.far.iter().map(|cut| (cut, true)));
        let mut walls = Vec::new();
        for (cut, is_far) in cuts().filter(|(cut, _)| !cut.is_thread()) {
            // A mill of unknown diameter may cut as wide.
            if exceeds(feature.diameter - cut.pass.diameter?, limit) {
                continue;
            }
            let [upper, lower] = cut.wall();
            let depth = self.nominal.depth;
            let span = if is_far { [depth - lower, depth - upper] } else { [upper, lower] };
            if span[0] < span[1] {
                walls.push((span, *cut));
            }
        }
        let is_short = |cut: &Cut<'_>| cut.pass.cut.milled.is_some_and(|circle| circle.wall.is_finite());
        let (_, mill) = *walls.iter().find(|(_, cut)| is_short(cut))?;
        walls.sort_by(|(one, _), (other, _)| one[0].total_cmp(&other[0]));
        let mut reached = self.top_of(feature);
        let bottom = feature.bottom().min(self.nominal.depth);
        for ([upper, lower], cut) in &walls {
            if MAX_STEP < upper.min(bottom) - reached {
                return Some(([reached, upper.min(bottom)], if is_short(cut) { *cut } else { mill }));
            }
            reached = reached.max(*lower);
        }
        None
    }

    /// Returns the depth at which a cylinder begins, below wider features.
    fn top_of(&self, feature: &Feature) -> f64 {
        let wider = self.nominal.features.iter().filter(|other| feature.diameter < other.diameter);
        let bottoms = wider.map(|other| match (other.kind, other.angle) {
            (FeatureKind::Tap, _) => 0.0,
            (FeatureKind::Countersink, Some(angle)) => {
                (other.diameter - feature.diameter) / 2.0 / Deg(angle / 2.0).tan()
            }
            _ => other.bottom(),
        });
        bottoms.fold(0.0, f64::max)
    }
}
