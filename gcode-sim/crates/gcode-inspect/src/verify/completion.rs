//! Completion of a verdict by what the comparison doesn't see: likely causes, errors of the whole program, assumptions.
use super::assumption::{denied_assumptions, denied_words};
use super::conclusion::{Answer, SummaryWords};
use super::verdict_finding::{Finding, finding_of, limit_per_kind};
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};
use gcode_lang::motion::Backtrace;
use gcode_lang::source::Span;
use gcode_part::{Assumption, Total};

/// Parts that every kind of verdict has.
#[derive(Debug)]
pub struct VerdictParts<'v> {
    pub(super) answer: &'v mut Answer,
    pub(super) summary: &'v mut String,
    pub(super) words: &'v mut SummaryWords,
    pub(super) likely_causes: &'v mut Vec<String>,
    pub(super) findings: &'v mut Vec<Finding>,
    pub(super) diagnostics: &'v mut Vec<Diagnostic>,
    pub(super) assumptions: &'v mut Vec<Assumption>,
    /// Number of all holes or flutes.
    pub(super) total: Total,
}

/// Verdict on holes or on flutes.
pub trait AnyVerdict {
    /// Returns the parts that every kind of verdict has.
    fn parts(&mut self) -> VerdictParts<'_>;

    /// Returns the answer.
    fn answer(&mut self) -> Answer {
        *self.parts().answer
    }

    /// Returns true if there is a finding above a note.
    fn has_findings(&mut self) -> bool {
        self.parts().diagnostics.iter().any(|finding| Severity::Warning <= finding.severity)
    }

    /// Removes the findings of a kind and returns them.
    fn take_findings(&mut self, kind: &'static FindingKind) -> Vec<Diagnostic> {
        let parts = self.parts();
        parts.findings.retain(|finding| finding.code != kind.code);
        parts.diagnostics.extract_if(.., |finding| finding.kind == kind).collect()
    }

    /// Inserts findings about the program's text before those that they may explain; the answer stays.
    fn add_likely_causes(&mut self, causes: Vec<Diagnostic>, locate: &dyn Fn(Span) -> (String, u32)) {
        let mut parts = self.parts();
        if *parts.answer == Answer::Fail {
            *parts.likely_causes = cause_sentences(&causes, locate);
        }
        let before = causes.iter().map(|cause| finding_of(cause, None, true, locate));
        parts.findings.splice(0..0, before);
        // What stopped the run explains the rest.
        let alarms =
            parts.diagnostics.iter().take_while(|finding| finding.severity == Severity::Alarm).count();
        parts.diagnostics.splice(alarms..alarms, limit_per_kind(causes.into_iter()));
        parts.update_summary();
    }

    /// Adds an error of the whole program, with its words in the summary.
    fn add_error(&mut self, error: Diagnostic, locate: &dyn Fn(Span) -> (String, u32)) {
        let words = error.kind.title.to_owned();
        self.parts().add_errors(vec![error], words, locate);
    }

    /// Adds the assumptions; each is an error if they are denied.
    fn add_assumptions(
        &mut self,
        assumptions: Vec<(Assumption, Backtrace)>,
        is_denied: bool,
        locate: &dyn Fn(Span) -> (String, u32),
    ) {
        let mut parts = self.parts();
        if is_denied && !assumptions.is_empty() {
            let denied = denied_assumptions(&assumptions, parts.total);
            parts.add_errors(denied, denied_words(assumptions.len()), locate);
        }
        parts.assumptions.extend(assumptions.into_iter().map(|(assumption, _)| assumption));
        parts.update_summary();
    }
}

impl VerdictParts<'_> {
    fn add_errors(&mut self, errors: Vec<Diagnostic>, words: String, locate: &dyn Fn(Span) -> (String, u32)) {
        self.findings.extend(errors.iter().map(|error| finding_of(error, None, true, locate)));
        self.diagnostics.extend(limit_per_kind(errors.into_iter()));
        *self.answer = Answer::Fail;
        self.words.added_errors.push(words);
        self.update_summary();
    }

    /// Writes the summary again; whatever changes another part calls this.
    pub(super) fn update_summary(&mut self) {
        *self.summary = self.words.line(*self.answer, self.findings, self.assumptions);
    }
}

/// Returns the messages of likely causes with their places: `X25 … is 0.025 mm (O0001 line 5)`.
fn cause_sentences(causes: &[Diagnostic], locate: &dyn Fn(Span) -> (String, u32)) -> Vec<String> {
    let sentence = |cause: &Diagnostic| match &cause.backtrace {
        Some(place) => {
            let (program, line) = locate(place.block);
            format!("{} ({program} line {line})", cause.message)
        }
        None => cause.message.clone(),
    };
    causes.iter().map(sentence).collect()
}
