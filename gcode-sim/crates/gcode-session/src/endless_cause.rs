//! Cause of an endless loop, if visible: a counter that its assignment does not change.
use gcode_control::{Control, Value};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Expr, ExprKind, Item, Statement};
use gcode_lang::syntax::parse;

/// Returns `#8=#8+#7 adds nothing: #7 is 0` for the blocks from `first` to `last` of one file.
pub(super) fn unchanged_counter(control: &Control, first: Span, last: Span) -> Option<String> {
    if first.source != last.source {
        return None;
    }
    let sources = control.memory().sources();
    let programs = parse(first.source, &sources.get(first.source).bytes);
    let blocks = programs.iter().flat_map(|program| &program.blocks);
    let looped = blocks.filter(|block| first.start <= block.span.start && block.span.end <= last.end);
    looped.flat_map(|block| &block.items).find_map(|item| {
        let Item::Statement(statement) = item else { return None };
        let Statement::Assign { target, value } = &statement.node else { return None };
        let ExprKind::Binary(BinaryOp::Add | BinaryOp::Sub, counter, step) = &value.kind else { return None };
        let (target, counter, step) = (number(target)?, number(counter)?, number(step)?);
        let stands = match control.variable(step).ok()? {
            Value::Vacant => "vacant",
            Value::Number(0.0) => "0",
            Value::Number(_) => return None,
        };
        let written = sources.text(statement.span);
        (target == counter).then(|| format!("{} adds nothing: #{step} is {stands}", written.trim()))
    })
}

/// Returns the number of a variable with a literal index.
fn number(expr: &Expr) -> Option<u32> {
    let ExprKind::Variable(index) = &expr.kind else { return None };
    let ExprKind::Literal(literal) = &index.kind else { return None };
    let number = literal.value();
    (number.fract() == 0.0 && (0.0..100_000.0).contains(&number)).then_some(number as u32)
}
