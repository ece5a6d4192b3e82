//! Single points through the tree: the way of a point and its values, computed from nodes.
use std::rc::Rc;

use gcode_enclosure::{Arena, Node, NodeId};
use gcode_lang::program::Library;
use gcode_lang::syntax::ast::BinaryOp;

use crate::leaf::{BoundState, ClaimState, Leaf, NodeFormula};
use crate::region::ClaimSet;
use crate::tree::{Asked, Step, Tree};
use crate::watch::Watch;

/// Values of nodes at a point, each computed once.
#[derive(Debug, Default)]
pub(crate) struct Points {
    values: Vec<f64>,
    stamps: Vec<u32>,
    stamp: u32,
    pending: Vec<NodeId>,
}

/// Way of a point.
pub(crate) struct PointWay {
    pub(crate) leaf: Rc<Leaf>,
    /// Claims that fail at the point.
    pub(crate) failed: ClaimSet,
    /// Claims that the tree doesn't decide, because something isn't followed.
    pub(crate) unfollowed: ClaimSet,
}

impl Points {
    /// Follows a point to the end of its way; `each` is called with the margin of every comparison, its left side less its
    /// right, and the segment that asks it. `None` if the work is to stop.
    pub(crate) fn follow<L: Library>(
        &mut self,
        tree: &mut Tree<L>,
        point: &[f64],
        watch: &Watch,
        mut each: impl FnMut(usize, f64),
    ) -> Option<PointWay> {
        self.begin();
        let mut id = 0;
        let leaf = loop {
            match tree.step(id, watch) {
                Step::Leaf(leaf) => break leaf,
                Step::Stopped => return None,
                Step::Fork(fork) => {
                    let arena = tree.nodes.arena();
                    let answer = match fork.asked {
                        Asked::Condition(condition) => {
                            let left = self.value(arena, condition.left, point);
                            let right = self.value(arena, condition.right, point);
                            each(id, left - right);
                            condition.relation.holds(left, right)
                        }
                        Asked::Finite(node) => self.value(arena, node, point).is_finite(),
                    };
                    id = if answer { fork.yes } else { fork.no };
                }
            }
        };
        let arena = tree.nodes.arena();
        let (mut failed, mut unfollowed) = (0, 0);
        for (index, state) in leaf.claims.iter().enumerate() {
            match state {
                ClaimState::Holds => {}
                ClaimState::Fails => failed |= 1 << index,
                ClaimState::Unfollowed(_) => unfollowed |= 1 << index,
                ClaimState::Depends(formula) => {
                    failed |= u64::from(!self.holds(arena, formula, point)) << index;
                }
            }
        }
        Some(PointWay { leaf, failed, unfollowed })
    }

    /// Returns the value of a bound at the point that was followed last.
    pub(crate) fn bound(&mut self, arena: &Arena, state: &BoundState, point: &[f64]) -> Option<f64> {
        match state {
            BoundState::Node(node) => Some(self.value(arena, *node, point)),
            BoundState::None | BoundState::Unfollowed(_) => None,
        }
    }

    /// Returns how far a condition is from failing at the point that was followed last; below 0 where it fails.
    pub(crate) fn margin(&mut self, arena: &Arena, formula: &NodeFormula, point: &[f64]) -> f64 {
        match formula {
            NodeFormula::Known(known) => {
                if *known {
                    f64::INFINITY
                } else {
                    f64::NEG_INFINITY
                }
            }
            NodeFormula::Condition(condition) => {
                use gcode_enclosure::Relation;
                let left = self.value(arena, condition.left, point);
                let right = self.value(arena, condition.right, point);
                match condition.relation {
                    Relation::Le | Relation::Lt => right - left,
                    Relation::Ge | Relation::Gt => left - right,
                    Relation::Eq => -(left - right).abs(),
                    Relation::Ne => (left - right).abs(),
                }
            }
            NodeFormula::Logic(op, left, right) => {
                let (left, right) = (self.margin(arena, left, point), self.margin(arena, right, point));
                if *op == BinaryOp::And { left.min(right) } else { left.max(right) }
            }
        }
    }

    fn begin(&mut self) {
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.stamps.fill(0);
            self.stamp = 1;
        }
    }

    fn holds(&mut self, arena: &Arena, formula: &NodeFormula, point: &[f64]) -> bool {
        match formula {
            NodeFormula::Known(known) => *known,
            NodeFormula::Condition(condition) => {
                let left = self.value(arena, condition.left, point);
                condition.relation.holds(left, self.value(arena, condition.right, point))
            }
            NodeFormula::Logic(op, left, right) => {
                let (left, right) = (self.holds(arena, left, point), self.holds(arena, right, point));
                match op {
                    BinaryOp::And => left && right,
                    BinaryOp::Xor => left != right,
                    _ => left || right,
                }
            }
        }
    }

    /// Returns the value of a node; NaN if an operation has none.
    fn value(&mut self, arena: &Arena, node: NodeId, point: &[f64]) -> f64 {
        if self.stamps.len() < arena.len() {
            self.stamps.resize(arena.len(), 0);
            self.values.resize(arena.len(), f64::NAN);
        }
        if self.is_known(node) {
            return self.values[node.index()];
        }
        self.pending.push(node);
        while let Some(next) = self.pending.last().copied() {
            let known = match arena.node(next) {
                Node::Constant(value) => Some(value),
                Node::Input(input) => Some(point[input]),
                Node::Unary(function, x) => self.known(x).map(|x| arena.apply_unary(function, x)),
                Node::Binary(operator, a, b) => match (self.known(a), self.known(b)) {
                    (Some(a), Some(b)) => Some(arena.apply_binary(operator, a, b)),
                    _ => None,
                },
            };
            if let Some(value) = known {
                self.values[next.index()] = value;
                self.stamps[next.index()] = self.stamp;
                self.pending.pop();
            }
        }
        self.values[node.index()]
    }

    fn is_known(&self, node: NodeId) -> bool {
        self.stamps[node.index()] == self.stamp
    }

    /// Returns the value of an operand if it is known; otherwise it is computed first.
    fn known(&mut self, node: NodeId) -> Option<f64> {
        if self.is_known(node) {
            return Some(self.values[node.index()]);
        }
        self.pending.push(node);
        None
    }
}
