//! Rule: arithmetic on constants that always raises an alarm, `SQRT[-4]`, `5/0`, `ACOS[1.5]`.
use gcode_control::static_eval::{atan2, binary, function, power};
use gcode_lang::alarm::LocatedAlarm;
use gcode_lang::control::Settings;
use gcode_lang::syntax::ast::{BinaryOp, CallForm, Expr, ExprKind, Function};

use crate::expressions;
use crate::prelude::*;

pub(super) static RULE: Rule = Rule::of_block(
    "constant-alarm",
    Severity::Error,
    "arithmetic on constants that always raises an alarm",
    find,
);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, block: OpIndex) -> Vec<Diagnostic> {
    let mut numbers = ConstantEvaluator { settings: context.settings, alarms: Vec::new() };
    for (expr, _) in expressions::block_expressions(&unit.blocks[block]) {
        numbers.value(expr);
    }
    numbers.alarms.iter().map(|alarm| context.alarm_finding(unit, &RULE.kind, block, alarm)).collect()
}

/// Evaluates constant expressions and collects their alarms.
struct ConstantEvaluator<'a> {
    settings: &'a Settings,
    alarms: Vec<LocatedAlarm>,
}

impl ConstantEvaluator<'_> {
    /// Returns the value; `None` if it depends on a variable or has raised an alarm.
    fn value(&mut self, expr: &Expr) -> Option<f64> {
        let computed = match &expr.kind {
            ExprKind::Literal(number) => Ok(number.value()),
            ExprKind::Bracket(inner) | ExprKind::Plus(inner) => Ok(self.value(inner)?),
            ExprKind::Negate(inner) => Ok(-self.value(inner)?),
            ExprKind::Binary(op, left, right) => {
                let (left, right) = (self.value(left), self.value(right)?);
                // Division by 0 raises an alarm for any dividend.
                let is_division = matches!(op, BinaryOp::Div | BinaryOp::Mod);
                let value =
                    binary(*op, left.or(is_division.then_some(1.0))?, right, &self.settings.undocumented);
                if left.is_none() && value.is_ok() {
                    return None;
                }
                value
            }
            ExprKind::Call(name, form) => self.call(*name, form)?,
            ExprKind::Variable(index) => {
                self.value(index);
                return None;
            }
            ExprKind::Named(_) | ExprKind::Parameter { .. } | ExprKind::AxisNumber(_) => return None,
        };
        computed.map_err(|alarm| self.alarms.push(alarm.located_at(expr.span))).ok()
    }

    fn call(&mut self, name: Function, form: &CallForm) -> Option<Result<f64, Alarm>> {
        match form {
            CallForm::One(inner) => {
                let x = self.value(inner)?;
                // ADP requires a variable and POW two numbers; such a block is unreadable.
                (!matches!(name, Function::Adp | Function::Pow)).then(|| function(name, x, self.settings))
            }
            CallForm::Slash(one, other) | CallForm::Comma(one, other) => {
                let (one, other) = (self.value(one), self.value(other));
                match name {
                    Function::Atan => Some(atan2(one?, other?, self.settings)),
                    Function::Pow => Some(power(one?, other?)),
                    _ => None,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn arithmetic_that_raises_an_alarm_is_reported() {
        let text = "O1\n#1=SQRT[-4]\n#2=#1/0\n#3=1/[2-2]\n#4=ACOS[1.5]\n#5=LN[0]\nIF[#1 MOD 0 GT 2]GOTO 9\n\
                    X[ASIN[-2]]\n#[5/0]=1\n#6=2+SQRT[0-ABS[-9]]*#1\nN9 M30\n";
        assert_eq!(lines(&RULE, text), [2, 3, 4, 5, 6, 7, 8, 9, 10]);
        let found = messages(&RULE, text);
        assert!(found[0].starts_with("PS0119: ") && found[1].starts_with("PS0112: "), "{found:?}");
    }

    #[test]
    fn computable_and_unknown_values_are_accepted() {
        let text = "O1\n#1=SQRT[4]/2\n#2=SQRT[#1-9]\n#3=5/#4\n#5=ACOS[-1]\n#6=0/5\n#7=ATAN[1]/[0]\n#8=7 MOD 3\nM30\n";
        assert_eq!(lines(&RULE, text), NOWHERE);
    }
}
