//! Sheets: drawing commands at their positions on the paper, ready to be written.
use super::ink::{DrawCommand, Rect};

/// A laid-out drawing: every command has its position in pixels or another unit of the paper.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// The paper, from 0 on.
    pub(super) page: Rect,
    pub(super) commands: Vec<DrawCommand>,
    /// Labels of holes and lines with their boxes; none overlaps another.
    pub labels: Vec<(Rect, Vec<String>)>,
    /// Omissions that the picture itself states.
    pub notes: Vec<String>,
    /// Magnification of deviations; `None` if none is drawn.
    pub magnification: Option<f64>,
}

impl Sheet {
    pub(super) fn empty(page: Rect) -> Self {
        Self { page, commands: Vec::new(), labels: Vec::new(), notes: Vec::new(), magnification: None }
    }
}
