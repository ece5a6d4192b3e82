//! Colours and line styles of the pens and statuses: Okabe and Ito's palette, safe for colour-blind readers,
//! on white.
//!
//! Colour never carries meaning alone: every status has its own shape and mark (`symbol`), every pen its own
//! width or dash pattern.
use super::ink::{Dash, Rgb};
use super::role::{HoleStatus, Pen};

pub(super) const PAPER: Rgb = Rgb(255, 255, 255);
pub(super) const TEXT: Rgb = Rgb(0, 0, 0);
pub(super) const SOFT_TEXT: Rgb = Rgb(70, 70, 70);
pub(super) const RULE: Rgb = Rgb(150, 150, 150);
/// Leaders, direction arrows, the circle of the tolerance zone.
pub(super) const THIN: Rgb = Rgb(90, 90, 90);

/// Tolerance band of a graph.
pub(super) const BAND: Rgb = Rgb(238, 238, 238);

pub(super) fn status_colour(standing: HoleStatus) -> Rgb {
    match standing {
        HoleStatus::Good => Rgb(0, 114, 178),
        HoleStatus::Bad => Rgb(213, 94, 0),
        HoleStatus::Missing => Rgb(0, 0, 0),
        HoleStatus::Extra => Rgb(230, 159, 0),
        HoleStatus::Unjudged => Rgb(90, 90, 90),
    }
}

/// Returns colour, width and dash pattern of a pen at a text height of `text` pixels.
pub(super) fn pen(pen: Pen, text: f64) -> (Rgb, f64, Dash) {
    match pen {
        Pen::Outline => (Rgb(0, 0, 0), 0.13 * text, Dash::Solid),
        Pen::Construction => (Rgb(120, 120, 120), 0.06 * text, Dash::Pattern([0.55 * text, 0.4 * text])),
        Pen::Scale => (Rgb(120, 120, 120), 0.06 * text, Dash::Solid),
        Pen::Feed => (Rgb(0, 158, 115), 0.1 * text, Dash::Solid),
        Pen::Faulty => (Rgb(213, 94, 0), 0.24 * text, Dash::Solid),
        Pen::Hidden => (Rgb(213, 94, 0), 0.08 * text, Dash::Pattern([0.4 * text, 0.3 * text])),
        Pen::Rapid => (Rgb(86, 180, 233), 0.07 * text, Dash::Pattern([0.25 * text, 0.25 * text])),
        Pen::Unchanged => (Rgb(150, 150, 150), 0.07 * text, Dash::Solid),
        Pen::New => (Rgb(213, 94, 0), 0.24 * text, Dash::Solid),
        Pen::Old => (Rgb(0, 0, 0), 0.09 * text, Dash::Pattern([0.4 * text, 0.3 * text])),
        Pen::Grid => (Rgb(205, 205, 205), 0.05 * text, Dash::Solid),
        Pen::First => (Rgb(0, 0, 0), 0.12 * text, Dash::Pattern([0.8 * text, 0.5 * text])),
        Pen::Measured => (Rgb(0, 114, 178), 0.14 * text, Dash::Solid),
        Pen::Others => (Rgb(150, 150, 150), 0.05 * text, Dash::Solid),
        Pen::Limit => (Rgb(213, 94, 0), 0.12 * text, Dash::Pattern([0.8 * text, 0.5 * text])),
        Pen::Second => (Rgb(204, 121, 167), 0.14 * text, Dash::Pattern([0.22 * text, 0.3 * text])),
    }
}
