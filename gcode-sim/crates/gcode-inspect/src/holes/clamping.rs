//! The clamp of the rotary table: while it holds, the table must not turn, and while it doesn't, nothing may be drilled.
use super::HoleExtractor;
use crate::findings::{DRILLS_UNCLAMPED, TURNS_CLAMPED};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{AxisIndex, Backtrace, Event, Position};
use gcode_part::job::Clamp;

/// What the program has done about the clamp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ClampState {
    /// Nothing yet: what was done before the program, nobody knows.
    #[default]
    Unknown,
    Clamped,
    Released,
}

impl HoleExtractor<'_> {
    /// A code of the clamp, if it is one.
    pub(super) fn apply_clamp_code(&mut self, code: u32) -> bool {
        let Some(clamp) = self.process_limits.clamp else { return false };
        match code {
            code if code == clamp.on => self.clamp_state = ClampState::Clamped,
            code if code == clamp.off => self.clamp_state = ClampState::Released,
            _ => return false,
        }
        true
    }

    /// Whether the rotary may turn.
    pub(super) fn check_clamp_released(&mut self, event: &Event<'_>, from: &Position, to: &Position) {
        let Some(clamp) = self.process_limits.clamp else { return };
        let Some(axis) = self.clamped_axis().filter(|axis| from[*axis] != to[*axis]) else { return };
        let letter = self.machine.axes.letter(axis);
        let Clamp { on, off } = clamp;
        match self.clamp_state {
            ClampState::Released => {}
            ClampState::Clamped => self.findings.add(&TURNS_CLAMPED, &event.backtrace(), 0, |kind| {
                Diagnostic::new(kind, format!("{letter} rotates while clamped by M{on:02}"))
                    .note("the control raises an alarm, or the drive works against the clamp")
                    .help(format!("command M{off:02} before {letter} rotates"))
            }),
            ClampState::Unknown => {
                self.findings.add(&TURNS_CLAMPED, &event.backtrace(), 1, |kind| {
                    Diagnostic::new(kind, format!("{letter} rotates before any M{off:02} releases it"))
                        .with_severity(Severity::Warning)
                        .note("the state of the clamp at the start of the program is unknown")
                        .help(format!("command M{off:02} before {letter} rotates"))
                });
                // It turned: so it was free, and nothing holds it now.
                self.clamp_state = ClampState::Released;
            }
        }
    }

    /// Whether what is drilled was held when the feed began.
    pub(super) fn check_clamped(&mut self, place: &Backtrace, clamp_state: ClampState) {
        let Some(Clamp { on, .. }) = self.process_limits.clamp else { return };
        let Some(axis) = self.clamped_axis() else { return };
        let letter = self.machine.axes.letter(axis);
        match clamp_state {
            ClampState::Clamped => {}
            ClampState::Released => self.findings.add(&DRILLS_UNCLAMPED, place, 0, |kind| {
                let message = format!("the tool feeds into the part with {letter} unclamped");
                Diagnostic::new(kind, message)
                    .note("the part gives way under the drill, which moves the hole")
                    .help(format!("command M{on:02} after {letter} has rotated"))
            }),
            ClampState::Unknown => self.findings.add(&DRILLS_UNCLAMPED, place, 1, |kind| {
                let message = format!("the tool feeds into the part before any M{on:02} clamps {letter}");
                Diagnostic::new(kind, message)
                    .with_severity(Severity::Warning)
                    .note("the state of the clamp at the start of the program is unknown")
                    .help(format!("command M{on:02} before the feed"))
            }),
        }
    }

    /// The axis that the clamp holds: the reference's rotary, where it carries the part, else the first that turns it.
    fn clamped_axis(&self) -> Option<AxisIndex> {
        let named = self.process_limits.rotary.and_then(|rotary| self.machine.axes.find(rotary.letter as u8));
        let mut turning = self.machine.table.rotary_axes();
        named
            .filter(|axis| self.machine.table.rotary_axes().any(|other| other == *axis))
            .or_else(|| turning.next())
    }
}
