//! Straight motions along the current line: it continues, or ends.
use std::mem::replace;

use nalgebra::Point3;

use super::cut_states::StateCut;
use super::cutting::CuttingState;
use super::line::{CuttingLine, ToolExit};
use super::{HoleExtractor, MotionKind};
use crate::machine::{TOUCH_DEPTH, ToolKind};
use gcode_lang::motion::{Event, EventKind, SpindleDirection};

/// Feed a revolution, as a share of the diameter, from which on a tool may enter a hole that is cut.
const ENTRY_FEED_SHARE: f64 = 0.05;

impl HoleExtractor<'_> {
    /// Follows a straight motion from `from` along the current line. Returns the point from which the tool moved freely;
    /// `None` if it stays on the line.
    pub(super) fn update_line(
        &mut self,
        event: &Event<'_>,
        kind: MotionKind,
        from: Point3<f64>,
    ) -> Option<Point3<f64>> {
        let Some(mut line) = self.current_line.take() else { return Some(from) };
        let tip = self.pose.tip;
        self.bar_shift.has_drilled |= line.enters_solid && self.surface.is_some();
        if kind == MotionKind::Rapid && line.is_overrun(&tip) && !self.is_gap_ahead(&line, &from) {
            if line.is_bar_shifted() {
                self.report_back_boring(&line);
            } else {
                self.check_lift(&line);
                self.note_cycle_in_air(&line);
                self.report_overrun(event, &line, &tip);
            }
            return Some(from);
        }
        let may_be_shifted = kind == MotionKind::Rapid && self.may_be_shifted();
        if may_be_shifted && line.is_inward() && line.try_bar_shift(&tip, self.tool_radius()) {
            if self.machine.kind_of(self.setup.tool).is_none() {
                self.unjudged.shifts_of_unknown_kind.count(|| event.backtrace());
            }
            if !self.bar_shift.is_oriented {
                self.unjudged.shifts_without_angle.count(|| event.backtrace());
            }
            self.current_line = Some(line);
            return None;
        }
        match line.exit_after(&from, &tip) {
            ToolExit::OnLine => {
                // Beyond the start of the feed the tool moves freely.
                let (before, after) = (line.depth_of(&from), line.depth_of(&tip));
                let is_beyond = kind == MotionKind::Rapid && after < 0.0 && after < before;
                let mut free_from = is_beyond.then_some(if before > 0.0 { line.start } else { from });
                // In a pocket there is no thread.
                if after < before && !self.metal.is_point_in_pocket(&from) {
                    let feed = match event.kind {
                        EventKind::Feed { rate, .. } => Some((*rate, self.cutting_state.speed)),
                        _ => None,
                    };
                    line.record_retract(&from, feed, self.cutting_state.spindle_direction);
                }
                let again = match kind {
                    MotionKind::Feed => {
                        if line.depth_of(&from) < line.depth_of(&tip) && !line.is_above_cut(&tip) {
                            self.record_line_feed(event, &mut line, &from);
                            self.record_start_inside(&mut line);
                        }
                        line.feed_to(&tip, event.backtrace(), &self.axis_position)
                    }
                    MotionKind::Rapid | MotionKind::Probe => {
                        line.is_cycle |= event.block == line.first_block;
                        let is_deeper = line.is_beyond_cut(&tip);
                        // Through a hole that is finished, or a gap behind it, the tool moves freely, as far as its body fits.
                        let is_free = is_deeper
                            && (self.metal.cuts(&from, &tip) == Some(false)
                                || self.is_gap_ahead(&line, &from));
                        let again = line.rapid_to(&tip, !is_free);
                        if is_free {
                            free_from = Some(from).filter(|_| kind == MotionKind::Rapid);
                        } else if is_deeper {
                            self.report_rapid_beyond_cut(event, &line);
                        }
                        again
                    }
                };
                if let Some(pass) = again.filter(|_| !self.is_milled(&line)) {
                    let next = self.strokes.begin_pass();
                    // An earlier stroke of a tap comes before the last one, a repeated pass after the line.
                    let order = if pass.cut.is_tapping { replace(&mut line.order, next) } else { next };
                    self.strokes.push(order, *pass, self.cut_kind(&line, false));
                }
                self.current_line = Some(line);
                free_from
            }
            exit @ (ToolExit::AlongLine | ToolExit::Sideways { .. }) => {
                let is_along = exit == ToolExit::AlongLine;
                if may_be_shifted && !line.is_inward() && !is_along {
                    self.bar_shift.is_back_bored = true;
                    self.report_back_boring(&line);
                    return Some(from);
                }
                let free_from = if is_along { line.start_level_crossing(&from, &tip) } else { from };
                self.report_line(line, exit, Some(kind));
                Some(free_from)
            }
        }
    }

    /// Returns true if the tool moves on in a gap between walls, behind a through hole that it has drilled: it meets no metal there.
    fn is_gap_ahead(&self, line: &CuttingLine, from: &Point3<f64>) -> bool {
        let Some(axis) = line.tool_axis.filter(|_| line.is_inward() && !line.is_bar_shifted()) else {
            return false;
        };
        let is_open = self.metal.holes.is_some() && self.metal.cuts(from, &self.pose.tip) != Some(true);
        is_open
            && line.cuts.last_feed().is_some()
            && self.metal.is_below_hole(from, &axis, |hole| hole.is_through)
    }

    /// Records rate and modal state of a feed inwards from `from` if it cuts; the approach may be faster.
    pub(super) fn record_line_feed(&self, event: &Event<'_>, line: &mut CuttingLine, from: &Point3<f64>) {
        let EventKind::Feed { rate, .. } = event.kind else { return };
        let tip = self.pose.tip;
        let is_in_air = match (&self.surface, &self.metal.holes) {
            // A feed through the part ends in the air.
            (Some(surface), _) => {
                !surface.is_deeper(&tip, TOUCH_DEPTH)
                    && surface.depth(&surface.deepest_between(from, &tip)) <= TOUCH_DEPTH
            }
            (None, Some(holes)) => holes.is_above_all(&tip, &tip),
            (None, None) => false,
        };
        // A tool may enter a hole that is cut with the spindle stopped or turning backwards.
        // One of unknown diameter may be a tap of the other hand.
        let may_turn_idle = match self.cutting_state.spindle_direction {
            SpindleDirection::Clockwise => false,
            SpindleDirection::Counterclockwise => self.machine.diameter_of(self.setup.tool).is_some(),
            SpindleDirection::Off => true,
        };
        // A gun drill enters its pilot hole slowly turning.
        let is_steep = || {
            let diameter = self.machine.diameter_of(self.setup.tool);
            diameter.is_some_and(|own| ENTRY_FEED_SHARE * own * self.cutting_state.speed.0 < rate.0)
        };
        let axis = line.tool_axis.unwrap_or(line.out);
        let cuts_nothing =
            || !self.is_finishing(&[*from, tip], &axis) && self.cuts_known_metal(from, &tip) == Some(false);
        if is_in_air || may_turn_idle && cuts_nothing() {
            return;
        }
        if !line.enters_solid && self.machine.kind_of(self.setup.tool).is_none_or(ToolKind::needs_hole) {
            line.enters_solid = self.metal.cuts(from, &tip) == Some(true);
        }
        let state = self.tool_state();
        let is_entry = (is_steep() || self.is_entry_told(&state)) && cuts_nothing();
        let origin = self.offset_origin.as_ref();
        let first = || StateCut::new(state, *rate, !is_entry, event.backtrace(), origin);
        line.record_feed(*rate, state, !is_entry, first);
    }

    /// Returns true if the feed of a tool that cuts nothing yet is judged otherwise than one that cuts: its pitch, or a speed that the
    /// job specifies.
    fn is_entry_told(&self, state: &CuttingState) -> bool {
        let is_sized_tap = self.machine.kind_of(state.tool) == Some(ToolKind::Tap)
            && self.machine.diameter_of(state.tool).is_some();
        let specified = self.process_limits.tool_process(state.tool).and_then(|tool| tool.speed);
        is_sized_tap || specified.is_some_and(|speed| speed != state.speed.0)
    }
}
