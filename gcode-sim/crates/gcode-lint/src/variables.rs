//! Variables that a block reads, with the use of each value: some uses tolerate a vacant variable.
use gcode_lang::program::{OpIndex, Slot};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{Block, Expr, ExprKind, Item, Statement};

use super::expressions::{UsedExpressions, ValueUse, block_expressions};
use super::literal;

/// One read of a variable.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VariableRead {
    pub number: u32,
    pub usage: ValueUse,
    pub span: Span,
}

/// Variable reads of a block or a condition.
#[derive(Clone, Debug, Default)]
pub(crate) struct VariableUses {
    pub reads: Vec<VariableRead>,
    /// True if the number of a variable is computed.
    pub reads_computed: bool,
}

pub(super) fn block_reads(block: &Block) -> Vec<VariableRead> {
    VariableUses::of(block_expressions(block)).reads
}

/// Returns true for a common variable of every control.
pub fn is_common(number: u32) -> bool {
    (100..=999).contains(&number) && matches!(Slot::of(number), Slot::Free(_))
}

/// Returns the numbers of the variables that a block reads by number or by name, without duplicates.
pub fn variables_read(block: &Block) -> Vec<u32> {
    let mut numbers = Vec::new();
    for read in block_reads(block) {
        if !numbers.contains(&read.number) {
            numbers.push(read.number);
        }
    }
    numbers
}

impl VariableUses {
    pub(super) fn of(expressions: UsedExpressions<'_>) -> Self {
        let mut uses = Self::default();
        for (expr, usage) in expressions {
            uses.expr(expr, usage);
        }
        uses
    }

    fn expr(&mut self, expr: &Expr, usage: ValueUse) {
        // An operand computed within a comparison is still part of the comparison.
        let inside = match usage {
            ValueUse::VacancyTest | ValueUse::Comparison => ValueUse::Comparison,
            _ => ValueUse::Computed,
        };
        match &expr.kind {
            ExprKind::Variable(_) | ExprKind::Named(_) => {
                match literal::variable(expr) {
                    _ if usage == ValueUse::Target => {}
                    Some(0) => {}
                    Some(number) => self.reads.push(VariableRead { number, usage, span: expr.span }),
                    None => self.reads_computed = true,
                }
                // Variables from which the number is computed.
                expr.operands().for_each(|index| self.expr(index, ValueUse::Computed));
            }
            ExprKind::Bracket(inner) | ExprKind::Plus(inner) => self.expr(inner, usage),
            ExprKind::Negate(inner) if usage == ValueUse::Word => self.expr(inner, usage),
            kind => {
                self.reads_computed |= matches!(kind, ExprKind::Parameter { .. });
                expr.operands().for_each(|part| self.expr(part, inside));
            }
        }
    }
}

/// Returns target and value of a block's assignment, alone or after IF … THEN.
pub(super) fn assignment(block: &Block) -> Option<(&Expr, &Expr)> {
    block.items.iter().find_map(item_assignment)
}

pub(super) fn item_assignment(item: &Item) -> Option<(&Expr, &Expr)> {
    match item {
        Item::Statement(statement) => statement_assignment(&statement.node),
        _ => None,
    }
}

pub(super) fn statement_assignment(statement: &Statement) -> Option<(&Expr, &Expr)> {
    match statement {
        Statement::Assign { target, value } => Some((target, value)),
        Statement::IfThen { then, .. } => statement_assignment(then),
        _ => None,
    }
}

/// Returns the statement of a block, `None` for a block of words.
pub(super) fn statement(blocks: &[Block], block: OpIndex) -> Option<&Statement> {
    blocks.get(block)?.items.iter().find_map(|item| match item {
        Item::Statement(statement) => Some(&statement.node),
        _ => None,
    })
}
