//! Expressions and values that a person types: evaluated, or assigned.
use super::{Adapter, Answer, Host, body};
use crate::debuggee::values;
use crate::protocol::arguments::{Evaluate, SetExpression, SetVariable};
use crate::protocol::bodies;
use crate::run::{Change, ChangeRefusal};
use gcode_control::{Control, Evaluation, Value};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{Expression, parse_target};

/// Types of values as a client shows them.
const NUMBER: &str = "number";
const CONDITION: &str = "condition";

/// Returns the type of a value.
fn kind(value: Value) -> &'static str {
    if value.is_vacant() { values::VACANT } else { NUMBER }
}

/// Returns the number of a variable as typed: `#100`, `#[#1+2]`.
pub(super) fn target(control: &Control, text: &str, level: usize) -> Result<u32, String> {
    let target = parse_target(text).map_err(|alarm| values::alarm(&alarm))?;
    control.target_number(&target, level).map_err(|alarm| values::alarm(&alarm))
}

/// Returns the value of a text, `vacant` included.
fn typed_value(control: &Control, text: &str, level: usize) -> Result<Value, String> {
    if text.trim().eq_ignore_ascii_case(values::VACANT) {
        return Ok(Value::Vacant);
    }
    let refused = |alarm| format!("'{text}': {}", values::alarm(&alarm));
    match control.evaluate(&typed_expression(text)?, level).map_err(refused)? {
        Evaluation::Value(value) => Ok(value),
        Evaluation::Condition(_) => Err(format!("'{text}' is a condition and no value")),
    }
}

/// Reads an expression or a condition as typed. A reason about the block round it is none of what was typed.
fn typed_expression(text: &str) -> Result<Expression, String> {
    let text = text.trim();
    if text.is_empty() {
        return Err("nothing is typed: type an expression, such as #100*2".to_owned());
    }
    Expression::parse(text).map_err(|alarm| match alarm {
        Alarm::MixedStatements | Alarm::MissingEquals | Alarm::NotAWord { .. } => {
            format!("'{text}' is no expression")
        }
        Alarm::MissingOpenBracket if !text.contains(['[', ']']) => {
            format!("'{text}' is no expression: a function has its argument in brackets, SIN[30.]")
        }
        alarm => format!("'{text}': {}", values::alarm(&alarm)),
    })
}

impl<H: Host> Adapter<H> {
    pub(super) fn evaluate(&mut self, arguments: &Evaluate) -> Answer {
        let level = self.level_of_frame(arguments.frame_id)?;
        let control = self.standing()?.debuggee.control();
        if arguments.expression.contains('=') {
            return Err(
                "an assignment is no expression: set the variable among those of its scope".to_owned()
            );
        }
        let expression = typed_expression(&arguments.expression)?;
        let result = control.evaluate(&expression, level).map_err(|alarm| values::alarm(&alarm))?;
        let kind = match result {
            Evaluation::Value(value) => kind(value),
            Evaluation::Condition(_) => CONDITION,
        };
        body(bodies::Evaluate { result: values::evaluation(result), kind, variables_reference: 0 })
    }

    pub(super) fn set_variable(&mut self, arguments: &SetVariable) -> Answer {
        let level = self.writable_scope(arguments.variables_reference)?;
        self.assign(level, &arguments.name, &arguments.value)
    }

    pub(super) fn set_expression(&mut self, arguments: &SetExpression) -> Answer {
        let level = self.level_of_frame(arguments.frame_id)?;
        self.assign(level, &arguments.expression, &arguments.value)
    }

    fn assign(&mut self, level: usize, name: &str, value: &str) -> Answer {
        let session = self.standing()?;
        let control = session.debuggee.control();
        let number = target(control, name, level)?;
        let value = typed_value(control, value, level)?;
        let change = Change::Assign { level, number, value };
        session.debuggee.change(change).map_err(|refusal| match refusal {
            ChangeRefusal::Alarm(alarm) => format!("#{number} can't be set: {}", values::alarm(&alarm)),
            ChangeRefusal::OtherProgram => format!("#{number} can't be set"),
        })?;
        let control = session.debuggee.control();
        let value = control.variable_of(level, number).map_err(|alarm| values::alarm(&alarm))?;
        body(bodies::SetVariable { value: values::value(value), kind: kind(value), variables_reference: 0 })
    }
}
