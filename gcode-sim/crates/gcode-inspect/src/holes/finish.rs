//! The end of a run: its holes and findings.
use std::collections::BTreeSet;

use super::rapid_paths::{OnPath, Search};
use super::strokes::MilledStrokes;
use super::{HoleExtraction, HoleExtractor, MAX_PASSES, group, unknown_axes};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::diag::Diagnostic;

impl HoleExtractor<'_> {
    /// Ends the run and returns its holes and findings.
    pub fn finish(mut self) -> HoleExtraction {
        let last_block = self.last_block.clone();
        self.report_low_rapid();
        self.end_in_metal();
        self.end_line(None);
        let unsearched = last_block.filter(|_| self.is_feed_unsearched.get());
        let feed = Search::Feed(OnPath::Straight);
        unsearched.into_iter().for_each(|block| self.unsearched.entry(feed).or_default().count(|| block));
        self.end_engagement();
        self.report_idle_mills();
        self.report_low_places();
        let (passes, milled, first_excess) = std::mem::take(&mut self.strokes).finish(self.machine);
        let mut holes = group::group_holes(&passes, self.machine, &self.process_limits.hole_axes);
        self.find_cores(&mut holes);
        self.find_surfaces(&mut holes);
        self.report_flank_cuts(&holes);
        let assumed_axes = self.positions.untouched_rotary_axes(self.machine);
        unknown_axes::keep_effective(&mut holes, self.machine, assumed_axes);
        self.report_unknown_positions(&holes);
        let covered_entries = self.covered_entries();
        let milled_strokes = milled.as_ref().map_or(0, MilledStrokes::count);
        let mut findings = self.findings.finish();
        findings.extend(milled.map(MilledStrokes::finding));
        findings.extend(first_excess.map(|backtrace| {
            let message =
                format!("more than {MAX_PASSES} feeds into the part: nothing after this is checked");
            let finding = Diagnostic::new(&LIMIT, message).with_backtrace(backtrace);
            finding.help("check for a loop that never ends; otherwise split the program")
        }));
        HoleExtraction {
            holes,
            findings,
            close_motions: self.close_motions.finish(),
            cut_conditions: self.cut_conditions.finish(),
            length_mismatches: self.length_mismatches,
            offset_tools: self.offset_tools,
            program_lengths: BTreeSet::new(),
            reset_lengths: Vec::new(),
            called_stubs: Vec::new(),
            unknown_rapids: self.positions.finish(self.machine),
            assumed_axes,
            process_limits: self.process_limits,
            is_metal_known: self.surface.is_some(),
            unsearched: self.unsearched,
            unjudged: self.unjudged,
            rapids_behind_change: self.change_retract.rapids,
            unsized_mills: self.milling.unsized_tools,
            assumed_cones: self.milling.cones,
            covered_entries,
            milled_strokes,
            has_unmilled_pockets: !self.metal.pockets.is_empty() && self.milled_blocks.is_empty(),
            milled_blocks: self.milled_blocks.finish(),
            feeds_in_air: self.feeds_in_air,
            back_bored: self.back_bored,
            cycles_in_air: self.cycles_in_air.finish(),
            strokes_in_air: self.strokes_in_air,
            air_strokes: self.air_strokes,
            is_removal_cut_short: self.metal.removed.is_full,
        }
    }
}
