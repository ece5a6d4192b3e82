//! Spindle while a tool is in the part: stopped before the feed, or stopped or reversed in the hole, as boring and tapping
//! cycles do.
use super::HoleExtractor;
use super::cutting::CuttingState;
use super::line::{CuttingLine, SpindleInHole};
use crate::findings::{SPINDLE_IN_HOLE, SPINDLE_STOPPED};
use crate::machine::{TOUCH_DEPTH, ToolKind, tool_name};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, SpindleDirection};

/// Returns the finding for a stopped tool or wheel: a warning if an M code of the machine builder, which may start the
/// spindle, comes before.
pub(crate) fn spindle_stopped_finding(message: &str, builder_code: Option<u32>) -> Diagnostic {
    let finding = Diagnostic::new(&SPINDLE_STOPPED, message);
    let Some(code) = builder_code else { return finding };
    finding.with_severity(Severity::Warning).note(format!(
        "M{code:02} is left to the machine builder's logic, which may have started it: this is not simulated"
    ))
}

impl HoleExtractor<'_> {
    /// Records a change of the spindle's direction from `before` while the tool is in a hole.
    pub(super) fn update_spindle_in_hole(&mut self, before: SpindleDirection) {
        let now = self.cutting_state.spindle_direction;
        let Some(line) = self.current_line.as_mut().filter(|line| line.is_below_start()) else { return };
        let begun = match line.cuts.extremes() {
            Some(_) => line.cutting_state.spindle_direction,
            // Nothing is cut so far.
            None => SpindleDirection::Off,
        };
        let is_drawn_back = line.depth_of(&self.pose.tip) + TOUCH_DEPTH < line.cut_depth();
        let state = match now {
            _ if begun == SpindleDirection::Off || now == before => SpindleInHole::Unchanged,
            SpindleDirection::Off => SpindleInHole::Stopped,
            now if now != begun => SpindleInHole::Reversed,
            // A cycle that taps starts it where it has stopped it, at the bottom.
            _ if is_drawn_back => SpindleInHole::Stopped,
            _ => SpindleInHole::Restarted,
        };
        line.is_tapping |= state == SpindleInHole::Reversed;
        line.spindle = line.spindle.max(state);
    }

    /// Reports a feed into the part with the spindle stopped, in the state of that feed.
    pub(super) fn report_spindle_stopped(&mut self, place: &Backtrace, state: &CuttingState) {
        let builder_code = state.builder_code;
        self.findings.add(&SPINDLE_STOPPED, place, 0, |_| {
            spindle_stopped_finding("the tool feeds into the part with the spindle stopped", builder_code)
                .help("start the spindle with M03 S… before the feed")
        });
    }

    /// Reports a spindle that stops or reverses in the hole, for a tool with which the job drills, or one whose kind the machine
    /// file states: only a tap reverses, and a stop is a boring bar's.
    pub(super) fn check_spindle(&mut self, backtrace: &Backtrace, line: &CuttingLine) {
        let number = line.cutting_state.tool;
        let kind = self.machine.kind_of(number);
        let is_bar = matches!(kind, Some(ToolKind::BoringBar)) && line.spindle != SpindleInHole::Reversed;
        let needs_spindle = kind.is_some_and(|kind| kind != ToolKind::Tap) && !is_bar;
        let is_tap = kind == Some(ToolKind::Tap);
        if is_tap || (!needs_spindle && self.process_limits.tool_process(number).is_none()) {
            return;
        }
        let (verb, severity, note) = match line.spindle {
            SpindleInHole::Unchanged => return,
            SpindleInHole::Stopped => (
                "stops",
                Severity::Warning,
                "G76, G86 and G88 stop the spindle for a boring bar; another tool that stops rubs in its hole, or breaks \
                 when it is moved sideways",
            ),
            SpindleInHole::Restarted => (
                "stops and starts again",
                Severity::Error,
                "G84 stops the spindle that M04 turns, and G74 the one that M03 turns: this tool is no tap",
            ),
            SpindleInHole::Reversed => {
                ("reverses", Severity::Error, "G84 and G74 reverse the spindle for a tap: this tool is none")
            }
        };
        let tool = tool_name(number);
        self.findings.add(&SPINDLE_IN_HOLE, backtrace, line.spindle as u32, |finding| {
            Diagnostic::new(finding, format!("the spindle {verb} while {tool} is in the hole"))
                .with_severity(severity)
                .note(note)
                .help(cycles_of(kind))
        });
    }
}

/// Returns the remedy for a spindle that changes while a tool of a kind is in the hole: the cycles in which it turns on.
fn cycles_of(kind: Option<ToolKind>) -> &'static str {
    match kind {
        Some(ToolKind::Reamer) => "ream with G85 or G81",
        Some(ToolKind::BoringBar) => "bore with G76, G85 or G86",
        Some(ToolKind::Counterbore | ToolKind::Countersink | ToolKind::EndMill) => {
            "sink with G82 or G81, or in single blocks"
        }
        Some(ToolKind::Drill | ToolKind::SpotDrill | ToolKind::Tap | ToolKind::Probe) | None => {
            "drill with G81, G82, G83 or G73"
        }
    }
}
