//! Rules of the checker, one file and one row of [`ALL`] each.
mod constant_alarm;
mod doubled_n;
mod doubled_program;
mod endless_loop;
mod jump_into_loop;
mod live_position;
mod loop_pairs;
mod missing_argument;
mod missing_feed;
mod missing_n;
mod missing_offset;
mod missing_point;
mod missing_program;
mod no_such_variable;
mod open_comment;
mod relation_symbol;
mod round_brackets;
mod rounded_pi;
mod several_m_codes;
mod stray_word;
mod unknown_check;
mod unknown_code;
mod unreachable;
mod unreachable_alarm;
mod unreadable;
mod unset_variable;

use gcode_lang::diag::Diagnostic;

use super::context::{CheckContext, ProgramUnit, RuleFinding};
use super::suppression::Suppressions;

/// Rule of the checker.
pub struct Rule {
    /// Code of the findings, and the name in `(CHECK-OFF NAME)`.
    pub name: &'static str,
    /// Fault found by the rule, in one line.
    pub summary: &'static str,
    find: fn(&CheckContext<'_>, &ProgramUnit<'_>) -> Vec<RuleFinding>,
}

/// All rules, in the order of their findings for one block.
#[rustfmt::skip]
pub const ALL: &[Rule] = &[
    Rule { name: unreadable::NAME, summary: "a block that raises an alarm as it is read", find: unreadable::find },
    Rule { name: round_brackets::NAME, summary: "( ) instead of [ ]: round brackets are a comment", find: round_brackets::find },
    Rule { name: relation_symbol::NAME, summary: "= < > instead of EQ, LT, GT …", find: relation_symbol::find },
    Rule { name: loop_pairs::NAME, summary: "DO and END that do not pair, or loops that overlap", find: loop_pairs::find },
    Rule { name: jump_into_loop::NAME, summary: "a jump into a loop from outside", find: jump_into_loop::find },
    Rule { name: missing_n::NAME, summary: "a jump to a sequence number that is not defined", find: missing_n::find },
    Rule { name: doubled_n::NAME, summary: "a sequence number that is defined twice", find: doubled_n::find },
    Rule { name: doubled_program::NAME, summary: "a program number that is defined twice", find: doubled_program::find },
    Rule { name: unknown_code::NAME, summary: "a G or M code the control does not have", find: unknown_code::find },
    Rule { name: missing_program::NAME, summary: "a call of a program that is not found", find: missing_program::find },
    Rule { name: missing_argument::NAME, summary: "a macro call without a required argument", find: missing_argument::find },
    Rule { name: several_m_codes::NAME, summary: "more M codes in a block than the control accepts", find: several_m_codes::find },
    Rule { name: no_such_variable::NAME, summary: "a variable that does not exist, or cannot be read or written", find: no_such_variable::find },
    Rule { name: constant_alarm::NAME, summary: "arithmetic on constants that always raises an alarm", find: constant_alarm::find },
    Rule { name: missing_offset::NAME, summary: "an H or D number beyond the tool offsets", find: missing_offset::find },
    Rule { name: missing_feed::NAME, summary: "a feed move before any F", find: missing_feed::find },
    Rule { name: open_comment::NAME, summary: "a comment that is not closed", find: open_comment::find },
    Rule { name: stray_word::NAME, summary: "a word that no block of this control accepts", find: stray_word::find },
    Rule { name: unset_variable::NAME, summary: "a local variable that is read before it is set", find: unset_variable::find },
    Rule { name: missing_point::NAME, summary: "a number without a decimal point that counts thousandths", find: missing_point::find },
    Rule { name: rounded_pi::NAME, summary: "a rounded π as a factor", find: rounded_pi::find },
    Rule { name: live_position::NAME, summary: "a position read while a move may be in progress", find: live_position::find },
    Rule { name: endless_loop::NAME, summary: "a loop that never ends", find: endless_loop::find },
    Rule { name: unreachable_alarm::NAME, summary: "a #3000 that is never reached", find: unreachable_alarm::find },
    Rule { name: unreachable::NAME, summary: "blocks that are never reached", find: unreachable::find },
    Rule { name: unknown_check::NAME, summary: "CHECK-OFF with a name that is not a rule", find: unknown_check::find },
];

/// Name of the rule about numbers without a decimal point.
pub const MISSING_POINT: &str = missing_point::NAME;

/// Returns the names of all rules.
pub(super) fn names() -> Vec<&'static str> {
    ALL.iter().map(|rule| rule.name).collect()
}

/// Returns the findings of all rules except the suppressed ones, by program and block.
pub(super) fn findings(context: &CheckContext<'_>) -> Vec<Diagnostic> {
    let mut all = Vec::new();
    for unit in &context.units {
        let suppressions = Suppressions::new(unit);
        let mut found: Vec<RuleFinding> = ALL.iter().flat_map(|rule| (rule.find)(context, unit)).collect();
        found.retain(|finding| !suppressions.suppresses(finding));
        found.sort_by_key(|finding| finding.block);
        all.extend(found.into_iter().map(|finding| finding.diagnostic));
    }
    all
}

#[cfg(test)]
pub(super) mod testing {
    //! Runs all rules on a program and returns the findings of one.
    use crate::check;
    use gcode_lang::control::Settings;
    use gcode_lang::program::NoLibrary;

    pub(crate) const NOWHERE: [u32; 0] = [];

    /// Returns the line numbers of a rule's findings, counted from 1.
    pub(crate) fn lines(rule: &str, text: &str) -> Vec<u32> {
        let checked = check("test.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary);
        let of_rule = checked.findings.iter().filter(|f| f.code == rule);
        of_rule
            .map(|f| checked.memory.sources().line_column(f.backtrace.as_ref().unwrap().block).line)
            .collect()
    }

    /// Returns the messages of a rule's findings.
    pub(crate) fn messages(rule: &str, text: &str) -> Vec<String> {
        let checked = check("test.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary);
        checked.findings.into_iter().filter(|f| f.code == rule).map(|f| f.message).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_spelled_as_codes_and_stand_once() {
        for (place, rule) in ALL.iter().enumerate() {
            assert!(rule.name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{}", rule.name);
            assert!(ALL[..place].iter().all(|other| other.name != rule.name), "{}", rule.name);
        }
    }
}
