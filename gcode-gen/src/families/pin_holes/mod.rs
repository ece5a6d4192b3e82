//! Pin holes on an ellipsoid of revolution: a main program of calls, and resident macros that compute
//! equation (8).
//!
//! The method is that of *Improved Processing Technology of Positioning Pin Hole on Melon Mold*; see
//! `docs/methods/pin-holes.md`. The main program contains no number that follows from a, b, r and the
//! azimuth: changing R moves the hole to its correct new position.
mod machine_file;
pub mod macros;

use gcode_part::job::{AxisDirection, HeadKind, HoleSpec, PinHoles};

use self::macros::{HEAD, HOLE, Resident};
use super::start::Start;
use super::{Family, control};
use crate::nc::block::Block;
use crate::nc::number::number;
use crate::nc::program::Program as Text;
use crate::order::{HeadSetting, ToolPass, passes};
use crate::package::{Package, Program};

/// O-number of the main program.
pub const MAIN: u32 = 8100;

pub const FAMILY: Family =
    Family { name: "pin-holes", new_job: include_str!("new.toml"), resident: macros::of_the_defaults };

/// Emits the main program, the resident macros and the machine file of a job.
pub fn emit(job: &PinHoles) -> Package {
    let mut programs = vec![Program { number: MAIN, text: Main::new(job).text() }];
    programs.extend(Resident::of(job).programs());
    Package { mains: vec![MAIN], programs, machine: machine_file::machine_file(job) }
}

struct Main<'j> {
    job: &'j PinHoles,
    resident: Resident,
    start: Start,
    text: Text,
}

impl<'j> Main<'j> {
    fn new(job: &'j PinHoles) -> Self {
        let text = Text::new(MAIN, "PIN HOLES ON AN ELLIPSOID OF REVOLUTION", job.control.dialect);
        let start = Start {
            control: job.control,
            changed_alarm: 17,
            shifted_alarm: 18,
            axes: "XYZ",
            cancelled_rotaries: job.machine.rotary.letter.to_string(),
        };
        Self { job, resident: Resident::of(job), start, text }
    }

    fn text(mut self) -> String {
        let passes = passes(self.job);
        self.header(&passes);
        self.start();
        for (index, pass) in passes.iter().enumerate() {
            self.tool(pass, passes.get(index + 1));
        }
        self.text
            .block(Block::of(format!("#{}=#0", self.resident.set())).comment("HEAD ANGLE NO LONGER VALID"));
        self.text.block(Block::of("M30"));
        self.text.finish()
    }

