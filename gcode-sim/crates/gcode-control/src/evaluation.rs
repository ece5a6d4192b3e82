//! Evaluates expressions and conditions.
use std::hint::cold_path;

use super::functions::{
    ExecResult, angle, atan2, binary, compare, function_alarm, function_value, integer, is_finite, locate,
    power, variable_number,
};
use super::notes::Note;
use super::registers::Registers;
use super::variables::{Accumulator, Value, VariableClass};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::names::NameRow;
use gcode_lang::program::{
    AssignmentTarget, ComputedSource, Instruction, Operand, OperandSource, Operation, Slot, UncommonOp,
};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Function, Relation};
use gcode_lang::units::{POWERS, round, round_scaled};

/// Unit to which ROUND rounds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum RoundingTarget {
    Increment,
    Whole,
}

impl Registers {
    #[inline]
    pub(super) fn operand(&self, operand: &Operand) -> ExecResult<Value> {
        match operand {
            Operand::Number(number) => Ok(Value::Number(*number)),
            Operand::Variable { slot, span } => self.load(*slot, span),
            Operand::Code(code) => self.run_code(code, RoundingTarget::Increment),
        }
    }

    /// Returns true if a condition is true; most conditions are one comparison.
    #[inline]
    pub(super) fn evaluate_condition(&self, condition: &[Instruction]) -> ExecResult<bool> {
        match self.evaluate_comparison(condition) {
            Some(is_true) => Ok(is_true),
            None => self.run_code(condition, RoundingTarget::Whole).map(is_true),
        }
    }

    /// Evaluates a condition of one comparison; `None` for any other.
    #[inline(never)]
    fn evaluate_comparison(&self, condition: &[Instruction]) -> Option<bool> {
        let [Instruction { operation: Operation::Compare(relation, [left, right]), .. }] = condition else {
            return None;
        };
        Some(self.compare(*relation, [left, right], Accumulator::VACANT))
    }

    /// Compares two values. Only = and ≠ distinguish vacant from 0.
    #[inline(always)]
    fn compare(&self, relation: Relation, [left, right]: [&OperandSource; 2], last: Accumulator) -> bool {
        if matches!(relation, Relation::Eq | Relation::Ne) {
            let left = self.fetch(left, last);
            return compare(relation, left, self.fetch(right, last));
        }
        let left = self.fetch_number(left, last);
        relation.holds(left, self.fetch_number(right, last))
    }

    /// Returns the value of an operand; `last` is the result of the preceding instruction.
    #[inline(always)]
    fn fetch(&self, source: &OperandSource, last: Accumulator) -> Value {
        match source {
            OperandSource::Number(number) => Value::Number(*number),
            OperandSource::Free(variable) => self.variables.get_free(*variable),
            OperandSource::Computed(ComputedSource::Last) => last.into(),
            OperandSource::Computed(ComputedSource::Stacked) => self.operand_stack.pop(),
        }
    }

    /// Returns the number of an operand, 0 for a vacant value.
    #[inline(always)]
    fn fetch_number(&self, source: &OperandSource, last: Accumulator) -> f64 {
        match source {
            OperandSource::Free(variable) => self.variables.free_number(*variable),
            OperandSource::Number(number) => *number,
            OperandSource::Computed(ComputedSource::Last) => last.number,
            OperandSource::Computed(ComputedSource::Stacked) => self.operand_stack.pop().number(),
        }
    }

    /// Returns the value of a variable, or its alarm located.
    #[inline(always)]
    pub(super) fn load(&self, slot: Slot, span: &Span) -> ExecResult<Value> {
        match slot {
            Slot::Free(variable) => Ok(self.variables.get_free(variable)),
            Slot::Other(number) => locate(self.read_variable(number), *span),
        }
    }

    pub(super) fn read_variable(&self, number: u32) -> Result<Value, Alarm> {
        match self.variables.classify(number) {
            VariableClass::Local(index) | VariableClass::Common(index) => Ok(self.variables.get(index)),
            VariableClass::Vacant => Ok(Value::Vacant),
            VariableClass::System => self.read_system(number),
        }
    }

    /// Evaluates code; ROUND rounds to the increment of the address in a word, to whole numbers in statements and arguments.
    #[inline(never)]
    pub(super) fn run_code(&self, code: &[Instruction], rounds: RoundingTarget) -> ExecResult<Value> {
        self.evaluate(code, rounds).map(Value::from)
    }

