//! Decisions over a box on one path: which alarms are possible, and on which side a condition is.
use crate::alarms::{self, PossibleAlarm};
use crate::arena::Arena;
use crate::divided_models::MAX_FACTORS;
use crate::enclosures::Enclosures;
use crate::hull;
use crate::interval::{Interval, sub_down, sub_up};
use crate::model::Model;
use crate::node::{AlarmKind, Binary, Condition, Node, NodeId, Relation, Unary};
use crate::proof::Prover;

/// Largest number of magnitudes whose signs are told apart for one condition.
const MAX_SIGNS: usize = 3;

/// Largest number of nodes among which magnitudes are looked for.
const MAX_SEARCHED: usize = 200;

impl Enclosures {
    /// Returns the alarms that the node's own operation can raise where its operands have values.
    pub fn alarms(&mut self, arena: &Arena, node: NodeId) -> Vec<PossibleAlarm> {
        self.enclose(arena, node);
        let semantics = arena.semantics();
        let mut possible = match arena.node(node) {
            Node::Constant(_) | Node::Input(_) => return Vec::new(),
            Node::Unary(function, x) if self.hull(x).is_empty() => {
                let _ = function;
                return Vec::new();
            }
            Node::Binary(_, a, b) if self.hull(a).is_empty() || self.hull(b).is_empty() => {
                return Vec::new();
            }
            Node::Unary(function, x) => alarms::unary(function, self.hull(x), semantics),
            Node::Binary(operator, a, b) => {
                let mut possible = alarms::binary(operator, self.hull(a), self.hull(b), semantics);
                if operator == Binary::Div && self.hull(b).contains(0.0) {
                    let least = self.least_magnitude(arena, b);
                    let overflows = !(self.hull(a).magnitude() / least.max(f64::from_bits(1))).is_finite();
                    possible.retain(|alarm| alarm.kind != AlarmKind::Overflow || overflows);
                }
                possible
            }
        };
        if arena.widening() > 0.0 && arena.is_widened(node) {
            self.add_overflow(arena, node, &mut possible);
        }
        possible.retain_mut(|alarm| {
            let conditions = arena.alarm_conditions(node, alarm.kind);
            let decided: Vec<_> = conditions.iter().map(|condition| self.decide(arena, *condition)).collect();
            alarm.is_certain |= decided.contains(&Some(true));
            decided.is_empty() || decided.iter().any(|decision| *decision != Some(false))
        });
        possible
    }

    /// Adds the overflow that a result off by the widening can have; none is certain.
    fn add_overflow(&self, arena: &Arena, node: NodeId, possible: &mut Vec<PossibleAlarm>) {
        let kind = match arena.node(node) {
            Node::Binary(..) => AlarmKind::Overflow,
            _ => AlarmKind::OutOfRange,
        };
        if self.hull(node).magnitude() > 1e300 {
            possible.retain(|alarm| alarm.kind != kind);
            possible.push(PossibleAlarm { kind, is_certain: false });
        }
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
            .or_else(|| {
                let hulls = |node: NodeId| match self.forms.get(node.index()) {
                    Some(Some(form)) => form.hull,
                    _ => Interval::ALL,
                };
                Prover::new(arena, &hulls, &self.conditions).decide(relation, left, right)
            })
            .or_else(|| self.decide_difference(arena, relation, left, right))
            .or_else(|| self.decide_quotient(arena, relation, left, right))
            .or_else(|| self.decide_quotient(arena, relation.swapped(), right, left))
            .or_else(|| self.decide_product(arena, relation, left, right))
            .or_else(|| self.decide_product(arena, relation.swapped(), right, left))
            .or_else(|| self.decide_by_certificate(arena, relation, left, right))
    }

    /// Decides a condition like [`Enclosures::decide`]; where a magnitude's argument has both signs, for each of them.
    pub fn decide_by_signs(&mut self, arena: &Arena, condition: Condition) -> Option<bool> {
        self.decide_with(arena, condition, MAX_SIGNS)
    }

