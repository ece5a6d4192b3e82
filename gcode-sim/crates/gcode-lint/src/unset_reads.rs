//! Reads of unset locals: locals that a call leaves vacant and that no block sets.
use gcode_lang::program::OpIndex;
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Block, Expr, ExprKind, Statement};

use super::calls::CallSite;
use super::context::ProgramUnit;
use super::expressions::ValueUse;
use super::first_reach::FirstReach;
use super::literal::variable;
use super::vacancy::{ANY_VALUE, Locals, NUMBER, States, guards};
use super::variables::{self, VariableRead, VariableUses};

/// Returns the locals at the start of a called macro.
pub(super) fn entry_locals(call: &CallSite) -> Locals {
    let mut entry = Locals::UNSET;
    for argument in &call.arguments {
        entry.0[argument.local] = if argument.is_number { NUMBER } else { ANY_VALUE };
    }
    entry
}

/// Read of an unset local: its block and local, the place and the use.
type UnsetRead = ((OpIndex, u32), (Span, ValueUse));

/// Returns the reads of locals that are certainly unset.
pub(super) fn unset_reads(unit: &ProgramUnit<'_>, states: &States) -> Vec<UnsetRead> {
    let first = FirstReach::new(unit, states);
    let mut found = Vec::new();
    for (block, written) in unit.blocks.iter().enumerate().filter(|(block, _)| states[*block].is_some()) {
        let reads = unit.reads(block);
        if !reads.iter().any(|read| (1..=33).contains(&read.number)) {
            continue;
        }
        // `#1=#1` has no effect.
        if variables::assignment(written).is_some_and(|(target, value)| same_variable(target, value)) {
            continue;
        }
        let guarded = guarded_locals(unit, block, reads);
        let counter = counter(written);
        let unset = reads.iter().filter(|read| {
            (1..=33).contains(&read.number)
                && read.usage != ValueUse::VacancyTest
                && Some(read.number) != counter
                && !guarded.contains(&read.number)
                && first.is_unset(block, read.number)
        });
        found.extend(unset.map(|read| ((block, read.number), (read.span, read.usage))));
    }
    found
}

/// Returns the locals whose vacancy a condition tests: the conditional part reads them only if they are set.
///
/// Other comparisons in the same condition are harmless.
fn guarded_locals(unit: &ProgramUnit<'_>, block: OpIndex, reads: &[VariableRead]) -> Vec<u32> {
    use Statement::{IfGoto, IfThen, While};
    let Some(IfThen { condition, .. } | IfGoto { condition, .. } | While { condition, .. }) =
        variables::statement(&unit.blocks, block)
    else {
        return Vec::new();
    };
    let tested = reads.iter().filter(|read| read.usage == ValueUse::VacancyTest).map(|read| read.number);
    // After IF[#9 EQ #0]THEN a read of #9 is still an error.
    tested.filter(|number| !is_computed_with(reads, *number) || guards(condition, *number)).collect()
}

/// Returns true if a local has a use other than comparison.
fn is_computed_with(reads: &[VariableRead], number: u32) -> bool {
    reads.iter().any(|read| {
        read.number == number && !matches!(read.usage, ValueUse::VacancyTest | ValueUse::Comparison)
    })
}

/// Returns the variable that a block adds to or subtracts from: in `#33=#33+1` a vacant #33 is 0, and a count begins.
fn counter(block: &Block) -> Option<u32> {
    let (target, value) = variables::assignment(block)?;
    let target = variable(target)?;
    let ExprKind::Binary(op @ (BinaryOp::Add | BinaryOp::Sub), left, right) = &value.kind else {
        return None;
    };
    let is_counted = |term: &Expr, other: &Expr| {
        let reads = VariableUses::of(vec![(other, ValueUse::Computed)]).reads;
        variable(term) == Some(target) && reads.iter().all(|read| read.number != target)
    };
    (is_counted(left, right) || *op == BinaryOp::Add && is_counted(right, left)).then_some(target)
}

fn same_variable(left: &Expr, right: &Expr) -> bool {
    variable(left).is_some() && variable(left) == variable(right)
}
