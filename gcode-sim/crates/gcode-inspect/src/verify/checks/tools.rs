//! Holes of one diameter are made by the same tools: where one lacks a tool that most others get, a call was lost.
//!
//! This needs no tool table, so it sees a lost finishing pass where nothing is known of the tools but their numbers.
//! Sister tools are no fault, so it warns and leaves the verdict alone.
use std::collections::BTreeMap;

use super::{HoleFinding, HoleInspection};
use crate::findings::HOLE_TOOLS;
use crate::holes::DrilledHole;
use gcode_lang::diag::Diagnostic;

/// Fewer holes of one diameter don't show what is usual.
const MIN_HOLES: usize = 3;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    // Diameters are what somebody wrote down: equal ones are equal bits.
    let mut alike: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (index, pair) in comparison.pairs.iter().enumerate() {
        if let Some(diameter) = comparison.nominal[pair.nominal].diameter {
            alike.entry(diameter.to_bits()).or_default().push(index);
        }
    }
    for (diameter, group) in alike.into_iter().filter(|(_, group)| MIN_HOLES <= group.len()) {
        let found = |index: &usize| &comparison.actual[comparison.pairs[*index].actual];
        let Some(usual) = most_common(group.iter().map(|index| tools(found(index)))) else { continue };
        for index in &group {
            let cuts = |tool: &u32| tools(found(index)).any(|other| other == *tool);
            if usual.iter().all(cuts) {
                continue;
            }
            let lacks: Vec<String> =
                usual.iter().filter(|tool| !cuts(tool)).map(|tool| format!("T{tool}")).collect();
            let pair = &comparison.pairs[*index];
            let message = format!(
                "hole {} is made without {}; most holes of Φ{} are made with it",
                comparison.id(pair.nominal),
                lacks.join(", "),
                f64::from_bits(diameter)
            );
            let finding = Diagnostic::new(&HOLE_TOOLS, message)
                .help("check for a missing call")
                .with_backtrace(comparison.actual[pair.actual].backtrace.clone());
            objections.push(HoleFinding::of_nominal(pair.nominal, finding));
        }
    }
}

/// The tools that cut in a hole.
fn tools(found: &DrilledHole) -> impl Iterator<Item = u32> + '_ {
    found.earlier_passes.iter().map(|cut| cut.tool).chain([found.tool]).flatten()
}

/// The tools, each once, that more than half of the holes get.
fn most_common<T: IntoIterator<Item = u32>>(holes: impl ExactSizeIterator<Item = T>) -> Option<Vec<u32>> {
    let all = holes.len();
    let mut counts: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    let mut set = Vec::new();
    for hole in holes {
        set.clear();
        set.extend(hole);
        set.sort_unstable();
        set.dedup();
        match counts.get_mut(&set) {
            Some(count) => *count += 1,
            None => {
                counts.insert(set.clone(), 1);
            }
        }
    }
    let (set, count) = counts.into_iter().max_by_key(|(_, count)| *count)?;
    (all < 2 * count).then_some(set)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_is_what_more_than_half_have() {
        let (both, one) = (vec![1, 2], vec![1]);
        assert_eq!(most_common([both.clone(), one.clone(), both.clone()].into_iter()), Some(both.clone()));
        assert_eq!(most_common([both.clone(), one.clone(), both, one].into_iter()), None);
        assert_eq!(most_common(std::iter::empty::<Vec<u32>>()), None);
    }
}
