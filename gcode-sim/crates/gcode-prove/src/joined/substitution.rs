//! Nodes with others in their place, and the inputs of which a node is computed.
use std::collections::{HashMap, HashSet};

use gcode_enclosure::{Arena, Condition, Enclosures, Node, NodeId};

/// Returns a node in which others are replaced; `None` if another input than those kept is left.
pub(super) fn substitute(
    arena: &mut Arena,
    node: NodeId,
    map: &HashMap<NodeId, NodeId>,
    is_kept: &dyn Fn(usize) -> bool,
    done: &mut HashMap<NodeId, Option<NodeId>>,
) -> Option<NodeId> {
    if let Some(other) = map.get(&node) {
        return Some(*other);
    }
    if let Some(known) = done.get(&node) {
        return *known;
    }
    let result = match arena.node(node) {
        Node::Constant(_) => Some(node),
        Node::Input(input) => is_kept(input).then_some(node),
        Node::Unary(function, x) => {
            substitute(arena, x, map, is_kept, done).map(|x| arena.unary(function, x))
        }
        Node::Binary(operator, a, b) => substitute(arena, a, map, is_kept, done)
            .zip(substitute(arena, b, map, is_kept, done))
            .map(|(a, b)| arena.binary(operator, a, b)),
    };
    done.insert(node, result);
    result
}

/// Returns true if no operation of a condition can raise an alarm; those up to the computed nodes have been executed.
///
/// A path that never computes a root says nothing of it, and not that its argument has one.
pub(super) fn has_values(
    arena: &Arena,
    enclosures: &mut Enclosures,
    condition: Condition,
    computed: HashSet<NodeId>,
) -> bool {
    let mut seen = computed;
    let mut pending = vec![condition.left, condition.right];
    while let Some(next) = pending.pop() {
        if !seen.insert(next) {
            continue;
        }
        match arena.node(next) {
            Node::Constant(_) | Node::Input(_) => continue,
            Node::Unary(_, x) => pending.push(x),
            Node::Binary(_, a, b) => pending.extend([a, b]),
        }
        if !enclosures.alarms(arena, next).is_empty() {
            return false;
        }
    }
    true
}

/// Iterates over the inputs of which a node is computed.
pub(super) fn inputs_of(arena: &Arena, node: NodeId) -> impl Iterator<Item = usize> {
    let mut seen = HashSet::new();
    let mut pending = vec![node];
    std::iter::from_fn(move || {
        while let Some(next) = pending.pop() {
            if !seen.insert(next) {
                continue;
            }
            match arena.node(next) {
                Node::Constant(_) => {}
                Node::Input(input) => return Some(input),
                Node::Unary(_, x) => pending.push(x),
                Node::Binary(_, a, b) => pending.extend([a, b]),
            }
        }
        None
    })
}
