//! Speed of the wheel, and its feed into the blank: those of the job.
use super::*;
use crate::findings::{WHEEL_FEED, WHEEL_SPEED};
use crate::verify::checks::cutting::{round_thousandth, severity};
use gcode_lang::motion::Backtrace;

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (nominal, actual) = (inspection.nominal, inspection.actual);
    if let Some(nominal) = nominal.wheel {
        let speeds = actual.passes.iter().enumerate().flat_map(|(index, pass)| {
            pass.speeds
                .iter()
                .map(move |(speed, at)| (speed.0, &at.backtrace, Site::new(Some(index), at.point)))
        });
        let message = |actual| format!("the wheel grinds at S{actual}; the job specifies S{nominal}");
        let finding = report_worst(&WHEEL_SPEED, nominal, speeds, message);
        findings.extend(finding.map(|finding| finding.help("correct S, or program.wheel in the job")));
    }
    if let Some(nominal) = nominal.plunge {
        let plunges = actual
            .plunges
            .iter()
            .map(|plunge| (plunge.speed, &plunge.backtrace, Site::new(None, plunge.point)));
        let message = |actual| {
            format!("the wheel is fed into the blank at {actual} mm/min; the job specifies {nominal} mm/min")
        };
        let help = "correct F, or program.plunge in the job; check that G94 is in force here, and not G93";
        let finding = report_worst(&WHEEL_FEED, nominal, plunges, message);
        findings.extend(finding.map(|finding| finding.help(help)));
    }
}

/// Returns one finding for all wrong values, at the one that is most too fast or too slow.
fn report_worst<'g>(
    kind: &'static FindingKind,
    nominal: f64,
    values: impl Iterator<Item = (f64, &'g Backtrace, Site)>,
    message: impl Fn(f64) -> String,
) -> Option<Diagnostic> {
    let factor = |actual: f64| (actual / nominal).max(nominal / actual);
    let wrong: Vec<_> = values.filter(|(actual, ..)| severity(*actual, nominal).is_some()).collect();
    // The first of those that differ by rounding only.
    let most = wrong.iter().map(|(actual, ..)| factor(*actual)).fold(0.0, f64::max);
    let (actual, backtrace, _) = *wrong.iter().find(|(actual, ..)| most <= factor(*actual) * (1.0 + 1e-9))?;
    let finding = Diagnostic::new(kind, message(round_thousandth(actual)))
        .with_severity(severity(actual, nominal)?)
        .with_backtrace(backtrace.clone())
        .with_sites(wrong.iter().map(|(.., site)| *site));
    let more = wrong.len() - 1;
    let note = (0 < more).then(|| format!("the same or a smaller difference occurs {more} more times"));
    Some(note.into_iter().fold(finding, Diagnostic::note))
}
