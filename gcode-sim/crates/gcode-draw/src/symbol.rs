//! Symbols as paths: status symbols that are distinct without colour, arrows, the position symbol.
use super::ink::{DrawCommand, Ink, Px, Rgb, px};
use super::palette;
use super::scene::{HoleStatus, Sign};
use super::side::Projection;
use gcode_lang::units::Deg;

/// Draws the symbol of a status, `radius` pixels large. Each differs from the others in outline and mark: ✓
/// in a disc, ✗ in a square, an empty dashed ring, + in a triangle, a dot in a ring.
pub(super) fn status_sign(status: HoleStatus, at: Px, radius: f64) -> Vec<DrawCommand> {
    let color = palette::status_colour(status);
    let disc = |radius: f64, color: Rgb| DrawCommand::Disc { centre: at, radius, color };
    let path = |points: &[[f64; 2]], ink: Ink| path(at, radius, points, ink);
    let cut = Ink::solid((radius * 0.3).max(1.2), palette::PAPER);
    match status {
        _ if radius < DOT => hole(status, at, radius, [0.0, 1.0], 1.0),
        HoleStatus::Good => {
            vec![disc(radius, color), path(&[[-0.5, 0.02], [-0.14, 0.42], [0.52, -0.4]], cut)]
        }
        HoleStatus::Bad => vec![
            area(at, radius, &[[-0.95, -0.95], [0.95, -0.95], [0.95, 0.95], [-0.95, 0.95]], color),
            path(&[[-0.45, -0.45], [0.45, 0.45]], cut),
            path(&[[-0.45, 0.45], [0.45, -0.45]], cut),
        ],
        HoleStatus::Missing => {
            let width = (radius * 0.3).max(1.5);
            let inner = radius * 1.1 - width / 2.0;
            let eighth = inner * std::f64::consts::TAU / 8.0;
            let ink = Ink::dashed(width, color, [eighth * 0.62, eighth * 0.38]);
            vec![disc(radius, palette::PAPER), DrawCommand::Ring { centre: at, radius: inner, ink }]
        }
        HoleStatus::Extra => {
            let corners = [[0.0, -1.15], [1.1, 0.8], [-1.1, 0.8]];
            let ink = Ink::solid(radius * 0.18, palette::TEXT);
            vec![
                area(at, radius, &corners, color),
                DrawCommand::outline(points(at, radius, &corners), ink),
                path(&[[-0.4, 0.2], [0.4, 0.2]], ink),
                path(&[[0.0, -0.2], [0.0, 0.6]], ink),
            ]
        }
        HoleStatus::Unjudged => {
            let ink = Ink::solid((radius * 0.22).max(1.2), color);
            vec![
                disc(radius, palette::PAPER),
                DrawCommand::Ring { centre: at, radius: radius - ink.width / 2.0, ink },
                disc(radius * 0.25, color),
            ]
        }
    }
}

/// Radius below which a symbol becomes a dot, pixels.
const DOT: f64 = 2.5;

/// Least visible radius of a hole, pixels.
pub(super) const LEAST_HOLE: f64 = 1.2;

/// Draws a hole to scale without a mark: a disc, a square, a ring, a triangle. `flat` is the ratio of its
/// height along `along` to its width, below 1 for a tilted hole.
pub(super) fn hole(status: HoleStatus, at: Px, radius: f64, along: [f64; 2], flat: f64) -> Vec<DrawCommand> {
    let low = (flat * radius).max(0.4 * LEAST_HOLE);
    let seen = |[x, y]: [f64; 2]| at.toward(along, low * y).toward([along[1], -along[0]], radius * x);
    let round = || (0..24u8).map(|n| Deg(15.0 * f64::from(n))).map(|turn| [turn.cos(), turn.sin()]).collect();
    let corners: Vec<[f64; 2]> = match status {
        HoleStatus::Good | HoleStatus::Missing | HoleStatus::Unjudged => round(),
        HoleStatus::Bad => vec![[-0.95, -0.95], [0.95, -0.95], [0.95, 0.95], [-0.95, 0.95]],
        HoleStatus::Extra => vec![[0.0, -1.4], [1.3, 0.9], [-1.3, 0.9]],
    };
    let (points, color) = (corners.into_iter().map(seen).collect(), palette::status_colour(status));
    vec![match status {
        HoleStatus::Missing | HoleStatus::Unjudged => DrawCommand::outline(points, Ink::solid(1.0, color)),
        HoleStatus::Good | HoleStatus::Bad | HoleStatus::Extra => DrawCommand::Area { points, color },
    }]
}

/// Draws a line with a head at its end.
pub(super) fn arrow(from: Px, to: Px, ink: Ink, head: f64) -> Vec<DrawCommand> {
    let length = from.distance(to).max(1e-9);
    let along = [(to.x - from.x) / length, (to.y - from.y) / length];
    let across = [-along[1], along[0]];
    let neck = to.toward(along, -head);
    let points = vec![to, neck.toward(across, head * 0.36), neck.toward(across, -head * 0.36)];
    vec![DrawCommand::line(from, neck, ink), DrawCommand::Area { points, color: ink.color }]
}

/// Draws ⌖ of ISO 1101: a circle with crosshairs that reach beyond it.
pub(super) fn position(at: Px, radius: f64, ink: Ink) -> Vec<DrawCommand> {
    vec![
        DrawCommand::Ring { centre: at, radius: radius * 0.62, ink },
        path(at, radius, &[[-1.0, 0.0], [1.0, 0.0]], ink),
        path(at, radius, &[[0.0, -1.0], [0.0, 1.0]], ink),
    ]
}

