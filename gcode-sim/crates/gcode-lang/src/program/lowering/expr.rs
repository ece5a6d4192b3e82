//! Lowering of expressions to bytecode.
use super::{Lowering, LoweringResult};
use crate::alarm::Alarm;
use crate::program::DialectSyntax;
use crate::program::bytecode::{
    AssignmentTarget, Bytecode, ComputedSource, Instruction, Operand, OperandSource, Operation, STACK, Slot,
    UncommonOp,
};
use crate::program::names::{self, OTHER_MEMORIES};
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, CallForm, Condition, Expr, ExprKind, Function, Name, OperatorSpelling};

/// Deepest nesting of brackets (operator's manual, custom macro: five levels).
pub(in crate::program) const MAX_BRACKETS: usize = 5;

const LAST: OperandSource = OperandSource::Computed(ComputedSource::Last);
const STACKED: OperandSource = OperandSource::Computed(ComputedSource::Stacked);

/// Largest number of a variable.
const MAX_VARIABLE_NUMBER: f64 = 999_999_999.0;

/// Context of an expression.
#[derive(Clone, Copy)]
pub(in crate::program) struct ExprContext {
    /// Address whose value the expression is; `None` in a macro statement.
    address: Option<u8>,
    /// Number of brackets around the expression.
    brackets: usize,
}

impl ExprContext {
    pub(in crate::program) const MACRO: Self = Self { address: None, brackets: 0 };

    /// The context of an expression in further brackets.
    fn inside(self, brackets: usize) -> Self {
        Self { brackets: self.brackets + brackets, ..self }
    }

    /// The context of an index or argument that is no part of the value.
    fn of_macro(self) -> Self {
        Self { address: None, ..self }
    }
}

impl Lowering {
    pub(in crate::program) fn operand(
        &mut self,
        expr: &Expr,
        context: ExprContext,
    ) -> LoweringResult<Operand> {
        match &expr.kind {
            ExprKind::Literal(number) => return Ok(Operand::Number(number.value())),
            ExprKind::Variable(index) => {
                if let Some(number) = literal_index(index) {
                    return Ok(Operand::Variable { slot: Slot::of(number), span: expr.span });
                }
            }
            _ => {}
        }
        self.compile(expr.span, |this| this.compile_expr(expr, context)).map(Operand::Code)
    }

    /// Lowers the value of a word; its own sign is not part of the expression.
    pub(in crate::program) fn word_value(&mut self, expr: &Expr, letter: u8) -> LoweringResult<Operand> {
        let context = ExprContext { address: Some(letter), ..ExprContext::MACRO };
        let ExprKind::Negate(inner) = &expr.kind else { return self.operand(expr, context) };
        let write = |this: &mut Self| this.compile_unary(inner, UncommonOp::NegateWord, expr.span, context);
        self.compile(expr.span, write).map(Operand::Code)
    }

    pub(in crate::program) fn condition(
        &mut self,
        condition: &Condition,
        span: Span,
    ) -> LoweringResult<Bytecode> {
        self.compile(span, |this| this.compile_condition(condition))
    }

    fn compile(
        &mut self,
        span: Span,
        write: impl FnOnce(&mut Self) -> LoweringResult<usize>,
    ) -> LoweringResult<Bytecode> {
        self.instructions.clear();
        let depth = write(self)?;
        if depth > STACK {
            Err(Alarm::TooManyBrackets.located_at(span))
        } else {
            Ok(self.instructions.drain(..).collect())
        }
    }

    fn emit(&mut self, operation: impl Into<Operation>, span: Span) {
        self.instructions.push(Instruction { operation: operation.into(), span });
    }

    /// Emits the code of `expr` and returns the stack depth it needs.
    fn compile_expr(&mut self, expr: &Expr, context: ExprContext) -> LoweringResult<usize> {
        let (source, depth) = self.compile_source(expr, context)?;
        if source != LAST {
            self.emit(UncommonOp::Load(source), expr.span);
        }
        Ok(depth)
    }

