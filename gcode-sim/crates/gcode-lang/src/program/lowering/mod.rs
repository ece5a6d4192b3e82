//! Lowering of blocks: tree to operations. A block that cannot run becomes the alarm it raises when reached.
mod expr;

use super::bytecode::{AssignmentTarget, Bytecode, Instruction, Slot};
use super::{
    Assign, CallCode, CallTarget, DialectSyntax, GuardedOp, LoweredWord, Op, OpBody, OpKind, Operand,
    PrintPart, Statement, WordOperand, Words,
};
use crate::alarm::{Alarm, LocatedAlarm};
use crate::source::{Span, Spanned};
use crate::syntax::ast;
pub(super) use expr::ExprContext;

/// Most skips inside one block, one per switch.
const MAX_INNER_SKIPS: usize = 9;

#[derive(Debug, Default)]
pub(super) struct Lowering {
    /// Code of the current expression.
    pub(super) instructions: Vec<Instruction>,
    /// Code of the current block's words, and the numbers of their axes.
    pub(super) codes: Vec<Bytecode>,
    pub(super) axes: Vec<Operand>,
    /// Syntax of the current block that some controls refuse.
    dialect_syntax: Vec<Spanned<DialectSyntax>>,
}

type LoweringResult<T> = Result<T, LocatedAlarm>;

impl Lowering {
    /// Records syntax of the current block that some controls refuse.
    pub(super) fn record_syntax(&mut self, syntax: DialectSyntax, span: Span) {
        self.dialect_syntax.push(Spanned::new(syntax, span));
    }

    /// Lowers a block; `small` starts at its first lower-case letter, as returned by [`lower_case`].
    pub(super) fn lower_block(&mut self, block: &ast::Block, small: Option<Span>) -> Op {
        if let Some(span) = small {
            self.record_syntax(DialectSyntax::LowerCase, span);
        }
        if let Some(span) = block.short_word {
            self.record_syntax(DialectSyntax::ShortWord, span);
        }
        if let ast::DoLine::Begins(span) = block.do_line {
            self.record_syntax(DialectSyntax::StatementsBehindDo, span);
        }
        if let Some(span) = block.behind_semicolon {
            self.record_syntax(DialectSyntax::BlockAfterSemicolon, span);
        }
        let unclosed = |comment: &&ast::Comment| comment.mark == ast::CommentMark::Unclosed;
        if let Some(comment) = block.comments.iter().find(unclosed) {
            self.record_syntax(DialectSyntax::UnclosedComment, comment.span);
        }
        if let Some(comment) = block.comments.iter().find(|comment| comment.word_behind_inner().is_some()) {
            self.record_syntax(DialectSyntax::NestedComment, comment.span);
        }
        let kind = self.lower_kind(block).unwrap_or_else(OpKind::Alarm);
        let skip = block.skip.as_ref().map(|s| s.node);
        let body = match skip.is_some() || !self.dialect_syntax.is_empty() {
            true => OpBody::Guarded(Box::new(GuardedOp {
                skip,
                dialect_syntax: self.dialect_syntax.drain(..).collect(),
                kind,
            })),
            false => OpBody::Plain(kind),
        };
        Op { ordinal: 0, span: block.span, number: block.number.as_ref().map(|n| n.node), body }
    }

    fn lower_kind(&mut self, block: &ast::Block) -> LoweringResult<OpKind> {
        if let Some(ast::Item::Word(first)) = block.items.first()
            && first.address.letter == b'O'
            && matches!(&first.value, ast::WordValue::Literal(number) if number.value() == 0.0)
        {
            self.record_syntax(DialectSyntax::ProgramZero, first.span);
            let rest = ast::Block { items: block.items[1..].to_vec(), ..block.clone() };
            return self.lower_kind(&rest);
        }
        if let Some(ast::Item::Statement(first)) = block.items.first()
            && let ast::Statement::If { condition, has_then } = &first.node
        {
            self.record_syntax(
                if *has_then { DialectSyntax::ThenWords } else { DialectSyntax::PlainIf },
                first.span,
            );
            let condition = self.condition(condition, first.span)?;
            let rest = ast::Block { items: block.items[1..].to_vec(), ..block.clone() };
            let then = match self.lower_kind(&rest)? {
                then @ (OpKind::Words(_)
                | OpKind::AssignDirect(_)
                | OpKind::Statement(Statement::Assign { .. })) => Box::new(then),
                _ => return Err(Alarm::IfFormat.located_at(first.span)),
            };
            return Ok(OpKind::If { condition, then });
        }
        if let Some(several) = self.lower_assignments(block)? {
            return Ok(OpKind::Statement(several));
        }
        let mut words = 0;
        let mut skips = Vec::new();
        let mut statement = None;
        for (index, item) in block.items.iter().enumerate() {
            match item {
                ast::Item::Word(_) => words += 1,
                ast::Item::Skip(switch) => skips.push((switch.node, index)),
                ast::Item::Unreadable(unreadable) => return Err(Box::new(unreadable.alarm.clone())),
                ast::Item::Statement(_) if statement.is_some() => {
                    let is_word = |item: &ast::Item| matches!(item, ast::Item::Word(_));
                    if block.items.iter().any(is_word) {
                        return Err(Alarm::MixedStatements.located_at(block.span));
                    }
                    let what = "two statements in one block".into();
                    return Err(Alarm::MacroFormat { what }.located_at(block.span));
                }
                ast::Item::Statement(found) => statement = Some(found),
            }
        }
        match (statement, words == 0) {
            (Some(_), false) => Err(Alarm::MixedStatements.located_at(block.span)),
            // The effect of /n after a statement on a control is unknown, so it must not be ignored.
            (Some(_), true) if !skips.is_empty() => Err(Alarm::MixedStatements.located_at(block.span)),
            (Some(found), true) => match self.lower_statement(&found.node, found.span, block)? {
                Statement::AssignDirect(assign) => Ok(OpKind::AssignDirect(assign)),
                statement => Ok(OpKind::Statement(statement)),
            },
            (None, true) => Ok(OpKind::Empty),
            (None, false) if skips.len() > MAX_INNER_SKIPS => {
                let what = format!("a block with more than {MAX_INNER_SKIPS} skips inside");
                Err(Alarm::NotSimulated { what }.located_at(block.span))
            }
            (None, false) => {
                let mut lowered = self.lower_words(&block.items, &skips)?;
                self.take_path_of_call(block, &mut lowered);
                if let Some(comment) = block.comments.first() {
                    lowered.keep_text_length(comment.text.len());
                }
                if let Some(value) = block.comments.first().and_then(|comment| sixteen_digits(&comment.text))
                {
                    lowered.set_punched_value(value);
                }
                Ok(OpKind::Words(lowered))
            }
        }
    }

