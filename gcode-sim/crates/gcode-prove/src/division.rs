//! Division of a box: exactly where a condition turns or a whole number steps, otherwise at a middle.
use std::collections::BTreeSet;

use gcode_enclosure::{Arena, Condition, Domain, Enclosures, Interval, Node, NodeId, Relation, Unary};

use crate::region::Finding;

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
