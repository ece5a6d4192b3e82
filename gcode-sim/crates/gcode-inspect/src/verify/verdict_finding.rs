//! Findings of a verdict as data.
use std::borrow::Cow;
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use gcode_lang::diag::{Diagnostic, FindingKind, Severity, Site};
use gcode_lang::source::Span;
use gcode_part::Origin;

/// A finding as data.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Finding {
    /// Row of the code.
    #[serde(skip)]
    pub kind: &'static FindingKind,
    /// The code, as in `explain`.
    pub code: Cow<'static, str>,
    /// One of note, warning, error and alarm.
    pub severity: &'static str,
    /// The fault in one sentence.
    pub message: String,
    /// The remedy.
    pub help: Option<String>,
    /// Further facts.
    pub notes: Vec<String>,
    /// The finding is about motion, not about the resulting holes.
    pub from_motion: bool,
    /// The id of the nominal hole.
    pub hole: Option<String>,
    /// The block of the finding.
    pub from: Option<Origin>,
    /// Further blocks, such as the first cut with a wrong length offset.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<BlockLabel>,
    /// A finding about many holes replaces it in the printed list and in the first line.
    #[serde(skip)]
    pub is_folded: bool,
    /// For a finding on flutes: positions on the part, the worst first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sites: Vec<PartPoint>,
}

/// A further block of a finding.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct BlockLabel {
    /// The program of the block.
    pub program: String,
    /// The block's line.
    pub line: u32,
    /// What the block does.
    pub text: String,
}

/// A position on the part, mm.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct PartPoint {
    /// Counted from 1; null without a pass: a missing flute, a rapid between two of them.
    pub pass: Option<usize>,
    /// Coordinates x, y, z.
    pub at: [f64; 3],
}

impl From<&Site> for PartPoint {
    fn from(site: &Site) -> Self {
        Self { pass: site.pass.map(|pass| pass + 1), at: site.point }
    }
}

/// Returns a finding as data, about the nominal hole of this id.
pub(super) fn finding_of(
    finding: &Diagnostic,
    hole: Option<&str>,
    from_motion: bool,
    locate: &dyn Fn(Span) -> (String, u32),
) -> Finding {
    let label = |(span, text): &(Span, String)| {
        let (program, line) = locate(*span);
        BlockLabel { program, line, text: text.clone() }
    };
    Finding {
        kind: finding.kind,
        code: finding.code(),
        severity: finding.severity.name(),
        message: finding.message.clone(),
        help: finding.help.clone(),
        notes: finding.notes.clone(),
        from_motion,
        hole: hole.map(str::to_owned),
        from: finding.backtrace.as_ref().map(|backtrace| origin(backtrace.block, None, locate)),
        labels: finding.labels.iter().map(label).collect(),
        is_folded: false,
        sites: finding.sites.iter().map(Into::into).collect(),
    }
}

/// Keeps the first findings of each kind and severity, the last of them with the number left out and a note on it. Alarms come first: what
/// stopped the run explains the rest.
pub(super) fn limit_per_kind(findings: impl Iterator<Item = Diagnostic>) -> Vec<Diagnostic> {
    const MAX_SHOWN: usize = 8;
    let mut kinds: BTreeMap<(&str, Severity), (usize, usize)> = BTreeMap::new();
    let mut shown: Vec<Diagnostic> = Vec::new();
    for finding in findings {
        let (count, last) = kinds.entry((finding.kind.code, finding.severity)).or_insert((0, 0));
        *count += 1;
        if *count <= MAX_SHOWN {
            *last = shown.len();
            shown.push(finding);
        }
    }
    for (count, last) in kinds.into_values().filter(|(count, _)| MAX_SHOWN < *count) {
        let more = count - MAX_SHOWN;
        shown[last].more = more;
        shown[last].notes.push(format!("and {more} more of this kind; --format json lists them all"));
    }
    shown.sort_by_key(|finding| finding.severity != Severity::Alarm);
    shown
}

/// Returns the place of a block.
pub(super) fn origin(block: Span, tool: Option<u32>, locate: &dyn Fn(Span) -> (String, u32)) -> Origin {
    let (program, line) = locate(block);
    Origin { program, line, tool }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::LENGTH_OFFSET;
    use gcode_lang::source::SourceId;

    /// Nine warnings and an error of one kind: the error is shown, and the count of the warnings stays nine.
    #[test]
    fn a_list_knows_how_many_findings_it_leaves_out() {
        let warning = || Diagnostic::new(&LENGTH_OFFSET, "").with_severity(Severity::Warning);
        let all = std::iter::repeat_with(warning).take(9).chain([Diagnostic::new(&LENGTH_OFFSET, "")]);
        let shown = limit_per_kind(all);
        let counts: Vec<_> = shown.iter().map(|one| (one.severity, one.more)).collect();
        assert_eq!(counts[7..], [(Severity::Warning, 1), (Severity::Error, 0)]);
        assert_eq!(counts.iter().map(|(_, more)| 1 + more).sum::<usize>(), 10);
        assert_eq!(limit_per_kind(std::iter::repeat_with(warning).take(8))[7].more, 0);
    }

    /// A finding at line 3 with a second block at line 7.
    #[test]
    fn the_second_place_of_a_finding_is_data() {
        let at = |start| Span { source: SourceId(0), start, end: start };
        let locate = |span: Span| ("O1".to_owned(), span.start);
        let finding =
            Diagnostic::new(&LENGTH_OFFSET, "T1 cuts with H2").label(at(7), "the first cut with it");
        let data = finding_of(&finding, None, true, &locate);
        let labels: Vec<_> =
            data.labels.iter().map(|l| (l.program.as_str(), l.line, l.text.as_str())).collect();
        assert_eq!(labels, [("O1", 7, "the first cut with it")]);
        assert!(finding_of(&Diagnostic::new(&LENGTH_OFFSET, ""), None, true, &locate).labels.is_empty());
    }
}
