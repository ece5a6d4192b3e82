//! Hover: what a word, a variable or a function means.
use gcode_lang::alarm::kinds;
use gcode_lang::control::DeclaredEffect;
use gcode_lang::diag::FindingKind;
use gcode_lang::program::g_codes::{self, Effect};
use gcode_lang::program::modes::Motion;
use gcode_lang::syntax::ast::{Item, ProgramName, Statement};
use gcode_lint::rules;
use gcode_lint::{constant, variable};

use crate::code_text::{BlockKind, address_text, g_row, g_text, m_text};
use crate::head_comment::title;
use crate::language_text::language_row;
use crate::lexer::{Lexeme, LexemeKind, lexemes};
use crate::navigation::Access;
use crate::project::{ProgramKey, Project};
use crate::scope::VariableScope;
use crate::symbol::Symbol;
use crate::system_text::{access_text, system_name, system_text};
use crate::text::{FileId, TextRange, line_range, lossy};

/// Explanation of a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// Explained text.
    pub range: TextRange,
    /// Explanation, Markdown.
    pub markdown: String,
    /// Symbol at the place, for values of a run.
    pub symbol: Option<Symbol>,
}

impl Project {
    /// Returns the explanation of an offset.
    pub fn hover(&self, file: FileId, offset: u32) -> Option<Hover> {
        let index = self.file(file)?;
        let line = line_range(index.text(), offset);
        let lexemes = self.line_lexemes(file, line);
        let at = lexemes.iter().position(|lexeme| lexeme.range.start <= offset && offset < lexeme.range.end);
        let at = at.or_else(|| lexemes.iter().position(|lexeme| lexeme.range.touches(offset)));
        if let Some(comment) = at.map(|at| lexemes[at]).filter(|at| at.kind == LexemeKind::Comment) {
            let of_code = || {
                let (range, kind) = finding_at(index.text(), line, offset)?;
                Some((range, finding_text(kind)))
            };
            let of_stop = || Some((comment.range, self.stop_text(file, offset)?));
            let (range, markdown) = of_code().or_else(of_stop)?;
            return Some(Hover { range, markdown, symbol: None });
        }
        if let Some((symbol, range)) = self.symbol_at(file, offset)
            && let Some(markdown) = self.symbol_text(&symbol, file, offset, range)
        {
            // A code that calls is explained as a code, with its program.
            return Some(Hover { range, markdown, symbol: Some(symbol) });
        }
        let of_stop = || Some((self.stop_number(file, offset)?, self.stop_text(file, offset)?));
        let (range, markdown) = self.lexeme_text(file, &lexemes, at?).or_else(of_stop)?;
        Some(Hover { range, markdown, symbol: None })
    }

