//! One path through a program, and the terms of the one that is followed.
use std::collections::HashMap;

use gcode_control::symbolic::{Snapshot, Term, TermOperation, Terms, Test};
use gcode_enclosure::Enclosures;

use crate::nodes::{Nodes, TestKey, is_finite, key};

/// Run up to a block, with what is assumed of the values on its path.
pub(super) struct PathState {
    pub(super) snapshot: Snapshot,
    pub(super) enclosures: Enclosures,
    /// Answers to the questions of the next block.
    pub(super) answers: HashMap<TestKey, bool>,
}

/// Terms of the path that is followed.
pub(super) struct PathTerms {
    pub(super) nodes: Nodes,
    pub(super) enclosures: Enclosures,
    pub(super) answers: HashMap<TestKey, bool>,
}

impl Terms for PathTerms {
    fn node(&mut self, operation: TermOperation, operands: [Term; 2]) -> Term {
        self.nodes.node(operation, operands)
    }

    fn bounds(&mut self, term: Term) -> (f64, f64) {
        let id = self.nodes.id(term);
        let hull = self.enclosures.enclose(self.nodes.arena(), id);
        (hull.lo(), hull.hi())
    }

    fn answer(&mut self, test: &Test) -> Option<bool> {
        if let Some(answer) = self.answers.get(&key(test)) {
            return Some(*answer);
        }
        match *test {
            Test::Compare(relation, left, right) => {
                let condition = self.nodes.condition(relation, left, right);
                self.enclosures.decide(self.nodes.arena(), condition)
            }
            Test::Finite(term) => {
                let id = self.nodes.id(term);
                is_finite(self.nodes.arena(), &mut self.enclosures, id)
            }
        }
    }
}
