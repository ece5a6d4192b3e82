//! The result of `explain`: one page for each code. Alarms and findings have theirs in `docs/explain/`; rules of `check`
//! and entries of `diff` are sections of `docs/checks.md` and `docs/changes.md`.
use std::fmt::Write;

use schemars::JsonSchema;
use serde::Serialize;

use gcode_control::notes;
use gcode_inspect::findings;
use gcode_lang::alarm::kinds;
use gcode_lang::diag::FindingKind;
use gcode_lang::similar;
use gcode_lint::rules;

/// The document of `explain --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ExplainReport {
    pages: Vec<PageReport>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct PageReport {
    code: &'static str,
    /// The meaning of the code in a few words.
    title: &'static str,
    /// The whole page in Markdown; absent in the list of all codes.
    #[serde(skip_serializing_if = "Option::is_none")]
    text: Option<&'static str>,
}

impl ExplainReport {
    /// Returns the pages of a code in any of its spellings; `hole-depth`, a code of `verify` and of `diff`,
    /// has two.
    pub fn of(code: &str) -> Option<Self> {
        let page = |Page { code, title, text }| PageReport { code, title, text: Some(text) };
        let pages: Vec<_> = pages(code).map(page).collect();
        (!pages.is_empty()).then_some(Self { pages })
    }

    /// Returns the list of all codes.
    pub fn list() -> Self {
        let page = |Page { code, title, .. }| PageReport { code, title, text: None };
        Self { pages: all().map(page).collect() }
    }

    /// Returns the pages as they are written, in Markdown.
    pub fn markdown(&self) -> String {
        self.pages.iter().filter_map(|page| page.text).collect::<Vec<_>>().join("\n")
    }

    /// Formats the pages for a terminal, or one line per code.
    pub fn text(&self) -> String {
        let page = |PageReport { code, title, text }: &PageReport| match text {
            None => format!("{code:<20} {title}\n"),
            Some(text) => plain_text(text),
        };
        let between = if self.pages.iter().any(|page| page.text.is_some()) { "\n" } else { "" };
        self.pages.iter().map(page).collect::<Vec<_>>().join(between)
    }
}

/// One page: meaning of a code, causes, a program that raises it, and a correct program.
#[derive(Clone, Copy, Debug)]
pub struct Page {
    /// `PS0112`, or a finding's `hole-position`; `MC3000` is the page of all alarms that programs raise.
    pub code: &'static str,
    /// Meaning of the code in a few words.
    pub title: &'static str,
    /// Markdown: a heading `# PS0112: division by zero`, and programs fenced as `nc`.
    pub text: &'static str,
}

impl From<&'static FindingKind> for Page {
    fn from(kind: &'static FindingKind) -> Self {
        Self { code: kind.code, title: kind.title, text: kind.page() }
    }
}

/// Returns the pages of all alarms and findings, in the order of their codes.
pub fn findings() -> Vec<Page> {
    let tables = [kinds::ALL, notes::ALL, findings::ALL];
    let mut all: Vec<Page> = tables.into_iter().flatten().map(|kind| Page::from(*kind)).collect();
    all.sort_by_key(|page| page.code);
    all
}

/// Returns the rules of `check`, each a section of their page.
pub fn rules() -> impl Iterator<Item = Page> {
    rules::ALL.iter().map(|rule| Page::from(&rule.kind))
}

/// Returns the entries of `diff` and `test`, each a section of their page.
pub fn changes() -> impl Iterator<Item = Page> {
    gcode_review::kinds::ALL.iter().map(|kind| Page::from(*kind))
}

/// Returns every page, in the order in which they are listed.
pub fn all() -> impl Iterator<Item = Page> {
    findings().into_iter().chain(rules()).chain(changes()).chain([claim()])
}

/// Returns the page of a claim of `test` that isn't proved, a section of the page on proofs.
fn claim() -> Page {
    const PROOFS: &str = include_str!("../../../docs/prove-reference.md");
    let section = PROOFS.split("\n## ").find(|section| section.starts_with("Claims in a repository"));
    Page { code: "claim", title: "a claim of a case isn't proved", text: section.unwrap_or(PROOFS) }
}

