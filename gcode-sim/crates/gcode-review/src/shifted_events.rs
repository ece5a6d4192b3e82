//! Stops, M codes and other commands that a revision executes earlier or later.
use std::collections::{BTreeMap, BTreeSet};

use super::align::Alignment;
use super::links::{Links, StepPair};
use super::reordered_cuts::ReorderedCuts;

/// The lost and the added step of a shifted command, and `earlier` or `later`.
pub(super) type ShiftedEvent = (usize, usize, &'static str);

/// Returns the commands that are lost at one point and added at another by the first of their two links; the second
/// has `None`. Of more than 1,000 commands none is paired.
pub(super) fn shifted_events(alignment: &Alignment<'_>) -> BTreeMap<usize, Option<ShiftedEvent>> {
    let Alignment { records: [old, new], links, tolerance } = *alignment;
    let mut known = BTreeMap::new();
    let is_command = |link: StepPair| alignment.step(link).is_some_and(|step| !step.is_move());
    let alone: Vec<(usize, StepPair)> = links.unpaired().filter(|(_, link)| is_command(*link)).collect();
    if alone.len() > 1000 {
        return known;
    }
    for (index, (k, link)) in alone.iter().enumerate() {
        if known.contains_key(k) {
            continue;
        }
        let pair = |(l, other): &(usize, StepPair)| match (*link, *other) {
            (StepPair::Lost(i), StepPair::Added(j)) => Some((*l, (i, j, "later"))),
            (StepPair::Added(j), StepPair::Lost(i)) => Some((*l, (i, j, "earlier"))),
            _ => None,
        };
        let mut others = alone[index + 1..].iter().filter(|(l, _)| !known.contains_key(l)).filter_map(pair);
        let is_same =
            |(_, (i, j, _)): &(usize, ShiftedEvent)| old.steps.at(*i).is_same(&new.steps.at(*j), tolerance);
        if let Some((l, found)) = others.find(is_same) {
            known.extend([(*k, Some(found)), (l, None)]);
        }
    }
    known
}

/// Removes the commands that are shifted together with the moves after them, and returns their links.
pub(super) fn take_with_runs(
    shifted: &mut BTreeMap<usize, Option<ShiftedEvent>>,
    links: &Links,
    cuts: &ReorderedCuts<'_>,
) -> Vec<usize> {
    let with = shifted.values().flatten().filter(|(i, j, _)| cuts.is_before_run(*i, *j));
    let steps: BTreeSet<[Option<usize>; 2]> =
        with.flat_map(|(i, j, _)| [[Some(*i), None], [None, Some(*j)]]).collect();
    shifted
        .extract_if(.., |k, _| links.get(*k).is_some_and(|link| steps.contains(&link.sides())))
        .map(|(k, _)| k)
        .collect()
}
