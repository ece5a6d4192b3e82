//! Which locals are vacant where: every block's state from the ways that lead to it, conditions on vacancy followed.
//!
//! A state says of each local what it may be: never set, set to `#0` on purpose, or a number. Where ways meet, it may
//! be what it is on either. A condition whose answer follows from the state (`#24 EQ #0` of a local that was never
//! set) is followed one way only.
use gcode_lang::program::{OpIndex, OpKind};
use gcode_lang::syntax::ast::{BinaryOp, CallForm, Condition, Expr, ExprKind, Function, Relation, Statement};

use super::context::ProgramUnit;
use super::{literal, variables};

/// What a local may be, as bits.
pub(crate) const UNSET: u8 = 1;
pub(crate) const VACANT: u8 = 2;
pub(crate) const NUMBER: u8 = 4;
pub(crate) const ANY_VALUE: u8 = VACANT | NUMBER;

/// The locals #1 to #33; place 0 is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Locals(pub [u8; 34]);

impl Locals {
    pub(crate) const UNSET: Self = Self([UNSET; 34]);
    pub(crate) const ANYTHING: Self = Self([ANY_VALUE; 34]);

    pub(super) fn bits_of(&self, number: u32) -> u8 {
        match number {
            // [#_EMPTY] is #3100.
            0 | 3100 => VACANT,
            1..=33 => self.0[number as usize],
            _ => ANY_VALUE,
        }
    }

    fn join(&mut self, other: &Self) -> bool {
        let before = *self;
        self.0.iter_mut().zip(other.0).for_each(|(mine, others)| *mine |= others);
        *self != before
    }

    fn add_bits(&mut self, bits: u8) {
        self.0.iter_mut().for_each(|local| *local |= bits);
    }
}

/// The state at each place of the ways; `None` where nothing leads.
pub(crate) type States = Vec<Option<Locals>>;

/// Follows a program from its first block with what its locals are there.
pub(crate) fn states(unit: &ProgramUnit<'_>, entry: Locals) -> States {
    let mut states: States = vec![None; unit.flow.block_count()];
    let mut open = unit.entry_blocks.clone();
    // A call that starts elsewhere brings its own locals.
    for (place, start) in unit.entry_blocks.iter().enumerate() {
        states[*start] = Some(if place == 0 { entry } else { Locals::ANYTHING });
    }
    while let Some(block) = open.pop() {
        let Some(Some(state)) = states.get(block).copied() else { continue };
        for (to, state) in steps(unit, block, &state) {
            let Some(known) = states.get_mut(to) else { continue };
            let changed = match known {
                Some(known) => known.join(&state),
                None => {
                    *known = Some(state);
                    true
                }
            };
            if changed {
                open.push(to);
            }
        }
    }
    states
}

/// Where a place leads and with which state.
pub(super) fn steps(unit: &ProgramUnit<'_>, block: OpIndex, state: &Locals) -> Vec<(OpIndex, Locals)> {
    let to = || unit.flow.successors(block);
    let to_all = |state: Locals| to().map(|to| (to, state)).collect::<Vec<_>>();
    let Some(op) = unit.program.ops().get(block) else { return to_all(*state) };
    let mut after = *state;
    let statement = variables::statement(&unit.blocks, block);
    let mut steps = match (op.kind(), statement) {
        (
            OpKind::Statement(_),
            Some(Statement::IfGoto { condition, .. } | Statement::While { condition, .. }),
        ) => {
            let on_true = truth(condition, state);
            let is_jump = matches!(statement, Some(Statement::IfGoto { .. }));
            let split = |to: OpIndex| {
                // IF jumps when it is true, WHILE when it is not.
                let taken = (to == block + 1) != is_jump;
                let sure = to != block + 1 || !unit.flow.block_successors[block].jumps.contains(&to);
                if sure && on_true == Some(!taken) {
                    return None;
                }
                let mut state = *state;
                refine(condition, taken, &mut state);
                Some((to, state))
            };
            to().filter_map(split).collect()
        }
        (OpKind::Statement(_), Some(Statement::IfThen { condition, then })) => {
            let mut when_true = *state;
            refine(condition, true, &mut when_true);
            let mut when_false = *state;
            refine(condition, false, &mut when_false);
            let answer = truth(condition, state);
            let mut steps = Vec::new();
            if answer != Some(false) {
                match variables::statement_assignment(then) {
                    Some((target, value)) => assign(target, value, &mut when_true),
                    None => steps
                        .extend(unit.flow.block_successors[block].jumps.iter().map(|to| (*to, when_true))),
                }
                if !super::control_flow::raises_alarm(op.kind())
                    && variables::statement_assignment(then).is_some()
                {
                    steps.push((block + 1, when_true));
                }
            }
            if answer != Some(true) {
                steps.push((block + 1, when_false));
            }
            steps
        }
        (OpKind::Statement(gcode_lang::program::Statement::Assignments(_)), _) => {
            for (target, value) in unit.blocks[block].items.iter().filter_map(variables::item_assignment) {
                assign(target, value, &mut after);
            }
            to_all(after)
        }
        (OpKind::Statement(_) | OpKind::AssignFree(_), Some(Statement::Assign { target, value })) => {
            assign(target, value, &mut after);
            to_all(after)
        }
        (OpKind::If { .. }, _) => {
            // What stands behind the condition may have written any of them, or none.
            after.add_bits(ANY_VALUE);
            to_all(after)
        }
        (OpKind::Words(_), _) => {
            // A subprogram works on the same locals.
            if unit.call_in(block).is_some_and(|call| !call.has_own_locals) {
                after.add_bits(ANY_VALUE);
            }
            to_all(after)
        }
        _ => to_all(after),
    };
    if op.skip().is_some() {
        steps.push((block + 1, *state));
    }
    steps
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
        // Any local could be meant.
        None => state.add_bits(ANY_VALUE),
    }
}

/// What is known of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum KnownValue {
    Vacant,
    Number(f64),
    /// A number, but not which.
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
            // Whether a minus keeps vacancy is a setting.
            _ => KnownValue::Unknown,
        },
        ExprKind::Binary(op, left, right) => {
            let sides = known_number(value_of(left, state)).zip(known_number(value_of(right, state)));
            let value = sides.and_then(|(left, right)| literal::arithmetic(*op, left, right));
            match value {
                Some(value) => KnownValue::Number(value),
                // A product with a vacant factor is 0 whatever the other one is.
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

/// The number a value counts as where it is reckoned with.
fn known_number(value: KnownValue) -> Option<f64> {
    match value {
        KnownValue::Vacant => Some(0.0),
        KnownValue::Number(value) => Some(value),
        KnownValue::Some | KnownValue::Unknown => None,
    }
}

/// The answer of a condition, where it follows from the state.
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
    }
}

fn compare(left: KnownValue, relation: Relation, right: KnownValue) -> Option<bool> {
    use KnownValue::{Number, Some as Any, Vacant};
    // EQ and NE tell vacant from 0, the others don't.
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

/// Whether a condition is only true where something has set the local, as `#9 NE #0` is.
pub(crate) fn guards(condition: &Condition, local: u32) -> bool {
    let mut state = Locals([UNSET | ANY_VALUE; 34]);
    refine(condition, true, &mut state);
    state.bits_of(local) & UNSET == 0
}

/// What a condition tells where it is known to be `answer`.
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
                // A way that can't be gone is not looked at any closer.
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
    }
}
