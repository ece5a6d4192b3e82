//! What every step of the layout needs, and what the drawing turns out to show.
use super::font::Font;
use super::measure::Scale;

/// Beyond so many holes labels could not be told apart: the most important ones get theirs.
pub(super) const LABEL_LIMIT: usize = 400;

/// What every step of the layout needs.
pub(super) struct Frame {
    pub(super) font: Font,
    /// Size of ordinary text, pixels.
    pub(super) text_size: f64,
    pub(super) scale: Scale,
    /// Radius in pixels beyond which a dial would hide the part.
    pub(super) largest_dial: f64,
    /// How far the axes' arrows reach beyond the part, pixels.
    pub(super) axis_reach: f64,
}

/// Which signs the drawing really has, for the legend.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegendUse {
    pub(super) magnification: Option<f64>,
    pub(super) directions: bool,
    pub(super) displacements: bool,
    /// Good holes are drawn as they are, without a sign.
    pub(super) has_plain_good: bool,
    /// And those that aren't.
    pub(super) has_plain_rest: bool,
}

impl LegendUse {
    /// No holes are drawn.
    pub(super) const NOTHING: Self = Self {
        magnification: None,
        directions: false,
        displacements: false,
        has_plain_good: false,
        has_plain_rest: false,
    };
}
