//! What the operator does at a stop, step by step, in the order in which it has to be done.
use gcode_sim::job::{HeadKind, Job, PinHoles};
use gcode_sim::motion::StopKind;
use gcode_sim::report::figures::short;

use super::record::Stop;

pub fn duty(job: &Job, stop: &Stop) -> Vec<String> {
    if let (Job::PinHoles(job), StopKind::Message, [(variable, angle)]) =
        (job, stop.kind, stop.named.as_slice())
        && job.machine.head.kind == HeadKind::Manual
        && *variable == job.macros.common
    {
        return set_head(job, *angle);
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

/// X and Y are told the tool's tip, not the head's pivot.
pub fn tip_is_programmed(job: &PinHoles) -> bool {
    job.machine.head.pivot == 0.0 && job.tools.iter().all(|tool| tool.length == 0.0)
}
