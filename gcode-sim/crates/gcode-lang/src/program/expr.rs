//! Expressions lowered to postfix code.
use super::DialectSyntax;
use super::code::{
    Bytecode, Computed, Instruction, Operand, OperandSource, Operation, STACK, Slot, Target, UncommonOp,
};
use super::lower::Lowering;
use super::names::{self, OTHER_MEMORIES};
use crate::alarm::{Alarm, LocatedAlarm};
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, CallForm, Condition, Expr, ExprKind, Function, Name, OperatorSpelling};

/// How deep brackets may stand in one another (operator's manual, custom macro: five levels).
pub(super) const BRACKETS: usize = 5;

const LAST: OperandSource = OperandSource::Computed(Computed::Last);
const WAITING: OperandSource = OperandSource::Computed(Computed::Waiting);

/// Beyond it no number is a variable's.
const MOST_WRITTEN: f64 = 999_999_999.0;

/// What an expression stands in.
#[derive(Clone, Copy)]
pub(super) enum Context {
    Macro,
    /// The value of an address.
    Address(u8),
}

type Lowered<T> = Result<T, LocatedAlarm>;

impl Lowering {
    pub(super) fn operand(&mut self, expr: &Expr, context: Context) -> Lowered<Operand> {
        match &expr.kind {
            ExprKind::Literal(number) => return Ok(Operand::Number(number.value())),
            ExprKind::Variable(index) => {
                if let Some(number) = self.literal_index(index) {
                    return Ok(Operand::Variable { slot: Slot::of(number), span: expr.span });
                }
            }
            _ => {}
        }
        self.code(expr.span, |this| this.expr(expr, context, 0)).map(Operand::Code)
    }

    /// The value of a word, whose own sign is no part of an expression.
    pub(super) fn word_value(&mut self, expr: &Expr, letter: u8) -> Lowered<Operand> {
        let context = Context::Address(letter);
        let ExprKind::Negate(inner) = &expr.kind else { return self.operand(expr, context) };
        let write = |this: &mut Self| this.unary(inner, UncommonOp::Reverse, expr.span, context, 0);
        self.code(expr.span, write).map(Operand::Code)
    }

    pub(super) fn condition(&mut self, condition: &Condition, span: Span) -> Lowered<Bytecode> {
        self.code(span, |this| this.test(condition))
    }

    fn code(&mut self, span: Span, write: impl FnOnce(&mut Self) -> Lowered<usize>) -> Lowered<Bytecode> {
        self.instructions.clear();
        let depth = write(self)?;
        if depth > STACK {
            Err(Alarm::TooManyBrackets.at(span))
        } else {
            Ok(self.instructions.drain(..).collect())
        }
    }

    fn emit(&mut self, operation: impl Into<Operation>, span: Span) {
        self.instructions.push(Instruction { operation: operation.into(), span });
    }

    /// Writes the code of `expr`; the answer is how many values it needs on the stack at once.
    fn expr(&mut self, expr: &Expr, context: Context, brackets: usize) -> Lowered<usize> {
        let (source, depth) = self.source(expr, context, brackets)?;
        if source != LAST {
            self.emit(UncommonOp::Load(source), expr.span);
        }
        Ok(depth)
    }

    /// Where an operator finds the value of `expr`, and how many places on the stack it needs at once. Only what has
    /// to be computed gets code, and what may alarm, so that the first alarm stays the first.
    fn source(&mut self, expr: &Expr, context: Context, brackets: usize) -> Lowered<(OperandSource, usize)> {
        if brackets > BRACKETS {
            return Err(Alarm::TooManyBrackets.at(expr.span));
        }
        match &expr.kind {
            ExprKind::Literal(number) => return Ok((OperandSource::Number(number.value()), 1)),
            ExprKind::Variable(index) => {
                if let Some(number) = self.literal_index(index) {
                    let source = match Slot::of(number) {
                        Slot::Free(number) => OperandSource::Free(number),
                        Slot::Other(number) => {
                            self.emit(UncommonOp::Read(number), expr.span);
                            LAST
                        }
                    };
                    return Ok((source, 1));
                }
                let depth = self.expr(index, Context::Macro, brackets)?;
                self.emit(UncommonOp::LoadIndirect, expr.span);
                return Ok((LAST, depth));
            }
            _ => {}
        }
        self.computed(expr, context, brackets).map(|depth| (LAST, depth))
    }

