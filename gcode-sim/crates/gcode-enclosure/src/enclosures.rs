//! The enclosures of nodes over one box, on one path through a program.
use crate::alarms::{self, PossibleAlarm};
use crate::arena::Arena;
use crate::domain::Domain;
use crate::hull;
use crate::interval::Interval;
use crate::node::{Condition, Node, NodeId, Relation};

/// Enclosures of nodes over a box, given the conditions of a path.
///
/// An enclosure has every double that the interpreter can compute at a point of the box that keeps the conditions and at
/// which no operation of the node raises an alarm. A clone is the same place with a future of its own: where a condition
/// isn't decided, each clone assumes one side.
#[derive(Clone, Debug)]
pub struct Enclosures {
    domain: Domain,
    conditions: Vec<Condition>,
    hulls: Vec<Option<Interval>>,
}

impl Enclosures {
    /// Returns the enclosures over a box.
    pub fn new(domain: Domain) -> Self {
        Self { domain, conditions: Vec::new(), hulls: Vec::new() }
    }

    /// Returns the box.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns the conditions assumed so far.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// Returns a range that has every double the node can have; empty if it never has a value.
    pub fn enclose(&mut self, arena: &Arena, node: NodeId) -> Interval {
        if let Some(Some(known)) = self.hulls.get(node.index()) {
            return *known;
        }
        if self.hulls.len() < arena.len() {
            self.hulls.resize(arena.len(), None);
        }
        let mut pending = vec![node];
        while let Some(&next) = pending.last() {
            let missing = arena.operands(next).filter(|operand| self.hulls[operand.index()].is_none());
            let before = pending.len();
            pending.extend(missing.collect::<Vec<_>>());
            if pending.len() == before {
                pending.pop();
                if self.hulls[next.index()].is_none() {
                    self.hulls[next.index()] = Some(self.compute(arena, next));
                }
            }
        }
        self.known(node)
    }

    /// Returns the hull of a node that has been computed.
    fn known(&self, node: NodeId) -> Interval {
        self.hulls[node.index()].unwrap_or(Interval::ALL)
    }

    fn compute(&self, arena: &Arena, node: NodeId) -> Interval {
        match arena.node(node) {
            Node::Constant(value) => Interval::point(value),
            Node::Input(input) => self.domain.range(input),
            Node::Unary(function, x) => hull::unary(function, self.known(x), arena.semantics()),
            Node::Binary(operator, a, b) => {
                hull::binary(operator, self.known(a), self.known(b), arena.semantics())
            }
        }
    }

    /// Returns the alarms that the node's own operation can raise where its operands have values.
    pub fn alarms(&mut self, arena: &Arena, node: NodeId) -> Vec<PossibleAlarm> {
        self.enclose(arena, node);
        let semantics = arena.semantics();
        let mut possible = match arena.node(node) {
            Node::Constant(_) | Node::Input(_) => return Vec::new(),
            Node::Unary(function, x) if self.known(x).is_empty() => {
                let _ = function;
                return Vec::new();
            }
            Node::Binary(_, a, b) if self.known(a).is_empty() || self.known(b).is_empty() => {
                return Vec::new();
            }
            Node::Unary(function, x) => alarms::unary(function, self.known(x), semantics),
            Node::Binary(operator, a, b) => alarms::binary(operator, self.known(a), self.known(b), semantics),
        };
        possible.retain_mut(|alarm| {
            let conditions = arena.alarm_conditions(node, alarm.kind);
            let decided: Vec<_> = conditions.iter().map(|condition| self.decide(arena, *condition)).collect();
            alarm.is_certain |= decided.contains(&Some(true));
            decided.is_empty() || decided.iter().any(|decision| *decision != Some(false))
        });
        possible
    }

    /// Decides a condition for every point of the box on this path; `None` if it isn't decided.
    ///
    /// At points where a side raises an alarm it says nothing.
    pub fn decide(&mut self, arena: &Arena, condition: Condition) -> Option<bool> {
        let Condition { relation, left, right } = condition;
        let (a, b) = (self.enclose(arena, left), self.enclose(arena, right));
        if left == right {
            return Some(matches!(relation, Relation::Eq | Relation::Ge | Relation::Le));
        }
        hull::decide(relation, a, b)
    }

    /// Assumes a condition from here on; false if no point of the box keeps it.
    pub fn assume(&mut self, arena: &Arena, condition: Condition) -> bool {
        if self.decide(arena, condition) == Some(false) {
            return false;
        }
        self.conditions.push(condition);
        let Condition { relation, left, right } = condition;
        let (a, b) = (self.known(left), self.known(right));
        let (a, b) = contract(relation, a, b);
        self.hulls[left.index()] = Some(a);
        self.hulls[right.index()] = Some(b);
        !a.is_empty() && !b.is_empty()
    }
}

/// Returns the parts of two ranges in which a relation between them can hold.
fn contract(relation: Relation, a: Interval, b: Interval) -> (Interval, Interval) {
    let at_least = |x: Interval, end: f64| x.intersect(Interval::new(end, f64::MAX));
    let at_most = |x: Interval, end: f64| x.intersect(Interval::new(-f64::MAX, end));
    match relation {
        Relation::Eq => (a.intersect(b), a.intersect(b)),
        Relation::Ne => (without(a, b), without(b, a)),
        Relation::Ge => (at_least(a, b.lo()), at_most(b, a.hi())),
        Relation::Gt => (at_least(a, b.lo().next_up()), at_most(b, a.hi().next_down())),
        Relation::Le | Relation::Lt => {
            let (b, a) = contract(relation.swapped(), b, a);
            (a, b)
        }
    }
}

/// Returns a range without the end that is another range's only number.
fn without(x: Interval, other: Interval) -> Interval {
    match other.as_point() {
        Some(end) if end == x.lo() => Interval::new(end.next_up(), x.hi()),
        Some(end) if end == x.hi() => Interval::new(x.lo(), end.next_down()),
        _ => x,
    }
}
