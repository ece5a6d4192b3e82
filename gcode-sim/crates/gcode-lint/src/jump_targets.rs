//! Sequence numbers to which the blocks of programs may jump.
use std::collections::BTreeSet;

use gcode_lang::program::{
    CallCode, CallTarget, LoweredWord, Memory, OpIndex, OpKind, Operand, Program, ProgramId, Statement,
    Words, lower_tree,
};

use super::literal;

/// Sequence numbers to which blocks may jump.
#[derive(Debug, Default)]
pub(super) struct JumpTargets {
    numbers: BTreeSet<u32>,
    /// A jump leads to a number that only a run computes.
    is_computed: bool,
}

impl JumpTargets {
    /// Returns the targets of some blocks of a program, lowered for that: those of GOTO, M96, M97, and `M99 P` of a main
    /// program.
    pub(super) fn of(program: &Program, blocks: &[OpIndex]) -> Self {
        let mut targets = Self::default();
        let trees = blocks.iter().filter_map(|block| program.block_texts().tree(*block));
        trees.for_each(|tree| targets.add_block(lower_tree(&tree).kind()));
        targets
    }

    /// Returns the targets of the blocks of lowered programs that lead to another program: `M99 P`, `M98 P Q`.
    pub(super) fn between(memory: &Memory, programs: impl IntoIterator<Item = ProgramId>) -> Self {
        let mut targets = Self::default();
        let words =
            programs.into_iter().flat_map(|id| memory.get(id).ops()).filter_map(|op| op.kind().words());
        words.for_each(|words| targets.add_call(words));
        targets
    }

    /// Returns true if a jump may lead to a number.
    pub(super) fn has(&self, number: u32) -> bool {
        self.is_computed || self.numbers.contains(&number)
    }

    fn add(&mut self, number: Option<u32>) {
        self.is_computed |= number.is_none();
        self.numbers.extend(number);
    }

    fn add_block(&mut self, kind: &OpKind) {
        match kind {
            OpKind::Statement(statement) => self.add_statement(statement),
            OpKind::If { then, .. } => self.add_block(then),
            OpKind::Words(words) => {
                self.add_call(words);
                // M96 of a Haas has its target in P.
                let is_m96 =
                    |word: &LoweredWord| word.letter == b'M' && literal::word_count(word) == Some(96);
                if words.list.iter().any(is_m96) {
                    let target = words.list.iter().filter(|word| word.letter == b'P');
                    target.for_each(|word| self.add(literal::word_count(word)));
                }
            }
            OpKind::Alarm(_) => self.is_computed = true,
            OpKind::Empty | OpKind::AssignDirect(_) => {}
        }
    }

    fn add_call(&mut self, words: &Words) {
        let Some(call) = words.call() else { return };
        call.start.iter().for_each(|word| self.add(literal::word_count(word)));
        if let (CallCode::Return, CallTarget::Number(word)) = (call.kind, &call.target) {
            self.add(literal::word_count(word));
        }
    }

    fn add_statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Goto(to) | Statement::IfGoto { to, .. } => match to.node {
                // A number that is none of a block raises an alarm.
                Operand::Number(number) => self.numbers.extend(literal::to_whole(number)),
                _ => self.is_computed = true,
            },
            Statement::IfThen { then, .. } => self.add_statement(then),
            Statement::Assignments(all) => all.iter().for_each(|statement| self.add_statement(statement)),
            Statement::Alarm(_) => self.is_computed = true,
            Statement::Assign { .. }
            | Statement::AssignDirect(_)
            | Statement::While { .. }
            | Statement::Do { .. }
            | Statement::End { .. }
            | Statement::SetNames { .. }
            | Statement::Print { .. }
            | Statement::OpenOutput
            | Statement::CloseOutput => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the targets of a program's blocks below 100; `None` if one is computed.
    fn targets(blocks: &str) -> Option<Vec<u32>> {
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{blocks}\nM30\n").into_bytes());
        let program = memory.get(memory.ids().next().unwrap());
        let all: Vec<OpIndex> = (0..program.block_count()).collect();
        let targets = JumpTargets::of(program, &all);
        (!targets.is_computed).then(|| (0..100).filter(|number| targets.has(*number)).collect())
    }

    #[test]
    fn each_kind_of_jump_has_its_target() {
        for (blocks, expected) in [
            ("G1 X10. F20.", Some(vec![])),
            ("GOTO 10", Some(vec![10])),
            ("IF[#1EQ2]GOTO 20", Some(vec![20])),
            ("#1=2 GOTO 30", Some(vec![30])),
            ("IF[#1EQ2]THEN GOTO 40", Some(vec![40])),
            ("M97 P50", Some(vec![50])),
            ("M96 P60 Q1", Some(vec![60])),
            ("M99 P70", Some(vec![70])),
            ("M98 P2 Q80", Some(vec![80])),
            ("M98 P2", Some(vec![])),
            ("GOTO 10\nGOTO 11", Some(vec![10, 11])),
            ("GOTO #1", None),
            ("M99 P#1", None),
        ] {
            assert_eq!(targets(blocks), expected, "{blocks}");
        }
    }
}
