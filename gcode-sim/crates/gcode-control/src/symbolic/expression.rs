//! Evaluates expressions and conditions to terms, with the alarms of the control.
use super::super::evaluation::RoundingTarget;
use super::super::functions::{binary, compare, locate, power, variable_number};
use super::super::registers::Registers;
use super::super::variables::{Accumulator, Value, VariableClass};
use super::oracle::{Halt, Oracle, Symbolic};
use super::term::{Formula, SymbolicValue, Term, TermOperation, Terms, Test};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{ComputedSource, Instruction, Operand, OperandSource, Operation, Slot, UncommonOp};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Function, Relation};
use gcode_lang::units::{POWERS, round};

/// Evaluation of one expression.
pub(super) struct Evaluation<'a, 'o, T> {
    pub(super) registers: &'a Registers,
    pub(super) oracle: &'a mut Oracle<'o, T>,
    stack: Vec<SymbolicValue>,
}

impl<'a, 'o, T: Terms> Evaluation<'a, 'o, T> {
    pub(super) fn new(registers: &'a Registers, oracle: &'a mut Oracle<'o, T>) -> Self {
        Self { registers, oracle, stack: Vec::new() }
    }

    pub(super) fn operand(&mut self, operand: &Operand) -> Symbolic<SymbolicValue> {
        match operand {
            Operand::Number(number) => Ok(SymbolicValue::Term(Term::Number(*number))),
            Operand::Variable { slot, span } => self.load(*slot, *span),
            Operand::Code(code) => self.run_code(code, RoundingTarget::Increment),
        }
    }

    pub(super) fn load(&mut self, slot: Slot, span: Span) -> Symbolic<SymbolicValue> {
        self.read(slot.number(), span)
    }

    /// Returns true if a condition is true.
    pub(super) fn is_true(&mut self, condition: &[Instruction]) -> Symbolic<bool> {
        let formula = self.condition(condition)?;
        self.oracle.is_true(&formula)
    }

    /// Returns a condition with its comparisons unanswered.
    pub(super) fn condition(&mut self, condition: &[Instruction]) -> Symbolic<Formula> {
        match self.run_code(condition, RoundingTarget::Whole)? {
            SymbolicValue::Truth(formula) => Ok(formula),
            SymbolicValue::Vacant => Ok(Formula::Known(false)),
            SymbolicValue::Term(term) => Ok(Formula::Compare(Relation::Ne, term, Term::Number(0.0))),
        }
    }

    pub(super) fn run_code(
        &mut self,
        code: &[Instruction],
        rounds: RoundingTarget,
    ) -> Symbolic<SymbolicValue> {
        let mut last = SymbolicValue::Vacant;
        for Instruction { operation, span } in code {
            last = match operation {
                Operation::Add(values) => self.binary(BinaryOp::Add, values, last, *span)?,
                Operation::Subtract(values) => self.binary(BinaryOp::Sub, values, last, *span)?,
                Operation::Multiply(values) => self.binary(BinaryOp::Mul, values, last, *span)?,
                Operation::Divide(values) => self.binary(BinaryOp::Div, values, last, *span)?,
                Operation::Compare(relation, values) => self.compare(*relation, values, &last)?,
                Operation::Function(name, argument) => {
                    let argument = self.fetch_term(argument, &last)?;
                    SymbolicValue::Term(self.function(*name, argument, *span)?)
                }
                Operation::Atan2([y, x]) => {
                    let y = self.fetch_term(y, &last)?;
                    let x = self.fetch_term(x, &last)?;
                    SymbolicValue::Term(self.atan(y, x, *span)?)
                }
                Operation::Uncommon(rare) => self.uncommon(rare, last, rounds, *span)?,
            };
        }
        Ok(last)
    }

    fn fetch(&mut self, source: &OperandSource, last: &SymbolicValue) -> Symbolic<SymbolicValue> {
        match source {
            OperandSource::Number(number) => Ok(SymbolicValue::Term(Term::Number(*number))),
            OperandSource::Free(variable) => self.read(u32::from(*variable), Span::default()),
            OperandSource::Computed(ComputedSource::Last) => Ok(last.clone()),
            OperandSource::Computed(ComputedSource::Stacked) => {
                Ok(self.stack.pop().unwrap_or(SymbolicValue::Vacant))
            }
        }
    }

    fn fetch_term(&mut self, source: &OperandSource, last: &SymbolicValue) -> Symbolic<Term> {
        let value = self.fetch(source, last)?;
        self.term(value)
    }

