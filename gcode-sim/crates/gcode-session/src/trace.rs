//! Trace of a run, block by block: execution counts and values of variables.
use std::collections::BTreeMap;

use gcode_control::{Control, Observer, Outcome, Value};
use gcode_lang::source::{SourceId, Span};
use gcode_lang::syntax::parse;

/// Largest number of variables recorded per block; a block that fills a table by computed numbers has
/// thousands.
const MAX_VALUES: usize = 40;

/// Variables that are not recorded: alarm, clocks and date. The control treats reading a clock as waiting.
const IGNORED_VARIABLES: [u32; 5] = [3000, 3001, 3002, 3011, 3012];

/// All executed blocks of a run, with the values of their variables. Record it with
/// [`run_observed`](crate::run_observed).
#[derive(Clone, Debug, Default)]
pub struct Trace {
    blocks: BTreeMap<(SourceId, u32), ExecutedBlock>,
    /// Variables that each block names by number.
    named_variables: BTreeMap<(SourceId, u32), Vec<u32>>,
    read_sources: Vec<SourceId>,
    current: Option<CurrentBlock>,
}

/// The block being executed.
#[derive(Clone, Debug)]
struct CurrentBlock {
    block: Span,
    level: usize,
    assigned: Vec<u32>,
}

/// Executions of one block.
#[derive(Clone, Debug)]
pub struct ExecutedBlock {
    /// The block in its file.
    pub block: Span,
    /// Number of executions.
    pub count: u64,
    /// Values of its variables, in the order of first use.
    pub values: Vec<VariableValues>,
    /// Whether the block has more variables than are recorded.
    pub is_truncated: bool,
}

/// Values of one variable in one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariableValues {
    /// Number of the variable.
    pub number: u32,
    /// Use of the variable in the block.
    pub role: VariableRole,
    /// Number of recorded values.
    pub count: u64,
    /// First value.
    pub first: Value,
    /// Last value.
    pub last: Value,
    /// Least and greatest numeric value; `None` if it was never a number.
    pub range: Option<(f64, f64)>,
    /// True if it was vacant at least once.
    pub has_been_vacant: bool,
}

/// Use of a variable in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum VariableRole {
    /// The block names it; the value before the block.
    Read,
    /// The block assigns it; the value after the block.
    Assigned,
    /// A local variable of the called program: an argument.
    Argument,
}

impl Trace {
    /// Returns the blocks in the order of the files and their lines.
    pub fn blocks(&self) -> impl Iterator<Item = &ExecutedBlock> {
        self.blocks.values()
    }

    /// Records the variables that the blocks of a file name, once per file.
    fn read_source(&mut self, control: &Control, source: SourceId) {
        if self.read_sources.contains(&source) {
            return;
        }
        self.read_sources.push(source);
        let bytes = &control.memory().sources().get(source).bytes;
        // Reading a file of a million moves for variables takes a seventh of the page's time.
        if !bytes.contains(&b'#') {
            return;
        }
        for block in parse(source, bytes).iter().flat_map(|program| &program.blocks) {
            let mut numbers = gcode_lint::variables_read(block);
            numbers.retain(|number| !IGNORED_VARIABLES.contains(number));
            if !numbers.is_empty() {
                self.named_variables.insert((source, block.span.start), numbers);
            }
        }
    }
}

impl Observer for Trace {
    fn before_block(&mut self, control: &mut Control) {
        self.current = None;
        let Some(block) = control.next_block() else { return };
        self.read_source(control, block.source);
        let key = (block.source, block.start);
        let new = || ExecutedBlock { block, count: 0, values: Vec::new(), is_truncated: false };
        let executed = self.blocks.entry(key).or_insert_with(new);
        executed.count += 1;
        for number in self.named_variables.get(&key).into_iter().flatten() {
            if let Ok(value) = control.variable(*number) {
                executed.record_value(*number, VariableRole::Read, value);
            }
        }
        let mut assigned = control.next_assigned_variables();
        assigned.retain(|number| !IGNORED_VARIABLES.contains(number));
        self.current = Some(CurrentBlock { block, level: control.vars().level(), assigned });
    }

