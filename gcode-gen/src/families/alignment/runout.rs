//! Run-out: touches the part along X at two heights over the petal's angles and fits its shift and tilt on
//! the control. After the operator's correction a second pass measures the remainder.
use gcode_part::job::Alignment;

use super::{Macro, Measurement, begin, common_remarks, control, number};
use crate::nc::{Block, ProgramText};

/// O-number of the main program.
pub(crate) const MAIN: u32 = 8210;

/// O-number of the macro with readings and fit.
pub(super) const FIT: u32 = 8211;

pub(super) const MEASUREMENT: Measurement =
    Measurement { main: MAIN, title: "RUN-OUT OF A PART TO BE SET UP", write, macros: MACROS };

pub(super) const MACROS: &[Macro] =
    &[Macro { number: FIT, file: "O8211_run_out.nc", text: include_str!("runout.nc") }];

fn write(job: &Alignment, text: &mut ProgramText) {
    let rotary = job.machine.rotary.letter;
    let runout = &job.runout;
    let k = control::alarm_thousands(job.control.dialect);
    let [low, high] = runout.heights.map(number);
    let [from, to] = [runout.angles.from, runout.angles.to].map(number);
    text.remark(format!(
        "{} READINGS FROM {rotary}{from} TO {rotary}{to} AT Y {low} AND Y {high}",
        runout.angles.count
    ));
    common_remarks(job, text);
    text.remarks([
        format!("CALLS O{FIT} TWICE, BETWEEN THEM A STOP TO CORRECT THE PART"),
        "#580 #581 SHIFT OF THE PART IN X AND Z, #582 #583 ITS TILT ABOUT".to_owned(),
        "X AND Z, OF THE LAST PASS".to_owned(),
        "#584 ITS SHIFT IN Y, LESS ACCURATE. #585 RESIDUAL OF THE FIT".to_owned(),
        "#590-#595 THE SAME OF THE FIRST PASS".to_owned(),
        format!("AT THE STOP, AT {rotary}0., THE PART IS MOVED BACK BY #580 #581 AND"),
        "SHIMMED BACK BY #582, THE TILT #583 IS LEFT TO O8230. CYCLE START".to_owned(),
        "MEASURES AGAIN".to_owned(),
        format!("ALARMS {k}138-{k}160 BY O{FIT}"),
        format!("START WITH THE BALL ABOVE THE POLE OF THE PART OR AT +X, {rotary} FREE TO"),
        "TURN".to_owned(),
    ]);
    begin(job, text);
    // These values are of the previous part; the first to be cleared are those that mark a pass as complete.
    for number in [585].into_iter().chain((590..596).rev()) {
        text.block(format!("#{number}=#0"));
    }
    text.block(pass(job).comment("FIRST PASS"));
    for of_pass in 0..6 {
        text.block(format!("#{}=#{}", 590 + of_pass, 580 + of_pass));
    }
    text.block(format!("#3006=1(PART OFF #580-#583 AT {rotary}0)"));
    text.block(pass(job).comment("WHAT REMAINS"));
    text.block("M30");
}

fn pass(job: &Alignment) -> Block {
    let runout = &job.runout;
    let [low, high] = runout.heights;
    let arguments = [
        ('A', job.surface.a),
        ('B', job.surface.b),
        ('R', job.probe.radius),
        ('I', low),
        ('J', high),
        ('D', runout.angles.from),
        ('E', runout.angles.to),
        ('H', f64::from(runout.angles.count)),
        ('F', job.probe.feed),
        ('V', job.probe.search),
        ('U', f64::from(job.machine.rotary.sign)),
        ('W', job.probe_noise()),
        ('T', runout.y_shift),
    ];
    Block::call(FIT, arguments)
}
