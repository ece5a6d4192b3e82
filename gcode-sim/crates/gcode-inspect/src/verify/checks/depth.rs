//! Depth of each hole.
use super::*;
use crate::findings::{FEATURE_DEPTH, HOLE_DEPTH};
use crate::holes::PassCut;
use crate::machine::tool_name;
use gcode_lang::motion::Backtrace;
use gcode_part::{Feature, NOISE};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    check_tools(inspection, findings);
    let comparison = &inspection.comparison;
    for (pair, nominal, drilled) in comparison.matched() {
        let error = pair.deviation.depth_error;
        // The check on features covers each of them, but not a point or a pilot below all of them.
        let deepest = nominal.features.iter().map(Feature::bottom).reduce(f64::max);
        let is_feature = deepest.is_some_and(|deepest| !exceeds(nominal.depth, deepest));
        if nominal.through || is_feature || !exceeds(error.abs(), comparison.tolerances.depth) {
            continue;
        }
        let depth = nominal.depth + error;
        let (id, limit) = (comparison.id(pair.nominal), comparison.tolerances.depth);
        let (nominal_depth, side) = (nominal.depth, if error > 0.0 { "deep" } else { "shallow" });
        let off = format!("{:.3} mm too {side} (tolerance ±{limit})", error.abs());
        let message = match depth < 0.0 {
            true => format!(
                "the feed at hole {id} ends {:.3} mm above its entry, nominal {nominal_depth} deep: {off}",
                -depth
            ),
            false => format!("hole {id} is {depth:.3} mm deep, nominal {nominal_depth}: {off}"),
        };
        let finding = Diagnostic::new(&HOLE_DEPTH, message)
            .help("check the programmed depth, the tool length and its offset")
            .with_backtrace(deepest_pass(drilled).clone());
        let note = mistaken_factor(nominal.depth, depth);
        findings.add(Subject::Nominal(pair.nominal), note.into_iter().fold(finding, Diagnostic::note));
    }
}

/// Reports tools that go deeper or less deep than their own specified depth, as a centre drill that is fed through.
fn check_tools(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let (comparison, limits) = (&inspection.comparison, &inspection.reference.process_limits);
    let limit = comparison.tolerances.depth;
    for (pair, nominal, drilled) in comparison.matched() {
        let [entry, out] = [nominal.entry, nominal.axis].map(Vector3::from);
        for pass in drilled.passes() {
            let specified =
                pass.tool.and_then(|tool| limits.tool_process(Some(tool))).and_then(|one| one.depth);
            let Some(specified) = specified else { continue };
            let depth = (entry - pass.cut.bottom.coords).dot(&out);
            if !exceeds((depth - specified).abs(), limit) {
                continue;
            }
            let (tool, id) = (tool_name(pass.tool), comparison.id(pair.nominal));
            let message = format!(
                "{tool} goes {depth:.3} mm deep in hole {id}, nominal {specified} for this tool (tolerance ±{limit})"
            );
            let finding = Diagnostic::new(&FEATURE_DEPTH, message)
                .help("correct the depth in the call of this tool, or the tool's depth in the job")
                .with_backtrace(pass.backtrace.clone());
            findings.add(Subject::Nominal(pair.nominal), finding);
        }
    }
}

/// Returns the block of the deepest pass; the finishing one if it is as deep.
fn deepest_pass(drilled: &DrilledHole) -> &Backtrace {
    let height = |cut: &PassCut| cut.bottom.coords.dot(&drilled.axis);
    let others = drilled.earlier_passes.iter();
    let lowest = others.min_by(|a, b| height(&a.cut).total_cmp(&height(&b.cut)));
    let deeper = lowest.filter(|pass| height(&pass.cut) < height(&drilled.finishing_cut) - NOISE);
    deeper.map_or(&drilled.backtrace, |pass| &pass.backtrace)
}

/// Returns the cause of a depth that is wrong by a factor: a missing decimal point, or inches and millimetres confused.
pub(super) fn mistaken_factor(nominal: f64, actual: f64) -> Option<&'static str> {
    const CAUSES: [(f64, f64, &str); 4] = [
        (
            1e3,
            0.01,
            "this is a thousandth of the nominal depth: a number without a decimal point counts thousandths here",
        ),
        (
            1e4,
            0.01,
            "this is a ten-thousandth of the nominal depth: a number without a decimal point counts \
             ten-thousandths here",
        ),
        (
            1.0 / 25.4,
            0.001,
            "this is 25.4 times the nominal depth: millimetres read as inches; check whether G20 is in \
             force instead of G21",
        ),
        (
            25.4,
            0.001,
            "this is the nominal depth divided by 25.4: inches read as millimetres; check whether G21 is \
             in force instead of G20",
        ),
    ];
    let is_cause =
        |(factor, tolerance, _): &&(f64, f64, &str)| (actual * factor / nominal - 1.0).abs() < *tolerance;
    CAUSES.iter().find(is_cause).map(|(.., words)| *words)
}
