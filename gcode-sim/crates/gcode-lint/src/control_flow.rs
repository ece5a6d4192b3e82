//! Control flow of a program: the blocks that can follow each block, and the blocks that are reachable.
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{CallCode, CallTarget, OpIndex, OpKind, Operand, Program, Statement, Words};

use super::literal;

/// Blocks that can follow a block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Successors {
    /// True if the next block can follow.
    pub falls_through: bool,
    /// Targets of jumps, loops and returns from calls.
    pub jumps: Vec<OpIndex>,
    /// True for a computed jump, which can reach any numbered block.
    pub jumps_anywhere: bool,
    /// True if the program ends, returns, or stops with its own alarm (`#3000`).
    pub is_exit: bool,
}

/// Jump to a sequence number, with its target if it exists.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jump {
    pub block: OpIndex,
    pub number: u32,
    pub to: Option<OpIndex>,
    /// True for `M99 P`: in a called program the number is the caller's.
    pub is_return: bool,
}

/// Control flow graph of one program.
#[derive(Debug)]
pub(crate) struct ControlFlowGraph {
    pub block_successors: Vec<Successors>,
    pub jumps: Vec<Jump>,
    numbered: Vec<OpIndex>,
}

impl ControlFlowGraph {
    pub(super) fn new(program: &Program) -> Self {
        let mut flow = Self { block_successors: Vec::new(), jumps: Vec::new(), numbered: Vec::new() };
        for (block, op) in program.ops().iter().enumerate() {
            if op.number.is_some() {
                flow.numbered.push(block);
            }
            let mut ways = flow.block_successors_of(program, block, op.kind());
            if op.skip().is_some() {
                ways.falls_through = true;
            }
            flow.block_successors.push(ways);
        }
        flow
    }

    fn block_successors_of(&mut self, program: &Program, block: OpIndex, kind: &OpKind) -> Successors {
        match kind {
            // An alarm stops the control; the blocks after it are checked as if it were corrected.
            OpKind::Empty | OpKind::AssignFree(_) | OpKind::Alarm(_) => {
                Successors { falls_through: true, ..Successors::default() }
            }
            OpKind::Words(words) => {
                let mut ways = self.word_successors(program, block, words);
                if let Some((_, short)) = words.skipped_form() {
                    let other = self.word_successors(program, block, short);
                    ways.falls_through |= other.falls_through;
                    ways.is_exit |= other.is_exit;
                    ways.jumps.extend(other.jumps);
                }
                ways
            }
            OpKind::Statement(statement) => self.statement_successors(program, block, statement),
            OpKind::If { then, .. } => {
                Successors { falls_through: true, ..self.block_successors_of(program, block, then) }
            }
        }
    }

    fn word_successors(&mut self, program: &Program, block: OpIndex, words: &Words) -> Successors {
        let mut ways = Successors { falls_through: true, ..Successors::default() };
        let codes = || words.list.iter().filter(|w| w.letter == b'M').filter_map(literal::word_count);
        if codes().any(|m| matches!(m, 2 | 30)) {
            ways = Successors { is_exit: true, ..Successors::default() };
        }
        // Haas: M97 calls a subprogram at a sequence number of the same program.
        if codes().any(|m| m == 97)
            && let Some(number) = words.list.iter().find(|w| w.letter == b'P').and_then(literal::word_count)
        {
            ways.jumps.extend(program.find_number(number, block + 1));
        }
        if let Some(call) = words.call().filter(|call| call.kind == CallCode::Return) {
            ways.falls_through = false;
            ways.is_exit = true;
            if let CallTarget::Number(word) = &call.target {
                match literal::word_count(word) {
                    Some(number) => {
                        let to = program.find_number(number, 0);
                        ways.jumps.extend(to);
                        self.jumps.push(Jump { block, number, to, is_return: true });
                    }
                    None => ways.jumps_anywhere = true,
                }
            }
        }
        ways
    }