    fn decide_with(&mut self, arena: &Arena, condition: Condition, signs: usize) -> Option<bool> {
        let decided = self.decide(arena, condition);
        if decided.is_some() || signs == 0 {
            return decided;
        }
        let argument = self.argument_of_both_signs(arena, [condition.left, condition.right])?;
        let of_sign = |relation: Relation| {
            let mut enclosures = self.clone();
            let sign = Condition { relation, left: argument, right: Arena::ZERO };
            // A sign that no point has decides nothing.
            let is_possible = enclosures.assume(arena, sign);
            is_possible.then(|| {
                enclosures.forget_magnitude(arena, argument);
                enclosures.decide_with(arena, condition, signs - 1)
            })
        };
        match (of_sign(Relation::Ge), of_sign(Relation::Lt)) {
            (Some(one), Some(other)) => one.filter(|_| one == other),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => None,
        }
    }

    /// Forgets the forms of a magnitude and of all that is computed of it, so that the sign of its argument counts.
    fn forget_magnitude(&mut self, arena: &Arena, argument: NodeId) {
        let Some(magnitude) = arena.find_unary(Unary::Abs, argument) else { return };
        let mut is_forgotten = vec![false; self.forms.len()];
        for (index, form) in self.forms.iter_mut().enumerate().skip(magnitude.index()) {
            let node = NodeId(index as u32);
            if node == magnitude || arena.operands(node).any(|operand| is_forgotten[operand.index()]) {
                is_forgotten[index] = true;
                *form = None;
            }
        }
    }

    /// Returns the argument of a magnitude in nodes that is below 0 somewhere in the box, and above elsewhere.
    fn argument_of_both_signs(&self, arena: &Arena, nodes: [NodeId; 2]) -> Option<NodeId> {
        let mut pending = nodes.to_vec();
        let mut seen = std::collections::HashSet::new();
        while let Some(node) = pending.pop() {
            if !seen.insert(node) || seen.len() > MAX_SEARCHED {
                continue;
            }
            if let Node::Unary(Unary::Abs, argument) = arena.node(node) {
                let hull = self.hull(argument);
                if hull.lo() < 0.0 && hull.hi() > 0.0 {
                    return Some(argument);
                }
            }
            pending.extend(arena.operands(node));
        }
        None
    }

    /// Decides by the polynomial of the difference, in which common parts cancel.
    fn decide_difference(
        &mut self,
        arena: &Arena,
        relation: Relation,
        left: NodeId,
        right: NodeId,
    ) -> Option<bool> {
        self.enclose_facts(arena);
        let difference = self.difference(arena, left, right)?;
        let zero = Interval::point(0.0);
        let range = difference.range(&self.basis);
        hull::decide(relation, range, zero)
            .or_else(|| hull::decide(relation, self.range_by_facts(arena, &difference, range)?, zero))
    }

    /// Returns the range of a model under the conditions of the path, from that without them; `None` without conditions.
    fn range_by_facts(&mut self, arena: &Arena, model: &Model, range: Interval) -> Option<Interval> {
        let facts = self.facts(arena);
        if facts.is_empty() {
            return None;
        }
        let lo = self.lower_bound(model, range.lo(), &facts, MAX_FACTORS);
        let hi = -self.lower_bound(&model.neg(), -range.hi(), &facts, MAX_FACTORS);
        Some(Interval::new(lo, hi))
    }

    /// Returns a range of the real difference between two nodes.
    pub fn difference_range(&mut self, arena: &Arena, left: NodeId, right: NodeId) -> Interval {
        let (a, b) = (self.enclose(arena, left), self.enclose(arena, right));
        if a.is_empty() || b.is_empty() {
            return Interval::EMPTY;
        }
        let by_hulls = match (a.as_point(), b.as_point()) {
            (Some(x), Some(y)) if is_exact_difference(x, y) => Interval::point(x - y),
            _ => Interval::new(sub_down(a.lo(), b.hi()), sub_up(a.hi(), b.lo())),
        };
        self.enclose_facts(arena);
        let Some(difference) = self.difference(arena, left, right) else { return by_hulls };
        let range = difference.range(&self.basis).intersect(by_hulls);
        self.range_by_facts(arena, &difference, range).map_or(range, |closer| range.intersect(closer))
    }

