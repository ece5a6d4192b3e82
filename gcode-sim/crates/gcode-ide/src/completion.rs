//! Completion: codes, variables, sequence numbers, programs, arguments and keywords that fit at a place.
use std::collections::BTreeSet;

use gcode_lang::program::m_codes::M_CODES;
use gcode_lang::program::{g_codes, names};
use gcode_lang::syntax::ast::ProgramName;

use crate::code_text::{g_text, m_text};
use crate::entry::EntryKind;
use crate::head_comment::title;
use crate::language_text::WORDS;
use crate::lexer::{Lexeme, LexemeKind};
use crate::project::{ProgramKey, Project};
use crate::scope::VariableScope;
use crate::system_text::{common_system_variables, system_text};
use crate::text::{FileId, TextRange, line_range, lossy};

/// Kind of a completion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CompletionKind {
    /// Argument that a called macro takes.
    Argument,
    /// Sequence number of the program.
    Number,
    /// Program of the project.
    Program,
    /// Local, common or system variable.
    Variable,
    /// G code.
    GCode,
    /// M code.
    MCode,
    /// Function.
    Function,
    /// Keyword or operator.
    Keyword,
}

/// One completion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// Text in the list.
    pub label: String,
    /// Meaning in a few words.
    pub detail: String,
    /// Kind.
    pub kind: CompletionKind,
    /// Text to insert.
    pub insert: String,
    /// Text that begins with what is typed: G1 finds G01.
    pub filter: String,
    /// Range that the text replaces: what is typed of the word.
    pub replace: TextRange,
}

/// Most sequence numbers and variables of a list.
const MAX_OFFERED: usize = 500;

/// Word before the cursor, as far as it is typed.
struct CursorWord {
    /// Text of the word so far, in capitals: `G8`, `#10`, `WH`, empty behind a space.
    text: String,
    range: TextRange,
    /// Elements before the word.
    before: Vec<Lexeme>,
}

