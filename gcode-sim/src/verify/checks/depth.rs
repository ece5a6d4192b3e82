//! Every hole must be as deep as wanted.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    for pair in &comparison.pairs {
        let error = pair.deviation.depth_error;
        if error.abs() <= comparison.tolerances.depth {
            continue;
        }
        let nominal = comparison.wanted[pair.wanted].depth;
        let message = format!(
            "hole {} is {:.3} mm deep, nominal {nominal}: {:.3} mm too {} (tolerance ±{})",
            comparison.id(pair.wanted),
            nominal + error,
            error.abs(),
            if error > 0.0 { "deep" } else { "shallow" },
            comparison.tolerances.depth
        );
        let mut finding = Diagnostic::error("hole-depth", message)
            .help("check the programmed depth, the tool length and its offset")
            .at(comparison.found[pair.found].place.clone());
        if let Some(note) = factor(nominal, nominal + error) {
            finding = finding.note(note);
        }
        objections.push(Objection::of(pair.wanted, finding));
    }
}

/// What a depth that is wrong by a factor comes of: a thousandth of the wanted one, or with the finer increment a
/// ten-thousandth; inches for millimetres or the other way.
pub(super) fn factor(wanted: f64, found: f64) -> Option<&'static str> {
    let is = |parts: f64| (found * parts / wanted - 1.0).abs() < 0.01;
    match () {
        () if is(1e3) => Some(
            "this is a thousandth of the nominal depth: a number without a decimal point counts thousandths here",
        ),
        () if is(1e4) => Some(
            "this is a ten-thousandth of the nominal depth: a number without a decimal point counts \
             ten-thousandths here",
        ),
        () if (found / wanted / 25.4 - 1.0).abs() < 0.001 => Some(
            "this is 25.4 times the nominal depth: millimetres read as inches; check whether G20 is in \
             force instead of G21",
        ),
        () if (found * 25.4 / wanted - 1.0).abs() < 0.001 => Some(
            "this is the nominal depth divided by 25.4: inches read as millimetres; check whether G21 is \
             in force instead of G20",
        ),
        () => None,
    }
}