/// Returns all pages of a code: two for `hole-depth`, a code of `verify` and of `diff`.
pub fn pages(code: &str) -> impl Iterator<Item = Page> {
    let own = find(code).map(|page| page.code);
    all().filter(move |page| Some(page.code) == own)
}

/// Returns the code that a misspelt one means; `None` if no code is so near.
pub(crate) fn similar_code(code: &str) -> Option<&'static str> {
    similar(code, all().map(|page| page.code))
}

/// Returns the page of a code in any of its spellings: `PS0112`, `PS 112`, `ps112`, `112`, `MC3021`, `hole-position`,
/// `doubled-n`.
pub fn find(code: &str) -> Option<Page> {
    let code = &code.replace(' ', "");
    if let Some(page) = all().find(|page| page.code.eq_ignore_ascii_case(code)) {
        return Some(page);
    }
    let code = code.to_ascii_uppercase();
    let digits = code.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    let family = &code[..code.len() - digits.len()];
    let number: u32 = digits.parse().ok()?;
    let named = |family: &str, number: u32| {
        let code = format!("{family}{number:04}");
        findings().into_iter().find(|page| page.code == code)
    };
    let raised = || named("MC", 3000);
    match family {
        "MC" => raised(),
        // A number alone is what older controls show: 112, 3021.
        "" => named("PS", number).or_else(|| (3000..4000).contains(&number).then(raised).flatten()),
        family => named(family, number),
    }
}

impl Page {
    /// Returns the fenced texts in a language: `nc` (a program that raises the alarm, then a correct one), `csv` or `toml`.
    pub fn fenced(&self, language: &str) -> Vec<&'static str> {
        let parts = self.text.split("```").skip(1).step_by(2);
        parts.filter_map(|part| part.strip_prefix(language)?.strip_prefix('\n')).collect()
    }
}

/// Formats Markdown for a terminal: programs indented, no fences.
pub(super) fn plain_text(markdown: &str) -> String {
    let mut text = String::new();
    let mut is_program = false;
    for line in markdown.lines() {
        if line.starts_with("```") {
            is_program = !is_program;
            continue;
        }
        let _ = if is_program {
            writeln!(text, "    {line}")
        } else {
            let line = line.strip_prefix("## ").or(line.strip_prefix("# ")).unwrap_or(line);
            writeln!(text, "{}", line.replace('`', "").replace("**", ""))
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_found_in_all_its_spellings() {
        for spelling in ["PS0112", "ps112", "112", " Ps0112 ", "PS 0112", "ps 112"] {
            assert_eq!(find(spelling).unwrap().code, "PS0112", "{spelling}");
        }
        for spelling in ["MC3021", "mc7", "3001"] {
            assert_eq!(find(spelling).unwrap().code, "MC3000", "{spelling}");
        }
        assert_eq!(find("SIM1").unwrap().code, "SIM0001");
        assert!(
            find("claim").unwrap().text.contains("claims.toml")
                && !find("claim").unwrap().text.contains("## ")
        );
        for unknown in ["PS9999", "", "PS", "X", "PS-1", "€1"] {
            assert!(find(unknown).is_none(), "{unknown}");
        }
    }

    #[test]
    fn a_misspelt_code_is_named_with_the_one_that_is_meant() {
        assert_eq!(similar_code("hole-positon"), Some("hole-position"));
        assert_eq!(similar_code("PS9999"), None, "digits are no slip");
        assert_eq!(similar_code("nonsense"), None);
    }

    #[test]
    fn the_text_of_a_page_has_no_markdown() {
        let text = plain_text(find("PS0112").unwrap().text);
        assert!(text.starts_with("PS0112: division by zero\n\nThe divisor is 0"));
        assert!(text.contains("\nRaises it\n\n    #1=360.\n    #2=#1/#3\n"));
        assert!(!text.contains('`'));
    }
}
