//! What the operator does at a stop, step by step, in the order in which it has to be done.
use gcode_lang::motion::StopKind;
use gcode_lang::units::Deg;
use gcode_part::job::{Alignment, HeadKind, Job, PinHoles};
use gcode_sim::report::figures::{near, short};

use super::record::OperatorStop;

pub fn duty(job: &Job, stop: &OperatorStop) -> Vec<String> {
    if let (Job::PinHoles(job), StopKind::Message, [(variable, angle)]) =
        (job, stop.kind, stop.named.as_slice())
        && job.machine.head.kind == HeadKind::Manual
        && *variable == job.macros.common
    {
        return set_head(job, *angle);
    }
    if let Job::Alignment(job) = job
        && let Some(steps) = set_up(job, stop)
    {
        return steps;
    }
    let mut steps = Vec::new();
    for (variable, value) in &stop.named {
        steps.push(format!("#{variable} is {} now.", short(*value)));
    }
    steps.push(match stop.kind {
        StopKind::Message => "Do what the message says.".to_owned(),
        StopKind::M00 => "The program waits: do what its remark there asks for.".to_owned(),
        StopKind::M01 => "The program waits where the switch for optional stops is on.".to_owned(),
    });
    steps.push("CYCLE START goes on.".to_owned());
    steps
}

/// The head's angle is the control's rounded one, which the hole's feed then follows.
fn set_head(job: &PinHoles, angle: f64) -> Vec<String> {
    let mut steps = vec![
        "Wait until the spindle stands still; the tool is clear of the part.".to_owned(),
        format!(
            "Set the head to {}° (from X towards Y; 90° is parallel to Y) and clamp it. #{} shows this angle.",
            short(angle),
            job.macros.common
        ),
    ];
    if tip_is_programmed(job) {
        steps.push(
            "Set the tool tip's place again in X and Y: the job has no pivot and no tool lengths, so the programmed \
             point is the tip."
                .to_owned(),
        );
    }
    steps.push("CYCLE START goes on; the program starts spindle and coolant.".to_owned());
    steps
}

/// The stops of the measurements, told by the first variable that they name. Its value isn't shown: the simulated part stands
/// right, and what it leaves there is rounding.
fn set_up(job: &Alignment, stop: &OperatorStop) -> Option<Vec<String>> {
    let (first, _) = stop.named.first()?;
    let steps = match first {
        580 => vec![
            "Read #580 to #583 at the control: the part is off by #580 in X and #581 in Z (mm), and tilted by #582 about X and \
             #583 about Z (degrees)."
                .to_owned(),
            format!(
                "Within limits: #580 and #581 each ±{} mm, #582 and #583 each ±{}°. Then nothing is moved.",
                short(job.limits.shift),
                short(job.limits.tilt)
            ),
            "#580 above 0: the part stands too far towards X+, move it towards X−. #581 above 0: too far towards Z+, move it towards \
             Z−. Below 0 the other way."
                .to_owned(),
            shim(),
            "The tilt #583 is left to O8230, the sine table.".to_owned(),
            "CYCLE START measures again: #580 to #583 then tell what remains, #590 to #593 what was found first.".to_owned(),
        ],
        596 => vec![
            format!(
                "#596 is the angle at which the sine table is taken to stand: {}° for a new part. Compare it with the blocks \
                 that are under the table.",
                short(job.sine_table.phi)
            ),
            "Where it is another one: RESET, write the right angle to #596, start again.".to_owned(),
            "CYCLE START goes on.".to_owned(),
        ],
        587 => vec![
            "Wring blocks to the height #587 (mm) and put them under the table.".to_owned(),
            "Then CYCLE START, and not before: it says that the table is set. #596 becomes its angle, and the tilt is used up."
                .to_owned(),
            "Run O8210 again, for a part that is turned on the table moves; then this program again, until #580 to #583 are \
             within the limits of the readings below."
                .to_owned(),
        ],
        574 => vec![
            format!(
                "Read #574 (mm) and #576 (degrees), which are to be added to Y and {} of the work offset.",
                job.machine.rotary.letter
            ),
            "CYCLE START adds them: nothing is set by hand. RESET keeps them out. The points are used up either way.".to_owned(),
            "X and Z stay as they are: the run-out knows better where the axis is. #573 and #575 say how far marks are aside in them. \
             Where the marks are surer than that, X or Z of G54 isn't on the axis of the rotary: RESET, and set it anew."
                .to_owned(),
        ],
        _ => return None,
    };
    Some(steps)
}

/// The sense of #582 is a right-hand turn about X, which takes Y+ towards Z+. It sinks what lies towards Z+ by its sine.
fn shim() -> String {
    format!(
        "#582 above 0: the top leans towards Z+, so shim the side towards Z+. Below 0: the top leans towards Z−, shim the side towards Z−. A shim \
         is {} mm thick for each 0.01° and metre between the supports in Z. A part that is shimmed moves in Z as well: #581 is corrected \
         after it has been measured again.",
        near(1000.0 * Deg(0.01).sin(), 4)
    )
}

/// X and Y are told the tool's tip, not the head's pivot.
pub fn tip_is_programmed(job: &PinHoles) -> bool {
    job.machine.head.pivot == 0.0 && job.tools.iter().all(|tool| tool.length == 0.0)
}
