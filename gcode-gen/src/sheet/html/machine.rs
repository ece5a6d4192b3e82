//! Set-up of the machine: the tools, the sequence of head angles, the control settings.
use gcode_inspect::verify::Verdict;
use gcode_lang::units::Deg;
use gcode_part::job::{HeadKind, Job, PatternTool, PinHoles};
use gcode_sim::report::figures::short;
use maud::{Markup, html};

use super::alignment::overwritten_variables;
use super::{blank, cell, table};
use crate::check::PackageVerdict;
use crate::order::passes;
use crate::sheet::Sheet;
use crate::sheet::settings::MAX_BLOCKS;

pub(super) fn tools(sheet: &Sheet<'_>) -> Markup {
    let row = |number: String, name: &str, diameter: f64, length: Markup, speed: f64, feed: String| {
        vec![cell(number), cell(name), cell(short(diameter)), length, cell(short(speed)), cell(feed), blank()]
    };
    let rows: Vec<_> = match sheet.job {
        Job::PinHoles(job) => job
            .tools
            .iter()
            .filter(|tool| sheet.record.tools.contains(&tool.number))
            .map(|tool| {
                let length = if job.is_tip_programmed() {
                    html! { "–" }
                } else {
                    cell(short(tool.length))
                };
                let more = |word: &str, value: Option<f64>| {
                    value.map_or_else(String::new, |value| format!(", {word} {}", short(value)))
                };
                let (peck, depth) = (more("pecks of", tool.peck), more("only to depth", tool.depth));
                let feed =
                    format!("{} in, {} out{peck}{depth}", short(tool.feed), short(tool.retract_feed()));
                row(format!("T{}", tool.number), &tool.name(), tool.diameter, length, tool.speed, feed)
            })
            .collect(),
        Job::Honeycomb(job) => {
            let drill = &job.drill;
            let length = html! { "measured, in H" (drill.number()) };
            vec![row(
                format!("T{}", drill.number()),
                "DRILL",
                drill.diameter,
                length,
                drill.speed(),
                short(drill.feed()),
            )]
        }
        Job::Pattern(job) => {
            let of = |tool: &PatternTool| {
                let length = html! { "measured, in H" (tool.number) };
                let feed = match tool.feed() {
                    Some(feed) => short(feed),
                    None => format!("pitch {}", short(tool.increment())),
                };
                row(format!("T{}", tool.number), &tool.name(), tool.diameter, length, tool.speed, feed)
            };
            job.tools.iter().map(of).collect()
        }
        Job::Alignment(job) => {
            let ball = short(2.0 * job.probe.radius);
            let row = |tool: &str, name: &str, speed: Markup, feed: String| {
                vec![cell(tool), cell(name), cell(&ball), cell("measured"), speed, cell(feed), blank()]
            };
            let touch = format!(
                "{} per touch, within {} of the surface",
                short(job.probe.feed),
                short(job.probe.search)
            );
            let along = format!(
                "{} from {} in front of the surface on and along it",
                short(job.ellipse().feed),
                short(job.machine.clearance())
            );
            vec![
                row("O8210, O8200", "TOUCH PROBE, stylus ball", html! { "stands" }, touch),
                row("O8220", "3D EDGE FINDER, ball", html! { "stopped (M05)" }, along),
            ]
        }
        Job::Burr(job) => {
            let program = job.program;
            let feed = format!(
                "{} along the flute, {} into the blank",
                short(program.speed()),
                short(program.plunge())
            );
            vec![vec![
                cell("wheel"),
                cell("GRINDING WHEEL"),
                blank(),
                blank(),
                cell(short(program.wheel())),
                cell(feed),
                blank(),
            ]]
        }
    };
    html! {
        div.together {
            h2 { "Tools" }
            (table(&["tool", "name", "#diameter", "#length", "#r/min", "feed", "holder, note"], rows))
            @if let Job::Alignment(job) = sheet.job {
                p.note {
                    "Both balls have the job's diameter, " (short(2.0 * job.probe.radius)) " mm: a smaller or larger one appears as a shift and a tilt that do not exist. "
                    "The ball's centre is the reference: calibrate the probe so that #5061 to #5063 are its centre at the touch. No length offset: G49."
                }
            }
            @if let Job::PinHoles(job) = sheet.job {
                @if job.is_tip_programmed() {
                    p.note { "No tool lengths in this job: X and Y are the tip, whose position is set again after each rotation of the head." }
                } @else {
                    p.note { "Lengths are from the spindle's gauge line to the tip; the head's pivot is " (short(job.machine.head.pivot)) " mm from the gauge line. The program includes them: no G43." }
                }
            }
        }
    }
}

