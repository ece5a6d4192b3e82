//! Inspection and changes between two blocks, as on the screen of a control: the calls, locals of every level, typed
//! expressions, and the next block.
use super::control::Control;
use super::data::Register;
use super::executor::Executor;
use super::flow::{CallFrame, FrameKind};
use super::functions::variable_number;
use super::registers::Registers;
use super::variables::{Locals, Value, VariableClass, Vars};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{CallChain, Position};
use gcode_lang::program::{
    ArgumentLocals, AssignmentTarget, CallCode, Expression, Op, OpKind, ProgramId, Slot, argument_letter,
};
use gcode_lang::source::Span;

/// One program of the call stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StackedProgram {
    /// Program.
    pub program: ProgramId,
    /// Next block, or the block that has called the program above.
    pub block: Span,
    /// Macro level, whose locals the program reads: 0 for the main program.
    pub level: usize,
}

/// Result of a typed expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evaluation {
    /// Value of an expression.
    Value(Value),
    /// Truth of a condition.
    Condition(bool),
}

/// Returns true for a variable that stops the run when it is written: #3000 and #3006.
fn is_stop(number: u32) -> bool {
    matches!(number, 3000 | 3006)
}

impl Vars {
    /// Returns the locals of a macro level; those of the current one from [`Vars::level`] on.
    pub fn locals_of(&self, level: usize) -> Locals {
        self.outer_level(level).copied().unwrap_or_else(|| self.locals())
    }

    /// Iterates over the numbers of all common variables, in ascending order within the control's own and the further ones.
    pub fn common_numbers(&self) -> impl Iterator<Item = u32> + '_ {
        (100..=199).chain(500..=999).chain(self.extra_numbers())
    }
}

impl Control {
    /// Returns the number of programs that wait for the end of the one at work.
    pub fn call_depth(&self) -> usize {
        self.executor.flow.callers.len()
    }

    /// Returns the number of passes of the called program at work that follow this one, by L of its call.
    pub fn passes_left(&self) -> u32 {
        self.executor.flow.frame.repeats
    }

    /// Returns the program at work.
    pub fn program_at_work(&self) -> ProgramId {
        self.executor.flow.frame.program
    }

    /// Returns the sequence number of [`Control::next_block`].
    pub fn next_number(&self) -> Option<u32> {
        self.next_op()?.number
    }

    /// Returns the program at work and its callers, innermost first. The next block has to be lowered by
    /// [`Control::next_block`].
    pub fn call_stack(&self) -> Vec<StackedProgram> {
        let flow = &self.executor.flow;
        let mut level = self.vars().level();
        let mut calls: &CallChain = &flow.frame.calls;
        let mut stack = vec![StackedProgram { program: flow.frame.program, block: self.next_span(), level }];
        let mut called = &flow.frame;
        for caller in flow.callers.iter().rev() {
            level -= usize::from(has_own_level(called));
            let block = calls.as_ref().map_or_else(Span::default, |call| call.calling_block);
            stack.push(StackedProgram { program: caller.program, block, level });
            calls = calls.as_ref().map_or(&None, |call| &call.outer_calls);
            called = caller;
        }
        stack
    }

    /// Returns the span of the next block, or of the end of the program.
    fn next_span(&self) -> Span {
        let CallFrame { program, next, .. } = self.executor.flow.frame;
        match self.memory.programs().get(program.0 as usize) {
            Some(found) => found.op(next).map_or(Span { start: found.span.end, ..found.span }, |op| op.span),
            None => Span::default(),
        }
    }

    /// Returns true if [`Control::next_block`] has neither words nor a statement nor a sequence number: an empty line or a
    /// comment.
    pub fn is_next_empty(&self) -> bool {
        let is_empty = |op: &Op| op.number.is_none() && matches!(op.kind(), OpKind::Empty);
        self.next_op().is_some_and(is_empty)
    }

