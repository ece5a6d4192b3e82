//! Axes that stand in machine coordinates while no work offset says what these are on the part: how near the part a rapid
//! passes there, nobody can tell, and where a hole is cut neither.
use nalgebra::Point3;

use super::Extractor;
use super::line::{After, Line};
use super::rapids::TOUCH;
use crate::diag::Diagnostic;
use crate::machine::Machine;
use crate::motion::{Axis, Event, Place};
use crate::part::surface::Surface;

/// The sine of the angle up to which an axis leads along a hole.
const ALONG: f64 = 1e-3;

/// Rapids from or to such a place.
#[derive(Clone, Debug)]
pub struct Unplaced {
    /// Of the first.
    pub place: Place,
    /// The letters of the axes of all of them, in words.
    pub letters: String,
    pub times: u64,
}

/// Which axes stand so now, and which will when the next move has ended.
#[derive(Clone, Debug, Default)]
pub(crate) struct Placing {
    now: u8,
    then: u8,
    /// The first rapid, the axes of all of them, how many they are.
    rapids: Option<(Place, u8, u64)>,
}

impl Placing {
    /// What the control says of the next move's end, of axes on which something is.
    pub(crate) fn hear(&mut self, machine: &Machine, axes: u8) {
        // A move that leads nowhere isn't told.
        self.now = self.then;
        self.then = machine
            .axes
            .iter()
            .filter(|(axis, _)| machine.carries(*axis))
            .fold(0, |mask, (axis, _)| mask | axes & 1 << axis);
    }

    /// The axes that stood so before a move and those that do after it.
    pub(crate) fn go(&mut self) -> (u8, u8) {
        (std::mem::replace(&mut self.now, self.then), self.then)
    }

    pub(crate) fn note_rapid(&mut self, event: &Event<'_>, axes: u8) {
        let (_, all, times) = self.rapids.get_or_insert_with(|| (event.place(), 0, 0));
        *all |= axes;
        *times += 1;
    }

    pub(crate) fn finish(self, machine: &Machine) -> Option<Unplaced> {
        let unplaced = |(place, axes, times)| Unplaced { place, letters: letters(machine, axes), times };
        self.rapids.map(unplaced)
    }

    /// The axes that stand so now.
    pub(super) fn now(&self) -> u8 {
        self.now
    }
}

impl Unplaced {
    /// What isn't checked because of them, in words. `begun`: the program and the line of the first.
    pub(crate) fn in_words(&self, (program, line): (String, u32)) -> String {
        let moves = match self.times {
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

impl Extractor<'_> {
    /// A rapid from or to where nobody knows, from `from` as far as that is reckoned: what was cut there ends, and of its
    /// own way only an end that is known is looked at.
    pub(super) fn jump(&mut self, event: &Event<'_>, from: &Point3<f64>, (was, is): (u8, u8)) {
        if let Some(line) = self.line.take() {
            let after = if self.leads_out(&line, is & !was) { After::Out } else { line.aside() };
            self.judge_line(line, after, false);
        }
        self.placing.note_rapid(event, was | is);
        if let (0, Some(surface)) = (is, self.surface) {
            let to = self.pose.tip;
            match self.outside {
                true => self.check_end(event, &surface, &to),
                false => self.check_first_rapid(event, &surface, from, &to),
            }
            self.look_outside();
        }
    }

    /// Whether axes that go to machine coordinates take the tool along the line: out of the hole, for nobody has machine
    /// zero in the part.
    fn leads_out(&self, line: &Line, axes: u8) -> bool {
        let along = |axis: Axis| {
            let mut beside = self.at;
            beside[axis] += 1.0;
            let by = self.machine.forward(&beside, &self.setup).tip - self.pose.tip;
            by.cross(&line.out).norm() <= ALONG * by.norm()
        };
        self.machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1).all(|(axis, _)| along(axis))
    }

    fn check_end(&mut self, event: &Event<'_>, surface: &Surface, to: &Point3<f64>) {
        let depth = surface.depth(to);
        if depth <= TOUCH {
            return;
        }
        self.findings.add("rapid-into-part", &event.place(), 0, || {
            let message =
                format!("the rapid ends {depth:.3} mm below the surface, at {}", super::rapids::shown(to));
            Diagnostic::error("rapid-into-part", message)
                .note("the start of this rapid is unknown: G28, G30 or G53 sent the tool there")
                .help("end it at a safe height; check the sign of Z and the length offset")
        });
    }

    /// Holes are cut where the axes of `line` stand, and nobody knows where that is.
    pub(super) fn check_placed(&mut self, place: &Place, unplaced: u8) {
        if unplaced == 0 {
            return;
        }
        let letters = letters(self.machine, unplaced);
        self.findings.add("machine-position", place, u32::from(unplaced), || {
            let message = format!(
                "the tool feeds into the part with {letters} where G28, G30 or G53 sent it: this position \
                 on the part is unknown"
            );
            Diagnostic::warning("machine-position", message)
                .note("the machine file lacks the work offset in effect; machine zero is taken as the work zero")
                .help(format!("command {letters} to the hole explicitly, or give the offset under \
                               [offsets] in the machine file"))
        });
    }
}

/// `X and Z`.
fn letters(machine: &Machine, axes: u8) -> String {
    let named = machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1);
    named.map(|(_, letter)| letter.to_string()).collect::<Vec<_>>().join(" and ")
}
