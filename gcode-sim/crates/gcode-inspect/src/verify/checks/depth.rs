//! Every hole must be as deep as wanted.
use super::{HoleFinding, HoleInspection};
use crate::findings::HOLE_DEPTH;
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    for pair in &comparison.pairs {
        let error = pair.deviation.depth_error;
        if error.abs() <= comparison.tolerances.depth {
            continue;
        }
        let nominal = comparison.nominal[pair.nominal].depth;
        let message = format!(
            "hole {} is {:.3} mm deep, nominal {nominal}: {:.3} mm too {} (tolerance ±{})",
            comparison.id(pair.nominal),
            nominal + error,
            error.abs(),
            if error > 0.0 { "deep" } else { "shallow" },
            comparison.tolerances.depth
        );
        let mut finding = Diagnostic::new(&HOLE_DEPTH, message)
            .help("check the programmed depth, the tool length and its offset")
            .with_backtrace(comparison.actual[pair.actual].backtrace.clone());
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
        () if is(1e3) => Some(
            "this is a thousandth of the nominal depth: a number without a decimal point counts thousandths here",
        ),
        () if is(1e4) => Some(
            "this is a ten-thousandth of the nominal depth: a number without a decimal point counts \
             ten-thousandths here",
        ),
        () if (actual / nominal / 25.4 - 1.0).abs() < 0.001 => Some(
            "this is 25.4 times the nominal depth: millimetres read as inches; check whether G20 is in \
             force instead of G21",
        ),
        () if (actual * 25.4 / nominal - 1.0).abs() < 0.001 => Some(
            "this is the nominal depth divided by 25.4: inches read as millimetres; check whether G21 is \
             in force instead of G20",
        ),
        () => None,
    }
}
