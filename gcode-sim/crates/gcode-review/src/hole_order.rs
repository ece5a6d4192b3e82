//! Holes, or some of their passes, that are made in a different order.
use std::collections::BTreeSet;

use super::align::Alignment;
use super::change::{Effect, grouped};
use super::cut_settings::changed_cut_settings;
use super::hole_groups::{HoleEffect, name_holes};
use super::kinds;
use super::passes::{Passes, in_words};

/// A pass of a hole that both revisions make.
#[derive(Clone, Copy)]
struct SharedPass {
    hole: usize,
    /// Number of the pass, from 1, and number of passes of its hole.
    number: (usize, usize),
    tool: Option<u32>,
    /// Its feed, old and new.
    steps: (usize, usize),
}

/// Passes of one hole, and how their conditions differ in the new order.
type ReorderedHole = (usize, Vec<SharedPass>, Vec<String>);

/// Returns one effect for holes that are reordered alike: the smallest set of passes whose order changed,
/// preferably none that are linked. Holes with more or fewer passes than before are not compared.
pub(super) fn hole_order(
    alignment: &Alignment<'_>,
    passes: &[Passes; 2],
    partner: &[Option<usize>],
) -> Vec<HoleEffect> {
    let pairs = partner.iter().enumerate().filter_map(|(hole, other)| Some((hole, (*other)?)));
    let mut all: Vec<SharedPass> = pairs.flat_map(|(hole, other)| of_hole(passes, hole, other)).collect();
    all.sort_unstable_by_key(|pass| pass.steps.0);
    let feeds: BTreeSet<(usize, usize)> = all.iter().map(|pass| pass.steps).collect();
    let linked: BTreeSet<(usize, usize)> = if feeds.is_empty() {
        BTreeSet::new()
    } else {
        alignment.pairs().filter(|pair| feeds.contains(pair)).collect()
    };
    let is_linked = |k: &usize| linked.contains(&all[*k].steps);
    let in_place: BTreeSet<usize> = (0..all.len()).filter(is_linked).collect();
    let most = longest_increasing(&all.iter().map(|pass| pass.steps.1).collect::<Vec<_>>());
    let stays = if most.len() <= in_place.len() { in_place } else { most };
    let late: Vec<SharedPass> = (0..all.len()).filter(|k| !stays.contains(k)).map(|k| all[k]).collect();
    let steps: Vec<(usize, usize)> = late.iter().map(|pass| pass.steps).collect();
    let settings = changed_cut_settings(alignment, &steps);
    let holes = grouped(late.into_iter().zip(settings).map(|pass| (pass.0.hole, pass)));
    let holes = holes.into_iter().map(|(hole, passes)| {
        let (passes, settings): (Vec<SharedPass>, Vec<_>) = passes.into_iter().unzip();
        let mut with: Vec<String> = Vec::new();
        for text in settings.into_iter().flatten() {
            if !with.contains(&text) {
                with.push(text);
            }
        }
        let is_whole = passes.len() == passes[0].number.1;
        let of = passes.iter().map(|pass| (pass.number, pass.tool)).filter(|_| !is_whole);
        ((with.clone(), of.collect::<Vec<_>>()), (hole, passes, with))
    });
    let groups = grouped(holes);
    all.sort_unstable_by_key(|pass| pass.steps.1);
    let effect = |(_, group): (_, Vec<ReorderedHole>)| {
        let (was, is): (Vec<usize>, Vec<usize>) =
            group.iter().flat_map(|(_, passes, _)| passes).map(|pass| pass.steps).unzip();
        let blocks = alignment.blocks([Some(was[0]), Some(is[0])]);
        let effect = Effect::new(&kinds::HOLE_ORDER, message(&group, &all), blocks);
        HoleEffect { effect, steps: [was, is], tools: [None, None] }
    };
    groups.into_iter().map(effect).collect()
}

/// Pairs the passes of a hole in their order if their number is unchanged.
fn of_hole(passes: &[Passes; 2], hole: usize, other: usize) -> Vec<SharedPass> {
    let (was, is) = (&passes[0].steps[hole], &passes[1].steps[other]);
    let (before, tools) = (&passes[0].tools[hole], &passes[1].tools[other]);
    // If the tools are unknown, no other difference reports a lost or added pass.
    if was.len() != is.len() && !(before.is_empty() && tools.is_empty()) {
        return Vec::new();
    }
    let pass = |(index, steps)| {
        let (number, tool) = ((index + 1, was.len().min(is.len())), tools.get(index).copied());
        SharedPass { hole, number, tool, steps }
    };
    was.iter().copied().zip(is.iter().copied()).enumerate().map(pass).collect()
}

/// Names the passes, unless they are all of the hole.
fn name(passes: &[SharedPass]) -> String {
    if passes.len() == passes[0].number.1 {
        return String::new();
    }
    let numbers: Vec<String> = passes.iter().map(|pass| pass.number.0.to_string()).collect();
    let word = if numbers.len() == 1 { "pass" } else { "passes" };
    let tools: Option<Vec<u32>> = passes.iter().map(|pass| pass.tool).collect();
    let by = tools.map(|tools| format!(", by {}", in_words(&tools))).unwrap_or_default();
    format!("{word} {} of {}{by}, ", numbers.join(" and "), passes[0].number.1)
}

/// Formats holes that are reordered alike; `all` is in the new order.
fn message(group: &[ReorderedHole], all: &[SharedPass]) -> String {
    let (_, passes, with) = &group[0];
    let holes: Vec<usize> = group.iter().map(|(hole, ..)| *hole).collect();
    let first = &passes[0];
    let is_before = |other: &&SharedPass| other.steps.1 < first.steps.1;
    let mut before = all.iter().filter(is_before);
    let last = before.clone().rev().find(|other| other.tool == first.tool && other.hole != first.hole);
    let after = match (last, first.tool) {
        (Some(other), _) => format!("after hole {}", other.hole + 1),
        (None, Some(tool)) if before.next().is_some() => format!("first of T{tool}"),
        (None, _) => "first of all".to_owned(),
    };
    let with: String = if with.is_empty() { String::new() } else { format!(", {}", with.join(", ")) };
    let which = if holes.len() == 1 { String::new() } else { format!("hole {} ", holes[0] + 1) };
    format!("{}: {}made in a different order, {which}{after}{with}", name_holes(&holes), name(passes))
}

/// Returns the indices of a longest increasing subsequence.
fn longest_increasing(values: &[usize]) -> BTreeSet<usize> {
    // Index of the smallest last value of each length, and the predecessor of each index.
    let mut ends: Vec<usize> = Vec::new();
    let mut follows: Vec<Option<usize>> = Vec::with_capacity(values.len());
    for (index, value) in values.iter().enumerate() {
        let length = ends.partition_point(|end| values[*end] < *value);
        follows.push(length.checked_sub(1).map(|shorter| ends[shorter]));
        match ends.get_mut(length) {
            Some(end) => *end = index,
            None => ends.push(index),
        }
    }
    std::iter::successors(ends.last().copied(), |index| follows[*index]).collect()
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
