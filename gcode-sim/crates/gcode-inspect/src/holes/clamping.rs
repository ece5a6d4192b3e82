//! The clamp of the rotary table: while it holds, the table must not turn, and while it doesn't, nothing may be drilled.
use super::HoleExtractor;
use gcode_lang::diag::Diagnostic;
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
        let Some(clamp) = self.conduct.clamp else { return false };
        match code {
            code if code == clamp.on => self.hold = ClampState::Clamped,
            code if code == clamp.off => self.hold = ClampState::Released,
            _ => return false,
        }
        true
    }

    /// Whether the rotary may turn.
    pub(super) fn check_turn(&mut self, event: &Event<'_>, from: &Position, to: &Position) {
        let Some(clamp) = self.conduct.clamp else { return };
        let Some(axis) = self.clamped().filter(|axis| from[*axis] != to[*axis]) else { return };
        let letter = self.machine.axes.letter(axis);
        let Clamp { on, off } = clamp;
        match self.hold {
            ClampState::Released => {}
            ClampState::Clamped => self.findings.add("turns-clamped", &event.place(), 0, || {
                Diagnostic::error("turns-clamped", format!("{letter} turns while M{on:02} holds it"))
                    .note("the axis stops with an alarm, or the drive works against the clamp")
                    .help(format!("M{off:02} before {letter} turns"))
            }),
            ClampState::Unknown => {
                self.findings.add("turns-clamped", &event.place(), 1, || {
                    Diagnostic::warning(
                        "turns-clamped",
                        format!("{letter} turns before any M{off:02} has let it go"),
                    )
                    .note("how the clamp stands when the program begins isn't known")
                    .help(format!("M{off:02} before {letter} turns"))
                });
                // It turned: so it was free, and nothing holds it now.
                self.hold = ClampState::Released;
            }
        }
    }

    /// Whether what is drilled was held when the feed began.
    pub(super) fn check_held(&mut self, place: &Backtrace, hold: ClampState) {
        let Some(Clamp { on, .. }) = self.conduct.clamp else { return };
        let Some(axis) = self.clamped() else { return };
        let letter = self.machine.axes.letter(axis);
        match hold {
            ClampState::Clamped => {}
            ClampState::Released => self.findings.add("drills-unclamped", place, 0, || {
                let message = format!("the tool feeds into the part while nothing holds {letter}");
                Diagnostic::error("drills-unclamped", message)
                    .note("the part gives way under the drill, and the hole stands where that leaves it")
                    .help(format!("M{on:02} after {letter} has turned"))
            }),
            ClampState::Unknown => self.findings.add("drills-unclamped", place, 1, || {
                let message = format!("the tool feeds into the part before any M{on:02} holds {letter}");
                Diagnostic::warning("drills-unclamped", message)
                    .note("how the clamp stands when the program begins isn't known")
                    .help(format!("M{on:02} before the feed"))
            }),
        }
    }

    /// The axis that the clamp holds: the reference's rotary, where it carries the part, else the first that turns it.
    fn clamped(&self) -> Option<AxisIndex> {
        let named = self.conduct.rotary.and_then(|rotary| self.machine.axes.find(rotary.letter as u8));
        let mut turning = self.machine.table.turning();
        named
            .filter(|axis| self.machine.table.turning().any(|other| other == *axis))
            .or_else(|| turning.next())
    }
}
