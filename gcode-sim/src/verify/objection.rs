//! What a check has against the holes, and which of it stands behind one sentence about many.
use crate::diag::Diagnostic;
use crate::motion::{Call, Place};

/// Something a check has against the holes.
#[derive(Clone, Debug)]
pub struct Objection {
    /// The wanted hole it is about, counted from 0.
    pub wanted: Option<usize>,
    /// The drilled hole that nobody asked for, counted from 0.
    pub extra: Option<usize>,
    pub finding: Diagnostic,
    /// Another finding says it of many holes at once: people read that one, the data has both.
    pub folded: bool,
}

impl Objection {
    /// About many holes, or about none that is known.
    pub fn whole(finding: Diagnostic) -> Self {
        Self { wanted: None, extra: None, finding, folded: false }
    }

    pub fn of(wanted: usize, finding: Diagnostic) -> Self {
        Self { wanted: Some(wanted), ..Self::whole(finding) }
    }

    pub fn of_extra(extra: usize, finding: Diagnostic) -> Self {
        Self { extra: Some(extra), ..Self::whole(finding) }
    }

    fn is_one_of(&self, codes: &[&str]) -> bool {
        codes.contains(&self.finding.code.as_str())
    }
}

/// Puts those of these codes that `about` speaks of behind another finding; the answer is how many they are.
pub(super) fn fold(
    objections: &mut [Objection],
    codes: &[&str],
    about: impl Fn(&Objection) -> bool,
) -> usize {
    let mut folded = 0;
    for objection in objections.iter_mut().filter(|o| !o.folded && o.is_one_of(codes) && about(o)) {
        objection.folded = true;
        folded += 1;
    }
    folded
}

/// What is said where findings were folded; `None` where there were none.
pub(super) fn behind(folded: usize) -> Option<String> {
    match folded {
        0 => None,
        1 => Some("--format json lists the finding of the single hole".to_owned()),
        _ => Some(format!("--format json lists the {folded} findings of the single holes")),
    }
}

/// What concerns many holes alike is told at the call in the main program, which has the numbers; where it was drilled is
/// a second place.
pub(super) fn at_the_call(finding: Diagnostic, place: &Place) -> Diagnostic {
    let calls = std::iter::successors(place.calls.as_deref(), |call: &&Call| call.outer.as_deref());
    match calls.last() {
        Some(call) => {
            let mut finding = finding.at(Place { block: call.from, calls: None });
            finding.labels.push((place.block, "drilled here".to_owned()));
            finding
        }
        None => finding.at(place.clone()),
    }
}
