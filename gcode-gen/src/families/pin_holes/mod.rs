//! Pin holes on an ellipsoid of revolution: a main program of calls, and resident macros that compute
//! equation (8).
//!
//! The method is that of *Improved Processing Technology of Positioning Pin Hole on Melon Mold*; see
//! `docs/methods/pin-holes.md`. The main program contains no number that follows from a, b, r and the
//! azimuth: changing R moves the hole to its correct new position.
use std::collections::BTreeSet;

use gcode_part::job::{AxisDirection, HeadKind, HoleSpec, PinHoles, Tool};

use super::start::Start;
use super::{Family, Macro, control, package};
use crate::nc::{Block, ProgramText, number};
use crate::order::{HeadSetting, ToolPass, passes};
use crate::package::{Package, Program};

/// O-number of the main program.
const MAIN: u32 = 8100;
/// O-number of the macro for one hole: approach, feed, retract.
const HOLE: u32 = 8101;
/// O-number of the macro that computes the head angle of a radius and sets the head.
const HEAD: u32 = 8102;

const MACROS: &[&[Macro]] = &[&[
    Macro { number: HOLE, file: "O8101_pin_hole.nc", text: include_str!("hole.nc") },
    Macro { number: HEAD, file: "O8102_head_angle.nc", text: include_str!("head.nc") },
]];

pub(super) const FAMILY: Family =
    Family { name: "pin-holes", new_job: include_str!("new.toml"), macros: MACROS };

/// Emits the main program, the resident macros and the machine file of a job.
pub(super) fn emit(job: &PinHoles) -> Package {
    let start = Start {
        control: job.control,
        changed_alarm: 17,
        shifted_alarm: 18,
        axes: "XYZ",
        cancelled_rotaries: job.machine.rotary.letter.to_string(),
    };
    let passes = passes(job);
    let mut text = ProgramText::new(MAIN, "PIN HOLES ON AN ELLIPSOID OF REVOLUTION", job.control.dialect);
    text.remarks(header(job));
    text.remarks(start.remarks());
    let mut named = BTreeSet::new();
    for ToolPass { tool, .. } in &passes {
        if named.insert(tool.number) {
            text.remark(format!("{}{}", tool_remark(tool), length_remark(tool)));
        }
    }
    start.blocks(&mut text);
    let angle_set = job.macros.common + 1;
    text.block(Block::of(format!("#{angle_set}=#0")).comment("HEAD NOT SET YET"));
    for (index, pass) in passes.iter().enumerate() {
        tool_blocks(job, pass, passes.get(index + 1), &mut text);
    }
    text.block(Block::of(format!("#{angle_set}=#0")).comment("HEAD ANGLE NO LONGER VALID"));
    text.block("M30");
    let main = Program { number: MAIN, text: text.finish() };
    package(job.control, vec![main], MACROS, &marks(job), machine_file(job))
}

