//! Proof over a box that joins the branches of a loop at each iteration: one state has the values of all branches.
//!
//! A variable that differs between ways becomes an input of its own, whose range has its values on every way. What relates it
//! to others is kept in two forms: its distance from another input, and conditions that hold on every way, found among
//! those that the program asks. A second pass knows the conditions of the first from its first turn on. Nothing is refuted.
mod substitution;
#[cfg(test)]
mod tests;
mod way;

use std::collections::{BTreeMap, HashMap, HashSet};

use gcode_control::Limits;
use gcode_control::symbolic::{Advance, Halt, Snapshot, SymbolicRun, Term, Test};
use gcode_enclosure::{Condition, Domain, Enclosures, Interval, NodeId, Relation};
use gcode_lang::program::Library;

use self::substitution::{has_values, inputs_of, substitute};
use self::way::{Way, WayTerms};
use crate::leaf::{ClaimState, End, node_formula, state_at};
use crate::nodes::{Nodes, key, semantics};
use crate::region::{ClaimSet, decide};
use crate::request::Claim;
use crate::tree::{Question, Tree};
use crate::watch::Watch;

/// Largest number of variables that are inputs of their own.
const MAX_JOINED: usize = 7;

/// Largest number of ways between two joins.
const MAX_WAYS: usize = 64;

/// Largest number of turns.
const MAX_TURNS: usize = 600;

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
    terms: WayTerms,
    question: &'t Question,
    domain: &'t Domain,
    watch: &'t Watch<'t>,
    /// Claims that hold at every end so far.
    proved: ClaimSet,
    /// Inputs by the slots of their variables.
    slots: BTreeMap<usize, usize>,
    /// Conditions on the inputs that may hold on every way.
    candidates: Vec<Condition>,
    known: HashSet<Condition>,
    blocks: u64,
    /// Part of the time at which the work is given up.
    end_part: f64,
}

