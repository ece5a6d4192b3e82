//! Ways through a program: the questions that the ranges don't decide, and what each way ends with.
//!
//! The tree grows where a box or a point goes. It knows no box: each question is asked of the enclosures over one.
use std::rc::Rc;
use std::sync::Arc;

use gcode_control::symbolic::{Advance, Formula, Halt, Snapshot, SymbolicRun, Term, Test};
use gcode_control::{Control, Limits};
use gcode_enclosure::{Condition, Domain, Node, NodeId, Unary};
use gcode_lang::program::{Bytecode, Library};
use gcode_lang::syntax::ast::BinaryOp;

use crate::leaf::{BoundState, ClaimState, End, Leaf, NodeFormula, node_formula, state_at};
use crate::nodes::{Nodes, semantics};
use crate::request::{Claim, Range};
use crate::watch::Watch;

/// What is asked of every way.
#[derive(Clone, Debug, Default)]
pub(crate) struct Question {
    pub(crate) ranges: Vec<Range>,
    pub(crate) conditions: Vec<Bytecode>,
    pub(crate) claims: Vec<Claim>,
    pub(crate) bounds: Vec<u32>,
    pub(crate) max_blocks: u64,
    /// Part of a result by which it may be off.
    pub(crate) widening: f64,
}

impl Question {
    /// Returns the number of blocks after which nothing more is asked: every claim counts blocks, and fails.
    pub(crate) fn enough_blocks(&self) -> u64 {
        let limit = |claim: &Claim| match claim {
            Claim::Blocks(limit) => *limit,
            Claim::Condition(_) | Claim::NoAlarm | Claim::OnlyAlarms(_) | Claim::Travel(_) => u64::MAX,
        };
        if self.bounds.is_empty() {
            self.claims.iter().map(limit).max().unwrap_or(u64::MAX)
        } else {
            u64::MAX
        }
    }

    /// Returns the box of all ranges.
    pub(crate) fn domain(&self) -> Domain {
        let range = |range: &Range| gcode_enclosure::Interval::new(range.low, range.high);
        Domain::new(self.ranges.iter().map(range).collect())
    }
}

/// Index of a segment.
pub(crate) type SegmentId = usize;

/// Part of ways between two questions.
#[derive(Debug)]
struct Segment {
    parent: Option<(SegmentId, bool)>,
    state: SegmentState,
}

#[derive(Debug)]
enum SegmentState {
    Open(Open),
    Fork(Fork),
    Leaf(Rc<Leaf>),
    /// While it is expanded.
    Taken,
}

/// Segment that no box has reached yet.
#[derive(Clone, Debug)]
struct Open {
    /// State before a block, a condition or a claim.
    snapshot: Rc<Snapshot>,
    phase: Phase,
    /// Answers of the way since then.
    answers: Vec<bool>,
}

/// Expansion of a segment.
struct Expansion {
    /// Where it began, or where its last snapshot was taken; the answers are those used since then.
    from: Open,
    phase: Phase,
    /// Number of answers in `from` that belong to what has been done.
    used: usize,
    /// Number of answers used in all.
    all_used: usize,
    blocks: u64,
}

impl Expansion {
    /// Returns the answers to what is done next.
    fn answers(&self) -> &[bool] {
        &self.from.answers[self.used..]
    }

    /// Counts answers as used.
    fn count(&mut self, used: usize) {
        self.used += used;
        self.all_used += used;
    }
}

/// Largest number of answers and of blocks that are done again from a snapshot.
const MAX_REPEATED: (usize, u64) = (16, 512);

/// What a run does next.
#[derive(Clone, Debug)]
enum Phase {
    /// Conditions on the ranges, from this one on.
    Conditions(usize),
    Blocks,
    /// Claims at the end, after these.
    Claims(Leaf),
}

/// Question with its two answers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fork {
    test: Test,
    pub(crate) asked: Asked,
    pub(crate) yes: SegmentId,
    pub(crate) no: SegmentId,
}

/// Question in nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Asked {
    Condition(Condition),
    Finite(NodeId),
}

/// Part of a tree that a caller follows.
pub(crate) enum Step {
    Fork(Fork),
    Leaf(Rc<Leaf>),
    /// The work is to stop.
    Stopped,
}

/// Largest number of nodes; a loop that never ends must not fill the memory.
const MAX_NODES: usize = 4_000_000;

/// Largest number of segments.
const MAX_SEGMENTS: usize = 30_000;

/// Largest number of questions on one way; a loop that never ends must not fill the memory.
const MAX_QUESTIONS: usize = 2000;

/// Number of blocks between two looks at the clock.
const BLOCKS_PER_LOOK: u64 = 1024;

