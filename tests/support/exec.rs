//! Cases of kinds `exec` and `alarm`: the events of a run, block by block, and its end.
//!
//! `case.nc` is run; the snapshot `events` has a line per event with the line of its block. `expect.txt`, where there
//! is one, is the end as it was worked out by hand, in the words of [`crate::expect`].
use std::fmt::Write as _;

use gcode_control::{AlarmStop, Outcome};
use gcode_lang::motion::{Call, EventKind, LengthCompensation};
use gcode_lang::source::Span;

use crate::Case;
use crate::expect::{self, Ran};

/// Compares the events with `events.snap`.
pub(crate) fn run(case: &Case) {
    let program = case.bytes("case.nc");
    let ran = expect::run(&program);
    let wrong: Vec<String> = case
        .optional("expect.txt")
        .iter()
        .flat_map(|e| ran.differences(&e.trim().replace('\n', "; ")))
        .collect();
    assert!(wrong.is_empty(), "{}: {wrong:#?}", case.name());
    case.snapshot("events", &shown(&ran));
}

/// The same, and the run must end in the alarm whose code begins the folder's name.
pub(crate) fn alarm(case: &Case) {
    run(case);
    let code = case.dir.file_name().unwrap().to_str().unwrap().split('_').next().unwrap().to_uppercase();
    let ran = expect::run(&case.bytes("case.nc"));
    let found = match ran.outcome {
        Outcome::Alarm(stopped) => stopped.alarm.code().to_string(),
        Outcome::End | Outcome::Limit => "no alarm".into(),
    };
    assert_eq!(found, code, "{}", case.name());
}

fn shown(ran: &Ran) -> String {
    let mut text = String::new();
    // Of the axes that are unknown only those at machine coordinates are shown.
    let mut at_machine_position = 0;
    for (span, kind, _) in &ran.recorder.0 {
        // The tool change shows the tool.
        if let EventKind::ToolSelected { .. } | EventKind::Start { .. } = kind {
            continue;
        }
        if let EventKind::PositionUnknown { axes } = kind {
            let before = std::mem::replace(&mut at_machine_position, axes.at_machine_position);
            if before == at_machine_position {
                continue;
            }
        }
        writeln!(text, "{:>3}  {}", line(ran, *span), event(ran, kind)).unwrap();
    }
    match &ran.outcome {
        Outcome::End => text.push_str("end\n"),
        Outcome::Limit => match ran.control.endless_loop() {
            Some((first, last)) => {
                writeln!(text, "repeats for ever from line {} to line {}", line(ran, first), line(ran, last))
                    .unwrap();
            }
            None => text.push_str("limit of blocks\n"),
        },
        Outcome::Alarm(stopped) => alarmed(ran, stopped, &mut text),
    }
    text
}

fn alarmed(ran: &Ran, stopped: &AlarmStop, text: &mut String) {
    let sources = ran.control.memory().sources();
    let place = sources.line_column(stopped.span);
    let code = stopped.alarm.code();
    writeln!(text, "{:>3}  {code} {}, at column {}", place.line, stopped.alarm, place.column).unwrap();
    let mut call: Option<&Call> = stopped.backtrace.calls.as_deref();
    while let Some(inner) = call {
        writeln!(
            text,
            "     called in line {}: {}",
            line(ran, inner.calling_block),
            sources.text(inner.calling_block).trim()
        )
        .unwrap();
        call = inner.outer_calls.as_deref();
    }
}

fn line(ran: &Ran, span: Span) -> u32 {
    ran.control.memory().sources().line_column(span).line
}

fn event(ran: &Ran, kind: &EventKind) -> String {
    let axes = &ran.control.settings().axes;
    let at = |to: &gcode_lang::motion::Position| {
        let moved = axes.iter().filter(|(axis, letter)| "XYZ".contains(*letter) || to[*axis] != 0.0);
        let words: Vec<_> = moved.map(|(axis, letter)| format!("{letter}{:.4}", to[axis])).collect();
        words.join(" ")
    };
    match kind {
        EventKind::Rapid { to } => format!("rapid {}", at(to)),
        EventKind::Feed { to, rate } => format!("feed  {} at {:.1}", at(to), rate.0),
        EventKind::Arc { to, arc, rate } => {
            let (a, b) = (axes.letter(arc.plane.0), axes.letter(arc.plane.1));
            let centre = format!("{a}{:.4} {b}{:.4}", arc.centre.0, arc.centre.1);
            format!("arc   {} at {:.1}, {:.3} degrees round {centre}", at(to), rate.0, arc.sweep.0)
        }
        EventKind::Skip { to, rate, has_signal } => {
            format!("skip  {} at {:.1}, {}", at(to), rate.0, if *has_signal { "signal" } else { "no signal" })
        }
        EventKind::Dwell { time } => format!("dwell {:.3} s", time.0),
        EventKind::ToolSelected { number } => format!("tool {number} selected"),
        EventKind::ToolChange { number } => format!("tool {number}"),
        EventKind::ToolLength { offset, compensation, .. } => match compensation {
            LengthCompensation::Off => format!("tool length {}", at(offset)),
            LengthCompensation::Plus(h) => format!("tool length {} by G43 H{h}", at(offset)),
            LengthCompensation::Minus(h) => format!("tool length {} by G44 H{h}", at(offset)),
        },
        EventKind::Start { at: position, .. } => format!("start {}", at(position)),
        EventKind::PositionUnknown { axes: unknown } => {
            format!("not placed on the part: {}", axes.names(unknown.at_machine_position))
        }
        EventKind::Spindle { direction, speed, .. } => {
            format!("spindle {direction:?} {}", speed.0).to_lowercase()
        }
        EventKind::Coolant { is_on, .. } => format!("coolant {}", if *is_on { "on" } else { "off" }),
        EventKind::Auxiliary { code } => format!("M{code:02} for the machine builder"),
        EventKind::Stop { kind, text, variables } => {
            let values: Vec<_> = variables.iter().map(|(n, value)| format!(" #{n} is {value:.4}")).collect();
            format!("stop {kind:?} {text}{}", values.concat()).trim_end().to_owned()
        }
    }
}