/// Returns the remarks at the head: conditions for the run.
fn header(job: &PinHoles) -> [String; 19] {
    let (a, b) = (number(job.surface.a), number(job.surface.b));
    let rotary = job.machine.rotary;
    let head = match job.machine.head.kind() {
        HeadKind::Manual => "SET BY HAND AT A STOP".to_owned(),
        HeadKind::Axis(letter) => format!("MOVED AS AXIS {letter}"),
    };
    let common = job.macros.common;
    let k = control::alarm_thousands(job.control.dialect);
    [
        format!("HOLES {}, SURFACE [X*X+Z*Z]/A/A+Y*Y/B/B = 1, A {a} B {b}", job.holes.len()),
        "NUMBERS ARE MILLIMETRES AND DEGREES, FEEDS MM/MIN".to_owned(),
        control::machine_remark(job.control),
        "WORK ZERO G54 IS THE CENTRE OF THE ELLIPSOID, Y ITS AXIS".to_owned(),
        format!("ROTARY {}, FROM X TOWARDS Z", control::rotary_command(rotary, "AZIMUTH")),
        format!("HEAD ANGLE FROM X TOWARDS Y, {head}"),
        format!("CALLS O{HEAD} HEAD ANGLE OF A RADIUS, AND O{HOLE} ONE HOLE"),
        "THEY COMPUTE EQUATION 8 OF IMPROVED PROCESSING TECHNOLOGY OF".to_owned(),
        "POSITIONING PIN HOLE ON MELON MOLD FROM A, B AND R".to_owned(),
        format!("TO MOVE A HOLE CHANGE R OR W IN ITS O{HOLE} CALLS AND R IN THE"),
        format!("O{HEAD} CALL ABOVE, WHERE THE HEAD DOES NOT SUIT A HOLE O{HOLE}"),
        format!("CALLS O{HEAD} ITSELF BEFORE IT CUTS"),
        "A EQUATORIAL RADIUS, B POLAR RADIUS, C CLEARANCE, D DEPTH".to_owned(),
        "E FEED OUT, F FEED IN, H 0. NORMAL 1. AXIAL, K PECK, Q PIVOT TO TIP".to_owned(),
        format!("R RADIUS, T TOOL DIAMETER, U SIGN OF {}, V RETRACT, W AZIMUTH", rotary.letter),
        format!("COMMON VARIABLES #{common} HEAD ANGLE TO SET, #{} ANGLE SET", common + 1),
        "M06 COMES AT Y = B+Q+V, CLEAR OF THE PART, WITH THE SPINDLE STOPPED".to_owned(),
        format!("ALARMS {k}001-{k}020 BY O{HOLE}, {k}021-{k}030 BY O{HEAD}"),
        "START WITH THE TOOL CLEAR OF THE PART, ABOVE OR BESIDE IT".to_owned(),
    ]
}

/// Returns the length of a tool and its depth and peck where it has any.
fn length_remark(tool: &Tool) -> String {
    let lengths = [
        (" LENGTH ", Some(tool.length).filter(|length| *length != 0.0)),
        (" DEPTH ", tool.depth),
        (" PECK ", tool.peck),
    ];
    let words = lengths.into_iter().filter_map(|(name, value)| Some(format!("{name}{}", number(value?))));
    words.collect()
}

fn tool_remark(tool: &Tool) -> String {
    format!("T{} {} DIAMETER {}", tool.number, tool.name(), number(tool.diameter))
}

/// Writes the blocks of one tool, from its change to the position clear of the part.
fn tool_blocks(job: &PinHoles, pass: &ToolPass<'_>, next: Option<&ToolPass<'_>>, text: &mut ProgramText) {
    let tool = pass.tool;
    text.remark(tool_remark(tool));
    text.block(format!("T{} M06", tool.number));
    // Without lengths only the operator knows where the new tip is, and no stop for the head follows.
    if job.is_tip_programmed() && pass.settings.first().is_some_and(|setting| setting.is_head_set) {
        text.block(Block::of("M00").comment("SET THE TIP AGAIN IN X AND Y, HEAD AS IT IS"));
    }
    text.blocks([format!("S{:.0} M03", tool.speed), "M08".to_owned()]);
    for setting in &pass.settings {
        if !setting.is_head_set {
            text.block(head_call(job, tool, setting));
        }
        text.blocks(setting.holes.iter().map(|hole| hole_call(job, tool, hole)));
    }
    text.block("M09");
    // The tip is then at least V above the pole, whatever the angle of the head: see O8102. This includes
    // the next tool, which may be longer.
    let longest = next.map_or(0.0, |next| reach(job, next.tool)).max(reach(job, tool));
    let height = [job.surface.b, longest, job.machine.retract()].map(number);
    text.block(Block::of(format!("G90 G00 Y[{}]", height.join("+"))).comment("B+Q+V, CLEAR OF THE PART"));
    text.block("M05");
}

