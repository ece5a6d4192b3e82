//! Axes in machine coordinates without a known work offset: their position on the part is unknown.
use nalgebra::Point3;

use super::HoleExtractor;
use super::line::{CuttingLine, ToolExit};
use crate::findings::MACHINE_POSITION;
use crate::machine::Machine;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{AxisIndex, Backtrace, Event};

/// Sine of the largest angle at which an axis moves along a hole.
const MAX_SINE: f64 = 1e-3;

/// Rapids from or to positions that are unknown on the part.
#[derive(Clone, Debug)]
pub(crate) struct UnknownWorkZero {
    /// Block of the first rapid.
    pub backtrace: Backtrace,
    /// Letters of the axes of all of them, as in `X and Z`.
    pub letters: String,
    /// Number of rapids.
    pub count: u64,
}

/// Axes of unknown position now and after the next move, as bits, axis 1 the lowest.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkZeroTracker {
    current: u8,
    upcoming: u8,
    /// First rapid, axes of all rapids, and their number.
    rapids: Option<(Backtrace, u8, u64)>,
}

impl WorkZeroTracker {
    /// Applies the event before a move: the axes of unknown position at its end.
    pub(crate) fn apply_event(&mut self, machine: &Machine, axes: u8) {
        // A move without travel has no event of its own.
        self.current = self.upcoming;
        self.upcoming = machine
            .axes
            .iter()
            .filter(|(axis, _)| machine.is_axis_used(*axis))
            .fold(0, |mask, (axis, _)| mask | axes & 1 << axis);
    }

    /// Returns the axes of unknown position before and after a move.
    pub(crate) fn advance(&mut self) -> (u8, u8) {
        (std::mem::replace(&mut self.current, self.upcoming), self.upcoming)
    }

    pub(crate) fn note_rapid(&mut self, event: &Event<'_>, axes: u8) {
        let (_, all, count) = self.rapids.get_or_insert_with(|| (event.backtrace(), 0, 0));
        *all |= axes;
        *count += 1;
    }

    pub(crate) fn finish(self, machine: &Machine) -> Option<UnknownWorkZero> {
        let (backtrace, axes, count) = self.rapids?;
        Some(UnknownWorkZero { backtrace, letters: axis_letters(machine, axes), count })
    }

    /// Returns the axes of unknown position now.
    pub(super) fn unknown_axes(&self) -> u8 {
        self.current
    }
}

impl UnknownWorkZero {
    /// Returns a sentence on what is not checked; `first` is the program and the line of the first rapid.
    pub(crate) fn describe(&self, first: (String, u32)) -> String {
        let (program, line) = first;
        let moves = match self.count {
            1 => format!("1 move, {program} line {line}"),
            count => format!("{count} moves, first {program} line {line}"),
        };
        format!(
            "the clearance of rapids from and to the positions where G28, G30 or G53 sends {} ({moves}): \
             the machine file lacks the work offset in effect ([offsets]), so the position of machine zero \
             on the part is unknown",
            self.letters
        )
    }
}

impl HoleExtractor<'_> {
    /// Ends the current line at a rapid from or to an unknown position, and checks its end if that is known. `from` is
    /// the computed start; `was` and `is` are the unknown axes before and after.
    pub(super) fn report_unknown_rapid(
        &mut self,
        event: &Event<'_>,
        from: &Point3<f64>,
        (was, is): (u8, u8),
    ) {
        if let Some(line) = self.current_line.take() {
            let is_out = self.is_out_along(&line, is & !was);
            let exit = if is_out { ToolExit::AlongLine } else { line.curved_exit() };
            self.report_line(line, exit, false);
        }
        self.work_zero.note_rapid(event, was | is);
        if let (0, Some(surface)) = (is, self.surface) {
            let to = self.pose.tip;
            if self.has_been_outside {
                let note = "the start of this rapid is unknown: G28, G30 or G53 sent the tool there";
                self.check_rapid_end(event, &surface, &to, Severity::Error, note);
            } else {
                self.check_first_rapid(event, &surface, from, &to);
            }
            self.update_outside();
        }
    }

    /// Returns true if all these axes move the tool along the line: out of the hole, since machine zero is outside the
    /// part.
    fn is_out_along(&self, line: &CuttingLine, axes: u8) -> bool {
        let is_along = |axis: AxisIndex| {
            let mut beside = self.axis_position;
            beside[axis] += 1.0;
            let by = self.machine.forward(&beside, &self.setup).tip - self.pose.tip;
            by.cross(&line.out).norm() <= MAX_SINE * by.norm()
        };
        self.machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1).all(|(axis, _)| is_along(axis))
    }

    /// Reports a cut with axes of unknown position.
    pub(super) fn check_work_zero_known(&mut self, backtrace: &Backtrace, axes: u8) {
        if axes == 0 {
            return;
        }
        let letters = axis_letters(self.machine, axes);
        self.findings.add(&MACHINE_POSITION, backtrace, u32::from(axes), |kind| {
            let message = format!(
                "the tool feeds into the part with {letters} where G28, G30 or G53 sent it: this position \
                 on the part is unknown"
            );
            let help = format!(
                "command {letters} to the hole explicitly, or give the offset under [offsets] in the machine file"
            );
            Diagnostic::new(kind, message)
                .note("the machine file lacks the work offset in effect; machine zero is taken as the work zero")
                .help(help)
        });
    }
}

/// Returns the letters of axes, as in `X and Z`.
fn axis_letters(machine: &Machine, axes: u8) -> String {
    let named = machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1);
    named.map(|(_, letter)| letter.to_string()).collect::<Vec<_>>().join(" and ")
}
