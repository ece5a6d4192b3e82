//! Rule: G53 with axes while G91 is in force on every path: the axes do not move.
use gcode_lang::motion::Backtrace;
use gcode_lang::program::g_codes::{Effect, OneShot};

use crate::modes::{after_words, modes_before};
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("ignored-g53", Severity::Warning, "G53 in G91, which moves nothing", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    if context.settings.undocumented.g53_moves_in_g91 {
        return Vec::new();
    }
    let before = modes_before(context, unit);
    let ignored = unit.reached_words().filter(|(block, words)| {
        let names_axis = || words.list.iter().any(|word| context.settings.axes.find(word.letter).is_some());
        let is_machine_move = context
            .has_effect(words, |effect| matches!(effect, Effect::OneShot(OneShot::MachineCoordinateSystem)));
        let modes = before[*block].map(|modes| after_words(context, words, &modes));
        // The words may be arguments of a code that calls a program.
        is_machine_move
            && unit.call_in(*block).is_none()
            && names_axis()
            && modes.is_some_and(|modes| modes.is_incremental && !modes.is_absolute)
    });
    let found = ignored.map(|(block, _)| {
        Diagnostic::new(&RULE.kind, "G53 in G91 is ignored: the axes of the block do not move")
            .with_backtrace(Backtrace { block: unit.op(block).span, calls: None })
            .help("command G90 with G53, or give --control G53-IN-G91=1 for a control that moves by the increment")
    });
    found.collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn g53_with_axes_is_reported_where_g91_is_in_force() {
        for (text, found) in [
            ("O1\nG91 G53 Z0.\nM30\n", [2]),
            ("O1\nG91 G28 Z0.\nG53 G49 Z0.\nM30\n", [3]),
            ("O1\nG90\nM98 P2\nM30\nO2\nG91\nG53 X0. Y0.\nM99\n", [7]),
            ("O1\nG91\n/G0 X5.\nG53 Z0.\nM30\n", [4]),
        ] {
            assert_eq!(lines(&RULE, text), found, "{text}");
        }
    }

    #[test]
    fn g53_is_not_reported_where_g90_may_be_in_force() {
        for text in [
            "O1\nG91 G28 Z0.\nG90 G53 Z0.\nM30\n",
            "O1\nG53 Z0.\nM30\n",
            "O1\nG91\n/G90\nG53 Z0.\nM30\n",
            "O1\nG91\nM98 P2\nG53 Z0.\nM30\nO2\nG90\nM99\n",
            "O1\nG91\nM98 P7\nG53 Z0.\nM30\n",
            "O1\nG91\nG#1\nG53 Z0.\nM30\n",
            "O1\nM98 P2\nM30\nO2\nG53 Z0.\nM99\n",
            // It waits, and moves nothing.
            "O1\nG91\nG53\nM30\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }
}
