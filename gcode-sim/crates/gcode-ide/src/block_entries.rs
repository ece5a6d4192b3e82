//! Entries of one block: its sequence number, jumps, calls, loops and variables.
use gcode_lang::control::Dialect;
use gcode_lang::program::{CallCode, CallTarget, LoweredWord, WordOperand, Words, lower_tree};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{Block, Decimal, Expr, ExprKind, Item, Statement, Unreadable, Word, WordValue};
use gcode_lint::{CalledProgramName, ValueUse, block_expressions, call_site, constant, variable};

use crate::chunk_builder::{ChunkBuilder, is_read_g, is_read_m};
use crate::entry::{ArgumentRecord, CallRecord, EntryKind};
use crate::text::TextRange;

/// Number of a variable with a name whose number only the run knows.
pub(crate) const NAMED: u32 = u32::MAX;

/// Records the entries of a block.
pub(crate) fn record(builder: &mut ChunkBuilder<'_>, block: &Block) {
    if block.items.is_empty() && block.is_unreadable() {
        return builder.push(EntryKind::Comment, block.span.into(), 0);
    }
    if let Some(number) = &block.number {
        builder.push(EntryKind::Number, number.span.into(), number.node);
    }
    for item in &block.items {
        match item {
            Item::Statement(statement) => record_statement(builder, &statement.node, statement.span.into()),
            Item::Unreadable(unreadable) => record_unreadable(builder, unreadable),
            Item::Word(_) | Item::Skip(_) => {}
        }
    }
    for (expr, usage) in block_expressions(block) {
        record_variables(builder, expr, usage == ValueUse::Target);
    }
    record_words(builder, block);
}

fn record_statement(builder: &mut ChunkBuilder<'_>, statement: &Statement, range: TextRange) {
    let number = |number: i64| u32::try_from(number).unwrap_or(u32::MAX);
    match statement {
        Statement::Goto(to) | Statement::IfGoto { to, .. } => {
            push_jump(builder, EntryKind::Goto, whole(constant(to)), to.span.into());
        }
        Statement::IfThen { then, .. } => record_statement(builder, then, range),
        Statement::While { number: loop_number, .. } | Statement::Do(loop_number) => {
            builder.push(EntryKind::LoopBegin, range, number(loop_number.node));
        }
        Statement::End(loop_number) => builder.push(EntryKind::LoopEnd, range, number(loop_number.node)),
        Statement::SetNames { first, .. } => {
            builder.push(EntryKind::SetNames, range, whole(constant(first)).unwrap_or(NAMED));
        }
        Statement::Assign { .. }
        | Statement::If { .. }
        | Statement::Print { .. }
        | Statement::OpenOutput
        | Statement::CloseOutput => {}
    }
}

/// Records a jump, or that its sequence number is computed.
fn push_jump(builder: &mut ChunkBuilder<'_>, kind: EntryKind, number: Option<u32>, range: TextRange) {
    let computed = match kind {
        EntryKind::ReturnTo => EntryKind::ComputedReturn,
        EntryKind::StartAt => EntryKind::ComputedStart,
        _ => EntryKind::ComputedGoto,
    };
    match number {
        Some(number) => builder.push(kind, range, number),
        None => builder.push(computed, range, 0),
    }
}

/// Returns a value as a whole number that a sequence number may be.
pub(crate) fn whole(value: Option<f64>) -> Option<u32> {
    let rounded = value?.round();
    (0.0..=999_999_999.0).contains(&rounded).then_some(rounded as u32)
}

