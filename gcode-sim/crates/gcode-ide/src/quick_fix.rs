//! Quick fixes: edits that carry out what a finding asks for.
use crate::lexer::{LexemeKind, lexemes};
use crate::project::Project;
use crate::text::{FileId, TextEdit, TextRange, line_range, lossy};

/// Correction of a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuickFix {
    /// `Write X25.`.
    pub title: String,
    /// Edits of the file.
    pub edits: Vec<TextEdit>,
    /// True if the finding has no other correction.
    pub is_preferred: bool,
}

/// Finding with its line.
struct Finding<'a> {
    text: &'a [u8],
    code: &'a str,
    range: TextRange,
    line: TextRange,
    help: &'a str,
}

type Fix = fn(&Finding<'_>) -> Option<QuickFix>;

/// All fixes, in the order of their offers.
const FIXES: [Fix; 12] = [
    missing_point,
    square_brackets,
    letter_o,
    decimal_comma,
    separating_comma,
    number_with_n,
    exponent,
    foreign_character,
    relation_sign,
    capitals,
    closing_bracket,
    exact_pi,
];

impl Project {
    /// Returns the fixes of a finding: its code, its exact part or its block, and its remedy.
    pub fn quick_fixes(
        &self,
        file: FileId,
        code: &str,
        range: TextRange,
        help: Option<&str>,
    ) -> Vec<QuickFix> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let text = index.text();
        let finding = Finding {
            text,
            code,
            range,
            line: line_range(text, range.start),
            help: help.unwrap_or_default(),
        };
        let mut found: Vec<_> = FIXES.iter().filter_map(|fix| fix(&finding)).collect();
        found.extend(two_signs(&finding));
        found
    }
}

/// Returns a fix of one edit.
fn fix(title: impl Into<String>, range: TextRange, text: impl Into<String>) -> Option<QuickFix> {
    let edits = vec![TextEdit { range, text: text.into() }];
    Some(QuickFix { title: title.into(), edits, is_preferred: true })
}

impl Finding<'_> {
    /// Returns the text of the line with its comments blanked, one byte for each.
    fn code_of_line(&self) -> Vec<u8> {
        let mut code = self.line.of(self.text).to_vec();
        for lexeme in lexemes(self.text, self.line, &[]) {
            if lexeme.kind == LexemeKind::Comment {
                let (start, end) = (lexeme.range.start - self.line.start, lexeme.range.end - self.line.start);
                code[start as usize..end as usize].fill(b' ');
            }
        }
        code
    }

    /// Returns the place of a text in the code of the line, the one nearest to the finding.
    fn find(&self, wanted: &str) -> Option<TextRange> {
        let code = self.code_of_line();
        let wanted = wanted.as_bytes();
        if wanted.is_empty() || wanted.len() > code.len() {
            return None;
        }
        let places = code.windows(wanted.len()).enumerate().filter(|(_, window)| *window == wanted);
        let starts = places.map(|(at, _)| self.line.start + at as u32);
        let start = starts.min_by_key(|start| start.abs_diff(self.range.start))?;
        Some(TextRange::new(start, start + wanted.len() as u32))
    }
}

/// Returns the part of a text between two others.
fn between<'t>(text: &'t str, before: &str, behind: &str) -> Option<&'t str> {
    let (_, rest) = text.split_once(before)?;
    Some(rest.split_once(behind)?.0)
}

/// `X25` becomes `X25.`.
fn missing_point(finding: &Finding<'_>) -> Option<QuickFix> {
    let word = lossy(finding.range.of(finding.text));
    let word = word.trim_end();
    let is_word = word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.ends_with(|c: char| c.is_ascii_digit())
        && !word.contains(['.', '#', '[']);
    let asks = finding.code == "missing-point" || finding.help.contains("without a decimal point");
    if !is_word || !asks {
        return None;
    }
    let end = finding.range.start + word.len() as u32;
    fix(format!("Write {word}."), TextRange::new(end, end), ".")
}

/// `(` becomes `[`, and its `)` becomes `]`.
fn square_brackets(finding: &Finding<'_>) -> Option<QuickFix> {
    if finding.code != "round-brackets" && !finding.help.contains("write '[' and ']'") {
        return None;
    }
    let line = finding.line.of(finding.text);
    let from = finding.range.start.saturating_sub(finding.line.start) as usize;
    let mut edits = Vec::new();
    let mut depth = 0;
    for (at, byte) in line.iter().enumerate().skip(from) {
        let new = match byte {
            b'(' => "[",
            b')' if depth > 0 => "]",
            _ => continue,
        };
        depth = if new == "[" { depth + 1 } else { depth - 1 };
        let start = finding.line.start + at as u32;
        edits.push(TextEdit { range: TextRange::new(start, start + 1), text: new.into() });
        if depth == 0 {
            break;
        }
    }
    let is_complete = depth == 0 && !edits.is_empty();
    is_complete.then(|| QuickFix { title: "Write [ ] for ( )".into(), edits, is_preferred: true })
}

