//! The arena: every expression once, its operands before it.
use std::collections::HashMap;

use crate::factors::Factors;
use crate::identities::Identities;
use crate::interval::{Interval, add_up, mul_up, sub_down};
use crate::node::{AlarmKind, Binary, Condition, Node, NodeId, Relation, Semantics, Unary};
use crate::values;

/// Expressions that share their common parts.
///
/// A node is what a control computes in doubles, not a real number: `a + b` and `b + a` are one node, `[a + b] + c` and
/// `a + [b + c]` are two. An operation on constants becomes its value.
#[derive(Clone, Debug)]
pub struct Arena {
    nodes: Vec<Node>,
    index: HashMap<Key, NodeId>,
    factors: Vec<Factors>,
    /// By node, whether it has whole numbers only.
    whole: Vec<bool>,
    /// By node, the number of operands that it is.
    uses: Vec<u32>,
    semantics: Semantics,
    widening: f64,
    identities: Identities,
}

/// A node as a key: a number by its bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Key {
    Constant(u64),
    Input(usize),
    Unary(Unary, NodeId),
    Binary(Binary, NodeId, NodeId),
}

impl Arena {
    /// The constant 0 of every arena.
    pub const ZERO: NodeId = NodeId(0);
    /// The constant 1 of every arena.
    pub const ONE: NodeId = NodeId(1);
    /// The constant −1 of every arena.
    pub const MINUS_ONE: NodeId = NodeId(2);

    /// Returns an arena for a control with these settings.
    pub fn new(semantics: Semantics) -> Self {
        let mut arena = Self {
            nodes: Vec::new(),
            index: HashMap::new(),
            factors: Vec::new(),
            whole: Vec::new(),
            uses: Vec::new(),
            semantics,
            widening: 0.0,
            identities: Identities::default(),
        };
        arena.constant(0.0);
        arena.constant(1.0);
        arena.constant(-1.0);
        arena
    }

    /// Returns the arena of a control whose operations have results that may be off by this part of them, 0 to 0.001.
    ///
    /// Then no proof rests on how a double rounds. ABS, FIX, FUP, ROUND, comparisons and operators of whole numbers are
    /// exact, a difference has its sign, and the same operation on the same numbers has the same result.
    #[must_use]
    pub fn with_widening(self, widening: f64) -> Self {
        Self { widening: widening.clamp(0.0, 1e-3), ..self }
    }

    /// Returns the part of a result by which it may be off.
    pub fn widening(&self) -> f64 {
        self.widening
    }

    /// Returns the range of results of a node's operation that are off by no more than the widening.
    pub(crate) fn widened(&self, node: NodeId, range: Interval) -> Interval {
        if self.widening == 0.0 || range.is_empty() || !self.is_widened(node) {
            return range;
        }
        let by = |end: f64| mul_up(end.abs(), self.widening);
        Interval::new(sub_down(range.lo(), by(range.lo())), add_up(range.hi(), by(range.hi())))
    }

    /// Returns true for an operation whose result may be off by the widening.
    pub(crate) fn is_widened(&self, node: NodeId) -> bool {
        match self.node(node) {
            Node::Constant(_) | Node::Input(_) => false,
            Node::Unary(function, _) => matches!(
                function,
                Unary::Sqrt
                    | Unary::Sin
                    | Unary::Cos
                    | Unary::Tan
                    | Unary::Asin
                    | Unary::Acos
                    | Unary::Atan
                    | Unary::Exp
                    | Unary::Ln
            ),
            Node::Binary(operator, ..) => matches!(
                operator,
                Binary::Add | Binary::Sub | Binary::Mul | Binary::Div | Binary::Pow | Binary::Atan
            ),
        }
    }

    /// Returns the settings.
    pub fn semantics(&self) -> Semantics {
        self.semantics
    }