    /// Returns a value as arithmetic takes it.
    fn term(&mut self, value: SymbolicValue) -> Symbolic<Term> {
        match value {
            SymbolicValue::Vacant => Ok(Term::Number(0.0)),
            SymbolicValue::Term(term) => Ok(term),
            SymbolicValue::Truth(formula) => {
                Ok(Term::Number(if self.oracle.is_true(&formula)? { 1.0 } else { 0.0 }))
            }
        }
    }

    fn read(&mut self, number: u32, span: Span) -> Symbolic<SymbolicValue> {
        let registers = self.registers;
        let value = match registers.variables.classify(number) {
            VariableClass::Local(index) | VariableClass::Common(index) => registers.variables.get(index),
            VariableClass::Vacant => Value::Vacant,
            VariableClass::System => return self.read_system(number, span),
        };
        SymbolicValue::of(value).ok_or_else(|| Halt::unfollowed(format!("#{number}")))
    }

    /// Reads a system variable. Nothing that the control computes from a stored node is taken for one.
    fn read_system(&mut self, number: u32, span: Span) -> Symbolic<SymbolicValue> {
        let value = locate(self.registers.read_variable(number), span)?;
        if value.as_number().is_none_or(|value| !value.is_nan()) {
            return SymbolicValue::of(value).ok_or_else(|| Halt::unfollowed(format!("#{number}")));
        }
        let modal = &self.registers.state.modal_words;
        let term = match number {
            5001..=5060 => self.position(number),
            4109 => Term::of(modal.f),
            4119 => Term::of(modal.s),
            _ => None,
        };
        term.map(SymbolicValue::Term).ok_or_else(|| Halt::unfollowed(format!("#{number}")))
    }

    fn binary(
        &mut self,
        op: BinaryOp,
        [left, right]: &[OperandSource; 2],
        last: SymbolicValue,
        span: Span,
    ) -> Symbolic<SymbolicValue> {
        let left = self.fetch_term(left, &last)?;
        let right = self.fetch_term(right, &last)?;
        self.combine(op, left, right, span).map(SymbolicValue::Term)
    }

    /// Computes + − * / and MOD.
    pub(super) fn combine(&mut self, op: BinaryOp, left: Term, right: Term, span: Span) -> Symbolic<Term> {
        if let (Term::Number(left), Term::Number(right)) = (left, right) {
            let undocumented = &self.registers.data.settings.undocumented;
            return Ok(Term::Number(locate(binary(op, left, right, undocumented), span)?));
        }
        let operation = match op {
            BinaryOp::Add => TermOperation::Add,
            BinaryOp::Sub => TermOperation::Subtract,
            BinaryOp::Mul => TermOperation::Multiply,
            BinaryOp::Div => {
                self.check_divisor(right, span)?;
                TermOperation::Divide
            }
            BinaryOp::Mod => {
                let (left, right) = (self.rounded(left)?, self.rounded(right)?);
                self.check_divisor(right, span)?;
                return Ok(self.oracle.terms.node(TermOperation::Remainder, [left, right]));
            }
            BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => return self.bitwise(op, left, right, span),
        };
        let node = self.oracle.terms.node(operation, [left, right]);
        self.check_finite(node, || Alarm::FloatOverflow, span)
    }

    fn check_divisor(&mut self, divisor: Term, span: Span) -> Symbolic<()> {
        if self.oracle.ask(Test::Compare(Relation::Eq, divisor, Term::Number(0.0)))? {
            return Err(Alarm::DivideByZero.located_at(span).into());
        }
        Ok(())
    }

    fn check_finite(&mut self, term: Term, alarm: impl FnOnce() -> Alarm, span: Span) -> Symbolic<Term> {
        if self.oracle.ask(Test::Finite(term))? { Ok(term) } else { Err(alarm().located_at(span).into()) }
    }

    fn compare(
        &mut self,
        relation: Relation,
        [left, right]: &[OperandSource; 2],
        last: &SymbolicValue,
    ) -> Symbolic<SymbolicValue> {
        let left = self.fetch(left, last)?;
        let right = self.fetch(right, last)?;
        let keeps_vacancy = matches!(relation, Relation::Eq | Relation::Ne);
        let known = |left: Value, right: Value| {
            Ok(SymbolicValue::Truth(Formula::Known(compare(relation, left, right))))
        };
        match (&left, &right) {
            (SymbolicValue::Vacant, SymbolicValue::Vacant) => return known(Value::Vacant, Value::Vacant),
            (SymbolicValue::Vacant, _) | (_, SymbolicValue::Vacant) if keeps_vacancy => {
                return known(Value::Vacant, Value::Number(0.0));
            }
            _ => {}
        }
        let (left, right) = (self.term(left)?, self.term(right)?);
        Ok(SymbolicValue::Truth(match (left, right) {
            (Term::Number(left), Term::Number(right)) => Formula::Known(relation.holds(left, right)),
            _ => Formula::Compare(relation, left, right),
        }))
    }

