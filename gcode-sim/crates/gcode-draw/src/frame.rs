//! Values shared by all layout steps, and the symbols that the legend has to explain.
use super::font::Font;
use super::measure::Scale;

/// Largest number of labelled holes: more labels could not be told apart, and the most important ones are
/// kept.
pub(super) const LABEL_LIMIT: usize = 400;

/// Values shared by all layout steps.
pub(super) struct Frame {
    pub(super) font: Font,
    /// Size of ordinary text, pixels.
    pub(super) text_size: f64,
    pub(super) scale: Scale,
    /// Radius in pixels beyond which a dial would hide the part.
    pub(super) largest_dial: f64,
    /// Distance by which the axis arrows exceed the part, pixels.
    pub(super) axis_reach: f64,
}

/// Symbols that the drawing really contains, for the legend.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegendUse {
    pub(super) magnification: Option<f64>,
    pub(super) directions: bool,
    pub(super) displacements: bool,
    /// Whether good holes are drawn to scale, without a symbol.
    pub(super) has_plain_good: bool,
    /// Whether bad holes are drawn to scale, without a symbol.
    pub(super) has_plain_rest: bool,
}

impl LegendUse {
    /// Use of a drawing without holes.
    pub(super) const NOTHING: Self = Self {
        magnification: None,
        directions: false,
        displacements: false,
        has_plain_good: false,
        has_plain_rest: false,
    };
}
