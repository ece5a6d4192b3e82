//! Expressions of a block, each with the use that the block makes of its value.
use gcode_lang::syntax::ast::{Block, Condition, Expr, Item, PrintPart, Statement, WordValue};

use super::literal;

/// Use that a block makes of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueUse {
    /// Left side of an assignment: only the number of the variable is read.
    Target,
    /// Compared with `#0`, a test for vacancy.
    VacancyTest,
    /// Operand of another comparison.
    Comparison,
    /// Passed on unchanged, vacancy included: `#1=#2`, `G65 … A#2`.
    PassedOn,
    /// Value of a word, which is ignored if it is vacant.
    Word,
    /// Any other use, where a vacant value counts as 0.
    Computed,
}

/// Outermost expressions with their uses, in the order written.
pub type UsedExpressions<'a> = Vec<(&'a Expr, ValueUse)>;

/// Returns the outermost expressions of a block with their uses.
pub fn block_expressions(block: &Block) -> UsedExpressions<'_> {
    let mut found = Vec::new();
    let has_call = block.items.iter().any(is_macro_call);
    for item in &block.items {
        match item {
            Item::Word(word) => {
                found.extend(word.axis.iter().map(|axis| (&**axis, ValueUse::Computed)));
                if let WordValue::Expr(expr) = &word.value {
                    found.push((expr, if has_call { ValueUse::PassedOn } else { ValueUse::Word }));
                }
            }
            Item::Statement(statement) => collect_from_statement(&statement.node, &mut found),
            Item::Skip(_) | Item::Unreadable(_) => {}
        }
    }
    found
}

pub(super) fn condition_expressions(condition: &Condition) -> UsedExpressions<'_> {
    let mut found = Vec::new();
    collect_from_condition(condition, &mut found);
    found
}

/// Returns true for G65, G66 and G66.1, whose other words are arguments.
fn is_macro_call(item: &Item) -> bool {
    let Item::Word(word) = item else { return false };
    let WordValue::Literal(number) = &word.value else { return false };
    word.address.letter == b'G' && [65.0, 66.0, 66.1].contains(&number.value())
}

fn collect_from_statement<'a>(statement: &'a Statement, found: &mut UsedExpressions<'a>) {
    match statement {
        Statement::Assign { target, value } => {
            found.extend([(target, ValueUse::Target), (value, ValueUse::PassedOn)]);
        }
        Statement::IfGoto { condition, to } => {
            collect_from_condition(condition, found);
            found.push((to, ValueUse::Computed));
        }
        Statement::IfThen { condition, then } => {
            collect_from_condition(condition, found);
            collect_from_statement(then, found);
        }
        Statement::While { condition, .. } | Statement::If { condition, .. } => {
            collect_from_condition(condition, found);
        }
        Statement::Print { parts, .. } => found.extend(parts.iter().filter_map(|part| match part {
            PrintPart::Value { variable, .. } => Some((variable, ValueUse::Computed)),
            PrintPart::Text(_) => None,
        })),
        Statement::Goto(value) | Statement::SetNames { first: value, .. } => {
            found.push((value, ValueUse::Computed));
        }
        Statement::Do(_) | Statement::End(_) | Statement::OpenOutput | Statement::CloseOutput => {}
    }
}

fn collect_from_condition<'a>(condition: &'a Condition, found: &mut UsedExpressions<'a>) {
    match condition {
        Condition::Compare { left, right, .. } => {
            let usage = |other: &Expr| match literal::variable(other) {
                Some(0 | 3100) => ValueUse::VacancyTest,
                _ => ValueUse::Comparison,
            };
            found.extend([(left, usage(right)), (right, usage(left))]);
        }
        Condition::Logic(_, _, one, other) => {
            collect_from_condition(one, found);
            collect_from_condition(other, found);
        }
        Condition::Bracket(inner) => collect_from_condition(inner, found),
        Condition::Value { value, .. } => found.push((value, ValueUse::Comparison)),
    }
}