    /// Returns the number of nodes.
    #[expect(clippy::len_without_is_empty, reason = "an arena always has the constants 0 and 1")]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Returns the content of a node.
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes[id.index()]
    }

    /// Returns the number of a constant node.
    pub fn as_constant(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Constant(value) => Some(value),
            Node::Input(_) | Node::Unary(..) | Node::Binary(..) => None,
        }
    }

    /// Returns the input of the node at a place.
    pub(crate) fn as_input(&self, place: usize) -> Option<usize> {
        match self.nodes[place] {
            Node::Input(input) => Some(input),
            Node::Constant(_) | Node::Unary(..) | Node::Binary(..) => None,
        }
    }

    /// Returns the node of a finite number.
    pub fn constant(&mut self, value: f64) -> NodeId {
        // Zeros of either sign are one number.
        self.insert(Node::Constant(value + 0.0))
    }

    /// Returns the node of an input of the domain.
    pub fn input(&mut self, index: usize) -> NodeId {
        self.insert(Node::Input(index))
    }

    /// Returns the node of a function of one value.
    ///
    /// With [`Semantics::zeroes_residues`], that of SIN, COS and TAN includes the zeroing.
    pub fn unary(&mut self, function: Unary, x: NodeId) -> NodeId {
        let simpler = match (function, self.node(x)) {
            (_, Node::Constant(value)) => {
                let value = values::unary(function, value, self.semantics).ok();
                value.map(|value| self.constant(value))
            }
            (Unary::Neg, Node::Unary(Unary::Neg, inner)) => Some(inner),
            // A rounding doesn't depend on the sign.
            (Unary::Neg, Node::Binary(Binary::Sub, a, b)) if self.widening() == 0.0 => {
                Some(self.binary(Binary::Sub, b, a))
            }
            (Unary::Abs, Node::Unary(Unary::Neg, inner)) => Some(self.unary(Unary::Abs, inner)),
            (_, Node::Unary(Unary::Neg, inner)) => self.of_opposite(function, inner),
            (Unary::Abs, Node::Unary(Unary::Abs | Unary::Sqrt, _)) => Some(x),
            (Unary::Fix | Unary::Fup | Unary::Round, _) if self.is_whole(x) => Some(x),
            _ => None,
        };
        let value = simpler.unwrap_or_else(|| self.insert(Node::Unary(function, x)));
        match function {
            Unary::Sin | Unary::Cos | Unary::Tan if self.semantics.zeroes_residues => {
                self.unary(Unary::Residue, value)
            }
            _ => value,
        }
    }

    /// Returns the node of an operator or a function of two values.
    pub fn binary(&mut self, operator: Binary, a: NodeId, b: NodeId) -> NodeId {
        if let (Some(left), Some(right)) = (self.as_constant(a), self.as_constant(b))
            && let Ok(value) = values::binary(operator, left, right, self.semantics)
        {
            return self.constant(value);
        }
        if let Some(simpler) =
            self.by_whole_part(operator, a, b).or_else(|| self.of_opposites(operator, a, b))
        {
            return simpler;
        }
        match operator {
            Binary::Add if a == Self::ZERO => b,
            Binary::Add | Binary::Sub if b == Self::ZERO => a,
            Binary::Add if self.are_opposite(a, b) => Self::ZERO,
            Binary::Sub if a == b => Self::ZERO,
            Binary::Sub if a == Self::ZERO => self.unary(Unary::Neg, b),
            Binary::Mul if a == Self::ZERO || b == Self::ZERO => Self::ZERO,
            Binary::Mul if a == Self::ONE => b,
            Binary::Mul | Binary::Div if b == Self::ONE => a,
            Binary::Mul if self.as_constant(a) == Some(-1.0) && self.widening() == 0.0 => {
                self.unary(Unary::Neg, b)
            }
            Binary::Mul | Binary::Div if self.as_constant(b) == Some(-1.0) && self.widening() == 0.0 => {
                self.unary(Unary::Neg, a)
            }
            // Their value doesn't depend on the order.
            Binary::Add | Binary::Mul if b < a => self.insert(Node::Binary(operator, b, a)),
            Binary::Compare(relation) if b < a => {
                self.insert(Node::Binary(Binary::Compare(relation.swapped()), b, a))
            }
            _ => self.insert(Node::Binary(operator, a, b)),
        }
    }

    /// Returns true for a − b and b − a, which are rounded alike.
    fn are_opposite(&self, x: NodeId, y: NodeId) -> bool {
        match (self.node(x), self.node(y)) {
            (Node::Binary(Binary::Sub, a, b), Node::Binary(Binary::Sub, c, d)) => {
                (a, b) == (d, c) && self.widening() == 0.0
            }
            _ => false,
        }
    }

    /// Returns the node of a condition's value, 1 or 0.
    pub fn compare(&mut self, condition: Condition) -> NodeId {
        self.binary(Binary::Compare(condition.relation), condition.left, condition.right)
    }

    /// Returns the number of least increments to which the control rounds a value: `units::round_scaled`.
    ///
    /// `scale` is the number of increments in a unit, 1000 for IS-B in mm; the quotient by it is the rounded value.
    pub fn round_scaled(&mut self, value: NodeId, scale: f64) -> NodeId {
        let (scale, correction) = (self.constant(scale), self.constant(1.0 + 4.0 * f64::EPSILON));
        let product = self.binary(Binary::Mul, value, scale);
        let corrected = self.binary(Binary::Mul, product, correction);
        self.unary(Unary::Round, corrected)
    }

    /// Returns true for a node that has whole numbers only, whatever its inputs.
    pub fn is_whole(&self, id: NodeId) -> bool {
        self.whole[id.index()]
    }

    /// Returns true if a new node has whole numbers only.
    fn has_whole_values(&self, node: Node) -> bool {
        match node {
            Node::Constant(value) => value.trunc() == value,
            Node::Input(_) => false,
            Node::Unary(function, x) => match function {
                Unary::Fix | Unary::Fup | Unary::Round | Unary::Bin | Unary::Bcd => true,
                Unary::Neg | Unary::Abs => self.is_whole(x),
                _ => false,
            },
            Node::Binary(operator, a, b) => match operator {
                Binary::Mod | Binary::And | Binary::Or | Binary::Xor | Binary::Compare(_) => true,
                // Sums and products of whole numbers stay whole when they are rounded to a double.
                Binary::Add | Binary::Sub | Binary::Mul => self.is_whole(a) && self.is_whole(b),
                Binary::Div | Binary::Pow | Binary::Atan => false,
            },
        }
    }

    /// Returns the node of a function if the arena has it.
    pub(crate) fn find_unary(&self, function: Unary, x: NodeId) -> Option<NodeId> {
        self.index.get(&Key::Unary(function, x)).copied()
    }

    /// Returns the node of an operator if the arena has it.
    pub(crate) fn find_binary(&self, operator: Binary, a: NodeId, b: NodeId) -> Option<NodeId> {
        self.index.get(&Key::Binary(operator, a, b)).copied()
    }

    /// Returns the node of a number if the arena has it.
    pub(crate) fn find_constant(&self, value: f64) -> Option<NodeId> {
        self.index.get(&Key::Constant(value.to_bits())).copied()
    }

    /// Returns the sums that have been examined for identities.
    pub(crate) fn identities(&self) -> &Identities {
        &self.identities
    }

    /// Returns the node of the half of a node, if the arena has it.
    pub(crate) fn find_half(&self, x: NodeId) -> Option<NodeId> {
        let constant = |value: f64| self.index.get(&Key::Constant(value.to_bits())).copied();
        let quotient = constant(2.0).and_then(|two| self.find_binary(Binary::Div, x, two));
        let product =
            || constant(0.5).and_then(|half| self.find_binary(Binary::Mul, x.min(half), x.max(half)));
        quotient.or_else(product)
    }

    /// Returns the node of the double of a node, if the arena has it.
    pub(crate) fn find_double(&self, x: NodeId) -> Option<NodeId> {
        let two = self.find_constant(2.0)?;
        self.find_binary(Binary::Mul, x.min(two), x.max(two)).or_else(|| self.find_binary(Binary::Add, x, x))
    }

    /// Returns z of [z + ABS[z]]/2, which is the larger of z and 0 without a rounding.
    pub(crate) fn positive_part(&self, id: NodeId) -> Option<NodeId> {
        let Node::Binary(operator, sum, factor) = self.node(id) else { return None };
        let (sum, factor) = if self.as_constant(sum).is_some() { (factor, sum) } else { (sum, factor) };
        let halves = match operator {
            Binary::Div => self.as_constant(factor) == Some(2.0),
            Binary::Mul => self.as_constant(factor) == Some(0.5),
            _ => false,
        };
        if halves { self.doubled_positive_part(sum) } else { None }
    }

    /// Returns z of z + ABS[z].
    pub(crate) fn doubled_positive_part(&self, id: NodeId) -> Option<NodeId> {
        let Node::Binary(Binary::Add, a, b) = self.node(id) else { return None };
        let is_abs = |x: NodeId, of: NodeId| self.node(x) == Node::Unary(Unary::Abs, of);
        if is_abs(b, a) {
            Some(a)
        } else if is_abs(a, b) {
            Some(b)
        } else {
            None
        }
    }

    /// Returns the node of a value's square if the arena has it.
    pub(crate) fn find_square(&self, x: NodeId) -> Option<NodeId> {
        self.index.get(&Key::Binary(Binary::Mul, x, x)).copied()
    }

    /// Computes a node at a point, the doubles of its inputs; the alarm of the first operation that has one.
    pub fn evaluate(&self, node: NodeId, point: &[f64]) -> Result<f64, AlarmKind> {
        let mut values = vec![f64::NAN; node.index() + 1];
        for id in self.cone(&[node]) {
            values[id.index()] = match self.node(id) {
                Node::Constant(value) => value,
                Node::Input(input) => point[input],
                Node::Unary(function, x) => values::unary(function, values[x.index()], self.semantics)?,
                Node::Binary(operator, a, b) => {
                    values::binary(operator, values[a.index()], values[b.index()], self.semantics)?
                }
            };
        }
        Ok(values[node.index()])
    }

    /// Returns true if a condition holds at a point; the alarm of an operation that it needs.
    pub fn holds(&self, condition: Condition, point: &[f64]) -> Result<bool, AlarmKind> {
        let left = self.evaluate(condition.left, point)?;
        Ok(condition.relation.holds(left, self.evaluate(condition.right, point)?))
    }

    /// Returns the nodes that the given ones are computed of, with them, operands first.
    pub(crate) fn cone(&self, roots: &[NodeId]) -> Vec<NodeId> {
        let last = roots.iter().map(|id| id.index()).max();
        let mut is_needed = vec![false; last.map_or(0, |last| last + 1)];
        for root in roots {
            is_needed[root.index()] = true;
        }
        for index in (0..is_needed.len()).rev() {
            if is_needed[index] {
                for operand in self.operands(NodeId(index as u32)) {
                    is_needed[operand.index()] = true;
                }
            }
        }
        let nodes = is_needed.iter().enumerate().filter(|(_, is_needed)| **is_needed);
        nodes.map(|(index, _)| NodeId(index as u32)).collect()
    }

    /// Returns the operands of a node.
    pub(crate) fn operands(&self, id: NodeId) -> impl Iterator<Item = NodeId> {
        let (first, second) = match self.node(id) {
            Node::Constant(_) | Node::Input(_) => (None, None),
            Node::Unary(_, x) => (Some(x), None),
            Node::Binary(_, a, b) => (Some(a), Some(b)),
        };
        first.into_iter().chain(second)
    }

    fn insert(&mut self, node: Node) -> NodeId {
        let key = match node {
            Node::Constant(value) => Key::Constant(value.to_bits()),
            Node::Input(input) => Key::Input(input),
            Node::Unary(function, x) => Key::Unary(function, x),
            Node::Binary(operator, a, b) => Key::Binary(operator, a, b),
        };
        if let Some(&known) = self.index.get(&key) {
            return known;
        }
        let id = NodeId(self.nodes.len() as u32);
        self.factors.push(Factors::of(id, node, &self.factors));
        self.whole.push(self.has_whole_values(node));
        self.uses.push(0);
        self.nodes.push(node);
        self.index.insert(key, id);
        let operands: Vec<_> = self.operands(id).collect();
        operands.into_iter().for_each(|operand| self.uses[operand.index()] += 1);
        id
    }

    /// Returns true for a node that other nodes have more than once for an operand.
    pub(crate) fn is_used_again(&self, id: NodeId) -> bool {
        self.uses[id.index()] > 1
    }

    /// Returns the factors of a node.
    pub(crate) fn factors(&self, id: NodeId) -> &Factors {
        &self.factors[id.index()]
    }
}

