//! Clamp of the rotary table: it holds the table while a tool drills, and is released while the table rotates.
use super::HoleExtractor;
use crate::findings::{DRILLS_UNCLAMPED, TURNS_CLAMPED};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};
use gcode_lang::motion::{AxisIndex, Backtrace, Event, Position};
use gcode_part::job::Clamp;

/// State of the clamp, as commanded by the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ClampState {
    /// Not commanded yet: the state at the start is unknown.
    #[default]
    Unknown,
    Clamped,
    Released,
}

impl HoleExtractor<'_> {
    /// Applies an M code of the clamp; returns false for other codes.
    pub(super) fn apply_clamp_code(&mut self, code: u32) -> bool {
        let Some(clamp) = self.process_limits.clamp else { return false };
        match code {
            code if code == clamp.on => self.cutting_state.clamp = ClampState::Clamped,
            code if code == clamp.off => self.cutting_state.clamp = ClampState::Released,
            _ => return false,
        }
        true
    }

    /// Reports a rotation of the clamped axis, unless the clamp is released.
    pub(super) fn check_clamp_released(&mut self, event: &Event<'_>, from: &Position, to: &Position) {
        let Some(Clamp { on, off }) = self.process_limits.clamp else { return };
        let Some(axis) = self.clamped_axis().filter(|axis| from[*axis] != to[*axis]) else { return };
        let letter = self.machine.axes.letter(axis);
        let message = match self.cutting_state.clamp {
            ClampState::Released => return,
            ClampState::Clamped => format!("{letter} rotates while clamped by M{on:02}"),
            ClampState::Unknown => format!("{letter} rotates before any M{off:02} releases it"),
        };
        let note = "the control raises an alarm, or the drive works against the clamp";
        let help = format!("command M{off:02} before {letter} rotates");
        self.report_clamp(&TURNS_CLAMPED, &event.backtrace(), self.cutting_state.clamp, message, note, help);
        if self.cutting_state.clamp == ClampState::Unknown {
            // The rotation shows that the axis was released.
            self.cutting_state.clamp = ClampState::Released;
        }
    }

    /// Reports a feed into the part in this state, unless the clamp held the table.
    pub(super) fn check_clamped(&mut self, backtrace: &Backtrace, state: ClampState) {
        let Some(Clamp { on, .. }) = self.process_limits.clamp else { return };
        let Some(axis) = self.clamped_axis() else { return };
        let letter = self.machine.axes.letter(axis);
        let (message, help) = match state {
            ClampState::Clamped => return,
            ClampState::Released => (
                format!("the tool feeds into the part with {letter} unclamped"),
                format!("command M{on:02} after {letter} has rotated"),
            ),
            ClampState::Unknown => (
                format!("the tool feeds into the part before any M{on:02} clamps {letter}"),
                format!("command M{on:02} before the feed"),
            ),
        };
        let note = "the part gives way under the drill, which moves the hole";
        self.report_clamp(&DRILLS_UNCLAMPED, backtrace, state, message, note, help);
    }

    /// Adds an error with `note`, or a warning if the state is unknown.
    fn report_clamp(
        &mut self,
        kind: &'static FindingKind,
        backtrace: &Backtrace,
        state: ClampState,
        message: String,
        note: &str,
        help: String,
    ) {
        let (detail, severity, note) = match state {
            ClampState::Unknown => {
                (1, Severity::Warning, "the state of the clamp at the start of the program is unknown")
            }
            ClampState::Clamped | ClampState::Released => (0, Severity::Error, note),
        };
        self.findings.add(kind, backtrace, detail, |kind| {
            Diagnostic::new(kind, message).with_severity(severity).note(note).help(help)
        });
    }

    /// Returns the axis that the clamp holds: the reference's rotary axis if it carries the part, else the first that
    /// rotates the part.
    fn clamped_axis(&self) -> Option<AxisIndex> {
        let named = self.process_limits.rotary.and_then(|rotary| self.machine.axes.find(rotary.letter as u8));
        let mut rotary_axes = self.machine.table.rotary_axes();
        named
            .filter(|axis| self.machine.table.rotary_axes().any(|other| other == *axis))
            .or_else(|| rotary_axes.next())
    }
}
