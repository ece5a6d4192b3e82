//! The operator's actions at a stop, step by step.
use gcode_lang::motion::StopKind;
use gcode_lang::units::Deg;
use gcode_part::job::{Alignment, HeadKind, Job, PinHoles};
use gcode_sim::report::figures::{rounded, short};

use super::record::OperatorStop;

pub(super) fn instructions(job: &Job, stop: &OperatorStop) -> Vec<String> {
    if let (Job::PinHoles(job), StopKind::Message, [(variable, angle)]) =
        (job, stop.kind, stop.variables.as_slice())
        && job.machine.head.kind() == HeadKind::Manual
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
    for (variable, value) in &stop.variables {
        steps.push(format!("#{variable} is {} now.", short(*value)));
    }
    steps.push(match stop.kind {
        StopKind::Message => "Follow the message.".to_owned(),
        StopKind::M00 => "The program waits: follow its comment there.".to_owned(),
        StopKind::M01 => "The program waits if the optional stop switch is on.".to_owned(),
    });
    steps.push("CYCLE START continues.".to_owned());
    steps
}

/// Returns the steps to set the head. The angle is the control's rounded one, which the hole's feed then
/// follows.
fn set_head(job: &PinHoles, angle: f64) -> Vec<String> {
    let mut steps = vec![
        "Wait until the spindle has stopped; the tool is clear of the part.".to_owned(),
        format!(
            "Set the head to {}° (from X towards Y; 90° is parallel to Y) and clamp it. #{} shows this angle.",
            short(angle),
            job.macros.common
        ),
    ];
    if job.is_tip_programmed() {
        steps.push(
            "Set the tool tip's position again in X and Y: the job has no pivot and no tool lengths, so \
             the programmed point is the tip."
                .to_owned(),
        );
    }
    steps.push("CYCLE START continues; the program starts spindle and coolant.".to_owned());
    steps
}

/// Returns the steps at a stop of the measurements, recognised by the first variable that it names. Its value
/// is not shown: the simulated part is in its nominal position, and the value is a rounding error.
fn set_up(job: &Alignment, stop: &OperatorStop) -> Option<Vec<String>> {
    let (first, _) = stop.variables.first()?;
    let steps = match first {
        580 => vec![
            "Read #580 to #583 at the control: the part is off by #580 in X and #581 in Z (mm), and tilted by #582 about X and \
             #583 about Z (degrees)."
                .to_owned(),
            format!(
                "Limits: #580 and #581 each ±{} mm, #582 and #583 each ±{}°. Within them nothing is moved.",
                short(job.limits().shift),
                short(job.limits().tilt)
            ),
            "#580 above 0: the part is too far towards X+, move it towards X−. #581 above 0: too far \
             towards Z+, move it towards Z−. Below 0: the opposite direction."
                .to_owned(),
            shim(),
            "The tilt #583 is corrected later by O8230, the sine table.".to_owned(),
            "CYCLE START measures again: #580 to #583 are then the remaining values, #590 to #593 the \
             first ones.".to_owned(),
        ],
        596 => vec![
            format!(
                "#596 is the assumed angle of the sine table: {}° for a new part. Compare it with the \
                 blocks under the table.",
                short(job.sine_table.phi)
            ),
            "If it differs: RESET, write the right angle to #596, start again.".to_owned(),
            "CYCLE START continues.".to_owned(),
        ],
        587 => vec![
            "Wring blocks to the height #587 (mm) and put them under the table.".to_owned(),
            "Then CYCLE START, and not before: it confirms that the table is set. #596 becomes its angle, \
             and the tilt is used up."
                .to_owned(),
            "Run O8210 again, because a part that rotates on the table moves; then this program again, \
             until #580 to #583 are within the limits of the readings below."
                .to_owned(),
        ],
        574 => vec![
            format!(
                "Read #574 (mm) and #576 (degrees), which will be added to Y and {} of the work offset.",
                job.machine.rotary.letter
            ),
            "CYCLE START adds them: nothing is set by hand. RESET discards them. The points are used up \
             either way.".to_owned(),
            "X and Z are unchanged: the run-out gives the axis more accurately. #573 and #575 are the \
             offsets of the marks in X and Z. If the marks are more accurate than that, X or Z of G54 is \
             not on the rotary axis: RESET, and set it again."
                .to_owned(),
        ],
        _ => return None,
    };
    Some(steps)
}

/// Returns the step with the shims. #582 is a right-hand rotation about X, which takes Y+ towards Z+ and
/// lowers the side towards Z+ by its sine.
fn shim() -> String {
    format!(
        "#582 above 0: the top leans towards Z+, so shim the side towards Z+. Below 0: the top leans \
         towards Z−, shim the side towards Z−. A shim is {} mm thick for each 0.01° and metre between the \
         supports in Z. A shimmed part also moves in Z: correct #581 after the next measurement.",
        rounded(1000.0 * Deg(0.01).sin(), 4)
    )
}
