//! Threads of nominal holes that a tool cuts away: only a tap, and a mill along its helix, may enter them, and no rapid.
use nalgebra::Point3;

use super::HoleExtractor;
use super::rapids::format_point;
use crate::findings::{FEED_BESIDE_HOLE, RAPID_INTO_PART};
use crate::machine::{ToolKind, tool_name};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Event;
use gcode_part::exceeds;

/// Largest depth of a cut in the flanks of a thread, mm.
const MAX_FLANK_CUT: f64 = 0.05;

/// Least distance of a tool that stands beside the axis of a hole, mm.
const MIN_ASIDE: f64 = 0.1;

/// Largest sine of the angle between the tool and a motion along it.
const MAX_AXIAL_SINE: f64 = 0.1;

impl HoleExtractor<'_> {
    /// Reports a straight motion along the tool, at the side of a threaded hole, that cuts more than a turn of the thread.
    pub(super) fn check_thread_wall(&mut self, event: &Event<'_>, from: &Point3<f64>) {
        if !self.strokes.nominal_axes().has_threads() {
            return;
        }
        let to = self.pose.tip;
        let (Some(axis), Some(diameter)) = (self.pose.axis, self.machine.diameter_of(self.setup.tool)) else {
            return;
        };
        let travel = to - from;
        let is_along = axis.cross(&travel).norm() <= MAX_AXIAL_SINE * travel.norm();
        let is_tap = self.machine.kind_of(self.setup.tool) == Some(ToolKind::Tap);
        if !is_along || is_tap || self.cutting_state.rigid_run != 0 {
            return;
        }
        let ends = if travel.dot(&axis) < 0.0 { [from, &to] } else { [&to, from] };
        let Some((hole, thread, aside)) = self.strokes.nominal_axes().threaded(ends, &axis) else { return };
        let depths = ends.map(|end| (hole.entry - end).dot(&hole.out));
        let bottom = depths[1].min(thread.span[1]);
        let length = bottom - depths[0].max(thread.span[0]);
        let reach = aside + diameter / 2.0;
        if aside < MIN_ASIDE
            || !exceeds(reach - thread.core, MAX_FLANK_CUT)
            || exceeds(reach - thread.major, MAX_FLANK_CUT)
            || length <= thread.pitch.max(MAX_FLANK_CUT)
        {
            return;
        }
        let (place, core) = (hole.entry - hole.out * bottom, 2.0 * thread.core);
        let tool = tool_name(self.setup.tool);
        self.findings.add(&FEED_BESIDE_HOLE, &event.backtrace(), 2, |finding| {
            let message = format!(
                "{tool} goes along the axis {aside:.3} mm beside it and cuts {:.3} mm deep into the thread, {length:.3} mm \
                 long, down to {}: the hole before the thread is Φ{core:.3}",
                reach - core / 2.0,
                format_point(&place),
            );
            Diagnostic::new(finding, message)
                .help("lead the mill to the axis of the hole before it goes down or up")
        });
    }

    /// Reports a rapid away from the axis of a threaded hole whose edge enters the flanks.
    pub(super) fn check_rapid_into_thread(&mut self, event: &Event<'_>, from: &Point3<f64>) {
        if !self.strokes.nominal_axes().has_threads() {
            return;
        }
        let to = self.pose.tip;
        let (Some(axis), Some(diameter)) = (self.pose.axis, self.machine.diameter_of(self.setup.tool)) else {
            return;
        };
        let Some((hole, thread, aside)) = self.strokes.nominal_axes().threaded([&to, &to], &axis) else {
            return;
        };
        let spoke = from - hole.entry;
        let before = (spoke - hole.out * spoke.dot(&hole.out)).norm();
        let depth = (hole.entry - to).dot(&hole.out).min(thread.span[1]);
        let reach = aside + diameter / 2.0;
        if !exceeds(aside - before, MAX_FLANK_CUT)
            || !exceeds(reach - thread.core, MAX_FLANK_CUT)
            || exceeds(reach - thread.major, MAX_FLANK_CUT)
            || !exceeds(depth - thread.span[0], MAX_FLANK_CUT)
        {
            return;
        }
        let (tool, core) = (tool_name(self.setup.tool), 2.0 * thread.core);
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |finding| {
            let message = format!(
                "{tool} enters the thread {:.3} mm deep in a rapid, at {}: the hole before the thread is Φ{core:.3}",
                reach - core / 2.0,
                format_point(&to),
            );
            Diagnostic::new(finding, message).help("only a feed along the helix may enter the thread")
        });
    }
}
