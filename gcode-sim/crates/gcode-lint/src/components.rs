//! Strongly connected components of a control flow graph, found in one pass.
//!
//! Algorithm: Tarjan, Depth-first search and linear graph algorithms, 1972.
use super::control_flow::ControlFlowGraph;

/// Returns the component number of each node. Two nodes share a component if each can reach the other.
pub(crate) fn strongly_connected_components(flow: &ControlFlowGraph) -> Vec<usize> {
    let after = |place: usize| flow.successors(place).collect();
    let mut search = Search::new(flow.block_count());
    for place in 0..flow.block_count() {
        search.visit(place, &after);
    }
    search.component
}

const UNVISITED: usize = usize::MAX;

/// State of the depth-first search.
struct Search {
    /// Order in which the nodes were first visited.
    visit_order: Vec<usize>,
    /// Lowest visit order reachable from each node.
    lowest_reachable: Vec<usize>,
    component: Vec<usize>,
    /// Visited nodes whose component is not complete.
    stack: Vec<usize>,
    visit_count: usize,
    component_count: usize,
}

impl Search {
    fn new(places: usize) -> Self {
        let unseen = vec![UNVISITED; places];
        Self {
            visit_order: unseen.clone(),
            lowest_reachable: unseen.clone(),
            component: unseen,
            stack: Vec::new(),
            visit_count: 0,
            component_count: 0,
        }
    }

    fn visit(&mut self, start: usize, after: &impl Fn(usize) -> Vec<usize>) {
        if self.visit_order[start] != UNVISITED {
            return;
        }
        // Nodes on the current path with the successors still to follow.
        let mut path = vec![(start, self.enter(start, after))];
        while let Some((place, ways)) = path.last_mut() {
            let place = *place;
            match ways.pop() {
                Some(to) if self.visit_order[to] == UNVISITED => path.push((to, self.enter(to, after))),
                Some(to) if self.component[to] == UNVISITED => {
                    self.lowest_reachable[place] = self.lowest_reachable[place].min(self.visit_order[to]);
                }
                Some(_) => {}
                None => {
                    path.pop();
                    if let Some((before, _)) = path.last() {
                        self.lowest_reachable[*before] =
                            self.lowest_reachable[*before].min(self.lowest_reachable[place]);
                    }
                    self.close(place);
                }
            }
        }
    }

    fn enter(&mut self, place: usize, after: &impl Fn(usize) -> Vec<usize>) -> Vec<usize> {
        self.visit_order[place] = self.visit_count;
        self.lowest_reachable[place] = self.visit_count;
        self.visit_count += 1;
        self.stack.push(place);
        after(place)
    }

    /// Completes a component if the node reaches no earlier node.
    fn close(&mut self, place: usize) {
        if self.lowest_reachable[place] < self.visit_order[place] {
            return;
        }
        while let Some(of_circle) = self.stack.pop() {
            self.component[of_circle] = self.component_count;
            if of_circle == place {
                break;
            }
        }
        self.component_count += 1;
    }
}
