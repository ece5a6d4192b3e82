//! The sine table: the gauge blocks that set φ, and on the control their change for the tilt that the run-out
//! determined.
//!
//! The macro gives the height, not the blocks. The fewest blocks of a set need a search through all stacks,
//! which is done here for the job's φ; for the corrected angle the operator chooses them by the digits of the
//! height, last digit first, as usual.
use gcode_lang::units::{Deg, Mm};
use gcode_part::gauge::{self, SineSetting, Thickness};
use gcode_part::job::{Alignment, SineTable};

use super::{Macro, Measurement, control, number};
use crate::nc::{Block, ProgramText};

/// O-number of the main program.
pub(crate) const MAIN: u32 = 8230;

/// Largest tilt that O8231 corrects, degrees.
pub(crate) const LARGEST_TILT: f64 = 1.0;
/// Largest φ that O8231 gives, degrees.
pub(crate) const STEEPEST: f64 = 45.0;

/// O-number of the macro that computes height and angle.
pub(super) const TABLE: u32 = 8231;

pub(super) const MEASUREMENT: Measurement =
    Measurement { main: MAIN, title: "SINE TABLE OF A PART TO BE SET UP", write, macros: MACROS };

pub(super) const MACROS: &[Macro] =
    &[Macro { number: TABLE, file: "O8231_sine_table.nc", text: include_str!("sine.nc") }];

fn write(job: &Alignment, text: &mut ProgramText) {
    let table = &job.sine_table;
    let k = control::alarm_thousands(job.control.dialect);
    let [phi, length] = [table.phi, table.length].map(number);
    let set = table.gauge_blocks;
    let setting = gauge::sine_setting(Mm(table.length), Deg(table.phi), &set);
    text.remark(format!("L {length} PHI {phi}, H = L*SIN[PHI] = {:.5}", setting.height.0));
    text.remark(format!("GAUGE BLOCKS {}", set.name));
    text.remarks(stack(&setting));
    text.remarks([
        "AFTER O8210 HAS FOUND THE TILT #583 THIS PROGRAM GIVES".to_owned(),
        "#586 PHI TO SET, #587 HEIGHT OF THE BLOCKS, #588 ITS CHANGE".to_owned(),
        "#589 ERROR OF #587 IN SECONDS OF ARC".to_owned(),
    ]);
    if gap(table).is_some() {
        text.remarks([
            "NOT EVERY H SO LOW HAS A STACK. WHERE #587 HAS NONE SET BLOCKS UNDER",
            "BOTH ROLLERS, #587 IS BY HOW MUCH THEY DIFFER",
        ]);
    }
    text.remarks([
        "#596 IS PHI AS THE TABLE IS SET, VACANT AT FIRST, THEN IT IS".to_owned(),
        format!("{phi}. IF THE TABLE IS SET DIFFERENTLY WRITE IT THERE"),
        "THE FIRST STOP ASKS WHETHER IT IS RIGHT, IF NOT RESET AND WRITE IT".to_owned(),
        "CYCLE START AT THE SECOND SAYS THAT THE TABLE IS SET, #596 IS CHANGED".to_owned(),
        "AND #583 IS USED UP. THEN O8210 AGAIN".to_owned(),
        "BELOW 0 #596 SAYS THAT RESET CAME WHILE IT WAS CHANGED. WRITE THE".to_owned(),
        "ANGLE OF THE BLOCKS TO IT".to_owned(),
        control::remark(job.control),
        format!("CALLS O{TABLE}, ALARMS {k}161-{k}169. NOTHING MOVES"),
    ]);
    let call = Block::call(TABLE, []).word('A', "#596");
    let call = call.numbers([('B', table.length), ('C', set.step().mm()), ('U', f64::from(table.sign))]);
    text.block(format!("IF[#596 EQ #0]THEN #596={phi}"));
    text.block("IF[#596 LT 0]THEN #3000=169(SET #596, PHI OF THE TABLE)");
    text.block(call.comment("SINE TABLE"));
    text.blocks(["#3006=1(TABLE STANDS AT PHI #596)", "#3006=1(SET BLOCKS TO H #587)"]);
    // RESET leaves the state before, the state after, or one that the next start refuses.
    text.blocks(["#596=-1.", "#583=#0"]);
    text.blocks([format!("#596=ASIN[#587/{length}]"), "M30".to_owned()]);
}

/// Returns the lowest height within the tilts that O8231 corrects for which the set has no stack.
pub(crate) fn gap(table: &SineTable) -> Option<Thickness> {
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
