//! Ball-end rotary burrs on a 5-axis grinder: flutes on a cylinder and its nose, computed by a resident macro
//! or written out move by move.
//!
//! The method is that of *Machining Rotary Burrs on 5-Axis Grinding Machine*; see `docs/methods/burr.md`.
mod helix_error;
mod law;
mod machine_file;
pub mod macros;
mod nose;
mod path;

use gcode_part::job::{Burr, FluteLaw, Nose, ProgramForm};

use self::macros::{FLUTE, Resident};
use self::nose::cylinder;
use self::path::{Point, clearance_y, points, stand_off};
use super::start::Start;
use super::{Family, control};
use crate::nc::block::Block;
use crate::nc::number::number;
use crate::nc::program::Program as Text;
use crate::package::{Package, Program};

/// O-number of the main program.
pub const MAIN: u32 = 8400;

pub const FAMILY: Family =
    Family { name: "burr", new_job: include_str!("new.toml"), resident: macros::of_the_defaults };

/// Emits the main program, its resident macro if it calls one, and the machine file of a job.
pub fn emit(job: &Burr) -> Package {
    let mut programs = vec![Program { number: MAIN, text: Main::new(job).text() }];
    if job.form() == ProgramForm::Loop {
        programs.extend(Resident::of(job).programs());
    }
    Package { mains: vec![MAIN], programs, machine: machine_file::machine_file(job) }
}

/// Returns the reason why no program grinds the job's burr within its tolerances, and alternatives.
pub fn refusal(job: &Burr) -> Option<String> {
    helix_error::refusal(job)
}

struct Main<'j> {
    job: &'j Burr,
    /// Chord error of the moves: the job's, or less if the helix angle requires it.
    chord_error: f64,
    start: Start,
    text: Text,
}

impl<'j> Main<'j> {
    fn new(job: &'j Burr) -> Self {
        let chord_error = helix_error::chord_error(job).unwrap_or(job.chord_error);
        // A is not cancelled: a shift of A rotates all flutes alike. The axis with number 3 on a grinder is
        // unknown.
        let start = Start {
            control: job.control,
            changed_alarm: 97,
            shifted_alarm: 98,
            axes: "XY",
            cancelled_rotaries: "BC".to_owned(),
        };
        Self { job, chord_error, start, text: Text::new(MAIN, "BALL-END ROTARY BURR", job.control.dialect) }
    }

    fn text(mut self) -> String {
        self.header();
        self.start.blocks(&mut self.text);
        self.block(format!("S{:.0} M03", self.job.program.wheel()));
        self.block("M08");
        match self.job.form() {
            ProgramForm::Loop => self.calls(),
            ProgramForm::Moves => self.moves(),
        }
        self.block("G00 C0.");
        self.block("M09");
        self.block("M05");
        self.block("M30");
        self.text.finish()
    }

    fn block(&mut self, words: impl Into<String>) {
        self.text.block(Block::of(words));
    }

    /// Writes the remarks at the head: conditions for the run.
    fn header(&mut self) {
        let job = self.job;
        let shape = &job.shape;
        let nose = match shape.nose {
            Nose::Ball => "BALL END".to_owned(),
            Nose::Arcs { large, small } => {
                format!("NOSE OF ARCS R{} AND R{}", number(large), number(small))
            }
        };
        let law = match job.law {
            FluteLaw::ConstantHelix => "CONSTANT UP TO THE TIP",
            FluteLaw::Published => "GROWING ON THE NOSE AS PRINTED",
        };
        let [x, y] = job.grinder.c_offset.map(number);
        let lines = [
            format!(
                "FLUTES {}, DIAMETER {}, LENGTH {}, {nose}",
                job.flutes,
                number(2.0 * shape.radius),
                number(shape.length)
            ),
            format!("HELIX ANGLE {}, {law}", number(job.helix)),
            format!("TIP ANGLE {}, CHORD ERROR {}", number(shape.tip_angle), number(job.chord_error)),
            "NUMBERS ARE MILLIMETRES AND DEGREES".to_owned(),
            format!("CONTROL {}, MACHINE FILE MACHINE.TOML", control::remark(job.control)),
            "WORK ZERO G54 AT C 0, TIP TOWARDS -X, THE WHEEL AT -Y TOUCHES".to_owned(),
            "THE TOOTH BOTTOM WHERE THE CYLINDER ENDS".to_owned(),
            format!("FROM THE C AXIS TO THERE X {x} Y {y}"),
            signs(job),
            "METHOD OF MACHINING ROTARY BURRS ON 5-AXIS GRINDING MACHINE".to_owned(),
            "FEED ALONG THE FLUTE BY INVERSE TIME G93".to_owned(),
            "START WITH C BETWEEN 0 AND THE END OF THE FLUTE, WHEEL CLEAR".to_owned(),
        ];
        for line in lines.into_iter().chain(self.start.remarks()) {
            self.text.remark(line);
        }
        if self.chord_error < job.chord_error {
            let least = number(self.chord_error);
            self.text.remark(format!("MOVES FOR A CHORD ERROR OF {least}, SO THAT THE HELIX ANGLE HOLDS"));
        }
    }

