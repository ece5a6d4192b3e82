//! What `explain` says: one page for every alarm and every finding of a run, written in `docs/explain/` and carried in
//! the program; the rules of `check` and the entries of `diff` have their sections in `docs/checks.md` and `docs/changes.md`.
use std::fmt::Write;

/// One page: what a code means, what causes it, a program that raises it and what to write instead.
#[derive(Clone, Copy, Debug)]
pub struct Page {
    /// `PS0112`, or a finding's `hole-position`; `MC3000` stands for all alarms that programs raise themselves.
    pub code: &'static str,
    /// Markdown: a title `# PS0112: division by zero`, and programs fenced as `nc`.
    pub text: &'static str,
}

macro_rules! pages {
    ($($code:literal)*) => {
        &[$(Page { code: $code, text: include_str!(concat!("../../../docs/explain/", $code, ".md")) }),*]
    };
}

/// All pages, in the order of their codes.
#[rustfmt::skip]
pub const PAGES: &[Page] = pages![
    "MC3000"
    "OT0500"
    "OT0501"
    "PS0003"
    "PS0004"
    "PS0005"
    "PS0006"
    "PS0007"
    "PS0009"
    "PS0010"
    "PS0011"
    "PS0020"
    "PS0021"
    "PS0022"
    "PS0025"
    "PS0030"
    "PS0032"
    "PS0033"
    "PS0034"
    "PS0035"
    "PS0037"
    "PS0039"
    "PS0041"
    "PS0042"
    "PS0044"
    "PS0045"
    "PS0046"
    "PS0050"
    "PS0051"
    "PS0052"
    "PS0053"
    "PS0055"
    "PS0074"
    "PS0076"
    "PS0077"
    "PS0078"
    "PS0092"
    "PS0109"
    "PS0110"
    "PS0111"
    "PS0112"
    "PS0115"
    "PS0116"
    "PS0118"
    "PS0119"
    "PS0122"
    "PS0124"
    "PS0125"
    "PS0126"
    "PS0127"
    "PS0128"
    "PS0129"
    "PS0142"
    "PS0144"
    "PS0231"
    "PS0245"
    "PS0300"
    "PS0305"
    "PS0310"
    "PS0311"
    "PS0331"
    "PS0332"
    "PS0335"
    "PS0369"
    "PS0370"
    "PS1079"
    "PS1080"
    "PS1091"
    "PS1092"
    "PS1093"
    "PS1095"
    "PS1096"
    "PS1098"
    "PS1099"
    "PS1100"
    "PS1115"
    "PS1120"
    "PS1124"
    "PS1125"
    "PS1128"
    "PS1131"
    "PS1132"
    "PS1133"
    "PS1134"
    "PS1137"
    "PS1138"
    "PS1139"
    "PS1141"
    "PS1142"
    "PS1143"
    "PS1144"
    "PS1160"
    "PS1196"
    "PS1202"
    "PS5010"
    "PS5074"
    "SIM0001"
    "SIM0002"
    "SIM0003"
    "atan-of-0"
    "axis-carries-nothing"
    "axis-left-out"
    "axis-signs"
    "back-bored"
    "ball-into-part"
    "block-skip"
    "burr-offset"
    "centre-here"
    "corner-ignored"
    "cycle-data-lost"
    "digits-lost"
    "doubled-number"
    "drill-feed"
    "drill-peck"
    "drill-plane"
    "drill-speed"
    "drills-unclamped"
    "end-before-switch"
    "feed-no-hole"
    "feed-not-along-tool"
    "feed-without-retract"
    "flute-end"
    "flute-extra"
    "flute-head"
    "flute-helix"
    "flute-index"
    "flute-missing"
    "flute-speed"
    "flute-surface"
    "flute-twice"
    "flutes-meet"
    "g53-ignored"
    "head-message-unclear"
    "head-not-manual"
    "head-not-set"
    "hole-cut-aside"
    "hole-depth"
    "hole-diameter"
    "hole-extra"
    "hole-in-air"
    "hole-missing"
    "hole-overlap"
    "hole-position"
    "hole-through"
    "hole-tilted"
    "hole-tools"
    "hole-twice"
    "holes-alike"
    "into-loop"
    "job-tool"
    "large-alarm-number"
    "leaves-hole-sideways"
    "length-of-nothing"
    "length-offset"
    "level-missing"
    "limit"
    "long-m-code"
    "lower-case"
    "m-code-lost"
    "machine-position"
    "mirror-image"
    "no-angle"
    "no-axis"
    "no-interrupt"
    "no-pass"
    "no-repeats"
    "no-signal"
    "parameter-without-effect"
    "path-not-read"
    "rapid-beyond-cut"
    "rapid-into-part"
    "rapid-near-part"
    "rotary-sign"
    "row-angle"
    "row-group"
    "row-missing"
    "row-pitch"
    "row-seam"
    "row-short"
    "spindle-in-hole"
    "spindle-reversed"
    "spindle-stopped"
    "tangent-of-90"
    "tool-short"
    "tool-unknown"
    "turns-clamped"
    "turns-near-part"
    "wheel-feed"
    "wheel-into-burr"
    "wheel-near-burr"
    "wheel-reversed"
    "wheel-speed"
    "words-passed-on"
    "work-offset"
];

/// The rules of `check`, each a section of their page.
pub fn rules() -> impl Iterator<Item = Page> {
    sections(include_str!("../../../docs/checks.md"))
}

/// What `diff` and `test` tell, each a section of their page.
pub fn changes() -> impl Iterator<Item = Page> {
    sections(include_str!("../../../docs/changes.md"))
}

/// The sections of a page with a heading `code: what it means`.
fn sections(page: &'static str) -> impl Iterator<Item = Page> {
    let sections = page.split("\n## ").skip(1);
    sections.filter_map(|text| Some(Page { code: text.split_once(": ")?.0, text }))
}

/// Every page, in the order in which they are listed.
pub fn all() -> impl Iterator<Item = Page> {
    PAGES.iter().copied().chain(rules()).chain(changes())
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
        PAGES.iter().copied().find(|page| page.code == code)
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
    /// The meaning of the code in a few words.
    pub fn title(&self) -> &'static str {
        let first = self.text.lines().next().unwrap_or_default();
        first.split_once(": ").map_or(first, |(_, title)| title)
    }

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
