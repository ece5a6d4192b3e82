//! Runs a program on a control and holds the end of the run against what was worked out for it.
//!
//! What is expected is a list with `; ` between its items:
//!
//! | item | holds when |
//! |---|---|
//! | `end=normal` | M30, M02 or the end of the program was reached without an alarm |
//! | `end=repeats` | the run was ended because the program provably repeats for ever |
//! | `alarm=PS0112` | the control stopped with this alarm; with one of several, `PS0112\|PS0119`, where `why` says what is open |
//! | `msg="TEXT"` | the alarm's text |
//! | `stop=TEXT` | an operator stop with this text |
//! | `note=lower-case` | the run told this note, by its name; `note=none` where it told none |
//! | `stops=M00,M01` | all operator stops, in their order |
//! | `passed_on=M77,M78` | the M codes left to the machine builder, in ascending order |
//! | `printed="LINE\|LINE"` | what DPRNT printed, all of it |
//! | `#100=1.5`, `#100=vacant` | the variable at the end; locals are those of the main program |
//! | `abs.X=1`, `mach.X=1` | work and machine position |
//! | `path=R(x,y,z) F(…) A(…) D(s)` | all rapids, cutting feeds, arcs (by their ends, machine X Y Z) and dwells |
//! | `time_min=0.5` | the time of all blocks in minutes |
//! | `amove=-10,20` | the ways of the A axis |
//! | `within=0.001` | the tolerance of all numbers, 1e-6 where it isn't said |
//! | `why=TEXT` | always: the reason for the alarm, the last item. It begins with `open:` where several are right |
//!
//! A comment `(@KEY=VALUE)` in the program is a setting of the control, by the name it has on the command line.
use std::fmt::Write as _;

use gcode_control::{Control, Limits, Outcome, Value};
use gcode_lang::control::Settings;
use gcode_lang::motion::{Event, EventKind, EventSink, Position};
use gcode_lang::program::{Memory, NoLibrary};
use gcode_lang::source::Span;

/// Everything the machine was told, and a control at the end of its run.
pub struct Ran {
    pub control: Control,
    pub outcome: Outcome,
    /// What was told, each with its block.
    pub events: Vec<(Span, EventKind)>,
    path: Path,
}

/// The default control with the settings that the program's comments name.
pub fn settings(program: &[u8]) -> Settings {
    let text = String::from_utf8_lossy(program);
    let mut settings = Settings::default();
    for directive in text.split("(@").skip(1) {
        let inside = directive.split(')').next().unwrap();
        let (key, value) = inside.split_once('=').unwrap();
        settings.set(key.trim(), value.trim()).unwrap_or_else(|e| panic!("{e}"));
    }
    settings
}

/// Runs a program to its end.
pub fn run(program: &[u8]) -> Ran {
    let mut memory = Memory::default();
    memory.load("case.nc", program);
    let mut control = Control::new(memory, settings(program));
    let mut path = Path::default();
    let outcome = control.run(Limits { blocks: 100_000 }, &mut NoLibrary, &mut path);
    let events = std::mem::take(&mut path.events);
    Ran { control, outcome, events, path }
}

impl Ran {
    /// What differs from `expected`, one line each.
    pub fn differences(&self, expected: &str) -> Vec<String> {
        let (demands, why) = expected.split_once("; why=").unwrap_or((expected, ""));
        let within = items(demands).find(|(key, _)| *key == "within");
        let tolerance = within.map_or(1e-6, |(_, value)| value.parse().unwrap());
        let several = items(demands).any(|(key, value)| key == "alarm" && value.contains('|'));
        assert_eq!(several, why.starts_with("open: "), "one alarm, or why several are right: {expected}");
        items(demands)
            .filter(|(key, _)| *key != "within")
            .filter_map(|(key, value)| self.difference(key, value, tolerance))
            .collect()
    }