/// `GO1` becomes `G01`.
fn letter_o(finding: &Finding<'_>) -> Option<QuickFix> {
    let (wrong, right) = finding.help.split_once(" has the letter O instead of a zero: write ")?;
    let wrong = wrong.trim_matches('\'');
    fix(format!("Write {right}"), finding.find(wrong)?, right)
}

/// `10,5` becomes `10.5`.
fn decimal_comma(finding: &Finding<'_>) -> Option<QuickFix> {
    let number = between(finding.help, "write ", ": the decimal separator is a point")?;
    fix(format!("Write {number}"), finding.find(&number.replace('.', ","))?, number)
}

/// `X10., Y5.` becomes `X10. Y5.`.
fn separating_comma(finding: &Finding<'_>) -> Option<QuickFix> {
    if !finding.help.contains("remove the comma") {
        return None;
    }
    fix("Remove the comma", finding.find(",")?, "")
}

/// `GOTO N10` becomes `GOTO 10`.
fn number_with_n(finding: &Finding<'_>) -> Option<QuickFix> {
    let digits = between(finding.help, "write GOTO ", ", without N")?;
    let place = finding.find(&format!("N{digits}"))?;
    fix(format!("Write GOTO {digits}"), place, digits)
}

/// `1E3` becomes `1000.`: in a word a whole number needs its point.
fn exponent(finding: &Finding<'_>) -> Option<QuickFix> {
    let value = between(finding.help, "write ", " for ")?;
    let written = between(finding.help, " for ", ": numbers have no exponent")?;
    let number = if value.contains('.') { value.to_owned() } else { format!("{value}.") };
    fix(format!("Write {number}"), finding.find(written)?, number)
}

/// A character that resembles one of a control becomes that one.
fn foreign_character(finding: &Finding<'_>) -> Option<QuickFix> {
    let number = between(finding.help, "the character U+", " is not a character")?;
    let character = char::from_u32(u32::from_str_radix(number, 16).ok()?)?;
    let (_, asked) = finding.help.rsplit_once(": type ")?;
    let right = match asked {
        "a space" => " ",
        _ => asked.split('\'').nth(1)?,
    };
    let place = finding.find(character.encode_utf8(&mut [0; 4]))?;
    fix(format!("Write {asked}"), place, right)
}

/// `==` becomes `EQ`.
fn relation_sign(finding: &Finding<'_>) -> Option<QuickFix> {
    const SIGNS: [(&str, &str); 12] = [
        ("==", "EQ"),
        ("<>", "NE"),
        ("!=", "NE"),
        (">=", "GE"),
        ("=>", "GE"),
        ("<=", "LE"),
        ("=<", "LE"),
        ("&&", "AND"),
        ("||", "OR"),
        ("=", "EQ"),
        (">", "GT"),
        ("<", "LT"),
    ];
    if finding.code != "relation-symbol" && !finding.help.contains("write EQ, NE, LT") {
        return None;
    }
    let code = finding.code_of_line();
    let at = (finding.range.start - finding.line.start) as usize;
    let is_sign = |byte: &u8| b"=<>!&|".contains(byte);
    let first = at + code.get(at..)?.iter().position(is_sign)?;
    let rest = &code[first..];
    let (sign, letters) = SIGNS.iter().find(|(sign, _)| rest.starts_with(sign.as_bytes()))?;
    let behind = first + sign.len();
    // One blank on each side, with those that stand there.
    let is_blank = |byte: Option<&u8>| byte == Some(&b' ');
    let before = if is_blank(first.checked_sub(1).and_then(|at| code.get(at))) { "" } else { " " };
    let after = if is_blank(code.get(behind)) { "" } else { " " };
    let place = [first, behind].map(|at| finding.line.start + at as u32);
    fix(format!("Write {letters}"), TextRange::new(place[0], place[1]), format!("{before}{letters}{after}"))
}

/// Letters become capitals, comments aside.
fn capitals(finding: &Finding<'_>) -> Option<QuickFix> {
    if finding.code != "lower-case" && !finding.help.contains("write capitals") {
        return None;
    }
    let code = finding.code_of_line();
    let mut edits = Vec::new();
    let mut at = 0;
    while at < code.len() {
        let length = code[at..].iter().take_while(|byte| byte.is_ascii_lowercase()).count();
        if length > 0 {
            let start = finding.line.start + at as u32;
            let text = lossy(&code[at..at + length]).to_ascii_uppercase();
            edits.push(TextEdit { range: TextRange::new(start, start + length as u32), text });
        }
        at += length.max(1);
    }
    (!edits.is_empty()).then(|| QuickFix { title: "Write capitals".into(), edits, is_preferred: true })
}

