//! Rule: a local variable that is read before it is set. Its word is ignored, or it counts as 0.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::alarm::kinds::PS0112;
use gcode_lang::program::argument_letter;
use gcode_lang::source::Span;

use crate::expressions::ValueUse;
use crate::prelude::*;
use crate::unset_reads::{entry_locals, unset_reads};
use crate::vacancy::{states, states_without_arguments};

use super::missing_argument::factor_reads;

pub(super) static RULE: Rule =
    Rule::new("unset-variable", Severity::Error, "a local variable that is read before it is set", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut unset: BTreeMap<(OpIndex, u32), (Span, ValueUse)> = BTreeMap::new();
    match unit.role {
        Role::Resident => {}
        // Without an end it may be a part of a program, or a macro.
        Role::Main if unit.piece.is_none() && !unit.has_exit() => {}
        Role::Main => {
            unset.extend(unset_reads(unit, states_without_arguments(unit)));
        }
        Role::Called => {
            // Calls with the same arguments leave the same locals unset.
            let mut entries = BTreeSet::new();
            for (caller, site) in &unit.callers {
                let call = &context.units[*caller].calls[*site];
                // A subprogram has its caller's locals, and a modal call keeps its own between calls.
                if !call.has_own_locals || call.is_modal {
                    return Vec::new();
                }
                let entry = entry_locals(call);
                if !entries.insert(entry) {
                    continue;
                }
                let states = states(unit, entry);
                // The rule `missing-argument` reports locals that an argument can set.
                let reads = unset_reads(unit, &states).into_iter();
                unset.extend(reads.filter(|((_, local), _)| argument_letter(*local as usize).is_none()));
            }
        }
    }
    let mut found = Vec::new();
    for ((block, local), (span, usage)) in unset {
        let so = match usage {
            ValueUse::Word => "its word is ignored",
            ValueUse::PassedOn => "it is passed on vacant",
            ValueUse::VacancyTest | ValueUse::Comparison => "a vacant variable is compared",
            ValueUse::Computed | ValueUse::Target => "it counts as 0",
        };
        let is_divisor = factor_reads(&unit.blocks[block]).contains(&(local, true));
        let (severity, so) = if is_divisor {
            (Severity::Error, PS0112.to_string())
        } else {
            (Severity::Warning, so.to_owned())
        };
        let message = format!("#{local} is read before a block sets it: {so}");
        let help = format!("set #{local} before it is read, or correct its number");
        let finding = unit.finding(&RULE.kind, block, message).with_severity(severity);
        found.push(finding.with_span(span).help(help));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn an_unset_variable_is_reported() {
        assert_eq!(lines(&RULE, "O1\n#1=2.\nG0 X#1 Y#2\n#3=#4*2\n#5=#6\nM30\n"), [3, 4, 5]);
        assert_eq!(lines(&RULE, "O1\nIF[#9 EQ #0]THEN #10=#9*2\nM30\n"), [2]);
        assert_eq!(lines(&RULE, "O1\n#1=#2+1\n#3=#3*2\n#4=1-#4\n#5=#5+#5\nM30\n"), [2, 3, 4, 5]);
        assert_eq!(lines(&RULE, "O1\nIF[#8 NE #0]THEN #10=#500\nIF[#9 LT 2]THEN #11=1\nM30\n"), [3]);
        let found = messages(&RULE, "O1\nG0 Y#2\nM30\n");
        assert_eq!(found, ["#2 is read before a block sets it: its word is ignored"]);
    }

    #[test]
    fn a_vacant_divisor_is_the_alarm() {
        let found = messages(&RULE, "O1\n#1=360.\n#2=#1/#3\n#4=#1*#5\nM30\n");
        assert_eq!(
            found,
            [
                "#3 is read before a block sets it: PS0112",
                "#5 is read before a block sets it: it counts as 0"
            ]
        );
    }

    #[test]
    fn idioms_are_accepted() {
        for text in [
            "O1\nIF[#24 EQ #0]THEN #24=1.\nX#24\nM30\n",
            "O1\nIF[#24 NE #0]GOTO 5\n#24=1.\nN5 X#24\nM30\n",
            "O1\n#1=#0\nX#1\n#2=#1\nM30\n",
            "O1\n#1=2.+3.\nX#1\n#2=SQRT[#1]\nIF[#2 GT 1]THEN #3=#2*2\n#4=#2/2\nX#2 Y#4\nM30\n",
            "O1\n#[10+5]=3.\nX#15\nM30\n",
            "O1\nM98 P2\nX#5\nM30\nO2\n#5=3.\nM99\n",
            "O1\n#3=#500\nX#3\n#4=#100\n#4=#4\nM30\n",
            "O2\nX#24\n#27=#26*2\nM99\n",
            "O1\nIF[#500 EQ 1]GOTO 5\n#1=2.\nN5 X#1\nM30\n",
            "O1\nIF[#9 NE #0]THEN #10=#9*2\nIF[[#9 NE #0] AND [#9 LT 5]]GOTO 5\nN5 M30\n",
            "O1\nIF[[#9 EQ #0] OR [#9 LT 5]]GOTO 5\nN5 M30\n",
            "O1\n#33=#33+1\n#32=#32-#500*2.\n#31=2.*#500+#31\nM30\n",
            "O1\nX#2\nIF[#1 LT 0.37]GOTO 9\nN9\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }

    #[test]
    fn the_first_iteration_of_a_loop_counts() {
        assert_eq!(lines(&RULE, "O1\n#1=0\nWHILE[#1 LT 3]DO1\nX#2\n#2=5.\n#1=#1+1\nEND1\nM30\n"), [4]);
        assert_eq!(
            lines(&RULE, "O1\n#1=0\nWHILE[#1 LT 3]DO1\n#2=5.\nX#2\n#1=#1+1\nEND1\nX#2\nM30\n"),
            NOWHERE
        );
    }

    #[test]
    fn the_arguments_of_the_calls_count() {
        let called = "O2\nX#24\n#30=#24+#31\nM99\n";
        assert_eq!(lines(&RULE, &format!("O1\nG65 P2 X1.\nM30\n{called}")), [6]);
        assert_eq!(lines(&RULE, "O1\nG65 P2 I1. I2.\nM30\nO2\nX#4 Y#7\nM99\n"), NOWHERE);
    }
}