    fn uncommon(
        &mut self,
        operation: &UncommonOp,
        last: SymbolicValue,
        rounds: RoundingTarget,
        span: Span,
    ) -> Symbolic<SymbolicValue> {
        let undocumented = &self.registers.data.settings.undocumented;
        Ok(match *operation {
            UncommonOp::Load(ref source) => match source {
                OperandSource::Free(variable) => self.read(u32::from(*variable), span)?,
                _ => self.fetch(source, &last)?,
            },
            UncommonOp::Push => {
                self.stack.push(last.clone());
                last
            }
            UncommonOp::Read(number) => self.read(number, span)?,
            UncommonOp::LoadIndirect => {
                let number = self.variable_number(last, span)?;
                self.read(number, span)?
            }
            UncommonOp::Negate if last == SymbolicValue::Vacant && undocumented.minus_keeps_vacancy => last,
            UncommonOp::NegateWord if last == SymbolicValue::Vacant => last,
            UncommonOp::Negate | UncommonOp::NegateWord => SymbolicValue::Term(match self.term(last)? {
                Term::Number(number) => Term::Number(-number),
                node @ Term::Node(_) => self.oracle.terms.node(TermOperation::Negate, [node, node]),
            }),
            UncommonOp::Bracket if last == SymbolicValue::Vacant && !undocumented.brackets_keep_vacancy => {
                SymbolicValue::Term(Term::Number(0.0))
            }
            UncommonOp::Bracket => last,
            UncommonOp::Whole(op, ref values) => self.binary(op, values, last, span)?,
            UncommonOp::Power([ref base, ref exponent]) => {
                let base = self.fetch_term(base, &last)?;
                let exponent = self.fetch_term(exponent, &last)?;
                SymbolicValue::Term(self.power(base, exponent, span)?)
            }
            UncommonOp::RoundTo(letter) => {
                let value = self.term(last)?;
                SymbolicValue::Term(self.round_to(letter, value, rounds)?)
            }
            UncommonOp::Logic(op) => {
                let left = self.stack.pop().unwrap_or(SymbolicValue::Vacant);
                let (left, right) = (self.formula(left), self.formula(last));
                SymbolicValue::Truth(Formula::Logic(op, Box::new(left), Box::new(right)))
            }
            UncommonOp::ReadItem { .. }
            | UncommonOp::Parameter { .. }
            | UncommonOp::AxisNumber(_)
            | UncommonOp::AddPoint
            | UncommonOp::NameNumber(_)
            | UncommonOp::SystemNumber(_) => self.concrete(operation, last, rounds, span)?,
        })
    }

    /// Computes an operation whose operands must be known numbers, as the control does.
    fn concrete(
        &mut self,
        operation: &UncommonOp,
        last: SymbolicValue,
        rounds: RoundingTarget,
        span: Span,
    ) -> Symbolic<SymbolicValue> {
        let takes = match operation {
            UncommonOp::Parameter { bit, axis } => usize::from(*bit) + usize::from(*axis),
            _ => 0,
        };
        let known = |value: Option<Value>| {
            let unfollowed = || Halt::unfollowed("an operand of a parameter, a name or an item");
            value.filter(|value| !value.number().is_nan()).ok_or_else(unfollowed)
        };
        if let UncommonOp::ReadItem { number, .. } = operation
            && self.registers.data.settings.has_variable_bits
        {
            let registers = self.registers;
            let read = registers.block_effects.without_effects(|| registers.read_variable(*number));
            if read.is_ok_and(|value| value.number().is_nan()) {
                return Err(Halt::unfollowed(format!("a bit of #{number}")));
            }
        }
        let first = self.stack.len().saturating_sub(takes);
        for value in self.stack.drain(first..) {
            self.registers.operand_stack.push(known(value.stored())?);
        }
        let last = known(last.stored())?;
        let value = locate(self.registers.uncommon_op(operation, Accumulator::from(last), rounds), span)?;
        SymbolicValue::of(value).ok_or_else(|| Halt::unfollowed("an item of a variable"))
    }

