//! Axes that stand in machine coordinates while no work offset says what these are on the part: how near the part a rapid
//! passes there, nobody can tell, and where a hole is cut neither.
use nalgebra::Point3;

use super::HoleExtractor;
use super::line::{CuttingLine, ToolExit};
use super::rapids::TOUCH_DEPTH;
use crate::findings::{MACHINE_POSITION, RAPID_INTO_PART};
use crate::machine::Machine;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{AxisIndex, Backtrace, Event};
use gcode_part::Surface;

/// The sine of the angle up to which an axis leads along a hole.
const MAX_SINE: f64 = 1e-3;

/// Rapids from or to such a place.
#[derive(Clone, Debug)]
pub struct UnknownWorkZero {
    /// Of the first.
    pub backtrace: Backtrace,
    /// The letters of the axes of all of them, in words.
    pub letters: String,
    pub count: u64,
}

/// Which axes stand so now, and which will when the next move has ended.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkZeroTracker {
    current: u8,
    upcoming: u8,
    /// The first rapid, the axes of all of them, how many they are.
    rapids: Option<(Backtrace, u8, u64)>,
}

impl WorkZeroTracker {
    /// What the control says of the next move's end, of axes on which something is.
    pub(crate) fn apply_event(&mut self, machine: &Machine, axes: u8) {
        // A move that leads nowhere isn't told.
        self.current = self.upcoming;
        self.upcoming = machine
            .axes
            .iter()
            .filter(|(axis, _)| machine.is_axis_used(*axis))
            .fold(0, |mask, (axis, _)| mask | axes & 1 << axis);
    }

    /// The axes that stood so before a move and those that do after it.
    pub(crate) fn advance(&mut self) -> (u8, u8) {
        (std::mem::replace(&mut self.current, self.upcoming), self.upcoming)
    }

    pub(crate) fn note_rapid(&mut self, event: &Event<'_>, axes: u8) {
        let (_, all, times) = self.rapids.get_or_insert_with(|| (event.backtrace(), 0, 0));
        *all |= axes;
        *times += 1;
    }

    pub(crate) fn finish(self, machine: &Machine) -> Option<UnknownWorkZero> {
        let unplaced = |(place, axes, times)| UnknownWorkZero {
            backtrace: place,
            letters: axis_letters(machine, axes),
            count: times,
        };
        self.rapids.map(unplaced)
    }

    /// The axes that stand so now.
    pub(super) fn unknown_axes(&self) -> u8 {
        self.current
    }
}

impl UnknownWorkZero {
    /// What isn't checked because of them, in words. `begun`: the program and the line of the first.
    pub fn describe(&self, (program, line): (String, u32)) -> String {
        let moves = match self.count {
            1 => format!("1 move, {program} line {line}"),
            times => format!("{times} moves, first {program} line {line}"),
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
    /// A rapid from or to where nobody knows, from `from` as far as that is reckoned: what was cut there ends, and of its
    /// own way only an end that is known is looked at.
    pub(super) fn report_unknown_rapid(
        &mut self,
        event: &Event<'_>,
        from: &Point3<f64>,
        (was, is): (u8, u8),
    ) {
        if let Some(line) = self.current_line.take() {
            let after =
                if self.is_out_along(&line, is & !was) { ToolExit::AlongLine } else { line.curved_exit() };
            self.report_line(line, after, false);
        }
        self.work_zero.note_rapid(event, was | is);
        if let (0, Some(surface)) = (is, self.surface) {
            let to = self.pose.tip;
            match self.has_been_outside {
                true => self.check_rapid_end(event, &surface, &to),
                false => self.check_first_rapid(event, &surface, from, &to),
            }
            self.update_outside();
        }
    }

    /// Whether axes that go to machine coordinates take the tool along the line: out of the hole, for nobody has machine
    /// zero in the part.
    fn is_out_along(&self, line: &CuttingLine, axes: u8) -> bool {
        let along = |axis: AxisIndex| {
            let mut beside = self.axis_position;
            beside[axis] += 1.0;
            let by = self.machine.forward(&beside, &self.setup).tip - self.pose.tip;
            by.cross(&line.out).norm() <= MAX_SINE * by.norm()
        };
        self.machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1).all(|(axis, _)| along(axis))
    }

    fn check_rapid_end(&mut self, event: &Event<'_>, surface: &Surface, to: &Point3<f64>) {
        let depth = surface.depth(to);
        if depth <= TOUCH_DEPTH {
            return;
        }
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let message = format!(
                "the rapid ends {depth:.3} mm below the surface, at {}",
                super::rapids::format_point(to)
            );
            Diagnostic::new(kind, message)
                .note("the start of this rapid is unknown: G28, G30 or G53 sent the tool there")
                .help("end it at a safe height; check the sign of Z and the length offset")
        });
    }

    /// Holes are cut where the axes of `line` stand, and nobody knows where that is.
    pub(super) fn check_work_zero_known(&mut self, place: &Backtrace, unplaced: u8) {
        if unplaced == 0 {
            return;
        }
        let letters = axis_letters(self.machine, unplaced);
        self.findings.add(&MACHINE_POSITION, place, u32::from(unplaced), |kind| {
            let message = format!(
                "the tool feeds into the part with {letters} where G28, G30 or G53 sent it: this position \
                 on the part is unknown"
            );
            Diagnostic::new(kind, message)
                .note("the machine file lacks the work offset in effect; machine zero is taken as the work zero")
                .help(format!("command {letters} to the hole explicitly, or give the offset under \
                               [offsets] in the machine file"))
        });
    }
}

/// `X and Z`.
fn axis_letters(machine: &Machine, axes: u8) -> String {
    let named = machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1);
    named.map(|(_, letter)| letter.to_string()).collect::<Vec<_>>().join(" and ")
}