    /// The sources of an operator's two values. The second may have to wait for the first.
    fn sources(
        &mut self,
        [left, right]: [&Expr; 2],
        context: Context,
        brackets: usize,
    ) -> Lowered<([OperandSource; 2], usize)> {
        let (mut left_source, left_depth) = self.source(left, context, brackets)?;
        let behind_left = self.instructions.len();
        let (right_source, right_depth) = self.source(right, context, brackets)?;
        if (left_source, right_source) == (LAST, LAST) {
            left_source = WAITING;
            let wait = Instruction { operation: UncommonOp::Wait.into(), span: left.span };
            self.instructions.insert(behind_left, wait);
        }
        Ok(([left_source, right_source], left_depth.max(right_depth + 1)))
    }

    /// Writes the code of what is no number and no variable.
    fn computed(&mut self, expr: &Expr, context: Context, brackets: usize) -> Lowered<usize> {
        let span = expr.span;
        Ok(match &expr.kind {
            ExprKind::Literal(_) | ExprKind::Variable(_) => self.expr(expr, context, brackets)?,
            ExprKind::Named(name) => {
                let depth = self.named(name, span, brackets)?;
                self.emit(UncommonOp::LoadIndirect, span);
                depth
            }
            ExprKind::Negate(inner) => self.unary(inner, UncommonOp::Negate, span, context, brackets)?,
            ExprKind::Plus(inner) => self.unary(inner, UncommonOp::Plus, span, context, brackets)?,
            ExprKind::Bracket(inner) => {
                self.unary(inner, UncommonOp::Bracket, span, context, brackets + 1)?
            }
            ExprKind::Binary(op, left, right) => {
                if *op == BinaryOp::Mod {
                    self.note(DialectSyntax::NewFunction("MOD"), span);
                }
                let (values, depth) = self.sources([left, right], context, brackets)?;
                self.emit(Operation::binary(*op, values), span);
                depth
            }
            ExprKind::Call(function, form) => self.call(*function, form, span, context, brackets + 1)?,
            ExprKind::Parameter { number, bit, axis } => {
                self.note(DialectSyntax::NewWord("PRM"), span);
                let mut depth = self.expr(number, Context::Macro, brackets + 1)?;
                for (place, part) in bit.iter().chain(axis).enumerate() {
                    self.emit(UncommonOp::Wait, span);
                    depth = depth.max(self.expr(part, Context::Macro, brackets + 1)? + place + 1);
                }
                self.emit(UncommonOp::Parameter { bit: bit.is_some(), axis: axis.is_some() }, span);
                depth
            }
            ExprKind::AxisNumber(letter) => {
                self.note(DialectSyntax::NewWord("AXNUM"), span);
                self.emit(UncommonOp::AxisNumber(*letter), span);
                1
            }
        })
    }

    fn unary(
        &mut self,
        inner: &Expr,
        operation: UncommonOp,
        span: Span,
        context: Context,
        brackets: usize,
    ) -> Lowered<usize> {
        let depth = self.expr(inner, context, brackets)?;
        self.emit(operation, span);
        Ok(depth)
    }

    fn call(
        &mut self,
        function: Function,
        form: &CallForm,
        span: Span,
        context: Context,
        brackets: usize,
    ) -> Lowered<usize> {
        let two = |this: &mut Self, a: &Expr, b: &Expr, operation: fn([OperandSource; 2]) -> Operation| {
            let (values, depth) = this.sources([a, b], context, brackets)?;
            this.emit(operation(values), span);
            Ok(depth)
        };
        let new = match (function, form) {
            (Function::Pow, _) => Some("POW"),
            (Function::Atan, CallForm::Comma(..)) => Some("ATAN[a,b]"),
            _ => None,
        };
        if let Some(name) = new {
            self.note(DialectSyntax::NewFunction(name), span);
        }
        if let Some(name) = new.or(rare(function)) {
            self.note(DialectSyntax::MoreFunction(name), span);
        }
        match (function, form, context) {
            (Function::Atan, CallForm::Slash(a, b) | CallForm::Comma(a, b), _) => {
                two(self, a, b, Operation::Atan2)
            }
            (Function::Pow, CallForm::Comma(a, b), _) => {
                two(self, a, b, |values| UncommonOp::Power(values).into())
            }
            (Function::Pow, CallForm::One(_), _) => Err(Alarm::MissingComma.at(span)),
            (Function::Round, CallForm::One(inner), Context::Address(letter)) => {
                self.unary(inner, UncommonOp::RoundTo(letter), span, context, brackets)
            }
            (Function::Adp, CallForm::One(inner), _) => {
                let ExprKind::Variable(index) = &inner.kind else {
                    return Err(Alarm::ArgumentFormat { function: "ADP".into() }.at(span));
                };
                self.unary(index, UncommonOp::AddPoint, span, Context::Macro, brackets)
            }
            (_, CallForm::One(inner), _) => {
                let (value, depth) = self.source(inner, context, brackets)?;
                self.emit(Operation::Function(function, value), span);
                Ok(depth)
            }
            (_, CallForm::Slash(..) | CallForm::Comma(..), _) => {
                Err(Alarm::ArgumentFormat { function: format!("{function:?}").to_uppercase() }.at(span))
            }
        }
    }

