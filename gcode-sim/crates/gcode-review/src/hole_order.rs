//! Holes, or some passes of them, that are made at another time than before.
use std::collections::{BTreeMap, BTreeSet};

use super::align::StepPair;
use super::change::Effect;
use super::cut_settings::changed_cut_settings;
use super::hole_groups::{HoleEffect, named};
use super::passes::{Passes, in_words};
use super::record::Record;

/// A pass of a hole that both revisions make.
#[derive(Clone, Copy)]
struct SharedPass {
    hole: usize,
    /// Which of how many of its hole, counted from 1.
    number: (usize, usize),
    tool: Option<u32>,
    /// Its feed, before and now.
    steps: (usize, usize),
}

/// The fewest passes that can be called moved, those whose steps are linked staying where they can. Passes of holes
/// that are made more or less often are made at another time because of that.
pub(super) fn hole_order<'a>(
    (old, new): (&'a Record, &'a Record),
    links: &[StepPair],
    passes: &(Passes, Passes),
    partner: &[Option<usize>],
) -> Vec<HoleEffect> {
    let pairs = partner.iter().enumerate().filter_map(|(hole, other)| Some((hole, (*other)?)));
    let mut all: Vec<SharedPass> = pairs.flat_map(|(hole, other)| of_hole(passes, hole, other)).collect();
    all.sort_unstable_by_key(|pass| pass.steps.0);
    let linked: BTreeMap<usize, usize> =
        links.iter().filter_map(|link| link.sides().0.zip(link.sides().1)).collect();
    let is_linked = |k: &usize| linked.get(&all[*k].steps.0) == Some(&all[*k].steps.1);
    let (most, in_place) = (
        longest_increasing(&all.iter().map(|pass| pass.steps.1).collect::<Vec<_>>()),
        (0..all.len()).filter(is_linked).collect::<BTreeSet<_>>(),
    );
    let stays = if most.len() <= in_place.len() { in_place } else { most };
    let late: Vec<SharedPass> = (0..all.len()).filter(|k| !stays.contains(k)).map(|k| all[k]).collect();
    let steps: Vec<(usize, usize)> = late.iter().map(|pass| pass.steps).collect();
    let mut holes: Vec<ReorderedPasses> = Vec::new();
    let mut of_holes: BTreeMap<usize, usize> = BTreeMap::new();
    for (pass, with) in late.into_iter().zip(changed_cut_settings(old, new, &steps)) {
        let place = *of_holes.entry(pass.hole).or_insert(holes.len());
        match holes.get_mut(place) {
            Some(hole) => hole.add(pass, with),
            None => holes.push(ReorderedPasses { passes: vec![pass], with: with.into_iter().collect() }),
        }
    }
    let mut groups: Vec<Vec<ReorderedPasses>> = Vec::new();
    for hole in holes {
        match groups.iter_mut().find(|group| group[0].is_alike(&hole)) {
            Some(group) => group.push(hole),
            None => groups.push(vec![hole]),
        }
    }
    all.sort_unstable_by_key(|pass| pass.steps.1);
    let effect = |group: &Vec<ReorderedPasses>| {
        let (was, is): (Vec<usize>, Vec<usize>) =
            group.iter().flat_map(|late| &late.passes).map(|pass| pass.steps).unzip();
        let place = |record: &'a Record, step: usize| record.places.get(record.steps[step].place);
        let effect = Effect::new("hole-order", message(group, &all));
        let effect = effect.with_old(place(old, was[0])).with_new(place(new, is[0]));
        HoleEffect { effect, steps: [was, is], tools: [None, None] }
    };
    groups.iter().map(effect).collect()
}

/// Its passes one by one, where they are as many as before.
fn of_hole(passes: &(Passes, Passes), hole: usize, other: usize) -> Vec<SharedPass> {
    let (was, is) = (&passes.0.steps[hole], &passes.1.steps[other]);
    let (before, tools) = (&passes.0.tools[hole], &passes.1.tools[other]);
    // Where nobody knows the tools, nothing else tells of a hole that is made more often.
    if was.len() != is.len() && !(before.is_empty() && tools.is_empty()) {
        return Vec::new();
    }
    let pass = |(place, steps)| {
        let (number, tool) = ((place + 1, was.len().min(is.len())), tools.get(place).copied());
        SharedPass { hole, number, tool, steps }
    };
    was.iter().copied().zip(is.iter().copied()).enumerate().map(pass).collect()
}