    /// Returns the elements of a line.
    pub(crate) fn line_lexemes(&self, file: FileId, line: TextRange) -> Vec<Lexeme> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let comments = self
            .block(file, line.start)
            .map(|block| block.comments.iter().map(|comment| comment.span.into()).collect::<Vec<_>>());
        lexemes(index.text(), line, &comments.unwrap_or_default())
    }

    fn symbol_text(&self, symbol: &Symbol, file: FileId, offset: u32, range: TextRange) -> Option<String> {
        match symbol {
            Symbol::Variable { number, scope, program } => {
                Some(self.variable_text(*number, *scope, *program, file, offset))
            }
            Symbol::Argument { letter, local, called } => {
                let Some(key) = called else {
                    return Some(format!("**{letter}** sets #{local} of the called macro"));
                };
                let meaning =
                    self.stated_meaning(*local, *key).map_or_else(String::new, |text| format!(": {text}"));
                Some(format!("**{letter}** sets #{local} of {}{meaning}", self.label(*key)))
            }
            Symbol::SequenceNumber { number, programs } => Some(self.number_text(*number, programs)),
            Symbol::Program { name } => Some(self.program_text(name, file, range)),
            Symbol::ComputedVariable => Some("variable whose number is computed".into()),
            Symbol::ComputedJump => Some("sequence number that is computed".into()),
            Symbol::ComputedCall => None,
        }
    }

    fn variable_text(
        &self,
        number: u32,
        scope: VariableScope,
        key: ProgramKey,
        file: FileId,
        offset: u32,
    ) -> String {
        let settings = self.settings();
        if scope == VariableScope::System {
            let name = system_name(number).map_or_else(String::new, |name| format!(" `[{name}]`"));
            let meaning =
                system_text(number, settings).unwrap_or_else(|| "no variable of this control".into());
            let mut text = format!(
                "**#{number}**{name} {meaning}\n\nsystem variable, {}",
                access_text(number, settings)
            );
            if let Some(alarm) = self.stop_text(file, offset).filter(|_| matches!(number, ALARM | MESSAGE)) {
                text.push_str(&format!("\n\n{alarm}"));
            }
            return text;
        }
        if scope == VariableScope::Null {
            return "**#0** is always vacant".into();
        }
        let mut text = format!("**#{number}**");
        if let Some((meaning, program)) = self.meaning(number, key) {
            text.push_str(&format!(" {meaning}"));
            text.push_str(&program.map_or_else(String::new, |program| format!(" ({program})")));
        }
        let letter =
            gcode_lang::program::argument_letter(number as usize).filter(|_| scope == VariableScope::Local);
        let place = match scope {
            VariableScope::Local => format!(" of {}", self.label(key)),
            _ => " of all programs".into(),
        };
        text.push_str(&format!("\n\n{}{place}", scope.name()));
        text.push_str(&letter.map_or_else(String::new, |letter| format!(", argument {letter}")));
        let uses = self.symbol_references(&Symbol::Variable { number, scope, program: key }, file);
        let count = |access: Access| uses.iter().filter(|reference| reference.access == access).count();
        let (set, read) = (count(Access::Write), count(Access::Read));
        text.push_str(&format!("; set {}, read {}", times(set), times(read)));
        text
    }

    /// Returns the alarm or message of an assignment to #3000 or #3006 in the line.
    fn stop_text(&self, file: FileId, offset: u32) -> Option<String> {
        let block = self.block(file, offset)?;
        let stop = block.items.iter().find_map(stop_by_variable)?;
        let comment = block.comments.first().map(|comment| lossy(&comment.text)).unwrap_or_default();
        let text = if comment.is_empty() { String::new() } else { format!(": {comment}") };
        if stop.variable == MESSAGE {
            return Some(format!("stops with the message **{}**", comment.trim()));
        }
        let settings = self.settings();
        let shows_large = settings.undocumented.shows_large_alarm_numbers;
        let max = if shows_large { LARGEST_SHOWN } else { f64::from(settings.macro_alarm_max) };
        let number = stop.value.round();
        if !(0.0..=max).contains(&number) {
            return Some(format!("raises alarm **PS0119**: n of #3000 is 0 to {max}"));
        }
        Some(format!("raises alarm **MC{:04}**{text}", f64::from(settings.macro_alarm_base) + number))
    }

    /// Returns the range of n in `#3000=n` or `#3006=n` if it has an offset.
    fn stop_number(&self, file: FileId, offset: u32) -> Option<TextRange> {
        let stop = self.block(file, offset)?.items.iter().find_map(stop_by_variable)?;
        stop.range.touches(offset).then_some(stop.range)
    }

    fn number_text(&self, number: u32, programs: &[ProgramKey]) -> String {
        let Some(key) = programs.first() else { return format!("**N{number}**") };
        let references = self.number_references(*key, number);
        let declared = references.iter().find(|reference| reference.access == Access::Declaration);
        let jumps = references.iter().filter(|reference| reference.access == Access::Read).count();
        let label = self.label(*key);
        match declared {
            Some(reference) => {
                let index = self.file(reference.location.file);
                let text = index.map(|index| {
                    let line = line_range(index.text(), reference.location.range.start);
                    lossy(TextRange::new(reference.location.range.start, line.end).of(index.text()))
                });
                let text = text.unwrap_or_default();
                let jumps = if jumps == 1 { "1 jump".to_owned() } else { format!("{jumps} jumps") };
                format!("**N{number}** of {label}, {jumps}\n\n`{}`", text.trim())
            }
            None => format!("**N{number}** is not in {label}"),
        }
    }

    fn program_text(&self, name: &ProgramName, file: FileId, range: TextRange) -> String {
        let mut text = String::new();
        let word = self.file(file).map(|index| lossy(range.of(index.text()))).unwrap_or_default();
        if let Some((letter, code)) = code_of(&word) {
            let (title, meaning) = match letter {
                b'G' => (g_codes::name(code), g_text(code, self.settings())),
                _ => (format!("M{:02}", code / 10), Some(m_text(code / 10, self.settings()))),
            };
            text = format!("**{title}** {}\n\n", meaning.unwrap_or_default());
        }
        let Some(key) = self.programs_named(name, file).first().copied() else {
            return format!("{text}**{}** is not in the project", name.label());
        };
        let title = self.file(key.file).and_then(|index| title(index, key.program)).unwrap_or_default();
        text.push_str(format!("**{}** {title}", name.label()).trim_end());
        for parameter in self.parameters_of(key) {
            let (letter, local, meaning) = (parameter.letter, parameter.local, parameter.text);
            text.push_str(format!("\n- {letter} #{local} {meaning}").trim_end());
        }
        text
    }

    /// Returns the explanation of a lexical element.
    fn lexeme_text(&self, file: FileId, lexemes: &[Lexeme], at: usize) -> Option<(TextRange, String)> {
        let text = self.file(file)?.text();
        // A number is explained with its letter.
        let at = match lexemes[at].kind {
            LexemeKind::Number if at > 0 && matches!(lexemes[at - 1].kind, LexemeKind::Letter(_)) => at - 1,
            _ => at,
        };
        let lexeme = lexemes[at];
        let word = lossy(lexeme.range.of(text));
        match lexeme.kind {
            LexemeKind::Letter(letter) => {
                let number = lexemes.get(at + 1).filter(|next| next.kind == LexemeKind::Number);
                let range =
                    TextRange::new(lexeme.range.start, number.map_or(lexeme.range.end, |n| n.range.end));
                let code = code_of(&lossy(range.of(text)));
                let markdown = match (letter, code) {
                    (b'G', Some((_, code))) => self.g_markdown(code),
                    (b'M', Some((_, code))) => self.m_markdown(code),
                    _ => {
                        let meaning = address_text(letter, self.block_kind(text, lexemes), self.settings())?;
                        format!("**{}** {meaning}", char::from(letter))
                    }
                };
                Some((range, markdown))
            }
            LexemeKind::Keyword(keyword) => {
                let row = language_row(keyword)?;
                Some((lexeme.range, format!("`{}` {}", row.form, row.text)))
            }
            LexemeKind::Function | LexemeKind::Operator => {
                let row = language_row(&word)?;
                Some((lexeme.range, format!("`{}` {}", row.form, row.text)))
            }
            _ => None,
        }
    }

    fn g_markdown(&self, code: u32) -> String {
        let settings = self.settings();
        match g_text(code, settings) {
            Some(text) => format!("**{}** {text}", g_codes::name(code)),
            None => format!("**{}** is no code of {}", g_codes::name(code), settings.codes.name()),
        }
    }

    fn m_markdown(&self, code: u32) -> String {
        let text = m_text(code / 10, self.settings());
        let declared = match self.settings().declared_codes.find(b'M', code) {
            Some(DeclaredEffect::Nothing) => ", declared to do nothing",
            Some(DeclaredEffect::Wait) => ", declared to wait for the moves before it",
            None => "",
        };
        format!("**M{:02}** {text}{declared}", code / 10)
    }

    /// Returns what the codes of a line make of its addresses.
    pub(crate) fn block_kind(&self, text: &[u8], lexemes: &[Lexeme]) -> BlockKind {
        let mut kind = BlockKind::default();
        for pair in lexemes.windows(2) {
            let range = TextRange::new(pair[0].range.start, pair[1].range.end);
            let (LexemeKind::Letter(_), LexemeKind::Number) = (pair[0].kind, pair[1].kind) else { continue };
            match code_of(&lossy(range.of(text))) {
                Some((b'G', 650 | 660 | 661)) => kind.is_macro_call = true,
                Some((b'M', 980 | 1980)) => kind.is_subprogram_call = true,
                Some((b'M', 990)) => kind.is_return = true,
                Some((b'G', 40)) => kind.is_dwell = true,
                Some((b'G', code)) => match g_row(code, self.settings()).map(|row| row.effect) {
                    Some(Effect::Cycle(Some(_))) => kind.is_cycle = true,
                    Some(Effect::Motion(Motion::Clockwise | Motion::Counterclockwise)) => kind.is_arc = true,
                    _ => kind.is_macro_call |= self.settings().code_calls.find_call(b'G', code).is_some(),
                },
                _ => {}
            }
        }
        kind
    }
}

