//! What a check has against the holes, and which of it stands behind one sentence about many.
use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::{Backtrace, Call};

/// Something a check has against the holes.
#[derive(Clone, Debug)]
pub struct HoleFinding {
    /// The wanted hole it is about, counted from 0.
    pub nominal: Option<usize>,
    /// The drilled hole that nobody asked for, counted from 0.
    pub extra: Option<usize>,
    pub finding: Diagnostic,
    /// It is about how the tool moved, not about the holes that came of it.
    pub is_motion: bool,
    /// Another finding says it of many holes at once: people read that one, the data has both.
    pub is_folded: bool,
}

impl HoleFinding {
    /// About many holes, or about none that is known.
    pub fn unlocated(finding: Diagnostic) -> Self {
        Self { nominal: None, extra: None, finding, is_motion: false, is_folded: false }
    }

    pub fn of_nominal(wanted: usize, finding: Diagnostic) -> Self {
        Self { nominal: Some(wanted), ..Self::unlocated(finding) }
    }

    pub fn of_extra(extra: usize, finding: Diagnostic) -> Self {
        Self { extra: Some(extra), ..Self::unlocated(finding) }
    }

    /// About how the tool moved.
    pub fn of_motion(finding: Diagnostic) -> Self {
        Self { is_motion: true, ..Self::unlocated(finding) }
    }

    pub(super) fn is_one_of(&self, kinds: &[&FindingKind]) -> bool {
        kinds.contains(&self.finding.kind)
    }
}

/// Puts those of these codes that `about` speaks of behind another finding; the answer is how many they are.
pub(super) fn fold(
    findings: &mut [HoleFinding],
    kinds: &[&FindingKind],
    is_concerned: impl Fn(&HoleFinding) -> bool,
) -> usize {
    let mut folded = 0;
    for objection in findings.iter_mut().filter(|o| !o.is_folded && o.is_one_of(kinds) && is_concerned(o)) {
        objection.is_folded = true;
        folded += 1;
    }
    folded
}

/// What is said where findings were folded; `None` where there were none.
pub(super) fn folded_note(folded: usize) -> Option<String> {
    match folded {
        0 => None,
        1 => Some("--format json lists the finding of the single hole".to_owned()),
        _ => Some(format!("--format json lists the {folded} findings of the single holes")),
    }
}

/// What concerns many holes alike is told at the call in the main program, which has the numbers; where it was drilled is
/// a second place.
pub(super) fn locate_at_call(finding: Diagnostic, place: &Backtrace) -> Diagnostic {
    let calls = std::iter::successors(place.calls.as_deref(), |call: &&Call| call.outer_calls.as_deref());
    match calls.last() {
        Some(call) => {
            let mut finding = finding.with_backtrace(Backtrace { block: call.calling_block, calls: None });
            finding.labels.push((place.block, "drilled here".to_owned()));
            finding
        }
        None => finding.with_backtrace(place.clone()),
    }
}
