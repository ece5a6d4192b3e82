//! Joining of paths: one state with an input for each variable that differs, and what holds of it on every path.
use std::collections::{BTreeMap, HashMap, HashSet};

use gcode_control::symbolic::{Snapshot, Term};
use gcode_enclosure::{Condition, Domain, Enclosures, Interval, NodeId, Relation};
use gcode_lang::program::Library;

use super::path::PathState;
use super::substitution::{has_values, inputs_of, substitute};
use super::{JoinedProof, MAX_CONDITIONS, MAX_JOINED};

impl<L: Library> JoinedProof<'_, L> {
    /// Joins paths that continue alike.
    pub(super) fn join_all(&mut self, mut arrived: Vec<PathState>) -> Option<Vec<PathState>> {
        let mut joined = Vec::new();
        while let Some(first) = arrived.pop() {
            let (mut group, others): (Vec<_>, Vec<_>) =
                arrived.into_iter().partition(|path| path.snapshot.continues_like(&first.snapshot));
            arrived = others;
            group.push(first);
            if group.len() == 1 {
                joined.append(&mut group);
            } else {
                joined.push(self.join(&mut group)?);
            }
        }
        Some(joined)
    }

    /// Joins paths; `None` if they differ in too much.
    fn join(&mut self, paths: &mut [PathState]) -> Option<PathState> {
        let inputs = self.domain.ranges().len();
        let mut values: BTreeMap<usize, Vec<NodeId>> = BTreeMap::new();
        let (slots, nodes) = (&mut self.slots, &mut self.terms.nodes);
        let states: Vec<_> = paths.iter().map(|path| path.snapshot.clone()).collect();
        let states: Vec<_> = states.iter().collect();
        let snapshot = Snapshot::joined(&states, &mut |slot: usize, terms: &[Term]| {
            let ids: Vec<_> = terms.iter().map(|term| nodes.id(*term)).collect();
            let is_kept = terms.iter().all(|term| *term == terms[0])
                && !inputs_of(nodes.arena(), ids[0]).any(|input| input >= inputs);
            if is_kept {
                return Some(terms[0]);
            }
            let count = slots.len();
            let input = *slots.entry(slot).or_insert(inputs + count);
            if input >= inputs + MAX_JOINED {
                return None;
            }
            values.insert(input, ids);
            Some(nodes.input(input))
        })?;
        let mut ranges = self.domain.ranges().to_vec();
        ranges.resize(inputs + MAX_JOINED, Interval::point(0.0));
        for (input, ids) in &values {
            let arena = self.terms.nodes.arena();
            let of_paths = paths.iter_mut().zip(ids);
            ranges[*input] = of_paths.fold(Interval::EMPTY, |range, (path, id)| {
                range.hull(path.enclosures.enclose_tightly(arena, *id))
            });
        }
        if ranges.iter().any(|range| range.is_empty()) {
            return None;
        }
        self.find_candidates(paths, &values);
        let relations = self.relations(paths, &values, &ranges);
        let mut enclosures = Enclosures::new(Domain::new(ranges));
        for (input, other, difference) in relations {
            enclosures.relate(input, other, difference);
        }
        for candidate in self.candidates.clone() {
            if self.is_used_up() {
                return None;
            }
            if self.holds_on_all(paths, &values, candidate)
                && !enclosures.assume(self.terms.nodes.arena(), candidate)
            {
                return None;
            }
        }
        Some(PathState { snapshot, enclosures, answers: HashMap::new() })
    }

    /// Returns for inputs of their own another input from which they differ little, and by how much.
    fn relations(
        &mut self,
        paths: &mut [PathState],
        values: &BTreeMap<usize, Vec<NodeId>>,
        ranges: &[Interval],
    ) -> Vec<(usize, usize, Interval)> {
        let mut relations = Vec::new();
        let mut others: Vec<(usize, Vec<NodeId>)> = Vec::new();
        for (index, range) in self.domain.ranges().iter().enumerate() {
            if range.width() > 0.0 {
                let term = self.terms.nodes.input(index);
                others.push((index, vec![self.terms.nodes.id(term); paths.len()]));
            }
        }
        for (input, ids) in values {
            let arena = self.terms.nodes.arena();
            let mut best: Option<(usize, Interval)> = None;
            for (other, of_other) in &others {
                let pairs = paths.iter_mut().zip(ids.iter().zip(of_other));
                let difference = pairs.fold(Interval::EMPTY, |range, (path, (id, other))| {
                    range.hull(path.enclosures.difference_range(arena, *id, *other))
                });
                if !difference.is_empty()
                    && difference.width() < 0.6 * ranges[*input].width()
                    && best.is_none_or(|(_, best)| difference.width() <= best.width())
                {
                    best = Some((*other, difference));
                }
            }
            relations.extend(best.map(|(other, difference)| (*input, other, difference)));
            others.push((*input, ids.clone()));
        }
        relations
    }

    /// Finds conditions that may hold on every path: those assumed on one, of its variables, and the order of variables and
    /// inputs.
    fn find_candidates(&mut self, paths: &[PathState], values: &BTreeMap<usize, Vec<NodeId>>) {
        let inputs = self.domain.ranges().len();
        let joined: Vec<usize> = values.keys().copied().collect();
        for (place, path) in paths.iter().enumerate() {
            for condition in path.enclosures.conditions().to_vec() {
                for preferred in &joined {
                    let mut map = HashMap::new();
                    for input in std::iter::once(preferred).chain(&joined) {
                        let id = values[input][place];
                        if self.terms.nodes.arena().as_constant(id).is_none() {
                            let term = self.terms.nodes.input(*input);
                            let own = self.terms.nodes.id(term);
                            map.entry(id).or_insert(own);
                        }
                    }
                    if let Some(found) = self.substituted(condition, &map, &|input| input < inputs) {
                        self.add_candidate(found);
                    }
                }
            }
        }
        for input in &joined {
            for other in 0..inputs {
                let sides = [*input, other].map(|input| self.terms.nodes.input(input));
                let [own, other] = sides.map(|term| self.terms.nodes.id(term));
                self.add_candidate(Condition::new(Relation::Le, own, other));
                self.add_candidate(Condition::new(Relation::Ge, own, other));
            }
        }
    }

    fn add_candidate(&mut self, condition: Condition) {
        let weaker = match condition.relation {
            Relation::Gt => Some(Relation::Ge),
            Relation::Lt => Some(Relation::Le),
            Relation::Eq | Relation::Ne | Relation::Ge | Relation::Le => None,
        };
        let weaker = weaker.map(|relation| Condition { relation, ..condition });
        for condition in weaker.into_iter().chain([condition]) {
            if self.candidates.len() < MAX_CONDITIONS && self.known.insert(condition) {
                self.candidates.push(condition);
            }
        }
    }

    /// Returns true if a condition on the inputs holds of the values on every path.
    fn holds_on_all(
        &mut self,
        paths: &mut [PathState],
        values: &BTreeMap<usize, Vec<NodeId>>,
        condition: Condition,
    ) -> bool {
        let inputs = self.domain.ranges().len();
        for (place, path) in paths.iter_mut().enumerate() {
            let mut map = HashMap::new();
            for (input, ids) in values {
                let term = self.terms.nodes.input(*input);
                map.insert(self.terms.nodes.id(term), ids[place]);
            }
            let Some(here) = self.substituted(condition, &map, &|input| input < inputs) else {
                return false;
            };
            let arena = self.terms.nodes.arena();
            let computed: HashSet<NodeId> = values.values().map(|ids| ids[place]).collect();
            if !has_values(arena, &mut path.enclosures, here, computed)
                || path.enclosures.decide_by_signs(arena, here) != Some(true)
            {
                return false;
            }
        }
        true
    }

    /// Returns a condition with nodes replaced; `None` if another input than those kept is left.
    fn substituted(
        &mut self,
        condition: Condition,
        map: &HashMap<NodeId, NodeId>,
        is_kept: &dyn Fn(usize) -> bool,
    ) -> Option<Condition> {
        let arena = self.terms.nodes.arena_mut();
        let mut done = HashMap::new();
        let left = substitute(arena, condition.left, map, is_kept, &mut done)?;
        let right = substitute(arena, condition.right, map, is_kept, &mut done)?;
        Some(Condition { left, right, ..condition })
    }
}
