//! Links of a document: the programs that it calls, and the pages of the rules that it turns off.
use gcode_lint::rules::{ALL, Rule};

use crate::entry::EntryKind;
use crate::navigation::NavigationTarget;
use crate::project::{Project, program_name};
use crate::text::{FileId, TextRange};

/// Link to a called program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentLink {
    /// Word P, or the code that calls.
    pub range: TextRange,
    /// `O8101`.
    pub label: String,
    /// Called program.
    pub target: NavigationTarget,
}

/// Link to the page of a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageLink {
    /// Name of the rule.
    pub range: TextRange,
    /// Code of the finding, `missing-n`.
    pub code: &'static str,
}

/// First word of a comment that turns rules off.
const SUPPRESSION: &[u8] = b"CHECK-OFF";

impl Project {
    /// Returns the links of a file: each call whose program the project has.
    pub fn document_links(&self, file: FileId) -> Vec<DocumentLink> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let calls = index.all_entries().filter(|entry| entry.kind == EntryKind::Call);
        let links = calls.filter_map(|entry| {
            let call = entry.call()?;
            let name = program_name(&call.record.target)?;
            let target = *self.program_targets(&name, file).first()?;
            let range = call.target_range().unwrap_or(call.code);
            Some(DocumentLink { range, label: name.label(), target })
        });
        links.collect()
    }

    /// Returns the links to pages: the names of rules in comments as `(CHECK-OFF missing-n)`.
    pub fn page_links(&self, file: FileId) -> Vec<PageLink> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let text = index.text();
        let mut found = Vec::new();
        let mut at = 0;
        while let Some(place) =
            text[at..].windows(SUPPRESSION.len()).position(|w| w.eq_ignore_ascii_case(SUPPRESSION))
        {
            let start = at + place + SUPPRESSION.len();
            let length =
                text[start..].iter().take_while(|byte| !matches!(byte, b')' | b'\n' | b'\r')).count();
            let mut from = start;
            for name in text[start..start + length].split(|byte| matches!(byte, b' ' | b',' | b'\t')) {
                let is_rule = |rule: &&&Rule| rule.kind.code.as_bytes().eq_ignore_ascii_case(name);
                if let Some(rule) = ALL.iter().find(is_rule) {
                    let range = TextRange::new(from as u32, (from + name.len()) as u32);
                    found.push(PageLink { range, code: rule.kind.code });
                }
                from += name.len() + 1;
            }
            at = start + length;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::fixture;
    use crate::text::FileId;

    #[test]
    fn suppressed_rules_link_to_their_pages() {
        let fixture =
            fixture("O1(CHECK-OFF MISSING-N, UNREACHABLE NONE)\nGOTO 5 (check-off missing-point)\n");
        let links = fixture.project.page_links(FileId(0));
        let shown: Vec<_> =
            links.iter().map(|link| (link.code, fixture.text(FileId(0), link.range))).collect();
        let expected =
            [("missing-n", "MISSING-N"), ("unreachable", "UNREACHABLE"), ("missing-point", "missing-point")];
        assert_eq!(shown, expected.map(|(code, text)| (code, text.to_owned())));
    }
}