    /// Decides whether a/b stands in a relation to another value by the sign of a less the value × b.
    ///
    /// The value is a double: a quotient that isn't above it doesn't round to one above it.
    fn decide_quotient(
        &mut self,
        arena: &Arena,
        relation: Relation,
        quotient: NodeId,
        value: NodeId,
    ) -> Option<bool> {
        let Node::Binary(Binary::Div, a, b) = arena.node(quotient) else { return None };
        if self.basis.degree() == 0 || arena.widening() > 0.0 {
            return None;
        }
        let divisor = self.hull(b);
        let sign = match (divisor.lo() > 0.0, divisor.hi() < 0.0) {
            (true, _) => 1.0,
            (_, true) => -1.0,
            _ => return None,
        };
        let [a, b, value] = [a, b, value].map(|node| self.forms[node.index()].clone()?.as_model());
        let product = value?.mul(&b?, &mut self.basis);
        let rest = a?.sub(&product).scale(sign);
        if !rest.is_finite() {
            return None;
        }
        let range = rest.range(&self.basis);
        match relation {
            Relation::Le if range.hi() <= 0.0 => Some(true),
            Relation::Gt if range.hi() <= 0.0 => Some(false),
            Relation::Ge if range.lo() >= 0.0 => Some(true),
            Relation::Lt if range.lo() >= 0.0 => Some(false),
            _ => None,
        }
    }

    /// Returns the model of a real difference between two nodes.
    fn difference(&mut self, arena: &Arena, left: NodeId, right: NodeId) -> Option<Model> {
        self.enclose(arena, left);
        self.enclose(arena, right);
        let [Some(left), Some(right)] = [left, right].map(|node| self.forms[node.index()].clone()) else {
            return None;
        };
        if left.model.is_none() && right.model.is_none() {
            return None;
        }
        Some(left.as_model()?.sub(&right.as_model()?)).filter(Model::is_finite)
    }

    /// Returns the conditions assumed last.
    fn last_conditions(&self) -> Vec<Condition> {
        const MOST: usize = 8;
        self.conditions.iter().rev().take(MOST).copied().collect()
    }

    /// Encloses the sides of the conditions assumed last: what is enclosed later may take variables back, which no model
    /// that is in use may have.
    fn enclose_facts(&mut self, arena: &Arena) {
        for Condition { left, right, .. } in self.last_conditions() {
            self.enclose(arena, left);
            self.enclose(arena, right);
        }
    }

    /// Returns models that are 0 or more on this path: the differences of the conditions assumed last.
    fn facts(&mut self, arena: &Arena) -> Vec<Model> {
        let conditions = self.last_conditions();
        let mut facts = Vec::new();
        for Condition { relation, left, right } in conditions {
            let Some(difference) = self.difference(arena, left, right) else { continue };
            match relation {
                Relation::Ge | Relation::Gt => {
                    facts.push(difference);
                    facts.extend(self.facts_of_magnitude(arena, left, right));
                }
                Relation::Le | Relation::Lt => {
                    facts.push(difference.neg());
                    facts.extend(self.facts_of_magnitude(arena, right, left));
                }
                Relation::Eq => facts.extend([difference.neg(), difference]),
                Relation::Ne => {}
            }
        }
        facts
    }
}

/// Returns true if a difference of two numbers isn't rounded.
fn is_exact_difference(x: f64, y: f64) -> bool {
    let difference = x - y;
    // The error of a sum of two doubles is a double (Knuth, The Art of Computer Programming, 4.2.2).
    let back = x - difference;
    difference.is_finite() && (x - (difference + back)) + (back - y) == 0.0
}
