//! The wheel turns and goes into the blank as fast as the job says.
use super::super::Inspection;
use crate::diag::{Diagnostic, Site};
use crate::motion::Place;
use crate::verify::checks::cutting::severity;

/// Something that the program does, and where.
struct Done<'g> {
    found: f64,
    place: &'g Place,
    site: Site,
}

pub(super) fn check(inspection: &Inspection<'_>, findings: &mut Vec<Diagnostic>) {
    let (wanted, ground) = (inspection.wanted, inspection.ground);
    if let Some(wanted) = wanted.wheel {
        let passes = ground.passes.iter().enumerate();
        let speeds = passes.flat_map(|(index, pass)| {
            pass.speeds.iter().map(move |(speed, begun)| Done {
                found: speed.0,
                place: &begun.place,
                site: Site { pass: Some(index), at: begun.at },
            })
        });
        let message = |found| format!("the wheel grinds at S{found}; the job specifies S{wanted}");
        let told = worst("wheel-speed", wanted, speeds.collect(), message);
        findings.extend(told.map(|finding| finding.help("correct S, or program.wheel in the job")));
    }
    if let Some(wanted) = wanted.plunge {
        let plunges = ground.plunges.iter().map(|plunge| Done {
            found: plunge.speed,
            place: &plunge.place,
            site: Site { pass: None, at: plunge.at },
        });
        let message = |found| {
            format!("the wheel is fed into the blank at {found} mm/min; the job specifies {wanted} mm/min")
        };
        let told = worst("wheel-feed", wanted, plunges.collect(), message);
        findings.extend(told.map(|finding| {
            finding
                .help("correct F, or program.plunge in the job; check that G94 is in force here, and not G93")
        }));
    }
}

/// One finding at the one that is most times too fast or too slow.
fn worst(
    code: &'static str,
    wanted: f64,
    all: Vec<Done<'_>>,
    message: impl Fn(f64) -> String,
) -> Option<Diagnostic> {
    let times = |done: &Done<'_>| (done.found / wanted).max(wanted / done.found);
    let wrong: Vec<Done<'_>> =
        all.into_iter().filter(|done| severity(done.found, wanted).is_some()).collect();
    // Of those that only rounding tells apart, the first.
    let most = wrong.iter().map(times).fold(0.0, f64::max);
    let first = wrong.iter().find(|done| most <= times(done) * (1.0 + 1e-9))?;
    let shown = (first.found * 1e3).round() / 1e3;
    let finding = Diagnostic::new(severity(first.found, wanted)?, code, message(shown));
    let finding = match wrong.len() - 1 {
        0 => finding,
        more => finding.note(format!("the same or a smaller difference occurs {more} more times")),
    };
    Some(finding.at(first.place.clone()).on(wrong.iter().map(|done| done.site)))
}
