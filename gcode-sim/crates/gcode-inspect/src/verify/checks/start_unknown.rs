//! Holes cut while the position of an axis is unknown: a finding for each, and one instead for all that lack the same axes.
use super::*;
use crate::holes::unknown_position_finding;
use gcode_lang::motion::UnknownAxes;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, .. } = inspection;
    let matched = comparison.pairs.iter().flat_map(|pair| {
        let both = [Some(pair.actual), pair.from_far_side];
        both.into_iter().flatten().map(|actual| (actual, Subject::Nominal(pair.nominal)))
    });
    let extra =
        comparison.extra.iter().chain(&comparison.repeated).map(|extra| (*extra, Subject::Extra(*extra)));
    let mut by_axes: BTreeMap<UnknownAxes, Vec<(usize, Subject)>> = BTreeMap::new();
    for (actual, subject) in matched.chain(extra) {
        let axes = comparison.actual[actual].unknown_axes;
        if !axes.is_none() {
            by_axes.entry(axes).or_default().push((actual, subject));
        }
    }
    for (axes, mut holes) in by_axes {
        holes.sort();
        let finding = |(actual, subject): (usize, Subject)| {
            let cut = match subject {
                Subject::Nominal(nominal) => format!("hole {} is cut", comparison.id(nominal)),
                Subject::Extra(_) | Subject::Whole | Subject::Motion => "an extra hole is cut".to_owned(),
            };
            let finding = unknown_position_finding(&machine.axes, axes, &cut);
            finding.with_backtrace(comparison.actual[actual].backtrace.clone())
        };
        if let [one] = holes[..] {
            findings.add(one.1, finding(one));
            continue;
        }
        holes.iter().for_each(|one| findings.add_folded(one.1, finding(*one)));
        let group = unknown_position_finding(&machine.axes, axes, &format!("{} holes are cut", holes.len()));
        let first = &comparison.actual[holes[0].0].backtrace;
        findings.put_first([finish_group_finding(group, holes.len(), first)]);
    }
}
