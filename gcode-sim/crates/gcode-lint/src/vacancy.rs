//! Vacancy analysis: the possible states of each local at each block.
//!
//! A state is a set of possibilities for each local: never set, set to `#0`, or a number. Where paths meet,
//! the sets are united. A condition that the state decides (`#24 EQ #0` for a local that is never set) is
//! followed in one direction only.
use std::collections::BTreeSet;

use gcode_lang::program::{self, OpIndex, OpKind};
use gcode_lang::syntax::ast::{
    BinaryOp, Block, CallForm, Condition, Expr, ExprKind, Function, Item, Relation, Statement,
};

use super::block_marks::KEEPS_LOCALS;
use super::context::ProgramUnit;
use super::control_flow::raises_alarm;
pub(crate) use super::locals::{ANY_VALUE, Locals, NUMBER, States, UNSET, VACANT};
use super::{literal, variables};

/// Returns the states of a program whose locals are all unset at its first block; of a piece those that its start has.
pub(crate) fn states_without_arguments<'u>(unit: &'u ProgramUnit<'_>) -> &'u States {
    let start = unit.piece.as_ref().map_or(Locals::UNSET, |piece| piece.start.locals);
    unit.states_without_arguments.get_or_init(|| states(unit, start))
}

/// Computes the states of a program whose locals are `entry` at its first block.
pub(crate) fn states(unit: &ProgramUnit<'_>, entry: Locals) -> States {
    // A call that starts at another block brings its own locals.
    let far = unit.piece.iter().flat_map(|piece| &piece.entries).map(|entry| entry.locals);
    let entries = std::iter::once(Some(entry)).chain(far).chain(std::iter::repeat(Some(Locals::ANYTHING)));
    let starts = unit.entry_blocks.iter().zip(entries);
    let starts = starts.filter_map(|(block, locals)| Some((*block, locals?)));
    unit.flow.propagate(starts, Locals::join, |block, state, open| steps(unit, block, state, open))
}

/// Returns true if a path leads from the first block to an end without an alarm and does not execute one of some blocks.
///
/// A loop that is reached counts as run at least once: left at its END only.
pub(super) fn can_avoid(unit: &ProgramUnit<'_>, entry: Locals, blocks: &BTreeSet<OpIndex>) -> bool {
    let starts = unit.entry_blocks.first().map(|start| (*start, entry));
    let ops = unit.program.ops();
    let next = |block: OpIndex, state: &Locals, open: &mut Vec<_>| {
        if blocks.contains(&block) {
            return;
        }
        match ops.get(block).map(|op| op.kind()) {
            Some(OpKind::Statement(program::Statement::While { end, .. })) => {
                let mut to = Vec::new();
                steps(unit, block, state, &mut to);
                open.extend(to.into_iter().filter(|(to, _)| *to != end + 1));
            }
            Some(OpKind::Statement(program::Statement::End { start, .. })) => {
                steps(unit, *start, state, open);
                open.push((block + 1, *state));
            }
            _ => steps(unit, block, state, open),
        }
    };
    let states = unit.flow.propagate(starts, Locals::join, next);
    let is_end = |block: OpIndex| match ops.get(block) {
        Some(op) => {
            let successors = &unit.flow.block_successors[block];
            successors.is_exit && !raises_alarm(op.kind()) && !blocks.contains(&block)
        }
        None => block == ops.len(),
    };
    states.iter().enumerate().any(|(block, state)| state.is_some() && is_end(block))
}

