//! Variables that a block reads, with the use of each value: some uses tolerate a vacant variable.
use gcode_lang::program::OpIndex;
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{
    Block, CallForm, Condition, Expr, ExprKind, Item, PrintPart, Statement, WordValue,
};

use super::literal;

/// Use of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VariableUse {
    /// Compared with `#0`, a test for vacancy.
    VacancyTest,
    /// Operand of another comparison.
    Comparison,
    /// Passed on unchanged, vacancy included: `#1=#2`, `G65 … A#2`.
    PassedOn,
    /// Value of a word, which is ignored if the variable is vacant.
    Word,
    /// Any other use, where a vacant variable counts as 0.
    Computed,
}

/// One read of a variable.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VariableRead {
    pub number: u32,
    pub usage: VariableUse,
    pub span: Span,
}

/// Variable reads of a block.
#[derive(Clone, Debug, Default)]
pub(crate) struct VariableUses {
    pub reads: Vec<VariableRead>,
    /// True if the number of a variable is computed.
    pub reads_computed: bool,
}

/// Returns the variable reads of a block.
pub(super) fn block_uses(block: &Block) -> VariableUses {
    let mut uses = VariableUses::default();
    let call = block.items.iter().any(is_macro_call);
    for item in &block.items {
        match item {
            Item::Word(word) => {
                word.axis.iter().for_each(|axis| uses.expr(axis, VariableUse::Computed));
                if let WordValue::Expr(expr) = &word.value {
                    uses.expr(expr, if call { VariableUse::PassedOn } else { VariableUse::Word });
                }
            }
            Item::Statement(statement) => uses.statement(&statement.node),
            Item::Skip(_) | Item::Unreadable(_) => {}
        }
    }
    uses
}

/// Returns the numbers of the variables that a block reads by number or by name, without duplicates.
pub fn variables_read(block: &Block) -> Vec<u32> {
    let mut numbers = Vec::new();
    for read in block_uses(block).reads {
        if !numbers.contains(&read.number) {
            numbers.push(read.number);
        }
    }
    numbers
}

/// Returns true for G65, G66 and G66.1, whose other words are arguments.
fn is_macro_call(item: &Item) -> bool {
    let Item::Word(word) = item else { return false };
    match &word.value {
        WordValue::Literal(number) if word.address.letter == b'G' => {
            let value = number.value();
            value == 65.0 || value == 66.0 || value == 66.1
        }
        _ => false,
    }
}

/// Returns the variable reads of a condition.
pub(super) fn condition_uses(condition: &Condition) -> VariableUses {
    let mut uses = VariableUses::default();
    uses.condition(condition);
    uses
}

impl VariableUses {
    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Assign { target, value } => {
                self.record_index_reads(target);
                self.expr(value, VariableUse::PassedOn);
            }
            Statement::Goto(to) => self.expr(to, VariableUse::Computed),
            Statement::IfGoto { condition, to } => {
                self.condition(condition);
                self.expr(to, VariableUse::Computed);
            }
            Statement::IfThen { condition, then } => {
                self.condition(condition);
                self.statement(then);
            }
            Statement::While { condition, .. } | Statement::If { condition, .. } => self.condition(condition),
            Statement::Print { parts, .. } => {
                for part in parts {
                    if let PrintPart::Value { variable, .. } = part {
                        self.expr(variable, VariableUse::Computed);
                    }
                }
            }
            Statement::SetNames { first, .. } => self.expr(first, VariableUse::Computed),
            Statement::Do(_) | Statement::End(_) | Statement::OpenOutput | Statement::CloseOutput => {}
        }
    }

    fn condition(&mut self, condition: &Condition) {
        match condition {
            Condition::Compare { left, right, .. } => {
                let usage = |other: &Expr| match literal::variable(other) {
                    Some(0 | 3100) => VariableUse::VacancyTest,
                    _ => VariableUse::Comparison,
                };
                self.expr(left, usage(right));
                self.expr(right, usage(left));
            }
            Condition::Logic(_, _, left, right) => {
                self.condition(left);
                self.condition(right);
            }
            Condition::Bracket(inner) => self.condition(inner),
        }
    }

    fn expr(&mut self, expr: &Expr, usage: VariableUse) {
        // An operand computed within a comparison is still part of the comparison.
        let inside = if matches!(usage, VariableUse::VacancyTest | VariableUse::Comparison) {
            VariableUse::Comparison
        } else {
            VariableUse::Computed
        };
        match &expr.kind {
            ExprKind::Literal(_) => {}
            ExprKind::Variable(_) => {
                match literal::variable(expr) {
                    Some(0) => {}
                    Some(number) => self.reads.push(VariableRead { number, usage, span: expr.span }),
                    None => self.reads_computed = true,
                }
                self.record_index_reads(expr);
            }
            ExprKind::Named(name) => {
                match literal::variable(expr) {
                    Some(number) => self.reads.push(VariableRead { number, usage, span: expr.span }),
                    None => self.reads_computed = true,
                }
                name.index.iter().for_each(|index| self.expr(index, VariableUse::Computed));
            }
            ExprKind::Negate(inner) if usage == VariableUse::Word => self.expr(inner, usage),
            ExprKind::Bracket(inner) | ExprKind::Plus(inner) => self.expr(inner, usage),
            ExprKind::Negate(inner) => self.expr(inner, inside),
            ExprKind::Binary(_, left, right) => {
                self.expr(left, inside);
                self.expr(right, inside);
            }
            ExprKind::Call(_, CallForm::One(inner)) => self.expr(inner, inside),
            ExprKind::Call(_, CallForm::Slash(left, right) | CallForm::Comma(left, right)) => {
                self.expr(left, inside);
                self.expr(right, inside);
            }
            ExprKind::Parameter { number, bit, axis } => {
                self.reads_computed = true;
                self.expr(number, inside);
                bit.iter().chain(axis).for_each(|part| self.expr(part, inside));
            }
            ExprKind::AxisNumber(_) => {}
        }
    }

    /// Records the variables from which a variable's number is computed.
    fn record_index_reads(&mut self, variable: &Expr) {
        if let ExprKind::Variable(index) = &variable.kind {
            self.expr(index, VariableUse::Computed);
        }
    }
}

/// Returns target and value of a block's assignment, alone or after IF … THEN.
pub(super) fn assignment(block: &Block) -> Option<(&Expr, &Expr)> {
    block.items.iter().find_map(item_assignment)
}

/// Returns target and value of an item's assignment.
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
