//! The result of `run`: the end state of a control, its operator stops, and optionally every move.
use std::collections::BTreeMap;
use std::fmt::Write;

use schemars::JsonSchema;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::figures::{as_on_control, count, duration, rounded, short};
use gcode_control::{Outcome, Value, printable};
use gcode_inspect::machine::Machine;
use gcode_lang::alarm::remedy;
use gcode_lang::motion::{Axes, Event, EventKind, EventSink, Position};
use gcode_lang::source::Span;
use gcode_part::{Assumption, Total};
use gcode_review::BlockLocation;
use gcode_session::Run;

/// The document of `run --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct RunReport {
    pub(crate) outcome: &'static str,
    pub(crate) alarm: Option<AlarmReport>,
    pub(crate) stops: Vec<StopReport>,
    /// The program's printed output, line by line; bytes that are not text as `\xNN`.
    pub(crate) output: Vec<String>,
    /// M codes left to the machine builder's logic.
    #[serde(rename = "passed_on")]
    pub(crate) auxiliary_codes: Vec<AuxiliaryCodeReport>,
    /// The notes: what the control did without a message.
    pub(crate) notes: Vec<NoteReport>,
    #[serde(serialize_with = "variables")]
    #[schemars(with = "BTreeMap<String, f64>")]
    pub(crate) variables: Vec<(u32, f64)>,
    /// The system variables of `--show`; null is vacant.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "shown")]
    #[schemars(with = "BTreeMap<String, Option<f64>>")]
    pub(crate) system: Vec<(u32, Option<f64>)>,
    /// End point in the active work coordinate system.
    pub(crate) position: Coordinates,
    pub(crate) machine: Coordinates,
    pub(crate) blocks: u64,
    pub(crate) moves: u64,
    pub(crate) seconds: f64,
    /// Values that the run read and nothing in the program set; `decides` holds numbers of holes as in `holes`.
    pub(crate) assumptions: Vec<Assumption>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) path: Option<Vec<MoveReport>>,
    /// Letters of the axes that nothing has commanded, as in `Y and Z`.
    #[serde(skip)]
    uncommanded: String,
    /// Unit of the linear axes in the active work coordinate system.
    #[serde(skip)]
    work_unit: &'static str,
    /// Number of holes that the run makes.
    #[serde(skip)]
    total: Total,
    /// The text of the main program has ended without M02, M30 or M99.
    #[serde(skip)]
    lacks_end: bool,
    /// Decimals of a position on the control's screen, in the work's unit and in the machine's.
    #[serde(skip)]
    decimals: [usize; 2],
}

#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct AlarmReport {
    pub(crate) number: u32,
    pub(crate) code: String,
    pub(crate) message: String,
    pub(crate) program: String,
    pub(crate) line: u32,
    pub(crate) column: u32,
    pub(crate) block: String,
    pub(crate) help: Option<String>,
    /// The calls that led there, innermost first.
    pub(crate) calls: Vec<BlockLocation>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct StopReport {
    pub(crate) kind: &'static str,
    pub(crate) text: String,
    /// Variables that the text names, with their values.
    #[serde(skip)]
    variables: Vec<(u32, f64)>,
    /// Program and line of its block.
    #[serde(skip)]
    location: Option<(String, u32)>,
    /// Comment of its block, which the control shows while it waits.
    #[serde(skip)]
    comment: String,
}

/// An M code without an effect on the control, and its first block.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PassedOnReport")]
pub(crate) struct AuxiliaryCodeReport {
    pub(crate) code: String,
    pub(crate) program: String,
    pub(crate) line: u32,
}

/// A note: a condition that is not an alarm and probably not intended, and the first block that has it.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct NoteReport {
    pub(crate) code: &'static str,
    pub(crate) message: String,
    pub(crate) program: String,
    pub(crate) line: u32,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct MoveReport {
    pub(crate) kind: &'static str,
    pub(crate) to: Coordinates,
    pub(crate) seconds: f64,
    pub(crate) feed: Option<f64>,
    pub(crate) program: String,
    pub(crate) line: u32,
}

/// Letter and value of every axis, in the order of the control's axis table.
#[derive(Debug, JsonSchema)]
#[schemars(with = "BTreeMap<char, f64>")]
pub(crate) struct Coordinates(pub Vec<(char, f64)>);

impl Coordinates {
    fn new(axes: &Axes, value: impl Fn(usize) -> f64) -> Self {
        Self(axes.iter().map(|(axis, letter)| (letter, plain(value(axis)))).collect())
    }
}

impl Serialize for Coordinates {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (letter, value) in &self.0 {
            map.serialize_entry(letter, value)?;
        }
        map.end()
    }
}

impl Coordinates {
    /// Formats the coordinates with the decimals of the control.
    fn text(&self, decimals: usize) -> String {
        let axes = self.0.iter().map(|(letter, value)| format!("{letter} {}", rounded(*value, decimals)));
        axes.collect::<Vec<_>>().join("  ")
    }
}

