//! Rule: `(` instead of `[`. Round brackets are a comment, so their content has no effect.
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("round-brackets", Severity::Error, "( ) instead of [ ]: round brackets are a comment", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    context.reading_findings(unit, &RULE.kind, |alarm| {
        matches!(alarm, Alarm::RoundBrackets { .. } | Alarm::RoundBracketsForValue)
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::lines;
    use super::RULE;

    #[test]
    fn values_and_conditions_need_square_brackets() {
        let text = "O1\n#1=ABS(#2)\nX(#1+1.)\nIF(#1 EQ 2)GOTO 5\n#3=[2.*3.] (#1+1.)\nN5 M30\n";
        assert_eq!(lines(&RULE, text), [2, 3, 4]);
    }
}
