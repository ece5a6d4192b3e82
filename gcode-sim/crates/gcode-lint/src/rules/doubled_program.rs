//! Rule: two programs with the same number or name. A control refuses the second and does not start.
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("doubled-program", Severity::Error, "a program number that is defined twice", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let refused = context.memory.duplicates().any(|program| std::ptr::eq(program, unit.program));
    let is_begun_before = unit.piece.as_ref().is_some_and(|piece| !piece.is_first);
    if !refused || unit.program.ops().is_empty() || is_begun_before {
        return Vec::new();
    }
    let label = unit.program.label();
    let finding = unit.finding(
        &RULE.kind,
        0,
        format!("program {label} is already defined above: a control refuses it"),
    );
    vec![finding.help("give one of them another number")]
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn a_number_belongs_to_one_program() {
        assert_eq!(lines(&RULE, "O1\nM30\nO0001\nM30\n"), [4]);
        assert_eq!(lines(&RULE, "O1\nM30\nO2\nM30\n"), NOWHERE);
    }
}
