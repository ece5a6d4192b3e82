//! Control flow of a program: the blocks that can follow each block, and the blocks that are reachable.
use std::collections::BTreeMap;
use std::ops::Range;

use gcode_lang::program::{CallCode, CallTarget, OpIndex, OpKind, Operand, Program, Statement, Words};

use super::literal;

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

impl Successors {
    fn next_or(jumps: Vec<OpIndex>) -> Self {
        Self { falls_through: true, jumps, ..Self::default() }
    }

    fn exit() -> Self {
        Self { is_exit: true, ..Self::default() }
    }

    /// Returns true if the block may end the program, or jump to a number that is not known.
    pub(crate) fn may_leave(&self) -> bool {
        self.is_exit || self.jumps_anywhere
    }

    fn or_next(self) -> Self {
        Self { falls_through: true, ..self }
    }

    fn or(mut self, other: Self) -> Self {
        self.falls_through |= other.falls_through;
        self.jumps_anywhere |= other.jumps_anywhere;
        self.is_exit |= other.is_exit;
        self.jumps.extend(other.jumps);
        self
    }
}

/// Jump to a sequence number, with its target if it exists.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jump {
    pub block: OpIndex,
    pub number: u32,
    pub to: Option<OpIndex>,
    /// True for `M99 P`: in a called program the number is the caller's.
    pub is_return: bool,
    /// The target is behind the piece of a program that this is.
    pub is_far: bool,
}

#[derive(Debug)]
pub(crate) struct ControlFlowGraph {
    pub block_successors: Vec<Successors>,
    pub jumps: Vec<Jump>,
    numbered: Vec<OpIndex>,
    /// Jumps of a piece to blocks behind it: each with the node that stands for its target.
    far_jumps: BTreeMap<OpIndex, OpIndex>,
    far_nodes: usize,
}

impl ControlFlowGraph {
    /// `far_jumps` are the blocks of a piece that jump to blocks behind it, each with the index of its target among all such
    /// targets.
    pub(super) fn new(program: &Program, far_jumps: &[(OpIndex, usize)]) -> Self {
        let first_far = program.ops().len() + 2;
        let mut flow = Self {
            block_successors: Vec::new(),
            jumps: Vec::new(),
            numbered: Vec::new(),
            far_jumps: far_jumps.iter().map(|(block, target)| (*block, first_far + target)).collect(),
            far_nodes: far_jumps.iter().map(|(_, target)| target + 1).max().unwrap_or(0),
        };
        for (block, op) in program.ops().iter().enumerate() {
            if op.number.is_some() {
                flow.numbered.push(block);
            }
            let successors = flow.block_successors_of(program, block, op.kind());
            let is_skippable = op.skip().is_some();
            flow.block_successors.push(if is_skippable { successors.or_next() } else { successors });
        }
        flow
    }

    fn block_successors_of(&mut self, program: &Program, block: OpIndex, kind: &OpKind) -> Successors {
        match kind {
            OpKind::Empty | OpKind::AssignDirect(_) => Successors::next_or(Vec::new()),
            // The corrected block may be a jump.
            OpKind::Alarm(_) => Successors { jumps_anywhere: true, ..Successors::next_or(Vec::new()) },
            OpKind::Words(words) => {
                let successors = self.word_successors(program, block, words);
                match words.form_if_skipped() {
                    Some((_, short)) => successors.or(self.word_successors(program, block, short)),
                    None => successors,
                }
            }
            OpKind::Statement(statement) => self.statement_successors(program, block, statement),
            OpKind::If { then, .. } => self.block_successors_of(program, block, then).or_next(),
        }
    }

    fn word_successors(&mut self, program: &Program, block: OpIndex, words: &Words) -> Successors {
        let codes = || words.list.iter().filter(|w| w.letter == b'M').filter_map(literal::word_count);
        let is_end = codes().any(|m| matches!(m, 2 | 30));
        let mut found = if is_end { Successors::exit() } else { Successors::next_or(Vec::new()) };
        let operand = |letter| words.list.iter().find(|word| word.letter == letter);
        // Haas: M96 P Q jumps if an input is 0.
        if codes().any(|m| m == 96)
            && let (Some(number), Some(_)) = (operand(b'P'), operand(b'Q'))
        {
            match literal::word_count(number) {
                Some(number) => found.jumps.extend(program.find_number(number, block + 1)),
                None => found.jumps_anywhere = true,
            }
        }
        if let Some(call) = words.call().filter(|call| call.kind == CallCode::Return) {
            found.falls_through = false;
            found.is_exit = true;
            if let CallTarget::Number(word) = &call.target {
                match literal::word_count(word) {
                    Some(number) => {
                        let to = program.find_number(number, 0);
                        found.jumps.extend(to);
                        self.jumps.push(Jump { block, number, to, is_return: true, is_far: false });
                    }
                    None => found.jumps_anywhere = true,
                }
            }
        }
        found
    }