/// Records the variables that are spelled in text that cannot be read, so that they are still found.
fn record_unreadable(builder: &mut ChunkBuilder<'_>, unreadable: &Unreadable) {
    let start = unreadable.span.start;
    builder.push(EntryKind::Unreadable, unreadable.span.into(), 0);
    let mut depth = 0;
    for (at, byte) in unreadable.text.iter().enumerate() {
        match byte {
            b'(' => depth += 1,
            b')' => depth = 0,
            b'#' if depth == 0 => {
                let digits = unreadable.text[at + 1..].iter().take_while(|b| b.is_ascii_digit()).count();
                let text = std::str::from_utf8(&unreadable.text[at + 1..at + 1 + digits]).ok();
                if let Some(number) = text.and_then(|text| text.parse().ok()).filter(|n: &u32| *n < NAMED) {
                    let range = TextRange::new(start + at as u32, start + (at + 1 + digits) as u32);
                    builder.push(EntryKind::Read, range, number);
                }
            }
            _ => {}
        }
    }
}

/// Records the variables of an expression; `is_target` if the outermost one is assigned.
fn record_variables(builder: &mut ChunkBuilder<'_>, expr: &Expr, is_target: bool) {
    let (known, computed) = match is_target {
        true => (EntryKind::Write, EntryKind::ComputedWrite),
        false => (EntryKind::Read, EntryKind::ComputedRead),
    };
    match &expr.kind {
        ExprKind::Variable(index) => {
            match variable(expr) {
                Some(number) => builder.push(known, expr.span.into(), number),
                None => builder.push(computed, expr.span.into(), 0),
            }
            record_variables(builder, index, false);
        }
        ExprKind::Named(name) => {
            builder.push(known, expr.span.into(), variable(expr).unwrap_or(NAMED));
            name.index.iter().for_each(|index| record_variables(builder, index, false));
        }
        ExprKind::Bracket(inner) => record_variables(builder, inner, is_target),
        _ => expr.operands().for_each(|part| record_variables(builder, part, false)),
    }
}

/// Returns a G or M code × 10 that is written as a number.
pub(crate) fn code(word: &Word) -> Option<u32> {
    match &word.value {
        WordValue::Literal(Decimal { negative: false, digits, places }) => {
            let unit = 10_u64.checked_pow(u32::from(places.unwrap_or(0)))?;
            u32::try_from(digits.checked_mul(10)? / unit).ok()
        }
        _ => None,
    }
}

/// Records the codes of a block: calls, returns, ends, data input.
fn record_words(builder: &mut ChunkBuilder<'_>, block: &Block) {
    let mut has_call = false;
    let words =
        block.items.iter().filter_map(|item| if let Item::Word(word) = item { Some(word) } else { None });
    for word in words.clone() {
        let (letter, code) = (word.address.letter, code(word));
        has_call |= builder.has_code_calls && builder.calls_program(letter, code.unwrap_or(u32::MAX));
        let Some(code) = code else { continue };
        match letter {
            b'G' if is_read_g(code) => has_call = true,
            b'G' => builder.note_motion(code),
            b'M' if is_read_m(code / 10) => {
                has_call |= matches!(code / 10, 97 | 98 | 99 | 198);
                record_m(builder, code / 10, word, words.clone(), block.span.into());
            }
            _ => {}
        }
    }
    if has_call {
        // Words before unreadable text still say what is called.
        let is_readable = |item: &&Item| !matches!(item, Item::Unreadable(_));
        let items = block.items.iter().filter(is_readable).cloned().collect();
        if let Some(words) = lower_tree(&Block { items, ..block.clone() }).kind().words() {
            record_call(builder, words, block);
        }
    }
}

