//! Nominal holes that are not drilled, each with the nearest extra hole.
use super::*;
use crate::findings::{HOLE_MISSING, MAIN_PROGRAM};
use crate::holes::BackBored;
use crate::machine::COS_30;
use crate::verify::bottom;

/// Cosine of the largest angle between holes of one side of the part: 30°.
const MIN_SIDE_COSINE: f64 = COS_30;

/// Steps of a component of a direction.
const DIRECTION_STEPS: f64 = 100.0;

/// Largest distance from the axis of a hole at which a feed is on it, mm.
const ON_AXIS: f64 = 0.5;

/// Largest distance between two bottoms that are one, mm.
const SAME_POINT: f64 = 0.01;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    // A repeated hole is not a missing one in a wrong position.
    let extra = comparison.extra.iter().filter(|index| comparison.nominal_on_line_of(**index).is_none());
    let extra: Vec<&DrilledHole> = extra.map(|index| &comparison.actual[*index]).collect();
    let tree = PointTree::new(extra.iter().map(|hole| hole.bottom()));
    let left_out = comparison.in_air.first().map(|index| &comparison.actual[*index]);
    let left_out = left_out.map(|hole| (hole.bottom(), hole.backtrace.clone()));
    let beside = left_out.or_else(|| inspection.extraction.feeds_in_air.first().cloned());
    let directions: BTreeSet<[i32; 3]> = comparison.actual.iter().map(|hole| rounded(&hole.axis)).collect();
    let has_direction = |nominal: &Hole| {
        let out = Vector3::from(nominal.axis);
        let cosine = |one: &[i32; 3]| Vector3::from(one.map(f64::from)).dot(&out) / DIRECTION_STEPS;
        directions.is_empty() || directions.iter().any(|one| MIN_SIDE_COSINE <= cosine(one))
    };
    let is_choice_open = comparison.actual.is_empty()
        && inspection.extraction.findings.iter().any(|finding| finding.kind == &MAIN_PROGRAM);
    for nominal in &comparison.missing {
        let end = bottom(&comparison.nominal[*nominal]);
        let finding = Diagnostic::new(&HOLE_MISSING, format!("hole {} is missing", comparison.id(*nominal)));
        let out = Vector3::from(comparison.nominal[*nominal].axis);
        let is_it =
            |bore: &&BackBored| COS_30 < bore.out.dot(&out) && (bore.end - end).cross(&out).norm() <= ON_AXIS;
        let back_bored = inspection.extraction.back_bored.iter().find(is_it);
        let finding = match (tree.nearest(&end), back_bored) {
            (_, Some(bore)) => finding
                .note("a bore on its axis is made backwards: only what is open on the tool's side is compared with the list")
                .help("remove the row, and check the bore in the picture or on the review page; the verdict names it as not checked")
                .with_backtrace(bore.backtrace.clone()),
            _ if beside.is_none() && !has_direction(&comparison.nominal[*nominal]) => finding
                .note("no tool cuts from its side of the part")
                .help("check the angle of the table or of the head, and whether the program commands it"),
            (Some((near, distance)), None) => {
                let off = extra[near].bottom() - end;
                if let Some(height) = height_above(&comparison.nominal[*nominal], &off) {
                    finding
                        .note(format!("the feed on its axis ends {height:.3} mm above its entry"))
                        .help("check Z and R of the cycle: in G91 R counts from the level before it, and Z from R")
                        .with_backtrace(extra[near].backtrace.clone())
                } else if let Some(below) = below_entry(&comparison.nominal[*nominal], extra[near], &off) {
                    finding
                        .note(format!(
                            "a hole on its axis ends at the same bottom; only the entries differ: that of the list is {below:.3} mm above \
                             the start of the feed"
                        ))
                        .help(
                            "if the program mills down to there first, the hole begins at that floor: correct z and the depths of the \
                             list; otherwise begin the feed above the entry",
                        )
                        .with_backtrace(extra[near].backtrace.clone())
                } else {
                    finding
                        .note(format!(
                            "the nearest extra hole ends {distance:.3} mm away; actual − nominal: x {:+.3}, y \
                             {:+.3}, z {:+.3} mm",
                            off.x, off.y, off.z
                        ))
                        .help("if that hole is the intended one, correct its position; otherwise add the missing hole")
                        .with_backtrace(extra[near].backtrace.clone())
                }
            }
            (None, None) => match &beside {
                Some((end, backtrace)) => finding
                    .note(format!(
                        "the feed to x {:.3} y {:.3} z {:.3} on the part goes beside it and cuts nothing",
                        end.x, end.y, end.z
                    ))
                    .help("if that feed is for the hole, correct its position; otherwise add the hole")
                    .with_backtrace(backtrace.clone()),
                None if is_choice_open => finding.help("choose the program that makes it with --program"),
                None => finding.help("add the hole to the program"),
            },
        };
        findings.add(Subject::Nominal(*nominal), finding);
    }
}

/// Returns a direction in steps, so that many holes have the same.
fn rounded(axis: &Unit<Vector3<f64>>) -> [i32; 3] {
    axis.into_inner().map(|part| (part * DIRECTION_STEPS).round() as i32).into()
}

/// Returns how far above the entry of a hole a feed on its axis ends, by the offset of that end from the bottom.
fn height_above(nominal: &Hole, off: &Vector3<f64>) -> Option<f64> {
    let out = Vector3::from(nominal.axis);
    let (height, aside) = (off.dot(&out) - nominal.depth, off.cross(&out).norm());
    (0.0 < height && aside <= ON_AXIS).then_some(height)
}

/// Returns how far below the entry of a hole a feed on its axis begins that ends at its bottom.
fn below_entry(nominal: &Hole, actual: &DrilledHole, off: &Vector3<f64>) -> Option<f64> {
    let out = Vector3::from(nominal.axis);
    let below = (Point3::from(nominal.entry) - actual.entry).dot(&out);
    (0.0 < below && off.norm() <= SAME_POINT && COS_30 < actual.axis.dot(&out)).then_some(below)
}
