//! Programs of a complete file: their trees, or the outline of their blocks.
//!
//! Most lines of a long file are one block of words, which the outline recognises without reading them. The
//! other lines are read, so an outline has the same programs and blocks as the tree.
use super::ast::{Block, Folder, Program, ProgramName};
use super::file_items::{FileItem, FileItems};
use super::numbers::NumberWords;
use super::read_blocks::KnownBlocks;
use crate::source::{SourceId, Span};

/// One program of a file, with its blocks in the form of the caller.
#[derive(Debug)]
pub(crate) struct ProgramParts<C, B> {
    /// O number or name.
    pub name: ProgramName,
    /// Folder of a memory dump; `None` in a file without folder lines.
    pub folder: Option<Folder>,
    /// Span of the O word, or of the first block.
    pub span: Span,
    /// State that the caller keeps for the program.
    pub context: C,
    /// Blocks in order.
    pub blocks: Vec<B>,
    /// True if `%` or another program follows, or has to: the text has a `%` before. False if a text without `%` ends, and for
    /// text behind the last `%`.
    pub is_closed: bool,
}

/// Reads all programs of a file.
pub fn parse(source: SourceId, bytes: &[u8]) -> Vec<Program> {
    let mut programs = Programs::<(), Block>::default();
    for item in FileItems::new(source, bytes) {
        match item {
            FileItem::Section => programs.begin_section(),
            FileItem::Program { name, span } => programs.begin(name, span),
            FileItem::Block(block) => {
                let (span, is_unreadable) = (block.span, block.is_unreadable());
                programs.program_for_block(span, is_unreadable).blocks.push(block);
            }
        }
    }
    let parts = programs.finish().into_iter();
    parts.map(|ProgramParts { name, span, blocks, .. }| Program { name, span, blocks }).collect()
}

/// Collects items into programs, each with its own context.
#[derive(Debug)]
pub(super) struct Programs<C, B> {
    /// Programs; the flag is true while nothing in the program is readable.
    list: Vec<(ProgramParts<C, B>, bool)>,
    /// True if the next block belongs to the last program.
    is_open: bool,
    /// True if the text has a `%`: its last program ends at another one, or is cut off.
    has_section: bool,
    /// Folder of the next program.
    folder: Option<Folder>,
}

impl<C, B> Default for Programs<C, B> {
    fn default() -> Self {
        Self { list: Vec::new(), is_open: false, has_section: false, folder: None }
    }
}

impl<C: Default, B> Programs<C, B> {
    pub(super) fn begin(&mut self, name: ProgramName, span: Span) {
        self.close();
        let is_unreadable = name == ProgramName::Unnamed;
        let (folder, context, blocks) = (self.folder.clone(), C::default(), Vec::new());
        self.list
            .push((ProgramParts { name, folder, span, context, blocks, is_closed: false }, is_unreadable));
        self.is_open = true;
    }

    /// Ends the last program at a `%`.
    fn begin_section(&mut self) {
        self.close();
        self.has_section = true;
    }

    /// Ends the last program because another item follows.
    fn close(&mut self) {
        if let Some((program, _)) = self.list.last_mut() {
            program.is_closed = true;
        }
        self.is_open = false;
    }

    /// Returns the program of the next block.
    ///
    /// Blocks before the first O word of a section form an unnamed program.
    pub(super) fn program_for_block(&mut self, span: Span, is_unreadable: bool) -> &mut ProgramParts<C, B> {
        if !self.is_open {
            self.begin(ProgramName::Unnamed, span);
        }
        let last = self.list.len() - 1;
        let (program, all_unreadable) = &mut self.list[last];
        *all_unreadable &= is_unreadable;
        program
    }

    /// Returns true if the last program is text behind the last `%`: no O word, no `%` behind it, and programs before.
    fn is_behind_end(&self) -> bool {
        let Some(((last, _), before)) = self.list.split_last() else { return false };
        self.is_open && last.name == ProgramName::Unnamed && before.iter().any(|(_, is_leader)| !is_leader)
    }

    /// Returns all programs. A program without readable content is leader text and is dropped unless it is
    /// the only one.
    pub(super) fn finish(mut self) -> Vec<ProgramParts<C, B>> {
        if self.has_section && !self.is_behind_end() {
            self.close();
        }
        let is_only_program = self.list.len() == 1;
        self.list
            .into_iter()
            .filter(|(_, is_unreadable)| is_only_program || !is_unreadable)
            .map(|(program, _)| program)
            .collect()
    }
}

