//! Rule: `=`, `<` or `>` in a condition instead of EQ, NE, LT, LE, GT or GE.
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("relation-symbol", Severity::Error, "= < > instead of EQ, LT, GT …", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    context.reading_findings(unit, &RULE.kind, |alarm| matches!(alarm, Alarm::RelationSymbol))
}

#[cfg(test)]
mod tests {
    use super::super::testing::lines;
    use super::RULE;

    #[test]
    fn symbols_compare_nothing() {
        let text = "O1\n#1=1\nIF[#1=2]GOTO 5\nIF[#1<=4]GOTO 5\nWHILE[#1>4]DO1\nIF[#1 GT 4]GOTO 5\nN5 M30\n";
        assert_eq!(lines(&RULE, text), [3, 4, 5]);
    }
}
