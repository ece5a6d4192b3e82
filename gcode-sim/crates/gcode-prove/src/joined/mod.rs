//! Proof over a box that joins the branches of a loop at each iteration: one state has the values of all paths.
//!
//! A variable that differs between paths becomes an input of its own, whose range has its values on every path. What relates it
//! to others is kept in two forms: its distance from another input, and conditions that hold on every path, found among
//! those that the program asks. A second pass knows the conditions of the first from its first iteration on. Nothing is refuted.
mod joining;
mod path;
mod substitution;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, HashMap, HashSet};

use gcode_control::Limits;
use gcode_control::symbolic::{Advance, Halt, SymbolicRun, Term, Test};
use gcode_enclosure::{Condition, Domain, Enclosures, Interval};
use gcode_lang::program::Library;

use self::path::{PathState, PathTerms};
use crate::leaf::{ClaimState, End, node_formula, state_at};
use crate::nodes::{Nodes, key, semantics};
use crate::region::{ClaimSet, decide};
use crate::request::Claim;
use crate::tree::{Question, Tree};
use crate::watch::Watch;

/// Largest number of variables that are inputs of their own.
const MAX_JOINED: usize = 7;

/// Largest number of paths between two joins.
const MAX_PATHS: usize = 64;

/// Largest number of iterations.
const MAX_ITERATIONS: usize = 600;

/// Largest number of nodes.
const MAX_NODES: usize = 100_000;

/// Largest number of passes.
const MAX_PASSES: usize = 4;

/// Largest number of conditions that are kept.
const MAX_CONDITIONS: usize = 48;

/// Largest part of the time.
const MAX_PART: f64 = 0.08;

/// Proof of one box.
struct JoinedProof<'t, L> {
    run: &'t mut SymbolicRun,
    library: &'t mut L,
    terms: PathTerms,
    question: &'t Question,
    domain: &'t Domain,
    watch: &'t Watch<'t>,
    /// Claims that hold at every end so far.
    proved: ClaimSet,
    /// Inputs by the slots of their variables.
    slots: BTreeMap<usize, usize>,
    /// Conditions on the inputs that may hold on every path.
    candidates: Vec<Condition>,
    known: HashSet<Condition>,
    blocks: u64,
    /// Part of the time at which the work is given up.
    end_part: f64,
}

/// Returns the claims of a set that are proved of a box by joining its paths.
pub(crate) fn prove_joined<L: Library>(
    tree: &mut Tree<L>,
    domain: &Domain,
    claims: ClaimSet,
    watch: &Watch,
) -> ClaimSet {
    let question = tree.question();
    let (start, semantics) = (tree.start(), semantics(tree.control().settings()));
    let inputs = domain.ranges().len();
    // Of the inputs to come nothing is known here.
    let joined = std::iter::repeat_n(Interval::ALL, MAX_JOINED);
    let all = Domain::new(domain.ranges().iter().copied().chain(joined).collect());
    let nodes = Nodes::new(semantics, all, question.widening);
    let (run, library) = tree.run_and_library();
    let enclosures = Enclosures::new(domain.clone());
    let terms = PathTerms { nodes, enclosures, answers: HashMap::new() };
    let mut proof = JoinedProof {
        run,
        library,
        terms,
        question: &question,
        domain,
        watch,
        proved: claims,
        slots: BTreeMap::new(),
        candidates: Vec::new(),
        known: HashSet::new(),
        blocks: 0,
        end_part: watch.part() + MAX_PART,
    };
    let mut proved = 0;
    for _ in 0..MAX_PASSES {
        let known = proof.known.len();
        proof.proved = claims & !proved;
        proof.run.restore(&start);
        for (index, range) in question.ranges.iter().enumerate().take(inputs) {
            let input = proof.terms.nodes.input(index);
            let term = if range.low == range.high { Term::Number(range.low) } else { input };
            // A variable that can't be set has been refused with the request.
            _ = proof.run.set_term(range.variable, term);
        }
        if proof.pass().is_none() {
            break;
        }
        proved |= proof.proved;
        if proved == claims || proof.known.len() == known {
            break;
        }
    }
    proved
}

