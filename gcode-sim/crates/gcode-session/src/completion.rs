//! Completion of a verdict by what its run shows: likely causes, a missing end, assumptions.
use super::{Request, Run, causes};
use gcode_control::Outcome;
use gcode_inspect::findings::NO_END;
use gcode_inspect::verify::{Answer, AnyVerdict};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_part::Assumption;

/// Completes a verdict; `causes` are likely causes besides those in the program's text.
pub(super) fn complete(
    verdict: &mut impl AnyVerdict,
    request: &Request,
    run: &Run,
    mut causes: Vec<Diagnostic>,
    assumptions: impl FnOnce() -> Vec<(Assumption, Backtrace)>,
) {
    let locate = |span| run.locate(span);
    if let Some(error) = missing_end(run) {
        verdict.add_error(error, &locate);
    }
    // Without a finding only a number without its point is looked for, where the text has one.
    if verdict.has_findings() || causes::may_lack_points(run) {
        causes.extend(causes::text_findings(run, verdict.answer() == Answer::Fail));
    }
    verdict.add_likely_causes(causes, &locate);
    let assumptions = assumptions();
    if let Some(error) = interruption(run) {
        verdict.add_error(error, &locate);
    }
    verdict.add_assumptions(assumptions, request.denies_assumptions, &locate);
}

/// Returns the error of an interruption behind the first run, whose assumptions are then not complete.
fn interruption(run: &Run) -> Option<Diagnostic> {
    let is_interrupted = matches!(run.outcome, Outcome::End) && run.control.is_cancelled();
    let message = "interrupted before the values were followed on which the result rests";
    is_interrupted.then(|| Diagnostic::new(&LIMIT, message).with_backtrace(run.control.backtrace()))
}

/// Returns the error of a program without M02, M30 or M99 that has run to the end of its text.
fn missing_end(run: &Run) -> Option<Diagnostic> {
    let lacks_end = matches!(run.outcome, Outcome::End) && run.control.lacks_end();
    let message =
        "the text ends without M02, M30 or M99: a control stops with PS5010, and blocks may be missing";
    let finding = || Diagnostic::new(&NO_END, message).with_backtrace(run.control.backtrace());
    lacks_end
        .then(|| finding().help("write M30 at the end of the program; transfer it again if it was cut off"))
}
