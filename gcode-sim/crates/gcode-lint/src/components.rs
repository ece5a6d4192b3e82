//! Which blocks lie on common ways round: the strongly connected parts of a program's ways, found in one pass
//! (Tarjan, Depth-first search and linear graph algorithms, 1972).
use super::control_flow::ControlFlowGraph;

/// For each place of the ways the number of its circle: two places have the same one if each can lead to the other.
pub(crate) fn strongly_connected_components(flow: &ControlFlowGraph) -> Vec<usize> {
    let after = |place: usize| flow.successors(place).collect();
    let mut search = Search::new(flow.block_count());
    for place in 0..flow.block_count() {
        search.visit(place, &after);
    }
    search.component
}

const UNVISITED: usize = usize::MAX;

struct Search {
    /// In which order the places were first seen.
    visit_order: Vec<usize>,
    /// The first of them, by order, that a place leads back to.
    lowest_reachable: Vec<usize>,
    component: Vec<usize>,
    /// Seen, and their circle not yet closed.
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
        // Each place with the ways from it that are still to be followed.
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

    /// A place that leads back to nothing before itself is the first of its circle.
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
