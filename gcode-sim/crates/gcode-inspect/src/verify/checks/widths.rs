//! Widths of the cuts of a hole: none is wider than the hole, but for the broken edge and the entry chamfer of a thread.
use super::features::{Judgement, ShapeGap};
use super::*;
use crate::findings::FEATURE_EXTRA;
use crate::machine::{PointShape, ToolKind};
use crate::verify::hole_cuts::Cut;
use crate::verify::outline::{CutShape, Outline};
use gcode_part::{FeatureKind, MAX_EDGE_BREAK};

/// Largest diameter of the chamfer at the entry of a thread, in diameters of the thread (DIN 76-1).
const CHAMFER_OF_THREAD: f64 = 1.05;

impl Judgement<'_> {
    /// Judges the cuts from the far side of a through hole: there it has the diameter that goes through.
    pub(super) fn judge_far_widths(&mut self, drilled: &DrilledHole) {
        if !self.far.is_empty() {
            let outline = Outline::of_far_side(self.nominal);
            self.judge_widths(&self.far.clone(), outline.as_ref(), drilled);
        }
    }

    /// Reports the cuts that are wider than the hole, without those of the finishing tool, which the check on the diameter
    /// covers.
    pub(super) fn judge_widths(
        &mut self,
        cuts: &[Cut<'_>],
        outline: Option<&Outline>,
        drilled: &DrilledHole,
    ) {
        let mut deepest = f64::NEG_INFINITY;
        for cut in cuts {
            let own = cut.pass;
            let is_finishing = (own.tool, own.diameter) == (drilled.tool, drilled.diameter);
            if own.tool.is_none() || !is_finishing || !self.nominal.features.is_empty() {
                self.judge_width(cut, outline, deepest);
            }
            deepest = deepest.max(cut.tip);
        }
    }

    /// Reports a cut that is wider than the hole; `before` is the deepest tip before it.
    pub(super) fn judge_width(&mut self, cut: &Cut<'_>, outline: Option<&Outline>, before: f64) {
        let tolerances = self.comparison.tolerances;
        let (Some(shape), Some(outline)) = (cut.shape(), outline) else { return };
        let excess = -2.0 * outline.margin(&shape);
        let is_cone = matches!(cut.point, PointShape::Pointed(_)) && !exceeds(shape.full_depth(), 0.0);
        let allowed = if is_cone { self.entry_chamfer() } else { 0.0 };
        if !exceeds(excess, allowed + tolerances.diameter) {
            return;
        }
        // Without its angle a tool of unknown kind counts as a spot drill.
        let point =
            if cut.kind == Some(ToolKind::Drill) { PointShape::DRILL } else { PointShape::SPOT_DRILL };
        let as_spot = -2.0 * outline.margin(&CutShape { point, ..shape });
        let is_first = before <= cut.tip;
        if cut.point == PointShape::Unknown && is_first && !exceeds(as_spot, tolerances.diameter) {
            self.gaps.push(ShapeGap::SpotDrill(cut.pass.tool));
            return;
        }
        let message = format!(
            "hole {}: {} cuts {excess:.3} mm wider than the hole, {:.3} mm deep",
            self.id,
            cut.name(),
            cut.tip
        );
        let finding = Diagnostic::new(&FEATURE_EXTRA, message).with_backtrace(cut.pass.backtrace.clone());
        let is_edge_break = is_cone && !exceeds(excess, self.max_edge_break());
        let severity = if is_edge_break { Severity::Warning } else { Severity::Error };
        let finding = cut.mill_note().into_iter().fold(finding, Diagnostic::note);
        let finding = match cut.point {
            PointShape::Unknown => {
                finding.note("the machine file gives neither its kind nor its point_angle: it counts as flat")
            }
            PointShape::Flat | PointShape::Pointed(_) => finding,
        };
        let finding = finding.with_severity(severity);
        let help = match is_edge_break {
            true => "make the cone less deep, or give the hole its countersink in a list of the holes",
            false => "remove the pass, or add its feature to the hole in the reference",
        };
        self.findings.push(finding.help(help));
    }

    /// Returns how much wider than the hole the entry chamfer of its thread may be, mm in diameter: 0 without a thread, and
    /// where the reference has a countersink of its own.
    fn entry_chamfer(&self) -> f64 {
        let of_kind = |kind| self.nominal.features.iter().filter(move |feature| feature.kind == kind);
        if of_kind(FeatureKind::Countersink).next().is_some() {
            return 0.0;
        }
        let widest = self.nominal.features.iter().map(|feature| feature.diameter).fold(0.0, f64::max);
        let threads = of_kind(FeatureKind::Tap).map(|thread| CHAMFER_OF_THREAD * thread.diameter - widest);
        threads.fold(0.0, f64::max)
    }

    /// Returns the width by which a cone may break the edge of the hole, mm in diameter: that of a countersink is its
    /// tolerance.
    fn max_edge_break(&self) -> f64 {
        let cones = self.nominal.features.iter().filter(|feature| feature.kind == FeatureKind::Countersink);
        let slack = self.comparison.tolerances.depth;
        let widths = cones.filter_map(|cone| Some(2.0 * slack * Deg(cone.angle? / 2.0).tan()));
        widths.fold(2.0 * MAX_EDGE_BREAK, f64::min)
    }
}
