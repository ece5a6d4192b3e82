//! Source of a tool length offset.

/// Source of a tool length offset: the code and its H.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum LengthCompensation {
    #[default]
    /// G49: no compensation.
    Off,
    /// G43 with this H.
    Plus(u32),
    /// G44 with this H.
    Minus(u32),
}

impl LengthCompensation {
    /// Returns H; `None` if there is no compensation, as by H0.
    pub fn number(self) -> Option<u32> {
        match self {
            Self::Off | Self::Plus(0) | Self::Minus(0) => None,
            Self::Plus(h) | Self::Minus(h) => Some(h),
        }
    }
}
