//! Small line drawings as SVG; mm of the part are mapped to paper units, y upwards.
use maud::{Markup, html};

/// Width of every drawing in its own units; text is 12 units high.
pub(super) const WIDTH: f64 = 480.0;

/// Origin and scale of a drawing on the paper.
#[derive(Clone, Copy)]
pub(super) struct Paper {
    pub origin: [f64; 2],
    pub scale: f64,
}

impl Paper {
    pub(super) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [self.origin[0] + x * self.scale, self.origin[1] - y * self.scale]
    }
}

/// Formats paper units to a tenth.
fn unit(value: f64) -> String {
    format!("{value:.1}")
}

/// Wraps the content into a drawing of this height, with a description for screen readers.
pub(super) fn drawing(height: f64, words: &str, content: Markup) -> Markup {
    html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {WIDTH} {}", unit(height))) role="img"
            font-size="12" font-family="DejaVu Sans, Arial, sans-serif" fill="none" stroke="#111" stroke-width="1.2" {
            title { (words) }
            (content)
        }
    }
}

pub(super) fn line(from: [f64; 2], to: [f64; 2]) -> Markup {
    html! { line x1=(unit(from[0])) y1=(unit(from[1])) x2=(unit(to[0])) y2=(unit(to[1])) {} }
}

/// Draws a thin line, as a leader or a dimension.
pub(super) fn thin(from: [f64; 2], to: [f64; 2]) -> Markup {
    html! { g stroke="#555" stroke-width="0.6" { (line(from, to)) } }
}

/// Draws the centre line of an axis of revolution.
pub(super) fn centre_line(from: [f64; 2], to: [f64; 2]) -> Markup {
    html! { g stroke="#555" stroke-width="0.8" stroke-dasharray="12 3 2 3" { (line(from, to)) } }
}

/// Draws a tool or its path as an arrow whose tip is at `to`.
pub(super) fn arrow(from: [f64; 2], to: [f64; 2]) -> Markup {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let long = (dx * dx + dy * dy).sqrt().max(1e-9);
    let (ux, uy) = (dx / long, dy / long);
    let corner = |aside: f64| [to[0] - 9.0 * ux - aside * uy, to[1] - 9.0 * uy + aside * ux];
    let (left, right) = (corner(3.5), corner(-3.5));
    let head = format!(
        "M{} {}L{} {}L{} {}Z",
        unit(to[0]),
        unit(to[1]),
        unit(left[0]),
        unit(left[1]),
        unit(right[0]),
        unit(right[1])
    );
    html! { g stroke="#0072b2" { (line(from, to)) path d=(head) fill="#0072b2" stroke="none" {} } }
}

pub(super) fn path(data: &str) -> Markup {
    html! { path d=(data) {} }
}

#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

pub(super) fn text(at: [f64; 2], anchor: Anchor, words: &str) -> Markup {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    html! { text x=(unit(at[0])) y=(unit(at[1])) text-anchor=(anchor) fill="#111" stroke="none" { (words) } }
}

/// Draws the symbol of the work zero: a circle with two black quarters.
pub(super) fn zero_sign([x, y]: [f64; 2]) -> Markup {
    let quarters = format!(
        "M{x} {y}L{x} {}A8 8 0 0 1 {} {y}ZM{x} {y}L{x} {}A8 8 0 0 1 {} {y}Z",
        unit(y - 8.0),
        unit(x + 8.0),
        unit(y + 8.0),
        unit(x - 8.0),
        x = unit(x),
        y = unit(y)
    );
    html! {
        circle cx=(unit(x)) cy=(unit(y)) r="8" fill="#fff" {}
        path d=(quarters) fill="#111" stroke="none" {}
    }
}
