//! The sine table: the gauge blocks that set φ, and on the control their change for the tilt that the run-out
//! determined.
//!
//! The macro gives the height, not the blocks. The fewest blocks of a set need a search through all stacks,
//! which is done here for the job's φ; for the corrected angle the operator chooses them by the digits of the
//! height, last digit first, as usual.
use gcode_lang::units::{Deg, Mm};
use gcode_part::gauge::{self, SineSetting, Thickness};
use gcode_part::job::{Alignment, SineTable};

use super::writes::Writes;
use super::{Macro, Measurement};
use crate::families::control;
use crate::nc::block::Block;
use crate::nc::number::number;
use crate::nc::program::Program as Text;

/// O-number of the main program.
pub const MAIN: u32 = 8230;

/// Largest tilt that O8231 corrects, degrees.
pub const LARGEST_TILT: f64 = 1.0;
/// Largest φ that O8231 gives, degrees.
pub const STEEPEST: f64 = 45.0;

/// O-number of the macro that computes height and angle.
const TABLE: u32 = 8231;

pub(super) const MEASUREMENT: Measurement = Measurement {
    main: MAIN,
    title: "SINE TABLE OF A PART TO BE SET UP",
    write,
    macros: &[Macro {
        number: TABLE,
        file: "O8231_sine_table.nc",
        text: include_str!("sine.nc"),
        writes: Writes(&[(586, 589)]),
    }],
    writes: Writes(&[(583, 583), (596, 596)]),
};

fn write(job: &Alignment, text: &mut Text) {
    let table = &job.sine_table;
    let k = control::alarm_thousands(job.control.dialect);
    let [phi, length] = [table.phi, table.length].map(number);
    let set = table.gauge_blocks;
    let setting = gauge::sine_setting(Mm(table.length), Deg(table.phi), &set);
    text.remark(format!("L {length} PHI {phi}, H = L*SIN[PHI] = {:.5}", setting.height.0));
    text.remark(format!("GAUGE BLOCKS {}", set.name));
    for line in stack(&setting) {
        text.remark(line);
    }
    for line in [
        "AFTER O8210 HAS FOUND THE TILT #583 THIS PROGRAM GIVES".to_owned(),
        "#586 PHI TO SET, #587 HEIGHT OF THE BLOCKS, #588 ITS CHANGE".to_owned(),
        "#589 ERROR OF #587 IN SECONDS OF ARC".to_owned(),
    ] {
        text.remark(line);
    }
    if gap(table).is_some() {
        text.remark("NOT EVERY H SO LOW HAS A STACK. WHERE #587 HAS NONE SET BLOCKS UNDER");
        text.remark("BOTH ROLLERS, #587 IS BY HOW MUCH THEY DIFFER");
    }
    for line in [
        "#596 IS PHI AS THE TABLE IS SET, VACANT AT FIRST, THEN IT IS".to_owned(),
        format!("{phi}. IF THE TABLE IS SET DIFFERENTLY WRITE IT THERE"),
        "THE FIRST STOP ASKS WHETHER IT IS RIGHT, IF NOT RESET AND WRITE IT".to_owned(),
        "CYCLE START AT THE SECOND SAYS THAT THE TABLE IS SET, #596 IS CHANGED".to_owned(),
        "AND #583 IS USED UP. THEN O8210 AGAIN".to_owned(),
        "BELOW 0 #596 SAYS THAT RESET CAME WHILE IT WAS CHANGED. WRITE THE".to_owned(),
        "ANGLE OF THE BLOCKS TO IT".to_owned(),
        format!("CONTROL {}", control::remark(job.control)),
        format!("CALLS O{TABLE}, ALARMS {k}161-{k}169. NOTHING MOVES"),
    ] {
        text.remark(line);
    }
    text.block(Block::of(format!("IF[#596 EQ #0]THEN #596={phi}")));
    text.block(Block::of("IF[#596 LT 0]THEN #3000=169(SET #596, PHI OF THE TABLE)"));
    text.block(
        Block::call(TABLE)
            .word('A', "#596")
            .word('B', &length)
            .word('C', number(set.step().mm()))
            .word('U', number(f64::from(table.sign)))
            .comment("SINE TABLE"),
    );
    text.block(Block::of("#3006=1(TABLE STANDS AT PHI #596)"));
    text.block(Block::of("#3006=1(SET BLOCKS TO H #587)"));
    // RESET leaves the state before, the state after, or one that the next start refuses.
    text.block(Block::of("#596=-1."));
    text.block(Block::of("#583=#0"));
    text.block(Block::of(format!("#596=ASIN[#587/{length}]")));
    text.block(Block::of("M30"));
}

/// Returns the lowest height within the tilts that O8231 corrects for which the set has no stack.
pub fn gap(table: &SineTable) -> Option<Thickness> {
    let [low, high] = [-LARGEST_TILT, LARGEST_TILT]
        .map(|tilt| gauge::height(Mm(table.length), Deg((table.phi + tilt).clamp(0.0, STEEPEST))));
    table.gauge_blocks.first_gap(low, high)
}

/// Returns the blocks in lines that a control can show, and the error of the angle. Jobs without a sufficient
/// stack are refused.
fn stack(setting: &SineSetting) -> Vec<String> {
    if setting.stack.blocks.is_empty() {
        return vec!["NO BLOCKS, THE TABLE LIES FLAT".to_owned()];
    }
    let names: Vec<_> = setting.stack.blocks.iter().map(ToString::to_string).collect();
    let mut lines: Vec<_> = names.chunks(8).map(|names| format!("BLOCKS {}", names.join(" + "))).collect();
    let over = if setting.remainder < 0.0 { "TOO LITTLE" } else { "TOO MUCH" };
    lines.push(format!("THEY MAKE {:.2} SECONDS OF ARC {over}", setting.remainder.abs()));
    lines
}
