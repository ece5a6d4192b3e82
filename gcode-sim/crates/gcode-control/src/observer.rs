//! Looking on while a control runs: at what stands in it before and after every block.
use super::control::Control;
use super::flow::Frame;
use super::registers::Registers;
use gcode_lang::program::{Assign, Op, OpKind, Slot, Statement};
use gcode_lang::source::Span;

/// Looks at a control between its blocks. Where nobody does, statements in a row are done at once.
pub trait Observer {
    /// Whether anybody looks.
    fn is_active(&self) -> bool {
        true
    }

    /// A block is about to be done: [`Control::next_block`], which makes it ready and changes nothing else.
    fn before_block(&mut self, control: &mut Control);

    /// It has been done, or an alarm has stopped it.
    fn after_block(&mut self, control: &Control);
}

/// Nobody looks on.
impl Observer for () {
    fn is_active(&self) -> bool {
        false
    }

    fn before_block(&mut self, _: &mut Control) {}

    fn after_block(&mut self, _: &Control) {}
}

impl<W: Observer> Observer for &mut W {
    fn is_active(&self) -> bool {
        (**self).is_active()
    }

    fn before_block(&mut self, control: &mut Control) {
        (**self).before_block(control);
    }

    fn after_block(&mut self, control: &Control) {
        (**self).after_block(control);
    }
}

/// Somebody who may be there.
impl<W: Observer> Observer for Option<W> {
    fn is_active(&self) -> bool {
        self.as_ref().is_some_and(W::is_active)
    }

    fn before_block(&mut self, control: &mut Control) {
        self.iter_mut().for_each(|watcher| watcher.before_block(control));
    }

    fn after_block(&mut self, control: &Control) {
        self.iter_mut().for_each(|watcher| watcher.after_block(control));
    }
}

impl Control {
    /// The block that a step would do now; `None` where the program has no more.
    pub fn next_block(&mut self) -> Option<Span> {
        let Frame { program, next, .. } = self.executor.flow.frame;
        self.memory.lower_block(program, next).map(|op| op.span)
    }

    /// The variables that [`Control::next_block`] will assign as things stand; those whose numbers are computed as well.
    pub fn next_assigned_variables(&self) -> Vec<u32> {
        let mut numbers = Vec::new();
        self.inspect_next(|registers, op| {
            if !registers.is_skipped(op) {
                registers.collect_targets(op.kind(), &mut numbers);
            }
        });
        numbers
    }

    /// What `look` sees in the operation of [`Control::next_block`]; `None` where there is none that is ready.
    pub(super) fn inspect_next<T>(&self, inspect: impl FnOnce(&Registers, &Op) -> T) -> Option<T> {
        let Frame { program, next, .. } = self.executor.flow.frame;
        let op = self.memory.get(program).op(next)?;
        Some(self.executor.registers.without_side_effects(|registers| inspect(registers, op)))
    }
}

impl Registers {
    /// Does what is no part of the run: what it leaves behind is forgotten.
    pub(super) fn without_side_effects<T>(&self, inspect: impl FnOnce(&Self) -> T) -> T {
        let clock_read = self.clock.has_been_read.get();
        let result = self.block_effects.without_effects(|| inspect(self));
        self.clock.has_been_read.set(clock_read);
        result
    }

    /// Whether the switch of a block skip before a block is on.
    pub(super) fn is_skipped(&self, op: &Op) -> bool {
        op.skip().is_some_and(|switch| self.data.is_skip_on(switch))
    }

