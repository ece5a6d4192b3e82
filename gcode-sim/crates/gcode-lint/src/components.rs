//! Which blocks lie on common ways round: the strongly connected parts of a program's ways, found in one pass
//! (Tarjan, Depth-first search and linear graph algorithms, 1972).
use super::flow::ControlFlowGraph;

/// For each place of the ways the number of its circle: two places have the same one if each can lead to the other.
pub(crate) fn strongly_connected_components(flow: &ControlFlowGraph) -> Vec<usize> {
    let after = |place: usize| flow.successors(place).collect();
    let mut search = Search::new(flow.block_count());
    for place in 0..flow.block_count() {
        search.from(place, &after);
    }
    search.circle
}

const UNSEEN: usize = usize::MAX;

struct Search {
    /// In which order the places were first seen.
    order: Vec<usize>,
    /// The first of them, by order, that a place leads back to.
    back: Vec<usize>,
    circle: Vec<usize>,
    /// Seen, and their circle not yet closed.
    open: Vec<usize>,
    seen: usize,
    found: usize,
}

impl Search {
    fn new(places: usize) -> Self {
        let unseen = vec![UNSEEN; places];
        Self {
            order: unseen.clone(),
            back: unseen.clone(),
            circle: unseen,
            open: Vec::new(),
            seen: 0,
            found: 0,
        }
    }

    fn from(&mut self, start: usize, after: &impl Fn(usize) -> Vec<usize>) {
        if self.order[start] != UNSEEN {
            return;
        }
        // Each place with the ways from it that are still to be followed.
        let mut path = vec![(start, self.enter(start, after))];
        while let Some((place, ways)) = path.last_mut() {
            let place = *place;
            match ways.pop() {
                Some(to) if self.order[to] == UNSEEN => path.push((to, self.enter(to, after))),
                Some(to) if self.circle[to] == UNSEEN => {
                    self.back[place] = self.back[place].min(self.order[to]);
                }
                Some(_) => {}
                None => {
                    path.pop();
                    if let Some((before, _)) = path.last() {
                        self.back[*before] = self.back[*before].min(self.back[place]);
                    }
                    self.close(place);
                }
            }
        }
    }

    fn enter(&mut self, place: usize, after: &impl Fn(usize) -> Vec<usize>) -> Vec<usize> {
        self.order[place] = self.seen;
        self.back[place] = self.seen;
        self.seen += 1;
        self.open.push(place);
        after(place)
    }

    /// A place that leads back to nothing before itself is the first of its circle.
    fn close(&mut self, place: usize) {
        if self.back[place] < self.order[place] {
            return;
        }
        while let Some(of_circle) = self.open.pop() {
            self.circle[of_circle] = self.found;
            if of_circle == place {
                break;
            }
        }
        self.found += 1;
    }
}