    /// Returns the source of the value of `expr` and the stack depth it needs.
    ///
    /// Emits code only for computed values and for reads that may raise an alarm, so that the first alarm
    /// stays the first.
    fn compile_source(
        &mut self,
        expr: &Expr,
        context: ExprContext,
    ) -> LoweringResult<(OperandSource, usize)> {
        if context.brackets > MAX_BRACKETS {
            return Err(Alarm::TooManyBrackets.located_at(expr.span));
        }
        match &expr.kind {
            ExprKind::Literal(number) => return Ok((OperandSource::Number(number.value()), 1)),
            ExprKind::Variable(index) => {
                if let Some(number) = literal_index(index) {
                    let source = match Slot::of(number) {
                        Slot::Free(number) => OperandSource::Free(number),
                        Slot::Other(number) => {
                            self.emit(UncommonOp::Read(number), expr.span);
                            LAST
                        }
                    };
                    return Ok((source, 1));
                }
                if let Some(read) = item_read(index) {
                    self.emit(read, expr.span);
                    return Ok((LAST, 1));
                }
                let depth = self.compile_expr(index, context.of_macro())?;
                self.emit(UncommonOp::LoadIndirect, expr.span);
                return Ok((LAST, depth));
            }
            ExprKind::Plus(inner) => return self.compile_source(inner, context),
            // Brackets only decide whether a vacant variable stays vacant.
            ExprKind::Bracket(inner) if is_never_vacant(inner) => {
                return self.compile_source(inner, context.inside(1));
            }
            _ => {}
        }
        self.compile_computed(expr, context).map(|depth| (LAST, depth))
    }

    /// Returns the sources of an operator's two values. The first is pushed if both are computed.
    fn compile_sources(
        &mut self,
        [left, right]: [&Expr; 2],
        context: ExprContext,
    ) -> LoweringResult<([OperandSource; 2], usize)> {
        let (mut left_source, left_depth) = self.compile_source(left, context)?;
        let behind_left = self.instructions.len();
        let (right_source, right_depth) = self.compile_source(right, context)?;
        if (left_source, right_source) == (LAST, LAST) {
            left_source = STACKED;
            let wait = Instruction { operation: UncommonOp::Push.into(), span: left.span };
            self.instructions.insert(behind_left, wait);
        }
        Ok(([left_source, right_source], left_depth.max(right_depth + 1)))
    }

    /// Emits the code of an expression other than a number or a variable.
    fn compile_computed(&mut self, expr: &Expr, context: ExprContext) -> LoweringResult<usize> {
        let span = expr.span;
        Ok(match &expr.kind {
            ExprKind::Literal(_) | ExprKind::Variable(_) | ExprKind::Plus(_) => {
                self.compile_expr(expr, context)?
            }
            ExprKind::Named(name) => {
                let depth = self.compile_named(name, span, context)?;
                self.emit(UncommonOp::LoadIndirect, span);
                depth
            }
            ExprKind::Negate(inner) => self.compile_unary(inner, UncommonOp::Negate, span, context)?,
            ExprKind::Bracket(inner) => {
                self.compile_unary(inner, UncommonOp::Bracket, span, context.inside(1))?
            }
            ExprKind::Binary(op, left, right) => {
                if *op == BinaryOp::Mod {
                    self.record_syntax(DialectSyntax::NewFunction("MOD"), span);
                }
                let (values, depth) = self.compile_sources([left, right], context)?;
                self.emit(Operation::binary(*op, values), span);
                depth
            }
            ExprKind::Call(function, form) => self.compile_call(*function, form, span, context.inside(1))?,
            ExprKind::Parameter { number, bit, axis } => {
                self.record_syntax(DialectSyntax::NewWord("PRM"), span);
                let context = context.of_macro().inside(1);
                let mut depth = self.compile_expr(number, context)?;
                for (index, part) in bit.iter().chain(axis).enumerate() {
                    self.emit(UncommonOp::Push, span);
                    depth = depth.max(self.compile_expr(part, context)? + index + 1);
                }
                self.emit(UncommonOp::Parameter { bit: bit.is_some(), axis: axis.is_some() }, span);
                depth
            }
            ExprKind::AxisNumber(letter) => {
                self.record_syntax(DialectSyntax::NewWord("AXNUM"), span);
                self.emit(UncommonOp::AxisNumber(*letter), span);
                1
            }
        })
    }

    fn compile_unary(
        &mut self,
        inner: &Expr,
        operation: UncommonOp,
        span: Span,
        context: ExprContext,
    ) -> LoweringResult<usize> {
        let depth = self.compile_expr(inner, context)?;
        self.emit(operation, span);
        Ok(depth)
    }