    /// What stands behind an IF that holds; else the operation itself.
    pub(super) fn guarded_operation<'a>(&self, kind: &'a OpKind) -> &'a OpKind {
        match kind {
            OpKind::If { condition, then } if self.evaluate_condition(condition).unwrap_or(false) => then,
            _ => kind,
        }
    }

    fn collect_targets(&self, kind: &OpKind, numbers: &mut Vec<u32>) {
        match kind {
            OpKind::If { condition, then } if self.evaluate_condition(condition).unwrap_or(false) => {
                self.collect_targets(then, numbers);
            }
            OpKind::AssignFree(Assign { variable: place, .. }) => numbers.push(u32::from(*place)),
            OpKind::Statement(statement) => self.collect_statement_targets(statement, numbers),
            OpKind::Empty | OpKind::Words(_) | OpKind::If { .. } | OpKind::Alarm(_) => {}
        }
    }

    fn collect_statement_targets(&self, statement: &Statement, numbers: &mut Vec<u32>) {
        match statement {
            Statement::AssignFree(Assign { variable: place, .. }) => numbers.push(u32::from(*place)),
            Statement::Assign { target, .. } => {
                numbers.extend(self.resolve_target(target).map(Slot::number));
            }
            Statement::Assignments(all) => {
                all.iter().for_each(|one| self.collect_statement_targets(one, numbers))
            }
            Statement::IfThen { condition, then } if self.evaluate_condition(condition).unwrap_or(false) => {
                self.collect_statement_targets(then, numbers);
            }
            _ => {}
        }
    }
}

/// What `look` sees of a block before it is done, for tests of what can be seen.
#[cfg(test)]
pub(super) fn seen_before<T: Clone>(block: &str, look: fn(&Control) -> T) -> T {
    use gcode_lang::program::{Memory, NoLibrary};

    struct Seen<T>(fn(&Control) -> T, Vec<T>);

    impl<T> Observer for Seen<T> {
        fn before_block(&mut self, control: &mut Control) {
            if control.next_block().is_some() {
                self.1.push(self.0(control));
            }
        }

        fn after_block(&mut self, _: &Control) {}
    }

    let mut memory = Memory::default();
    memory.load("O1.nc", format!("O1\n{block}\nM30\n").into_bytes());
    let mut control = Control::new(memory, gcode_lang::control::Settings::default());
    let mut watcher = Seen(look, Vec::new());
    control.run_observed(super::Limits::default(), &mut NoLibrary, &mut (), &mut watcher);
    // Behind it stands M30.
    watcher.1[watcher.1.len() - 2].clone()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, Value};
    use gcode_lang::program::{Memory, NoLibrary};

    /// `#n=value` of every assignment, as it stands behind its block.
    #[derive(Default)]
    struct Assigned {
        numbers: Vec<u32>,
        seen: Vec<(u32, Value)>,
    }

    impl Observer for Assigned {
        fn before_block(&mut self, control: &mut Control) {
            self.numbers = control.next_block().map_or(Vec::new(), |_| control.next_assigned_variables());
        }

        fn after_block(&mut self, control: &Control) {
            let values = self.numbers.iter().map(|n| (*n, control.variable(*n).unwrap()));
            self.seen.extend(values);
        }
    }

    fn seen(text: &str) -> Vec<(u32, Value)> {
        let mut memory = Memory::default();
        memory.load("O1.nc", text.as_bytes().to_vec());
        let mut control = Control::new(memory, gcode_lang::control::Settings::default());
        let mut watcher = Assigned::default();
        control.run_observed(Limits::default(), &mut NoLibrary, &mut (), &mut watcher);
        watcher.seen
    }

    #[test]
    fn assignments_are_seen_with_the_numbers_they_compute() {
        let text = "O1\n#1=500\n#[#1+2]=7.5\nIF[#1 EQ 500]THEN #2=#0\nIF[#1 EQ 1]THEN #3=1\nM30\n";
        let expected = [(1, Value::Number(500.0)), (502, Value::Number(7.5)), (2, Value::Vacant)];
        assert_eq!(seen(text), expected, "#3 is not assigned: its condition doesn't hold");
    }

    #[test]
    fn a_block_that_is_skipped_assigns_nothing() {
        assert_eq!(seen("O1\n#1=1\nGOTO 5\n#1=2\nN5 M30\n"), [(1, Value::Number(1.0))]);
    }
}