    fn statement_successors(
        &mut self,
        program: &Program,
        block: OpIndex,
        statement: &Statement,
    ) -> Successors {
        match statement {
            Statement::Goto(to) => self.jump_successors(program, block, &to.node),
            Statement::IfGoto { to, .. } => self.jump_successors(program, block, &to.node).or_next(),
            Statement::IfThen { then, .. } => self.statement_successors(program, block, then).or_next(),
            Statement::While { end, .. } => Successors::next_or(vec![end + 1]),
            Statement::End { start, .. } => Successors { jumps: vec![*start], ..Successors::default() },
            statement if is_raise(statement) => Successors::exit(),
            Statement::Assignments(all) if matches!(all.last(), Some(Statement::Goto(_))) => {
                let goto = all.last().unwrap_or(statement);
                self.statement_successors(program, block, goto)
            }
            Statement::Assign { .. }
            | Statement::AssignDirect(_)
            | Statement::Assignments(_)
            | Statement::Do { .. }
            | Statement::SetNames { .. }
            | Statement::Print { .. }
            | Statement::OpenOutput
            | Statement::CloseOutput => Successors::next_or(Vec::new()),
            Statement::Alarm(_) => Successors { jumps_anywhere: true, ..Successors::next_or(Vec::new()) },
        }
    }

    fn jump_successors(&mut self, program: &Program, block: OpIndex, to: &Operand) -> Successors {
        let Operand::Number(number) = to else {
            return Successors { jumps_anywhere: true, ..Successors::default() };
        };
        let Some(number) = literal::to_whole(*number) else { return Successors::default() };
        if let Some(far) = self.far_jumps.get(&block).copied() {
            self.jumps.push(Jump { block, number, to: None, is_return: false, is_far: true });
            return Successors { jumps: vec![far], ..Successors::default() };
        }
        let to = program.find_number(number, block + 1);
        self.jumps.push(Jump { block, number, to, is_return: false, is_far: false });
        // The rule `missing-n` reports a missing target; the blocks after it are not a second fault.
        Successors { falls_through: to.is_none(), jumps: to.into_iter().collect(), ..Successors::default() }
    }

    /// Returns the number of nodes: the blocks, the end of the program, one for computed jumps and the targets behind a piece.
    ///
    /// The end is one past the last block. The node for computed jumps leads to every numbered block, which keeps the edges
    /// few.
    pub(crate) fn block_count(&self) -> usize {
        self.block_successors.len() + 2 + self.far_nodes
    }

    /// Returns the node for computed jumps.
    pub(crate) fn computed_node(&self) -> OpIndex {
        self.block_successors.len() + 1
    }

    /// Returns true if a block has a sequence number.
    pub(crate) fn has_numbers(&self) -> bool {
        !self.numbered.is_empty()
    }

    /// Returns the nodes of the targets behind a piece.
    pub(crate) fn far_nodes(&self) -> Range<OpIndex> {
        self.block_successors.len() + 2..self.block_count()
    }

    pub(crate) fn successors(&self, place: OpIndex) -> impl Iterator<Item = OpIndex> + '_ {
        let anywhere = self.computed_node();
        let block = self.block_successors.get(place);
        let jumps = block.map_or(&[][..], |block| &block.jumps);
        let next = block.filter(|block| block.falls_through).map(|_| place + 1);
        let computed = block.filter(|block| block.jumps_anywhere).map(|_| anywhere);
        let numbered = if place == anywhere { &self.numbered[..] } else { &[] };
        jumps.iter().copied().chain(next).chain(computed).chain(numbered.iter().copied())
    }

    /// Returns, for each node, whether it is reachable from one of `starts`.
    pub(crate) fn reachable(&self, starts: &[OpIndex]) -> Vec<bool> {
        let starts = starts.iter().map(|start| (*start, ()));
        let next = |place, (): &(), open: &mut Vec<_>| open.extend(self.successors(place).map(|to| (to, ())));
        let states = self.propagate(starts, |(), ()| (), next);
        states.iter().map(Option::is_some).collect()
    }

    /// Returns the state before each node, `None` for an unreachable one.
    ///
    /// Starts with the states of some nodes. `next` adds the nodes that follow a node with their states; the
    /// states that meet at a node are joined until nothing changes.
    pub(crate) fn propagate<S: Clone + PartialEq>(
        &self,
        starts: impl IntoIterator<Item = (OpIndex, S)>,
        join: impl Fn(&mut S, S),
        next: impl Fn(OpIndex, &S, &mut Vec<(OpIndex, S)>),
    ) -> Vec<Option<S>> {
        let mut states: Vec<Option<S>> = vec![None; self.block_count()];
        let mut open: Vec<_> = starts.into_iter().collect();
        while let Some((place, state)) = open.pop() {
            let Some(known) = states.get_mut(place) else { continue };
            match known {
                Some(known) => {
                    let before = known.clone();
                    join(known, state);
                    if *known == before {
                        continue;
                    }
                }
                None => *known = Some(state),
            }
            known.iter().for_each(|state| next(place, state, &mut open));
        }
        states
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