    fn compile_call(
        &mut self,
        function: Function,
        form: &CallForm,
        span: Span,
        context: ExprContext,
    ) -> LoweringResult<usize> {
        let two = |this: &mut Self, a: &Expr, b: &Expr, operation: fn([OperandSource; 2]) -> Operation| {
            let (values, depth) = this.compile_sources([a, b], context)?;
            this.emit(operation(values), span);
            Ok(depth)
        };
        let new = match (function, form) {
            (Function::Pow, _) => Some("POW"),
            (Function::Atan, CallForm::Comma(..)) => Some("ATAN[a,b]"),
            _ => None,
        };
        if let Some(name) = new {
            self.record_syntax(DialectSyntax::NewFunction(name), span);
        }
        if let Some(name) = new.or(is_extended(function).then(|| function.name())) {
            self.record_syntax(DialectSyntax::MoreFunction(name), span);
        }
        match (function, form, context.address) {
            (Function::Atan, CallForm::Slash(a, b) | CallForm::Comma(a, b), _) => {
                two(self, a, b, Operation::Atan2)
            }
            (Function::Pow, CallForm::Comma(a, b), _) => {
                two(self, a, b, |values| UncommonOp::Power(values).into())
            }
            (Function::Pow, CallForm::One(_), _) => Err(Alarm::MissingComma.located_at(span)),
            (Function::Round, CallForm::One(inner), Some(letter)) => {
                self.compile_unary(inner, UncommonOp::RoundTo(letter), span, context)
            }
            (Function::Adp, CallForm::One(inner), _) => {
                let ExprKind::Variable(index) = &inner.kind else {
                    return Err(Alarm::ArgumentFormat { function: "ADP".into() }.located_at(span));
                };
                self.compile_unary(index, UncommonOp::AddPoint, span, context.of_macro())
            }
            (_, CallForm::One(inner), _) => {
                let (value, depth) = self.compile_source(inner, context)?;
                self.emit(Operation::Function(function, value), span);
                Ok(depth)
            }
            (_, CallForm::Slash(..) | CallForm::Comma(..), _) => {
                Err(Alarm::ArgumentFormat { function: function.name().into() }.located_at(span))
            }
        }
    }

    pub(in crate::program) fn compile_target(&mut self, target: &Expr) -> LoweringResult<AssignmentTarget> {
        match &target.kind {
            ExprKind::Variable(index) => match self.operand(index, ExprContext::MACRO)? {
                // The nearest whole number, as for any index.
                Operand::Number(number) if (0.0..=MAX_VARIABLE_NUMBER).contains(&number.round()) => {
                    if number.fract() != 0.0 {
                        self.record_syntax(DialectSyntax::FractionalNumber, index.span);
                    }
                    Ok(AssignmentTarget::Slot(Slot::of(number.round() as u32)))
                }
                operand => Ok(AssignmentTarget::Computed(operand)),
            },
            ExprKind::Named(name) => {
                let code = self
                    .compile(target.span, |this| this.compile_named(name, target.span, ExprContext::MACRO))?;
                Ok(AssignmentTarget::Computed(Operand::Code(code)))
            }
            _ => Err(Alarm::Expression { text: String::new() }.located_at(target.span)),
        }
    }

    /// Emits the code for the number of a named variable.
    fn compile_named(&mut self, name: &Name, span: Span, context: ExprContext) -> LoweringResult<usize> {
        let text = || name.text.clone();
        self.record_syntax(DialectSyntax::NewWord("[#NAME]"), span);
        if !name.text.starts_with('_') {
            if name.index.is_some() {
                return Err(Alarm::Suffix { name: text() }.located_at(span));
            }
            self.emit(UncommonOp::NameNumber(name.text.as_str().into()), span);
            return Ok(1);
        }
        if OTHER_MEMORIES.contains(&name.text.as_str()) {
            return Err(Alarm::VariableName { name: text() }.located_at(span));
        }
        let row =
            names::find(&name.text).ok_or_else(|| Alarm::NoVariableName { name: text() }.located_at(span))?;
        let depth = match (&name.index, row.suffix) {
            (Some(index), Some(_)) => self.compile_expr(index, context.of_macro().inside(2))?,
            (None, None) => 1,
            _ => return Err(Alarm::Suffix { name: text() }.located_at(span)),
        };
        self.emit(UncommonOp::SystemNumber(row), span);
        Ok(depth)
    }