/// Ways through a program for one thread.
#[derive(Debug)]
pub(crate) struct Tree<L> {
    run: SymbolicRun,
    library: L,
    pub(crate) nodes: Nodes,
    segments: Vec<Segment>,
    question: Arc<Question>,
    /// State before the first block.
    start: Rc<Snapshot>,
    /// Number of blocks without a question after which a way is left alone for now.
    pub(crate) patience: u64,
}

impl<L: Library> Tree<L> {
    /// Returns the tree of a control that hasn't begun; its variables of the ranges are set to numbers already.
    pub(crate) fn new(control: Control, library: L, question: Arc<Question>) -> Self {
        let mut nodes = Nodes::new(semantics(control.settings()), question.domain(), question.widening);
        let mut run = SymbolicRun::new(control);
        for (index, range) in question.ranges.iter().enumerate() {
            let term = if range.low == range.high { Term::Number(range.low) } else { nodes.input(index) };
            // A variable that can't be set has been refused with the request.
            _ = run.set_term(range.variable, term);
        }
        let snapshot = Rc::new(run.snapshot());
        let start = Rc::clone(&snapshot);
        let open = Open { snapshot, phase: Phase::Conditions(0), answers: Vec::new() };
        let root = Segment { parent: None, state: SegmentState::Open(open) };
        Self { run, library, nodes, segments: vec![root], question, start, patience: u64::MAX }
    }

    /// Returns the number of variables whose bounds are wanted.
    pub(crate) fn bound_count(&self) -> usize {
        self.question.bounds.len()
    }

    /// Returns what is asked of every way.
    pub(crate) fn question(&self) -> Arc<Question> {
        Arc::clone(&self.question)
    }

    /// Returns the state before the first block.
    pub(crate) fn start(&self) -> Rc<Snapshot> {
        Rc::clone(&self.start)
    }

    pub(crate) fn control(&self) -> &Control {
        self.run.control()
    }

    /// Returns the run and its library, for ways that don't belong to the tree; the run is restored before the tree uses it.
    pub(crate) fn run_and_library(&mut self) -> (&mut SymbolicRun, &mut L) {
        (&mut self.run, &mut self.library)
    }

    /// Returns for each input whether the conditions of the request let it have whole numbers only: `#1 EQ ROUND[#1]`.
    pub(crate) fn whole_inputs(&mut self) -> Vec<bool> {
        let question = Arc::clone(&self.question);
        let mut wholes = vec![false; question.ranges.len()];
        for code in &question.conditions {
            if let Ok((formula, _)) = self.run.condition(code, &mut self.nodes, &[]) {
                self.note_wholes(&formula, &mut wholes);
            }
        }
        wholes
    }

    fn note_wholes(&mut self, formula: &Formula, wholes: &mut [bool]) {
        match formula {
            Formula::Logic(BinaryOp::And, left, right) => {
                self.note_wholes(left, wholes);
                self.note_wholes(right, wholes);
            }
            Formula::Compare(gcode_lang::syntax::ast::Relation::Eq, left, right) => {
                let sides = [self.nodes.id(*left), self.nodes.id(*right)];
                for (input, whole) in [(sides[0], sides[1]), (sides[1], sides[0])] {
                    if let (Node::Input(index), Node::Unary(Unary::Round | Unary::Fix | Unary::Fup, of)) =
                        (self.nodes.arena().node(input), self.nodes.arena().node(whole))
                        && of == input
                    {
                        wholes[index] = true;
                    }
                }
            }
            _ => {}
        }
    }

    /// Returns the segment's end, after its blocks are executed.
    pub(crate) fn step(&mut self, id: SegmentId, watch: &Watch) -> Step {
        if let SegmentState::Open(_) = &self.segments[id].state {
            self.expand(id, watch);
        }
        match &self.segments[id].state {
            SegmentState::Fork(fork) => Step::Fork(*fork),
            SegmentState::Leaf(leaf) => Step::Leaf(Rc::clone(leaf)),
            SegmentState::Open(_) | SegmentState::Taken => Step::Stopped,
        }
    }