/// Returns letter and number × 10 of `G54.1`, `M3`.
fn code_of(word: &str) -> Option<(u8, u32)> {
    let letter = word.bytes().next()?.to_ascii_uppercase();
    let number: f64 = word.get(1..)?.trim().parse().ok().filter(|number| (0.0..1e8).contains(number))?;
    matches!(letter, b'G' | b'M').then_some((letter, (number * 10.0).round() as u32))
}

/// Number of the variable that raises an alarm, and of the one that stops with a message.
const ALARM: u32 = 3000;
const MESSAGE: u32 = 3006;

/// Largest n of `#3000=n` on a control that shows numbers beyond those of its manual.
const LARGEST_SHOWN: f64 = 4095.0;

/// An assignment of a constant to #3000 or #3006.
struct StopByVariable {
    variable: u32,
    value: f64,
    /// The value as written.
    range: TextRange,
}

fn stop_by_variable(item: &Item) -> Option<StopByVariable> {
    fn of(statement: &Statement) -> Option<StopByVariable> {
        match statement {
            Statement::Assign { target, value } => {
                let variable = variable(target).filter(|number| matches!(*number, ALARM | MESSAGE))?;
                Some(StopByVariable { variable, value: constant(value)?, range: value.span.into() })
            }
            Statement::IfThen { then, .. } => of(then),
            _ => None,
        }
    }
    match item {
        Item::Statement(statement) => of(&statement.node),
        _ => None,
    }
}