    /// Evaluates as [`Registers::run_code`], inlined into the loop over the blocks: most expressions are assigned.
    #[inline(always)]
    pub(super) fn evaluate(&self, code: &[Instruction], rounds: RoundingTarget) -> ExecResult<Accumulator> {
        let mut last = Accumulator::VACANT;
        for Instruction { operation, span } in code {
            last = Accumulator::of(match operation {
                Operation::Add(values) => self.binary(BinaryOp::Add, values, last, span)?,
                Operation::Subtract(values) => self.binary(BinaryOp::Sub, values, last, span)?,
                Operation::Multiply(values) => self.binary(BinaryOp::Mul, values, last, span)?,
                Operation::Divide(values) => self.binary(BinaryOp::Div, values, last, span)?,
                Operation::Compare(relation, [left, right]) => {
                    truth(self.compare(*relation, [left, right], last))
                }
                Operation::Function(name, argument) => match (name, self.fetch_number(argument, last)) {
                    // One instruction, without a call.
                    (Function::Sqrt, argument) if argument >= 0.0 => argument.sqrt(),
                    (Function::Tan, argument) => self.tangent(argument, span)?,
                    (name, argument) => self.evaluate_function(*name, argument, span)?,
                },
                Operation::Atan2([y, x]) => {
                    let y = self.fetch_number(y, last);
                    self.atan(y, self.fetch_number(x, last), span)?
                }
                Operation::Uncommon(rare) => {
                    last = locate(self.uncommon_op(rare, last, rounds), *span)?.into();
                    continue;
                }
            });
        }
        Ok(last)
    }

    /// Computes + − * /; without a finite result it computes again for the alarm.
    #[inline(always)]
    fn binary(
        &self,
        op: BinaryOp,
        [left, right]: &[OperandSource; 2],
        last: Accumulator,
        span: &Span,
    ) -> ExecResult<f64> {
        let left = self.fetch_number(left, last);
        let right = self.fetch_number(right, last);
        let value = match op {
            BinaryOp::Add => left + right,
            BinaryOp::Sub => left - right,
            BinaryOp::Mul => left * right,
            _ => left / right,
        };
        if !is_finite(value) {
            return locate(binary(op, left, right, &self.data.settings.undocumented), *span);
        }
        Ok(value)
    }

    /// Computes a function, or its alarm.
    #[inline(always)]
    fn evaluate_function(&self, name: Function, argument: f64, span: &Span) -> ExecResult<f64> {
        let value = function_value(name, argument, &self.data.settings);
        if !is_finite(value) {
            return Err(function_alarm(name, argument).located_at(*span));
        }
        Ok(value)
    }

    /// Computes TAN; that of 90° has a note or an alarm.
    #[inline(never)]
    fn tangent(&self, argument: f64, span: &Span) -> ExecResult<f64> {
        let value = self.evaluate_function(Function::Tan, argument, span)?;
        if (argument % 180.0).abs() == 90.0 {
            self.block_effects.record_note(Note::TangentOf90);
        }
        Ok(value)
    }

    /// Computes ATAN of two values; that of two zeros has a note or an alarm.
    #[inline(always)]
    fn atan(&self, y: f64, x: f64, span: &Span) -> ExecResult<f64> {
        if y == 0.0 && x == 0.0 {
            cold_path();
            let angle = locate(atan2(y, x, &self.data.settings), *span)?;
            self.block_effects.record_note(Note::AtanOf0);
            return Ok(angle);
        }
        Ok(angle(y, x, &self.data.settings))
    }

