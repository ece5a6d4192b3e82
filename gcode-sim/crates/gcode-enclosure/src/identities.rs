//! Sums that have been examined for identities, by node: what is known of an arena's nodes on every box.
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::node::NodeId;

/// Largest number of sums that are examined.
const MAX_EXAMINED: usize = 400;

/// Sums and differences by whether they are constants but for roundings.
#[derive(Debug, Default)]
pub(crate) struct Identities(Mutex<HashMap<NodeId, bool>>);

impl Clone for Identities {
    fn clone(&self) -> Self {
        Self(Mutex::new(self.lock().clone()))
    }
}

impl Identities {
    fn lock(&self) -> MutexGuard<'_, HashMap<NodeId, bool>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether a node is one; `examine` finds it out, of the first few hundred nodes.
    pub(crate) fn contains(&self, node: NodeId, examine: impl FnOnce() -> bool) -> bool {
        let mut known = self.lock();
        if let Some(is_one) = known.get(&node) {
            return *is_one;
        }
        let is_one = known.len() < MAX_EXAMINED && examine();
        known.insert(node, is_one);
        is_one
    }
}
