//! Semantic tokens: words by the motion that they make, variables by their scope.
use gcode_lang::control::Settings;
use gcode_lang::program::g_codes::{self, Effect, OneShot};
use gcode_lang::program::names;
use gcode_lang::syntax::{LineItem, line_items};

use crate::chunk_builder::{MotionChange, MotionKind, motion_of};
use crate::lexer::{Lexeme, LexemeKind, lexemes};
use crate::project::Project;
use crate::scope::VariableScope;
use crate::text::{FileId, SOURCE, TextRange, line_range};

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TokenKind {
    /// Comment or remark.
    Comment,
    /// Number.
    Number,
    /// Text of DPRNT, or a program name.
    Text,
    /// IF, WHILE, GOTO and the others.
    Keyword,
    /// EQ, AND, MOD, +, =.
    Operator,
    /// SIN, ROUND and the others.
    Function,
    /// #1 to #33.
    LocalVariable,
    /// #100 to #199, #500 to #999 and further commons.
    CommonVariable,
    /// System variable, by number or by name.
    SystemVariable,
    /// N word, and the target of a jump.
    SequenceNumber,
    /// O word, and the P of a call.
    Program,
    /// G00, and axis words that it moves.
    RapidMotion,
    /// G01, and axis words that it moves.
    FeedMotion,
    /// G02 and G03, and axis words that they move.
    ArcMotion,
    /// Canned cycle, and axis words of its holes.
    CycleMotion,
    /// G65, G66, M98, M99 and codes that call programs.
    Call,
    /// Any other G code.
    GCode,
    /// Any other M code.
    MCode,
    /// Any other address: F, S, T and so on.
    Address,
    /// `/` and `%`.
    Mark,
}

impl TokenKind {
    /// All kinds in ascending order.
    pub const ALL: [Self; 20] = [
        Self::Comment,
        Self::Number,
        Self::Text,
        Self::Keyword,
        Self::Operator,
        Self::Function,
        Self::LocalVariable,
        Self::CommonVariable,
        Self::SystemVariable,
        Self::SequenceNumber,
        Self::Program,
        Self::RapidMotion,
        Self::FeedMotion,
        Self::ArcMotion,
        Self::CycleMotion,
        Self::Call,
        Self::GCode,
        Self::MCode,
        Self::Address,
        Self::Mark,
    ];
}

/// Token of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SemanticToken {
    /// Range in one line.
    pub range: TextRange,
    /// Kind.
    pub kind: TokenKind,
    /// True for an assigned variable.
    pub is_written: bool,
    /// True for the sequence number of a block and an O word.
    pub is_declaration: bool,
}

impl Project {
    /// Returns the tokens of the lines of a range, or of the whole file, in order and without overlaps.
    pub fn semantic_tokens(&self, file: FileId, range: Option<TextRange>) -> Vec<SemanticToken> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let text = index.text();
        let whole = TextRange::new(0, text.len() as u32);
        let range = range.unwrap_or(whole);
        let (begin, end) = (line_range(text, range.start).start, line_range(text, range.end).end);
        let (start, motion) = index.motion_before(begin);
        let mut tokens = Tokens { text, settings: self.settings(), begin, motion, found: Vec::new() };
        let start = start.max(gcode_lang::syntax::first_line(text).min(end));
        line_items(SOURCE, &text[..end as usize], start, |item| tokens.item(item));
        let mut found = tokens.found;
        found.sort_by_key(|token| token.range);
        let mut last = 0;
        found.retain(|token| {
            let is_behind = token.range.start >= last && !token.range.is_empty();
            last = if is_behind { token.range.end } else { last };
            is_behind
        });
        found
    }
}

/// Collects the tokens of lines, with the motion in force.
struct Tokens<'a> {
    text: &'a [u8],
    settings: &'a Settings,
    /// Offset from which tokens are wanted.
    begin: u32,
    motion: Option<MotionKind>,
    found: Vec<SemanticToken>,
}

/// Meaning of the codes of a block for its other words.
#[derive(Clone, Copy)]
struct BlockCodes {
    /// Colour of axis words.
    axes: TokenKind,
    /// Colour of the word P: a program or a sequence number.
    p: Option<TokenKind>,
    is_call: bool,
}

