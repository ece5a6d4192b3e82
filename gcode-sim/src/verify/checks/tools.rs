//! Holes of one diameter are made by the same tools: where one lacks a tool that most others get, a call was lost.
//!
//! This needs no tool table, so it sees a lost finishing pass where nothing is known of the tools but their numbers.
//! Sister tools are no fault, so it warns and leaves the verdict alone.
use std::collections::BTreeMap;

use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::holes::Found;

/// Fewer holes of one diameter don't show what is usual.
const FEWEST: usize = 3;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    // Diameters are what somebody wrote down: equal ones are equal bits.
    let mut alike: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (index, pair) in comparison.pairs.iter().enumerate() {
        if let Some(diameter) = comparison.wanted[pair.wanted].diameter {
            alike.entry(diameter.to_bits()).or_default().push(index);
        }
    }
    for (diameter, group) in alike.into_iter().filter(|(_, group)| FEWEST <= group.len()) {
        let sets: Vec<Vec<u32>> =
            group.iter().map(|index| tools(&comparison.found[comparison.pairs[*index].found])).collect();
        let Some(usual) = most_common(&sets) else { continue };
        for (index, set) in group.iter().zip(&sets) {
            let lacks: Vec<String> =
                usual.iter().filter(|tool| !set.contains(tool)).map(|tool| format!("T{tool}")).collect();
            if lacks.is_empty() {
                continue;
            }
            let pair = &comparison.pairs[*index];
            let message = format!(
                "hole {} is made without {}, which most holes of Φ{} get",
                comparison.id(pair.wanted),
                lacks.join(", "),
                f64::from_bits(diameter)
            );
            let finding = Diagnostic::warning("hole-tools", message)
                .help("was a call left out?")
                .at(comparison.found[pair.found].place.clone());
            objections.push(Objection::of(pair.wanted, finding));
        }
    }
}

/// The tools that cut in a hole, each once.
fn tools(found: &Found) -> Vec<u32> {
    let mut tools: Vec<u32> = found.others.iter().map(|cut| cut.tool).chain([found.tool]).flatten().collect();
    tools.sort_unstable();
    tools.dedup();
    tools
}

/// What more than half of the holes get.
fn most_common(sets: &[Vec<u32>]) -> Option<Vec<u32>> {
    let mut counts: BTreeMap<&Vec<u32>, usize> = BTreeMap::new();
    for set in sets {
        *counts.entry(set).or_default() += 1;
    }
    let (set, count) = counts.into_iter().max_by_key(|(_, count)| *count)?;
    (sets.len() < 2 * count).then(|| set.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_is_what_more_than_half_have() {
        let (both, one) = (vec![1, 2], vec![1]);
        assert_eq!(most_common(&[both.clone(), one.clone(), both.clone()]), Some(both.clone()));
        assert_eq!(most_common(&[both.clone(), one.clone(), both, one]), None);
        assert_eq!(most_common(&[]), None);
    }
}