/// Returns the code of an alarm or of a rule of `check` at an offset of a comment, with its kind.
fn finding_at(text: &[u8], line: TextRange, offset: u32) -> Option<(TextRange, &'static FindingKind)> {
    let is_of_code = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'-';
    let (before, behind) =
        text[line.start as usize..line.end as usize].split_at((offset - line.start) as usize);
    let before = before.iter().rev().take_while(|byte| is_of_code(byte)).count() as u32;
    let behind = behind.iter().take_while(|byte| is_of_code(byte)).count() as u32;
    let range = TextRange::new(offset - before, offset + behind);
    let code = range.of(text);
    let is_raised = || {
        code.len() == 6 && code[..2].eq_ignore_ascii_case(b"MC") && code[2..].iter().all(u8::is_ascii_digit)
    };
    let known = kinds::ALL.iter().copied().chain(rules::ALL.iter().map(|rule| &rule.kind));
    let mut known = known.filter(|kind| kind.code.as_bytes().eq_ignore_ascii_case(code));
    let kind = known.next().or_else(|| is_raised().then_some(&kinds::MC3000))?;
    Some((range, kind))
}

/// Returns the title of a kind of finding and the first paragraph of its page.
fn finding_text(kind: &FindingKind) -> String {
    let paragraph = kind.page().split("\n\n").nth(1).unwrap_or_default();
    format!("**{}** {}\n\n{}", kind.code, kind.title, paragraph.trim())
}