    /// Writes a loop with one call per flute.
    fn calls(&mut self) {
        let job = self.job;
        self.text.remark(format!("ONE FLUTE BY O{FLUTE}, ITS ARGUMENTS STAND AT ITS HEAD"));
        let flutes = number(f64::from(job.flutes));
        self.block("#1=0");
        self.block(format!("WHILE[#1 LT {flutes}]DO1"));
        let shape = &job.shape;
        let [x, y] = job.grinder.c_offset;
        let mut call = Block::call(FLUTE)
            .word('A', format!("[#1*360./{flutes}]"))
            .word('B', number(job.helix))
            .word('C', number(90.0 - shape.tip_angle))
            .word('D', number(self.chord_error))
            .word('E', number(job.program.plunge()))
            .word('F', number(job.program.speed()))
            .word('H', if job.law == FluteLaw::Published { "1." } else { "0." })
            .word('I', number(x))
            .word('J', number(y));
        if let Nose::Arcs { large, small } = shape.nose {
            call = call.word('K', number(large)).word('Q', number(small));
        }
        let call = call
            .word('R', number(shape.radius))
            .word('V', number(stand_off(job)))
            .word('W', number(cylinder(job)));
        self.text.block(call);
        self.block("#1=#1+1");
        self.block("END1");
    }

    /// Writes every flute point by point.
    fn moves(&mut self) {
        let job = self.job;
        let points = points(job, self.chord_error);
        let (signs, clear, stand_off) = (job.grinder.signs(), clearance_y(job), stand_off(job));
        // Rounded here, because a control truncates digits beyond its increment.
        let increment = job.control.increment;
        let along = |letter: char, sign: i8, value: f64| {
            format!("{letter}{}", number(increment.round(f64::from(sign) * value)))
        };
        for flute in 0..job.flutes {
            let start = f64::from(flute) * 360.0 / f64::from(job.flutes);
            let axes = |point: &Point| {
                format!(
                    "{} {} {} {}",
                    along('X', signs.x, point.x),
                    along('Y', signs.y, point.y),
                    along('A', signs.a, start + point.a.0),
                    along('C', signs.c, point.c.0)
                )
            };
            self.text.remark(format!("FLUTE {} OF {}", flute + 1, job.flutes));
            let Some((first, rest)) = points.split_first() else { continue };
            self.block(format!("G00 {}", along('Y', signs.y, clear)));
            self.block(format!(
                "{} {} {} C0.",
                along('X', signs.x, first.x),
                along('A', signs.a, start),
                along('B', signs.b, job.helix)
            ));
            self.block(along('Y', signs.y, stand_off));
            self.block(format!("G01 Y0. F{}", number(job.program.plunge())));
            self.block("G93");
            for point in rest {
                self.block(format!(
                    "{} F{}",
                    axes(point),
                    number(rate(job.program.speed(), point.path_length))
                ));
            }
            self.block(format!("G94 G00 {}", along('Y', signs.y, clear)));
        }
    }
}

/// Returns the feed of a move in 1/min. Controls accept three decimals of an inverse-time F.
fn rate(speed: f64, way: f64) -> f64 {
    (1000.0 * speed / way).round().max(1.0) / 1000.0
}

/// Returns the remark on axes that run against the formulas.
fn signs(job: &Burr) -> String {
    let signs = job.grinder.signs();
    let all = [('X', signs.x), ('Y', signs.y), ('A', signs.a), ('B', signs.b), ('C', signs.c)];
    let turned: Vec<String> =
        all.iter().filter(|(_, sign)| *sign < 0).map(|(letter, _)| letter.to_string()).collect();
    match turned.is_empty() {
        true => "ALL AXES RUN AS IN THE FORMULAS".to_owned(),
        false => format!("REVERSED AGAINST THE FORMULAS {}", turned.join(" ")),
    }
}

#[cfg(test)]
mod tests {
    use gcode_part::job::Job;

    use super::*;

    /// Returns the burr of the test with `more` under `[machine]`.
    pub(super) fn job(more: &str) -> Burr {
        let text = format!(
            "family = \"burr\"\n[burr]\ndiameter = 12.0\nlength = 25.0\nflutes = 16\nhelix = 20.0\n\
             law = \"constant-helix\"\ntip_angle = 5.0\nchord_error = 0.002\n[machine]\nc_offset = [40.0, -15.0]\n{more}"
        );
        match Job::parse(&text).unwrap() {
            Job::Burr(job) => job,
            other => panic!("{other:?} is no burr"),
        }
    }
}
