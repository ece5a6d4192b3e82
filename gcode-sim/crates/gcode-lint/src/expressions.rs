//! Expressions of a block: those of its words, statements and conditions.
use gcode_lang::syntax::ast::{Block, Condition, Expr, Item, PrintPart, Statement, WordValue};

/// Returns the outermost expressions in the order written.
pub(super) fn block_expressions(block: &Block) -> Vec<&Expr> {
    let mut found = Vec::new();
    for item in &block.items {
        match item {
            Item::Word(word) => {
                found.extend(word.axis.as_deref());
                if let WordValue::Expr(expr) = &word.value {
                    found.push(expr);
                }
            }
            Item::Statement(statement) => collect_from_statement(&statement.node, &mut found),
            Item::Skip(_) | Item::Unreadable(_) => {}
        }
    }
    found
}

fn collect_from_statement<'a>(statement: &'a Statement, found: &mut Vec<&'a Expr>) {
    match statement {
        Statement::Assign { target, value } => found.extend([target, value]),
        Statement::Goto(to) => found.push(to),
        Statement::IfGoto { condition, to } => {
            collect_from_condition(condition, found);
            found.push(to);
        }
        Statement::IfThen { condition, then } => {
            collect_from_condition(condition, found);
            collect_from_statement(then, found);
        }
        Statement::While { condition, .. } | Statement::If { condition, .. } => {
            collect_from_condition(condition, found)
        }
        Statement::Print { parts, .. } => {
            found.extend(parts.iter().filter_map(|part| match part {
                PrintPart::Value { variable, .. } => Some(variable),
                PrintPart::Text(_) => None,
            }));
        }
        Statement::SetNames { first, .. } => found.push(first),
        Statement::Do(_) | Statement::End(_) | Statement::OpenOutput | Statement::CloseOutput => {}
    }
}

fn collect_from_condition<'a>(condition: &'a Condition, found: &mut Vec<&'a Expr>) {
    match condition {
        Condition::Compare { left, right, .. } => found.extend([left, right]),
        Condition::Logic(_, _, one, other) => {
            collect_from_condition(one, found);
            collect_from_condition(other, found);
        }
        Condition::Bracket(inner) => collect_from_condition(inner, found),
    }
}
