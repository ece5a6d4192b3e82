//! Ball-end rotary burrs on a 5-axis grinder: flutes on a cylinder and its nose, computed by a resident macro
//! or written out move by move.
//!
//! The method is that of *Machining Rotary Burrs on 5-Axis Grinding Machine*; see `docs/methods/burr.md`.
mod helix_error;
mod law;
mod nose;
mod path;

use gcode_part::job::{AxisSigns, Burr, FluteLaw, Nose, ProgramForm};

use self::nose::cylinder;
use self::path::{Point, clearance_y, points, stand_off};
use super::control::{self, minus};
use super::start::Start;
use super::{Family, Macro, package};
use crate::nc::{Block, ProgramText, number};
use crate::package::{Package, Program};

/// O-number of the main program.
const MAIN: u32 = 8400;
/// O-number of the macro for one flute: approach, cylinder, nose, retract.
const FLUTE: u32 = 8401;

const MACROS: &[&[Macro]] =
    &[&[Macro { number: FLUTE, file: "O8401_burr_flute.nc", text: include_str!("flute.nc") }]];

pub(super) const FAMILY: Family = Family { name: "burr", new_job: include_str!("new.toml"), macros: MACROS };

/// Emits the main program, its resident macro if it calls one, and the machine file of a job.
pub(super) fn emit(job: &Burr) -> Package {
    let marks: Vec<(&str, String)> = ["{x}", "{y}", "{a}", "{b}", "{c}"]
        .into_iter()
        .zip(signs(job).map(|(_, sign)| minus(sign).to_owned()))
        .collect();
    let called = if job.form() == ProgramForm::Loop { MACROS } else { &[] };
    let main = Program { number: MAIN, text: main(job) };
    package(job.control, vec![main], called, &marks, machine_file(job))
}

/// Returns the reason why no program grinds the job's burr within its tolerances, and alternatives.
pub(crate) fn refusal(job: &Burr) -> Option<String> {
    helix_error::refusal(job)
}

fn main(job: &Burr) -> String {
    let mut text = ProgramText::new(MAIN, "BALL-END ROTARY BURR", job.control.dialect);
    // A is not cancelled: a shift of A rotates all flutes alike. The axis with number 3 on a grinder is
    // unknown.
    let start = Start {
        control: job.control,
        changed_alarm: 97,
        shifted_alarm: 98,
        axes: "XY",
        cancelled_rotaries: "BC".to_owned(),
    };
    // The job's, or less if the helix angle requires it.
    let chord_error = helix_error::chord_error(job).unwrap_or(job.chord_error);
    text.remarks(header(job));
    text.remarks(start.remarks());
    if chord_error < job.chord_error {
        let least = number(chord_error);
        text.remark(format!("MOVES FOR A CHORD ERROR OF {least}, SO THAT THE HELIX ANGLE HOLDS"));
    }
    start.blocks(&mut text);
    text.blocks([format!("S{:.0} M03", job.program.wheel()), "M08".to_owned()]);
    match job.form() {
        ProgramForm::Loop => write_calls(job, chord_error, &mut text),
        ProgramForm::Moves => write_moves(job, chord_error, &mut text),
    }
    text.blocks(["G00 C0.", "M09", "M05", "M30"]);
    text.finish()
}

/// Returns the remarks at the head: conditions for the run.
fn header(job: &Burr) -> [String; 12] {
    let shape = &job.shape;
    let nose = match shape.nose {
        Nose::Ball => "BALL END".to_owned(),
        Nose::Arcs { large, small } => format!("NOSE OF ARCS R{} AND R{}", number(large), number(small)),
    };
    let law = match job.law {
        FluteLaw::ConstantHelix => "CONSTANT UP TO THE TIP",
        FluteLaw::Published => "GROWING ON THE NOSE AS PRINTED",
    };
    let [x, y] = job.grinder.c_offset.map(number);
    let [diameter, length] = [2.0 * shape.radius, shape.length].map(number);
    [
        format!("FLUTES {}, DIAMETER {diameter}, LENGTH {length}, {nose}", job.flutes),
        format!("HELIX ANGLE {}, {law}", number(job.helix)),
        format!("TIP ANGLE {}, CHORD ERROR {}", number(shape.tip_angle), number(job.chord_error)),
        "NUMBERS ARE MILLIMETRES AND DEGREES".to_owned(),
        control::machine_remark(job.control),
        "WORK ZERO G54 AT C 0, TIP TOWARDS -X, THE WHEEL AT -Y TOUCHES".to_owned(),
        "THE TOOTH BOTTOM WHERE THE CYLINDER ENDS".to_owned(),
        format!("FROM THE C AXIS TO THERE X {x} Y {y}"),
        reversed_axes(job),
        "METHOD OF MACHINING ROTARY BURRS ON 5-AXIS GRINDING MACHINE".to_owned(),
        "FEED ALONG THE FLUTE BY INVERSE TIME G93".to_owned(),
        "START WITH C BETWEEN 0 AND THE END OF THE FLUTE, WHEEL CLEAR".to_owned(),
    ]
}