fn times(count: usize) -> String {
    match count {
        0 => "never".into(),
        1 => "once".into(),
        _ => format!("{count} times"),
    }
}

#[cfg(test)]
mod tests {
    use crate::testing::{fixture, fixture_on};
    use gcode_lang::control::{Dialect, Settings};

    fn hovered(text: &str) -> String {
        let fixture = fixture(text);
        fixture.project.hover(fixture.file, fixture.offset).map(|hover| hover.markdown).unwrap_or_default()
    }

    #[test]
    fn variables_have_their_meaning() {
        assert_eq!(
            hovered("O8101(T)\n(R #18 RADIUS OF THE HOLE)\nX#$018\nM99\n"),
            "**#18** RADIUS OF THE HOLE\n\nlocal variable of O8101, argument R; set never, read once"
        );
        assert_eq!(
            hovered("//- O1.nc\nO1\nX#$0500\n//- O2.nc\nO2\n#500=5. (FEED OUT)\n"),
            "**#500** FEED OUT (O0002)\n\ncommon variable of all programs; set once, read once"
        );
        assert_eq!(
            hovered("O1\n#1=#$05023\n"),
            "**#5023** `[#_ABSMT[3]]` position, machine coordinates, axis 3 (Z)\n\nsystem variable, read only"
        );
        assert!(hovered("O1\n#1=[#_A$0BSMT[3]]\n").contains("machine coordinates, axis 3 (Z)"));
        assert!(hovered("O1\nIF[#1 LE 0]THEN #30$000=12(NO R)\n").ends_with("raises alarm **MC3012**: NO R"));
        assert!(hovered("O1\n#300$06=1(TURN)\n").ends_with("stops with the message **TURN**"));
        assert_eq!(
            hovered("O1\nG65 P2 R$05.\nO2\n(R #18 RADIUS)\nX#18\n"),
            "**R** sets #18 of O0002: RADIUS"
        );
    }

    #[test]
    fn the_number_of_an_alarm_is_explained_as_the_control_shows_it() {
        assert_eq!(hovered("O1\n#3000=$07(TOO BIG)\n"), "raises alarm **MC3007**: TOO BIG");
        assert_eq!(hovered("O1\n#3000=1$02(TOO BIG)\n"), "raises alarm **MC3012**: TOO BIG");
        assert_eq!(hovered("O1\nIF[#1 EQ 9]THEN #3000=$07\n"), "raises alarm **MC3007**");
        assert_eq!(hovered("O1\nIF[#1 EQ $09]THEN #3000=7(A)\n"), "", "the number of the condition");
        assert_eq!(hovered("O1\n#3006=$01(TURN)\n"), "stops with the message **TURN**");
        assert_eq!(hovered("O1\n#3000=7(TOO $0BIG)\n"), "raises alarm **MC3007**: TOO BIG");
        assert!(hovered("O1\nIF[#1 GT 9]THEN #3000=#$01(A)\n").starts_with("**#1**"));
        assert_eq!(hovered("O1\n#500=$07(TOO BIG)\n"), "");
        // A number above 200 is displayed too, unless the control is told to refuse it.
        assert_eq!(hovered("O1\n#3000=$0201(A)\n"), "raises alarm **MC3201**: A");
        assert_eq!(hovered("O1\n#3000=$04096\n"), "raises alarm **PS0119**: n of #3000 is 0 to 4095");
        assert_eq!(hovered("O1\n#3000=-$01(A)\n"), "raises alarm **PS0119**: n of #3000 is 0 to 4095");
        let on = |text: &str, settings: Settings| {
            let fixture = fixture_on(text, settings);
            fixture.project.hover(fixture.file, fixture.offset).map(|hover| hover.markdown)
        };
        let mut strict = Settings::default();
        strict.undocumented.shows_large_alarm_numbers = false;
        assert_eq!(on("O1\n#3000=$0200(A)\n", strict.clone()).unwrap(), "raises alarm **MC3200**: A");
        let refused = on("O1\n#3000=$0201(A)\n", strict).unwrap();
        assert_eq!(refused, "raises alarm **PS0119**: n of #3000 is 0 to 200");
        let mut haas = Settings::default();
        haas.apply_dialect(Dialect::HaasNgc);
        assert_eq!(on("O1\n#3000=$07(A)\n", haas).unwrap(), "raises alarm **MC1007**: A");
    }

