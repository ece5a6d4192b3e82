//! Runs a program on a control and compares the end of the run with an expectation that is computed by hand.
//!
//! An expectation is a list with `; ` between its items:
//!
//! | item | holds when |
//! |---|---|
//! | `end=normal` | M30, M02 or the end of the program was reached without an alarm |
//! | `end=repeats` | the run ended because the program provably repeats for ever |
//! | `alarm=PS0112` | the control stopped with this alarm; with one of several, `PS0112\|PS0119`, if `why` states the open point |
//! | `msg="TEXT"` | the alarm's text |
//! | `stop=TEXT` | an operator stop with this text |
//! | `note=lower-case` | the run has this note, by its name; `note=none` if it has none |
//! | `stops=M00,M01` | all operator stops, in their order; `stops=` if there is none |
//! | `passed_on=M77,M78` | the M codes left to the machine builder, in ascending order |
//! | `printed="LINE\|LINE"` | all lines that DPRNT printed |
//! | `#100=1.5`, `#100=vacant` | the variable at the end; locals are those of the main program; `#501-#560=vacant` all of these, `=known` if not vacant, `=#574` the value of another |
//! | `abs.X=1`, `mach.X=1` | work and machine position |
//! | `path=R(x,y,z) F(…) A(…) D(s)` | all rapids, cutting feeds, arcs (by their ends, machine X Y Z) and dwells |
//! | `time_min=0.5` | the time of all blocks in minutes |
//! | `amove=-10,20` | the moves of the A axis |
//! | `moves=0`, `moves=41..` | the number of moves, exactly or at least; `feeds=0` that of cutting feeds |
//! | `within=0.001` | the tolerance of all numbers, 1e-6 by default; `0.1±0.002` that of one number |
//! | `why=TEXT` | always: the reason for the alarm, the last item. It begins with `open:` if several are right |
//!
//! A comment `(@KEY=VALUE)` in the program is a setting of the control, by the name it has on the command line.
use std::collections::BTreeSet;
use std::fmt::Write as _;

use gcode_control::{Control, Limits, Outcome, Value};
use gcode_lang::control::Settings;
use gcode_lang::motion::{Event, EventKind, EventSink, Position};
use gcode_lang::program::{Memory, NoLibrary};
use gcode_lang::source::Span;

/// Events of a run: block, kind, seconds.
#[derive(Debug, Default, PartialEq)]
pub struct Recorder(pub Vec<(Span, EventKind, f64)>);

impl EventSink for Recorder {
    fn event(&mut self, event: &Event<'_>) {
        self.0.push((event.block, event.kind.clone(), event.seconds.0));
    }
}

impl Recorder {
    /// Iterates over the end positions of all moves, each with R for a rapid, F for a feed and A for an arc.
    pub fn moves(&self) -> impl Iterator<Item = (char, &Position)> {
        self.0.iter().filter_map(|(_, kind, _)| match kind {
            EventKind::Rapid { to } => Some(('R', to)),
            EventKind::Feed { to, .. } | EventKind::Skip { to, .. } => Some(('F', to)),
            EventKind::Arc { to, .. } => Some(('A', to)),
            _ => None,
        })
    }

    /// Returns the end positions of all moves in their order.
    pub fn positions(&self) -> Vec<Position> {
        self.moves().map(|(_, to)| *to).collect()
    }
}

/// Control at the end of its run, and the events of the run.
pub struct Ran {
    pub control: Control,
    pub outcome: Outcome,
    pub recorder: Recorder,
}

/// Returns the default settings with those that the program's comments name.
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
    run_on(program, settings(program), 100_000)
}

/// Runs a program on a control with these settings.
pub fn run_on(program: &[u8], settings: Settings, blocks: u64) -> Ran {
    let mut memory = Memory::default();
    memory.load("case.nc", program);
    let mut control = Control::new(memory, settings);
    let mut recorder = Recorder::default();
    let outcome = control.run(Limits { blocks }, &mut NoLibrary, &mut recorder);
    Ran { control, outcome, recorder }
}

