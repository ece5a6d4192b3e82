//! The neighbours of removed blocks in the new revision.
use std::collections::{BTreeMap, BTreeSet};

use super::align::Alignment;
use super::change::Change;

/// Gives each change that only the old revision has a block of its neighbouring block in the new one: the block before it that
/// is still there, else the one after it.
pub(super) fn set_anchors(changes: &mut [Change], alignment: &Alignment<'_>) {
    let [old, new] = alignment.records;
    let numbers = changes.iter().map(|change| match (&change.old, &change.new) {
        (Some(was), None) => old.blocks.find(was),
        _ => None,
    });
    let numbers: Vec<Option<usize>> = numbers.collect();
    let anchors = anchors(numbers.iter().flatten().copied(), alignment);
    for (change, number) in changes.iter_mut().zip(numbers) {
        let step = number.and_then(|number| anchors.get(&number).copied());
        change.anchor = step.map(|step| new.block(step).into_owned());
    }
}

/// Returns, for each of some old blocks, the new step whose block is its neighbour.
fn anchors(blocks: impl Iterator<Item = usize>, alignment: &Alignment<'_>) -> BTreeMap<usize, usize> {
    let steps = &alignment.records[0].steps;
    let mut open: BTreeSet<usize> = blocks.collect();
    let mut anchors = BTreeMap::new();
    // Blocks before which no step is paired: they have the first that is.
    let mut first_ones = Vec::new();
    let mut last = None;
    for link in alignment.links.iter() {
        if open.is_empty() && first_ones.is_empty() {
            break;
        }
        let [was, is] = link.sides();
        if let Some(number) = was.map(|step| steps.block_number(step)).filter(|number| open.remove(number)) {
            match last {
                Some(step) => _ = anchors.insert(number, step),
                None => first_ones.push(number),
            }
        }
        last = was.and(is).or(last);
        if let Some(step) = last {
            anchors.extend(first_ones.drain(..).map(|number| (number, step)));
        }
    }
    anchors
}