impl<L: Library> JoinedProof<'_, L> {
    /// Follows all paths to their ends; `None` if they are too many.
    fn pass(&mut self) -> Option<()> {
        let begin = PathState {
            snapshot: self.run.snapshot(),
            enclosures: Enclosures::new(self.domain.clone()),
            answers: HashMap::new(),
        };
        let mut paths = self.included(begin)?;
        for _ in 0..MAX_ITERATIONS {
            let mut arrived = Vec::new();
            for path in paths {
                self.follow(path, &mut arrived)?;
            }
            if arrived.is_empty() || self.proved == 0 {
                return Some(());
            }
            paths = self.join_all(arrived)?;
        }
        None
    }

    /// Returns true if the time or the nodes are used up.
    fn is_used_up(&self) -> bool {
        self.watch.is_over()
            || self.watch.part() > self.end_part
            || self.terms.nodes.arena().len() > MAX_NODES
    }

    /// Returns the paths on which the conditions of the request hold.
    fn included(&mut self, begin: PathState) -> Option<Vec<PathState>> {
        let mut paths = vec![begin];
        for code in &self.question.conditions {
            let mut kept = Vec::new();
            while let Some(path) = paths.pop() {
                self.resume(&path);
                match self.run.decide(code, &mut self.terms, &[]) {
                    Ok((true, _)) => kept.push(PathState { answers: HashMap::new(), ..self.suspended(path) }),
                    Ok((false, _)) | Err(Halt::Alarm(_)) => {}
                    Err(Halt::Fork(test)) => {
                        let path = self.suspended(path);
                        self.divide(path, test, &mut paths);
                    }
                    Err(Halt::Unfollowed(_)) => return None,
                }
                if paths.len() + kept.len() > MAX_PATHS {
                    return None;
                }
            }
            paths = kept;
        }
        Some(paths)
    }

    /// Continues with a path.
    fn resume(&mut self, path: &PathState) {
        self.run.restore(&path.snapshot);
        self.terms.enclosures = path.enclosures.clone();
        self.terms.answers.clone_from(&path.answers);
    }

    /// Returns a path with what has been computed on it.
    fn suspended(&self, path: PathState) -> PathState {
        PathState { enclosures: self.terms.enclosures.clone(), ..path }
    }

    /// Adds the two answers of a question that a path asks.
    fn divide(&mut self, path: PathState, test: Test, paths: &mut Vec<PathState>) {
        for answer in [false, true] {
            let mut enclosures = path.enclosures.clone();
            let mut answers = path.answers.clone();
            answers.insert(key(&test), answer);
            let mut is_possible = true;
            if let Test::Compare(relation, left, right) = test {
                let condition = self.terms.nodes.condition(relation, left, right);
                let condition = if answer { condition } else { condition.negated() };
                is_possible = enclosures.assume(self.terms.nodes.arena(), condition);
            }
            if is_possible {
                paths.push(PathState { snapshot: path.snapshot.clone(), enclosures, answers });
            }
        }
    }

    /// Follows a path to its ends, or to its next jump back.
    fn follow(&mut self, path: PathState, arrived: &mut Vec<PathState>) -> Option<()> {
        let mut paths = vec![path];
        while let Some(path) = paths.pop() {
            if paths.len() + arrived.len() > MAX_PATHS || self.is_used_up() {
                return None;
            }
            self.resume(&path);
            loop {
                let before = self.run.position();
                let blocks = self.run.control().blocks();
                self.blocks += 1;
                let is_cut_off = blocks >= self.question.max_blocks
                    || self.run.exceeds_moves(Limits { blocks: self.question.max_blocks });
                if is_cut_off || self.blocks > 200_000 {
                    return None;
                }
                match self.run.advance(&mut self.terms, &[], self.library) {
                    Advance::Next(_) => {
                        self.terms.answers.clear();
                        let after = self.run.position();
                        if (before.0, before.1) == (after.0, after.1) && after.2 <= before.2 {
                            arrived.push(self.path_here());
                            break;
                        }
                    }
                    Advance::Fork(test) => {
                        let here = self.path_here();
                        self.divide(here, test, &mut paths);
                        break;
                    }
                    Advance::End(outcome, _) => {
                        let end = End::of(&outcome, self.run.control());
                        self.end(&end);
                        break;
                    }
                    Advance::Unfollowed(_) => {
                        self.proved = 0;
                        break;
                    }
                }
            }
        }
        Some(())
    }

    fn path_here(&self) -> PathState {
        PathState {
            snapshot: self.run.snapshot(),
            enclosures: self.terms.enclosures.clone(),
            answers: self.terms.answers.clone(),
        }
    }

    /// Decides the claims at an end.
    fn end(&mut self, end: &End) {
        let blocks = self.run.control().blocks();
        self.run.leave_calls();
        for (index, claim) in self.question.claims.iter().enumerate() {
            if self.proved >> index & 1 == 0 {
                continue;
            }
            self.terms.answers.clear();
            let holds = match (claim, end) {
                (Claim::Condition(code), End::Program) => {
                    match self.run.condition(code, &mut self.terms, &[]) {
                        Ok((formula, _)) => {
                            let formula = node_formula(&mut self.terms.nodes, &formula);
                            let PathTerms { nodes, enclosures, .. } = &mut self.terms;
                            decide(&formula, nodes.arena(), enclosures, &mut Vec::new()) == Some(true)
                        }
                        Err(_) => false,
                    }
                }
                (claim, end) => state_at(claim, end, blocks) == ClaimState::Holds,
            };
            if !holds {
                self.proved &= !(1 << index);
            }
        }
    }
}
