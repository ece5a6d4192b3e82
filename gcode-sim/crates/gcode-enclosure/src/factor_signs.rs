//! Signs of products by those of their factors, and magnitudes in the conditions of a path.
use crate::arena::Arena;
use crate::enclosures::Enclosures;
use crate::model::Model;
use crate::node::{Binary, Condition, Node, NodeId, Relation, Unary};

/// Largest number of factors of factors.
const MAX_DEPTH: u32 = 8;

impl Enclosures {
    /// Decides whether a product or a quotient is 0 or more, or 0 or less, by the signs of its factors.
    pub(crate) fn decide_product(
        &mut self,
        arena: &Arena,
        relation: Relation,
        product: NodeId,
        value: NodeId,
    ) -> Option<bool> {
        let is_product = matches!(arena.node(product), Node::Binary(Binary::Mul | Binary::Div, ..));
        if !is_product || value != Arena::ZERO || matches!(relation, Relation::Eq | Relation::Ne) {
            return None;
        }
        // One that underflows is 0.
        match (relation, self.is_positive(arena, product, MAX_DEPTH)?) {
            (Relation::Ge, true) | (Relation::Le, false) => Some(true),
            (Relation::Lt, true) | (Relation::Gt, false) => Some(false),
            _ => None,
        }
    }

    /// Returns true for a value of 0 or more, false for one of 0 or less.
    fn is_positive(&mut self, arena: &Arena, node: NodeId, depth: u32) -> Option<bool> {
        let range = self.enclose(arena, node);
        if range.lo() >= 0.0 || range.hi() <= 0.0 {
            return Some(range.lo() >= 0.0);
        }
        let depth = depth.checked_sub(1)?;
        let (left, right) = match arena.node(node) {
            Node::Binary(Binary::Mul | Binary::Div, a, b) if a == b => return Some(true),
            Node::Binary(Binary::Mul | Binary::Div, a, b) => {
                return Some(self.is_positive(arena, a, depth)? == self.is_positive(arena, b, depth)?);
            }
            // A difference of doubles has the sign of the real one, and where results are off too.
            Node::Binary(Binary::Sub, a, b) => (a, b),
            _ => (node, Arena::ZERO),
        };
        let mut is_true = |relation| self.decide(arena, Condition::new(relation, left, right)) == Some(true);
        if is_true(Relation::Ge) {
            return Some(true);
        }
        is_true(Relation::Le).then_some(false)
    }

    /// Returns models that are 0 or more where a value is at least |y|, or |y| + c: it is at least y and −y, + c, too.
    pub(crate) fn facts_of_magnitude(&self, arena: &Arena, greater: NodeId, less: NodeId) -> Vec<Model> {
        let magnitude = |node: NodeId| match arena.node(node) {
            Node::Unary(Unary::Abs, y) => Some(y),
            _ => None,
        };
        let (y, c) = match arena.node(less) {
            Node::Unary(Unary::Abs, y) => (y, None),
            Node::Binary(Binary::Add, a, b) => match (magnitude(a), magnitude(b)) {
                (Some(y), _) => (y, Some(b)),
                (None, Some(y)) => (y, Some(a)),
                (None, None) => return Vec::new(),
            },
            _ => return Vec::new(),
        };
        if arena.widening() > 0.0 {
            return Vec::new();
        }
        let model = |node: NodeId| self.forms.get(node.index())?.clone()?.as_model();
        let (Some(mut rest), Some(y)) = (model(greater), model(y)) else { return Vec::new() };
        if let Some(c) = c {
            let Some(c) = model(c) else { return Vec::new() };
            rest = rest.sub(&c);
            // The sum of both is rounded.
            rest.widen(self.hull(less).magnitude() * f64::EPSILON);
        }
        [rest.sub(&y), rest.add(&y)].into_iter().filter(Model::is_finite).collect()
    }
}
