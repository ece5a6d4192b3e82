//! Edges that one tool breaks alike in many holes: one warning in place of one for each hole.
use super::common_shift::{MIN_GROUP_SIZE, describe_set};
use super::*;
use crate::findings::FEATURE_EXTRA;
use crate::verify::hole_finding::HoleFinding;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    // What each warning says behind the name of its hole: tool, width and depth.
    let said = |one: &HoleFinding| {
        let Subject::Nominal(nominal) = one.subject else { return None };
        let is_warning = one.finding.kind == &FEATURE_EXTRA && one.finding.severity == Severity::Warning;
        let name = format!("hole {}: ", comparison.id(nominal));
        let said = one.finding.message.strip_prefix(&name).filter(|_| is_warning && !one.is_folded)?;
        Some((said.to_owned(), nominal))
    };
    let mut groups: BTreeMap<String, Vec<(usize, Diagnostic)>> = BTreeMap::new();
    for (one, (said, nominal)) in findings.iter().filter_map(|one| Some((one, said(one)?))) {
        groups.entry(said).or_default().push((nominal, one.finding.clone()));
    }
    for (text, group) in groups.into_iter().filter(|(_, group)| MIN_GROUP_SIZE <= group.len()) {
        let members: Vec<usize> = group.iter().map(|(nominal, _)| *nominal).collect();
        let folded = findings.fold_if(|one| said(one).is_some_and(|(own, _)| own == text));
        let message = format!("{}: {text}", describe_set(comparison, &members));
        let finding = Diagnostic { message, ..group[0].1.clone() };
        let backtrace = finding.backtrace.clone().unwrap_or_default();
        findings.add(Subject::Whole, finish_group_finding(finding, folded, &backtrace));
    }
}
