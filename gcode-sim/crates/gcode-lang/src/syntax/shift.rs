//! Shift of a tree: its places after an edit in front of it.
use super::ast::{Block, Condition, DoLine, Expr, Item, PrintPart, Statement, WordValue};
use crate::source::Span;

impl Block {
    /// Moves all places of the block by a number of bytes.
    pub(super) fn shift(&mut self, delta: i64) {
        shift_span(&mut self.span, delta);
        let marks = [
            self.skip.as_mut().map(|skip| &mut skip.span),
            self.short_word.as_mut(),
            self.behind_semicolon.as_mut(),
        ];
        if let DoLine::Begins(span) = &mut self.do_line {
            shift_span(span, delta);
        }
        let number = self.number.as_mut().map(|number| &mut number.span);
        marks.into_iter().chain([number]).flatten().for_each(|span| shift_span(span, delta));
        self.comments.iter_mut().for_each(|comment| shift_span(&mut comment.span, delta));
        self.items.iter_mut().for_each(|item| shift_item(item, delta));
    }
}

fn shift_span(span: &mut Span, delta: i64) {
    span.start = (i64::from(span.start) + delta) as u32;
    span.end = (i64::from(span.end) + delta) as u32;
}

fn shift_item(item: &mut Item, delta: i64) {
    match item {
        Item::Word(word) => {
            shift_span(&mut word.span, delta);
            let value = match &mut word.value {
                WordValue::Expr(value) => Some(value),
                WordValue::Literal(_) | WordValue::Name(_) => None,
            };
            word.axis.iter_mut().chain(value).for_each(|expr| shift_expr(expr, delta));
        }
        Item::Statement(statement) => {
            shift_span(&mut statement.span, delta);
            shift_statement(&mut statement.node, delta);
        }
        Item::Skip(skip) => shift_span(&mut skip.span, delta),
        Item::Unreadable(rest) => {
            shift_span(&mut rest.span, delta);
            shift_span(&mut rest.alarm.span, delta);
        }
    }
}

fn shift_statement(statement: &mut Statement, delta: i64) {
    match statement {
        Statement::Assign { target, value } => {
            shift_expr(target, delta);
            shift_expr(value, delta);
        }
        Statement::Goto(to) | Statement::SetNames { first: to, .. } => shift_expr(to, delta),
        Statement::IfGoto { condition, to } => {
            shift_condition(condition, delta);
            shift_expr(to, delta);
        }
        Statement::IfThen { condition, then } => {
            shift_condition(condition, delta);
            shift_statement(then, delta);
        }
        Statement::If { condition, .. } => shift_condition(condition, delta),
        Statement::While { condition, number } => {
            shift_condition(condition, delta);
            shift_span(&mut number.span, delta);
        }
        Statement::Do(number) | Statement::End(number) => shift_span(&mut number.span, delta),
        Statement::Print { parts, .. } => {
            for part in parts {
                if let PrintPart::Value { variable, .. } = part {
                    shift_expr(variable, delta);
                }
            }
        }
        Statement::OpenOutput | Statement::CloseOutput => {}
    }
}

fn shift_condition(condition: &mut Condition, delta: i64) {
    match condition {
        Condition::Compare { left, right, span, .. } => {
            shift_expr(left, delta);
            shift_expr(right, delta);
            shift_span(span, delta);
        }
        Condition::Logic(_, _, left, right) => {
            shift_condition(left, delta);
            shift_condition(right, delta);
        }
        Condition::Bracket(inner) => shift_condition(inner, delta),
        Condition::Value { value, .. } => shift_expr(value, delta),
    }
}

fn shift_expr(expr: &mut Expr, delta: i64) {
    shift_span(&mut expr.span, delta);
    expr.operands_mut().for_each(|part| shift_expr(part, delta));
}
