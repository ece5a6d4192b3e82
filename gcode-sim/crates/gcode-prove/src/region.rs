//! One box: every way that its values can take, and what the claims are there.
use gcode_enclosure::{Arena, Condition, Enclosures, Interval, NodeId};
use gcode_lang::program::Library;
use gcode_lang::syntax::ast::BinaryOp;

use crate::leaf::{BoundState, ClaimState, End, Leaf, NodeFormula};
use crate::nodes::is_finite;
use crate::tree::{Asked, SegmentId, Step, Tree};
use crate::watch::Watch;

/// Largest number of ways of a box; with more it is divided.
const MAX_WAYS: usize = 48;

/// Largest number of undecided questions of a box.
const MAX_FORKS: usize = 400;

/// Largest number of questions of a box, decided ones included.
const MAX_STEPS: usize = 20_000;

/// Number of questions between two polls of the clock.
const STEPS_PER_POLL: usize = 64;

/// Set of claims, as bits.
pub(crate) type ClaimSet = u64;

/// What is known of a box.
#[derive(Debug, Default)]
pub(crate) struct Finding {
    /// Claims that hold for all values.
    pub(crate) proved: ClaimSet,
    /// Claims that fail for all values of the box.
    pub(crate) refuted: ClaimSet,
    /// Conditions that aren't decided, the most important first.
    pub(crate) undecided: Vec<Condition>,
    /// What isn't followed on some way.
    pub(crate) unfollowed: Option<String>,
    /// Dividing the box can't help.
    pub(crate) is_final: bool,
    /// A way on which the conditions of the request hold has been reached.
    pub(crate) is_included: bool,
    /// A way on which the run ends without an alarm has been reached.
    pub(crate) has_end: bool,
    /// Ranges of the variables whose bounds are wanted; empty if no run gives them a value.
    pub(crate) bounds: Vec<Interval>,
    /// Nodes of the last way that has values for them.
    pub(crate) bound_nodes: Vec<Option<NodeId>>,
    pub(crate) is_stopped: bool,
    /// The box has too many ways.
    pub(crate) has_many_ways: bool,
}

/// Examines a box for the claims of a set.
pub(crate) fn examine<L: Library>(
    tree: &mut Tree<L>,
    enclosures: Enclosures,
    claims: ClaimSet,
    watch: &Watch,
) -> Finding {
    let mut region = Region {
        claims,
        finding: Finding {
            proved: claims,
            bounds: vec![Interval::EMPTY; tree.bound_count()],
            bound_nodes: vec![None; tree.bound_count()],
            ..Finding::default()
        },
        fails: 0,
        forks: 0,
        ways: 0,
        failing: Vec::new(),
    };
    region.walk(tree, enclosures, watch);
    region.conclude()
}

struct Region {
    claims: ClaimSet,
    finding: Finding,
    /// Claims that fail on a way.
    fails: ClaimSet,
    forks: usize,
    ways: usize,
    failing: Vec<Condition>,
}

impl Region {
    fn walk<L: Library>(&mut self, tree: &mut Tree<L>, enclosures: Enclosures, watch: &Watch) {
        // With the last question of the way that isn't decided.
        let mut pending: Vec<(SegmentId, Enclosures, Option<Condition>)> = vec![(0, enclosures, None)];
        let mut steps = 0;
        while let Some((id, mut enclosures, last)) = pending.pop() {
            steps += 1;
            if steps > MAX_STEPS {
                return self.give_up();
            }
            if steps.is_multiple_of(STEPS_PER_POLL) && watch.is_over() {
                self.finding.is_stopped = true;
                return self.give_up();
            }
            let fork = match tree.step(id, watch) {
                Step::Fork(fork) => fork,
                Step::Leaf(leaf) => {
                    self.ways += 1;
                    self.leaf(tree, &leaf, &mut enclosures, last);
                    if self.ways > MAX_WAYS && !pending.is_empty() {
                        self.finding.has_many_ways = true;
                        return self.give_up();
                    }
                    continue;
                }
                Step::Stopped => {
                    self.finding.is_stopped = true;
                    return self.give_up();
                }
            };
            let arena = tree.nodes.arena();
            let answer = match fork.asked {
                Asked::Condition(condition) => enclosures.decide(arena, condition),
                Asked::Finite(node) => is_finite(arena, &mut enclosures, node),
            };
            match answer {
                Some(true) => pending.push((fork.yes, enclosures, last)),
                Some(false) => pending.push((fork.no, enclosures, last)),
                None => {
                    self.forks += 1;
                    let mut other = enclosures.clone();
                    let (mut yes, mut no) = (true, true);
                    let mut last = last;
                    if let Asked::Condition(condition) = fork.asked {
                        last = Some(condition);
                        self.finding.undecided.push(condition);
                        yes = enclosures.assume(arena, condition);
                        no = other.assume(arena, condition.negated());
                    }
                    if self.forks > MAX_FORKS {
                        self.finding.has_many_ways = true;
                        return self.give_up();
                    }
                    // The way on which the run continues is often the one on which a claim fails.
                    pending.extend(yes.then_some((fork.yes, enclosures, last)));
                    pending.extend(no.then_some((fork.no, other, last)));
                }
            }
        }
    }

