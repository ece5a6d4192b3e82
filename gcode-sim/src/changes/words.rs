//! What steps, places and distances are called in an entry.
use super::steps::{Category, Kind, Quiet, Step, difference};
use crate::motion::{Axes, Position, Spindle, StopKind};

/// What a change of such a step is called.
pub(super) fn code(kind: &Kind) -> &'static str {
    match kind.category() {
        Category::Move => "move",
        Category::Dwell => "dwell",
        Category::Tool | Category::Silent(Quiet::Tool) => "tool",
        Category::Length => "tool-length",
        Category::Spindle | Category::Silent(Quiet::Speed) => "spindle",
        Category::Coolant => "coolant",
        Category::Auxiliary | Category::Silent(Quiet::MCode) => "m-code",
        Category::Stop => "stop",
        Category::Silent(Quiet::Skip) => "block-skip",
        Category::Silent(Quiet::Path) => "path-mode",
        Category::Silent(Quiet::GCode) => "g-code",
        Category::Silent(Quiet::Switch) => "switch",
        Category::Silent(Quiet::Signal) => "signal",
    }
}

pub(super) fn described(kind: &Kind, axes: &Axes) -> String {
    match kind {
        Kind::Dwell(seconds) => format!("a dwell of {seconds} s"),
        Kind::Tool(number) => format!("tool T{number}"),
        Kind::Length(offset) => match coordinates(offset, axes, 0.0, false).as_str() {
            "" => "a tool length offset of 0".to_owned(),
            values => format!("tool length offset {values}"),
        },
        Kind::Spindle(Spindle::Off, _) => "spindle stop".to_owned(),
        Kind::Spindle(Spindle::Clockwise, speed) => format!("M03 S{speed}"),
        Kind::Spindle(Spindle::Counterclockwise, speed) => format!("M04 S{speed}"),
        Kind::Coolant(true, None) => "coolant on".to_owned(),
        Kind::Coolant(false, None) => "coolant off".to_owned(),
        Kind::Coolant(_, Some(code)) | Kind::Auxiliary(code) => format!("M{code:02}"),
        Kind::Stop(StopKind::M00, ..) => "the stop M00".to_owned(),
        Kind::Stop(StopKind::M01, ..) => "the stop M01".to_owned(),
        Kind::Stop(StopKind::Message, text, named) => {
            let values = named.iter().map(|(number, value)| format!(", #{number} = {}", short(*value)));
            format!("the stop #3006 ({text}){}", values.collect::<String>())
        }
        Kind::Silent(Quiet::Skip, text) => format!("the block skip {text}"),
        Kind::Silent(Quiet::Tool, text) => format!("{text} without M06"),
        Kind::Silent(Quiet::Speed, text) => format!("{text} without M03 or M04"),
        Kind::Silent(_, text) => text.clone(),
        Kind::Rapid | Kind::Feed(_) | Kind::Arc(..) | Kind::Probe(_) => kind.one(),
    }
}

/// Where a move ends, in machine coordinates without the tool's length.
pub(super) fn point(step: &Step, axes: &Axes) -> String {
    let way = difference(&step.to, &step.from);
    let moving: Vec<String> = axes
        .iter()
        .filter(|(axis, _)| way[*axis] != 0.0)
        .map(|(axis, letter)| format!("{letter}{:.4}", step.at[axis]))
        .collect();
    if moving.is_empty() { "its start point".to_owned() } else { moving.join(" ") }
}

/// The axes whose values are beyond `least`.
pub(super) fn coordinates(values: &Position, axes: &Axes, least: f64, signed: bool) -> String {
    let far = axes.iter().filter(|(axis, _)| values[*axis].abs() > least);
    let told = far.map(|(axis, letter)| match signed {
        true => format!("{letter} {:+.4}", values[axis]),
        false => format!("{letter} {:.4}", values[axis]),
    });
    told.collect::<Vec<_>>().join(" ")
}

/// A feed without digits nobody can set.
pub(super) fn short(rate: f64) -> f64 {
    (rate * 1e4).round() / 1e4
}