impl Project {
    /// Returns the completions at an offset, the likeliest first; none in a comment.
    pub fn completions(&self, file: FileId, offset: u32) -> Vec<Completion> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let text = index.text();
        let offset = offset.min(text.len() as u32);
        let line = line_range(text, offset);
        let lexemes = self.line_lexemes(file, line);
        let is_comment = |lexeme: &&Lexeme| {
            lexeme.kind == LexemeKind::Comment
                && lexeme.range.start < offset
                && (offset < lexeme.range.end || text.get(lexeme.range.end as usize - 1) != Some(&b')'))
        };
        if lexemes.iter().any(|lexeme| is_comment(&lexeme)) {
            return Vec::new();
        }
        let typed = typed(text, line, offset, &lexemes);
        let key = self.program_at(file, offset);
        let mut found = Vec::new();
        let digits = typed.text.trim_start_matches(|c: char| c.is_ascii_alphabetic());
        let letter = typed.text.bytes().next().unwrap_or_default();
        let is_code = typed.text.len() - digits.len() == 1;
        let last = typed.before.last().map(|lexeme| lexeme.kind);
        if typed.text.starts_with('#') {
            found.extend(key.map(|key| self.variables(key, &typed)).unwrap_or_default());
        } else if last == Some(LexemeKind::Keyword("GOTO")) {
            found.extend(key.map(|key| self.numbers(key, &typed, 0)).unwrap_or_default());
        } else if is_code && letter == b'P' && self.takes_program(text, &lexemes) {
            found = self.program_numbers(&typed);
        } else if is_code && letter == b'P' && self.takes_number(text, &lexemes) {
            let programs = key.map(|key| match self.block_kind(text, &lexemes).is_return {
                true => self.return_programs(key),
                false => vec![key],
            });
            found.extend(programs.into_iter().flatten().flat_map(|key| self.numbers(key, &typed, 1)));
        } else if is_code && letter == b'Q' && self.block_kind(text, &lexemes).is_subprogram_call {
            let programs = key.map(|key| self.started_programs(key, TextRange::new(line.start, line.start)));
            found.extend(programs.into_iter().flatten().flat_map(|key| self.numbers(key, &typed, 1)));
        } else if is_expression(text, &typed.before) {
            found.extend(words(&typed, true));
        } else if let Some(arguments) = self.arguments(file, offset, &typed) {
            found = arguments;
        } else {
            if is_code && letter == b'G' || typed.text.is_empty() {
                found.extend(self.g_codes(&typed));
            }
            if is_code && letter == b'M' || typed.text.is_empty() {
                found.extend(self.m_codes(&typed));
            }
            found.extend(words(&typed, false));
        }
        found.retain(|completion| {
            completion.filter.starts_with(typed.text.trim_start_matches(['P', 'Q']))
                || completion.filter.starts_with(&typed.text)
        });
        // `GOTO10`: the number follows without a space.
        if typed.text == "GOTO" {
            let behind =
                CursorWord { text: String::new(), range: TextRange::new(offset, offset), before: Vec::new() };
            found.extend(key.map(|key| self.numbers(key, &behind, 0)).unwrap_or_default());
        }
        found
    }

    fn g_codes(&self, typed: &CursorWord) -> Vec<Completion> {
        let settings = self.settings();
        let mut codes: BTreeSet<u32> = g_codes::all()
            .iter()
            .filter(|row| row.dialects.contains(&settings.codes))
            .map(|row| row.code)
            .collect();
        let called = (1..=9999).map(|code| code * 10);
        codes.extend(called.filter(|code| settings.code_calls.find_call(b'G', *code).is_some()));
        let codes = codes.into_iter().filter_map(|code| Some((code, g_text(code, settings)?)));
        codes.map(|(code, detail)| code_completion('G', code, detail, CompletionKind::GCode, typed)).collect()
    }

    fn m_codes(&self, typed: &CursorWord) -> Vec<Completion> {
        let settings = self.settings();
        let mut codes: BTreeSet<u32> =
            M_CODES.iter().filter(|row| row.dialects.contains(&settings.codes)).map(|row| row.code).collect();
        codes.extend((1..=999).filter(|code| settings.code_calls.find_call(b'M', code * 10).is_some()));
        let codes = codes.into_iter().map(|code| (code, m_text(code, settings)));
        codes
            .map(|(code, detail)| code_completion('M', code * 10, detail, CompletionKind::MCode, typed))
            .collect()
    }

    /// Returns the sequence numbers of a program; the typed word has `letters` letters before its number.
    fn numbers(&self, key: ProgramKey, typed: &CursorWord, letters: u32) -> Vec<Completion> {
        let Some(index) = self.file(key.file) else { return Vec::new() };
        let replace = TextRange::new(typed.range.start + letters, typed.range.end);
        let mut seen = BTreeSet::new();
        let numbers = index.program_entries(key.program).filter(|entry| entry.kind == EntryKind::Number);
        let numbers = numbers.filter(|entry| seen.insert(entry.value)).take(MAX_OFFERED).map(|entry| {
            let line = line_range(index.text(), entry.range.start);
            let block = lossy(TextRange::new(entry.range.end, line.end).of(index.text()));
            let label = entry.value.to_string();
            Completion {
                filter: label.clone(),
                insert: label.clone(),
                label,
                detail: block.trim().to_owned(),
                kind: CompletionKind::Number,
                replace,
            }
        });
        numbers.collect()
    }

    fn program_numbers(&self, typed: &CursorWord) -> Vec<Completion> {
        let replace = TextRange::new(typed.range.start + 1, typed.range.end);
        let mut seen = BTreeSet::new();
        let keys: Vec<_> = self.programs().map(|(key, _)| key).collect();
        let programs = keys.into_iter().filter_map(|key| {
            let Some(ProgramName::Number(number)) = self.name_of(key) else { return None };
            let label = seen.insert(number).then(|| number.to_string())?;
            let detail = self.file(key.file).and_then(|index| title(index, key.program)).unwrap_or_default();
            let kind = CompletionKind::Program;
            Some(Completion { filter: label.clone(), insert: label.clone(), label, detail, kind, replace })
        });
        programs.collect()
    }

    /// Returns the letters that the macro call of a block still lacks; `None` outside a macro call.
    fn arguments(&self, file: FileId, offset: u32, typed: &CursorWord) -> Option<Vec<Completion>> {
        let call = self.macro_call_at(file, offset).filter(|call| call.code.end <= typed.range.start)?;
        let called = self.called_program(file, &call.record.target)?;
        if typed.text.bytes().any(|byte| byte.is_ascii_digit()) {
            return Some(Vec::new());
        }
        let passed: Vec<_> = call
            .record
            .arguments
            .iter()
            .filter(|argument| !call.place(argument.range()).touches(offset))
            .map(|argument| argument.local())
            .collect();
        let mut lacking = self.parameters_of(called);
        lacking.retain(|parameter| !passed.contains(&parameter.local));
        lacking.sort_by_key(|parameter| (parameter.is_optional, parameter.letter));
        let offered = lacking.into_iter().map(|parameter| {
            let label = parameter.letter.to_string();
            Completion {
                filter: label.clone(),
                insert: label.clone(),
                label,
                detail: format!("#{} {}", parameter.local, parameter.text).trim_end().to_owned(),
                kind: CompletionKind::Argument,
                replace: typed.range,
            }
        });
        Some(offered.collect())
    }

    fn variables(&self, key: ProgramKey, typed: &CursorWord) -> Vec<Completion> {
        let kind = CompletionKind::Variable;
        let settings = self.settings();
        if typed.text.starts_with("#_") {
            let named = names::all().map(|row| {
                let suffix = row.suffix.map_or_else(String::new, |(from, _)| format!("[{from}]"));
                let label = format!("#{}{suffix}", row.name);
                let detail =
                    format!("#{} {}", row.number, system_text(row.number, settings).unwrap_or_default());
                Completion {
                    filter: label.clone(),
                    insert: label.clone(),
                    label,
                    detail,
                    kind,
                    replace: typed.range,
                }
            });
            return named.collect();
        }
        let mut own = BTreeSet::new();
        let mut commons = BTreeSet::new();
        for (other, _) in self.programs() {
            let Some(index) = self.file(other.file) else { continue };
            for entry in index.program_entries(other.program) {
                if !matches!(entry.kind, EntryKind::Read | EntryKind::Write) {
                    continue;
                }
                match VariableScope::of(entry.value, settings) {
                    VariableScope::Local if other == key => own.insert(entry.value),
                    VariableScope::Common => commons.insert(entry.value),
                    _ => false,
                };
            }
        }
        let used =
            own.into_iter().chain(commons).filter(|number| format!("#{number}").starts_with(&typed.text));
        let used = used
            .take(MAX_OFFERED)
            .map(|number| (number, self.stated_meaning(number, key).unwrap_or_default()));
        let system = common_system_variables()
            .map(|number| (number, system_text(number, settings).unwrap_or_default()));
        let all = used.chain(system).map(|(number, detail)| {
            let label = format!("#{number}");
            Completion {
                filter: label.clone(),
                insert: label.clone(),
                label,
                detail,
                kind,
                replace: typed.range,
            }
        });
        all.collect()
    }

    /// Returns true if P is a program in a line.
    fn takes_program(&self, text: &[u8], lexemes: &[Lexeme]) -> bool {
        let kind = self.block_kind(text, lexemes);
        kind.is_macro_call || kind.is_subprogram_call
    }

    /// Returns true if P in a line is a sequence number of its program. So it is with M97, and with M99 of a main
    /// program.
    fn takes_number(&self, text: &[u8], lexemes: &[Lexeme]) -> bool {
        let is_local = lexemes.windows(2).any(|pair| {
            let number = lossy(pair[1].range.of(text));
            pair[0].kind == LexemeKind::Letter(b'M') && pair[1].kind == LexemeKind::Number && number == "97"
        });
        is_local || self.block_kind(text, lexemes).is_return
    }
}

