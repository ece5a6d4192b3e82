//! Findings about holes, and findings about many holes that replace them.
use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::{Backtrace, Call};

/// Subject of a finding; holes are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Subject {
    /// Several holes, or the program as a whole.
    Whole,
    /// One nominal hole.
    Nominal(usize),
    /// One drilled hole that has no nominal hole.
    Extra(usize),
    /// The motion of the tool.
    Motion,
}

/// A finding of a check on holes.
#[derive(Clone, Debug)]
pub(super) struct HoleFinding {
    pub subject: Subject,
    pub finding: Diagnostic,
    /// Words for the first line of the verdict; `None` for the title of the kind.
    pub summary: Option<String>,
    /// True if a finding about many holes replaces it in the printed list; JSON has both.
    pub is_folded: bool,
}

/// Findings of the checks so far, in printed order.
#[derive(Debug, Default)]
pub(super) struct HoleFindings {
    list: Vec<HoleFinding>,
}

impl HoleFindings {
    pub(super) fn add(&mut self, subject: Subject, finding: Diagnostic) {
        self.list.push(HoleFinding { subject, finding, summary: None, is_folded: false });
    }

    /// Adds a finding with its words for the first line of the verdict.
    pub(super) fn add_summed(&mut self, subject: Subject, finding: Diagnostic, summary: String) {
        self.list.push(HoleFinding { subject, finding, summary: Some(summary), is_folded: false });
    }

    /// Adds a finding that a finding about many holes replaces in the printed list.
    pub(super) fn add_folded(&mut self, subject: Subject, finding: Diagnostic) {
        self.list.push(HoleFinding { subject, finding, summary: None, is_folded: true });
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &HoleFinding> {
        self.list.iter()
    }

    pub(super) fn into_list(self) -> Vec<HoleFinding> {
        self.list
    }

    /// Replaces the help of the findings about a subject.
    pub(super) fn set_help(&mut self, subject: Subject, help: &str) {
        for one in self.list.iter_mut().filter(|one| one.subject == subject) {
            one.finding.help = Some(help.to_owned());
        }
    }

    /// Inserts findings about many holes before all others.
    pub(super) fn put_first(&mut self, findings: impl IntoIterator<Item = Diagnostic>) {
        self.put_first_summed(findings.into_iter().map(|finding| (finding, None)));
    }

    /// Inserts findings about many holes before all others, each with its words for the first line of the verdict.
    pub(super) fn put_first_summed(
        &mut self,
        findings: impl IntoIterator<Item = (Diagnostic, Option<String>)>,
    ) {
        let subject = Subject::Whole;
        let whole = |(finding, summary)| HoleFinding { subject, finding, summary, is_folded: false };
        self.list.splice(0..0, findings.into_iter().map(whole));
    }

    /// Returns the index of the first finding of one of these kinds.
    pub(super) fn first_of_kind(&self, kinds: &[&FindingKind]) -> Option<usize> {
        self.list.iter().position(|one| kinds.contains(&one.finding.kind))
    }

    /// Adds notes to the finding with this index.
    pub(super) fn add_notes(&mut self, index: usize, notes: impl IntoIterator<Item = String>) {
        self.list[index].finding.notes.extend(notes);
    }

    pub(super) fn remove(&mut self, kinds: &[&FindingKind]) {
        self.list.retain(|one| !kinds.contains(&one.finding.kind));
    }

    /// Folds the findings of these kinds whose subject `is_explained` accepts; returns their number.
    pub(super) fn fold(&mut self, kinds: &[&FindingKind], is_explained: impl Fn(Subject) -> bool) -> usize {
        self.fold_if(|one| kinds.contains(&one.finding.kind) && is_explained(one.subject))
    }

    /// Folds the findings that `is_explained` accepts; returns their number.
    pub(super) fn fold_if(&mut self, is_explained: impl Fn(&HoleFinding) -> bool) -> usize {
        let mut folded = 0;
        for one in self.list.iter_mut().filter(|one| !one.is_folded) {
            one.is_folded = is_explained(one);
            folded += usize::from(one.is_folded);
        }
        folded
    }
}

/// Returns a note on the folded findings; `None` if their number is 0.
pub(super) fn folded_note(folded: usize) -> Option<String> {
    match folded {
        0 => None,
        1 => Some("--format json lists the finding of the single hole".to_owned()),
        _ => Some(format!("--format json lists the {folded} findings of the single holes")),
    }
}

/// Completes a finding about many holes: the note on the findings that it replaces, and its location.
pub(super) fn finish_group_finding(
    mut finding: Diagnostic,
    folded: usize,
    backtrace: &Backtrace,
) -> Diagnostic {
    finding.notes.extend(folded_note(folded));
    locate_at_call(finding, backtrace)
}

/// Returns the calls that led to a block, the innermost first.
pub(super) fn calls_of(backtrace: &Backtrace) -> impl Iterator<Item = &Call> {
    std::iter::successors(backtrace.calls.as_deref(), |call: &&Call| call.outer_calls.as_deref())
}

/// Locates a finding at the outermost call, which has the arguments; the block of the hole is a secondary location.
pub(super) fn locate_at_call(finding: Diagnostic, backtrace: &Backtrace) -> Diagnostic {
    match calls_of(backtrace).last() {
        Some(call) => {
            let mut finding = finding.with_backtrace(Backtrace { block: call.calling_block, calls: None });
            finding.labels.push((backtrace.block, "drilled here".to_owned()));
            finding
        }
        None => finding.with_backtrace(backtrace.clone()),
    }
}