#[derive(Debug)]
pub(crate) enum BlockOutline<'a> {
    /// Block that is not read; it is neither DO nor END. The span includes trailing spaces.
    Words(Span),
    /// Block that begins its line.
    Tree(&'a Block),
    /// Block after another item of its line; it cannot be read again from its own start.
    WithinLine(Box<Block>),
}

impl BlockOutline<'_> {
    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Words(span) => *span,
            Self::Tree(block) => block.span,
            Self::WithinLine(block) => block.span,
        }
    }
}

/// Returns the programs of a file as [`parse`] finds them, each block converted by `convert`.
///
/// Neither the trees nor the lines of a long file are kept. A known block is not read.
pub(crate) fn outline<C: Default, B>(
    source: SourceId,
    bytes: &[u8],
    known: &KnownBlocks,
    mut convert: impl FnMut(&mut C, BlockOutline<'_>) -> B,
) -> Vec<ProgramParts<C, B>> {
    let mut programs = Programs::default();
    let mut items = FileItems::new(source, bytes);
    // True once the current program has a name or a readable block.
    let mut is_program_known = false;
    loop {
        let begins_line = items.begins_line();
        if let Some(block) = items.line_code_start().filter(|_| begins_line).and_then(|at| known.find(at)) {
            items.skip_line();
            let is_unreadable = block.is_unreadable();
            is_program_known |= !is_unreadable;
            if !programs.is_open {
                programs.folder = items.folder();
            }
            let ProgramParts { context, blocks, .. } = programs.program_for_block(block.span, is_unreadable);
            blocks.push(convert(context, BlockOutline::Tree(block)));
            continue;
        }
        match items.next_item() {
            Some(FileItem::Section) => {
                is_program_known = false;
                programs.begin_section();
            }
            Some(FileItem::Program { name, span }) => {
                is_program_known = true;
                programs.folder = items.folder();
                programs.begin(name, span);
            }
            Some(FileItem::Block(block)) => {
                let is_unreadable = block.is_unreadable();
                is_program_known |= !is_unreadable;
                if !programs.is_open {
                    programs.folder = items.folder();
                }
                let ProgramParts { context, blocks, .. } =
                    programs.program_for_block(block.span, is_unreadable);
                let outlined = match begins_line {
                    true => BlockOutline::Tree(&block),
                    false => BlockOutline::WithinLine(Box::new(block)),
                };
                blocks.push(convert(context, outlined));
            }
            None => {
                if is_program_known {
                    let ProgramParts { context, blocks, .. } =
                        programs.program_for_block(Span::default(), false);
                    items.plain_lines(|span| blocks.push(convert(context, BlockOutline::Words(span))));
                }
                if items.next_line().is_none() {
                    return programs.finish();
                }
            }
        }
    }
}

/// Reads the block at the line start `start`, taken from an outline, of a text without its trailer.
pub fn block_at(source: SourceId, bytes: &[u8], start: u32) -> Option<Block> {
    FileItems::starting_at(source, bytes, start as usize).find_map(|item| match item {
        FileItem::Block(block) => Some(block),
        _ => None,
    })
}

/// Returns the sequence number of the block at `start`, `None` without one.
pub(crate) fn sequence_number_at(source: SourceId, bytes: &[u8], start: u32) -> Option<u32> {
    match bytes.get(start as usize)? {
        b'N' => {
            // A comment may interrupt the number; only the complete block settles it.
            if let Some(numbers) = NumberWords::new(source, bytes, start)
                && (numbers.is_at_end() || numbers.is_at_letter())
            {
                return numbers.sequence_number;
            }
        }
        b'#' | b'A'..=b'Z' => return None,
        _ => {}
    }
    block_at(source, bytes, start)?.number.map(|number| number.node)
}

#[cfg(test)]
mod tests {
    use super::super::ast::{Item, Statement, WordValue};
    use super::*;

    fn programs(text: &[u8]) -> Vec<Program> {
        parse(SourceId(0), text)
    }

    fn alarms(text: &str) -> Vec<u32> {
        let blocks = programs(text.as_bytes()).into_iter().flat_map(|p| p.blocks);
        let items = blocks.flat_map(|b| b.items);
        items
            .filter_map(|item| {
                if let Item::Unreadable(a) = item { Some(a.alarm.node.code().number()) } else { None }
            })
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
    fn statements_differ_from_words() {
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
    fn unreadable_text_has_the_alarm_of_a_control() {
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
            ("IF #1 EQ 1 GOTO 10", 1137),
            ("IF[#814GT1]", 1137),
            ("WHILE[#500LT1]", 1138),
            ("WHILE #1 LT 2 DO1", 1138),
            ("X#1+#2", 4),
            ("?", 4),
        ] {
            assert_eq!(alarms(text), [alarm], "{text}");
        }
    }
}