/// A comment without `)` gets one at the end of its line.
fn closing_bracket(finding: &Finding<'_>) -> Option<QuickFix> {
    let comment = finding.range.of(finding.text);
    let is_open = comment.first() == Some(&b'(') && !comment.contains(&b')');
    let asks = matches!(finding.code, "open-comment" | "unclosed-comment");
    let end = finding.range.end;
    (asks && is_open)
        .then(|| fix("Close the comment at the end of the line", TextRange::new(end, end), ")"))?
}

/// `3.14` becomes `3.14159265`.
fn exact_pi(finding: &Finding<'_>) -> Option<QuickFix> {
    let exact = finding.help.strip_prefix("write ").filter(|_| finding.code == "rounded-pi")?;
    let number = lossy(finding.range.of(finding.text));
    number.starts_with("3.1").then(|| fix(format!("Write {exact}"), finding.range, exact))?
}

/// `Z--5` becomes `Z-5` or `Z-[-5]`.
fn two_signs(finding: &Finding<'_>) -> Vec<QuickFix> {
    let Some((one, other)) =
        finding.help.strip_prefix("write one sign: ").and_then(|help| help.split_once(", or "))
    else {
        return Vec::new();
    };
    let Some(digits) = one.get(2..) else { return Vec::new() };
    let letter = one.get(..1).unwrap_or_default();
    let Some(place) = finding.find(&format!("{letter}--{digits}")) else { return Vec::new() };
    let offers = [one, other].map(|text| fix(format!("Write {text}"), place, text));
    let offers = offers.into_iter().flatten();
    offers.map(|fix| QuickFix { is_preferred: false, ..fix }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::apply_edits;
    use gcode_lang::control::Settings;
    use gcode_lang::program::NoLibrary;

    /// Returns the text after the fixes of all findings of `check`, one at a time, and their titles.
    fn corrected(line: &str) -> (String, Vec<String>) {
        let text = format!("O1\n{line}\nM30\n");
        let settings = Settings::default();
        let mut project = Project::new(settings.clone());
        project.set_file(FileId(0), "A", text.clone().into_bytes());
        let checked = gcode_lint::check("A", text.clone().into_bytes(), &settings, &mut NoLibrary);
        let fixes = checked.findings.iter().flat_map(|finding| {
            let block = finding.backtrace.as_ref().map(|place| place.block);
            let span = finding.span.or(block).unwrap();
            project.quick_fixes(FileId(0), &finding.code(), span.into(), finding.help.as_deref())
        });
        let fixes: Vec<_> = fixes.collect();
        let first = fixes.first().map(|fix| apply_edits(text.as_bytes(), &fix.edits)).unwrap_or_default();
        let line = String::from_utf8(first).unwrap().lines().nth(1).unwrap_or_default().to_owned();
        (line, fixes.into_iter().map(|fix| fix.title).collect())
    }

    #[test]
    fn findings_have_their_fixes() {
        for (wrong, right, title) in [
            ("G0 X1. Y25", "G0 X1. Y25.", "Write Y25."),
            ("G0 X1. Z-3", "G0 X1. Z-3.", "Write Z-3."),
            ("X(#1+[2*3])(C)", "X[#1+[2*3]](C)", "Write [ ] for ( )"),
            ("#1=SIN(30.)", "#1=SIN[30.]", "Write [ ] for ( )"),
            ("G90 GO1 X10. F100.", "G90 G01 X10. F100.", "Write G01"),
            ("GO X5.", "G0 X5.", "Write G0"),
            ("#100=1O.", "#100=10.", "Write 10."),
            ("#1OO=5.", "#100=5.", "Write 100"),
            ("(GO1) GO1 X1O.", "(GO1) G01 X1O.", "Write G01"),
            ("G0 X10,5", "G0 X10.5", "Write 10.5"),
            ("GOTO N10", "GOTO 10", "Write GOTO 10"),
            ("G0 X\u{2212}10.", "G0 X-10.", "Write the minus '-'"),
            ("IF[#1==2]GOTO 5", "IF[#1 EQ 2]GOTO 5", "Write EQ"),
            ("IF[#1 > 2.]GOTO 5", "IF[#1 GT 2.]GOTO 5", "Write GT"),
            ("IF[#1 >2.]GOTO 5", "IF[#1 GT 2.]GOTO 5", "Write GT"),
            ("#1=1E3", "#1=1000.", "Write 1000."),
            ("G0 Z--5.", "G0 Z-5.", "Write Z-5."),
            ("G0 X1. (OPEN X2.", "G0 X1. (OPEN X2.)", "Close the comment at the end of the line"),
            ("#2=#101*3.1416", "#2=#101*3.14159265", "Write 3.14159265"),
        ] {
            let (found, titles) = corrected(wrong);
            assert!(found == right && titles[0] == title, "{wrong}: {found} {titles:?}");
        }
    }

    #[test]
    fn other_findings_have_none() {
        for line in ["GOTO 77", "X..5", "#1=[2", "IF[#1 EQ 1]THEN"] {
            assert_eq!(corrected(line).1, [""; 0], "{line}");
        }
    }
}