/// Adds the nodes that follow a node, each with its state.
pub(super) fn steps(
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    state: &Locals,
    steps: &mut Vec<(OpIndex, Locals)>,
) {
    let mut to_all = |state: Locals| steps.extend(unit.flow.successors(block).map(|to| (to, state)));
    let Some(op) = unit.program.ops().get(block) else { return to_all(*state) };
    let mut after = *state;
    let keeps_locals = unit.marks[block] & KEEPS_LOCALS != 0;
    let statement = if keeps_locals { None } else { variables::statement(&unit.blocks, block) };
    match (op.kind(), statement) {
        _ if keeps_locals => to_all(after),
        (
            OpKind::Statement(_),
            Some(Statement::IfGoto { condition, .. } | Statement::While { condition, .. }),
        ) => {
            let on_true = truth(condition, state);
            let is_jump = matches!(statement, Some(Statement::IfGoto { .. }));
            let split = |to: OpIndex| {
                // IF jumps if its condition is true, WHILE if it is false.
                let taken = (to == block + 1) != is_jump;
                let sure = to != block + 1 || !unit.flow.block_successors[block].jumps.contains(&to);
                let is_impossible = sure && on_true == Some(!taken);
                (!is_impossible).then(|| (to, refined(condition, taken, state)))
            };
            steps.extend(unit.flow.successors(block).filter_map(split));
        }
        (OpKind::Statement(_), Some(Statement::IfThen { condition, then })) => {
            let answer = truth(condition, state);
            if answer != Some(false) {
                let mut state = refined(condition, true, state);
                if let Some((target, value)) = variables::statement_assignment(then) {
                    assign(target, value, &mut state);
                    steps.extend((!raises_alarm(op.kind())).then_some((block + 1, state)));
                } else {
                    let jumps = &unit.flow.block_successors[block].jumps;
                    steps.extend(jumps.iter().map(|to| (*to, state)));
                }
            }
            if answer != Some(true) {
                steps.push((block + 1, refined(condition, false, state)));
            }
        }
        (OpKind::Statement(gcode_lang::program::Statement::Assignments(_)), _) => {
            for (target, value) in unit.blocks[block].items.iter().filter_map(variables::item_assignment) {
                assign(target, value, &mut after);
            }
            to_all(after);
        }
        (OpKind::Statement(_) | OpKind::AssignDirect(_), Some(Statement::Assign { target, value })) => {
            assign(target, value, &mut after);
            to_all(after);
        }
        (OpKind::If { .. }, _) => {
            // The conditional part may have set any local.
            after.add_bits(ANY_VALUE);
            to_all(after);
        }
        (OpKind::Words(_), _) => {
            // A subprogram uses the locals of its caller.
            if unit.call_in(block).is_some_and(|call| !call.has_own_locals) {
                after.add_bits(ANY_VALUE);
            }
            to_all(after);
        }
        _ => to_all(after),
    }
    if op.skip().is_some() {
        steps.push((block + 1, *state));
    }
}

/// Returns true for a statement that reads commons alone, sets none of the locals and has a condition that may be true or
/// false: [`steps`] leads on with the same states.
pub(super) fn keeps_locals(block: &Block) -> bool {
    let sets_none = |statement: &Statement| match variables::statement_assignment(statement) {
        Some((target, _)) => literal::variable(target).is_some_and(|number| !(1..=33).contains(&number)),
        None => true,
    };
    let [Item::Statement(statement)] = &block.items[..] else { return false };
    match &statement.node {
        Statement::IfGoto { condition, .. }
        | Statement::While { condition, .. }
        | Statement::IfThen { condition, .. } => {
            truth(condition, &Locals::ANYTHING).is_none() && sets_none(&statement.node)
        }
        Statement::Assign { .. } => sets_none(&statement.node),
        _ => false,
    }
}

fn assign(target: &Expr, value: &Expr, state: &mut Locals) {
    let bits = match value_of(value, state) {
        KnownValue::Vacant => VACANT,
        KnownValue::Number(_) | KnownValue::Some => NUMBER,
        KnownValue::Unknown => ANY_VALUE,
    };
    match literal::variable(target) {
        Some(number @ 1..=33) => state.0[number as usize] = bits,
        Some(_) => {}
        // A computed number may be that of any local.
        None => state.add_bits(ANY_VALUE),
    }
}

/// Static knowledge of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum KnownValue {
    Vacant,
    Number(f64),
    /// Unknown number.
    Some,
    Unknown,
}

fn value_of(expr: &Expr, state: &Locals) -> KnownValue {
    match &expr.kind {
        ExprKind::Literal(number) => KnownValue::Number(number.value()),
        ExprKind::Variable(_) | ExprKind::Named(_) => {
            match literal::variable(expr).map(|number| state.bits_of(number)) {
                Some(bits) if bits & NUMBER == 0 => KnownValue::Vacant,
                Some(NUMBER) => KnownValue::Some,
                _ => KnownValue::Unknown,
            }
        }
        ExprKind::Bracket(inner) | ExprKind::Plus(inner) => value_of(inner, state),
        ExprKind::Negate(inner) => match value_of(inner, state) {
            KnownValue::Number(value) => KnownValue::Number(-value),
            // A setting decides whether a minus keeps vacancy.
            _ => KnownValue::Unknown,
        },
        ExprKind::Binary(op, left, right) => {
            let sides = known_number(value_of(left, state)).zip(known_number(value_of(right, state)));
            let value = sides.and_then(|(left, right)| literal::arithmetic(*op, left, right));
            match value {
                Some(value) => KnownValue::Number(value),
                // A product with a vacant factor is 0 for any other factor.
                None if *op == BinaryOp::Mul
                    && [left, right].iter().any(|e| known_number(value_of(e, state)) == Some(0.0)) =>
                {
                    KnownValue::Number(0.0)
                }
                None => KnownValue::Some,
            }
        }
        ExprKind::Call(Function::Abs, CallForm::One(inner)) => match known_number(value_of(inner, state)) {
            Some(value) => KnownValue::Number(value.abs()),
            None => KnownValue::Some,
        },
        ExprKind::Call(..) | ExprKind::Parameter { .. } | ExprKind::AxisNumber(_) => KnownValue::Some,
    }
}

