//! Record as a file: JSON with one step, one block and one hole per line, so that changes of it are readable.
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use nalgebra::{Point3, Unit, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::block_list::BlockList;
use super::block_location::{BlockLocation, OtherBlock};
use super::first_command::FirstCommand;
use super::legacy_records::present_words;
use super::modal_conditions::{ModalAspect, ModalConditions, ModalSetting};
use super::other_blocks::other_blocks;
use super::record::{EndState, Record, Totals};
use super::recorder::RunStart;
use super::step_list::{NewStep, StepList};
use super::steps::{Step, StepKind, UnsimulatedKind};
use gcode_inspect::holes::{DrilledHole, PassCut};
use gcode_lang::motion::{Axes, Backtrace, PlanarArc, Position, SpindleDirection, StopKind, UnknownAxes};
use gcode_lang::units::Deg;

/// Version of the format.
const VERSION: u32 = 1;

/// An accepted result: the record of a run as JSON.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AcceptedFile {
    version: u32,
    axes: String,
    /// Name of the main program as a control shows it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    program: Option<String>,
    totals: Totals,
    ending: EndState,
    /// True if a reference judged the result.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    verified: bool,
    #[serde(rename = "places")]
    blocks: Vec<BlockLocation>,
    /// Blocks that no step names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    other_blocks: Option<Vec<OtherBlock>>,
    /// The first commands of the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    begun: Option<Vec<FirstCommand>>,
    steps: Vec<StepLine>,
    holes: Vec<Hole>,
}

