//! What a block commands that would otherwise be as it was left: modal codes, the places of axes, offsets.
use super::control::Control;
use super::registers::Registers;
use super::words::computed_row;
use gcode_lang::program::code_facts::AxisWords;
use gcode_lang::program::g_codes::{self, Effect};
use gcode_lang::program::modes::Distance;
use gcode_lang::program::{OpKind, Statement, Words};

/// Of a block that is about to be done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockCommands {
    /// The group of each modal code, and the code × 10.
    pub modes: Vec<(u32, u32)>,
    /// The letters of axes that are sent to a place, wherever they stand.
    pub axes: Vec<char>,
    /// Offsets that get a value by G10: `G10 L2 P1 X`.
    pub offsets: Vec<String>,
    /// Those of the letters F, S and T that it gives a value.
    pub valued_letters: Vec<char>,
}

impl Control {
    /// What [`Control::next_block`] commands; nothing for a block that is skipped.
    pub fn next_commands(&self) -> BlockCommands {
        let mut commands = BlockCommands::default();
        self.inspect_next(|registers, op| {
            if registers.is_skipped(op) {
                return;
            }
            if let OpKind::Words(words) = registers.guarded_operation(op.kind()) {
                registers.collect_commands(words, &mut commands);
            }
        });
        commands
    }

    /// Whether [`Control::next_block`] will do all that it says: it isn't skipped, and no condition stands in the way.
    pub fn is_next_unconditional(&self) -> bool {
        let is_unconditional = self.inspect_next(|registers, op| {
            let condition = match op.kind() {
                OpKind::If { condition, .. }
                | OpKind::Statement(
                    Statement::IfGoto { condition, .. } | Statement::IfThen { condition, .. },
                ) => Some(condition),
                OpKind::Empty
                | OpKind::Words(_)
                | OpKind::Statement(_)
                | OpKind::AssignFree(_)
                | OpKind::Alarm(_) => None,
            };
            let is_true =
                condition.is_none_or(|condition| registers.evaluate_condition(condition).unwrap_or(true));
            is_true && !registers.is_skipped(op)
        });
        is_unconditional.unwrap_or(true)
    }
}

impl Registers {
    fn collect_commands(&self, words: &Words, commands: &mut BlockCommands) {
        // Behind G65 and M98 letters are arguments.
        if words.call().is_some() {
            return;
        }
        let words = match words.skipped_form() {
            Some((switch, short)) if self.data.is_skip_on(*switch) => short,
            _ => words,
        };
        let mut distance = self.state.modal.distance;
        let mut axis_words = AxisWords::Move;
        for word in words.list.iter().filter(|word| word.letter == b'G') {
            let Ok(Some(raw)) = self.evaluate_word(words, word) else { continue };
            let Ok(row) = computed_row(raw, self.data.settings.codes) else { continue };
            if let Effect::Distance(new) = row.effect {
                distance = new;
            }
            match row.facts.axis_words {
                AxisWords::Move | AxisWords::Hole => {}
                own @ (AxisWords::Position
                | AxisWords::PositionInAbsolute
                | AxisWords::Tables
                | AxisWords::Other) => axis_words = own,
            }
            commands.modes.extend(row.group().map(|group| (group, row.code)));
        }
        let values = words.list.iter().filter(|word| b"FST".contains(&word.letter) && !word.comma);
        let values = values.filter(|word| matches!(self.evaluate_word(words, word), Ok(Some(_))));
        commands.valued_letters.extend(values.map(|word| char::from(word.letter)));
        if axis_words == AxisWords::Tables {
            self.collect_written_offsets(words, commands);
        } else if is_axis_positioned(axis_words, distance) {
            let letters = words.list.iter().filter(|word| !word.comma && word.axis.is_none());
            let valued = letters.filter(|word| matches!(self.evaluate_word(words, word), Ok(Some(_))));
            let axes = valued.filter(|word| self.data.settings.axes.find(word.letter).is_some());
            commands.axes.extend(axes.map(|word| char::from(word.letter)));
        }
    }

    /// `G10 L2 P1 X`, for every value that the block gives.
    fn collect_written_offsets(&self, words: &Words, commands: &mut BlockCommands) {
        let mut table = "G10".to_owned();
        for letter in *b"LP" {
            let word = words.list.iter().find(|word| word.letter == letter && !word.comma);
            let raw = word.and_then(|word| self.evaluate_word(words, word).ok().flatten());
            if let Some(raw) = raw {
                table.push_str(&format!(" {}{}", char::from(letter), raw.value()));
            }
        }
        let values = words.list.iter().filter(|word| !b"GLPN".contains(&word.letter) && !word.comma);
        commands.offsets.extend(values.map(|word| format!("{table} {}", char::from(word.letter))));
    }
}

/// Whether the axes of a block end where it says, wherever they stood.
fn is_axis_positioned(axis_words: AxisWords, distance: Distance) -> bool {
    match axis_words {
        AxisWords::Position => true,
        AxisWords::Move | AxisWords::Hole | AxisWords::PositionInAbsolute => distance == Distance::Absolute,
        AxisWords::Tables | AxisWords::Other => false,
    }
}

/// A modal code as programs write it: `G90`, `G54.1`, `G00`.
pub fn modal_code(code: u32) -> String {
    g_codes::name(code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::seen_before;

    /// What a block commands, and whether it is done whole.
    fn said(block: &str) -> (BlockCommands, bool) {
        seen_before(block, |control| (control.next_commands(), control.is_next_unconditional()))
    }

    #[test]
    fn modal_codes_and_places_are_commanded() {
        let (commanded, _) = said("G90 G54 G0 X5. Y0");
        assert_eq!(commanded.modes, [(3, 900), (14, 540), (1, 0)]);
        assert_eq!(commanded.axes, ['X', 'Y']);
        assert!(said("G91 G0 X5.").0.axes.is_empty(), "by how far is no place");
        assert!(said("G92 X5.").0.axes.is_empty(), "no axis moves");
        assert_eq!(said("G91 G28 Z0").0.axes, ['Z']);
        assert_eq!(said("G10 L2 P1 X0 Y0").0.offsets, ["G10 L2 P1 X", "G10 L2 P1 Y"]);
        assert_eq!(said("G1 X1. F100 S500 M3").0.valued_letters, ['F', 'S']);
        assert!(said("G0 X1.").0.valued_letters.is_empty(), "F is as it was");
        assert_eq!([modal_code(0), modal_code(541)], ["G00", "G54.1"]);
    }

    #[test]
    fn what_a_condition_keeps_from_being_done_is_not_whole() {
        for block in ["IF[1 GT 2]THEN #3000=1", "IF[1 GT 2]GOTO 9", "N5 IF[#1 EQ 1]THEN #2=1"] {
            assert!(!said(block).1, "{block}");
        }
        for block in ["IF[1 LT 2]THEN #2=1", "#2=1", "G0 X1."] {
            assert!(said(block).1, "{block}");
        }
    }
}