impl Default for Arena {
    fn default() -> Self {
        Self::new(Semantics::default())
    }
}

impl Arena {
    /// Returns the conditions under which an operation raises an alarm of this kind: any of them suffices.
    ///
    /// Without one, no comparison of the operands says it.
    pub fn alarm_conditions(&self, id: NodeId, kind: AlarmKind) -> Vec<Condition> {
        match (self.node(id), kind) {
            (Node::Unary(Unary::Sqrt, x), AlarmKind::OutOfRange) => {
                vec![Condition::new(Relation::Lt, x, Self::ZERO)]
            }
            (Node::Unary(Unary::Ln, x), AlarmKind::OutOfRange) => {
                vec![Condition::new(Relation::Le, x, Self::ZERO)]
            }
            (Node::Unary(Unary::Asin | Unary::Acos, x), AlarmKind::OutOfRange) => vec![
                Condition::new(Relation::Lt, x, Self::MINUS_ONE),
                Condition::new(Relation::Gt, x, Self::ONE),
            ],
            (Node::Binary(Binary::Div, _, b), AlarmKind::DivideByZero) => {
                vec![Condition::new(Relation::Eq, b, Self::ZERO)]
            }
            (Node::Binary(Binary::Pow, a, _), AlarmKind::OutOfRange) => {
                vec![Condition::new(Relation::Lt, a, Self::ZERO)]
            }
            _ => Vec::new(),
        }
    }
}
