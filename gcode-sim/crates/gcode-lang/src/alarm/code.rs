//! Designation of an alarm, and its row of the table.
use crate::diag::FindingKind;

/// Designation of an alarm: `PS0112`, `OT0500`, `MC3021` if the program raises it; `SIM…` if the simulator, not the
/// control, cannot continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlarmCode {
    /// Kind of finding, with code and page.
    pub kind: &'static FindingKind,
    /// Number of an alarm that the program raises: replaces the number in the kind's code.
    pub raised: Option<u16>,
}

impl AlarmCode {
    /// Returns the number without its letters.
    pub fn number(self) -> u32 {
        let digits = self.kind.code.trim_start_matches(|c: char| c.is_ascii_alphabetic());
        self.raised.map_or_else(|| digits.parse().unwrap_or_default(), u32::from)
    }
}

impl std::fmt::Display for AlarmCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.raised {
            Some(number) => write!(f, "MC{number:04}"),
            None => self.kind.fmt(f),
        }
    }
}

/// Designation, wording and remedy of an alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmRow {
    /// Designation.
    pub code: AlarmCode,
    /// Wording.
    pub message: String,
    /// Remedy: one instruction.
    pub help: Option<String>,
}