/// Draws the symbol of a zero point: a circle whose upper right and lower left quarters are black.
pub(super) fn zero(at: Px, radius: f64, ink: Ink) -> Vec<DrawCommand> {
    let quarter = |from: f64| {
        let rim = (0..=12).map(|n| direction(Deg(from + 7.5 * f64::from(n))));
        let points = std::iter::once(at).chain(rim.map(|out| at.toward(out, radius))).collect();
        DrawCommand::Area { points, color: ink.color }
    };
    vec![
        DrawCommand::Disc { centre: at, radius, color: palette::PAPER },
        DrawCommand::Ring { centre: at, radius, ink },
        quarter(0.0),
        quarter(180.0),
    ]
}

/// Draws the symbol of a place on a tool path: a triangle at the start, a square at the end, a pause in a square at a stop,
/// a cross at an alarm.
pub(super) fn sign(of: Sign, at: Px, radius: f64) -> Vec<DrawCommand> {
    let (color, width) = (palette::TEXT, (radius * 0.3).max(1.2));
    let ink = Ink::solid(width, color);
    let square = [[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]];
    match of {
        // Holes are round, and an extra one is a triangle that points up.
        Sign::Start => {
            let corners = [[-0.7, -1.0], [1.1, 0.0], [-0.7, 1.0]];
            let corners = points(at, radius, &corners);
            let rim = Ink::solid(3.0 * width, palette::PAPER);
            vec![
                DrawCommand::outline(corners.clone(), rim),
                DrawCommand::Area { points: corners.clone(), color: palette::PAPER },
                DrawCommand::outline(corners, ink),
            ]
        }
        Sign::End => vec![area(at, radius, &square, color)],
        Sign::Stop => vec![
            area(at, radius, &square, palette::PAPER),
            DrawCommand::outline(points(at, radius, &square), ink),
            path(at, radius, &[[-0.3, -0.4], [-0.3, 0.4]], ink),
            path(at, radius, &[[0.3, -0.4], [0.3, 0.4]], ink),
        ],
        Sign::Alarm => {
            let strokes = [[[-1.0, -1.0], [1.0, 1.0]], [[-1.0, 1.0], [1.0, -1.0]]];
            let halo = Ink::solid(3.0 * width, palette::PAPER);
            let cross = Ink::solid(1.6 * width, palette::VERMILION);
            [halo, cross]
                .into_iter()
                .flat_map(|ink| strokes.map(|ends| path(at, radius, &ends, ink)))
                .collect()
        }
    }
}

/// Draws the symbol of an arrangement of views: a truncated cone from the side and along its axis.
pub(super) fn projection(of: Projection, at: Px, text: f64) -> Vec<DrawCommand> {
    let ink = Ink::solid(0.07 * text, palette::TEXT);
    let (circles, cone) = match of {
        Projection::Third => (-0.45 * text, 0.5 * text),
        Projection::First => (0.45 * text, -0.5 * text),
    };
    let ring =
        |radius: f64| DrawCommand::Ring { centre: px(at.x + circles, at.y), radius: radius * text, ink };
    // The small end points to the circles in the third angle, which show what is nearest to them.
    let ends = [[-0.35, -0.2], [0.35, -0.4], [0.35, 0.4], [-0.35, 0.2]];
    let side = points(px(at.x + cone, at.y), text, &ends);
    vec![ring(0.4), ring(0.2), DrawCommand::outline(side, ink)]
}

/// Returns the unit direction on the sheet at an angle counter-clockwise from the right.
pub(super) fn direction(angle: Deg) -> [f64; 2] {
    [angle.cos(), -angle.sin()]
}

/// Returns points given in parts of a symbol's radius.
fn points(at: Px, radius: f64, points: &[[f64; 2]]) -> Vec<Px> {
    points.iter().map(|[x, y]| px(at.x + x * radius, at.y + y * radius)).collect()
}

fn path(at: Px, radius: f64, corners: &[[f64; 2]], ink: Ink) -> DrawCommand {
    DrawCommand::path(points(at, radius, corners), ink)
}

fn area(at: Px, radius: f64, corners: &[[f64; 2]], color: Rgb) -> DrawCommand {
    DrawCommand::Area { points: points(at, radius, corners), color }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Describes a symbol without colours, as in a photocopy: kinds of command and number of points.
    fn shape(of: HoleStatus, radius: f64) -> Vec<String> {
        let commands = status_sign(of, px(0.0, 0.0), radius);
        let kinds = commands.iter().map(|command| match command {
            DrawCommand::Line { points, ink, .. } => format!("line {} {:?}", points.len(), ink.dash),
            DrawCommand::Area { points, .. } => format!("area {}", points.len()),
            DrawCommand::Ring { ink, .. } => format!("ring {:?}", ink.dash),
            DrawCommand::Disc { radius, .. } => format!("disc {radius}"),
            DrawCommand::Text { text, .. } | DrawCommand::Halo { text, .. } => format!("text {text}"),
        });
        kinds.collect()
    }

    #[test]
    fn statuses_differ_by_more_than_colour_as_symbols_and_as_dots() {
        use HoleStatus::{Bad, Extra, Good, Missing, Unjudged};
        for (all, radius) in
            [(&[Good, Bad, Missing, Extra, Unjudged][..], 10.0), (&[Good, Bad, Missing, Extra], 2.0)]
        {
            for (i, a) in all.iter().enumerate() {
                for b in &all[i + 1..] {
                    assert_ne!(shape(*a, radius), shape(*b, radius), "{a:?} {b:?}");
                }
            }
        }
    }
}