/// Returns what is typed of the word at an offset.
fn typed(text: &[u8], line: TextRange, offset: u32, lexemes: &[Lexeme]) -> CursorWord {
    let before = TextRange::new(line.start, offset).of(text);
    let behind = |fits: fn(&u8) -> bool, from: usize| {
        before[..from].iter().rev().take_while(|byte| fits(byte)).count()
    };
    let number = behind(|byte| byte.is_ascii_digit() || *byte == b'.', before.len());
    let letters_end = before.len() - number;
    let letters = behind(|byte| byte.is_ascii_alphabetic() || *byte == b'_', letters_end);
    let is_variable = |from: usize| from > 0 && before[from - 1] == b'#';
    let length = match (number, letters) {
        _ if is_variable(letters_end - letters) => number + letters + 1,
        (0, letters) => letters,
        // `GOTO10`, `DO1`: the number stands alone.
        (number, 0 | 2..) => number,
        (number, _) => number + 1,
    };
    let start = offset - length as u32;
    let range = TextRange::new(start, offset);
    let text = lossy(range.of(text)).to_ascii_uppercase();
    let before = lexemes.iter().filter(|lexeme| lexeme.range.end <= start).copied().collect();
    CursorWord { text, range, before }
}

/// Returns true inside brackets, and behind `=`.
fn is_expression(text: &[u8], before: &[Lexeme]) -> bool {
    let mut depth = 0;
    let mut is_value = false;
    for lexeme in before {
        match lexeme.kind {
            LexemeKind::Bracket(b'[') => depth += 1,
            LexemeKind::Bracket(_) => depth -= 1,
            LexemeKind::Operator => is_value |= lexeme.range.of(text) == b"=",
            LexemeKind::Keyword(_) => is_value = false,
            _ => {}
        }
    }
    depth > 0 || is_value
}