    /// Evaluates an instruction that few expressions have, out of line so that the others don't save registers for it.
    #[inline(never)]
    pub(super) fn uncommon_op(
        &self,
        operation: &UncommonOp,
        before: Accumulator,
        rounds: RoundingTarget,
    ) -> Result<Value, Alarm> {
        let (last, undocumented) = (Value::from(before), &self.data.settings.undocumented);
        Ok(match *operation {
            UncommonOp::Load(ref source) => self.fetch(source, before),
            UncommonOp::Push => {
                self.operand_stack.push(last);
                last
            }
            UncommonOp::Read(number) => self.read_variable(number)?,
            UncommonOp::ReadItem { number, item, .. } if self.data.settings.has_variable_bits => {
                self.read_item(number, item)?
            }
            UncommonOp::ReadItem { rounded, .. } => self.read_variable(rounded)?,
            UncommonOp::LoadIndirect => self.read_variable(variable_number(last)?)?,
            UncommonOp::Negate => match last {
                Value::Vacant if undocumented.minus_keeps_vacancy => Value::Vacant,
                value => Value::Number(-value.number()),
            },
            UncommonOp::NegateWord => last.as_number().map_or(Value::Vacant, |number| Value::Number(-number)),
            UncommonOp::Bracket => match last {
                Value::Vacant if !undocumented.brackets_keep_vacancy => Value::Number(0.0),
                value => value,
            },
            UncommonOp::Whole(op, [ref left, ref right]) => {
                let left = self.fetch_number(left, before);
                Value::Number(binary(op, left, self.fetch_number(right, before), undocumented)?)
            }
            UncommonOp::Power([ref base, ref exponent]) => {
                let base = self.fetch_number(base, before);
                Value::Number(power(base, self.fetch_number(exponent, before))?)
            }
            UncommonOp::RoundTo(_) if rounds == RoundingTarget::Whole => Value::Number(round(last.number())),
            UncommonOp::RoundTo(letter) => Value::Number(self.round_to_address(letter, last.number())),
            UncommonOp::Logic(op) => Value::Number(truth(self.combine_conditions(op, last))),
            UncommonOp::Parameter { bit, axis } => Value::Number(self.parameter(bit, axis, last)?),
            UncommonOp::AxisNumber(letter) => {
                let axis = self.data.settings.axes.find(letter);
                let unknown = || Alarm::AxisAddress { text: char::from(letter).into() };
                Value::Number(axis.ok_or_else(unknown)? as f64 + 1.0)
            }
            UncommonOp::AddPoint => match self.variables.classify(variable_number(last)?) {
                VariableClass::Local(local) => Value::Number(self.variables.value_with_point(local)),
                VariableClass::Vacant | VariableClass::Common(_) | VariableClass::System => {
                    return Err(Alarm::ArgumentFormat { function: "ADP".into() });
                }
            },
            UncommonOp::NameNumber(ref name) => {
                Value::Number(f64::from(self.variables.named_variable(name)?))
            }
            UncommonOp::SystemNumber(row) => Value::Number(f64::from(self.system_number(&row, last)?)),
        })
    }

    /// Combines the condition on the stack with the last result.
    fn combine_conditions(&self, op: BinaryOp, last: Value) -> bool {
        let (left, right) = (is_true(self.operand_stack.pop()), is_true(last));
        match op {
            BinaryOp::And => left && right,
            BinaryOp::Xor => left != right,
            _ => left || right,
        }
    }

    /// Reads a parameter: the last of its number, bit and axis is the last result, the others are on the stack.
    fn parameter(&self, has_bit: bool, has_axis: bool, last: Value) -> Result<f64, Alarm> {
        let mut part = last;
        let mut take = |is_there: bool| {
            is_there.then(|| std::mem::replace(&mut part, self.operand_stack.pop()).number())
        };
        let (axis, bit) = (take(has_axis), take(has_bit));
        let stated = self.data.read_parameter(part.number(), bit, axis)?;
        Ok(stated.unwrap_or_else(|number| {
            self.block_effects.record_note(Note::ParameterUnknown(number));
            0.0
        }))
    }

    /// Returns the number of a named system variable with its suffix.
    fn system_number(&self, row: &NameRow, suffix: Value) -> Result<u32, Alarm> {
        let number = if self.data.settings.series_15_offsets { row.series_15 } else { row.number };
        let Some((from, to)) = row.suffix else { return Ok(number) };
        let suffix = integer(suffix.number())?;
        if !(i64::from(from)..=i64::from(to)).contains(&suffix) {
            return Err(Alarm::Suffix { name: row.name.into() });
        }
        Ok(number + suffix as u32 - from)
    }
}

/// Returns the number of a condition, 1 or 0.
fn truth(is_true: bool) -> f64 {
    f64::from(u8::from(is_true))
}

/// Returns true if an evaluated condition is true.
#[inline]
fn is_true(condition: Value) -> bool {
    condition.number() != 0.0
}

impl Registers {
    /// Rounds to the increment of an address: ROUND in a word.
    pub(super) fn round_to_address(&self, letter: u8, value: f64) -> f64 {
        let has_e_axis = || self.data.settings.axes.find(b'E').is_some();
        match letter {
            b'F' => value,
            b'E' if !has_e_axis() => value,
            b'A'..=b'C' | b'E' | b'I'..=b'K' | b'Q' | b'R' | b'U'..=b'Z' => {
                let scale = POWERS[self.data.decimals(letter, self.state.modal.unit)];
                round_scaled(value, scale) / scale
            }
            _ => value.round(),
        }
    }

    /// Returns the variable that an assignment writes.
    pub(super) fn resolve_target(&self, target: &AssignmentTarget) -> Result<Slot, Alarm> {
        match target {
            AssignmentTarget::Slot(slot) => Ok(*slot),
            AssignmentTarget::Computed(number) => {
                let value = self.operand(number).map_err(|alarm| alarm.node)?;
                variable_number(value).map(Slot::of)
            }
        }
    }
}
