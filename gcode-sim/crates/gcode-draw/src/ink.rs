//! Drawing commands in pixels from the picture's top left corner.
use super::scene::Align;

/// A point of the sheet, pixels to the right and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Px {
    pub(super) x: f64,
    pub(super) y: f64,
}

/// Builds a [`Px`].
pub(super) const fn px(x: f64, y: f64) -> Px {
    Px { x, y }
}

impl Px {
    pub(super) fn distance(self, other: Self) -> f64 {
        libm::hypot(self.x - other.x, self.y - other.y)
    }

    /// Returns the point `length` pixels further in a direction.
    pub(super) fn toward(self, direction: [f64; 2], length: f64) -> Self {
        px(self.x + direction[0] * length, self.y + direction[1] * length)
    }
}

/// An axis-parallel rectangle, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub left: f64,
    /// Top edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Bottom edge.
    pub bottom: f64,
}

impl Rect {
    pub(super) fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self { left, top, right: left + width, bottom: top + height }
    }

    /// Returns the rectangle of this size round a middle.
    pub(super) fn around(middle: Px, (width, height): (f64, f64)) -> Self {
        Self::new(middle.x - width / 2.0, middle.y - height / 2.0, width, height)
    }

    /// Returns the least rectangle that contains a point and all others.
    pub(super) fn enclosing(first: Px, others: &[Px]) -> Self {
        others.iter().fold(Self::new(first.x, first.y, 0.0, 0.0), |all, p| Self {
            left: all.left.min(p.x),
            top: all.top.min(p.y),
            right: all.right.max(p.x),
            bottom: all.bottom.max(p.y),
        })
    }

    /// Returns the corners in order round the rectangle.
    pub(super) fn corners(&self) -> Vec<Px> {
        vec![
            px(self.left, self.top),
            px(self.right, self.top),
            px(self.right, self.bottom),
            px(self.left, self.bottom),
        ]
    }

    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn centre(&self) -> Px {
        px((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0)
    }

    #[must_use]
    pub(super) fn grown(&self, by: f64) -> Self {
        Self { left: self.left - by, top: self.top - by, right: self.right + by, bottom: self.bottom + by }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    pub(super) fn contains(&self, inner: &Self) -> bool {
        self.left <= inner.left
            && self.top <= inner.top
            && inner.right <= self.right
            && inner.bottom <= self.bottom
    }

    /// Returns the point of the rectangle that is nearest to `to`.
    pub(super) fn nearest(&self, to: Px) -> Px {
        px(to.x.clamp(self.left, self.right), to.y.clamp(self.top, self.bottom))
    }

    /// Returns the distance from `from` to the farthest corner.
    pub(super) fn farthest(&self, from: Px) -> f64 {
        let x = (from.x - self.left).abs().max((from.x - self.right).abs());
        let y = (from.y - self.top).abs().max((from.y - self.bottom).abs());
        libm::hypot(x, y)
    }
}

/// An opaque colour, sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rgb(pub(super) u8, pub(super) u8, pub(super) u8);

/// Colour, width in pixels and dash pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ink {
    pub(super) color: Rgb,
    pub(super) width: f64,
    /// Dash, gap, dash, gap, pixels; `None` for a solid line.
    pub(super) dash: Option<[f64; 4]>,
    /// Length of the dash pattern that precedes the line, pixels.
    pub(super) phase: f64,
}

impl Ink {
    pub(super) const fn solid(width: f64, color: Rgb) -> Self {
        Self { color, width, dash: None, phase: 0.0 }
    }

    pub(super) const fn dashed(width: f64, color: Rgb, [dash, gap]: [f64; 2]) -> Self {
        Self { color, width, dash: Some([dash, gap, dash, gap]), phase: 0.0 }
    }
}

/// Depth of letters below the base line, in sizes of the text.
const DESCENT: f64 = 0.22;

/// One drawing command; later ones cover earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum DrawCommand {
    Line {
        points: Vec<Px>,
        closed: bool,
        ink: Ink,
    },
    Area {
        points: Vec<Px>,
        color: Rgb,
    },
    Ring {
        centre: Px,
        radius: f64,
        ink: Ink,
    },
    Disc {
        centre: Px,
        radius: f64,
        color: Rgb,
    },
    /// Rim of paper about the letters of a text, so that it is legible on lines and hides little of them.
    Halo {
        at: Px,
        align: Align,
        size: f64,
        text: String,
    },
    /// Text with `at` on the base line; `size` is the em in pixels.
    Text {
        at: Px,
        align: Align,
        size: f64,
        text: String,
        color: Rgb,
    },
}

impl DrawCommand {
    pub(super) fn line(from: Px, to: Px, ink: Ink) -> Self {
        Self::path(vec![from, to], ink)
    }

    pub(super) fn path(points: Vec<Px>, ink: Ink) -> Self {
        Self::Line { points, closed: false, ink }
    }

    pub(super) fn outline(points: Vec<Px>, ink: Ink) -> Self {
        Self::Line { points, closed: true, ink }
    }

    /// Returns the ordinate of the lowest point.
    pub(super) fn bottom(&self) -> f64 {
        match self {
            Self::Line { points, .. } | Self::Area { points, .. } => {
                points.iter().map(|point| point.y).fold(f64::NEG_INFINITY, f64::max)
            }
            Self::Ring { centre, radius, .. } | Self::Disc { centre, radius, .. } => centre.y + radius,
            Self::Text { at, size, .. } | Self::Halo { at, size, .. } => at.y + DESCENT * size,
        }
    }

    /// Returns the width of the rim of a halo about text of this size.
    pub(super) fn halo_width(size: f64) -> f64 {
        (0.14 * size).max(1.5)
    }

    pub(super) fn text(at: Px, size: f64, text: impl Into<String>, color: Rgb) -> Self {
        Self::Text { at, align: Align::Left, size, text: text.into(), color }
    }
}
