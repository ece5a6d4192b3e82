//! Conditions of a path: what they take from the ranges of nodes.
use crate::arena::Arena;
use crate::domain::Domain;
use crate::enclosures::Enclosures;
use crate::hull;
use crate::interval::{Interval, add_up, sub_down};
use crate::node::{Binary, Condition, Node, NodeId, Relation, Unary};

impl Enclosures {
    /// Assumes a condition from here on; false if no point of the box keeps it.
    ///
    /// The ranges of both sides shrink, those of their operands, and those of all nodes computed of these.
    pub fn assume(&mut self, arena: &Arena, condition: Condition) -> bool {
        if self.decide(arena, condition) == Some(false) {
            return false;
        }
        self.conditions.push(condition);
        let Condition { relation, left, right } = condition;
        let (a, b) = contract(relation, self.hull(left), self.hull(right));
        let mut changed = vec![false; self.forms.len()];
        self.narrow(arena, left, a, &mut changed);
        self.narrow(arena, right, b, &mut changed);
        self.propagate(arena, &mut changed);
        !self.hull(left).is_empty() && !self.hull(right).is_empty()
    }

    /// Returns the box without the values of its inputs that the conditions of the path exclude.
    ///
    /// `None` if they exclude all.
    pub fn contracted_domain(&mut self, arena: &Arena) -> Option<Domain> {
        let mut ranges = self.domain().ranges().to_vec();
        for (index, form) in self.forms.iter().enumerate() {
            if let (Some(form), Some(input)) = (form, arena.as_input(index)) {
                ranges[input] = ranges[input].intersect(form.hull);
            }
        }
        let is_empty = ranges.iter().any(|range| range.is_empty());
        (!is_empty).then(|| Domain::new(ranges))
    }

    /// Takes values from the range of a node, and from its operands what leads to no others.
    fn narrow(&mut self, arena: &Arena, node: NodeId, range: Interval, changed: &mut [bool]) {
        let mut pending = vec![(node, range)];
        while let Some((node, range)) = pending.pop() {
            let Some(Some(form)) = self.forms.get(node.index()) else { continue };
            let narrower = form.hull.intersect(range);
            if narrower == form.hull {
                continue;
            }
            let narrower = match arena.node(node) {
                Node::Binary(Binary::Atan, y, x) if arena.widening() == 0.0 => {
                    hull::angles_within(self.hull(y), self.hull(x), narrower, arena.semantics())
                }
                _ if arena.is_whole(node) && arena.widened(node, narrower) == narrower => {
                    whole_part(narrower)
                }
                _ => narrower,
            };
            self.set_hull(node, narrower);
            changed[node.index()] = true;
            if narrower.is_empty() {
                continue;
            }
            // The result without what it may be off, twice as far as the widening: 1/(1 − w) < 1 + 2·w.
            let narrower = arena.widened(node, arena.widened(node, narrower));
            match arena.node(node) {
                Node::Constant(_) | Node::Input(_) => {}
                Node::Unary(function, x) => {
                    pending.extend(unary_operand(function, narrower).map(|range| (x, range)));
                }
                Node::Binary(operator, a, b) => {
                    let ranges = binary_operands(operator, self.hull(a), self.hull(b), narrower);
                    pending.extend(ranges.into_iter().flat_map(|[of_a, of_b]| [(a, of_a), (b, of_b)]));
                }
            }
        }
    }

    /// Computes the ranges of all nodes again whose operands have changed.
    fn propagate(&mut self, arena: &Arena, changed: &mut [bool]) {
        let semantics = arena.semantics();
        for index in 0..changed.len() {
            let id = NodeId(index as u32);
            let Some(form) = &self.forms[index] else { continue };
            if !arena.operands(id).any(|operand| changed[operand.index()]) {
                continue;
            }
            let range = match arena.node(id) {
                Node::Constant(_) | Node::Input(_) => continue,
                Node::Unary(function, x) => hull::unary(function, self.hull(x), semantics),
                Node::Binary(Binary::Div, a, b) if self.hull(b).contains(0.0) => {
                    self.quotient_hull(arena, a, b)
                }
                Node::Binary(Binary::Atan, a, b) if arena.widening() == 0.0 => {
                    hull::angles_within(self.hull(a), self.hull(b), form.hull, semantics)
                }
                Node::Binary(operator, a, b) => hull::binary(operator, self.hull(a), self.hull(b), semantics),
            };
            let narrower = form.hull.intersect(arena.widened(id, range));
            if narrower != form.hull {
                self.set_hull(id, narrower);
                changed[index] = true;
            }
        }
    }
}

/// Returns the range of the whole numbers in a range.
fn whole_part(range: Interval) -> Interval {
    let (first, last) = (range.lo().ceil(), range.hi().floor());
    if first <= last { Interval::new(first, last) } else { Interval::EMPTY }
}

/// Returns a range of real numbers that round to doubles of a range.
fn unrounded(range: Interval) -> Interval {
    let margin = |end: f64| add_up(end.abs() * f64::EPSILON, f64::from_bits(1));
    Interval::new(sub_down(range.lo(), margin(range.lo())), add_up(range.hi(), margin(range.hi())))
}

/// Returns the operands of a function whose values lie in a range; `None` if that says nothing.
fn unary_operand(function: Unary, result: Interval) -> Option<Interval> {
    match function {
        Unary::Neg => Some(Interval::new(-result.hi(), -result.lo())),
        Unary::Abs => Some(Interval::new(-result.hi(), result.hi())),
        Unary::Sqrt if result.hi() < 1e100 => {
            let roots = unrounded(result).intersect(Interval::new(0.0, f64::MAX));
            Some(unrounded(Interval::new(roots.lo() * roots.lo(), roots.hi() * roots.hi())))
        }
        // A rounding moves by 1 at most, and by less than a unit in the last place of a number without a fraction.
        Unary::Fix | Unary::Fup | Unary::Round => Some(unrounded(result.widened(1.0))),
        _ => None,
    }
}

/// Returns the operands of an operator whose values lie in a range; `None` if that says nothing.
fn binary_operands(operator: Binary, a: Interval, b: Interval, result: Interval) -> Option<[Interval; 2]> {
    // Real numbers beyond the largest double round to it.
    if result.magnitude() > 1e300 {
        return None;
    }
    let wide = unrounded(result);
    let sum = |x: Interval, y: Interval| Interval::new(sub_down(x.lo(), -y.lo()), add_up(x.hi(), y.hi()));
    let minus = |x: Interval| Interval::new(-x.hi(), -x.lo());
    match operator {
        Binary::Add => Some([sum(wide, minus(b)), sum(wide, minus(a))]),
        Binary::Sub => Some([sum(wide, b), sum(a, minus(wide))]),
        Binary::Mul => {
            // A factor is the quotient of the product by the other, if that isn't 0.
            let quotient = |by: Interval| match by.contains(0.0) || by.mignitude() < 1e-100 {
                true => Interval::ALL,
                false => unrounded(hull::binary(Binary::Div, wide, by, Default::default())),
            };
            Some([quotient(b), quotient(a)])
        }
        _ => None,
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
