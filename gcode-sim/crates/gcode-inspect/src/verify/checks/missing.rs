//! Nominal holes that are not drilled, each with the nearest extra hole.
use super::*;
use crate::findings::HOLE_MISSING;
use crate::verify::bottom;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    // A repeated hole is not a missing one in a wrong position.
    let extra = comparison.extra.iter().filter(|index| comparison.nominal_on_line_of(**index).is_none());
    let extra: Vec<&DrilledHole> = extra.map(|index| &comparison.actual[*index]).collect();
    let tree = PointTree::new(extra.iter().map(|hole| hole.bottom()));
    let left_out = comparison.in_air.first().map(|index| &comparison.actual[*index]);
    let left_out = left_out.map(|hole| (hole.bottom(), hole.backtrace.clone()));
    let beside = left_out.or_else(|| inspection.extraction.feeds_in_air.first().cloned());
    for nominal in &comparison.missing {
        let end = bottom(&comparison.nominal[*nominal]);
        let finding = Diagnostic::new(&HOLE_MISSING, format!("hole {} is missing", comparison.id(*nominal)));
        let finding = match tree.nearest(&end) {
            Some((near, distance)) => {
                let off = extra[near].bottom() - end;
                finding
                    .note(format!(
                        "the nearest extra hole ends {distance:.3} mm away; actual − nominal: x {:+.3}, y \
                         {:+.3}, z {:+.3} mm",
                        off.x, off.y, off.z
                    ))
                    .help("if that hole is the intended one, correct its position; otherwise add the missing hole")
                    .with_backtrace(extra[near].backtrace.clone())
            }
            None => match &beside {
                Some((end, backtrace)) => finding
                    .note(format!(
                        "the feed to x {:.3} y {:.3} z {:.3} on the part goes beside it and cuts nothing",
                        end.x, end.y, end.z
                    ))
                    .help("if that feed is for the hole, correct its position; otherwise add the hole")
                    .with_backtrace(backtrace.clone()),
                None => finding.help("add the hole to the program"),
            },
        };
        findings.add(Subject::Nominal(*nominal), finding);
    }
}
