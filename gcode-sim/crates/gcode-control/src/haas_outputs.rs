//! Outputs of a Haas that M29, M59 and M69 name by P.
use super::functions::ExecResult;
use super::planner::Planner;
use gcode_lang::control::Dialect;

/// Variable of output 0 of a Haas, and the number of the last output.
const FIRST_OUTPUT: u32 = 12_000;
pub(super) const LAST_OUTPUT: u32 = 255;
const LAST_OUTPUT_VARIABLE: u32 = FIRST_OUTPUT + LAST_OUTPUT;

/// Variables of the outputs of a Haas before the NGC, which M59 and M69 name as they are.
const OLDER_OUTPUTS: std::ops::RangeInclusive<u32> = 1100..=1155;

impl Planner<'_> {
    /// Returns true for M29 P of a Haas, which taps rigidly without it: an output until the machine answers.
    pub(super) fn pulses_output(&self) -> bool {
        self.data.settings.codes == Dialect::HaasNgc && self.words.has(b'P')
    }

    /// Returns the variable of the output P of a Haas.
    pub(super) fn output_variable(&self, code: u32) -> ExecResult<u32> {
        match self.words.count(b'P')? {
            Some(output @ 0..=LAST_OUTPUT) => Ok(FIRST_OUTPUT + output),
            Some(output @ FIRST_OUTPUT..=LAST_OUTPUT_VARIABLE) => Ok(output),
            // The variables of older controls.
            Some(output) if OLDER_OUTPUTS.contains(&output) => Ok(output),
            _ => {
                let what = format!("M{code:02} without P0 to P255, P12000 to P12255 or P1100 to P1155");
                Err(self.not_simulated(what))
            }
        }
    }
}
