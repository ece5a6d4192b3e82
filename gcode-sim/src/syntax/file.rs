//! A whole file: lines, `%` sections, and the programs in them.
use super::ast::{Block, Program, ProgramName};
use super::block::{begins_program, block};
use super::number::integer;
use super::token::{Input, Line, spaces};
use crate::source::{SourceId, Span, end_of_line};

/// What a file is made of, line by line, so that nobody has to hold all of it.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// `%`: what follows belongs to no program yet.
    Section,
    /// `O0001`, `:0007`, `<NAME>`; words on its line are the next piece.
    Program {
        name: ProgramName,
        span: Span,
    },
    Block(Block),
}

/// Reads the pieces of a file in order. Lines without anything in them are left out.
#[derive(Debug)]
pub struct Pieces<'a> {
    source: SourceId,
    total: usize,
    rest: Input<'a>,
    /// What is left of a line that a piece ended within.
    within: Option<(Line, Input<'a>)>,
}

impl<'a> Pieces<'a> {
    pub fn new(source: SourceId, bytes: &'a [u8]) -> Self {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let end = text.iter().position(|b| *b == 0x1a).unwrap_or(text.len());
        Self { source, total: bytes.len(), rest: &text[..end], within: None }
            .behind_leader(bytes.len() - text.len() + end)
    }

    /// The offsets count from the file's first byte, whatever was cut off behind.
    fn behind_leader(mut self, end: usize) -> Self {
        self.total = end;
        if let Some(at) = leader(self.rest) {
            self.rest = &self.rest[at..];
        }
        self
    }

    fn next_line(&mut self) -> Option<(Line, Input<'a>)> {
        if self.rest.is_empty() {
            return None;
        }
        let length = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len());
        let text = &self.rest[..length];
        let end = self.total - (self.rest.len() - length);
        self.rest = &self.rest[length + end_of_line(&self.rest[length..])..];
        Some((Line { source: self.source, end: end as u32 }, text))
    }
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        loop {
            let (line, text) = match self.within.take() {
                Some(left) => left,
                None => self.next_line()?,
            };
            let at = spaces(text);
            match at.first() {
                None => {}
                Some(b'%') => {
                    // `%O0003(…)` goes on with the program; any other text behind the sign is a leader.
                    let behind = spaces(&at[1..]);
                    if begins_program(behind) || behind.first() == Some(&b'<') {
                        self.within = Some((line, behind));
                    }
                    return Some(Piece::Section);
                }
                // `&F=//CNC_MEM/…`: the folder line of a memory dump says nothing to the control.
                Some(b'&') => {}
                Some(_) => {
                    if let Some((rest, name)) = program_name(at) {
                        self.within = Some((line, rest));
                        return Some(Piece::Program { name, span: line.span(at, rest) });
                    }
                    let (block, left) = block(line, text);
                    if !left.is_empty() {
                        self.within = Some((line, left));
                    }
                    return Some(Piece::Block(block));
                }
            }
        }
    }
}

/// Where the text after a leader begins: what stands before the first `%` is ignored if a program begins behind it
/// and none before it.
fn leader(bytes: &[u8]) -> Option<usize> {
    let first = bytes.iter().position(|b| *b == b'%')?;
    let starts_line = first == 0 || matches!(bytes[first - 1], b'\n' | b'\r');
    if !starts_line || !bytes[..first].iter().any(|b| !b.is_ascii_whitespace()) {
        return None;
    }
    let has_program = |text: &[u8]| {
        let mut lines = text.split(|b| matches!(b, b'\n' | b'\r'));
        lines.any(|line| {
            let line = spaces(line.strip_prefix(b"%").unwrap_or(line));
            begins_program(line) || line.first() == Some(&b'<')
        })
    };
    (!has_program(&bytes[..first]) && has_program(&bytes[first..])).then_some(first)
}

fn program_name(at: Input<'_>) -> Option<(Input<'_>, ProgramName)> {
    if begins_program(at) {
        let (rest, number) = integer(spaces(&at[1..])).ok()?;
        let number = u32::try_from(number).ok().filter(|n| *n <= 99_999_999)?;
        // `O9123<NAME>`: the number is the name, the rest a title.
        let rest = match spaces(rest) {
            [b'<', title @ ..] => title.iter().position(|b| *b == b'>').map_or(rest, |end| &title[end + 1..]),
            _ => rest,
        };
        return Some((rest, ProgramName::Number(number)));
    }
    let (b'<', inside) = at.split_first()? else { return None };
    let end = inside.iter().position(|b| *b == b'>')?;
    let text = String::from_utf8_lossy(&inside[..end]).trim().to_ascii_uppercase();
    let number = text.strip_prefix('O').and_then(|digits| digits.parse().ok());
    let name = number.map_or(ProgramName::Name(text), ProgramName::Number);
    Some((&inside[end + 1..], name))
}