    /// Returns the letters of the arguments of a macro call, each with its local, as its block names them; those of argument
    /// specification I if the block is no G65.
    pub fn argument_letters(&self, calling_block: Span) -> Vec<(usize, char)> {
        let op = self.memory.id_at(calling_block).and_then(|id| {
            let program = self.memory.get(id);
            program.op(program.block_texts().index_at(calling_block.start)?)
        });
        let call = op.and_then(|op| match op.kind() {
            OpKind::Words(words) => words.call().filter(|call| call.kind == CallCode::Macro),
            _ => None,
        });
        let Some(call) = call else {
            return (1..=33).filter_map(|local| Some((local, argument_letter(local)?))).collect();
        };
        let mut locals = ArgumentLocals::new(self.settings().reads_ijk_plainly, false);
        let named = call.arguments.iter().filter_map(|word| {
            let local = locals.next(word.letter).ok()??;
            Some((local, char::from(word.letter)))
        });
        named.collect()
    }

    /// Returns a variable as a program of a macro level would read it now.
    pub fn variable_of(&self, level: usize, number: u32) -> Result<Value, Alarm> {
        match self.vars().classify(number) {
            VariableClass::Local(local) => Ok(self.vars().locals_of(level).get(local)),
            VariableClass::Common(_) | VariableClass::Vacant | VariableClass::System => self.variable(number),
        }
    }

    /// Evaluates a typed expression or condition with the locals of a macro level; nothing changes.
    pub fn evaluate(&self, expression: &Expression, level: usize) -> Result<Evaluation, Alarm> {
        self.inspect_level(level, |registers| match expression {
            Expression::Value(operand) => registers.operand(operand).map(Evaluation::Value),
            Expression::Condition(code) => registers.evaluate_condition(code).map(Evaluation::Condition),
        })
        .map_err(|alarm| alarm.node)
    }

    /// Returns the number of the variable on the left of a typed assignment.
    pub fn target_number(&self, target: &AssignmentTarget, level: usize) -> Result<u32, Alarm> {
        self.inspect_level(level, |registers| match target {
            AssignmentTarget::Slot(slot) => Ok(slot.number()),
            AssignmentTarget::Computed(number) => {
                variable_number(registers.operand(number).map_err(|alarm| alarm.node)?)
            }
        })
    }

    fn inspect_level<T>(&self, level: usize, inspect: impl FnOnce(&Registers) -> T) -> T {
        let registers = &self.executor.registers;
        if self.vars().outer_level(level).is_none() {
            return registers.without_side_effects(inspect);
        }
        let mut of_level = registers.clone();
        of_level.variables.set_locals(&self.vars().locals_of(level));
        inspect(&of_level)
    }

    /// Assigns a variable between two blocks, with the locals of a macro level. #3000 and #3006 can't be written so.
    pub fn assign(&mut self, level: usize, number: u32, value: Value) -> Result<(), Alarm> {
        if is_stop(number) {
            return Err(Alarm::WriteProtected { number });
        }
        let Executor { registers, .. } = &mut self.executor;
        if let VariableClass::Local(local) = registers.variables.classify(number)
            && registers.variables.set_outer_local(level, local, value)
        {
            return Ok(());
        }
        let written = self.executor.write(Slot::of(number), value, None, Span::default(), &mut ());
        written.map_err(|alarm| alarm.node)
    }

    /// Makes a block of the program at work the next one and closes the loops that don't contain it; false if the block isn't
    /// one of that program.
    pub fn jump_to(&mut self, block: Span) -> bool {
        let program = self.executor.flow.frame.program;
        if self.memory.id_at(block) != Some(program) {
            return false;
        }
        let Some(index) = self.memory.get(program).block_texts().index_at(block.start) else { return false };
        self.executor.flow.frame.jump(index);
        true
    }

    /// Returns the active tool length offset of each axis, mm and degrees.
    pub fn length_offset(&self) -> Position {
        self.executor.registers.state.length_offset
    }

    /// Returns the part of the active tool length offset that is wear.
    pub fn length_wear(&self) -> Position {
        let Registers { data, state, .. } = &self.executor.registers;
        data.along_tool(state, state.length_wear)
    }

    /// Returns the tool length of each H whose geometry is not 0.
    pub fn tool_lengths(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        let lengths = &self.executor.registers.data.offsets.tools[Register::HGeometry as usize];
        lengths.iter().enumerate().map(|(h, length)| (h as u32, *length)).filter(|(_, length)| *length != 0.0)
    }
}

