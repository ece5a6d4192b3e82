//! Expressions and conditions outside a program, as a person types them on a screen.
use super::bytecode::{AssignmentTarget, Bytecode, Operand, Slot};
use super::{Assign, Memory, OpKind, ProgramId, Statement};
use crate::alarm::Alarm;

/// Bytes that would end the expression, begin a comment, or assign.
const FOREIGN: &[u8] = b"();%=\r\n";

/// Relations whose presence makes a text a condition.
const RELATIONS: [&str; 6] = ["EQ", "NE", "GT", "GE", "LT", "LE"];

/// Variable for which an expression is read; nothing is written to it.
const TARGET: u32 = 1;

/// Expression or condition that is ready for evaluation.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    /// Expression: `#1*2`, `SIN[30.]`.
    Value(Operand),
    /// Condition: `#1 GT 3`, without brackets around it.
    Condition(Bytecode),
}

impl Expression {
    /// Reads an expression or a condition.
    ///
    /// # Errors
    /// The alarm that a control raises at such a statement.
    pub fn parse(text: &str) -> Result<Self, Alarm> {
        let text = checked(text)?;
        match value(&text) {
            Ok(operand) => Ok(Self::Value(operand)),
            Err(alarm) => match condition(&text) {
                Ok(code) => Ok(Self::Condition(code)),
                Err(other) => {
                    let is_condition = RELATIONS.iter().any(|relation| text.contains(relation));
                    Err(if is_condition { other } else { alarm })
                }
            },
        }
    }
}

/// Reads the variable on the left of an assignment: `#100`, `#[#1+2]`.
///
/// # Errors
/// The alarm that a control raises at an assignment to it.
pub fn parse_target(text: &str) -> Result<AssignmentTarget, Alarm> {
    let text = checked(text)?;
    match statement(&format!("{text}=0"))? {
        Statement::Assign { target, .. } => Ok(target),
        Statement::AssignDirect(Assign { variable, .. }) => Ok(AssignmentTarget::Slot(Slot::Free(variable))),
        _ => Err(foreign(&text)),
    }
}

fn foreign(text: &str) -> Alarm {
    Alarm::NotAWord { text: text.chars().take(40).collect() }
}

/// Returns the text in upper case, without a `;`, a comment or a line end.
fn checked(text: &str) -> Result<String, Alarm> {
    let text = text.trim();
    if text.is_empty() || text.bytes().any(|byte| FOREIGN.contains(&byte)) || !text.is_ascii() {
        return Err(foreign(text));
    }
    Ok(text.to_ascii_uppercase())
}

fn value(text: &str) -> Result<Operand, Alarm> {
    match statement(&format!("#{TARGET}={text}"))? {
        Statement::AssignDirect(Assign { code, .. }) => Ok(Operand::Code(code)),
        Statement::Assign { value, .. } => Ok(value),
        _ => Err(foreign(text)),
    }
}

fn condition(text: &str) -> Result<Bytecode, Alarm> {
    const END: &str = "]GOTO1";
    let read = statement(&format!("IF[{text}{END}")).map_err(|alarm| match alarm {
        // The text ends where the statement around it goes on.
        Alarm::Expression { text: from } => {
            Alarm::Expression { text: from.strip_suffix(END).unwrap_or(&from).to_owned() }
        }
        alarm => alarm,
    });
    match read? {
        Statement::IfGoto { condition, to } if to.node == Operand::Number(1.0) => Ok(condition),
        _ => Err(foreign(text)),
    }
}

/// Lowers a block that must be one statement.
fn statement(block: &str) -> Result<Statement, Alarm> {
    let mut memory = Memory::default();
    memory.load("", format!("O1\n{block}\n").into_bytes());
    let op = memory.take_op(ProgramId::default(), 0);
    match op {
        Some(OpKind::AssignDirect(assign)) => Ok(Statement::AssignDirect(assign)),
        Some(OpKind::Statement(Statement::Alarm(alarm))) | Some(OpKind::Alarm(alarm)) => Err(alarm.node),
        Some(OpKind::Statement(statement)) => Ok(statement),
        _ => Err(foreign(block)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_and_conditions_are_told_apart() {
        let is_condition =
            |text: &str| Expression::parse(text).map(|read| matches!(read, Expression::Condition(_)));
        for text in ["5", "#1", " #1*2 ", "sin[30.]", "#[#1+100]", "-#2", "#1 AND 3", "#0", "1/2"] {
            assert_eq!(is_condition(text), Ok(false), "{text}");
        }
        for text in ["#1 GT 3", "#1 EQ #0", "[#1 LE 0]OR[#2 LE 0]", "#1gt3"] {
            assert_eq!(is_condition(text), Ok(true), "{text}");
        }
    }

    #[test]
    fn what_is_no_expression_is_refused() {
        for text in [
            "", "  ", "#1=5", "1 #2=5", "1(TEXT)", "1;2", "1\n#2=5", "G0 X1.", "M30", "1]GOTO5", "#1 GT",
            "SIN[30", "Ä",
        ] {
            assert!(Expression::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_reason_of_a_condition_names_what_was_typed() {
        let reason = |text: &str| Expression::parse(text).unwrap_err();
        assert_eq!(reason("#1 GT"), Alarm::Expression { text: String::new() });
        assert_eq!(reason("#1 GT *5"), Alarm::Expression { text: "*5".to_owned() });
    }

    #[test]
    fn a_target_is_a_variable_and_nothing_else() {
        assert_eq!(parse_target("#100"), Ok(AssignmentTarget::Slot(Slot::Free(100))));
        assert_eq!(parse_target("#5221"), Ok(AssignmentTarget::Slot(Slot::Other(5221))));
        assert!(matches!(parse_target("#[#1+2]"), Ok(AssignmentTarget::Computed(_))));
        for text in ["100", "#1+2", "#1=#2", "SIN[1]", "X"] {
            assert!(parse_target(text).is_err(), "{text}");
        }
    }
}
