//! One box: every way that its values can take, and what the claims are there.
use std::collections::BTreeSet;

use gcode_enclosure::{Arena, Condition, Domain, Enclosures, Interval, Node, NodeId, Relation, Unary};
use gcode_lang::program::Library;
use gcode_lang::syntax::ast::BinaryOp;

use crate::nodes::is_finite;
use crate::tree::{Asked, BoundState, ClaimState, End, Leaf, NodeFormula, SegmentId, Step, Tree};
use crate::watch::Watch;

/// Largest number of ways of a box; with more it is divided.
const MAX_WAYS: usize = 48;

/// Largest number of undecided questions of a box.
const MAX_FORKS: usize = 400;

/// Largest number of questions of a box, decided ones included.
const MAX_STEPS: usize = 20_000;

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
            let fork = match tree.step(id, watch) {
                Step::Fork(fork) => fork,
                Step::Leaf(leaf) => {
                    self.ways += 1;
                    self.leaf(tree, &leaf, &mut enclosures, last);
                    if self.ways > MAX_WAYS && !pending.is_empty() {
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
fn decide(
    formula: &NodeFormula,
    arena: &Arena,
    enclosures: &mut Enclosures,
    undecided: &mut Vec<Condition>,
) -> Option<bool> {
    match formula {
        NodeFormula::Known(known) => Some(*known),
        NodeFormula::Condition(condition) => {
            let answer = enclosures.decide(arena, *condition);
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

/// Divides a box where it decides most; empty if every input has one value.
pub(crate) fn divide(arena: &Arena, domain: &Domain, finding: &Finding) -> Vec<Domain> {
    let first = finding.undecided.get(turn(domain, finding.undecided.len()));
    for condition in first.into_iter().chain(finding.undecided.iter().take(8)) {
        let parts =
            cut_at_limit(arena, domain, *condition).or_else(|| cut_at_turn(arena, domain, *condition));
        if let Some(parts) = parts {
            return parts;
        }
    }
    for condition in finding.undecided.iter().take(2) {
        if let Some(parts) = cut_at_step(arena, domain, *condition) {
            return parts;
        }
    }
    let input = first.and_then(|condition| best_input(arena, domain, *condition));
    let widest = || {
        let ranges = domain.ranges().iter().enumerate().filter(|(_, range)| range.lo() < range.hi());
        let width = |range: &Interval| range.width() / (range.magnitude() + f64::MIN_POSITIVE);
        ranges.max_by(|a, b| width(a.1).total_cmp(&width(b.1))).map(|(input, _)| input)
    };
    let Some(input) = input.or_else(widest) else { return Vec::new() };
    domain.split(input).map_or_else(Vec::new, Vec::from)
}

/// Returns which of several conditions decides where a box is divided: mostly the first, now and then another, since some
/// are never decided and need not be.
fn turn(domain: &Domain, count: usize) -> usize {
    let widths = domain.ranges().iter().map(|range| range.width()).filter(|width| *width > 0.0);
    // Every division changes the number of halvings.
    let halvings: f64 = widths.map(|width| -libm::log2(width)).sum();
    let step = halvings.round().rem_euclid(3000.0) as usize;
    if count > 1 && step % 3 == 2 { 1 + step / 3 % (count - 1).min(5) } else { 0 }
}

/// Cuts a box exactly where a condition compares an input with a number.
fn cut_at_limit(arena: &Arena, domain: &Domain, condition: Condition) -> Option<Vec<Domain>> {
    let input_of = |node: NodeId| match arena.node(node) {
        Node::Input(input) => Some(input),
        _ => None,
    };
    let (input, limit, relation) = match (input_of(condition.left), arena.as_constant(condition.right)) {
        (Some(input), Some(limit)) => (input, limit, condition.relation),
        _ => {
            let input = input_of(condition.right)?;
            (input, arena.as_constant(condition.left)?, condition.relation.swapped())
        }
    };
    let range = domain.range(input);
    let (below, above) = (limit.next_down(), limit.next_up());
    let parts = match relation {
        Relation::Lt | Relation::Ge => vec![(range.lo(), below), (limit, range.hi())],
        Relation::Le | Relation::Gt => vec![(range.lo(), limit), (above, range.hi())],
        Relation::Eq | Relation::Ne => vec![(range.lo(), below), (limit, limit), (above, range.hi())],
    };
    let parts = parts.into_iter().filter(|(lo, hi)| lo <= hi && *lo >= range.lo() && *hi <= range.hi());
    let parts: Vec<_> = parts.map(|(lo, hi)| domain.with(input, Interval::new(lo, hi))).collect();
    (parts.len() > 1).then_some(parts)
}

/// Cuts a box exactly where a condition of one input turns, if it has different answers at both ends.
fn cut_at_turn(arena: &Arena, domain: &Domain, condition: Condition) -> Option<Vec<Domain>> {
    let input = only_input(arena, domain, &[condition.left, condition.right])?;
    let at_low = holds_at(arena, domain, input, domain.range(input).lo(), condition)?;
    cut_where(domain, input, |value| {
        holds_at(arena, domain, input, value, condition).map(|holds| holds == at_low)
    })
}

fn holds_at(arena: &Arena, domain: &Domain, input: usize, value: f64, condition: Condition) -> Option<bool> {
    let mut point = domain.midpoint();
    point[input] = value;
    arena.holds(condition, &point).ok()
}

/// Cuts a box exactly where a whole number on which a condition depends has its only step.
fn cut_at_step(arena: &Arena, domain: &Domain, condition: Condition) -> Option<Vec<Domain>> {
    let is_step =
        |node: &NodeId| matches!(arena.node(*node), Node::Unary(Unary::Round | Unary::Fix | Unary::Fup, _));
    let steps = cone(arena, &[condition.left, condition.right]).into_iter().filter(is_step);
    steps.take(16).find_map(|node| {
        let input = only_input(arena, domain, &[node])?;
        let mut point = domain.midpoint();
        let mut value_at = |value: f64| {
            point[input] = value;
            arena.evaluate(node, &point).ok()
        };
        let (low, high) = (value_at(domain.range(input).lo())?, value_at(domain.range(input).hi())?);
        if (high - low).abs() != 1.0 {
            return None;
        }
        cut_where(domain, input, |value| Some(value_at(value)? == low))
    })
}

/// Cuts a box between the last double of an input that is as the first, and the next one.
fn cut_where(
    domain: &Domain,
    input: usize,
    mut is_as_first: impl FnMut(f64) -> Option<bool>,
) -> Option<Vec<Domain>> {
    let range = domain.range(input);
    let (mut low, mut high) = (range.lo(), range.hi());
    if is_as_first(high)? {
        return None;
    }
    while low.next_up() < high {
        let middle = low / 2.0 + high / 2.0;
        let middle = if low < middle && middle < high { middle } else { low.next_up() };
        if is_as_first(middle)? { low = middle } else { high = middle }
    }
    Some(vec![
        domain.with(input, Interval::new(range.lo(), low)),
        domain.with(input, Interval::new(high, range.hi())),
    ])
}

/// Returns the only input with a range on which nodes depend.
fn only_input(arena: &Arena, domain: &Domain, nodes: &[NodeId]) -> Option<usize> {
    let input_of = |node: NodeId| match arena.node(node) {
        Node::Input(input) if domain.range(input).lo() < domain.range(input).hi() => Some(input),
        _ => None,
    };
    let mut inputs = cone(arena, nodes).into_iter().filter_map(input_of);
    let first = inputs.next()?;
    inputs.all(|input| input == first).then_some(first)
}

/// Returns nodes and everything of which they are computed.
fn cone(arena: &Arena, nodes: &[NodeId]) -> BTreeSet<NodeId> {
    let mut seen = BTreeSet::new();
    let mut pending = nodes.to_vec();
    while let Some(node) = pending.pop() {
        if seen.insert(node) {
            match arena.node(node) {
                Node::Input(_) | Node::Constant(_) => {}
                Node::Unary(_, x) => pending.push(x),
                Node::Binary(_, a, b) => pending.extend([a, b]),
            }
        }
    }
    seen
}

/// Returns the input that, known to be at its middle, leaves least of a condition's margin.
fn best_input(arena: &Arena, domain: &Domain, condition: Condition) -> Option<usize> {
    let margin = |domain: Domain| {
        let mut enclosures = Enclosures::with_degree(domain, 0);
        let (left, right) =
            (enclosures.enclose(arena, condition.left), enclosures.enclose(arena, condition.right));
        left.width() + right.width()
    };
    let all = margin(domain.clone());
    let ranges = domain.ranges().iter().enumerate().filter(|(_, range)| range.lo() < range.hi());
    let rated = ranges
        .map(|(input, range)| (all - margin(domain.with(input, Interval::point(range.midpoint()))), input));
    let best = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > 0.0).then_some(best.1)
}