/// Writes a loop with one call per flute.
fn write_calls(job: &Burr, chord_error: f64, text: &mut ProgramText) {
    let shape = &job.shape;
    let [x, y] = job.grinder.c_offset;
    let flutes = number(f64::from(job.flutes));
    let arguments = [
        ('B', job.helix),
        ('C', 90.0 - shape.tip_angle),
        ('D', chord_error),
        ('E', job.program.plunge()),
        ('F', job.program.speed()),
        ('H', if job.law == FluteLaw::Published { 1.0 } else { 0.0 }),
        ('I', x),
        ('J', y),
    ];
    let nose = match shape.nose {
        Nose::Ball => Vec::new(),
        Nose::Arcs { large, small } => vec![('K', large), ('Q', small)],
    };
    let rest = [('R', shape.radius), ('V', stand_off(job)), ('W', cylinder(job))];
    text.remark(format!("ONE FLUTE BY O{FLUTE}, ITS ARGUMENTS STAND AT ITS HEAD"));
    text.blocks(["#1=0".to_owned(), format!("WHILE[#1 LT {flutes}]DO1")]);
    let call = Block::call(FLUTE, []).word('A', format!("[#1*360./{flutes}]"));
    text.block(call.numbers(arguments.into_iter().chain(nose).chain(rest)));
    text.blocks(["#1=#1+1", "END1"]);
}

/// Writes every flute point by point.
fn write_moves(job: &Burr, chord_error: f64, text: &mut ProgramText) {
    let points = points(job, chord_error);
    let (signs, clear, stand_off) = (job.grinder.signs(), clearance_y(job), stand_off(job));
    // Rounded here, because a control truncates digits beyond its increment.
    let increment = job.control.increment;
    let along = |letter: char, sign: i8, value: f64| {
        format!("{letter}{}", number(increment.round(f64::from(sign) * value)))
    };
    for flute in 0..job.flutes {
        let start = f64::from(flute) * 360.0 / f64::from(job.flutes);
        let cut = |point: &Point| {
            format!(
                "{} {} {} {} F{}",
                along('X', signs.x, point.x),
                along('Y', signs.y, point.y),
                along('A', signs.a, start + point.a.0),
                along('C', signs.c, point.c.0),
                number(rate(job.program.speed(), point.path_length))
            )
        };
        text.remark(format!("FLUTE {} OF {}", flute + 1, job.flutes));
        let Some((first, rest)) = points.split_first() else { continue };
        text.blocks([
            format!("G00 {}", along('Y', signs.y, clear)),
            format!(
                "{} {} {} C0.",
                along('X', signs.x, first.x),
                along('A', signs.a, start),
                along('B', signs.b, job.helix)
            ),
            along('Y', signs.y, stand_off),
            format!("G01 Y0. F{}", number(job.program.plunge())),
            "G93".to_owned(),
        ]);
        text.blocks(rest.iter().map(cut));
        text.block(format!("G94 G00 {}", along('Y', signs.y, clear)));
    }
}

/// Returns the feed of a move in 1/min. Controls accept three decimals of an inverse-time F.
fn rate(speed: f64, length: f64) -> f64 {
    (1000.0 * speed / length).round().max(1.0) / 1000.0
}

/// Returns the remark on axes that run against the formulas.
fn reversed_axes(job: &Burr) -> String {
    let reversed = signs(job).into_iter().filter(|(_, sign)| *sign < 0);
    let letters: Vec<String> = reversed.map(|(letter, _)| letter.to_string()).collect();
    match letters.is_empty() {
        true => "ALL AXES RUN AS IN THE FORMULAS".to_owned(),
        false => format!("REVERSED AGAINST THE FORMULAS {}", letters.join(" ")),
    }
}

/// Returns the axes with their signs.
fn signs(job: &Burr) -> [(char, i8); 5] {
    let AxisSigns { x, y, a, b, c } = job.grinder.signs();
    [('X', x), ('Y', y), ('A', a), ('B', b), ('C', c)]
}

/// Returns the text of `machine.toml`.
fn machine_file(job: &Burr) -> String {
    let [x, y] = job.grinder.c_offset;
    let signs = job.grinder.signs();
    let contact = y - job.shape.radius;
    let link = |letter: char, moves: &str, sign: i8, centre: &str| {
        format!("[[table]]\nletter = \"{letter}\"\n{moves}\nsign = {sign}\n{centre}\n")
    };
    format!(
        "{}\
         axes = \"XYABC\"\n\
         \n\
         # Machine zero is on the C axis, with X and Y at 0.\n\
         # X and Y slide the table C, which carries the head A, which rotates the burr about its own axis.\n\
         {}{}{}{}\
         # The burr: x along its axis towards the shank, origin where its cylinder ends.\n\
         [part]\n\
         origin = [{x:?}, {y:?}, 0.0]\n\
         \n\
         # Where the wheel touches; B swivels it to the helix angle.\n\
         [wheel]\n\
         contact = [{x:?}, {contact:?}, 0.0]\n\
         letter = \"B\"\n\
         sign = {}\n",
        control::machine_file(job.control),
        link('X', "slides = \"x\"", signs.x, ""),
        link('Y', "slides = \"y\"", signs.y, ""),
        link('C', "turns = \"z\"", signs.c, "centre = [0.0, 0.0, 0.0]\n"),
        link('A', "turns = \"x\"", signs.a, ""),
        signs.b
    )
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