    /// Writes the remarks at the head: conditions for the run.
    fn header(&mut self, passes: &[ToolPass<'_>]) {
        let job = self.job;
        let (a, b) = (number(job.surface.a), number(job.surface.b));
        let holes = job.holes.len();
        let rotary = job.machine.rotary;
        let sign = if rotary.sign < 0 { "-" } else { "" };
        let head = match job.machine.head.kind() {
            HeadKind::Manual => "SET BY HAND AT A STOP".to_owned(),
            HeadKind::Axis(letter) => format!("MOVED AS AXIS {letter}"),
        };
        let control = control::remark(job.control);
        let common = self.resident.common;
        let k = control::alarm_thousands(job.control.dialect);
        let lines = [
            format!("HOLES {holes}, SURFACE [X*X+Z*Z]/A/A+Y*Y/B/B = 1, A {a} B {b}"),
            "NUMBERS ARE MILLIMETRES AND DEGREES, FEEDS MM/MIN".to_owned(),
            format!("CONTROL {control}, MACHINE FILE MACHINE.TOML"),
            "WORK ZERO G54 IS THE CENTRE OF THE ELLIPSOID, Y ITS AXIS".to_owned(),
            format!("ROTARY {} = {sign}AZIMUTH, FROM X TOWARDS Z", rotary.letter),
            format!("HEAD ANGLE FROM X TOWARDS Y, {head}"),
            format!("CALLS O{HEAD} HEAD ANGLE OF A RADIUS, AND O{HOLE} ONE HOLE"),
            "THEY COMPUTE EQUATION 8 OF IMPROVED PROCESSING TECHNOLOGY OF".to_owned(),
            "POSITIONING PIN HOLE ON MELON MOLD FROM A, B AND R".to_owned(),
            format!("TO MOVE A HOLE CHANGE R OR W IN ITS O{HOLE} CALLS AND R IN THE"),
            format!("O{HEAD} CALL ABOVE, WHERE THE HEAD DOES NOT SUIT A HOLE O{HOLE}"),
            format!("CALLS O{HEAD} ITSELF BEFORE IT CUTS"),
            "A EQUATORIAL RADIUS, B POLAR RADIUS, C CLEARANCE, D DEPTH".to_owned(),
            "E FEED OUT, F FEED IN, H 0. NORMAL 1. AXIAL, Q PIVOT TO TIP".to_owned(),
            format!("R RADIUS, U SIGN OF {}, V RETRACT, W AZIMUTH", rotary.letter),
            format!("COMMON VARIABLES #{common} HEAD ANGLE TO SET, #{} ANGLE SET", common + 1),
            format!("ALARMS {k}001-{k}017 BY O{HOLE}, {k}021-{k}030 BY O{HEAD}"),
            "START WITH THE TOOL CLEAR OF THE PART, ABOVE OR BESIDE IT".to_owned(),
        ];
        for line in lines.into_iter().chain(self.start.remarks()) {
            self.text.remark(line);
        }
        for ToolPass { tool, .. } in passes {
            let (diameter, length) = (number(tool.diameter), number(tool.length));
            self.text.remark(format!("T{} {} DIAMETER {diameter} LENGTH {length}", tool.number, tool.name()));
        }
    }

    fn start(&mut self) {
        self.start.blocks(&mut self.text);
        self.text.block(Block::of(format!("#{}=#0", self.resident.set())).comment("HEAD NOT SET YET"));
    }

    fn tool(&mut self, pass: &ToolPass<'_>, next: Option<&ToolPass<'_>>) {
        let tool = pass.tool;
        let diameter = number(tool.diameter);
        self.text.remark(format!("T{} {} DIAMETER {diameter}", tool.number, tool.name()));
        self.text.block(Block::of(format!("T{} M06", tool.number)));
        self.text.block(Block::of(format!("S{:.0} M03", tool.speed)));
        self.text.block(Block::of("M08"));
        for setting in &pass.settings {
            let head = self.head_call(pass, setting);
            self.text.block(head);
            for hole in &setting.holes {
                let call = self.hole_call(pass, hole);
                self.text.block(call);
            }
        }
        self.text.block(Block::of("M09"));
        // The tip is then at least V above the pole, whatever the angle of the head: see O8102. This includes
        // the next tool, which may be longer.
        let reach = next.map_or(0.0, |next| self.reach(next)).max(self.reach(pass));
        let height = [self.job.surface.b, reach, self.job.machine.retract()].map(number);
        self.text
            .block(Block::of(format!("G90 G00 Y[{}]", height.join("+"))).comment("B+Q+V, CLEAR OF THE PART"));
        self.text.block(Block::of("M05"));
    }

    /// Returns the distance from the head's pivot to the tip.
    fn reach(&self, pass: &ToolPass<'_>) -> f64 {
        self.job.machine.head.pivot + pass.tool.length
    }

    fn head_call(&self, pass: &ToolPass<'_>, setting: &HeadSetting<'_>) -> Block {
        let job = self.job;
        Block::call(HEAD)
            .word('A', number(job.surface.a))
            .word('B', number(job.surface.b))
            .word('R', number(setting.radius))
            .word('H', flag(setting.axis))
            .word('Q', number(self.reach(pass)))
            .word('V', number(job.machine.retract()))
            .comment("HEAD")
    }

    fn hole_call(&self, pass: &ToolPass<'_>, hole: &HoleSpec) -> Block {
        let job = self.job;
        Block::call(HOLE)
            .word('A', number(job.surface.a))
            .word('B', number(job.surface.b))
            .word('R', number(hole.radius))
            .word('W', number(hole.azimuth))
            .word('H', flag(hole.axis))
            .word('D', number(hole.depth))
            .word('C', number(job.machine.clearance()))
            .word('V', number(job.machine.retract()))
            .word('F', number(pass.tool.feed))
            .word('E', number(pass.tool.retract_feed()))
            .word('U', number(f64::from(job.machine.rotary.sign)))
            .word('Q', number(self.reach(pass)))
            .comment(format!("HOLE {}", hole.id))
    }
}

fn flag(axis: AxisDirection) -> &'static str {
    match axis {
        AxisDirection::Normal => "0.",
        AxisDirection::Axial => "1.",
    }
}