    #[test]
    fn codes_of_alarms_and_rules_in_comments_are_explained() {
        let division = hovered("O1\n(PS01$012 IS RAISED)\n");
        assert!(division.starts_with("**PS0112** division by zero\n\nThe divisor is 0, or"), "{division}");
        assert_eq!(hovered("O1\n($0ps0112)\n"), division);
        assert_eq!(hovered("O1\n(PS0112$0)\n"), division);
        assert!(hovered("O1\n(MC30$012 NO R)\n").starts_with("**MC3000** the program raises a macro alarm"));
        assert!(hovered("O1\nG0(CHECK-OFF mi$0ssing-n)\n").starts_with("**missing-n** "));
        for text in ["O1\n(PS01$0123)\n", "O1\n(A$0)\n", "O1\n(MC30$0)\n", "O1\n(\u{d8}$0)\n"] {
            assert_eq!(hovered(text), "", "{text}");
        }
    }

    #[test]
    fn codes_have_the_meaning_of_the_control() {
        assert_eq!(hovered("G8$03 Z-5.\n"), "**G83** peck drilling cycle, modal group 09");
        assert_eq!(hovered("G0$04 P500\n"), "**G04** dwell, acts in its block");
        assert_eq!(hovered("M$008\n"), "**M08** coolant");
        assert_eq!(hovered("M$0123\n"), "**M123** code of the machine builder");
        assert_eq!(hovered("G4 P$0500\n"), "**P** time, milliseconds");
        assert_eq!(hovered("G83 Z-5. Q$02.\n"), "**Q** depth of a peck, or the shift of a boring cycle");
        assert_eq!(hovered("F$0100\n"), "**F** feed rate");
        let mut settings = Settings::default();
        settings.apply_dialect(Dialect::HaasNgc);
        let haas = fixture_on("G$047\n", settings);
        assert!(haas.project.hover(haas.file, haas.offset).unwrap().markdown.contains("text engraving"));
    }

    #[test]
    fn words_numbers_and_programs_are_explained() {
        assert!(hovered("IF[#1 E$0Q 2]GOTO 5\n").starts_with("`a EQ b` equal"));
        assert!(hovered("#1=AT$0AN[1]/[2]\n").starts_with("`ATAN[a]/[b]` arc tangent"));
        assert!(hovered("WH$0ILE[#1 LT 2]DO1\n").starts_with("`WHILE["));
        assert_eq!(hovered("O1\nGOTO $05\nN5 G0 X1.\n"), "**N5** of O0001, 1 jump\n\n`N5 G0 X1.`");
        assert_eq!(
            hovered("O1\nG65 P$02 A1.\nO2(HOLE)\n(A #1 RADIUS)\nX#1\n"),
            "**O0002** HOLE\n- A #1 RADIUS"
        );
        assert!(hovered("O1\nM9$08 P9\n").starts_with("**M98** subprogram call\n\n**O0009** is not in"));
        assert_eq!(hovered("O1\n(GOTO $05)\n"), "", "a comment");
        assert_eq!(hovered(""), "");
    }
}
