//! Breakpoints: on lines, on programs and their sequence numbers, on variables.
use std::collections::BTreeMap;

use super::hit_condition::HitCondition;
use super::log_message::LogMessage;
use gcode_control::{Control, Evaluation};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::Expression;
use gcode_lang::source::SourceId;
use gcode_lang::syntax::ast::ProgramName;

/// What has to hold at a breakpoint for the run to stop there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Conditions {
    /// Condition, or an expression that isn't 0.
    pub(crate) condition: Option<Expression>,
    pub(crate) hits: Option<HitCondition>,
    /// Message that is written in place of a stop.
    pub(crate) log: Option<LogMessage>,
}

/// Breakpoint with its conditions and its hits.
#[derive(Clone, Debug)]
pub(crate) struct Breakpoint<P> {
    pub(crate) id: i64,
    pub(crate) place: P,
    pub(crate) conditions: Conditions,
    /// Positions of the hits so far, if a hit condition counts them.
    hits: Vec<u64>,
}

/// Block of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BlockPlace {
    /// Canonical path of the file.
    pub(crate) path: String,
    /// Offset of the block.
    pub(crate) start: u32,
}

/// Program, or a sequence number in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ProgramPlace {
    /// Program; `None` for the main program.
    pub(crate) name: Option<ProgramName>,
    /// Sequence number; `None` for the first block.
    pub(crate) number: Option<u32>,
}

/// Variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct VariablePlace {
    pub(crate) number: u32,
    /// Macro level of a local; `None` for every level.
    pub(crate) level: Option<usize>,
    pub(crate) on_write: bool,
    pub(crate) on_read: bool,
}

/// What follows from reaching a breakpoint.
#[derive(Debug, PartialEq)]
pub(crate) enum Hit {
    /// The run goes on.
    None,
    Stop,
    Log(String),
    /// The run stops, because the condition can't be evaluated.
    Refused(Alarm),
}

impl<P> Breakpoint<P> {
    pub(crate) fn new(id: i64, place: P, conditions: Conditions) -> Self {
        Self { id, place, conditions, hits: Vec::new() }
    }

    /// Takes over the hits of an equal breakpoint.
    fn continue_hits(&mut self, old: &[Self])
    where
        P: PartialEq,
    {
        let equal = |one: &&Self| one.place == self.place && one.conditions == self.conditions;
        self.hits = old.iter().find(equal).map(|one| one.hits.clone()).unwrap_or_default();
    }

    /// Decides about a forward pass at a position.
    fn reach(&mut self, control: &Control, position: u64) -> Hit {
        match self.condition_holds(control) {
            Ok(true) => {}
            Ok(false) => return Hit::None,
            Err(alarm) => return Hit::Refused(alarm),
        }
        if let Some(condition) = self.conditions.hits
            && !condition.holds(self.count_hit(position))
        {
            return Hit::None;
        }
        match &self.conditions.log {
            Some(message) => Hit::Log(message.text(control)),
            None => Hit::Stop,
        }
    }

    /// Returns true if a forward pass at a position has stopped or would stop there.
    fn stops_backwards(&self, control: &Control, position: u64) -> bool {
        let counted = |condition: HitCondition| {
            self.hits.binary_search(&position).is_ok_and(|index| condition.holds(index as u64 + 1))
        };
        self.conditions.log.is_none()
            && self.condition_holds(control).unwrap_or(true)
            && self.conditions.hits.is_none_or(counted)
    }

    fn condition_holds(&self, control: &Control) -> Result<bool, Alarm> {
        let Some(condition) = &self.conditions.condition else { return Ok(true) };
        Ok(match control.evaluate(condition, control.vars().level())? {
            Evaluation::Condition(is_true) => is_true,
            Evaluation::Value(value) => value.number() != 0.0,
        })
    }

    /// Counts a hit once, and returns its number.
    fn count_hit(&mut self, position: u64) -> u64 {
        let index = match self.hits.binary_search(&position) {
            Ok(index) => index,
            Err(index) => {
                self.hits.insert(index, position);
                index
            }
        };
        index as u64 + 1
    }
}

/// Hits of one place, of all breakpoints there.
#[derive(Debug, Default)]
pub(crate) struct Hits {
    /// Breakpoints that stop the run.
    pub(crate) ids: Vec<i64>,
    pub(crate) messages: Vec<String>,
    /// Alarm of a condition.
    pub(crate) refusal: Option<Alarm>,
}

impl Hits {
    fn add(&mut self, id: i64, hit: Hit) {
        match hit {
            Hit::None => {}
            Hit::Stop => self.ids.push(id),
            Hit::Log(message) => self.messages.push(message),
            Hit::Refused(alarm) => {
                self.ids.push(id);
                self.refusal = Some(alarm);
            }
        }
    }
}

/// All breakpoints.
#[derive(Default)]
pub(crate) struct Breakpoints {
    pub(crate) lines: Vec<Breakpoint<BlockPlace>>,
    pub(crate) programs: Vec<Breakpoint<ProgramPlace>>,
    pub(crate) variables: Vec<Breakpoint<VariablePlace>>,
    /// Indices of the breakpoints on lines by their blocks.
    sites: BTreeMap<(SourceId, u32), Vec<usize>>,
    /// Number of the texts for which the sites hold.
    located_sources: usize,
}