impl Ran {
    /// Fails if something differs from `expected`.
    pub fn must(&self, expected: &str) {
        let wrong = self.differences(expected);
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    /// Returns the differences from `expected`, one line each.
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

    fn difference(&self, key: &str, expected: &str, tolerance: f64) -> Option<String> {
        let (is_met, found) = match key {
            "path" => self.path(expected, tolerance),
            "moves" => at_least(self.control.moves(), expected),
            "feeds" => {
                at_least(self.recorder.moves().filter(|(kind, _)| *kind == 'F').count() as u64, expected)
            }
            "stop" => {
                let texts: Vec<_> = self.control.stops().iter().map(|stop| &*stop.text).collect();
                (texts.contains(&expected.trim_matches('"')), texts.join(", "))
            }
            "note" => {
                let codes: BTreeSet<_> =
                    self.control.notes().map(|(note, _)| note.describe().0.code).collect();
                let is_met = if expected == "none" { codes.is_empty() } else { codes.contains(expected) };
                (is_met, Vec::from_iter(codes).join(", "))
            }
            "amove" => close(&self.moves_of_axis(3), expected, tolerance),
            "time_min" => close(&[self.control.seconds().0 / 60.0], expected, tolerance),
            _ if key.starts_with('#') => return self.variables(key, expected, tolerance),
            _ => match (self.text(key), key.split_once('.')) {
                // Manuals may leave a choice of alarms.
                (Some(found), _) if key == "alarm" => (expected.split('|').any(|one| one == found), found),
                (Some(found), _) => (expected == found, found),
                (None, Some((frame, letter))) => {
                    let axis = self.control.settings().axes.find(letter.as_bytes()[0]).unwrap();
                    let position = match frame {
                        "abs" => self.control.work_position(axis),
                        "mach" => self.control.machine_position()[axis],
                        _ => panic!("item {key}"),
                    };
                    close(&[position], expected, tolerance)
                }
                (None, None) => panic!("item {key}"),
            },
        };
        (!is_met).then(|| format!("{key} is {found}, expected is {expected}; {}", self.end()))
    }

    /// Returns the text that an item compares; `None` for an item with numbers.
    fn text(&self, key: &str) -> Option<String> {
        let alarm = match &self.outcome {
            Outcome::Alarm(stopped) => Some(&stopped.alarm),
            Outcome::End | Outcome::Limit => None,
        };
        Some(match key {
            "end" if self.control.endless_loop().is_some() => "repeats".to_owned(),
            "end" if matches!(self.outcome, Outcome::End) => "normal".to_owned(),
            "end" => self.end(),
            "alarm" => alarm.map_or("none".to_owned(), |alarm| alarm.code().to_string()),
            "msg" => alarm.map_or("none".to_owned(), |alarm| format!("\"{alarm}\"")),
            "stops" => {
                let kinds = self.control.stops().iter().map(|stop| format!("{:?}", stop.kind));
                kinds.collect::<Vec<_>>().join(",")
            }
            "passed_on" => {
                let codes = self.control.builder_m_codes().keys().map(|code| format!("M{code}"));
                codes.collect::<Vec<_>>().join(",")
            }
            "printed" => {
                let lines =
                    self.control.output().iter().map(|line| String::from_utf8_lossy(line).into_owned());
                format!("\"{}\"", lines.collect::<Vec<_>>().join("|"))
            }
            _ => return None,
        })
    }

    fn end(&self) -> String {
        match &self.outcome {
            Outcome::End => "the run ended normally".to_owned(),
            Outcome::Limit => "the run was ended by its limit of blocks".to_owned(),
            Outcome::Alarm(stopped) => format!("{} {}", stopped.alarm.code(), stopped.alarm),
        }
    }

    /// Compares one variable or a range of them; locals are those of the main program.
    fn variables(&self, key: &str, expected: &str, tolerance: f64) -> Option<String> {
        let mut numbers = key.split('-').map(|number| number.trim_start_matches('#').parse().unwrap());
        let first: u32 = numbers.next().unwrap();
        let wrong = (first..=numbers.next().unwrap_or(first)).find_map(|number| {
            let found = match number {
                1..=33 => self.control.variables().find(|(n, _)| *n == number).map(|(_, value)| value),
                _ => match self.control.variable(number).unwrap() {
                    Value::Number(value) => Some(value),
                    Value::Vacant => None,
                },
            };
            let is_met = match found {
                Some(value) => expected == "known" || close(&[value], &self.resolved(expected), tolerance).0,
                None => expected == "vacant",
            };
            (!is_met).then(|| (number, found.map_or("vacant".to_owned(), |value| value.to_string())))
        });
        wrong.map(|(number, found)| format!("#{number} is {found}, expected is {expected}; {}", self.end()))
    }

    /// Replaces the variable that an expectation begins with, as in `#574±0.0006`, by its value.
    fn resolved(&self, expected: &str) -> String {
        let Some(variable) = expected.strip_prefix('#') else { return expected.to_owned() };
        let digits = variable.find(|c: char| !c.is_ascii_digit()).unwrap_or(variable.len());
        let value = self.control.variable(variable[..digits].parse().unwrap()).unwrap().number();
        format!("{value}{}", &variable[digits..])
    }

    fn moves_of_axis(&self, axis: usize) -> Vec<f64> {
        let positions: Vec<f64> =
            std::iter::once(0.0).chain(self.recorder.moves().map(|(_, to)| to[axis])).collect();
        positions.windows(2).map(|pair| pair[1] - pair[0]).filter(|way| *way != 0.0).collect()
    }

    /// Compares moves and dwells with a `path`; also returns them in its form.
    fn path(&self, expected: &str, tolerance: f64) -> (bool, String) {
        let found: Vec<(char, Vec<f64>)> = self
            .recorder
            .0
            .iter()
            .filter_map(|(_, kind, _)| match kind {
                EventKind::Rapid { to } => Some(('R', to.0[..3].to_vec())),
                EventKind::Feed { to, .. } | EventKind::Skip { to, .. } => Some(('F', to.0[..3].to_vec())),
                EventKind::Arc { to, .. } => Some(('A', to.0[..3].to_vec())),
                EventKind::Dwell { time } => Some(('D', vec![time.0])),
                _ => None,
            })
            .collect();
        let steps: Vec<&str> = expected.split_whitespace().collect();
        let is_step = |(step, (letter, numbers)): (&&str, &(char, Vec<f64>))| {
            let expected =
                step.strip_prefix(*letter).and_then(|rest| rest.strip_prefix('(')?.strip_suffix(')'));
            expected.is_some_and(|expected| close(numbers, expected, tolerance).0)
        };
        let is_met = steps.len() == found.len() && steps.iter().zip(&found).all(is_step);
        let mut shown = String::new();
        for (letter, numbers) in &found {
            let numbers: Vec<_> = numbers.iter().map(f64::to_string).collect();
            write!(shown, "{letter}({}) ", numbers.join(",")).unwrap();
        }
        (is_met, shown)
    }
}

/// Iterates over the items of an expectation, key and value.
fn items(expected: &str) -> impl Iterator<Item = (&str, &str)> {
    expected.split("; ").map(|item| item.trim().split_once('=').unwrap_or_else(|| panic!("item {item}")))
}

/// Compares a count with a number, or with the least number before `..`; also returns the count as text.
fn at_least(found: u64, expected: &str) -> (bool, String) {
    let is_met = match expected.strip_suffix("..") {
        Some(least) => least.parse::<u64>().unwrap() <= found,
        None => expected.parse() == Ok(found),
    };
    (is_met, found.to_string())
}

/// Compares numbers with a list; also returns them as text.
fn close(found: &[f64], expected: &str, tolerance: f64) -> (bool, String) {
    let tolerated = |number: &str| {
        let (number, own) = number.split_once('±').unwrap_or((number, ""));
        Some((number.parse::<f64>().ok()?, own.parse().unwrap_or(tolerance)))
    };
    let expected: Option<Vec<(f64, f64)>> = expected.split(',').map(tolerated).collect();
    let is_met = expected.is_some_and(|expected| {
        let is_close = |(found, (number, by)): (&f64, &(f64, f64))| (found - number).abs() <= *by;
        found.len() == expected.len() && found.iter().zip(&expected).all(is_close)
    });
    (is_met, format!("{found:?}"))
}
