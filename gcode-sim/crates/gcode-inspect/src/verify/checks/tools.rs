//! Tools of holes of one diameter: a hole without a tool that most of the others have lacks a call.
//!
//! The check needs no tool table, so that it finds a missing finishing pass with the numbers of the tools alone. Sister
//! tools are no fault: it only warns.
use super::*;
use crate::findings::{FEATURE_MISSING, HOLE_DEPTH, HOLE_DIAMETER, HOLE_NOT_THROUGH, HOLE_TOOLS};
use crate::verify::hole_finding::HoleFinding;

/// Least number of holes of one diameter.
const MIN_HOLES: usize = 3;

/// Largest number of holes that a message names.
const MAX_NAMED: usize = 8;

/// Findings about a hole that follow from a missing tool.
pub(super) const FOLLOWING_KINDS: [&FindingKind; 4] =
    [&HOLE_DEPTH, &HOLE_DIAMETER, &FEATURE_MISSING, &HOLE_NOT_THROUGH];

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
        // Most holes are made with the tools of the one before.
        let alike = group.chunk_by(|(_, one), (_, next)| tools(one).eq(tools(next)));
        let sets = alike.map(|holes| (tools(holes[0].1).collect(), holes.len()));
        let Some(usual) = most_common(sets, group.len()) else { continue };
        let lacking_holes = report_incomplete(comparison, &usual, &group, f64::from_bits(diameter), findings);
        for (nominal, drilled) in group.into_iter().filter(|(nominal, _)| !lacking_holes.contains(nominal)) {
            let lacking = usual.iter().filter(|tool| tools(drilled).all(|own| own != **tool));
            let lacking: Vec<String> = lacking.map(|tool| format!("T{tool}")).collect();
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
                .with_severity(Severity::Warning)
                .help("check for a missing call")
                .with_backtrace(drilled.backtrace.clone());
            findings.add(Subject::Nominal(nominal), finding);
        }
    }
}

/// Reports the holes that are wrong because a tool is missing in them, and folds what follows from that; returns them.
fn report_incomplete(
    comparison: &Comparison<'_>,
    usual: &BTreeSet<u32>,
    group: &[(usize, &DrilledHole)],
    diameter: f64,
    findings: &mut HoleFindings,
) -> BTreeSet<usize> {
    let follows = |one: &&HoleFinding| FOLLOWING_KINDS.contains(&one.finding.kind) && !one.is_folded;
    let wrong: BTreeSet<Subject> = findings.iter().filter(follows).map(|one| one.subject).collect();
    let mut by_lack: BTreeMap<Vec<u32>, Vec<usize>> = BTreeMap::new();
    for (nominal, drilled) in group.iter().filter(|(nominal, _)| wrong.contains(&Subject::Nominal(*nominal)))
    {
        let own: BTreeSet<u32> = tools(drilled).collect();
        let lacking: Vec<u32> = usual.difference(&own).copied().collect();
        // Another tool in its place is a wrong tool.
        if !lacking.is_empty() && own.is_subset(usual) {
            by_lack.entry(lacking).or_default().push(*nominal);
        }
    }
    let mut all = BTreeSet::new();
    for (lacking, holes) in by_lack {
        let names = lacking.iter().map(|tool| format!("T{tool}")).collect::<Vec<_>>().join(", ");
        let verb = if lacking.len() == 1 { "is" } else { "are" };
        let noun = if group.len() == 1 { "hole" } else { "holes" };
        let summary = format!("{names} {verb} missing in {} of {} {noun}", holes.len(), group.len());
        let shown = holes.iter().take(MAX_NAMED).map(|nominal| comparison.id(*nominal));
        let mut shown: Vec<String> = shown.map(str::to_owned).collect();
        if MAX_NAMED < holes.len() {
            shown.push(format!("{} more", holes.len() - MAX_NAMED));
        }
        let subjects: BTreeSet<Subject> = holes.iter().map(|nominal| Subject::Nominal(*nominal)).collect();
        let folded = findings.fold(&FOLLOWING_KINDS, |subject| subjects.contains(&subject));
        let message = format!("{summary} of Φ{diameter}: {}", shown.join(", "));
        let mut finding = Diagnostic::new(&HOLE_TOOLS, message)
            .help(format!("call {names} for these holes too: the block is where it makes the others"));
        finding.notes.extend(folded_note(folded));
        let makes = |drilled: &DrilledHole| {
            let mut passes = drilled.passes();
            passes
                .find(|pass| pass.tool.is_some_and(|tool| lacking.contains(&tool)))
                .map(|pass| pass.backtrace.clone())
        };
        if let Some(place) = group.iter().find_map(|(_, drilled)| makes(drilled)) {
            finding = locate_at_call(finding, &place);
        }
        findings.add_summed(Subject::Whole, finding, summary);
        all.extend(holes);
    }
    all
}

/// Returns the tools that cut a hole.
fn tools(drilled: &DrilledHole) -> impl Iterator<Item = u32> + '_ {
    drilled.earlier_passes.iter().map(|pass| pass.tool).chain([drilled.tool]).flatten()
}

/// Returns the set that more than half of `all` holes have; each set comes with the number of its holes, and may come again.
fn most_common(sets: impl Iterator<Item = (BTreeSet<u32>, usize)>, all: usize) -> Option<BTreeSet<u32>> {
    let mut counts: BTreeMap<BTreeSet<u32>, usize> = BTreeMap::new();
    sets.for_each(|(set, holes)| *counts.entry(set).or_default() += holes);
    counts.into_iter().find(|(_, count)| all < 2 * count).map(|(set, _)| set)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_tools_are_those_of_more_than_half_of_the_holes() {
        let (both, one) = (BTreeSet::from([1, 2]), BTreeSet::from([1]));
        let sets = [(both.clone(), 1), (one.clone(), 3), (both.clone(), 3)];
        assert_eq!(most_common(sets.into_iter(), 7), Some(both.clone()));
        assert_eq!(most_common([(both, 2), (one, 2)].into_iter(), 4), None);
        assert_eq!(most_common(std::iter::empty(), 0), None);
    }
}