    fn formula(&mut self, value: SymbolicValue) -> Formula {
        match value {
            SymbolicValue::Truth(formula) => formula,
            SymbolicValue::Vacant => Formula::Known(false),
            SymbolicValue::Term(Term::Number(number)) => Formula::Known(number != 0.0),
            SymbolicValue::Term(term) => Formula::Compare(Relation::Ne, term, Term::Number(0.0)),
        }
    }

    /// Returns a variable number; each whole number of one that depends on the ranges is a way of its own.
    pub(super) fn variable_number(&mut self, value: SymbolicValue, span: Span) -> Symbolic<u32> {
        let number = match self.term(value)? {
            Term::Number(number) => number,
            node @ Term::Node(_) => self.oracle.pin(node)?,
        };
        Ok(locate(variable_number(Value::Number(number)), span)?)
    }

    pub(super) fn rounded(&mut self, term: Term) -> Symbolic<Term> {
        Ok(match term {
            Term::Number(number) => Term::Number(round(number)),
            node @ Term::Node(_) => {
                self.oracle.terms.node(TermOperation::Function(Function::Round), [node, node])
            }
        })
    }

    fn power(&mut self, base: Term, exponent: Term, span: Span) -> Symbolic<Term> {
        if let (Term::Number(base), Term::Number(exponent)) = (base, exponent) {
            return Ok(Term::Number(locate(power(base, exponent), span)?));
        }
        let zero = Term::Number(0.0);
        if self.oracle.ask(Test::Compare(Relation::Lt, base, zero))? {
            let value = self.oracle.terms.bounds(base).0;
            return Err(Alarm::OutOfRange { function: "POW".into(), value }.located_at(span).into());
        }
        if self.oracle.ask(Test::Compare(Relation::Lt, exponent, zero))?
            && self.oracle.ask(Test::Compare(Relation::Eq, base, zero))?
        {
            return Err(Alarm::DivideByZero.located_at(span).into());
        }
        let node = self.oracle.terms.node(TermOperation::Power, [base, exponent]);
        self.check_finite(node, || Alarm::FloatOverflow, span)
    }

    /// ROUND of an address in a word.
    fn round_to(&mut self, letter: u8, value: Term, rounds: RoundingTarget) -> Symbolic<Term> {
        if let Term::Number(number) = value {
            let number = match rounds {
                RoundingTarget::Whole => round(number),
                RoundingTarget::Increment => self.registers.round_to_address(letter, number),
            };
            return Ok(Term::Number(number));
        }
        match letter {
            _ if rounds == RoundingTarget::Whole => self.rounded(value),
            b'F' => Ok(value),
            b'E' if self.registers.data.settings.axes.find(b'E').is_none() => Ok(value),
            b'A'..=b'C' | b'E' | b'I'..=b'K' | b'Q' | b'R' | b'U'..=b'Z' => {
                let decimals = self.registers.data.decimals(letter, self.registers.state.modal.unit);
                self.oracle.rounded_to_increment(value, POWERS[decimals])
            }
            _ => self.rounded(value),
        }
    }

    /// Computes a function, or its alarm.
    fn function(&mut self, name: Function, x: Term, span: Span) -> Symbolic<Term> {
        if let Term::Number(x) = x {
            let function = super::super::functions::function(name, x, &self.registers.data.settings);
            return Ok(Term::Number(locate(function, span)?));
        }
        self.function_of_node(name, x, span)
    }

    /// Computes ATAN of two values.
    fn atan(&mut self, y: Term, x: Term, span: Span) -> Symbolic<Term> {
        let settings = &self.registers.data.settings;
        if let (Term::Number(y), Term::Number(x)) = (y, x) {
            return Ok(Term::Number(locate(super::super::functions::atan2(y, x, settings), span)?));
        }
        if settings.undocumented.atan_of_zeros_alarms
            && self.oracle.ask(Test::Compare(Relation::Eq, y, Term::Number(0.0)))?
            && self.oracle.ask(Test::Compare(Relation::Eq, x, Term::Number(0.0)))?
        {
            return Ok(Term::Number(locate(super::super::functions::atan2(0.0, 0.0, settings), span)?));
        }
        Ok(self.oracle.terms.node(TermOperation::Direction, [y, x]))
    }
}

impl Registers {
    pub(super) fn is_inch(&self) -> bool {
        self.state.modal.unit == gcode_lang::program::modes::Unit::Inch
    }
}
