//! Lexer of one block for colours and completion: it never fails, whatever the text is.
use crate::text::TextRange;

/// Kind of a lexical element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LexemeKind {
    Comment,
    /// Letter of a word.
    Letter(u8),
    /// Number with its sign, if that follows a letter.
    Number,
    /// `#5`; the number follows.
    Variable(u32),
    /// `#_ABSMT` or `#TOOL_NO`.
    VariableName,
    /// IF, GOTO and the others; the index in [`KEYWORDS`].
    Keyword(&'static str),
    Function,
    /// EQ, AND, `+`, `=`.
    Operator,
    /// `[` or `]`.
    Bracket(u8),
    /// Text of DPRNT, `<NAME>`.
    Text,
    /// `/` at the start of a block, `%`.
    Mark,
    /// Anything else.
    Other,
}

/// Lexical element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lexeme {
    pub kind: LexemeKind,
    pub range: TextRange,
}

/// Keywords of statements.
pub(crate) const KEYWORDS: [&str; 12] =
    ["IF", "THEN", "GOTO", "WHILE", "DO", "END", "SETVN", "DPRNT", "BPRNT", "POPEN", "PCLOS", "AX"];

/// Functions and the values that are written like one.
pub(crate) const FUNCTIONS: [&str; 19] = [
    "ROUND", "SQRT", "ASIN", "ACOS", "ATAN", "AXNUM", "SIN", "COS", "TAN", "ABS", "FIX", "FUP", "EXP", "POW",
    "BIN", "BCD", "ADP", "PRM", "LN",
];

/// Operators that are written with letters.
pub(crate) const OPERATORS: [&str; 10] = ["EQ", "NE", "GT", "LT", "GE", "LE", "AND", "XOR", "MOD", "OR"];

/// Splits a range of one line into elements, in order and without overlaps. `comments` are sorted.
pub(crate) fn lexemes(text: &[u8], range: TextRange, comments: &[TextRange]) -> Vec<Lexeme> {
    let end = (range.end as usize).min(text.len());
    let mut lexer = Lexer { text: &text[..end], at: range.start as usize, found: Vec::new() };
    let mut comments = comments.iter().peekable();
    while lexer.at < end {
        while comments.next_if(|comment| (comment.start as usize) < lexer.at).is_some() {}
        if let Some(comment) = comments.next_if(|comment| comment.start as usize == lexer.at) {
            let stop = (comment.end as usize).clamp(lexer.at + 1, end);
            lexer.push_to(LexemeKind::Comment, stop);
            continue;
        }
        lexer.next();
    }
    lexer.found
}

struct Lexer<'a> {
    text: &'a [u8],
    at: usize,
    found: Vec<Lexeme>,
}