/// All programs of a file. Blocks before the first O word of a section are a program without a name.
pub fn parse(source: SourceId, bytes: &[u8]) -> Vec<Program> {
    let mut programs: Vec<Program> = Vec::new();
    let mut open = false;
    for piece in Pieces::new(source, bytes) {
        match piece {
            Piece::Section => open = false,
            Piece::Program { name, span } => {
                programs.push(Program { name, span, blocks: Vec::new() });
                open = true;
            }
            Piece::Block(block) => {
                if !open {
                    programs.push(Program {
                        name: ProgramName::Unnamed,
                        span: block.span,
                        blocks: Vec::new(),
                    });
                    open = true;
                }
                if let Some(program) = programs.last_mut() {
                    program.blocks.push(block);
                }
            }
        }
    }
    programs
}

#[cfg(test)]
mod tests {
    use super::super::ast::{Item, Statement, WordValue};
    use super::*;
    use crate::alarm::Code;

    fn programs(text: &[u8]) -> Vec<Program> {
        parse(SourceId(0), text)
    }

    fn alarms(text: &str) -> Vec<Code> {
        let blocks = programs(text.as_bytes()).into_iter().flat_map(|p| p.blocks);
        let items = blocks.flat_map(|b| b.items);
        items
            .filter_map(|item| if let Item::Unreadable(a) = item { Some(a.node.code()) } else { None })
            .collect()
    }

    #[test]
    fn a_file_of_two_programs_with_a_leader() {
        let found = programs(b"PART 7\r\n%\r\nO1(A)\r\nG0X1 0.5Y-#1\r\nM30\r\nO2\r\nM99\r\n%\r\n");
        let names: Vec<_> = found.iter().map(|p| p.name.clone()).collect();
        assert_eq!(names, [ProgramName::Number(1), ProgramName::Number(2)]);
        let words = &found[0].blocks[1].items;
        assert_eq!(words.len(), 3);
        let Item::Word(x) = &words[1] else { panic!("a word") };
        let WordValue::Literal(number) = &x.value else { panic!("a literal") };
        assert_eq!((number.value(), number.places), (10.5, Some(1)));
    }

    #[test]
    fn a_number_run_together_begins_the_next_program() {
        let found = programs(b"%O0003(X)\nM99O0810(TEXT)\nM30\n%");
        let names: Vec<_> = found.iter().map(|p| p.name.clone()).collect();
        assert_eq!(names, [ProgramName::Number(3), ProgramName::Number(810)]);
        assert_eq!(found[1].blocks[0].comments[0].text, b"TEXT");
    }

    #[test]
    fn statements_are_told_from_words() {
        let found =
            programs(b"N41GOTO#22\nIF[[#1 EQ 1]AND[#2 LT 3]]THEN#3000=1(BAD)\nWH[#1GT0]DO1\nEND 1\nDO4\n");
        let kinds: Vec<_> = found[0]
            .blocks
            .iter()
            .map(|b| match &b.items[0] {
                Item::Statement(s) => match &s.node {
                    Statement::Goto(_) => "goto",
                    Statement::IfThen { .. } => "if then",
                    Statement::While { .. } => "while",
                    Statement::End(_) => "end",
                    Statement::Do(_) => "do",
                    _ => "else",
                },
                _ => "no statement",
            })
            .collect();
        assert_eq!(kinds, ["goto", "if then", "while", "end", "do"]);
        assert_eq!(found[0].blocks[1].comments[0].text, b"BAD");
    }

    #[test]
    fn what_cannot_be_read_has_the_alarm_of_a_control() {
        for (text, alarm) in [
            ("G0 X1..5", 7),
            ("G0 X Y10.", 5),
            ("X-12.8.", 7),
            ("X-11.Z", 5),
            ("G0 X123456789012.", 3),
            ("#100=[[[[[[1+1]]]]]]", 118),
            ("#100=1+2]", 1131),
            ("#100=[1+2", 1132),
            ("#100 5", 1133),
            ("#100=2**3", 1125),
            ("#1=ABS(#26 - #13)", 1131),
            ("#100=[1 LT 2]", 1125),
            ("IF[#1 EQ 1]#100=5", 1137),
            ("IF #1 EQ 1 GOTO 10", 1137),
            ("IF[#814GT1]", 1137),
            ("WHILE[#500LT1]", 1138),
            ("WHILE #1 LT 2 DO1", 1138),
            ("X#1+#2", 4),
            ("?", 4),
        ] {
            assert_eq!(alarms(text), [Code::Ps(alarm)], "{text}");
        }
    }
}
