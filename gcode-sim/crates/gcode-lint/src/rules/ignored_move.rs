//! Rule: G53 with axes in G91, which moves nothing unless a control moves by the increment.
//!
//! The rule is silent where G90 is possible before the block, or `G53-IN-G91` makes the axes move.
use gcode_lang::program::g_codes::{Effect, OneShot};
use gcode_lang::program::modes::Distance;

use crate::modes::modes_before;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("ignored-move", Severity::Warning, "G53 in G91, which moves nothing", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    if context.settings.undocumented.g53_moves_in_g91 {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (block, words) in unit.reached_words() {
        let is_machine_move =
            context.has_effect(words, |effect| effect == Effect::OneShot(OneShot::MachineCoordinateSystem));
        // A skip in machine coordinates moves by the increment.
        let is_skip = context.has_effect(words, |effect| effect == Effect::OneShot(OneShot::Skip));
        if !is_machine_move || is_skip || !context.names_axis(words) || unit.call_in(block).is_some() {
            continue;
        }
        let Some(before) = modes_before(context, unit)[block] else { continue };
        let distances = context.g_code_rows(words).filter_map(|row| match row.effect {
            Effect::Distance(distance) => Some(distance == Distance::Absolute),
            _ => None,
        });
        if !distances.last().unwrap_or(before.is_absolute) {
            let message = "G53 in G91 is ignored: the axes of the block do not move";
            let help = "command G90 with G53, or give --control G53-IN-G91=1 for a control that moves by the increment";
            found.push(unit.finding(&RULE.kind, block, message).help(help));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn g53_is_reported_where_g91_is_certain() {
        assert_eq!(lines(&RULE, "O1\nG91 G53 G00 X5.\nG90\nM30\n"), [2]);
        assert_eq!(lines(&RULE, "O1\nG91\nG00 X1.\nG53 Z0.\nG53 G90 Z0.\nG53 Z0.\nM30\n"), [4]);
        assert_eq!(lines(&RULE, "O1\nG91\nIF[#500 EQ 1]GOTO 5\nG90\nN5 G53 Z0.\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\nG91\nM98 P7\nG53 Z0.\nM30\n"), NOWHERE, "O7 may command G90");
        assert_eq!(lines(&RULE, "O1\nG91\nG53\nG#1\nG53 Z0.\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O2\nG53 Z0.\nM99\n"), NOWHERE, "its caller decides");
    }
}