    /// Gives a call without P the program that a path behind its code names, `M98 (Memory/O00002.nc) L2`.
    fn take_path_of_call(&mut self, block: &ast::Block, lowered: &mut Words) {
        let Some(call) = lowered.call_mut() else { return };
        let names_program = !matches!(call.kind, CallCode::Return | CallCode::Cancel | CallCode::Local);
        if !names_program || !matches!(call.target, CallTarget::None) || call.start.is_some() {
            return;
        }
        let behind = block.comments.iter().find(|comment| call.span.end <= comment.span.start);
        let Some((path, span)) = behind.map(|comment| (&comment.text, comment.span)) else { return };
        let path = String::from_utf8_lossy(path);
        let file = path.rsplit(['/', '\\']).next().unwrap_or_default().trim();
        let is_file = |(stem, ending): &(&str, &str)| {
            !stem.is_empty() && !ending.is_empty() && ending.bytes().all(|byte| byte.is_ascii_alphanumeric())
        };
        let Some((stem, _)) = file.rsplit_once('.').filter(is_file) else { return };
        call.target = match stem.trim_start_matches(['O', 'o']).parse() {
            Ok(digits) => {
                let value = WordOperand::Literal(ast::Decimal { negative: false, digits, places: None });
                CallTarget::Number(LoweredWord { letter: b'O', axis: None, comma: false, value, span })
            }
            Err(_) => CallTarget::Name(stem.to_owned()),
        };
        self.record_syntax(DialectSyntax::PathOfCall, span);
    }

    /// Lowers a block of two or more assignments, of which the last may be a GOTO, and nothing else; `None` for any other block.
    fn lower_assignments(&mut self, block: &ast::Block) -> LoweringResult<Option<Statement>> {
        let [_, second, ..] = &block.items[..] else { return Ok(None) };
        let ast::Item::Statement(second) = second else { return Ok(None) };
        let mut several = Vec::new();
        let mut jump = None;
        for item in &block.items {
            let ast::Item::Statement(found) = item else { return Ok(None) };
            match &found.node {
                ast::Statement::Assign { target, value } if jump.is_none() => {
                    several.push(self.lower_assignment(target, value, found.span, block)?);
                }
                ast::Statement::Goto(to) if jump.is_none() && !several.is_empty() => {
                    jump = Some((Statement::Goto(self.lower_jump_target(to)?), found.span));
                }
                _ => return Ok(None),
            }
        }
        if several.len() > 1 {
            self.record_syntax(DialectSyntax::SeveralAssignments, second.span);
        }
        if let Some((goto, span)) = jump {
            self.record_syntax(DialectSyntax::GotoAfterAssignment, span);
            several.push(goto);
        }
        Ok(Some(Statement::Assignments(several)))
    }