/// Returns the distance from the head's pivot to the tip.
fn reach(job: &PinHoles, tool: &Tool) -> f64 {
    job.machine.head.pivot + tool.length
}

fn head_call(job: &PinHoles, tool: &Tool, setting: &HeadSetting<'_>) -> Block {
    let arguments = [
        ('A', job.surface.a),
        ('B', job.surface.b),
        ('R', setting.radius),
        ('H', axial_flag(setting.axis)),
        ('Q', reach(job, tool)),
        ('V', job.machine.retract()),
    ];
    Block::call(HEAD, arguments).comment("HEAD")
}

fn hole_call(job: &PinHoles, tool: &Tool, hole: &HoleSpec) -> Block {
    let (program, arguments) = hole_arguments(job, tool, hole);
    Block::call(program, arguments).comment(format!("HOLE {}", hole.id))
}

/// Returns the macro of one hole, and its arguments.
pub(crate) fn hole_arguments(job: &PinHoles, tool: &Tool, hole: &HoleSpec) -> (u32, Vec<(char, f64)>) {
    let mut arguments = vec![
        ('A', job.surface.a),
        ('B', job.surface.b),
        ('R', hole.radius),
        ('W', hole.azimuth),
        ('H', axial_flag(hole.axis)),
        ('D', tool.depth_in(hole)),
        ('C', job.machine.clearance()),
        ('V', job.machine.retract()),
        ('F', tool.feed),
        ('E', tool.retract_feed()),
        ('T', tool.diameter),
        ('U', f64::from(job.machine.rotary.sign)),
        ('Q', reach(job, tool)),
    ];
    arguments.extend(tool.peck.map(|peck| ('K', peck)));
    (HOLE, arguments)
}

/// Returns the argument H.
fn axial_flag(axis: AxisDirection) -> f64 {
    match axis {
        AxisDirection::Normal => 0.0,
        AxisDirection::Axial => 1.0,
    }
}

/// Returns the marks of the macros. A common variable holds the head angle to be set; the next one holds the
/// angle that is set, and is vacant until then.
fn marks(job: &PinHoles) -> [(&'static str, String); 5] {
    let common = job.macros.common;
    let (set_head, spindle_note) = match job.machine.head.kind() {
        HeadKind::Manual => (
            format!("M09\nM05\n#3006=1(SET HEAD TO ANGLE IN #{common})\nM03\nM08"),
            "\n(STOPS SPINDLE AND COOLANT FOR THE OPERATOR, THEN M03 M08)",
        ),
        HeadKind::Axis(letter) => (format!("G90 G00 {letter}#{common}"), ""),
    };
    [
        ("{rotary}", job.machine.rotary.letter.to_string()),
        ("{angle}", common.to_string()),
        ("{set}", (common + 1).to_string()),
        ("{set_head}", set_head),
        ("{spindle_note}", spindle_note.to_owned()),
    ]
}

/// Returns the text of `machine.toml`.
fn machine_file(job: &PinHoles) -> String {
    let head = job.machine.head;
    let kind = match head.kind() {
        HeadKind::Manual => "kind = \"manual\"".to_owned(),
        HeadKind::Axis(letter) => format!("kind = \"axis\"\nletter = \"{letter}\""),
    };
    let tool = |tool: &Tool| {
        let Tool { number, length, diameter, .. } = tool;
        format!("\n[[tool]]\nnumber = {number}\nlength = {length:?}\ndiameter = {diameter:?}\n")
    };
    format!(
        "{}{}\n\
         # The head tilts the tool in the xy plane; its angle counts from x towards y.\n\
         [head]\n\
         {kind}\n\
         pivot = {:?}\n\
         {}",
        control::machine_file(job.control),
        control::rotary_table(job.machine.rotary, 'y', "its axis goes through the part's origin"),
        head.pivot,
        job.tools.iter().map(tool).collect::<String>()
    )
}
