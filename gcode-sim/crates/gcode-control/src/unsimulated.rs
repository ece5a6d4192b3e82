//! What a block says that moves nothing in a run and means something on a machine: block skips, codes without effect here.
use super::control::Control;
use super::registers::Registers;
use super::words::{computed_row, count};
use gcode_lang::program::code_facts::{Letters, Unsimulated};
use gcode_lang::program::g_codes;
use gcode_lang::program::m_codes::MCodeEffect;
use gcode_lang::program::{OpKind, WordOperand, Words, m_codes};

/// Of a block that is about to be done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnsimulatedCodes {
    /// `/`, `/3`: at its beginning or inside.
    pub block_skips: Vec<String>,
    /// How exactly corners are cut, and how far is read ahead: `G09`, `G05.1 Q1`.
    pub path_codes: Vec<String>,
    /// Other G codes without effect here: `G25`.
    pub g_codes: Vec<String>,
    /// Other M codes without effect here: `M29`.
    pub m_codes: Vec<String>,
    /// It may change offsets, parameters, outputs or counters.
    pub writes: bool,
    /// M02 or M30, by its number.
    pub end_code: Option<u32>,
}

impl Control {
    /// What [`Control::next_block`] says so; nothing for a block that is skipped.
    pub fn next_unsimulated(&self) -> UnsimulatedCodes {
        let mut unsimulated = UnsimulatedCodes::default();
        self.inspect_next(|registers, op| {
            if registers.is_skipped(op) {
                return;
            }
            unsimulated.block_skips.extend(op.skip().map(skip_text));
            match registers.guarded_operation(op.kind()) {
                OpKind::Words(words) => registers.collect_unsimulated(words, &mut unsimulated),
                OpKind::Statement(_) => {
                    unsimulated.writes = self.next_assigned_variables().iter().any(|number| *number >= 1000);
                }
                OpKind::Empty | OpKind::AssignFree(_) | OpKind::If { .. } | OpKind::Alarm(_) => {}
            }
        });
        unsimulated
    }
}

/// The first switch needs no number.
fn skip_text(switch: u8) -> String {
    if switch <= 1 { "/".to_owned() } else { format!("/{switch}") }
}

impl Registers {
    fn collect_unsimulated(&self, words: &Words, unsimulated: &mut UnsimulatedCodes) {
        unsimulated.writes |= self.state.is_in_parameter_input;
        let words = match words.skipped_form() {
            Some((switch, short)) if self.data.is_skip_on(*switch) => short,
            Some((switch, _)) => {
                unsimulated.block_skips.push(skip_text(*switch));
                words
            }
            None => words,
        };
        for word in words.list.iter().filter(|word| matches!(word.letter, b'G' | b'M')) {
            let Ok(Some(raw)) = self.evaluate_word(words, word) else { continue };
            if word.letter == b'M' {
                let Ok(code) = count(raw, b'M') else { continue };
                match m_codes::find(code, self.data.settings.codes) {
                    Some(MCodeEffect::NoEffect) => unsimulated.m_codes.push(format!("M{code:02}")),
                    Some(MCodeEffect::Orient) => {
                        unsimulated.m_codes.push(self.with_words(
                            words,
                            format!("M{code:02}"),
                            Letters::of(b"PR"),
                        ));
                    }
                    Some(MCodeEffect::End) => unsimulated.end_code = Some(code),
                    Some(
                        MCodeEffect::Stop
                        | MCodeEffect::OptionalStop
                        | MCodeEffect::SpindleForward
                        | MCodeEffect::SpindleReverse
                        | MCodeEffect::SpindleStop
                        | MCodeEffect::ToolChange
                        | MCodeEffect::CoolantOn
                        | MCodeEffect::CoolantOff
                        | MCodeEffect::InterruptOn
                        | MCodeEffect::InterruptOff
                        | MCodeEffect::Call
                        | MCodeEffect::NotSimulated,
                    )
                    | None => {}
                }
                continue;
            }
            let Ok(row) = computed_row(raw, self.data.settings.codes) else { continue };
            let text = |letters| self.with_words(words, g_codes::name(row.code), letters);
            match row.facts.unsimulated {
                Unsimulated::No => {}
                Unsimulated::Path(letters) => unsimulated.path_codes.push(text(letters)),
                Unsimulated::Code(letters) => unsimulated.g_codes.push(text(letters)),
                Unsimulated::Writes => unsimulated.writes = true,
            }
        }
    }

    /// A name and what stands behind these letters.
    fn with_words(&self, words: &Words, name: String, letters: Letters) -> String {
        let values = words.list.iter().filter(|word| letters.has(word.letter) && !word.comma);
        let shown = values.filter_map(|word| {
            if matches!(word.value, WordOperand::G(..)) {
                return None;
            }
            let value = self.evaluate_word(words, word).ok()??.value();
            Some(format!(" {}{value}", char::from(word.letter)))
        });
        name + &shown.collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::seen_before;

    fn said(block: &str) -> UnsimulatedCodes {
        seen_before(block, Control::next_unsimulated)
    }

    #[test]
    fn what_moves_nothing_is_seen() {
        assert_eq!(said("/G1 X1. F100").block_skips, ["/"]);
        assert_eq!(said("/3 M08").block_skips, ["/3"]);
        assert_eq!(said("G1 X1. F100 /2 Y5.").block_skips, ["/2"]);
        assert_eq!(said("G9 G1 X1. F100").path_codes, ["G09"]);
        assert_eq!(said("G5.1 Q1 R5").path_codes, ["G05.1 Q1 R5"]);
        assert_eq!(said("G8 P1").path_codes, ["G08 P1"]);
        assert_eq!(said("G25").g_codes, ["G25"]);
        assert_eq!(said("M29 S500").m_codes, ["M29"]);
        assert_eq!(said("M19 R90.").m_codes, ["M19 R90"]);
        assert_eq!(said("G91 G28 Z0").g_codes, ["G28"]);
        assert_eq!(said("G30 P3 Z0").g_codes, ["G30 P3"]);
        assert_eq!(said("G60 X5.").path_codes, ["G60"]);
        // The spindle stops, and stands at an angle.
        assert_eq!(said("M19").m_codes, ["M19"]);
    }

    #[test]
    fn what_may_change_offsets_says_so() {
        for block in ["G10 L2 P1 X5.", "G92 X0", "G52 X1.", "#5221=3.", "#2001=1."] {
            assert!(said(block).writes, "{block}");
        }
        for block in ["G1 X1. F100", "#500=3.", "G54", "G90 G0 X5."] {
            assert_eq!(said(block), UnsimulatedCodes::default(), "{block}");
        }
    }
}
