//! Rule: `(CHECK-OFF NAME)` with a name that is not a rule, which suppresses nothing.
use crate::prelude::*;
use crate::suppression::suppressions;

pub(super) static RULE: Rule =
    Rule::new("unknown-check", Severity::Warning, "CHECK-OFF with a name that is not a rule", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut off = suppressions(unit);
    off.retain(|found| !context.rules.iter().any(|rule| rule.eq_ignore_ascii_case(&found.name)));
    let findings = off.into_iter().map(|unknown| {
        let message = match &*unknown.name {
            "" => "CHECK-OFF does not name a rule".to_owned(),
            name => format!("{name} is not a rule: CHECK-OFF suppresses nothing"),
        };
        let finding = unit.finding(&RULE.kind, unknown.block, message).with_span(unknown.comment);
        finding.help("see docs/checks.md for the rules")
    });
    findings.collect()
}

#[cfg(test)]
mod tests {
    use super::super::doubled_n;
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn names_must_be_those_of_rules() {
        assert_eq!(
            lines(&RULE, "O1(CHECK-OFF DOUBLED-M)\n(CHECK-OFF)\nN1 M8(CHECK-OFF DOUBLED-N)\nM30\n"),
            [1, 2]
        );
    }

    #[test]
    fn a_silenced_rule_is_silent_on_its_block_or_in_its_program() {
        assert_eq!(lines(&doubled_n::RULE, "O1\nN1 M8\nN1 M9 (CHECK-OFF DOUBLED-N)\nN2\nN2\nM30\n"), [5]);
        assert_eq!(lines(&doubled_n::RULE, "O1(PART)\n(CHECK-OFF DOUBLED-N)\nN1 M8\nN1 M9\nM30\n"), NOWHERE);
    }
}