/// Returns the words of the language: functions and operators in an expression, otherwise the keywords.
fn words(typed: &CursorWord, in_expression: bool) -> Vec<Completion> {
    let is_operator = |word: &str| crate::lexer::OPERATORS.contains(&word);
    let fits = |row: &&crate::language_text::LanguageRow| {
        (row.is_function || is_operator(row.word)) == in_expression
    };
    let offered = WORDS.iter().filter(fits).map(|row| Completion {
        label: row.word.to_owned(),
        detail: row.text.to_owned(),
        kind: if row.is_function { CompletionKind::Function } else { CompletionKind::Keyword },
        insert: row.word.to_owned(),
        filter: row.word.to_owned(),
        replace: typed.range,
    });
    offered.collect()
}

/// Returns the completion of a code × 10; `G1` finds G01 and G10.
fn code_completion(
    letter: char,
    code: u32,
    detail: String,
    kind: CompletionKind,
    typed: &CursorWord,
) -> Completion {
    let label = format!("{letter}{}", g_codes::spelled(code));
    let plain = format!("{letter}{}", f64::from(code) / 10.0);
    let filter = if label.starts_with(&typed.text) { label.clone() } else { plain };
    Completion { insert: label.clone(), label, detail, kind, filter, replace: typed.range }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{fixture, fixture_on};
    use gcode_lang::control::{Dialect, Settings};

    fn offered(text: &str) -> Vec<String> {
        let fixture = fixture(text);
        let found = fixture.project.completions(fixture.file, fixture.offset).into_iter();
        found.map(|completion| completion.label).collect()
    }

    #[test]
    fn codes_of_the_control_are_offered() {
        assert_eq!(offered("G90 G8$0\n")[..3], ["G08", "G80", "G80.4"].map(String::from));
        assert!(offered("G1$0\n").contains(&"G01".into()) && offered("G1$0\n").contains(&"G10".into()));
        assert!(!offered("G18$0\n").contains(&"G187".into()), "a code of a Haas");
        let mut settings = Settings::default();
        settings.apply_dialect(Dialect::HaasNgc);
        let haas = fixture_on("G18$0\n", settings);
        let found = haas.project.completions(haas.file, haas.offset);
        assert!(found.iter().any(|completion| completion.label == "G187"));
        assert_eq!(offered("M3$0\n"), ["M03", "M30"]);
        let all = offered("O1\n$0\n");
        assert!(["G83", "M98", "WHILE"].iter().all(|wanted| all.iter().any(|label| label == wanted)));
    }

    #[test]
    fn numbers_and_programs_are_offered() {
        let text = "O1\nN10 X1.\nN20\nGOTO $0\nO2\nN30\n";
        assert_eq!(offered(text), ["10", "20"]);
        assert_eq!(offered("O1\nN10 X1.\nN20\nIF[#1 EQ 1]GOTO2$0\n"), ["20"]);
        assert_eq!(offered("O1\nN10 X1.\nIF[#1 EQ 1]GOTO$0\n"), ["GOTO", "10"]);
        assert_eq!(offered("O1\nN10 X1.\nIF[#1 EQ 1]GOT$0\n"), ["GOTO"]);
        assert_eq!(offered("O1\nN10\nM99 P$0\n"), ["10"]);
        assert_eq!(offered("O1\nM98 P2\nN7\nO2\nN8\nM99 P$0\n"), ["7"], "in the caller");
        assert_eq!(offered("O1\nM98 P2 Q$0\nN7\nO2\nN8\nM99\n"), ["8"], "in the called program");
        let calls = "//- O1.nc\nO1\nG65 P$0\n//- O8101.nc\nO8101(HOLE)\n";
        assert_eq!(offered(calls), ["1", "8101"]);
        assert_eq!(offered(&calls.replace("P$0", "P81$0")), ["8101"]);
        assert_eq!(offered(&calls.replace("G65 P$0", "M98 P$0")), ["1", "8101"]);
        let fixture = fixture(&calls.replace("P$0", "P81$0"));
        let found = fixture.project.completions(fixture.file, fixture.offset);
        assert_eq!(
            (found[0].detail.as_str(), fixture.text(FileId(0), found[0].replace)),
            ("HOLE", "81".into())
        );
    }

    #[test]
    fn arguments_that_a_call_lacks_are_offered() {
        let library = "O9\n(R #18 RADIUS)\nIF[#6 EQ #0]THEN #6=1.\nX[#18*#7*#6]\nM99\n";
        let call = |words: &str| offered(&format!("O1\nG65 P9 {words}\nM30\n{library}"));
        assert_eq!(call("$0"), ["D", "R", "K"], "K may be left out");
        assert_eq!(call("D5. $0"), ["R", "K"]);
        assert_eq!(call("D5. R1. K$0"), ["K"]);
        assert_eq!(call("D5$0"), [""; 0]);
        assert!(call("D[S$0").contains(&"SIN".into()), "an expression");
        assert_eq!(call("D#$0")[..1], ["#3000".to_owned()]);
    }

    #[test]
    fn variables_are_offered_by_number_and_name() {
        let text = "//- O1.nc\nO1\n#3=1 (FEED)\n#101=2\nX#$0\n//- O2.nc\nO2\n#7=#500\n";
        assert_eq!(offered(text)[..3], ["#3", "#101", "#500"].map(String::from));
        assert!(offered(&text.replace("X#$0", "X#50$0")).contains(&"#5021".into()));
        assert!(offered(&text.replace("X#$0", "X[#_AB$0]")).contains(&"#_ABSMT[1]".into()));
    }

    #[test]
    fn words_of_the_language_are_offered_where_they_fit() {
        assert_eq!(offered("O1\nWH$0\n"), ["WHILE"]);
        assert_eq!(offered("O1\n#1=S$0\n"), ["SIN", "SQRT"]);
        assert_eq!(offered("O1\nIF[#1 E$0\n"), ["EXP", "EQ"]);
        assert_eq!(offered("O1\n(G$0)\n"), [""; 0]);
        assert_eq!(offered("O1\n(G$0\n"), [""; 0]);
        assert!(offered("").len() > 100);
    }
}
