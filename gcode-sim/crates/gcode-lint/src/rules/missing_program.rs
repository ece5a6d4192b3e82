//! Rule: a call of a program that is neither in the file nor in the folders, PS0076, or PS0310 by name.
//!
//! A macro that a control protects is probably on the control: its absence here is a warning, one for all such macros.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::alarm::kinds::{PS0076, PS0310};
use gcode_lang::alarm::{missing_macro_help, missing_macros_help, repeats_in_p_help};
use gcode_lang::control::Dialect;
use gcode_lang::syntax::ast::ProgramName;

use crate::calls::{CallSite, CalledProgramName};
use crate::prelude::*;
use crate::suppression::suppressions;

/// Number of missing macros that a message names.
const NAMED: usize = 20;

pub(super) static RULE: Rule =
    Rule::new("missing-program", Severity::Error, "a call of a program that is not found", find);

pub(crate) fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let (mut found, mut of_macros) = (Vec::new(), Vec::new());
    let missing =
        unit.calls.iter().filter(|call| unit.is_reached[call.block] && context.called_unit(call).is_none());
    let missing: Vec<_> = missing.collect();
    let counts = call_counts(unit, &missing);
    let mut reported = BTreeSet::new();
    for call in missing {
        // One finding per missing program, regardless of the number of calls.
        if call.target != CalledProgramName::Missing && !reported.insert(&call.target) {
            continue;
        }
        let label = call.target.label();
        let mut severity = RULE.kind.severity;
        let (message, help) = match call.target {
            CalledProgramName::Computed => continue,
            CalledProgramName::Missing if call.is_of_own_program() => continue,
            CalledProgramName::Missing => (
                format!("{PS0076}: a call without a program number"),
                "write the program number after P".to_owned(),
            ),
            CalledProgramName::Number(number) => {
                let of_macro = missing_macro_help(number);
                if of_macro.is_some() {
                    severity = Severity::Warning;
                }
                let of_blocks = || {
                    let is_here = unit.program.find_number(number, 0).is_some();
                    let has_local_calls = context.settings.codes == Dialect::HaasNgc;
                    (is_here && has_local_calls).then(|| {
                        format!("write M97 P{number} to call the blocks from N{number} on in this program")
                    })
                };
                let in_p = call.digits_of_p.filter(|digits| is_in_memory(context, *digits));
                let help = in_p.map(repeats_in_p_help).or_else(of_blocks).or(of_macro);
                let help = help.unwrap_or_else(|| "give the folder that holds it with --lib".to_owned());
                let calls = match counts[&call.target] {
                    1 => String::new(),
                    calls => format!(" ({calls} calls)"),
                };
                (format!("{PS0076}: program {label} is not found{calls}"), help)
            }
            CalledProgramName::Name(_) => (
                format!("{PS0310}: program {label} is not found"),
                "give the folder that holds it with --lib, or put it into the same file".to_owned(),
            ),
        };
        let finding = unit.finding(&RULE.kind, call.block, message).with_span(call.span);
        let finding = finding.with_severity(severity).help(help);
        match severity {
            Severity::Error => found.push(finding),
            _ => of_macros.push((label, finding)),
        }
    }
    let off = suppressions(unit);
    of_macros.retain(|(_, finding)| !off.iter().any(|off| off.suppresses(finding)));
    found.extend(of_all_macros(of_macros));
    found
}

/// Returns one finding for the findings of all missing macros, each with the name of its macro; it stands at the first call.
fn of_all_macros(each: Vec<(String, Diagnostic)>) -> Option<Diagnostic> {
    let count = each.len();
    let names: Vec<_> = each.iter().map(|(name, _)| name.clone()).collect();
    let mut all = each.into_iter();
    let (_, first) = all.next()?;
    if count == 1 {
        return Some(first);
    }
    let more = count.saturating_sub(NAMED);
    let more = if more == 0 { String::new() } else { format!(" and {more} more") };
    let shown = names[..count - count.saturating_sub(NAMED)].join(", ");
    let message = format!("{PS0076}: {count} macros are not found: {shown}{more}");
    let help = missing_macros_help(&names[0]);
    let calls = all.filter_map(|(name, finding)| Some((finding.span?, name)));
    let all = Diagnostic { message, help: Some(help), ..first };
    Some(calls.fold(all, |finding, (span, name)| finding.label(span, name)))
}