/// Replaces −0 by 0.
fn plain(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value }
}

fn variables<S: Serializer>(all: &[(u32, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(all.iter().map(|(number, value)| (format!("#{number}"), plain(*value))))
}

fn shown<S: Serializer>(all: &[(u32, Option<f64>)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(all.iter().map(|(number, value)| (format!("#{number}"), value.map(plain))))
}

/// Common variables that a control clears when it is switched off: programs use them as scratch memory.
const SCRATCH: std::ops::RangeInclusive<u32> = 100..=199;

/// Largest number of recorded moves: a loop that never ends must not fill the memory.
pub(crate) const MAX_MOVES: usize = 1_000_000;

/// Records the blocks of operator stops, in their order.
#[derive(Debug, Default)]
pub(crate) struct StopRecorder(Vec<Span>);

impl EventSink for StopRecorder {
    fn event(&mut self, event: &Event<'_>) {
        /// A program that loops over M00 must not fill the memory.
        const MOST: usize = 10_000;
        if matches!(event.kind, EventKind::Stop { .. }) && self.0.len() < MOST {
            self.0.push(event.block);
        }
    }
}

/// Returns the comments of a block.
pub(super) fn comments(block: &str) -> String {
    let comments = block.split('(').skip(1).map(|rest| rest.split(')').next().unwrap_or_default().trim());
    comments.filter(|comment| !comment.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Records every move that changes the position, and every dwell.
#[derive(Debug, Default)]
pub(crate) struct MoveRecorder {
    /// There were more than [`MAX_MOVES`].
    pub(crate) is_truncated: bool,
    position: Position,
    moves: Vec<(&'static str, Position, f64, Option<f64>, Span)>,
}

impl EventSink for MoveRecorder {
    fn event(&mut self, event: &Event<'_>) {
        let kind = match event.kind {
            EventKind::Rapid { .. } => "rapid",
            EventKind::Feed { .. } | EventKind::Skip { .. } => "feed",
            EventKind::Arc { .. } => "arc",
            EventKind::Dwell { .. } => "dwell",
            _ => return,
        };
        let to = event.kind.end().copied().unwrap_or(self.position);
        if to != self.position || matches!(kind, "arc" | "dwell") {
            self.is_truncated = self.moves.len() >= MAX_MOVES;
            if !self.is_truncated {
                let feed = event.kind.rate().map(|rate| rate.0);
                self.moves.push((kind, to, event.seconds.0, feed, event.block));
            }
        }
        self.position = to;
    }
}

impl RunReport {
    /// Builds the report of a run with its stops; `moves` and the values of `system` variables are optional.
    /// `assumptions` come with the number of holes.
    pub(crate) fn new(
        run: &Run,
        machine: &Machine,
        (stops, moves): (&StopRecorder, Option<&MoveRecorder>),
        system: Vec<(u32, Value)>,
        (assumptions, total): (Vec<Assumption>, Total),
    ) -> Self {
        let control = &run.control;
        let axes = &control.settings().axes;
        let position = control.machine_position();
        let uncommanded = machine.needed_axes(control.unknown_axes().uncommanded);
        let path = moves.map(|moves| {
            let report =
                |(kind, to, seconds, feed, block): &(&'static str, Position, f64, Option<f64>, Span)| {
                    let (program, line) = run.locate(*block);
                    let to = Coordinates::new(axes, |axis| to[axis]);
                    MoveReport { kind, to, seconds: *seconds, feed: *feed, program, line }
                };
            moves.moves.iter().map(report).collect()
        });
        Self {
            outcome: match run.outcome {
                Outcome::End => "end",
                Outcome::Alarm(_) => "alarm",
                Outcome::Limit => "limit",
            },
            alarm: alarm(run),
            stops: control
                .stops()
                .iter()
                .enumerate()
                .map(|(index, stop)| {
                    let block = stops.0.get(index).copied();
                    let text = |block| control.memory().sources().text(block);
                    StopReport {
                        kind: stop.kind.name(),
                        text: stop.text.clone(),
                        variables: stop.variables.clone(),
                        location: block.map(|block| run.locate(block)),
                        comment: block.map_or_else(String::new, |block| comments(&text(block))),
                    }
                })
                .collect(),
            output: control.output().iter().map(|line| printable(line)).collect(),
            auxiliary_codes: control
                .builder_m_codes()
                .iter()
                .map(|(code, span)| {
                    let (program, line) = run.locate(*span);
                    AuxiliaryCodeReport { code: format!("M{code:02}"), program, line }
                })
                .collect(),
            notes: control
                .notes()
                .map(|(note, block)| {
                    let (kind, message, _) = note.describe();
                    let (program, line) = run.locate(block);
                    NoteReport { code: kind.code, message, program, line }
                })
                .collect(),
            variables: control.variables().collect(),
            system: system.into_iter().map(|(number, value)| (number, value.as_number())).collect(),
            position: Coordinates::new(axes, |axis| control.work_position(axis)),
            machine: Coordinates::new(axes, |axis| position[axis]),
            blocks: control.blocks(),
            moves: control.moves(),
            seconds: control.seconds().0,
            assumptions,
            total,
            path,
            lacks_end: control.lacks_end(),
            uncommanded: axes.names(uncommanded),
            work_unit: if control.is_inch() { "inches" } else { "mm" },
            decimals: {
                let increment = control.settings().increment.decimals();
                [increment + usize::from(control.is_inch()), increment]
            },
        }
    }

    /// Formats the result for a terminal.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        let word = match self.outcome {
            "end" if self.lacks_end => "ended where its text does, without M02, M30 or M99".to_owned(),
            "end" => "ended".to_owned(),
            "limit" => "not ended: a limit was reached".to_owned(),
            _ => self.alarm.as_ref().map_or_else(
                || "stopped by an alarm".to_owned(),
                |AlarmReport { code, message, program, line, .. }| {
                    format!("stopped by the alarm {code} {message} ({program} line {line})")
                },
            ),
        };
        let [work, machine] = self.decimals;
        let _ = writeln!(text, "outcome    {word}");
        let _ = writeln!(text, "position   {} ({}, degrees)", self.position.text(work), self.work_unit);
        let _ = writeln!(text, "machine    {} (mm, degrees)", self.machine.text(machine));
        if !self.uncommanded.is_empty() {
            let _ = writeln!(
                text,
                "unknown    {}: where the last job left it; no block commands it in G90",
                self.uncommanded
            );
        }
        let (blocks, moves) = (count(self.blocks, "block"), count(self.moves, "move"));
        let _ = writeln!(text, "executed   {blocks}, {moves}");
        let _ =
            writeln!(text, "time       {} (paths and rapid rates, no acceleration)", duration(self.seconds));
        for stop in &self.stops {
            let values = stop
                .variables
                .iter()
                .map(|(number, value)| format!(" #{number} = {}", as_on_control(*value)));
            let values: Vec<_> = values.collect();
            let shown = if values.is_empty() { String::new() } else { format!(":{}", values.join(",")) };
            let place = stop.location.as_ref().map(|(program, line)| format!(" ({program} line {line})"));
            let words = if stop.text.is_empty() { &stop.comment } else { &stop.text };
            let words = if words.is_empty() { String::new() } else { format!(" {words}") };
            let _ = writeln!(text, "stop       {}{}{words}{shown}", stop.kind, place.unwrap_or_default());
        }
        for line in &self.output {
            let _ = writeln!(text, "output     {line}");
        }
        for AuxiliaryCodeReport { code, program, line } in &self.auxiliary_codes {
            let _ = writeln!(
                text,
                "passed on  {code}, first in {program} line {line}: left to the machine builder, not simulated"
            );
        }
        for assumption in &self.assumptions {
            let _ = writeln!(text, "assumes    {}", assumption.sentence(self.total));
        }
        let is_shown = |number: u32| self.system.iter().any(|(shown, _)| *shown == number);
        let (scratch, kept): (Vec<_>, Vec<_>) = self
            .variables
            .iter()
            .filter(|(number, _)| !is_shown(*number))
            .partition(|(number, _)| SCRATCH.contains(number));
        if let [(first, _), ..] = scratch.as_slice() {
            let commons = count(scratch.len() as u64, "variable");
            let _ = writeln!(
                text,
                "not shown  {commons} of #100 to #199: --show '#{first}' shows one, --format json all"
            );
        }
        for (number, value) in kept {
            let _ = writeln!(text, "{:<11}{}", format!("#{number}"), as_on_control(value));
        }
        for (number, value) in &self.system {
            let value = value.map_or_else(|| "vacant".to_owned(), as_on_control);
            let _ = writeln!(text, "{:<11}{value}", format!("#{number}"));
        }
        if self.path.is_some() {
            let _ = writeln!(text, "moves      machine coordinates in mm and degrees");
        }
        for step in self.path.iter().flatten() {
            let feed = step.feed.map(|f| format!("  F{}", short(f))).unwrap_or_default();
            let location = format!("{}:{}", step.program, step.line);
            let _ = writeln!(
                text,
                "{location:<14} {:<6} {}{feed}  {:.2} s",
                step.kind,
                step.to.text(machine),
                step.seconds
            );
        }
        text
    }
}

fn alarm(run: &Run) -> Option<AlarmReport> {
    let Outcome::Alarm(stopped) = &run.outcome else { return None };
    let row = stopped.alarm.row();
    let sources = run.control.memory().sources();
    let at = sources.line_column(stopped.span);
    let BlockLocation { program, block, calls, .. } = BlockLocation::of(run, &stopped.backtrace);
    Some(AlarmReport {
        number: row.code.number(),
        code: row.code.to_string(),
        message: row.message,
        program,
        line: at.line,
        column: at.column,
        block,
        help: remedy(&stopped.alarm, stopped.span, sources),
        calls,
    })
}
