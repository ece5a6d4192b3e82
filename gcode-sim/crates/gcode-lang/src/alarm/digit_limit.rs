//! Limits of the digits of a number.

/// Most digits that the control allows a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DigitLimit {
    /// Digits as they are written.
    Written(u8),
    /// Nine digits after the conversion to increments.
    Increments,
}

impl DigitLimit {
    /// Returns what the alarm says.
    pub(super) fn message(self) -> String {
        match self {
            Self::Written(digits) => format!("too many digits: the control allows {digits} here"),
            Self::Increments => "too many digits: the control allows 9 in increments".into(),
        }
    }

    /// Returns the remedy.
    pub(super) const fn help(self) -> &'static str {
        match self {
            Self::Written(_) => "write a shorter number; a decimal point may be missing",
            Self::Increments => "write a smaller value: at 0.001 mm at most 999999.999",
        }
    }
}
