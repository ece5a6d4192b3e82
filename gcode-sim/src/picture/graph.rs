//! The numbers along the edges of a graph of degrees over degrees, both from 0 to 90.
use super::ink::{Align, Ink, px};
use super::palette;
use super::sheet::Frame;

/// Below the graph and at its left, at every line of the grid.
pub(super) fn numbers(frame: &Frame, grid: usize) -> Vec<Ink> {
    let text = frame.text;
    let number = |at: super::ink::Px, align: Align, degrees: usize| Ink::Text {
        at,
        align,
        size: text,
        text: format!("{degrees}°"),
        color: palette::TEXT,
    };
    let mut inks = Vec::new();
    for degrees in (0..=90).step_by(grid.max(1)) {
        let below = frame.scale.px([degrees as f64, 0.0]);
        inks.push(number(px(below.x, below.y + 1.4 * text), Align::Centre, degrees));
        let beside = frame.scale.px([0.0, degrees as f64]);
        inks.push(number(px(beside.x - 0.6 * text, beside.y + 0.36 * text), Align::Right, degrees));
    }
    inks
}
