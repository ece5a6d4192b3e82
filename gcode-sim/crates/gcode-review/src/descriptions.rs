//! Words for steps, points and distances in an entry.
use super::steps::{Step, StepKind, UnsimulatedKind, difference};
use gcode_lang::motion::{Axes, MAX_AXES, Position, SpindleDirection, StopKind};

/// Describes a command, or names a move.
pub(super) fn describe(kind: &StepKind, axes: &Axes) -> String {
    match kind {
        StepKind::Dwell(seconds) => format!("a dwell of {seconds} s"),
        StepKind::Tool(number) => format!("tool T{number}"),
        StepKind::Length(offset) => match coordinates(offset, axes, 0.0, false).as_str() {
            "" => "a tool length offset of 0".to_owned(),
            values => format!("tool length offset {values}"),
        },
        StepKind::Spindle(SpindleDirection::Off, _) => "spindle stop".to_owned(),
        StepKind::Spindle(SpindleDirection::Clockwise, speed) => format!("M03 S{speed}"),
        StepKind::Spindle(SpindleDirection::Counterclockwise, speed) => format!("M04 S{speed}"),
        StepKind::Coolant(true, None) => "coolant on".to_owned(),
        StepKind::Coolant(false, None) => "coolant off".to_owned(),
        StepKind::Coolant(_, Some(code)) | StepKind::Auxiliary(code) => format!("M{code:02}"),
        StepKind::Stop(StopKind::M00, ..) => "the stop M00".to_owned(),
        StepKind::Stop(StopKind::M01, ..) => "the stop M01".to_owned(),
        StepKind::Stop(StopKind::Message, text, named) => {
            let values = named.iter().map(|(number, value)| format!(", #{number} = {}", short(*value)));
            format!("the stop #3006 ({text}){}", values.collect::<String>())
        }
        StepKind::Silent(UnsimulatedKind::Skip, text) => format!("the block skip {text}"),
        StepKind::Silent(UnsimulatedKind::Tool, text) => format!("{text} without M06"),
        StepKind::Silent(UnsimulatedKind::Speed, text) => format!("{text} without M03 or M04"),
        StepKind::Silent(_, text) => text.clone(),
        StepKind::Rapid | StepKind::Feed(_) | StepKind::Arc(..) | StepKind::Probe(_) => kind.one(),
    }
}

/// Formats the end point of the axes that a move moves, in machine coordinates.
pub(super) fn point(step: &Step<'_>, axes: &Axes) -> String {
    let displacement = difference(&step.to, &step.from);
    let moving: Vec<String> = axes
        .iter()
        .filter(|(axis, _)| displacement[*axis] != 0.0)
        .map(|(axis, letter)| format!("{letter}{:.4}", step.at[axis]))
        .collect();
    if moving.is_empty() {
        return "its start point".to_owned();
    }
    let moves = |is_rotary: bool| {
        axes.iter().any(|(axis, _)| displacement[axis] != 0.0 && axes.is_rotary(axis) == is_rotary)
    };
    let units = match (moves(false), moves(true)) {
        (true, true) => "mm, degrees",
        (false, true) => "degrees",
        (_, false) => "mm",
    };
    format!("{} (machine, {units})", moving.join(" "))
}

/// Formats the axes whose values exceed `least`.
pub(super) fn coordinates(values: &Position, axes: &Axes, least: f64, signed: bool) -> String {
    let far = axes.iter().filter(|(axis, _)| values[*axis].abs() > least);
    let shown = far.map(|(axis, letter)| match signed {
        true => format!("{letter} {:+.4}", values[axis]),
        false => format!("{letter} {:.4}", values[axis]),
    });
    shown.collect::<Vec<_>>().join(" ")
}

/// Returns a key of what [`coordinates`] shows with signs; `None` if a value is about half way between two that are shown.
pub(super) fn shown_key(values: &Position, least: f64) -> Option<[i64; MAX_AXES]> {
    let mut key = [HIDDEN; MAX_AXES];
    for (shown, value) in key.iter_mut().zip(values.0).filter(|(_, value)| value.abs() > least) {
        let rounded = (value * 1e4).round();
        if (value * 1e4 - rounded).abs() > 0.499 || rounded == 0.0 {
            return None;
        }
        *shown = rounded as i64;
    }
    Some(key)
}

/// Key of a value that isn't shown: none that is rounds to it.
const HIDDEN: i64 = 0;

/// Rounds a feed to four decimals.
pub(super) fn short(rate: f64) -> f64 {
    (rate * 1e4).round() / 1e4
}

/// Describes the sign of a change of depth.
pub(super) fn deeper(mm: f64) -> &'static str {
    if mm > 0.0 { "deeper" } else { "less deep" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacements_have_one_key_if_they_are_shown_alike() {
        let key = |x: f64, y: f64| shown_key(&Position([x, y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 1e-4);
        assert_eq!(key(0.11 - 0.1, 0.0), key(0.01, 0.000_09), "X +0.0100, and a Y that is not shown");
        assert!(key(0.01, 0.0).is_some());
        assert_ne!(key(0.01, 0.0), key(0.0101, 0.0));
        assert_ne!(key(0.01, 0.0), key(-0.01, 0.0));
        assert_ne!(key(0.01, 0.0), key(0.01, 0.000_2));
        // Half way between 0.0100 and 0.0101 the text decides.
        assert_eq!(key(0.010_05, 0.0), None);
    }
}
