//! Reads of unset locals: locals that a call leaves vacant and that no block sets.
use std::rc::Rc;

use gcode_lang::program::OpIndex;
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{Expr, Statement};

use super::calls::CallSite;
use super::context::ProgramUnit;
use super::expressions::ValueUse;
use super::first_reach::FirstReach;
use super::literal::variable;
use super::vacancy::{ANY_VALUE, Locals, NUMBER, States, guards};
use super::variables::{self, VariableRead};

/// Returns the locals at the start of a called macro.
pub(super) fn entry_locals(call: &CallSite) -> Locals {
    let mut entry = Locals::UNSET;
    for argument in &call.arguments {
        entry.0[argument.local] = if argument.is_number { NUMBER } else { ANY_VALUE };
    }
    entry
}

/// Iterates over the reads of locals that are certainly unset, each local once per block.
pub(super) fn unset_reads<'a>(
    unit: &'a ProgramUnit<'a>,
    states: &'a States,
) -> impl Iterator<Item = ((OpIndex, u32), (Span, ValueUse))> + 'a {
    let first = Rc::new(FirstReach::new(unit, states));
    let reached = unit.blocks.iter().enumerate().filter(|(block, _)| states[*block].is_some());
    reached.flat_map(move |(block, written)| {
        let itself = variables::assignment(written)
            .filter(|(target, value)| target.kind == value.kind || same_variable(target, value));
        let reads = variables::block_reads(written);
        let minded = guarded_locals(unit, block, &reads);
        let plain = reads.into_iter().filter(move |read| {
            // `#1=#1` has no effect.
            (1..=33).contains(&read.number)
                && read.usage != ValueUse::VacancyTest
                && itself.is_none()
                && !minded.contains(&read.number)
        });
        let first = Rc::clone(&first);
        plain
            .filter(move |read| first.is_unset(block, read.number))
            .map(move |read| ((block, read.number), (read.span, read.usage)))
    })
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

fn same_variable(left: &Expr, right: &Expr) -> bool {
    variable(left).is_some() && variable(left) == variable(right)
}