    fn after_block(&mut self, control: &Control) {
        // A block that alarms has changed nothing.
        if matches!(control.outcome(), Some(Outcome::Alarm(_))) {
            return;
        }
        let Some(now) = self.current.take() else { return };
        let Some(executed) = self.blocks.get_mut(&(now.block.source, now.block.start)) else { return };
        for number in now.assigned {
            if let Ok(value) = control.variable(number) {
                executed.record_value(number, VariableRole::Assigned, value);
            }
        }
        if control.vars().level() > now.level {
            let locals = control.vars().locals();
            for number in (1..=33).filter(|number| !locals.get(*number).is_vacant()) {
                executed.record_value(number as u32, VariableRole::Argument, locals.get(number));
            }
        }
    }
}

impl ExecutedBlock {
    fn record_value(&mut self, number: u32, role: VariableRole, value: Value) {
        let at = self.values.iter().position(|values| values.number == number && values.role == role);
        if at.is_none() && self.values.len() == MAX_VALUES {
            self.is_truncated = true;
            return;
        }
        let at = at.unwrap_or_else(|| {
            let (first, last) = (value, value);
            let values =
                VariableValues { number, role, count: 0, first, last, range: None, has_been_vacant: false };
            self.values.push(values);
            self.values.len() - 1
        });
        let values = &mut self.values[at];
        values.count += 1;
        values.last = value;
        values.has_been_vacant |= value.is_vacant();
        if let Some(number) = value.as_number() {
            let (low, high) = values.range.unwrap_or((number, number));
            values.range = Some((low.min(number), high.max(number)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Request, run_observed};
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;

    fn trace(text: &str) -> Trace {
        let request = Request::new("O1.nc", text.as_bytes().to_vec(), Machine::default());
        let mut trace = Trace::default();
        run_observed(&request, &mut NoLibrary, &mut (), &mut trace).unwrap();
        trace
    }

    /// Returns the executed lines, counted from 1, with their numbers of executions.
    fn times(text: &str) -> Vec<(usize, u64)> {
        let line = |executed: &ExecutedBlock| text[..executed.block.start as usize].lines().count() + 1;
        trace(text).blocks().map(|executed| (line(executed), executed.count)).collect()
    }

    #[test]
    fn executed_blocks_are_counted_and_skipped_ones_are_absent() {
        let text = "O1\n#1=0\nWHILE[#1 LT 3]DO1\n#1=#1+1\nEND1\nGOTO9\n#2=1\nN9 M30\n";
        // The loop's condition is evaluated a fourth time and is false.
        assert_eq!(times(text), [(2, 1), (3, 4), (4, 3), (5, 3), (6, 1), (8, 1)]);
    }

    #[test]
    fn a_variable_in_a_loop_has_first_and_last_value_and_range() {
        let trace = trace("O1\n#1=3\nWHILE[#1 GT 0]DO1\n#1=#1-1\nEND1\nM30\n");
        let block = trace.blocks().nth(2).unwrap();
        let number = Value::Number;
        let read = VariableValues {
            number: 1,
            role: VariableRole::Read,
            count: 3,
            first: number(3.0),
            last: number(1.0),
            range: Some((1.0, 3.0)),
            has_been_vacant: false,
        };
        let assigned = VariableValues {
            role: VariableRole::Assigned,
            first: number(2.0),
            last: number(0.0),
            range: Some((0.0, 2.0)),
            ..read
        };
        assert_eq!(block.values, [read, assigned]);
    }

    #[test]
    fn a_call_shows_its_arguments() {
        let trace = trace("O1\nG65 P2 A4.5 X2.\nM30\nO2\n#2=#1\nM99\n");
        let passed: Vec<_> =
            trace.blocks().next().unwrap().values.iter().map(|v| (v.number, v.role)).collect();
        assert_eq!(passed, [(1, VariableRole::Argument), (24, VariableRole::Argument)], "A is #1, X is #24");
    }

    #[test]
    fn a_block_that_alarms_assigns_nothing() {
        let trace = trace("O1\n#1=2/0\nM30\n");
        let block = trace.blocks().next().unwrap();
        assert_eq!((block.count, block.values.len()), (1, 0));
    }
}
