//! What `explain` shows: one page for each code. Alarms and findings have theirs in `docs/explain/`; rules of `check` and
//! entries of `diff` are sections of `docs/checks.md` and `docs/changes.md`.
use std::fmt::Write;

use gcode_control::notes;
use gcode_inspect::findings;
use gcode_lang::alarm::kinds;
use gcode_lang::diag::FindingKind;
use gcode_lint::rules;

/// One page: what a code means, what causes it, a program that raises it and what to write instead.
#[derive(Clone, Copy, Debug)]
pub struct Page {
    /// `PS0112`, or a finding's `hole-position`; `MC3000` stands for all alarms that programs raise.
    pub code: &'static str,
    /// What the code means in a few words.
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
    findings().into_iter().chain(rules()).chain(changes())
}

/// All pages of a code: of `hole-depth`, which `verify` tells and `diff` too, there are two.
pub fn pages(code: &str) -> impl Iterator<Item = Page> {
    let own = find(code).map(|page| page.code);
    all().filter(move |page| Some(page.code) == own)
}

/// The page of a code in any of its spellings: `PS0112`, `ps112`, `112`, `MC3021`, `hole-position`, `doubled-n`.
pub fn find(code: &str) -> Option<Page> {
    let code = code.trim();
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
    /// What is fenced as `nc` (the program that raises the alarm, then the one that doesn't), `csv` or `toml`.
    pub fn fenced(&self, language: &str) -> Vec<&'static str> {
        let parts = self.text.split("```").skip(1).step_by(2);
        parts.filter_map(|part| part.strip_prefix(language)?.strip_prefix('\n')).collect()
    }

    /// The page as a terminal shows it: programs indented, no fences.
    pub fn plain_text(&self) -> String {
        let mut text = String::new();
        let mut program = false;
        for line in self.text.lines() {
            if line.starts_with("```") {
                program = !program;
                continue;
            }
            let _ = if program {
                writeln!(text, "    {line}")
            } else {
                let line = line.strip_prefix("## ").or(line.strip_prefix("# ")).unwrap_or(line);
                writeln!(text, "{}", line.replace('`', "").replace("**", ""))
            };
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_found_in_all_its_spellings() {
        for spelling in ["PS0112", "ps112", "112", " Ps0112 "] {
            assert_eq!(find(spelling).unwrap().code, "PS0112", "{spelling}");
        }
        for spelling in ["MC3021", "mc7", "3001"] {
            assert_eq!(find(spelling).unwrap().code, "MC3000", "{spelling}");
        }
        assert_eq!(find("SIM1").unwrap().code, "SIM0001");
        for unknown in ["PS9999", "", "PS", "X", "PS-1", "€1"] {
            assert!(find(unknown).is_none(), "{unknown}");
        }
    }

    #[test]
    fn a_terminal_sees_no_marks_of_a_page() {
        let text = find("PS0112").unwrap().plain_text();
        assert!(text.starts_with("PS0112: division by zero\n\nThe divisor is 0"));
        assert!(text.contains("\nRaises it\n\n    #1=360.\n    #2=#1/#3\n"));
        assert!(!text.contains('`'));
    }
}