/// Returns the claims of a set that are proved of a box by joining its ways.
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
    let terms = WayTerms { nodes, enclosures, answers: HashMap::new() };
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
    /// Follows all ways to their ends; `None` if they are too many.
    fn pass(&mut self) -> Option<()> {
        let begin = Way {
            snapshot: self.run.snapshot(),
            enclosures: Enclosures::new(self.domain.clone()),
            answers: HashMap::new(),
        };
        let mut ways = self.included(begin)?;
        for _ in 0..MAX_TURNS {
            let mut arrived = Vec::new();
            for way in ways {
                self.follow(way, &mut arrived)?;
            }
            if arrived.is_empty() || self.proved == 0 {
                return Some(());
            }
            ways = self.join_all(arrived)?;
        }
        None
    }

    fn is_enough(&self) -> bool {
        self.watch.is_over()
            || self.watch.part() > self.end_part
            || self.terms.nodes.arena().len() > MAX_NODES
    }

    /// Returns the ways on which the conditions of the request hold.
    fn included(&mut self, begin: Way) -> Option<Vec<Way>> {
        let mut ways = vec![begin];
        for code in &self.question.conditions {
            let mut kept = Vec::new();
            while let Some(way) = ways.pop() {
                self.take(&way);
                match self.run.decide(code, &mut self.terms, &[]) {
                    Ok((true, _)) => kept.push(Way { answers: HashMap::new(), ..self.leave(way) }),
                    Ok((false, _)) | Err(Halt::Alarm(_)) => {}
                    Err(Halt::Fork(test)) => {
                        let way = self.leave(way);
                        self.divide(way, test, &mut ways);
                    }
                    Err(Halt::Unfollowed(_)) => return None,
                }
                if ways.len() + kept.len() > MAX_WAYS {
                    return None;
                }
            }
            ways = kept;
        }
        Some(ways)
    }

    /// Continues with a way.
    fn take(&mut self, way: &Way) {
        self.run.restore(&way.snapshot);
        self.terms.enclosures = way.enclosures.clone();
        self.terms.answers.clone_from(&way.answers);
    }

    /// Returns a way with what has been computed on it.
    fn leave(&self, way: Way) -> Way {
        Way { enclosures: self.terms.enclosures.clone(), ..way }
    }

    /// Adds the two answers of a question that a way asks.
    fn divide(&mut self, way: Way, test: Test, ways: &mut Vec<Way>) {
        for answer in [false, true] {
            let mut enclosures = way.enclosures.clone();
            let mut answers = way.answers.clone();
            answers.insert(key(&test), answer);
            let mut is_possible = true;
            if let Test::Compare(relation, left, right) = test {
                let condition = self.terms.nodes.condition(relation, left, right);
                let condition = if answer { condition } else { condition.negated() };
                is_possible = enclosures.assume(self.terms.nodes.arena(), condition);
            }
            if is_possible {
                ways.push(Way { snapshot: way.snapshot.clone(), enclosures, answers });
            }
        }
    }

    /// Follows a way to its ends, or to its next jump back.
    fn follow(&mut self, way: Way, arrived: &mut Vec<Way>) -> Option<()> {
        let mut ways = vec![way];
        while let Some(way) = ways.pop() {
            if ways.len() + arrived.len() > MAX_WAYS || self.is_enough() {
                return None;
            }
            self.take(&way);
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
                            arrived.push(self.way_here());
                            break;
                        }
                    }
                    Advance::Fork(test) => {
                        let here = self.way_here();
                        self.divide(here, test, &mut ways);
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

    fn way_here(&self) -> Way {
        Way {
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
                            let WayTerms { nodes, enclosures, .. } = &mut self.terms;
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

    /// Joins ways that continue alike.
    fn join_all(&mut self, mut arrived: Vec<Way>) -> Option<Vec<Way>> {
        let mut joined = Vec::new();
        while let Some(first) = arrived.pop() {
            let (mut group, others): (Vec<_>, Vec<_>) =
                arrived.into_iter().partition(|way| way.snapshot.continues_like(&first.snapshot));
            arrived = others;
            group.push(first);
            if group.len() == 1 {
                joined.append(&mut group);
            } else {
                joined.push(self.join(&mut group)?);
            }
        }
        Some(joined)
    }

    /// Joins ways; `None` if they differ in too much.
    fn join(&mut self, ways: &mut [Way]) -> Option<Way> {
        let inputs = self.domain.ranges().len();
        let mut values: BTreeMap<usize, Vec<NodeId>> = BTreeMap::new();
        let (slots, nodes) = (&mut self.slots, &mut self.terms.nodes);
        let states: Vec<_> = ways.iter().map(|way| way.snapshot.clone()).collect();
        let states: Vec<_> = states.iter().collect();
        let snapshot = Snapshot::joined(&states, &mut |slot: usize, terms: &[Term]| {
            let ids: Vec<_> = terms.iter().map(|term| nodes.id(*term)).collect();
            let is_kept = terms.iter().all(|term| *term == terms[0])
                && !inputs_of(nodes.arena(), ids[0]).any(|input| input >= inputs);
            if is_kept {
                return Some(terms[0]);
            }
            let count = slots.len();
            let input = *slots.entry(slot).or_insert(inputs + count);
            if input >= inputs + MAX_JOINED {
                return None;
            }
            values.insert(input, ids);
            Some(nodes.input(input))
        })?;
        let mut ranges = self.domain.ranges().to_vec();
        ranges.resize(inputs + MAX_JOINED, Interval::point(0.0));
        for (input, ids) in &values {
            let arena = self.terms.nodes.arena();
            let of_ways = ways.iter_mut().zip(ids);
            ranges[*input] = of_ways.fold(Interval::EMPTY, |range, (way, id)| {
                range.hull(way.enclosures.enclose_tightly(arena, *id))
            });
        }
        if ranges.iter().any(|range| range.is_empty()) {
            return None;
        }
        self.find_candidates(ways, &values);
        let relations = self.relations(ways, &values, &ranges);
        let mut enclosures = Enclosures::new(Domain::new(ranges));
        for (input, other, difference) in relations {
            enclosures.relate(input, other, difference);
        }
        for candidate in self.candidates.clone() {
            if self.is_enough() {
                return None;
            }
            if self.holds_on_all(ways, &values, candidate)
                && !enclosures.assume(self.terms.nodes.arena(), candidate)
            {
                return None;
            }
        }
        Some(Way { snapshot, enclosures, answers: HashMap::new() })
    }

    /// Returns for inputs of their own another input from which they differ little, and by how much.
    fn relations(
        &mut self,
        ways: &mut [Way],
        values: &BTreeMap<usize, Vec<NodeId>>,
        ranges: &[Interval],
    ) -> Vec<(usize, usize, Interval)> {
        let mut relations = Vec::new();
        let mut others: Vec<(usize, Vec<NodeId>)> = Vec::new();
        for (index, range) in self.domain.ranges().iter().enumerate() {
            if range.width() > 0.0 {
                let term = self.terms.nodes.input(index);
                others.push((index, vec![self.terms.nodes.id(term); ways.len()]));
            }
        }
        for (input, ids) in values {
            let arena = self.terms.nodes.arena();
            let mut best: Option<(usize, Interval)> = None;
            for (other, of_other) in &others {
                let pairs = ways.iter_mut().zip(ids.iter().zip(of_other));
                let difference = pairs.fold(Interval::EMPTY, |range, (way, (id, other))| {
                    range.hull(way.enclosures.difference_range(arena, *id, *other))
                });
                if !difference.is_empty()
                    && difference.width() < 0.6 * ranges[*input].width()
                    && best.is_none_or(|(_, best)| difference.width() <= best.width())
                {
                    best = Some((*other, difference));
                }
            }
            relations.extend(best.map(|(other, difference)| (*input, other, difference)));
            others.push((*input, ids.clone()));
        }
        relations
    }

    /// Finds conditions that may hold on every way: those assumed on one, of its variables, and the order of variables and
    /// inputs.
    fn find_candidates(&mut self, ways: &[Way], values: &BTreeMap<usize, Vec<NodeId>>) {
        let inputs = self.domain.ranges().len();
        let joined: Vec<usize> = values.keys().copied().collect();
        for (place, way) in ways.iter().enumerate() {
            for condition in way.enclosures.conditions().to_vec() {
                for preferred in &joined {
                    let mut map = HashMap::new();
                    for input in std::iter::once(preferred).chain(&joined) {
                        let id = values[input][place];
                        if self.terms.nodes.arena().as_constant(id).is_none() {
                            let term = self.terms.nodes.input(*input);
                            let own = self.terms.nodes.id(term);
                            map.entry(id).or_insert(own);
                        }
                    }
                    if let Some(found) = self.substituted(condition, &map, &|input| input < inputs) {
                        self.add_candidate(found);
                    }
                }
            }
        }
        for input in &joined {
            for other in 0..inputs {
                let sides = [*input, other].map(|input| self.terms.nodes.input(input));
                let [own, other] = sides.map(|term| self.terms.nodes.id(term));
                self.add_candidate(Condition::new(Relation::Le, own, other));
                self.add_candidate(Condition::new(Relation::Ge, own, other));
            }
        }
    }

    fn add_candidate(&mut self, condition: Condition) {
        let weaker = match condition.relation {
            Relation::Gt => Some(Relation::Ge),
            Relation::Lt => Some(Relation::Le),
            Relation::Eq | Relation::Ne | Relation::Ge | Relation::Le => None,
        };
        let weaker = weaker.map(|relation| Condition { relation, ..condition });
        for condition in weaker.into_iter().chain([condition]) {
            if self.candidates.len() < MAX_CONDITIONS && self.known.insert(condition) {
                self.candidates.push(condition);
            }
        }
    }

    /// Returns true if a condition on the inputs holds of the values on every way.
    fn holds_on_all(
        &mut self,
        ways: &mut [Way],
        values: &BTreeMap<usize, Vec<NodeId>>,
        condition: Condition,
    ) -> bool {
        let inputs = self.domain.ranges().len();
        for (place, way) in ways.iter_mut().enumerate() {
            let mut map = HashMap::new();
            for (input, ids) in values {
                let term = self.terms.nodes.input(*input);
                map.insert(self.terms.nodes.id(term), ids[place]);
            }
            let Some(here) = self.substituted(condition, &map, &|input| input < inputs) else {
                return false;
            };
            let arena = self.terms.nodes.arena();
            let computed: HashSet<NodeId> = values.values().map(|ids| ids[place]).collect();
            if !has_values(arena, &mut way.enclosures, here, computed)
                || way.enclosures.decide_by_signs(arena, here) != Some(true)
            {
                return false;
            }
        }
        true
    }

    /// Returns a condition with nodes replaced; `None` if another input than those kept is left.
    fn substituted(
        &mut self,
        condition: Condition,
        map: &HashMap<NodeId, NodeId>,
        is_kept: &dyn Fn(usize) -> bool,
    ) -> Option<Condition> {
        let arena = self.terms.nodes.arena_mut();
        let mut done = HashMap::new();
        let left = substitute(arena, condition.left, map, is_kept, &mut done)?;
        let right = substitute(arena, condition.right, map, is_kept, &mut done)?;
        Some(Condition { left, right, ..condition })
    }
}