impl Breakpoints {
    /// Returns true if no place is watched.
    pub(crate) fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.programs.is_empty() && self.variables.is_empty()
    }

    /// Replaces the breakpoints of one file.
    pub(crate) fn replace_lines(&mut self, path: &str, mut new: Vec<Breakpoint<BlockPlace>>) {
        new.iter_mut().for_each(|one| one.continue_hits(&self.lines));
        self.lines.retain(|one| one.place.path != path);
        self.lines.extend(new);
        self.located_sources = 0;
    }

    /// Replaces the breakpoints on programs.
    pub(crate) fn replace_programs(&mut self, mut new: Vec<Breakpoint<ProgramPlace>>) {
        new.iter_mut().for_each(|one| one.continue_hits(&self.programs));
        self.programs = new;
    }

    /// Replaces the breakpoints on variables.
    pub(crate) fn replace_variables(&mut self, mut new: Vec<Breakpoint<VariablePlace>>) {
        new.iter_mut().for_each(|one| one.continue_hits(&self.variables));
        self.variables = new;
    }

    /// Returns true if a text has been loaded since the breakpoints were located.
    #[inline]
    pub(crate) fn located_for_fewer(&self, control: &Control) -> bool {
        control.memory().sources().count() != self.located_sources
    }

    /// Finds the blocks of the breakpoints in the loaded texts, if there are others than before.
    pub(crate) fn locate(&mut self, control: &Control, canonical: &dyn Fn(&str) -> String) {
        let sources = control.memory().sources();
        let count = sources.count();
        if count == self.located_sources {
            return;
        }
        self.located_sources = count;
        self.sites.clear();
        for (id, source) in sources.iter() {
            let path = canonical(&source.name);
            for (index, _) in self.lines.iter().enumerate().filter(|(_, one)| one.place.path == path) {
                self.sites.entry((id, self.lines[index].place.start)).or_default().push(index);
            }
        }
    }

    /// Reaches the breakpoints on the next block.
    pub(crate) fn reach_block(&mut self, control: &Control, site: (SourceId, u32), position: u64) -> Hits {
        let mut hits = Hits::default();
        for index in self.sites.get(&site).into_iter().flatten() {
            let breakpoint = &mut self.lines[*index];
            hits.add(breakpoint.id, breakpoint.reach(control, position));
        }
        hits
    }

    /// Reaches the breakpoints on programs.
    pub(crate) fn reach_programs(&mut self, arrival: &Arrival<'_>, position: u64) -> Hits {
        let mut hits = Hits::default();
        for breakpoint in &mut self.programs {
            if arrival.is_at(&breakpoint.place) {
                hits.add(breakpoint.id, breakpoint.reach(arrival.control, position));
            }
        }
        hits
    }

    /// Reaches the breakpoints on variables that a block has written or read on a macro level.
    pub(crate) fn reach_variables(
        &mut self,
        control: &Control,
        (level, access): (usize, &Access),
        position: u64,
    ) -> Hits {
        let mut hits = Hits::default();
        for breakpoint in &mut self.variables {
            if access.concerns(&breakpoint.place, level) {
                hits.add(breakpoint.id, breakpoint.reach(control, position));
            }
        }
        hits
    }

    /// Returns the breakpoints on the next block's line and program at which a run that goes back stops.
    pub(crate) fn stops_before(
        &self,
        arrival: &Arrival<'_>,
        site: (SourceId, u32),
        position: u64,
    ) -> (Vec<i64>, Vec<i64>) {
        let control = arrival.control;
        let on_line = self.sites.get(&site).into_iter().flatten().map(|index| &self.lines[*index]);
        let lines = on_line.filter(|one| one.stops_backwards(control, position)).map(|one| one.id).collect();
        let programs = self.programs.iter().filter(|one| arrival.is_at(&one.place));
        let programs = programs.filter(|one| one.stops_backwards(control, position)).map(|one| one.id);
        (lines, programs.collect())
    }

    /// Returns the breakpoints on variables at which a run that goes back stops in front of the next block.
    pub(crate) fn stops_at_access(&self, control: &Control, access: &Access, position: u64) -> Vec<i64> {
        let level = control.vars().level();
        let concerned = self.variables.iter().filter(|one| access.concerns(&one.place, level));
        concerned.filter(|one| one.stops_backwards(control, position)).map(|one| one.id).collect()
    }

    /// Forgets the hits behind a position, from which the run goes another way.
    pub(crate) fn forget_hits_behind(&mut self, position: u64) {
        let forget = |hits: &mut Vec<u64>| hits.retain(|hit| *hit <= position);
        self.lines.iter_mut().for_each(|one| forget(&mut one.hits));
        self.programs.iter_mut().for_each(|one| forget(&mut one.hits));
        self.variables.iter_mut().for_each(|one| forget(&mut one.hits));
    }
}

/// Variables that a block writes and reads.
#[derive(Debug, Default)]
pub(crate) struct Access {
    pub(crate) written: Vec<u32>,
    pub(crate) read: Vec<u32>,
}

impl Access {
    /// Returns the access of the next block.
    pub(crate) fn of_next(control: &Control) -> Self {
        Self { written: control.next_assigned_variables(), read: control.next_read_variables() }
    }

    fn concerns(&self, place: &VariablePlace, level: usize) -> bool {
        place.level.is_none_or(|of| of == level)
            && (place.on_write && self.written.contains(&place.number)
                || place.on_read && self.read.contains(&place.number))
    }
}

/// Next block as a place in its program.
pub(crate) struct Arrival<'a> {
    pub(crate) control: &'a Control,
    /// The program has just begun.
    pub(crate) has_entered: bool,
}

impl Arrival<'_> {
    fn is_at(&self, place: &ProgramPlace) -> bool {
        let memory = self.control.memory();
        let id = self.control.program_at_work();
        let Some(program) = memory.programs().get(id.0 as usize) else { return false };
        let is_program = place.name.as_ref().map_or(id == memory.main(), |name| *name == program.name);
        is_program
            && match place.number {
                None => self.has_entered,
                Some(number) => self.control.next_number() == Some(number),
            }
    }
}