/// Returns the sequence of head settings with their holes, for pin holes only.
pub(super) fn head_angles(sheet: &Sheet<'_>) -> Markup {
    let (Job::PinHoles(job), PackageVerdict::Holes(verdict)) = (sheet.job, &sheet.checked.verdict) else {
        return html! {};
    };
    let by = match job.machine.head.kind() {
        HeadKind::Manual => "set by hand at an operator stop".to_owned(),
        HeadKind::Axis(letter) => format!("moved by the program as axis {letter}"),
    };
    let rows = settings_of(job, verdict).into_iter().enumerate().map(|(index, setting)| {
        vec![
            html! { (index + 1) },
            html! { "T" (setting.tool) },
            cell(match (setting.angle, setting.is_head_set) {
                (None, _) => "-".to_owned(),
                (Some(angle), false) => short(angle),
                (Some(angle), true) => format!("{} as before", short(angle)),
            }),
            cell(short(setting.radius)),
            cell(setting.holes.join(", ")),
        ]
    });
    html! {
        div.together {
            h2 { "Head angles in order" }
            p { "The head's angle counts from X towards Y; 90 is parallel to Y. It is " (by) "." }
            (table(&["#setting", "tool", "#head angle, °", "#radius of the holes", "holes, in their order"], rows))
        }
    }
}

struct Setting {
    tool: u32,
    /// Angle of the holes in the simulation, degrees.
    angle: Option<f64>,
    radius: f64,
    holes: Vec<String>,
    is_head_set: bool,
}

fn settings_of(job: &PinHoles, verdict: &Verdict) -> Vec<Setting> {
    let angle = |id: &str| {
        let hole = verdict.holes.iter().find(|hole| hole.id == id)?;
        let [x, y, z] = hole.actual.axis;
        // In the plane z = 0, to which the table rotates it; rounded like the angle that was set.
        let angle = Deg::atan2(y, (x * x + z * z).sqrt()).0;
        Some(job.control.increment.round(angle))
    };
    let mut all = Vec::new();
    for pass in passes(job) {
        for setting in pass.settings {
            all.push(Setting {
                tool: pass.tool.number,
                angle: setting.holes.first().and_then(|hole| angle(&hole.id)),
                radius: setting.radius,
                is_head_set: setting.is_head_set,
                holes: setting.holes.iter().map(|hole| hole.id.clone()).collect(),
            });
        }
    }
    all
}

/// Returns the control settings on which the numbers of this sheet depend.
pub(super) fn settings(sheet: &Sheet<'_>) -> Markup {
    let [slide, turn] = sheet.record.rapids;
    let codes: Vec<String> = sheet.record.auxiliary_codes.iter().map(|code| format!("M{code:02}")).collect();
    html! {
        div.together {
            h2 { "Control requirements" }
            ul {
                li { "The control family and the least increment are at the head of this sheet." }
                li { "Rapid rates (1420) are assumed as " (short(slide)) " mm/min and " (short(turn)) " degrees/min; only the run time depends on them." }
                (needed(sheet))
                @if let Job::Alignment(job) = sheet.job { (overwritten_variables(job)) }
                @if !codes.is_empty() {
                    li { (codes.join(", ")) ": M codes of the machine builder. Their effect here is not simulated; try them by MDI before the run." }
                }
            }
        }
    }
}

/// Returns the switches that the programs depend on.
fn needed(sheet: &Sheet<'_>) -> Markup {
    let (needed, waiting) = (&sheet.required_settings, &sheet.record.alarmed_programs);
    html! {
        @for one in needed {
            li {
                b { (one.key) " = " (one.value) } " (" (one.meaning) "): with the other value " (one.consequence) "."
            }
        }
        @if sheet.package.mains.len() > waiting.len() {
          li {
            "All settings in which controls differ (" code { "gcode-sim settings" } " lists them) were changed one by one: "
            @if needed.is_empty() { "none" } @else { "no other" }
            " changes what the first " (MAX_BLOCKS) " blocks of a run do."
            @if !waiting.is_empty() {
                " Not tried with " (waiting.join(", ")) ", which ends in an alarm on a part in its nominal position."
            }
          }
        }
    }
}
