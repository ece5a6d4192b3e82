//! The clamp of the rotary table: while it holds, the table must not turn, and while it doesn't, nothing may be drilled.
use super::Extractor;
use crate::diag::Diagnostic;
use crate::job::Clamp;
use crate::motion::{Axis, Event, Place, Position};

/// What the program has done about the clamp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Hold {
    /// Nothing yet: what was done before the program, nobody knows.
    #[default]
    Unsaid,
    Held,
    Free,
}

impl Extractor<'_> {
    /// A code of the clamp, if it is one.
    pub(super) fn hold(&mut self, code: u32) -> bool {
        let Some(clamp) = self.conduct.clamp else { return false };
        match code {
            code if code == clamp.on => self.hold = Hold::Held,
            code if code == clamp.off => self.hold = Hold::Free,
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
            Hold::Free => {}
            Hold::Held => self.findings.add("turns-clamped", &event.place(), 0, || {
                Diagnostic::error("turns-clamped", format!("{letter} rotates while clamped by M{on:02}"))
                    .note("the control raises an alarm, or the drive works against the clamp")
                    .help(format!("command M{off:02} before {letter} rotates"))
            }),
            Hold::Unsaid => {
                self.findings.add("turns-clamped", &event.place(), 1, || {
                    Diagnostic::warning(
                        "turns-clamped",
                        format!("{letter} rotates before any M{off:02} releases it"),
                    )
                    .note("the state of the clamp at the start of the program is unknown")
                    .help(format!("command M{off:02} before {letter} rotates"))
                });
                // It turned: so it was free, and nothing holds it now.
                self.hold = Hold::Free;
            }
        }
    }

    /// Whether what is drilled was held when the feed began.
    pub(super) fn check_held(&mut self, place: &Place, hold: Hold) {
        let Some(Clamp { on, .. }) = self.conduct.clamp else { return };
        let Some(axis) = self.clamped() else { return };
        let letter = self.machine.axes.letter(axis);
        match hold {
            Hold::Held => {}
            Hold::Free => self.findings.add("drills-unclamped", place, 0, || {
                let message = format!("the tool feeds into the part with {letter} unclamped");
                Diagnostic::error("drills-unclamped", message)
                    .note("the part gives way under the drill, which moves the hole")
                    .help(format!("command M{on:02} after {letter} has rotated"))
            }),
            Hold::Unsaid => self.findings.add("drills-unclamped", place, 1, || {
                let message = format!("the tool feeds into the part before any M{on:02} clamps {letter}");
                Diagnostic::warning("drills-unclamped", message)
                    .note("the state of the clamp at the start of the program is unknown")
                    .help(format!("command M{on:02} before the feed"))
            }),
        }
    }

    /// The axis that the clamp holds: the reference's rotary, where it carries the part, else the first that turns it.
    fn clamped(&self) -> Option<Axis> {
        let named = self.conduct.rotary.and_then(|rotary| self.machine.axes.find(rotary.letter as u8));
        let mut turning = self.machine.table.turning();
        named
            .filter(|axis| self.machine.table.turning().any(|other| other == *axis))
            .or_else(|| turning.next())
    }
}