/// A step: its action, the end positions of the axes it moves (mm and degrees), and the number of its block.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
enum StepLine {
    Rapid {
        to: BTreeMap<char, f64>,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Feed {
        to: BTreeMap<char, f64>,
        f: f64,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Arc {
        to: BTreeMap<char, f64>,
        plane: [char; 2],
        centre: [f64; 2],
        sweep: f64,
        f: f64,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Probe {
        to: BTreeMap<char, f64>,
        f: f64,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Dwell {
        seconds: f64,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Tool {
        number: u32,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Length {
        offset: BTreeMap<char, f64>,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Spindle {
        turning: SpindleDirection,
        speed: f64,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Coolant {
        on: bool,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        m: Option<u32>,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Auxiliary {
        m: u32,
        #[serde(rename = "place")]
        block_number: usize,
    },
    Stop {
        kind: StopKind,
        text: String,
        named: Vec<(u32, f64)>,
        #[serde(rename = "place")]
        block_number: usize,
    },
    /// A command of a block without motion.
    Silent {
        what: UnsimulatedKind,
        code: String,
        #[serde(rename = "place")]
        block_number: usize,
    },
    /// Not a step: a modal condition from here on. Holes do not count it among their steps.
    Under {
        what: ModalAspect,
        code: String,
        #[serde(rename = "place")]
        block_number: Option<usize>,
    },
    /// Not a step: the block whose T, S or F the steps from here on use; null for their own blocks.
    Word {
        letter: char,
        #[serde(rename = "place")]
        block_number: Option<usize>,
    },
}

/// A hole in the part's frame, and the steps that cut it.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Hole {
    entry: [f64; 3],
    axis: [f64; 3],
    depth: f64,
    diameter: Option<f64>,
    tool: Option<u32>,
    steps: Vec<usize>,
    /// The hole that this one repeats, counted from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    again: Option<usize>,
}

/// Reason why an accepted result is not readable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct StoreError(String);

impl Record {
    /// Writes the record as JSON.
    ///
    /// # Errors
    /// A value that JSON cannot represent.
    pub fn to_json(&self) -> Result<String, StoreError> {
        let mut at = Position::default();
        let mut steps = Vec::with_capacity(self.steps.len());
        let mut under = ModalConditions::default();
        let mut words: BTreeMap<char, usize> = BTreeMap::new();
        for (index, step) in self.steps.iter().enumerate() {
            let now = self.under(index);
            for what in ModalAspect::ALL.into_iter().filter(|what| now.word(*what) != under.word(*what)) {
                let ModalSetting { text, block_number } = now.word(what).clone();
                steps.push(StepLine::Under { what, code: text, block_number });
            }
            under.clone_from(now);
            if let Some(letter) = step.kind.letter()
                && words.get(&letter) != step.set_by.as_ref()
            {
                steps.push(StepLine::Word { letter, block_number: step.set_by });
                match step.set_by {
                    Some(block_number) => _ = words.insert(letter, block_number),
                    None => _ = words.remove(&letter),
                }
            }
            steps.push(self.line(&step, &at));
            at = step.at;
        }
        let holes = self.holes.iter().zip(&self.feeds).enumerate().map(|(number, (hole, steps))| Hole {
            entry: hole.entry.coords.into(),
            axis: hole.axis.into_inner().into(),
            depth: hole.depth,
            diameter: hole.diameter,
            tool: hole.tool,
            steps: steps.clone(),
            again: (hole.first_on_line != number).then_some(hole.first_on_line),
        });
        let blocks: Vec<_> = (0..self.blocks.len()).map(|number| self.blocks.location(number)).collect();
        let axes: String = self.axes.iter().map(|(_, letter)| letter).collect();
        let mut text = String::from("{\n");
        let _ = writeln!(text, "\"version\": {VERSION},\n\"axes\": \"{axes}\",");
        if let Some(program) = &self.program {
            let _ = writeln!(text, "\"program\": {},", json(program)?);
        }
        let _ = writeln!(text, "\"totals\": {},\n\"ending\": {},", json(&self.totals)?, json(&self.ending)?);
        if self.is_verified {
            text.push_str("\"verified\": true,\n");
        }
        let _ = writeln!(text, "\"places\": {},", lines(&blocks)?);
        if let Some(others) = other_blocks(self) {
            let _ = writeln!(text, "\"other_blocks\": {},", lines(&others)?);
        }
        if let Some(begun) = &self.first_commands {
            let _ = writeln!(text, "\"begun\": {},", lines(begun)?);
        }
        let _ = writeln!(text, "\"steps\": {},", lines(&steps)?);
        let _ = writeln!(text, "\"holes\": {}", lines(&holes.collect::<Vec<_>>())?);
        text.push_str("}\n");
        Ok(text)
    }

    /// Reads the result of [`Record::to_json`].
    ///
    /// # Errors
    /// The first invalid value, with its line.
    pub fn from_json(text: &str) -> Result<Self, StoreError> {
        let file: AcceptedFile = serde_json::from_str(text).map_err(|error| StoreError(error.to_string()))?;
        if file.version != VERSION {
            return Err(StoreError(format!(
                "version {} is unknown: this program reads version {VERSION}",
                file.version
            )));
        }
        let axes =
            Axes::new(&file.axes).ok_or_else(|| StoreError(format!("axes '{}' are not valid", file.axes)))?;
        let mut reader = Steps {
            axes: &axes,
            at: Position::default(),
            length: Position::default(),
            conditions: vec![ModalConditions::default()],
            words: BTreeMap::new(),
        };
        let mut steps = StepList::default();
        for line in file.steps {
            reader.step(line)?.into_iter().for_each(|step| steps.push(step));
        }
        let conditions = reader.conditions;
        let named = conditions.iter().flat_map(|condition| &condition.0).filter_map(|word| word.block_number);
        if let Some(block_number) = named.max().filter(|block_number| file.blocks.len() <= *block_number) {
            return Err(StoreError(format!("a mode names block {block_number}, which does not exist")));
        }
        let mut named = (0..steps.len()).flat_map(|step| [steps.block_number(step), steps.editable_at(step)]);
        if let Some(block_number) = named.find(|block_number| file.blocks.len() <= *block_number) {
            return Err(StoreError(format!("a step names block {block_number}, which does not exist")));
        }
        let mut feeds = Vec::with_capacity(file.holes.len());
        let mut holes = Vec::with_capacity(file.holes.len());
        for hole in file.holes {
            if hole.steps.iter().any(|step| steps.len() <= *step) {
                return Err(StoreError("a hole names a step that does not exist".to_owned()));
            }
            if hole.again.is_some_and(|first| {
                holes.get(first).is_none_or(|hole: &DrilledHole| hole.first_on_line != first)
            }) {
                return Err(StoreError("a hole repeats one that does not precede it".to_owned()));
            }
            holes.push(hole.found(holes.len())?);
            feeds.push(hole.steps);
        }
        let mut commands = file.begun.iter().flatten();
        if let Some(FirstCommand { text, block_number, .. }) =
            commands.find(|command| file.blocks.len() <= command.block_number)
        {
            return Err(StoreError(format!("{text} names block {block_number}, which does not exist")));
        }
        let (blocks, mut ending, totals) = (file.blocks, file.ending, file.totals);
        ending.words = present_words(&ending.words);
        Ok(Self {
            axes,
            start: RunStart::default(),
            steps,
            holes,
            feeds,
            unfinished: BTreeSet::new(),
            blocks: BlockList::Listed(blocks),
            other_blocks: file.other_blocks,
            conditions,
            first_commands: file.begun,
            program: file.program,
            ending,
            is_verified: file.verified,
            totals,
        })
    }

    fn line(&self, step: &Step<'_>, before: &Position) -> StepLine {
        let block_number = step.block_number;
        let to = moved(&self.axes, before, &step.at);
        match step.kind {
            StepKind::Rapid => StepLine::Rapid { to, block_number },
            StepKind::Feed(f) => StepLine::Feed { to, f: *f, block_number },
            StepKind::Arc(arc, f) => StepLine::Arc {
                to,
                plane: [self.axes.letter(arc.plane.0), self.axes.letter(arc.plane.1)],
                centre: [arc.centre.0, arc.centre.1],
                sweep: arc.sweep.0,
                f: *f,
                block_number,
            },
            StepKind::Probe(f) => StepLine::Probe { to, f: *f, block_number },
            StepKind::Dwell(seconds) => StepLine::Dwell { seconds: *seconds, block_number },
            StepKind::Tool(number) => StepLine::Tool { number: *number, block_number },
            StepKind::Length(offset) => {
                StepLine::Length { offset: moved(&self.axes, &Position::default(), offset), block_number }
            }
            StepKind::Spindle(turning, speed) => {
                StepLine::Spindle { turning: *turning, speed: *speed, block_number }
            }
            StepKind::Coolant(on, m) => StepLine::Coolant { on: *on, m: *m, block_number },
            StepKind::Auxiliary(m) => StepLine::Auxiliary { m: *m, block_number },
            StepKind::Stop(kind, text, named) => {
                StepLine::Stop { kind: *kind, text: text.clone(), named: named.clone(), block_number }
            }
            StepKind::Silent(what, code) => {
                StepLine::Silent { what: *what, code: code.clone(), block_number }
            }
        }
    }
}

/// Returns the positions of the axes that moved.
fn moved(axes: &Axes, before: &Position, at: &Position) -> BTreeMap<char, f64> {
    let moved = axes.iter().filter(|(axis, _)| before[*axis] != at[*axis]);
    moved.map(|(axis, letter)| (letter, at[axis])).collect()
}

fn json(value: &impl Serialize) -> Result<String, StoreError> {
    serde_json::to_string(value).map_err(|error| StoreError(error.to_string()))
}

/// Writes a list with one element per line.
fn lines(values: &[impl Serialize]) -> Result<String, StoreError> {
    let all = values.iter().map(json).collect::<Result<Vec<_>, _>>()?;
    Ok(if all.is_empty() { "[]".to_owned() } else { format!("[\n{}\n]", all.join(",\n")) })
}

/// Reads steps and tracks the axes.
struct Steps<'a> {
    axes: &'a Axes,
    at: Position,
    length: Position,
    conditions: Vec<ModalConditions>,
    /// Blocks of the T, S and F that the steps use; none for a letter in their own blocks.
    words: BTreeMap<char, usize>,
}

impl Steps<'_> {
    /// Reads a line; `None` if it is no step.
    fn step(&mut self, line: StepLine) -> Result<Option<NewStep>, StoreError> {
        let (kind, block_number) = match line {
            StepLine::Rapid { to, block_number } => (self.go(&to, StepKind::Rapid)?, block_number),
            StepLine::Feed { to, f, block_number } => (self.go(&to, StepKind::Feed(f))?, block_number),
            StepLine::Probe { to, f, block_number } => (self.go(&to, StepKind::Probe(f))?, block_number),
            StepLine::Arc { to, plane: [first, second], centre, sweep, f, block_number } => {
                let plane = (self.axis(first)?, self.axis(second)?);
                let arc = PlanarArc { plane, centre: (centre[0], centre[1]), sweep: Deg(sweep) };
                (self.go(&to, StepKind::Arc(arc, f))?, block_number)
            }
            StepLine::Dwell { seconds, block_number } => (StepKind::Dwell(seconds), block_number),
            StepLine::Tool { number, block_number } => (StepKind::Tool(number), block_number),
            StepLine::Length { offset, block_number } => {
                self.length = self.put(&offset, Position::default())?;
                (StepKind::Length(Box::new(self.length)), block_number)
            }
            StepLine::Spindle { turning, speed, block_number } => {
                (StepKind::Spindle(turning, speed), block_number)
            }
            StepLine::Coolant { on, m, block_number } => (StepKind::Coolant(on, m), block_number),
            StepLine::Auxiliary { m, block_number } => (StepKind::Auxiliary(m), block_number),
            StepLine::Stop { kind, text, named, block_number } => {
                (StepKind::Stop(kind, text, named), block_number)
            }
            StepLine::Silent { what, code, block_number } => (StepKind::Silent(what, code), block_number),
            StepLine::Under { what, code, block_number } => {
                let mut next = self.conditions.last().cloned().unwrap_or_default();
                next.set(what, ModalSetting { text: code, block_number });
                self.conditions.push(next);
                return Ok(None);
            }
            StepLine::Word { letter, block_number } => {
                match block_number {
                    Some(block_number) => _ = self.words.insert(letter, block_number),
                    None => _ = self.words.remove(&letter),
                }
                return Ok(None);
            }
        };
        let set_by = kind.letter().and_then(|letter| self.words.get(&letter)).copied();
        Ok(Some(NewStep {
            kind,
            at: self.at,
            length: self.length,
            zero: Position::default(),
            unknown: UnknownAxes::default(),
            block_number,
            set_by,
            condition: self.conditions.len() - 1,
        }))
    }

    fn go(&mut self, to: &BTreeMap<char, f64>, kind: StepKind) -> Result<StepKind, StoreError> {
        self.at = self.put(to, self.at)?;
        Ok(kind)
    }

    fn put(&self, values: &BTreeMap<char, f64>, mut position: Position) -> Result<Position, StoreError> {
        for (letter, value) in values {
            position[self.axis(*letter)?] = *value;
        }
        Ok(position)
    }

    fn axis(&self, letter: char) -> Result<usize, StoreError> {
        let found = u8::try_from(letter).ok().and_then(|letter| self.axes.find(letter));
        found.ok_or_else(|| StoreError(format!("a step names axis {letter}, which does not exist")))
    }
}

impl Hole {
    fn found(&self, number: usize) -> Result<DrilledHole, StoreError> {
        let (entry, axis) = (Point3::from(self.entry), Vector3::from(self.axis));
        if (axis.norm() - 1.0).abs() > 1e-9 {
            return Err(StoreError("a hole's axis is not a unit vector".to_owned()));
        }
        Ok(DrilledHole {
            entry,
            // Normalising again would change the last digits.
            axis: Unit::new_unchecked(axis),
            depth: self.depth,
            diameter: self.diameter,
            tool: self.tool,
            backtrace: Backtrace::default(),
            axis_position: Position::default(),
            is_tool_axis_known: false,
            unknown_axes: UnknownAxes::default(),
            earlier_passes: Vec::new(),
            finishing_cut: PassCut::new(entry, entry - axis * self.depth),
            finishing_index: 0,
            surface: None,
            first_on_line: self.again.unwrap_or(number),
        })
    }
}

#[cfg(test)]
mod tests {
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;
    use gcode_session::Request;

    use super::*;
    use crate::{Revision, changes};

    /// F stands in line 3, the moves that it feeds in lines 4 and 5; the accepted result keeps line 3.
    #[test]
    fn a_word_of_an_earlier_block_keeps_its_place_in_the_file() {
        let [old, new] = [100, 200].map(|feed| {
            let text = format!("O1\nG90 G54\nG1 X0 Y0 Z0 F{feed}\nX10.\nX20.\nG4 P1\nG1 X30. F50\nM30\n");
            let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
            Revision::of(&request, &mut NoLibrary, None).unwrap().record
        });
        let accepted = Record::from_json(&old.to_json().unwrap()).unwrap();
        assert!(changes(&accepted, &old, 1e-4).is_empty());
        let found = changes(&accepted, &new, 1e-4);
        let lines = [&found[0].old, &found[0].new].map(|at| at.as_ref().unwrap().line);
        assert_eq!((found.len(), &*found[0].code, lines), (1, "feed", [3, 3]));
    }
}