    fn statement_successors(
        &mut self,
        program: &Program,
        block: OpIndex,
        statement: &Statement,
    ) -> Successors {
        match statement {
            Statement::Goto(to) => self.jump_successors(program, block, &to.node),
            Statement::IfGoto { to, .. } => {
                Successors { falls_through: true, ..self.jump_successors(program, block, &to.node) }
            }
            Statement::IfThen { then, .. } => {
                Successors { falls_through: true, ..self.statement_successors(program, block, then) }
            }
            Statement::While { end, .. } => {
                Successors { falls_through: true, jumps: vec![end + 1], ..Successors::default() }
            }
            Statement::End { start, .. } => Successors { jumps: vec![*start], ..Successors::default() },
            Statement::Assign { target, .. } if target.is_variable(3000) => {
                Successors { is_exit: true, ..Successors::default() }
            }
            Statement::Assignments(all) if all.iter().any(is_raise) => {
                Successors { is_exit: true, ..Successors::default() }
            }
            Statement::Assign { .. }
            | Statement::AssignFree(_)
            | Statement::Assignments(_)
            | Statement::Do { .. }
            | Statement::SetNames { .. }
            | Statement::Print { .. }
            | Statement::OpenOutput
            | Statement::CloseOutput
            | Statement::Alarm(_) => Successors { falls_through: true, ..Successors::default() },
        }
    }

    fn jump_successors(&mut self, program: &Program, block: OpIndex, to: &Operand) -> Successors {
        let Some(number) = literal::operand_number(to).and_then(literal::to_whole) else {
            let computed = literal::operand_number(to).is_none();
            return Successors { jumps_anywhere: computed, ..Successors::default() };
        };
        let to = program.find_number(number, block + 1);
        self.jumps.push(Jump { block, number, to, is_return: false });
        // The rule `missing-n` reports a missing target; the blocks after it are not a second fault.
        Successors { falls_through: to.is_none(), jumps: to.into_iter().collect(), ..Successors::default() }
    }

    /// Adds the blocks to which the program called in `block` may return.
    pub(super) fn add_return_targets(&mut self, block: OpIndex, to: impl IntoIterator<Item = OpIndex>) {
        self.block_successors[block].jumps.extend(to);
    }

    /// Marks a call whose program may return to any numbered block.
    pub(super) fn add_return_anywhere(&mut self, block: OpIndex) {
        self.block_successors[block].jumps_anywhere = true;
    }

    /// Returns the number of nodes: the blocks, the end of the program and one for computed jumps.
    ///
    /// The end is one past the last block. The last node leads to every numbered block, which keeps the edges
    /// few.
    pub(crate) fn block_count(&self) -> usize {
        self.block_successors.len() + 2
    }

    /// Iterates over the nodes that can follow a node.
    pub(crate) fn successors(&self, place: OpIndex) -> impl Iterator<Item = OpIndex> + '_ {
        let anywhere = self.block_successors.len() + 1;
        let ways = self.block_successors.get(place);
        let jumps = ways.map_or(&[][..], |ways| &ways.jumps);
        let next = ways.filter(|ways| ways.falls_through).map(|_| place + 1);
        let computed = ways.filter(|ways| ways.jumps_anywhere).map(|_| anywhere);
        let numbered = if place == anywhere { &self.numbered[..] } else { &[] };
        jumps.iter().copied().chain(next).chain(computed).chain(numbered.iter().copied())
    }

    /// Returns, for each block, whether it is reachable from one of `starts`.
    pub(crate) fn reachable(&self, starts: impl IntoIterator<Item = OpIndex>) -> Vec<bool> {
        let mut reached = vec![false; self.block_count()];
        let mut open: Vec<OpIndex> = starts.into_iter().collect();
        while let Some(place) = open.pop() {
            if !std::mem::replace(&mut reached[place], true) {
                open.extend(self.successors(place));
            }
        }
        reached.truncate(self.block_successors.len());
        reached
    }
}

/// Returns true for `#3000=…`, alone or after IF … THEN.
pub(crate) fn raises_alarm(kind: &OpKind) -> bool {
    match kind {
        OpKind::Statement(Statement::IfThen { then, .. }) => is_raise(then),
        OpKind::Statement(statement) => is_raise(statement),
        _ => false,
    }
}

fn is_raise(statement: &Statement) -> bool {
    match statement {
        Statement::Assign { target, .. } => target.is_variable(3000),
        Statement::Assignments(all) => all.iter().any(is_raise),
        _ => false,
    }
}

/// Returns true for the alarms of unpaired loops, which the rule `loop-pairs` reports.
pub(crate) fn is_loop_alarm(alarm: &Alarm) -> bool {
    matches!(alarm, Alarm::MissingEnd { .. } | Alarm::MissingDo { .. } | Alarm::LoopNumber { .. })
}