/// Passes of one hole that are made at another time.
struct ReorderedPasses {
    passes: Vec<SharedPass>,
    /// How they are made otherwise because of that.
    with: Vec<String>,
}

impl ReorderedPasses {
    fn add(&mut self, pass: SharedPass, with: Option<String>) {
        self.passes.push(pass);
        self.with.extend(with.filter(|text| !self.with.contains(text)));
    }

    fn is_whole(&self) -> bool {
        self.passes.len() == self.passes[0].number.1
    }

    fn is_alike(&self, other: &Self) -> bool {
        let of = |late: &Self| late.passes.iter().map(|pass| (pass.number, pass.tool)).collect::<Vec<_>>();
        self.with == other.with && (self.is_whole() && other.is_whole() || of(self) == of(other))
    }

    /// Which passes, unless it is all of them.
    fn name(&self) -> String {
        if self.is_whole() {
            return String::new();
        }
        let numbers: Vec<String> = self.passes.iter().map(|pass| pass.number.0.to_string()).collect();
        let passes = if numbers.len() == 1 { "pass" } else { "passes" };
        let tools: Option<Vec<u32>> = self.passes.iter().map(|pass| pass.tool).collect();
        let by = tools.map(|tools| format!(", by {}", in_words(&tools))).unwrap_or_default();
        format!("{passes} {} of {}{by}, ", numbers.join(" and "), self.passes[0].number.1)
    }
}

/// Of holes that are made at another time alike; `all` is in the new order.
fn message(group: &[ReorderedPasses], all: &[SharedPass]) -> String {
    let (first, holes): (&ReorderedPasses, Vec<usize>) =
        (&group[0], group.iter().map(|late| late.passes[0].hole).collect());
    let pass = &first.passes[0];
    let is_before = |other: &&SharedPass| other.steps.1 < pass.steps.1;
    let mut before = all.iter().filter(is_before);
    let last = before.clone().rev().find(|other| other.tool == pass.tool && other.hole != pass.hole);
    let after = match (last, pass.tool) {
        (Some(other), _) => format!("after hole {}", other.hole + 1),
        (None, Some(tool)) if before.next().is_some() => format!("first of T{tool}"),
        (None, _) => "first of all".to_owned(),
    };
    let with = if first.with.is_empty() { String::new() } else { format!(", {}", first.with.join(", ")) };
    let name = first.name();
    match holes.len() {
        1 => format!("{}: {name}made in a different order, {after}{with}", named(&holes)),
        _ => {
            format!("{}: {name}made in a different order, hole {} {after}{with}", named(&holes), holes[0] + 1)
        }
    }
}

/// The places of a longest rising subsequence.
fn longest_increasing(values: &[usize]) -> BTreeSet<usize> {
    // The last place of the best sequence of each length, and what each place follows.
    let mut ends: Vec<usize> = Vec::new();
    let mut follows: Vec<Option<usize>> = Vec::with_capacity(values.len());
    for (place, value) in values.iter().enumerate() {
        let length = ends.partition_point(|end| values[*end] < *value);
        follows.push(length.checked_sub(1).map(|shorter| ends[shorter]));
        match ends.get_mut(length) {
            Some(end) => *end = place,
            None => ends.push(place),
        }
    }
    std::iter::successors(ends.last().copied(), |place| follows[*place]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_holes_are_called_moved() {
        assert_eq!(longest_increasing(&[0, 1, 2, 3]), BTreeSet::from([0, 1, 2, 3]));
        assert_eq!(longest_increasing(&[1, 2, 0, 3]), BTreeSet::from([0, 1, 3]));
        assert_eq!(longest_increasing(&[3, 2, 1, 0]).len(), 1);
        assert_eq!(longest_increasing(&[]), BTreeSet::new());
    }
}