    fn difference(&self, key: &str, wanted: &str, tolerance: f64) -> Option<String> {
        let found = match key {
            "end" if wanted == "repeats" => {
                let found = self.control.endless_loop().is_some();
                return self.not(found, "end=repeats");
            }
            "end" => return self.not(matches!(self.outcome, Outcome::End), "end=normal"),
            "alarm" => {
                let code = match &self.outcome {
                    Outcome::Alarm(stopped) => stopped.alarm.code().to_string(),
                    Outcome::End | Outcome::Limit => String::new(),
                };
                let holds = wanted.split('|').any(|wanted| wanted == code);
                return self.not(holds, &format!("alarm={wanted}"));
            }
            "msg" => {
                let holds =
                    matches!(&self.outcome, Outcome::Alarm(s) if format!("\"{}\"", s.alarm) == wanted);
                return self.not(holds, &format!("msg={wanted}"));
            }
            "stop" => {
                let holds = self.control.stops().iter().any(|s| s.text == wanted.trim_matches('"'));
                return self.not(holds, &format!("stop={wanted}"));
            }
            "stops" => {
                let kinds: Vec<_> =
                    self.control.stops().iter().map(|stop| format!("{:?}", stop.kind)).collect();
                return self.not(kinds.join(",") == wanted, &format!("stops={wanted}"));
            }
            "passed_on" => {
                let codes: Vec<_> =
                    self.control.auxiliary_codes().keys().map(|code| format!("M{code}")).collect();
                return self.not(codes.join(",") == wanted, &format!("passed_on={wanted}"));
            }
            "note" => {
                let holds = self.control.notes().any(|(note, _)| note.describe().0.code == wanted);
                let holds = if wanted == "none" { self.control.notes().next().is_none() } else { holds };
                return self.not(holds, &format!("note={wanted}"));
            }
            "printed" => {
                let lines: Vec<_> =
                    self.control.output().iter().map(|l| String::from_utf8_lossy(l)).collect();
                let found = lines.join("|");
                let holds = format!("\"{found}\"") == wanted;
                return (!holds).then(|| format!("printed is \"{found}\", {wanted} is wanted"));
            }
            "path" => return self.path.difference(wanted, tolerance),
            "amove" => self.path.ways(3),
            "time_min" => vec![self.control.seconds().0 / 60.0],
            _ if key.starts_with('#') => match self.variable(key[1..].parse().unwrap()) {
                Value::Number(number) => vec![number],
                Value::Vacant if wanted == "vacant" => return None,
                Value::Vacant => return Some(format!("{key} is vacant, {wanted} is wanted")),
            },
            _ => {
                let (frame, letter) = key.split_once('.').unwrap_or_else(|| panic!("item {key}"));
                let axis = self.control.settings().axes.find(letter.as_bytes()[0]).unwrap();
                vec![match frame {
                    "abs" => self.control.work_position(axis),
                    "mach" => self.control.machine_position()[axis],
                    _ => panic!("item {key}"),
                }]
            }
        };
        let wanted_numbers: Option<Vec<f64>> = wanted.split(',').map(|w| w.parse().ok()).collect();
        let holds = wanted_numbers.is_some_and(|wanted| is_close(&found, &wanted, tolerance));
        (!holds).then(|| format!("{key} is {found:?}, {wanted} is wanted"))
    }

    /// A variable at the end; locals are those of the main program.
    fn variable(&self, number: u32) -> Value {
        if (1..=33).contains(&number) {
            let known = self.control.variables().find(|(n, _)| *n == number);
            return known.map_or(Value::Vacant, |(_, value)| Value::Number(value));
        }
        self.control.variable(number).unwrap()
    }

    fn not(&self, holds: bool, wanted: &str) -> Option<String> {
        let ended = match &self.outcome {
            Outcome::End => "the run ended normally".to_owned(),
            Outcome::Limit => "the run was ended by its limit of blocks".to_owned(),
            Outcome::Alarm(stopped) => format!("{} {}", stopped.alarm.code(), stopped.alarm),
        };
        (!holds).then(|| format!("{ended}; {wanted} is wanted"))
    }
}

/// The items of an expectation. A semicolon inside quotes belongs to its item.
fn items(expected: &str) -> impl Iterator<Item = (&str, &str)> {
    expected.split("; ").map(|item| item.trim().split_once('=').unwrap_or_else(|| panic!("item {item}")))
}

fn is_close(found: &[f64], wanted: &[f64], tolerance: f64) -> bool {
    found.len() == wanted.len() && found.iter().zip(wanted).all(|(f, w)| (f - w).abs() <= tolerance)
}

/// One thing the machine was told, by its letter and its numbers.
type PathEntry = (char, Vec<f64>);

#[derive(Default)]
struct Path {
    entries: Vec<PathEntry>,
    stations: Vec<Position>,
    events: Vec<(Span, EventKind)>,
}

impl EventSink for Path {
    fn event(&mut self, event: &Event<'_>) {
        self.events.push((event.block, event.kind.clone()));
        let (letter, to) = match &event.kind {
            EventKind::Rapid { to } => ('R', to),
            EventKind::Feed { to, .. } | EventKind::Skip { to, .. } => ('F', to),
            EventKind::Arc { to, .. } => ('A', to),
            EventKind::Dwell { time } => return self.entries.push(('D', vec![time.0])),
            _ => return,
        };
        self.entries.push((letter, to.0[..3].to_vec()));
        self.stations.push(*to);
    }
}

impl Path {
    fn ways(&self, axis: usize) -> Vec<f64> {
        let places: Vec<f64> = std::iter::once(0.0).chain(self.stations.iter().map(|p| p[axis])).collect();
        places.windows(2).map(|pair| pair[1] - pair[0]).filter(|way| *way != 0.0).collect()
    }

    fn difference(&self, wanted: &str, tolerance: f64) -> Option<String> {
        let wanted_path: Vec<PathEntry> = wanted
            .split_whitespace()
            .map(|step| {
                let (letter, rest) = step.split_once('(').unwrap();
                let numbers = rest.trim_end_matches(')').split(',').map(|n| n.parse().unwrap());
                (letter.chars().next().unwrap(), numbers.collect())
            })
            .collect();
        let same = |(a, b): (&PathEntry, &PathEntry)| a.0 == b.0 && is_close(&a.1, &b.1, tolerance);
        let holds =
            wanted_path.len() == self.entries.len() && self.entries.iter().zip(&wanted_path).all(same);
        (!holds).then(|| {
            let mut found = String::new();
            for (letter, numbers) in &self.entries {
                let numbers: Vec<_> = numbers.iter().map(f64::to_string).collect();
                write!(found, "{letter}({}) ", numbers.join(",")).unwrap();
            }
            format!("path is {found}, {wanted} is wanted")
        })
    }
}
