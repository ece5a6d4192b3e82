//! Messages of logpoints: text with expressions in braces, `x {#5041}`.
use super::values;
use gcode_control::Control;
use gcode_lang::program::Expression;

/// Message of a logpoint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LogMessage(Vec<Part>);

#[derive(Clone, Debug, PartialEq)]
enum Part {
    Text(String),
    Value(Expression),
}

impl LogMessage {
    /// Reads a message; the error names the expression that can't be read.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some((before, behind)) = rest.split_once('{') {
            let Some((inside, after)) = behind.split_once('}') else {
                return Err(format!("log message '{text}': a closing brace is missing"));
            };
            parts.push(Part::Text(before.to_owned()));
            let expression = Expression::parse(inside)
                .map_err(|alarm| format!("log message, {{{inside}}}: {}", values::alarm(&alarm)))?;
            parts.push(Part::Value(expression));
            rest = after;
        }
        parts.push(Part::Text(rest.to_owned()));
        Ok(Self(parts))
    }

    /// Returns the message with the values of now; an alarm stands in the place of its value.
    pub(crate) fn text(&self, control: &Control) -> String {
        let level = control.vars().level();
        let shown = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Value(expression) => match control.evaluate(expression, level) {
                Ok(result) => values::evaluation(result),
                Err(alarm) => format!("<{}>", values::alarm(&alarm)),
            },
        };
        self.0.iter().map(shown).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_control::Value;
    use gcode_lang::control::Settings;
    use gcode_lang::program::Memory;

    #[test]
    fn expressions_in_braces_become_values() {
        let mut control = Control::new(Memory::default(), Settings::default());
        control.assign(0, 1, Value::Number(2.5)).unwrap();
        let text = |message: &str| LogMessage::parse(message).unwrap().text(&control);
        assert_eq!(text("x {#1*2}, {#2} and {#1 GT 2}."), "x 5, vacant and true.");
        assert_eq!(text("no value"), "no value");
        assert!(text("{1/0}").starts_with("<PS0112"));
        for message in ["{#1", "{}", "{G0}"] {
            assert!(LogMessage::parse(message).is_err(), "{message}");
        }
    }
}
