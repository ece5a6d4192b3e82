//! Single runs by the control itself: the last word on every counterexample.
use std::sync::Arc;

use gcode_control::symbolic::{Formula, Snapshot, SymbolicRun, Term, TermOperation, Terms, Test};
use gcode_control::{Control, Limits, Outcome};
use gcode_lang::program::Library;

use crate::leaf::{ClaimState, End, state_at};
use crate::region::ClaimSet;
use crate::request::Claim;
use crate::tree::Question;
use crate::watch::Watch;

/// Number of blocks between two polls of the clock.
const BLOCKS_PER_POLL: u64 = 65_536;

/// Control that runs single points, each as from power-on.
#[derive(Debug)]
pub(crate) struct Witness<L> {
    run: SymbolicRun,
    start: Snapshot,
    library: L,
    question: Arc<Question>,
}

/// Result of a single run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PointResult {
    /// `None` if the conditions of the request exclude the point.
    pub(crate) end: Option<End>,
    pub(crate) blocks: u64,
    pub(crate) failed: ClaimSet,
    /// Claims that a run which a limit has cut off doesn't decide.
    pub(crate) undecided: ClaimSet,
    /// Values of the variables whose bounds are wanted, at the end of a run.
    pub(crate) values: Vec<Option<f64>>,
}

/// Terms of a run that has none.
struct NoTerms;

impl Terms for NoTerms {
    fn node(&mut self, _: TermOperation, _: [Term; 2]) -> Term {
        Term::Number(f64::NAN)
    }

    fn bounds(&mut self, _: Term) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    fn answer(&mut self, _: &Test) -> Option<bool> {
        None
    }
}

impl<L: Library> Witness<L> {
    pub(crate) fn new(control: Control, library: L, question: Arc<Question>) -> Self {
        let run = SymbolicRun::new(control);
        let start = run.snapshot();
        Self { run, start, library, question }
    }

    /// Runs a point.
    pub(crate) fn run(&mut self, point: &[f64], watch: &Watch) -> PointResult {
        self.run.restore(&self.start);
        for (range, value) in self.question.ranges.iter().zip(point) {
            // A variable that can't be set has been refused with the request.
            _ = self.run.set_term(range.variable, Term::Number(*value));
        }
        let excluded = PointResult {
            end: None,
            blocks: 0,
            failed: 0,
            undecided: 0,
            values: vec![None; self.question.bounds.len()],
        };
        for code in &self.question.conditions {
            if !matches!(self.run.decide(code, &mut NoTerms, &[]), Ok((true, _))) {
                return excluded;
            }
        }
        let enough = self.question.enough_blocks().saturating_add(1);
        let outcome = self.run_blocks(self.question.max_blocks.min(enough), watch);
        let end = End::of(&outcome, self.run.control());
        let blocks = self.run.control().blocks();
        self.run.leave_calls();
        let (mut failed, mut undecided) = (0, 0);
        for (index, claim) in self.question.claims.iter().enumerate() {
            let holds = match (claim, &end) {
                (Claim::Condition(code), End::Program) => {
                    let formula = self.run.condition(code, &mut NoTerms, &[]);
                    matches!(formula.map(|(formula, _)| value(&formula)), Ok(Some(true)))
                }
                (claim, end) => match state_at(claim, end, blocks) {
                    ClaimState::Unfollowed(_) => {
                        undecided |= 1 << index;
                        true
                    }
                    state => state == ClaimState::Holds,
                },
            };
            failed |= u64::from(!holds) << index;
        }
        let is_end = end == End::Program;
        let number = |number: &u32| {
            let term = self.run.variable(*number).ok().flatten().filter(|_| is_end);
            term.and_then(Term::number)
        };
        PointResult {
            values: self.question.bounds.iter().map(number).collect(),
            end: Some(end),
            blocks,
            failed,
            undecided,
        }
    }
}

impl<L: Library> Witness<L> {
    /// Runs up to a number of blocks, as long as the work isn't to end.
    fn run_blocks(&mut self, most: u64, watch: &Watch) -> Outcome {
        let mut blocks = 0;
        loop {
            blocks = most.min(blocks + BLOCKS_PER_POLL);
            let outcome = self.run.run_numbers(Limits { blocks }, &mut self.library);
            let is_cut_off = matches!(outcome, Outcome::Limit) && self.run.control().endless_loop().is_none();
            if !is_cut_off || blocks == most || watch.is_over() {
                return outcome;
            }
        }
    }
}

/// Returns the value of a condition without nodes.
fn value(formula: &Formula) -> Option<bool> {
    use gcode_lang::syntax::ast::BinaryOp;
    match formula {
        Formula::Known(known) => Some(*known),
        Formula::Compare(..) => None,
        Formula::Logic(op, left, right) => {
            let (left, right) = (value(left)?, value(right)?);
            Some(match op {
                BinaryOp::And => left && right,
                BinaryOp::Xor => left != right,
                _ => left || right,
            })
        }
    }
}
