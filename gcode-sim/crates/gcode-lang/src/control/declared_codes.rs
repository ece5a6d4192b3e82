//! Codes of a machine builder whose effect the user declares: `G120.1 = "nothing"`.
use std::collections::BTreeMap;

/// Declared effect of a code that no call and no table of the control has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclaredEffect {
    /// Nothing moves and nothing is set.
    Nothing,
    /// As [`DeclaredEffect::Nothing`]; the block waits for the end of the moves before it.
    Wait,
}

impl DeclaredEffect {
    /// All effects with their names.
    pub const ALL: [(&'static str, Self); 2] = [("nothing", Self::Nothing), ("wait", Self::Wait)];
}

/// Declared effects by letter, G or M, and code × 10.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeclaredCodes(BTreeMap<(u8, u32), DeclaredEffect>);

impl DeclaredCodes {
    /// Returns the declared effect of a code × 10.
    pub fn find(&self, letter: u8, code: u32) -> Option<DeclaredEffect> {
        self.0.get(&(letter, code)).copied()
    }

    /// Declares a code, `G120.1` or `M77`; `None` for a text that is no code.
    pub(super) fn set(&mut self, key: &str, effect: DeclaredEffect) -> Option<()> {
        let letter = key.bytes().next()?.to_ascii_uppercase();
        let tenths = (key.get(1..)?.trim().parse::<f64>().ok()? * 10.0).round();
        let is_code = match letter {
            b'G' => (1.0..=99_999.0).contains(&tenths),
            b'M' => (10.0..=999_999_990.0).contains(&tenths) && tenths % 10.0 == 0.0,
            _ => false,
        };
        is_code.then(|| self.0.insert((letter, tenths as u32), effect)).map(|_| ())
    }
}