    /// Iterates over the questions of the way to a segment, with their answers.
    fn answers_to(&self, id: SegmentId) -> impl Iterator<Item = (Test, bool)> + '_ {
        let mut next = self.segments[id].parent;
        std::iter::from_fn(move || {
            let (parent, answer) = next?;
            next = self.segments[parent].parent;
            match &self.segments[parent].state {
                SegmentState::Fork(fork) => Some((fork.test, answer)),
                SegmentState::Open(_) | SegmentState::Leaf(_) | SegmentState::Taken => None,
            }
        })
    }

    fn expand(&mut self, id: SegmentId, watch: &Watch) {
        let state = std::mem::replace(&mut self.segments[id].state, SegmentState::Taken);
        let SegmentState::Open(open) = state else { return };
        // What is done again asks its own questions again, in their order.
        let way: Vec<_> = self.answers_to(id).collect();
        let (again, before) = way.split_at(open.answers.len());
        self.nodes.set_answers(before.iter().copied());
        let mut again = again.iter().rev();
        self.nodes.repeat(again.clone().map(|(test, _)| test));
        self.run.restore(&open.snapshot);
        let mut expansion = Expansion {
            phase: open.phase.clone(),
            from: open.clone(),
            used: 0,
            all_used: 0,
            blocks: self.run.control().blocks(),
        };
        let state = loop {
            let before = expansion.all_used;
            let progress = self.advance(&mut expansion, watch);
            let is_stopped = matches!(progress, Some(Progress::Stopped));
            let left = self.nodes.answers_left();
            let is_wrong = match &progress {
                None => left != expansion.answers().len(),
                Some(_) => left > 0 && !is_stopped,
            };
            if self.nodes.has_mismatch() || is_wrong {
                break self.unfollowed("a way whose questions change");
            }
            match progress {
                Some(Progress::Ended(leaf)) => break SegmentState::Leaf(Rc::new(leaf)),
                Some(Progress::Asked(_)) if self.segments.len() >= MAX_SEGMENTS => {
                    break self.unfollowed("more than 30,000 ways");
                }
                Some(Progress::Asked(_)) if way.len() >= MAX_QUESTIONS => {
                    break self.unfollowed("more than 2000 questions on one way");
                }
                Some(Progress::Asked(test)) => break self.fork(id, test, &mut expansion),
                // What has been executed since the last question is executed again.
                Some(Progress::Stopped) => break SegmentState::Open(open),
                None if self.nodes.arena().len() > MAX_NODES => {
                    break self.unfollowed("a loop that computes without an end");
                }
                None => {
                    for (test, answer) in again.by_ref().take(expansion.all_used - before) {
                        self.nodes.add_answer(test, *answer);
                    }
                }
            }
        };
        self.segments[id].state = state;
    }

    fn unfollowed(&self, what: &str) -> SegmentState {
        let blocks = self.run.control().blocks();
        SegmentState::Leaf(Rc::new(self.leaf(End::Unfollowed(what.to_owned()), blocks)))
    }

    /// Adds the two answers of a question.
    fn fork(&mut self, id: SegmentId, test: Test, expansion: &mut Expansion) -> SegmentState {
        let asked = match test {
            Test::Compare(relation, left, right) => {
                Asked::Condition(self.nodes.condition(relation, left, right))
            }
            Test::Finite(term) => Asked::Finite(self.nodes.id(term)),
        };
        let blocks = self.run.control().blocks() - expansion.blocks;
        if expansion.from.answers.len() >= MAX_REPEATED.0 || blocks >= MAX_REPEATED.1 {
            // The state is that before what asks.
            expansion.from.answers.drain(..expansion.used);
            expansion.from.snapshot = Rc::new(self.run.snapshot());
            expansion.from.phase = expansion.phase.clone();
        }
        let mut child = |answer: bool| {
            let mut open = expansion.from.clone();
            open.answers.push(answer);
            self.segments.push(Segment { parent: Some((id, answer)), state: SegmentState::Open(open) });
            self.segments.len() - 1
        };
        let (yes, no) = (child(true), child(false));
        SegmentState::Fork(Fork { test, asked, yes, no })
    }

    /// Does one thing more.
    fn advance(&mut self, open: &mut Expansion, watch: &Watch) -> Option<Progress> {
        match open.phase.clone() {
            Phase::Conditions(index) => {
                let question = Arc::clone(&self.question);
                let Some(code) = question.conditions.get(index) else {
                    open.phase = Phase::Blocks;
                    return None;
                };
                match self.run.decide(code, &mut self.nodes, open.answers()) {
                    Ok((true, used)) => {
                        open.phase = Phase::Conditions(index + 1);
                        open.count(used);
                        None
                    }
                    // A condition without a value excludes its values.
                    Ok((false, _)) | Err(Halt::Alarm(_)) => {
                        Some(Progress::Ended(self.leaf(End::Excluded, 0)))
                    }
                    Err(Halt::Fork(test)) => Some(Progress::Asked(test)),
                    Err(Halt::Unfollowed(what)) => Some(Progress::Ended(self.leaf(End::Unfollowed(what), 0))),
                }
            }
            Phase::Blocks => self.block(open, watch),
            Phase::Claims(mut leaf) => {
                let question = Arc::clone(&self.question);
                let Some(claim) = question.claims.get(leaf.claims.len()) else {
                    return Some(Progress::Ended(leaf));
                };
                let state = match (claim, &leaf.end) {
                    (Claim::Condition(code), End::Program) => {
                        let before = self.nodes.answers_left();
                        let result = self.run.condition(code, &mut self.nodes, open.answers());
                        if matches!(result, Err(Halt::Alarm(_) | Halt::Unfollowed(_))) {
                            // The answers taken before belong to this claim.
                            open.count(before - self.nodes.answers_left());
                        }
                        match result {
                            Ok((formula, used)) => {
                                open.count(used);
                                match node_formula(&mut self.nodes, &formula) {
                                    NodeFormula::Known(true) => ClaimState::Holds,
                                    NodeFormula::Known(false) => ClaimState::Fails,
                                    formula => ClaimState::Depends(formula),
                                }
                            }
                            Err(Halt::Fork(test)) => return Some(Progress::Asked(test)),
                            // A claim without a value doesn't hold.
                            Err(Halt::Alarm(_)) => ClaimState::Fails,
                            Err(Halt::Unfollowed(what)) => ClaimState::Unfollowed(what),
                        }
                    }
                    (claim, _) => state_at(claim, &leaf.end, leaf.blocks),
                };
                leaf.claims.push(state);
                open.phase = Phase::Claims(leaf);
                None
            }
        }
    }

    /// Executes a block.
    fn block(&mut self, open: &mut Expansion, watch: &Watch) -> Option<Progress> {
        let blocks = self.run.control().blocks();
        let limits = Limits { blocks: self.question.max_blocks };
        if blocks.is_multiple_of(BLOCKS_PER_LOOK) && (watch.is_over() || blocks - open.blocks > self.patience)
        {
            return Some(Progress::Stopped);
        }
        if blocks > self.question.enough_blocks()
            || blocks >= self.question.max_blocks
            || self.run.exceeds_moves(limits)
        {
            return Some(Progress::Ended(self.leaf(End::cut_off(blocks), blocks)));
        }
        match self.run.advance(&mut self.nodes, open.answers(), &mut self.library) {
            Advance::Next(used) => {
                open.count(used);
                None
            }
            Advance::Fork(test) => Some(Progress::Asked(test)),
            Advance::End(outcome, used) => {
                let end = End::of(&outcome, self.run.control());
                self.end(open, end, used)
            }
            Advance::Unfollowed(what) => {
                let what = format!("{}: {what}", self.place());
                Some(Progress::Ended(self.leaf(End::Unfollowed(what), blocks)))
            }
        }
    }

    /// Returns program and line of the current block.
    fn place(&self) -> String {
        let (memory, block) = (self.run.control().memory(), self.run.control().backtrace().block);
        let line = memory.sources().line_column(block).line;
        let program = memory.program_at(block).map_or_else(String::new, |program| program.label());
        format!("{program} line {line}")
    }

    fn end(&mut self, open: &mut Expansion, end: End, used: usize) -> Option<Progress> {
        // An alarm leaves the locals of the macro.
        self.run.leave_calls();
        let blocks = self.run.control().blocks();
        let mut leaf = Leaf { end, blocks, claims: Vec::new(), bounds: Vec::new() };
        for number in &self.question.bounds {
            leaf.bounds.push(match self.run.variable(*number) {
                Ok(Some(term)) if leaf.end == End::Program => BoundState::Node(self.nodes.id(term)),
                Ok(_) => BoundState::None,
                Err(_) if leaf.end != End::Program => BoundState::None,
                Err(Halt::Unfollowed(what)) => BoundState::Unfollowed(what),
                Err(_) => BoundState::None,
            });
        }
        // The answers to the questions of a last block that ends the run.
        open.count(used);
        open.from.answers.drain(..open.used);
        open.used = 0;
        open.from.snapshot = Rc::new(self.run.snapshot());
        open.phase = Phase::Claims(leaf);
        open.from.phase = open.phase.clone();
        None
    }

    /// Returns a leaf whose claims are as its end says.
    fn leaf(&self, end: End, blocks: u64) -> Leaf {
        let claims = self.question.claims.iter().map(|claim| state_at(claim, &end, blocks)).collect();
        let bound = match &end {
            End::Unfollowed(what) => BoundState::Unfollowed(what.clone()),
            End::Excluded | End::Program | End::Alarm(_) | End::Endless => BoundState::None,
        };
        Leaf { end, blocks, claims, bounds: vec![bound; self.question.bounds.len()] }
    }
}

/// Result of one step of an expansion.
enum Progress {
    Ended(Leaf),
    Asked(Test),
    Stopped,
}
