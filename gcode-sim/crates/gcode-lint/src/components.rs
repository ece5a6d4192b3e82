//! Strongly connected components of a control flow graph, found in linear time.
//!
//! Algorithm: Kosaraju and Sharir, two depth-first searches; the second follows the edges backwards.
use super::control_flow::ControlFlowGraph;

const UNKNOWN: usize = usize::MAX;

/// Returns the component number of each node. Two nodes share a component if each can reach the other.
pub(crate) fn strongly_connected_components(flow: &ControlFlowGraph) -> Vec<usize> {
    let count = flow.block_count();
    let mut predecessors = vec![Vec::new(); count];
    let mut is_visited = vec![false; count];
    // Nodes in the order in which the search leaves them.
    let mut left = Vec::new();
    for start in 0..count {
        let mut open = vec![(start, false)];
        while let Some((place, is_complete)) = open.pop() {
            if is_complete {
                left.push(place);
            } else if !std::mem::replace(&mut is_visited[place], true) {
                open.push((place, true));
                for to in flow.successors(place) {
                    predecessors[to].push(place);
                    open.push((to, false));
                }
            }
        }
    }
    let mut component = vec![UNKNOWN; count];
    for (number, start) in left.into_iter().rev().enumerate() {
        let mut open = vec![start];
        while let Some(place) = open.pop() {
            if component[place] == UNKNOWN {
                component[place] = number;
                open.extend(&predecessors[place]);
            }
        }
    }
    component
}