    /// Leaves the rest of the box undecided.
    fn give_up(&mut self) {
        self.finding.proved = 0;
        self.fails = 0;
        self.finding.bounds.iter_mut().for_each(|bounds| *bounds = Interval::ALL);
    }

    fn leaf<L: Library>(
        &mut self,
        tree: &Tree<L>,
        leaf: &Leaf,
        enclosures: &mut Enclosures,
        last: Option<Condition>,
    ) {
        if leaf.end == End::Excluded {
            return;
        }
        let fails = self.fails;
        self.finding.is_included = true;
        self.finding.has_end |= leaf.end == End::Program;
        let arena = tree.nodes.arena();
        for (index, state) in
            leaf.claims.iter().enumerate().filter(|(index, _)| self.claims >> index & 1 == 1)
        {
            let bit = 1 << index;
            match state {
                ClaimState::Holds => {}
                ClaimState::Fails => {
                    self.finding.proved &= !bit;
                    self.fails |= bit;
                }
                ClaimState::Unfollowed(what) => {
                    self.finding.proved &= !bit;
                    self.finding.unfollowed.get_or_insert_with(|| what.clone());
                }
                ClaimState::Depends(formula) => match decide(formula, arena, enclosures, &mut self.failing) {
                    Some(true) => {}
                    Some(false) => {
                        self.finding.proved &= !bit;
                        self.fails |= bit;
                    }
                    None => self.finding.proved &= !bit,
                },
            }
        }
        if self.fails & !fails != 0 || self.fails != 0 && self.failing.is_empty() {
            // Whether this way is taken at all decides.
            self.failing.extend(last);
        }
        self.bounds(leaf, arena, enclosures);
    }

    fn bounds(&mut self, leaf: &Leaf, arena: &Arena, enclosures: &mut Enclosures) {
        let finding = &mut self.finding;
        for (index, state) in leaf.bounds.iter().enumerate() {
            match state {
                BoundState::None => {}
                BoundState::Unfollowed(what) => {
                    finding.unfollowed.get_or_insert_with(|| what.clone());
                    finding.bounds[index] = Interval::ALL;
                }
                BoundState::Node(node) => {
                    let range = enclosures.enclose_tightly(arena, *node);
                    // The conditions of the way narrow the difference from 0.
                    let range = range.intersect(enclosures.difference_range(arena, *node, Arena::ZERO));
                    finding.bounds[index] = finding.bounds[index].hull(range);
                    finding.bound_nodes[index] = Some(*node);
                }
            }
        }
    }

    fn conclude(mut self) -> Finding {
        let has_one_way = self.forks == 0 && self.ways == 1;
        if has_one_way {
            self.finding.refuted = self.fails & self.claims;
            self.finding.is_final = self.finding.unfollowed.is_some();
        }
        // What the claims say decides more often than where a way divides.
        self.failing.append(&mut self.finding.undecided);
        self.finding.undecided = self.failing;
        self.finding
    }
}

/// Decides a condition over nodes; those that aren't decided are collected.
pub(crate) fn decide(
    formula: &NodeFormula,
    arena: &Arena,
    enclosures: &mut Enclosures,
    undecided: &mut Vec<Condition>,
) -> Option<bool> {
    match formula {
        NodeFormula::Known(known) => Some(*known),
        NodeFormula::Condition(condition) => {
            let answer = enclosures.decide_by_signs(arena, *condition);
            if answer.is_none() {
                undecided.push(*condition);
            }
            answer
        }
        NodeFormula::Logic(op, left, right) => {
            let left = decide(left, arena, enclosures, undecided);
            match (op, left) {
                (BinaryOp::And, Some(false)) => Some(false),
                (BinaryOp::And, Some(true)) => decide(right, arena, enclosures, undecided),
                (BinaryOp::Xor, left) => {
                    let right = decide(right, arena, enclosures, undecided)?;
                    Some(left? != right)
                }
                (BinaryOp::And, None) => {
                    let right = decide(right, arena, enclosures, undecided);
                    if right == Some(false) { right } else { None }
                }
                (_, Some(true)) => Some(true),
                (_, Some(false)) => decide(right, arena, enclosures, undecided),
                (_, None) => {
                    let right = decide(right, arena, enclosures, undecided);
                    if right == Some(true) { right } else { None }
                }
            }
        }
    }
}