    fn lower_statement(
        &mut self,
        statement: &ast::Statement,
        span: Span,
        block: &ast::Block,
    ) -> LoweringResult<Statement> {
        Ok(match statement {
            ast::Statement::Assign { target, value } => self.lower_assignment(target, value, span, block)?,
            ast::Statement::Goto(to) => Statement::Goto(self.lower_jump_target(to)?),
            ast::Statement::IfGoto { condition, to } => Statement::IfGoto {
                condition: self.condition(condition, span)?,
                to: self.lower_jump_target(to)?,
            },
            ast::Statement::IfThen { condition, then } => {
                let condition = self.condition(condition, span)?;
                let then = match &**then {
                    ast::Statement::Assign { .. } => self.lower_statement(then, span, block)?,
                    ast::Statement::Goto(_) => {
                        self.record_syntax(DialectSyntax::ThenGoto, span);
                        self.lower_statement(then, span, block)?
                    }
                    _ => Statement::Alarm(Alarm::IfFormat.located_at(span)),
                };
                Statement::IfThen { condition, then: Box::new(then) }
            }
            ast::Statement::If { .. } => return Err(Alarm::IfFormat.located_at(span)),
            ast::Statement::While { condition, number } => {
                let number = loop_number(number)?;
                Statement::While { condition: self.condition(condition, span)?, number, end: 0 }
            }
            ast::Statement::Do(number) => Statement::Do { number: loop_number(number)?, end: 0 },
            ast::Statement::End(number) => Statement::End { number: loop_number(number)?, start: 0 },
            ast::Statement::SetNames { first, names } => {
                self.record_syntax(DialectSyntax::NewWord("SETVN"), span);
                let first = self.operand(first, ExprContext::MACRO)?;
                Statement::SetNames { first, names: names.clone() }
            }
            ast::Statement::Print { kind, parts } => self.lower_print(*kind, parts, span)?,
            ast::Statement::OpenOutput => Statement::OpenOutput,
            ast::Statement::CloseOutput => Statement::CloseOutput,
        })
    }

    fn lower_assignment(
        &mut self,
        target: &ast::Expr,
        value: &ast::Expr,
        span: Span,
        block: &ast::Block,
    ) -> LoweringResult<Statement> {
        let (to, value) = (self.compile_target(target)?, self.operand(value, ExprContext::MACRO)?);
        Ok(match (to, value) {
            (AssignmentTarget::Slot(Slot::Free(variable)), Operand::Code(code)) => {
                Statement::AssignDirect(Assign { variable, code })
            }
            (to, value) => {
                let text = block.comments.iter().find(|c| c.span.start >= span.start);
                let text = text.map(|c| c.text.clone().into_boxed_slice());
                Statement::Assign { target: to, target_span: target.span, value, text }
            }
        })
    }

    fn lower_jump_target(&mut self, to: &ast::Expr) -> LoweringResult<Spanned<Operand>> {
        Ok(Spanned::new(self.operand(to, ExprContext::MACRO)?, to.span))
    }

    fn lower_print(
        &mut self,
        kind: ast::PrintKind,
        parts: &[ast::PrintPart],
        span: Span,
    ) -> LoweringResult<Statement> {
        let mut lowered = Vec::new();
        for part in parts {
            lowered.push(match part {
                ast::PrintPart::Text(text) => PrintPart::Text(text.clone()),
                ast::PrintPart::Value { variable, format } => {
                    let digits: Vec<u8> = format.bytes().map(|b| b.wrapping_sub(b'0')).collect();
                    let (whole, decimals) = match (kind, &digits[..]) {
                        (ast::PrintKind::Decimal, [whole @ 0..=9, decimals @ 0..=9]) => (*whole, *decimals),
                        (ast::PrintKind::Binary, [decimals @ 0..=9]) => (0, *decimals),
                        _ => return Err(Alarm::PrintFormat.located_at(span)),
                    };
                    let value = self.operand(variable, ExprContext::MACRO)?;
                    PrintPart::Value { value, whole, decimals }
                }
            });
        }
        Ok(Statement::Print { kind, parts: lowered })
    }
}

/// Reads sixteen hexadecimal digits, the form in which a control punches a double.
fn sixteen_digits(text: &[u8]) -> Option<u64> {
    let text = std::str::from_utf8(text).ok()?.trim();
    let hexadecimal = text.len() == 16 && text.bytes().all(|b| b.is_ascii_hexdigit());
    hexadecimal.then(|| u64::from_str_radix(text, 16).ok()).flatten()
}

/// Returns the span from the first lower-case letter outside comments to the end of the block.
///
/// `None` without one, and for an unreadable block, which has its own alarm.
pub(super) fn lower_case(block: &ast::Block, bytes: &[u8]) -> Option<Span> {
    if matches!(block.items.last(), Some(ast::Item::Unreadable(_))) {
        return None;
    }
    let written = bytes.get(block.span.start as usize..block.span.end as usize)?;
    // Most blocks have no lower-case letter at all.
    if !written.iter().fold(false, |any, byte| any | byte.is_ascii_lowercase()) {
        return None;
    }
    let mut from = block.span.start as usize;
    let small = |from: usize, to: usize| {
        let at = bytes.get(from..to)?.iter().position(u8::is_ascii_lowercase)?;
        Some(Span { start: (from + at) as u32, ..block.span })
    };
    for comment in &block.comments {
        if let Some(found) = small(from, comment.span.start as usize) {
            return Some(found);
        }
        from = comment.span.end as usize;
    }
    small(from, block.span.end as usize)
}

fn loop_number(number: &Spanned<i64>) -> LoweringResult<u8> {
    match number.node {
        1..=3 => Ok(number.node as u8),
        other => Err(Alarm::LoopNumber { number: other }.located_at(number.span)),
    }
}
