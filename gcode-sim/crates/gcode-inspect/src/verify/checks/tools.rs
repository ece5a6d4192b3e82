//! Tools of holes of one diameter: a hole without a tool that most of the others have lacks a call.
//!
//! The check needs no tool table, so that it finds a missing finishing pass with the numbers of the tools alone. Sister
//! tools are no fault: it only warns.
use super::*;
use crate::findings::HOLE_TOOLS;

/// Least number of holes of one diameter.
const MIN_HOLES: usize = 3;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    // The diameters are those of the drawing: equal ones have equal bits.
    let mut by_diameter: BTreeMap<u64, Vec<(usize, &DrilledHole)>> = BTreeMap::new();
    for (pair, nominal, drilled) in comparison.matched() {
        if let Some(diameter) = nominal.diameter {
            by_diameter.entry(diameter.to_bits()).or_default().push((pair.nominal, drilled));
        }
    }
    for (diameter, group) in by_diameter.into_iter().filter(|(_, group)| MIN_HOLES <= group.len()) {
        let Some(usual) = most_common(group.iter().map(|(_, drilled)| tools(drilled).collect())) else {
            continue;
        };
        for (nominal, drilled) in group {
            let own: BTreeSet<u32> = tools(drilled).collect();
            let lacking: Vec<String> = usual.difference(&own).map(|tool| format!("T{tool}")).collect();
            if lacking.is_empty() {
                continue;
            }
            let message = format!(
                "hole {} is made without {}; most holes of Φ{} are made with it",
                comparison.id(nominal),
                lacking.join(", "),
                f64::from_bits(diameter)
            );
            let finding = Diagnostic::new(&HOLE_TOOLS, message)
                .help("check for a missing call")
                .with_backtrace(drilled.backtrace.clone());
            findings.add(Subject::Nominal(nominal), finding);
        }
    }
}

/// Returns the tools that cut a hole.
fn tools(drilled: &DrilledHole) -> impl Iterator<Item = u32> + '_ {
    drilled.earlier_passes.iter().map(|pass| pass.tool).chain([drilled.tool]).flatten()
}

/// Returns the set that more than half of the holes have.
fn most_common(holes: impl ExactSizeIterator<Item = BTreeSet<u32>>) -> Option<BTreeSet<u32>> {
    let all = holes.len();
    let mut counts: BTreeMap<BTreeSet<u32>, usize> = BTreeMap::new();
    holes.for_each(|set| *counts.entry(set).or_default() += 1);
    counts.into_iter().find(|(_, count)| all < 2 * count).map(|(set, _)| set)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_tools_are_those_of_more_than_half_of_the_holes() {
        let (both, one) = (BTreeSet::from([1, 2]), BTreeSet::from([1]));
        assert_eq!(most_common([both.clone(), one.clone(), both.clone()].into_iter()), Some(both.clone()));
        assert_eq!(most_common([both.clone(), one.clone(), both, one].into_iter()), None);
        assert_eq!(most_common(std::iter::empty::<BTreeSet<u32>>()), None);
    }
}