    /// The variable that an assignment writes.
    pub(super) fn target(&mut self, target: &Expr) -> Lowered<Target> {
        match &target.kind {
            ExprKind::Variable(index) => match self.operand(index, Context::Macro)? {
                // The nearest whole number, as of any index.
                Operand::Number(number) if (0.0..=MOST_WRITTEN).contains(&number.round()) => {
                    Ok(Target::Slot(Slot::of(number.round() as u32)))
                }
                operand => Ok(Target::Computed(operand)),
            },
            ExprKind::Named(name) => {
                let code = self.code(target.span, |this| this.named(name, target.span, 0))?;
                Ok(Target::Computed(Operand::Code(code)))
            }
            _ => Err(Alarm::Expression { text: String::new() }.at(target.span)),
        }
    }

    /// The number of a named variable.
    fn named(&mut self, name: &Name, span: Span, brackets: usize) -> Lowered<usize> {
        let text = || name.text.clone();
        self.note(DialectSyntax::NewWord("[#NAME]"), span);
        if !name.text.starts_with('_') {
            if name.index.is_some() {
                return Err(Alarm::Suffix { name: text() }.at(span));
            }
            self.emit(UncommonOp::NameNumber(name.text.as_str().into()), span);
            return Ok(1);
        }
        if OTHER_MEMORIES.contains(&name.text.as_str()) {
            return Err(Alarm::VariableName { name: text() }.at(span));
        }
        let row = names::find(&name.text).ok_or_else(|| Alarm::NoVariableName { name: text() }.at(span))?;
        let depth = match (&name.index, row.suffix) {
            (Some(index), Some(_)) => self.expr(index, Context::Macro, brackets + 2)?,
            (None, None) => 1,
            _ => return Err(Alarm::Suffix { name: text() }.at(span)),
        };
        self.emit(UncommonOp::SystemNumber(row), span);
        Ok(depth)
    }

    /// `#5`: a variable whose number is written out. `#5.4` is #5, as any number used as an integer, unless the control
    /// means a bit by it.
    fn literal_index(&mut self, index: &Expr) -> Option<u32> {
        let ExprKind::Literal(number) = index.kind else { return None };
        let value = number.value();
        if value.fract() != 0.0 {
            self.note(DialectSyntax::Fraction, index.span);
        }
        let value = value.round();
        (0.0..=MOST_WRITTEN).contains(&value).then_some(value as u32)
    }

    fn test(&mut self, condition: &Condition) -> Lowered<usize> {
        match condition {
            Condition::Compare { left, relation, written, right, span } => {
                if *written == OperatorSpelling::Sign {
                    self.note(DialectSyntax::Signs, *span);
                }
                let (values, depth) = self.sources([left, right], Context::Macro, 1)?;
                self.emit(Operation::Compare(*relation, values), *span);
                Ok(depth)
            }
            Condition::Logic(op, written, first, second) => {
                let left = self.test(first)?;
                let span = self.instructions.last().map_or_else(Span::default, |i| i.span);
                self.emit(UncommonOp::Wait, span);
                let right = self.test(second)?;
                let span = self.instructions.last().map_or_else(Span::default, |i| i.span);
                if *written == OperatorSpelling::Sign {
                    self.note(DialectSyntax::Signs, span);
                }
                self.emit(UncommonOp::Logic(*op), span);
                Ok(left.max(right + 1))
            }
            Condition::Bracket(inner) => self.test(inner),
        }
    }
}

/// Functions that controls with few of them lack.
fn rare(function: Function) -> Option<&'static str> {
    Some(match function {
        Function::Fup => "FUP",
        Function::Ln => "LN",
        Function::Exp => "EXP",
        Function::Bin => "BIN",
        Function::Bcd => "BCD",
        Function::Adp => "ADP",
        _ => return None,
    })
}