impl Tokens<'_> {
    fn item(&mut self, item: LineItem) {
        match item {
            LineItem::Section { start } => {
                let rest = &self.text[start as usize..];
                if let Some(at) = rest.iter().position(|byte| *byte == b'%') {
                    let at = start + at as u32;
                    self.push(TextRange::new(at, at + 1), TokenKind::Mark);
                }
            }
            LineItem::Program { span, .. } => {
                let range = span.into();
                self.push_token(SemanticToken {
                    range,
                    kind: TokenKind::Program,
                    is_written: false,
                    is_declaration: true,
                });
            }
            LineItem::Words(span) => self.block(span.into(), &[]),
            LineItem::Block(block) => {
                let comments: Vec<_> = block.comments.iter().map(|comment| comment.span.into()).collect();
                self.block(block.span.into(), &comments);
            }
        }
    }

    fn push(&mut self, range: TextRange, kind: TokenKind) {
        self.push_token(SemanticToken { range, kind, is_written: false, is_declaration: false });
    }

    fn push_token(&mut self, token: SemanticToken) {
        if token.range.start >= self.begin {
            self.found.push(token);
        }
    }

    fn block(&mut self, range: TextRange, comments: &[TextRange]) {
        let lexemes = lexemes(self.text, range, comments);
        let codes = self.codes(&lexemes);
        if range.start < self.begin {
            return;
        }
        let mut depth = 0;
        let mut is_first = true;
        let mut jumps = false;
        let mut at = 0;
        while let Some(lexeme) = lexemes.get(at) {
            let next = lexemes.get(at + 1);
            at += 1;
            let range = lexeme.range;
            match lexeme.kind {
                LexemeKind::Comment => self.push(range, TokenKind::Comment),
                LexemeKind::Letter(letter) => {
                    let number = next.filter(|next| next.kind == LexemeKind::Number && depth == 0);
                    let whole = number.map_or(range, |number| TextRange::new(range.start, number.range.end));
                    let (kind, is_whole) = self.word_kind(letter, number, is_first, codes);
                    let is_declaration = letter == b'N' && is_first && number.is_some();
                    let range = if is_whole { whole } else { range };
                    self.push_token(SemanticToken { range, kind, is_written: false, is_declaration });
                    at += usize::from(is_whole && number.is_some());
                    jumps = false;
                    is_first &= letter != b'N';
                    if letter != b'N' {
                        is_first = false;
                    }
                }
                LexemeKind::Number => {
                    let kind = if jumps { TokenKind::SequenceNumber } else { TokenKind::Number };
                    self.push(range, kind);
                    jumps = false;
                }
                LexemeKind::Variable(number) => {
                    let is_written = depth == 0 && next.is_some_and(|next| self.is_equals(next));
                    let kind = match VariableScope::of(number, self.settings) {
                        VariableScope::Null | VariableScope::Local => TokenKind::LocalVariable,
                        VariableScope::Common => TokenKind::CommonVariable,
                        VariableScope::System => TokenKind::SystemVariable,
                    };
                    self.push_token(SemanticToken { range, kind, is_written, is_declaration: false });
                    jumps = false;
                }
                LexemeKind::VariableName => {
                    let name = String::from_utf8_lossy(range.of(self.text)).to_ascii_uppercase();
                    let is_system = names::find(name.trim_start_matches('#')).is_some();
                    let kind = if is_system { TokenKind::SystemVariable } else { TokenKind::CommonVariable };
                    self.push(range, kind);
                }
                LexemeKind::Keyword(keyword) => {
                    jumps = keyword == "GOTO";
                    self.push(range, TokenKind::Keyword);
                }
                LexemeKind::Function => self.push(range, TokenKind::Function),
                LexemeKind::Operator => self.push(range, TokenKind::Operator),
                LexemeKind::Bracket(bracket) => {
                    depth = if bracket == b'[' { depth + 1 } else { (depth - 1).max(0) };
                    jumps = false;
                }
                LexemeKind::Text => self.push(range, TokenKind::Text),
                LexemeKind::Mark => self.push(range, TokenKind::Mark),
                LexemeKind::Other => {}
            }
            is_first &= matches!(lexeme.kind, LexemeKind::Comment | LexemeKind::Mark | LexemeKind::Letter(_));
        }
    }

    fn is_equals(&self, lexeme: &Lexeme) -> bool {
        lexeme.kind == LexemeKind::Operator && lexeme.range.of(self.text) == b"="
    }

    /// Returns the colour of a word, and true if its number has the same one.
    fn word_kind(
        &self,
        letter: u8,
        number: Option<&Lexeme>,
        is_first: bool,
        codes: BlockCodes,
    ) -> (TokenKind, bool) {
        let code = number.and_then(|number| self.tenths(number));
        match letter {
            b'N' if is_first => (TokenKind::SequenceNumber, true),
            b'O' | b':' => (TokenKind::Program, true),
            b'G' => (code.map_or(TokenKind::GCode, |code| self.g_kind(code)), true),
            b'M' => (code.map_or(TokenKind::MCode, |code| self.m_kind(code)), true),
            b'P' if codes.p.is_some() && number.is_some() => (codes.p.unwrap_or(TokenKind::Address), true),
            b'A' | b'B' | b'C' | b'U' | b'V' | b'W' | b'X' | b'Y' | b'Z' => (codes.axes, false),
            b'I' | b'J' | b'K' | b'Q' | b'R' if !codes.is_call => (codes.axes, false),
            _ => (TokenKind::Address, false),
        }
    }

    /// Returns a number × 10.
    fn tenths(&self, number: &Lexeme) -> Option<u32> {
        let text = std::str::from_utf8(number.range.of(self.text)).ok()?;
        let value: f64 = text.trim().parse().ok()?;
        (0.0..1e8).contains(&value).then_some((value * 10.0).round() as u32)
    }

    fn g_kind(&self, code: u32) -> TokenKind {
        let row = g_codes::row_on(code, g_codes::find(code), self.settings);
        if self.settings.code_calls.find_call(b'G', code).is_some() {
            return TokenKind::Call;
        }
        match (motion_of(code, self.settings), row.map(|row| row.effect)) {
            (_, Some(Effect::Call)) => TokenKind::Call,
            (_, Some(Effect::Cycle(None))) => TokenKind::CycleMotion,
            (MotionChange::To(motion), _) => motion_kind(motion),
            (MotionChange::None, _) => TokenKind::GCode,
        }
    }

    fn m_kind(&self, code: u32) -> TokenKind {
        let is_call = matches!(code, 970 | 980 | 990 | 1980)
            || self.settings.code_calls.find_call(b'M', code).is_some();
        if is_call { TokenKind::Call } else { TokenKind::MCode }
    }

    /// Reads the codes of a block, and changes the motion in force.
    fn codes(&mut self, lexemes: &[Lexeme]) -> BlockCodes {
        let mut codes = BlockCodes { axes: TokenKind::Address, p: None, is_call: false };
        let mut own = None;
        for pair in lexemes.windows(2) {
            let (LexemeKind::Letter(letter), LexemeKind::Number) = (pair[0].kind, pair[1].kind) else {
                continue;
            };
            let Some(code) = self.tenths(&pair[1]) else { continue };
            match (letter, code) {
                (b'G', 650 | 660 | 661) | (b'M', 980 | 1980) => {
                    codes.p = Some(TokenKind::Program);
                    codes.is_call |= letter == b'G';
                }
                (b'M', 970 | 990) => codes.p = Some(TokenKind::SequenceNumber),
                (b'G', _) => {
                    codes.is_call |= self.settings.code_calls.find_call(b'G', code).is_some();
                    if let MotionChange::To(motion) = motion_of(code, self.settings) {
                        self.motion = Some(motion);
                    }
                    let row = g_codes::row_on(code, g_codes::find(code), self.settings);
                    own = own.or(row.and_then(|row| one_shot_kind(row.effect)));
                }
                _ => {}
            }
        }
        codes.axes = match own {
            _ if codes.is_call => TokenKind::Address,
            Some(kind) => kind,
            None => self.motion.map_or(TokenKind::Address, motion_kind),
        };
        codes
    }
}