/// Returns true if a program is among those read.
fn is_in_memory(context: &CheckContext<'_>, number: u32) -> bool {
    context.memory.find_from(&ProgramName::Number(number), None).is_some()
}

/// Returns the number of calls of each missing program: those that are left out of the check count too.
fn call_counts<'a>(
    unit: &ProgramUnit<'_>,
    missing: &[&'a CallSite],
) -> BTreeMap<&'a CalledProgramName, usize> {
    let mut counts = BTreeMap::new();
    for call in missing {
        let left_out = unit.left_out.calls.get(&unit.op(call.block).span.start);
        *counts.entry(&call.target).or_default() += 1 + left_out.copied().unwrap_or_default();
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;
    use crate::check;
    use gcode_lang::control::{Dialect, Settings};
    use gcode_lang::diag::Severity;
    use gcode_lang::program::NoLibrary;

    #[test]
    fn a_macro_of_the_control_is_a_warning() {
        let severity = |number: u32| {
            let text = format!("O1\nG65 P{number} X1.\nM30\n");
            check("O1.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary).findings[0].severity
        };
        for (number, expected) in [
            (7999, Severity::Error),
            (8000, Severity::Warning),
            (9810, Severity::Warning),
            (9999, Severity::Warning),
            (10000, Severity::Error),
        ] {
            assert_eq!(severity(number), expected, "O{number}");
        }
        let found = messages(&RULE, "O1\nG65 P9810 X1.\nG65 P9810 X5.\nM30\n");
        assert_eq!(found, ["PS0076: program O9810 is not found (2 calls)"]);
    }

    #[test]
    fn macros_of_the_control_are_one_warning() {
        let text = "O1\nG65 P9810 X1.\nG65 P9811 Z1.\nM98 P5\nG65 P9810 X5.\nG65 P9812 X5. (CHECK-OFF MISSING-PROGRAM)\nM30\n";
        let found = messages(&RULE, text);
        assert_eq!(
            found,
            ["PS0076: 2 macros are not found: O9810, O9811", "PS0076: program O0005 is not found"]
        );
        assert_eq!(lines(&RULE, text), [2, 4]);
        // The call that is turned off is the first one.
        let text = text.replace("X1.", "X1. (CHECK-OFF MISSING-PROGRAM)");
        assert_eq!(messages(&RULE, &text)[0], "PS0076: program O9811 is not found");
        let all: String = (9800..9825).map(|number| format!("G65 P{number}\n")).collect();
        let found = messages(&RULE, &format!("O1\n{all}M30\n"));
        assert!(
            found[0].contains("25 macros are not found: O9800, ") && found[0].ends_with("O9819 and 5 more"),
            "{found:?}"
        );
    }

    #[test]
    fn a_part_of_the_same_program_has_no_number() {
        for call in ["M97 P9", "M97 P#1", "M97 P#1 L2", "M98 Q9", "M98 Q#1", "M98 H9"] {
            assert_eq!(lines(&RULE, &format!("O1\n#1=9\n{call}\nM30\nN9 G91 X1.\nM99\n")), NOWHERE, "{call}");
        }
        assert_eq!(lines(&RULE, "O1\nM98\nM98 L2\nM30\n"), [2, 3]);
    }

    /// M97 of a Haas calls blocks of its own program, G65 and M98 don't.
    #[test]
    fn blocks_with_the_number_of_a_missing_program_are_named_on_a_haas() {
        let help = |settings: &Settings| {
            let text = "O1\nG65 P1000 X1.\nM30\nN1000\n#100=#24\nM99\n";
            check("O1.nc", text.as_bytes(), settings, &mut NoLibrary).findings[0].help.clone().unwrap()
        };
        let mut haas = Settings::default();
        haas.apply_dialect(Dialect::HaasNgc);
        assert_eq!(help(&haas), "write M97 P1000 to call the blocks from N1000 on in this program");
        assert_eq!(help(&Settings::default()), "give the folder that holds it with --lib");
    }

    #[test]
    fn a_missing_program_is_reported_once() {
        let text =
            "O1\nM98 P30002\nG65 P3 A1.\nM98 P2 L2\n#1=2\nG65 P#1\nG65 A1.\nG65 P3 A2.\nM30\nO2\nM99\n";
        assert_eq!(lines(&RULE, text), [3, 7]);
    }
}