impl Lexer<'_> {
    fn byte(&self, at: usize) -> u8 {
        self.text.get(at).copied().unwrap_or_default()
    }

    /// Appends the element up to an offset.
    fn push_to(&mut self, kind: LexemeKind, end: usize) {
        let end = end.clamp(self.at + 1, self.text.len());
        self.found.push(Lexeme { kind, range: TextRange::new(self.at as u32, end as u32) });
        self.at = end;
    }

    /// Returns the end of the bytes from an offset that fit.
    fn run(&self, from: usize, fits: impl Fn(u8) -> bool) -> usize {
        let rest = self.text.get(from..).unwrap_or_default();
        from + rest.iter().take_while(|byte| fits(**byte)).count()
    }

    fn next(&mut self) {
        let (at, byte) = (self.at, self.byte(self.at));
        match byte {
            b' ' | b'\t' | b'\r' | b'\n' | 0 | 0x1a | 0x7f => self.at += 1,
            b'(' => {
                let close = self.run(at + 1, |byte| byte != b')');
                self.push_to(LexemeKind::Comment, close + 1);
            }
            b'#' => self.variable(),
            b'0'..=b'9' | b'.' => {
                let end = self.run(at, |byte| byte.is_ascii_digit() || byte == b'.');
                self.push_to(LexemeKind::Number, end);
            }
            b'-' | b'+' if self.is_sign() => {
                let digits = self.run(at + 1, |byte| byte == b' ');
                let end = self.run(digits, |byte| byte.is_ascii_digit() || byte == b'.');
                self.push_to(LexemeKind::Number, end);
            }
            b'a'..=b'z' | b'A'..=b'Z' => self.letters(),
            b'[' | b']' => self.push_to(LexemeKind::Bracket(byte), at + 1),
            b'<' if self.name_end().is_some() => {
                let end = self.name_end().unwrap_or(at + 1);
                self.push_to(LexemeKind::Text, end);
            }
            b'/' if self.found.iter().all(|lexeme| lexeme.kind == LexemeKind::Comment) => {
                let end = self.run(at + 1, |byte| matches!(byte, b'1'..=b'9'));
                self.push_to(LexemeKind::Mark, end.min(at + 2));
            }
            b'%' => self.push_to(LexemeKind::Mark, at + 1),
            b'+' | b'-' | b'*' | b'/' | b'=' | b'<' | b'>' | b'&' | b'|' => {
                self.push_to(LexemeKind::Operator, at + 1);
            }
            _ => {
                // Bytes of one character stay together.
                let end = self.run(at + 1, |byte| byte & 0xc0 == 0x80);
                self.push_to(LexemeKind::Other, end);
            }
        }
    }

    /// Returns true for a sign between a letter and a number.
    fn is_sign(&self) -> bool {
        let follows_letter = matches!(self.found.last().map(|last| last.kind), Some(LexemeKind::Letter(_)));
        let next = self.run(self.at + 1, |byte| byte == b' ');
        follows_letter && matches!(self.byte(next), b'0'..=b'9' | b'.')
    }

    fn variable(&mut self) {
        let start = self.run(self.at + 1, |byte| byte == b' ');
        let digits = self.run(start, |byte| byte.is_ascii_digit());
        if digits > start {
            let spelled = std::str::from_utf8(&self.text[start..digits]).ok();
            let number = spelled.and_then(|text| text.parse().ok()).unwrap_or(u32::MAX);
            return self.push_to(LexemeKind::Variable(number), digits);
        }
        let name = self.run(self.at + 1, |byte| byte.is_ascii_alphanumeric() || byte == b'_');
        let kind = if name > self.at + 1 { LexemeKind::VariableName } else { LexemeKind::Operator };
        self.push_to(kind, name);
    }

    /// Returns the end of `<NAME>`.
    fn name_end(&self) -> Option<usize> {
        let fits = |byte: u8| {
            byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.' | b'/' | b' ' | b'+')
        };
        let end = self.run(self.at + 1, fits);
        (end > self.at + 1 && self.byte(end) == b'>').then_some(end + 1)
    }

    fn letters(&mut self) {
        let end = self.run(self.at, |byte| byte.is_ascii_alphabetic());
        let upper = self.text[self.at..end].to_ascii_uppercase();
        let starts = |word: &&&str| upper.starts_with(word.as_bytes());
        if upper.len() > 1 {
            // The longest of all words that begin here: ASIN before AS.
            let keyword = KEYWORDS.iter().find(starts).map(|word| (word.len(), LexemeKind::Keyword(word)));
            let function = FUNCTIONS.iter().find(starts).map(|word| (word.len(), LexemeKind::Function));
            let operator = OPERATORS.iter().find(starts).map(|word| (word.len(), LexemeKind::Operator));
            let longest =
                [keyword, function, operator].into_iter().flatten().max_by_key(|(length, _)| *length);
            if let Some((length, kind)) = longest.or_else(|| abbreviated(&upper)) {
                let is_print = matches!(kind, LexemeKind::Keyword("DPRNT" | "BPRNT"));
                self.push_to(kind, self.at + length);
                if is_print {
                    self.print();
                }
                return;
            }
        }
        let letter = upper.first().copied().unwrap_or_default();
        self.push_to(LexemeKind::Letter(letter), self.at + 1);
    }

    /// Splits the brackets of DPRNT: texts, and variables with their formats.
    fn print(&mut self) {
        let open = self.run(self.at, |byte| byte == b' ');
        if self.byte(open) != b'[' {
            return;
        }
        self.at = open;
        self.push_to(LexemeKind::Bracket(b'['), open + 1);
        while self.at < self.text.len() {
            let text = self.run(self.at, |byte| !matches!(byte, b'#' | b']' | b'['));
            if text > self.at {
                self.push_to(LexemeKind::Text, text);
            }
            match self.byte(self.at) {
                b'#' => {
                    self.variable();
                    // The format, or the brackets of a computed number.
                    let mut depth = 0;
                    while self.at < self.text.len() {
                        match self.byte(self.at) {
                            b'[' => depth += 1,
                            b']' => depth -= 1,
                            _ => {}
                        }
                        self.next();
                        if depth <= 0 && self.byte(self.at) != b'[' {
                            break;
                        }
                    }
                }
                b']' => return self.push_to(LexemeKind::Bracket(b']'), self.at + 1),
                b'[' => self.push_to(LexemeKind::Bracket(b'['), self.at + 1),
                _ => return,
            }
        }
    }
}

/// Returns the keyword or function that two or more letters abbreviate.
fn abbreviated(upper: &[u8]) -> Option<(usize, LexemeKind)> {
    let common = |word: &str| word.bytes().zip(upper).take_while(|(one, other)| one == *other).count();
    let keyword =
        KEYWORDS.iter().find(|word| common(word) >= 2).map(|word| (common(word), LexemeKind::Keyword(word)));
    let function =
        || FUNCTIONS.iter().find(|word| common(word) >= 2).map(|word| (common(word), LexemeKind::Function));
    keyword.or_else(function)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> String {
        let found = lexemes(text.as_bytes(), TextRange::new(0, text.len() as u32), &[]);
        found
            .iter()
            .map(|l| &text[l.range.start as usize..l.range.end as usize])
            .collect::<Vec<_>>()
            .join("|")
    }

    #[test]
    fn blocks_are_split() {
        assert_eq!(split("N10G01X-1.5 Y[#1+2]F#9(FEED)"), "N|10|G|01|X|-1.5|Y|[|#1|+|2|]|F|#9|(FEED)");
        assert_eq!(split("IF[#1EQ#2]GOTO10"), "IF|[|#1|EQ|#2|]|GOTO|10");
        assert_eq!(split("WH[#1GTSIN[30]]DO1"), "WH|[|#1|GT|SIN|[|30|]|]|DO|1");
        assert_eq!(split("DPRNT[X#1[44] Y*#[#2][33]]"), "DPRNT|[|X|#1|[|44|]| Y*|#|[|#2|]|[|33|]|]");
        assert_eq!(split("/2 M98P<SUB>"), "/2|M|98|P|<SUB>");
        assert_eq!(split("#3=[#_ABSMT[1]]-2"), "#3|=|[|#_ABSMT|[|1|]|]|-|2");
        assert_eq!(split("É X1."), "É|X|1.");
    }
}
