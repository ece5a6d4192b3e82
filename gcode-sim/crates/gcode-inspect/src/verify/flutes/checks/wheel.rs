//! The wheel turns and goes into the blank as fast as the job says.
use super::super::Inspection;
use crate::findings::{WHEEL_FEED, WHEEL_SPEED};
use crate::verify::checks::cutting::severity;
use gcode_lang::diag::{Diagnostic, FindingKind, Site};
use gcode_lang::motion::Backtrace;

/// Something that the program does, and where.
struct ActualValue<'g> {
    actual: f64,
    place: &'g Backtrace,
    site: Site,
}

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (wanted, ground) = (inspection.nominal, inspection.actual);
    if let Some(wanted) = wanted.wheel {
        let passes = ground.passes.iter().enumerate();
        let speeds = passes.flat_map(|(index, pass)| {
            pass.speeds.iter().map(move |(speed, begun)| ActualValue {
                actual: speed.0,
                place: &begun.backtrace,
                site: Site::new(Some(index), begun.point),
            })
        });
        let message = |found| format!("the wheel grinds at S{found}; the job specifies S{wanted}");
        let told = report_worst(&WHEEL_SPEED, wanted, speeds.collect(), message);
        findings.extend(told.map(|finding| finding.help("correct S, or program.wheel in the job")));
    }
    if let Some(wanted) = wanted.plunge {
        let plunges = ground.plunges.iter().map(|plunge| ActualValue {
            actual: plunge.speed,
            place: &plunge.backtrace,
            site: Site::new(None, plunge.point),
        });
        let message = |found| {
            format!("the wheel is fed into the blank at {found} mm/min; the job specifies {wanted} mm/min")
        };
        let told = report_worst(&WHEEL_FEED, wanted, plunges.collect(), message);
        findings.extend(told.map(|finding| {
            finding
                .help("correct F, or program.plunge in the job; check that G94 is in force here, and not G93")
        }));
    }
}

/// One finding at the one that is most times too fast or too slow.
fn report_worst(
    kind: &'static FindingKind,
    nominal: f64,
    all: Vec<ActualValue<'_>>,
    message: impl Fn(f64) -> String,
) -> Option<Diagnostic> {
    let times = |done: &ActualValue<'_>| (done.actual / nominal).max(nominal / done.actual);
    let wrong: Vec<ActualValue<'_>> =
        all.into_iter().filter(|done| severity(done.actual, nominal).is_some()).collect();
    // Of those that only rounding tells apart, the first.
    let most = wrong.iter().map(times).fold(0.0, f64::max);
    let first = wrong.iter().find(|done| most <= times(done) * (1.0 + 1e-9))?;
    let shown = (first.actual * 1e3).round() / 1e3;
    let finding = Diagnostic::new(kind, message(shown)).with_severity(severity(first.actual, nominal)?);
    let finding = match wrong.len() - 1 {
        0 => finding,
        more => finding.note(format!("the same or a smaller difference occurs {more} more times")),
    };
    Some(finding.with_backtrace(first.place.clone()).with_sites(wrong.iter().map(|done| done.site)))
}