    fn compile_condition(&mut self, condition: &Condition) -> LoweringResult<usize> {
        match condition {
            Condition::Compare { left, relation, spelling: written, right, span } => {
                if *written == OperatorSpelling::Sign {
                    self.record_syntax(DialectSyntax::RelationSigns, *span);
                }
                let (values, depth) = self.compile_sources([left, right], ExprContext::MACRO.inside(1))?;
                self.emit(Operation::Compare(*relation, values), *span);
                Ok(depth)
            }
            Condition::Logic(op, written, first, second) => {
                let left = self.compile_condition(first)?;
                let span = self.instructions.last().map_or_else(Span::default, |i| i.span);
                self.emit(UncommonOp::Push, span);
                let right = self.compile_condition(second)?;
                let span = self.instructions.last().map_or_else(Span::default, |i| i.span);
                if *written == OperatorSpelling::Sign {
                    self.record_syntax(DialectSyntax::RelationSigns, span);
                }
                self.emit(UncommonOp::Logic(*op), span);
                Ok(left.max(right + 1))
            }
            Condition::Bracket(inner) => self.compile_condition(inner),
            Condition::Value { value, of_loop } => {
                self.record_syntax(DialectSyntax::ValueCondition { of_loop: *of_loop }, value.span);
                self.compile_expr(value, ExprContext::MACRO.inside(1))
            }
        }
    }
}

/// Returns the number of a variable with a whole literal number, `#5`.
fn literal_index(index: &Expr) -> Option<u32> {
    let ExprKind::Literal(number) = index.kind else { return None };
    let value = number.value();
    (value.fract() == 0.0 && (0.0..=MAX_VARIABLE_NUMBER).contains(&value)).then_some(value as u32)
}

/// Returns the operation that reads a variable whose literal number has digits behind its point, `#30057.21`.
fn item_read(index: &Expr) -> Option<UncommonOp> {
    let ExprKind::Literal(number) = index.kind else { return None };
    let unit = 10_u64.checked_pow(u32::from(number.places?))?;
    let (whole, rounded) = (number.digits / unit, number.value().round());
    let is_index = !number.negative && rounded <= MAX_VARIABLE_NUMBER;
    is_index.then_some(UncommonOp::ReadItem {
        number: whole as u32,
        item: u32::try_from(number.digits % unit).ok()?,
        rounded: rounded as u32,
    })
}

/// Returns true for an expression whose value is a number even if its variables are vacant.
fn is_never_vacant(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Variable(_) | ExprKind::Named(_) => false,
        ExprKind::Negate(inner) | ExprKind::Plus(inner) | ExprKind::Bracket(inner) => is_never_vacant(inner),
        ExprKind::Literal(_)
        | ExprKind::Binary(..)
        | ExprKind::Call(..)
        | ExprKind::Parameter { .. }
        | ExprKind::AxisNumber(_) => true,
    }
}

/// Returns true for a function outside the basic set.
fn is_extended(function: Function) -> bool {
    use Function::{Adp, Bcd, Bin, Exp, Fup, Ln};
    matches!(function, Fup | Ln | Exp | Bin | Bcd | Adp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::{Memory, OpKind};

    /// Returns the operations of an assignment.
    fn operations(text: &str) -> Vec<Operation> {
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{text}\n").into_bytes());
        let program = memory.ids().next().unwrap();
        let OpKind::AssignDirect(assign) = memory.lower_block(program, 0).unwrap().kind() else {
            panic!("{text}")
        };
        assign.code.iter().map(|instruction| instruction.operation.clone()).collect()
    }

    #[test]
    fn brackets_and_signs_without_effect_need_no_instruction() {
        let sum = Operation::Add([OperandSource::Free(2), OperandSource::Number(1.0)]);
        let product = Operation::Multiply([LAST, OperandSource::Number(2.0)]);
        assert_eq!(operations("#1=[#2+1.]*[2.]"), [sum.clone(), product]);
        assert_eq!(operations("#1=+[+#2+1.]"), [sum]);
        let load = Operation::from(UncommonOp::Load(OperandSource::Free(2)));
        assert_eq!(operations("#1=[#2]"), [load, UncommonOp::Bracket.into()]);
    }
}
