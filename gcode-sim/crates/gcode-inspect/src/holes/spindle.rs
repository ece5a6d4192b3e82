//! What the spindle does while a tool is in the part: it stands, of a drill and of a grinder's wheel alike; it is stopped or
//! reversed in the hole, as the cycles do that bore and tap.
use super::HoleExtractor;
use super::line::{CuttingLine, SpindleInHole};
use crate::findings::{SPINDLE_IN_HOLE, SPINDLE_STOPPED};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, SpindleDirection};

/// The finding: nothing is cut so. It is a warning where an M code went to the machine builder's logic before, `builder`,
/// for that may be what starts the spindle.
pub(crate) fn spindle_stopped_finding(message: &str, builder: Option<u32>) -> Diagnostic {
    let severity = if builder.is_some() { Severity::Warning } else { Severity::Error };
    let finding = Diagnostic::new(&SPINDLE_STOPPED, message).with_severity(severity);
    builder.into_iter().fold(finding, |finding, code| {
        finding.note(format!(
            "M{code:02} is left to the machine builder's logic, which may have started it: this is not simulated"
        ))
    })
}

impl HoleExtractor<'_> {
    /// The spindle is switched, having turned so `before`.
    pub(super) fn update_spindle_in_hole(&mut self, before: SpindleDirection) {
        let now = self.cutting_state.spindle_direction;
        let Some(line) = self.current_line.as_mut().filter(|line| line.is_below_start()) else { return };
        let begun = line.cutting_state.spindle_direction;
        let state = match now {
            _ if begun == SpindleDirection::Off || now == before => SpindleInHole::Unchanged,
            SpindleDirection::Off => SpindleInHole::Stopped,
            now if now != begun => SpindleInHole::Reversed,
            _ => SpindleInHole::Unchanged,
        };
        line.spindle = line.spindle.max(state);
    }

    /// A tool that the job has to drill with: a cycle that taps or bores isn't meant for it.
    pub(super) fn check_spindle(&mut self, place: &Backtrace, line: &CuttingLine) {
        if self.process_limits.tool_process(line.cutting_state.tool).is_none() {
            return;
        }
        let name = || line.cutting_state.tool.map_or("the tool".to_owned(), |number| format!("T{number}"));
        let finding = match line.spindle {
            SpindleInHole::Unchanged => return,
            SpindleInHole::Stopped => {
                let message = format!("the spindle stops while {} is in the hole", name());
                Diagnostic::new(&SPINDLE_IN_HOLE, message).with_severity(Severity::Warning).note(
                    "G76, G86 and G88 stop the spindle for a boring bar; a stopped drill rubs in its hole, or breaks when \
                     it is moved sideways",
                )
            }
            SpindleInHole::Reversed => {
                let message = format!("the spindle reverses while {} is in the hole", name());
                Diagnostic::new(&SPINDLE_IN_HOLE, message)
                    .note("G84 and G74 reverse the spindle for a tap; the job specifies a drilled hole")
            }
        };
        self.findings.add(&SPINDLE_IN_HOLE, place, 0, |_| finding.help("drill with G81, G82, G83 or G73"));
    }
}