fn has_own_level(frame: &CallFrame) -> bool {
    matches!(frame.kind, FrameKind::Macro | FrameKind::Modal(_))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::control::Settings;
    use gcode_lang::program::{Memory, NoLibrary, parse_target};

    const TEXT: &str =
        "O1\n#1=4\nN20 M98 P2\nM30\nO2\n(COMMENT)\nG65 P3 A7. I1. I2.\nM99\nO3\n#2=#1\nN30 #100=#2\nM99\n";

    /// The control of the text after some blocks.
    fn after(blocks: usize) -> Control {
        let mut memory = Memory::default();
        memory.load("O1.nc", TEXT.as_bytes().to_vec());
        let mut control = Control::new(memory, Settings::default());
        for _ in 0..blocks {
            assert!(control.step(&mut NoLibrary, &mut ()).is_none());
        }
        control.next_block();
        control
    }

    fn value(control: &Control, level: usize, text: &str) -> Result<Evaluation, Alarm> {
        control.evaluate(&Expression::parse(text)?, level)
    }

    #[test]
    fn the_stack_has_the_block_of_every_caller_and_its_level() {
        // #1=4, M98, the comment, G65, #2=#1.
        let control = after(5);
        let sources = control.memory().sources();
        let stack: Vec<_> = control
            .call_stack()
            .iter()
            .map(|one| (control.memory().get(one.program).label(), sources.text(one.block), one.level))
            .collect();
        let frame = |program: &str, block: &str, level| (program.to_owned(), block.to_owned(), level);
        let expected = [
            frame("O0003", "N30 #100=#2", 1),
            frame("O0002", "G65 P3 A7. I1. I2.", 0),
            frame("O0001", "N20 M98 P2", 0),
        ];
        assert_eq!(stack, expected);
        let letters = control.argument_letters(control.call_stack()[1].block);
        assert_eq!(letters, [(1, 'A'), (4, 'I'), (7, 'I')]);
    }

    #[test]
    fn comments_are_empty_and_sequence_numbers_are_not() {
        assert!(after(2).is_next_empty(), "the comment in O2");
        assert!(!after(1).is_next_empty());
        assert!(!after(3).is_next_empty());
    }

    #[test]
    fn an_expression_reads_the_locals_of_its_level() {
        let control = after(5);
        let number = |number| Ok(Evaluation::Value(Value::Number(number)));
        assert_eq!(value(&control, 1, "#1*2"), number(14.0));
        assert_eq!(value(&control, 0, "#1*2"), number(8.0));
        assert_eq!(value(&control, 0, "#2"), Ok(Evaluation::Value(Value::Vacant)));
        assert_eq!(value(&control, 1, "ABS[-30.]"), number(30.0));
        assert_eq!(value(&control, 1, "#1 GT 3"), Ok(Evaluation::Condition(true)));
        assert_eq!(value(&control, 1, "#1 GT 7"), Ok(Evaluation::Condition(false)));
        assert_eq!(value(&control, 1, "1/0"), Err(Alarm::DivideByZero));
        assert_eq!(value(&control, 1, "#4115"), number(3.0));
    }

    #[test]
    fn an_assignment_goes_to_the_level_and_stops_are_refused() {
        let mut control = after(5);
        control.assign(0, 1, Value::Number(9.0)).unwrap();
        control.assign(1, 2, Value::Vacant).unwrap();
        control.assign(1, 100, Value::Number(5.0)).unwrap();
        assert_eq!(control.variable_of(0, 1), Ok(Value::Number(9.0)));
        assert_eq!(control.variable_of(1, 1), Ok(Value::Number(7.0)));
        assert_eq!(control.variable(2), Ok(Value::Vacant));
        assert_eq!(control.variable(100), Ok(Value::Number(5.0)));
        for number in [0, 3000, 3006, 5001] {
            assert!(control.assign(1, number, Value::Number(1.0)).is_err(), "#{number}");
        }
        let target = |text| control.target_number(&parse_target(text).unwrap(), 0);
        assert_eq!(target("#[#1+91]"), Ok(100), "#1 of level 0 is 9");
    }

    #[test]
    fn a_jump_stays_in_the_program_at_work() {
        let mut control = after(5);
        let block = |text: &str| {
            let start = TEXT.find(text).unwrap() as u32;
            Span { start, end: start + text.len() as u32, ..Span::default() }
        };
        assert!(!control.jump_to(block("N20 M98 P2")));
        assert!(!control.jump_to(block("100=#2")), "no block begins there");
        assert!(control.jump_to(block("#2=#1\n")));
        let next = control.next_block().unwrap();
        assert_eq!(control.memory().sources().text(next), "#2=#1");
    }
}
