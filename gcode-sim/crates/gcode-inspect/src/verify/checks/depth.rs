//! Every hole must be as deep as wanted.
use super::{Comparison, HoleFinding};
use gcode_lang::diag::Diagnostic;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<HoleFinding>) {
    for pair in &comparison.pairs {
        let error = pair.deviation.depth_error;
        if error.abs() <= comparison.tolerances.depth {
            continue;
        }
        let nominal = comparison.nominal[pair.nominal].depth;
        let message = format!(
            "hole {} is {:.3} mm deep, {nominal} wanted: {:.3} mm too {} ({} allowed)",
            comparison.id(pair.nominal),
            nominal + error,
            error.abs(),
            if error > 0.0 { "deep" } else { "shallow" },
            comparison.tolerances.depth
        );
        let mut finding = Diagnostic::error("hole-depth", message)
            .help("check the programmed depth, the tool's length and its offset")
            .at(comparison.actual[pair.actual].backtrace.clone());
        if let Some(note) = mistaken_factor(nominal, nominal + error) {
            finding = finding.note(note);
        }
        objections.push(HoleFinding::of_nominal(pair.nominal, finding));
    }
}

/// What a depth that is wrong by a factor comes of: a thousandth of the wanted one, or with the finer increment a
/// ten-thousandth; inches for millimetres or the other way.
pub(super) fn mistaken_factor(nominal: f64, actual: f64) -> Option<&'static str> {
    let is = |parts: f64| (actual * parts / nominal - 1.0).abs() < 0.01;
    match () {
        () if is(1e3) => {
            Some("that is a thousandth of it: a number without a decimal point counts thousandths here")
        }
        () if is(1e4) => Some(
            "that is a ten-thousandth of it: a number without a decimal point counts ten-thousandths here",
        ),
        () if (actual / nominal / 25.4 - 1.0).abs() < 0.001 => {
            Some("that is 25.4 times it: millimetres read as inches; is G20 in force where G21 is meant?")
        }
        () if (actual * 25.4 / nominal - 1.0).abs() < 0.001 => Some(
            "that is it divided by 25.4: inches read as millimetres; is G21 in force where G20 is meant?",
        ),
        () => None,
    }
}