fn motion_kind(motion: MotionKind) -> TokenKind {
    match motion {
        MotionKind::Rapid => TokenKind::RapidMotion,
        MotionKind::Feed => TokenKind::FeedMotion,
        MotionKind::Arc => TokenKind::ArcMotion,
        MotionKind::Cycle => TokenKind::CycleMotion,
    }
}

/// Returns the colour of axis words beside a code of group 00 that makes something else of them.
fn one_shot_kind(effect: Effect) -> Option<TokenKind> {
    match effect {
        Effect::OneShot(one) if one.is_skip() => Some(TokenKind::FeedMotion),
        Effect::OneShot(
            OneShot::Reference | OneShot::FromReference | OneShot::SecondReference | OneShot::SingleDirection,
        ) => Some(TokenKind::RapidMotion),
        Effect::OneShot(OneShot::MachineCoordinateSystem | OneShot::ToolOffset(_)) => None,
        Effect::OneShot(_) => Some(TokenKind::Address),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::fixture;
    use proptest::prelude::*;

    fn shown(text: &str) -> String {
        let fixture = fixture(text);
        let tokens = fixture.project.semantic_tokens(FileId(0), None);
        let each = tokens.iter().map(|token| {
            let sign = if token.is_written {
                "="
            } else if token.is_declaration {
                "!"
            } else {
                ""
            };
            format!("{}:{:?}{sign}", fixture.text(FileId(0), token.range), token.kind)
        });
        each.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn words_have_the_colour_of_their_motion() {
        assert_eq!(
            shown("%\nO1(A)\nN1G1X1.F9\nY2\n"),
            "%:Mark O1:Program! (A):Comment N1:SequenceNumber! G1:FeedMotion X:FeedMotion 1.:Number F:Address 9:Number \
             Y:FeedMotion 2:Number"
        );
        assert_eq!(
            shown("G4 X1\nG0 G90 X1"),
            "G4:GCode X:Address 1:Number G0:RapidMotion G90:GCode X:RapidMotion 1:Number"
        );
        assert_eq!(
            shown("G2 X1 I2\nG83 Z-1 Q1\nM8"),
            "G2:ArcMotion X:ArcMotion 1:Number I:ArcMotion 2:Number G83:CycleMotion Z:CycleMotion -1:Number \
             Q:CycleMotion 1:Number M8:MCode"
        );
        assert_eq!(shown("G65 P81 A1"), "G65:Call P81:Program A:Address 1:Number");
        assert_eq!(shown("M99 P5"), "M99:Call P5:SequenceNumber");
    }

    #[test]
    fn variables_have_the_colour_of_their_scope() {
        assert_eq!(
            shown("#1=#100+#5021*SIN[[#_ABSMT[1]]]"),
            "#1:LocalVariable= =:Operator #100:CommonVariable +:Operator #5021:SystemVariable *:Operator SIN:Function \
             #_ABSMT:SystemVariable 1:Number"
        );
        assert_eq!(
            shown("IF[#1 EQ 2]THEN #2=3(N)"),
            "IF:Keyword #1:LocalVariable EQ:Operator 2:Number THEN:Keyword #2:LocalVariable= =:Operator 3:Number (N):Comment"
        );
        assert_eq!(shown("GOTO 5"), "GOTO:Keyword 5:SequenceNumber");
        assert_eq!(
            shown("X..5 #1 (C)"),
            "X:Address ..5:Number #1:LocalVariable (C):Comment",
            "text that cannot be read"
        );
    }

    #[test]
    fn a_range_has_the_motion_of_the_lines_before() {
        let text = format!("G1 X1.\n{}X3.\n", "(COMMENT)\n".repeat(4000));
        let fixture = fixture(&text);
        let end = text.len() as u32;
        let tokens = fixture.project.semantic_tokens(FileId(0), Some(TextRange::new(end - 4, end)));
        assert_eq!(
            tokens.iter().map(|token| token.kind).collect::<Vec<_>>(),
            [TokenKind::FeedMotion, TokenKind::Number]
        );
    }

    proptest! {
        #[test]
        fn tokens_are_in_order_on_any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..300), words in "[%OGNMX#0-9\\[\\](){};/ <>=.\n\r-]{0,200}") {
            for text in [bytes, words.into_bytes()] {
                let mut project = Project::new(Settings::default());
                project.set_file(FileId(0), "A", text.clone());
                let tokens = project.semantic_tokens(FileId(0), None);
                let mut last = 0;
                for token in tokens {
                    prop_assert!(token.range.start >= last && token.range.end > token.range.start);
                    prop_assert!(token.range.end as usize <= text.len());
                    prop_assert!(!token.range.of(&text).contains(&b'\n'), "in one line");
                    last = token.range.end;
                }
            }
        }
    }
}