/// Records an end, and the P of M96 and of a Haas's M109.
fn record_m<'a>(
    builder: &mut ChunkBuilder<'_>,
    code: u32,
    word: &Word,
    mut words: impl Iterator<Item = &'a Word>,
    block: TextRange,
) {
    if matches!(code, 2 | 30 | 99) {
        return builder.push(EntryKind::End, word.span.into(), code);
    }
    if !matches!(code, 96 | 109) {
        return;
    }
    let Some(p) = words.find(|word| word.address.letter == b'P') else { return };
    let number = match &p.value {
        WordValue::Literal(number) => whole(Some(number.value())),
        WordValue::Expr(expr) => whole(constant(expr)),
        WordValue::Name(_) => None,
    };
    let range = value_range(builder.text, p.span.into());
    let is_haas = builder.settings.codes == Dialect::HaasNgc;
    match (code, is_haas) {
        (96, true) => push_jump(builder, EntryKind::Goto, number, range),
        (96, false) => {
            let target = number.map_or(CalledProgramName::Computed, CalledProgramName::Number);
            let record = CallRecord {
                kind: None,
                has_own_locals: true,
                is_modal: false,
                target,
                target_range: Some(builder.relative(p.span.into())),
                block: builder.relative(block),
                arguments: Box::default(),
            };
            push_call(builder, record, word.span.into());
        }
        (_, true) => match number {
            Some(number) => builder.push(EntryKind::Write, range, number),
            None => builder.push(EntryKind::ComputedWrite, range, 0),
        },
        _ => {}
    }
}

fn push_call(builder: &mut ChunkBuilder<'_>, record: CallRecord, code: TextRange) {
    let index = builder.chunk.calls.len() as u32;
    builder.chunk.calls.push(record);
    builder.push(EntryKind::Call, code, index);
}

fn record_call(builder: &mut ChunkBuilder<'_>, words: &Words, block: &Block) {
    record_data_input(builder, words, block.span.into());
    if let Some(call) = words.call()
        && call.kind == CallCode::Return
    {
        if let CallTarget::Number(word) = &call.target {
            let number = whole(literal(word));
            let range = value_range(builder.text, word.span.into());
            push_jump(builder, EntryKind::ReturnTo, number, range);
        }
        return;
    }
    let Some(site) = call_site(0, words, builder.settings) else { return };
    if let Some(span) = site.start_span {
        let kind = if site.is_of_own_program() { EntryKind::LocalCall } else { EntryKind::StartAt };
        push_jump(builder, kind, site.start, value_range(builder.text, span.into()));
    }
    if site.is_of_own_program() {
        return;
    }
    let arguments = site.arguments.iter().map(|argument| {
        ArgumentRecord::new(argument.letter, argument.local, argument.span.start - builder.base)
    });
    let record = CallRecord {
        kind: site.kind,
        has_own_locals: site.has_own_locals,
        is_modal: site.is_modal,
        arguments: arguments.collect(),
        target_range: site.target_span.or_else(|| name_span(block)).map(|span| builder.relative(span.into())),
        target: site.target,
        block: builder.relative(block.span.into()),
    };
    push_call(builder, record, site.span.into());
}

/// Returns the span of a word with the name of a program.
fn name_span(block: &Block) -> Option<Span> {
    block.items.iter().find_map(|item| match item {
        Item::Word(Word { value: WordValue::Name(_), span, .. }) => Some(*span),
        _ => None,
    })
}

/// Returns the number of a word.
fn literal(word: &LoweredWord) -> Option<f64> {
    match word.value {
        WordOperand::Literal(number) => Some(number.value()),
        WordOperand::Number(number) => Some(number),
        WordOperand::G(..) | WordOperand::Variable { .. } | WordOperand::Code(_) => None,
    }
}

/// Records where parameter input begins and ends.
fn record_data_input(builder: &mut ChunkBuilder<'_>, words: &Words, block: TextRange) {
    let has_g =
        |code: u32| words.list.iter().any(|word| matches!(word.value, WordOperand::G(c, _) if c == code));
    if has_g(110) {
        builder.push(EntryKind::ParametersEnd, block, 0);
    }
    let l = words.list.iter().find(|word| word.letter == b'L').and_then(|word| whole(literal(word)));
    if has_g(100) && matches!(l, Some(50 | 52)) {
        builder.push(EntryKind::ParametersBegin, block, 0);
    }
}

/// Returns the range of a word's value, without the letter.
pub(crate) fn value_range(text: &[u8], word: TextRange) -> TextRange {
    let inside = word.of(text).get(1..).unwrap_or_default();
    let spaces = inside.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
    TextRange::new((word.start + 1 + spaces as u32).min(word.end), word.end)
}
