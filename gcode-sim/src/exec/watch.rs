//! Looking on while a control runs: at what stands in it before and after every block.
use super::frames::Frame;
use super::{Control, Core};
use crate::program::{Compute, Op, OpKind, Slot, Statement};
use crate::source::Span;

/// Looks at a control between its blocks. Where nobody does, statements in a row are done at once.
pub trait Watcher {
    /// Whether anybody looks.
    fn looks(&self) -> bool {
        true
    }

    /// A block is about to be done: [`Control::next_block`], which makes it ready and changes nothing else.
    fn before(&mut self, control: &mut Control);

    /// It has been done, or an alarm has stopped it.
    fn after(&mut self, control: &Control);
}

/// Nobody looks on.
impl Watcher for () {
    fn looks(&self) -> bool {
        false
    }

    fn before(&mut self, _: &mut Control) {}

    fn after(&mut self, _: &Control) {}
}

impl<W: Watcher> Watcher for &mut W {
    fn looks(&self) -> bool {
        (**self).looks()
    }

    fn before(&mut self, control: &mut Control) {
        (**self).before(control);
    }

    fn after(&mut self, control: &Control) {
        (**self).after(control);
    }
}

/// Somebody who may be there.
impl<W: Watcher> Watcher for Option<W> {
    fn looks(&self) -> bool {
        self.as_ref().is_some_and(W::looks)
    }

    fn before(&mut self, control: &mut Control) {
        self.iter_mut().for_each(|watcher| watcher.before(control));
    }

    fn after(&mut self, control: &Control) {
        self.iter_mut().for_each(|watcher| watcher.after(control));
    }
}

impl Control {
    /// The block that a step would do now; `None` where the program has no more.
    pub fn next_block(&mut self) -> Option<Span> {
        let Frame { program, next, .. } = self.core.frame;
        self.memory.ready(program, next).map(|op| op.span)
    }

    /// The variables that [`Control::next_block`] will assign as things stand; those whose numbers are computed as well.
    pub fn will_assign(&self) -> Vec<u32> {
        let mut numbers = Vec::new();
        self.look_at_next(|core, op| {
            if !core.is_skipped(op) {
                core.targets(op.kind(), &mut numbers);
            }
        });
        numbers
    }

    /// What `look` sees in the operation of [`Control::next_block`]; `None` where there is none that is ready.
    pub(super) fn look_at_next<T>(&self, look: impl FnOnce(&Core, &Op) -> T) -> Option<T> {
        let Frame { program, next, .. } = self.core.frame;
        let op = self.memory.get(program).op(next)?;
        Some(self.core.apart(|core| look(core, op)))
    }
}

impl Core {
    /// Does what is no part of the run: what it leaves behind is forgotten.
    pub(super) fn apart<T>(&self, look: impl FnOnce(&Self) -> T) -> T {
        let clock_read = self.clock_read.get();
        let seen = self.aftermath.apart(|| look(self));
        self.clock_read.set(clock_read);
        seen
    }

    /// Whether the switch of a block skip before a block is on.
    pub(super) fn is_skipped(&self, op: &Op) -> bool {
        op.skip().is_some_and(|switch| self.skips(switch))
    }

    /// What stands behind an IF that holds; else the operation itself.
    pub(super) fn behind_if<'a>(&self, kind: &'a OpKind) -> &'a OpKind {
        match kind {
            OpKind::If { condition, then } if self.holds(condition).unwrap_or(false) => then,
            _ => kind,
        }
    }

    fn targets(&self, kind: &OpKind, numbers: &mut Vec<u32>) {
        match kind {
            OpKind::If { condition, then } if self.holds(condition).unwrap_or(false) => {
                self.targets(then, numbers);
            }
            OpKind::Compute(Compute { place, .. }) => numbers.push(u32::from(*place)),
            OpKind::Statement(statement) => self.targets_of(statement, numbers),
            OpKind::Empty | OpKind::Words(_) | OpKind::If { .. } | OpKind::Alarm(_) => {}
        }
    }

    fn targets_of(&self, statement: &Statement, numbers: &mut Vec<u32>) {
        match statement {
            Statement::Compute(Compute { place, .. }) => numbers.push(u32::from(*place)),
            Statement::Assign { target, .. } => {
                numbers.extend(self.target(target).map(Slot::number));
            }
            Statement::Several(all) => all.iter().for_each(|one| self.targets_of(one, numbers)),
            Statement::IfThen { condition, then } if self.holds(condition).unwrap_or(false) => {
                self.targets_of(then, numbers);
            }
            _ => {}
        }
    }
}

/// What `look` sees of a block before it is done, for tests of what can be seen.
#[cfg(test)]
pub(super) fn seen_before<T: Clone>(block: &str, look: fn(&Control) -> T) -> T {
    use crate::program::{Memory, NoLibrary};

    struct Seen<T>(fn(&Control) -> T, Vec<T>);

    impl<T> Watcher for Seen<T> {
        fn before(&mut self, control: &mut Control) {
            if control.next_block().is_some() {
                self.1.push(self.0(control));
            }
        }

        fn after(&mut self, _: &Control) {}
    }

    let mut memory = Memory::default();
    memory.load("O1.nc", format!("O1\n{block}\nM30\n").into_bytes());
    let mut control = Control::new(memory, crate::control::Settings::default());
    let mut watcher = Seen(look, Vec::new());
    control.run_watched(super::Limits::default(), &mut NoLibrary, &mut (), &mut watcher);
    // Behind it stands M30.
    watcher.1[watcher.1.len() - 2].clone()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exec::{Limits, Value};
    use crate::program::{Memory, NoLibrary};

    /// `#n=value` of every assignment, as it stands behind its block.
    #[derive(Default)]
    struct Assigned {
        numbers: Vec<u32>,
        seen: Vec<(u32, Value)>,
    }

    impl Watcher for Assigned {
        fn before(&mut self, control: &mut Control) {
            self.numbers = control.next_block().map_or(Vec::new(), |_| control.will_assign());
        }

        fn after(&mut self, control: &Control) {
            let values = self.numbers.iter().map(|n| (*n, control.variable(*n).unwrap()));
            self.seen.extend(values);
        }
    }

    fn seen(text: &str) -> Vec<(u32, Value)> {
        let mut memory = Memory::default();
        memory.load("O1.nc", text.as_bytes().to_vec());
        let mut control = Control::new(memory, crate::control::Settings::default());
        let mut watcher = Assigned::default();
        control.run_watched(Limits::default(), &mut NoLibrary, &mut (), &mut watcher);
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