/// Returns the number that a value counts as in arithmetic.
fn known_number(value: KnownValue) -> Option<f64> {
    match value {
        KnownValue::Vacant => Some(0.0),
        KnownValue::Number(value) => Some(value),
        KnownValue::Some | KnownValue::Unknown => None,
    }
}

/// Returns the result of a condition if the state decides it.
pub(crate) fn truth(condition: &Condition, state: &Locals) -> Option<bool> {
    match condition {
        Condition::Compare { left, relation, right, .. } => {
            compare(value_of(left, state), *relation, value_of(right, state))
        }
        Condition::Logic(op, _, left, right) => match (op, truth(left, state), truth(right, state)) {
            (BinaryOp::And, Some(false), _) | (BinaryOp::And, _, Some(false)) => Some(false),
            (BinaryOp::Or, Some(true), _) | (BinaryOp::Or, _, Some(true)) => Some(true),
            (BinaryOp::And | BinaryOp::Or, Some(left), Some(right)) => {
                Some(if *op == BinaryOp::And { left && right } else { left || right })
            }
            _ => None,
        },
        Condition::Bracket(inner) => truth(inner, state),
        Condition::Value { value, .. } => known_number(value_of(value, state)).map(|value| value != 0.0),
    }
}

fn compare(left: KnownValue, relation: Relation, right: KnownValue) -> Option<bool> {
    use KnownValue::{Number, Some as Any, Vacant};
    // EQ and NE distinguish vacant from 0; the other relations do not.
    if matches!(relation, Relation::Eq | Relation::Ne) {
        let equal = match (left, right) {
            (Vacant, Vacant) => true,
            (Vacant, Number(_) | Any) | (Number(_) | Any, Vacant) => false,
            (Number(left), Number(right)) => left == right,
            _ => return None,
        };
        return Some(equal == (relation == Relation::Eq));
    }
    let (left, right) = (known_number(left)?, known_number(right)?);
    Some(match relation {
        Relation::Gt => left > right,
        Relation::Ge => left >= right,
        Relation::Lt => left < right,
        Relation::Le => left <= right,
        Relation::Eq | Relation::Ne => return None,
    })
}

/// Returns true if a condition can only be true with the local set, as `#9 NE #0`.
pub(crate) fn guards(condition: &Condition, local: u32) -> bool {
    let state = Locals([UNSET | ANY_VALUE; 34]);
    refined(condition, true, &state).bits_of(local) & UNSET == 0
}

/// Returns a state restricted to the locals for which a condition has the result `answer`.
fn refined(condition: &Condition, answer: bool, state: &Locals) -> Locals {
    let mut state = *state;
    refine(condition, answer, &mut state);
    state
}

/// Restricts a state to the locals for which a condition has the result `answer`.
fn refine(condition: &Condition, answer: bool, state: &mut Locals) {
    match condition {
        Condition::Compare { left, relation: relation @ (Relation::Eq | Relation::Ne), right, .. } => {
            let tested = match (literal::variable(left), literal::variable(right)) {
                (Some(0 | 3100), Some(number)) | (Some(number), Some(0 | 3100)) => number,
                _ => return,
            };
            let vacant = (*relation == Relation::Eq) == answer;
            if let Some(bits) = state.0.get_mut(tested as usize).filter(|_| tested > 0) {
                let left = *bits & if vacant { UNSET | VACANT } else { NUMBER };
                // An impossible result is not analysed further.
                if left != 0 {
                    *bits = left;
                }
            }
        }
        Condition::Compare { .. } => {}
        Condition::Logic(BinaryOp::And, _, left, right) if answer => {
            refine(left, true, state);
            refine(right, true, state);
        }
        Condition::Logic(BinaryOp::Or, _, left, right) if !answer => {
            refine(left, false, state);
            refine(right, false, state);
        }
        Condition::Logic(..) => {}
        Condition::Bracket(inner) => refine(inner, answer, state),
        // A true value is not vacant.
        Condition::Value { value, .. } => {
            let bits = literal::variable(value).filter(|number| answer && *number > 0);
            if let Some(bits) = bits.and_then(|number| state.0.get_mut(number as usize))
                && *bits & NUMBER != 0
            {
                *bits &= NUMBER;
            }
        }
    }
}
