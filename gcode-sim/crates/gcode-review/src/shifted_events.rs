//! Stops, M codes and the like that come at another time than before.
use std::collections::{BTreeMap, BTreeSet};

use super::align::StepPair;
use super::reordered_cuts::ReorderedCuts;
use super::steps::Step;

/// The lost and the added step of what comes at another time, and whether that is `earlier` or `later`.
pub(super) type ShiftedEvent = (usize, usize, &'static str);

/// Stops, M codes and the like that are lost in one place and added in another, by the first link of the two; with
/// nothing at the second.
pub(super) fn shifted_events(
    links: &[StepPair],
    (old, new): (&[Step], &[Step]),
    tolerance: f64,
) -> BTreeMap<usize, Option<ShiftedEvent>> {
    let mut known = BTreeMap::new();
    let alone = |(_, link): &(usize, &StepPair)| match link {
        StepPair::Lost(i) => !old[*i].is_move(),
        StepPair::Added(j) => !new[*j].is_move(),
        StepPair::Same(..) | StepPair::Changed(..) => false,
    };
    let alone: Vec<(usize, &StepPair)> = links.iter().enumerate().filter(alone).collect();
    // Of more than these each is an entry of its own.
    if alone.len() > 1000 {
        return known;
    }
    for (place, (k, link)) in alone.iter().enumerate() {
        if known.contains_key(k) {
            continue;
        }
        let pair = |(l, other): &(usize, &StepPair)| match (link, other) {
            (StepPair::Lost(i), StepPair::Added(j)) => Some((*l, (*i, *j, "later"))),
            (StepPair::Added(j), StepPair::Lost(i)) => Some((*l, (*i, *j, "earlier"))),
            _ => None,
        };
        let mut others = alone[place + 1..].iter().filter(|(l, _)| !known.contains_key(l)).filter_map(pair);
        if let Some((l, found)) = others.find(|(_, (i, j, _))| old[*i].is_same(&new[*j], tolerance)) {
            known.extend([(*k, Some(found)), (l, None)]);
        }
    }
    known
}

/// Takes out what comes at another time together with the moves behind it; gives the links.
pub(super) fn take_with_runs(
    shifted: &mut BTreeMap<usize, Option<ShiftedEvent>>,
    links: &[StepPair],
    displaced: &ReorderedCuts<'_>,
) -> Vec<usize> {
    let with = shifted.values().flatten().filter(|(i, j, _)| displaced.is_before_run(*i, *j));
    let (was, is): (BTreeSet<usize>, BTreeSet<usize>) = with.map(|(i, j, _)| (*i, *j)).unzip();
    let is_with = |k: &usize| {
        let (i, j) = links[*k].sides();
        i.is_some_and(|i| was.contains(&i)) || j.is_some_and(|j| is.contains(&j))
    };
    shifted.extract_if(.., |k, _| is_with(k)).map(|(k, _)| k).collect()
}
