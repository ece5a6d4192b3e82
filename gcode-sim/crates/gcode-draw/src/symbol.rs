//! Symbols as paths: status symbols that are distinct without colour, arrows, the position symbol.
use super::ink::{Dash, DrawCommand, Px, Rgb, px};
use super::palette;
use super::role::HoleStatus;
use gcode_lang::units::Deg;

/// Draws the symbol of a status, `radius` pixels large. Each differs from the others in outline and mark: ✓
/// in a disc, ✗ in a square, an empty dashed ring, + in a triangle, a dot in a ring.
pub(super) fn status_sign(standing: HoleStatus, at: Px, radius: f64) -> Vec<DrawCommand> {
    let color = palette::status_colour(standing);
    let stroke = (radius * 0.3).max(1.2);
    match standing {
        _ if radius < DOT => hole(standing, at, radius, [0.0, 1.0], 1.0),
        HoleStatus::Good => vec![
            DrawCommand::Disc { centre: at, radius, color },
            path(at, radius, &[[-0.5, 0.02], [-0.14, 0.42], [0.52, -0.4]], stroke, palette::PAPER),
        ],
        HoleStatus::Bad => {
            let s = radius * 0.95;
            let corners = [[-s, -s], [s, -s], [s, s], [-s, s]].map(|[x, y]| px(at.x + x, at.y + y));
            vec![
                DrawCommand::Area { points: corners.to_vec(), color },
                path(at, radius, &[[-0.45, -0.45], [0.45, 0.45]], stroke, palette::PAPER),
                path(at, radius, &[[-0.45, 0.45], [0.45, -0.45]], stroke, palette::PAPER),
            ]
        }
        HoleStatus::Missing => {
            let width = (radius * 0.3).max(1.5);
            let inner = radius * 1.1 - width / 2.0;
            let eighth = inner * std::f64::consts::TAU / 8.0;
            let dash = Dash::Pattern([eighth * 0.62, eighth * 0.38]);
            vec![
                DrawCommand::Disc { centre: at, radius, color: palette::PAPER },
                DrawCommand::Ring { centre: at, radius: inner, width, dash, color },
            ]
        }
        HoleStatus::Extra => {
            let corners = [[0.0, -1.15], [1.1, 0.8], [-1.1, 0.8]];
            let points: Vec<_> =
                corners.iter().map(|[x, y]| px(at.x + x * radius, at.y + y * radius)).collect();
            let width = (radius * 0.18).max(1.0);
            let edge = DrawCommand::Line {
                points: points.clone(),
                closed: true,
                width,
                dash: Dash::Solid,
                color: palette::TEXT,
            };
            vec![
                DrawCommand::Area { points, color },
                edge,
                path(at, radius, &[[-0.4, 0.2], [0.4, 0.2]], width, palette::TEXT),
                path(at, radius, &[[0.0, -0.2], [0.0, 0.6]], width, palette::TEXT),
            ]
        }
        HoleStatus::Unjudged => {
            let width = (radius * 0.22).max(1.2);
            vec![
                DrawCommand::Disc { centre: at, radius, color: palette::PAPER },
                DrawCommand::Ring {
                    centre: at,
                    radius: radius - width / 2.0,
                    width,
                    dash: Dash::Solid,
                    color,
                },
                DrawCommand::Disc { centre: at, radius: radius * 0.25, color },
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
pub(super) fn hole(
    standing: HoleStatus,
    at: Px,
    radius: f64,
    along: [f64; 2],
    flat: f64,
) -> Vec<DrawCommand> {
    let low = (flat * radius).max(0.4 * LEAST_HOLE);
    let seen = |[x, y]: [f64; 2]| at.toward(along, low * y).toward([along[1], -along[0]], radius * x);
    let round = || (0..24u8).map(|n| Deg(15.0 * f64::from(n))).map(|turn| [turn.cos(), turn.sin()]).map(seen);
    let color = palette::status_colour(standing);
    match standing {
        HoleStatus::Good => vec![DrawCommand::Area { points: round().collect(), color }],
        HoleStatus::Bad => {
            let corners = [[-0.95, -0.95], [0.95, -0.95], [0.95, 0.95], [-0.95, 0.95]];
            vec![DrawCommand::Area { points: corners.map(seen).to_vec(), color }]
        }
        HoleStatus::Extra => {
            let corners = [[0.0, -1.4], [1.3, 0.9], [-1.3, 0.9]];
            vec![DrawCommand::Area { points: corners.map(seen).to_vec(), color }]
        }
        HoleStatus::Missing | HoleStatus::Unjudged => {
            let points = round().collect();
            vec![DrawCommand::Line { points, closed: true, width: 1.0, dash: Dash::Solid, color }]
        }
    }
}

/// Draws a line with a head at its end.
pub(super) fn arrow(from: Px, to: Px, width: f64, head: f64, color: Rgb) -> Vec<DrawCommand> {
    let length = from.distance(to).max(1e-9);
    let along = [(to.x - from.x) / length, (to.y - from.y) / length];
    let across = [-along[1], along[0]];
    let neck = to.toward(along, -head);
    let points = vec![to, neck.toward(across, head * 0.36), neck.toward(across, -head * 0.36)];
    vec![DrawCommand::line(from, neck, width, color), DrawCommand::Area { points, color }]
}

/// Draws ⌖ of ISO 1101: a circle with crosshairs that reach beyond it.
pub(super) fn position(at: Px, radius: f64, width: f64, color: Rgb) -> Vec<DrawCommand> {
    vec![
        DrawCommand::Ring { centre: at, radius: radius * 0.62, width, dash: Dash::Solid, color },
        path(at, radius, &[[-1.0, 0.0], [1.0, 0.0]], width, color),
        path(at, radius, &[[0.0, -1.0], [0.0, 1.0]], width, color),
    ]
}

/// Returns the unit direction on the sheet at an angle counter-clockwise from the right.
pub(super) fn direction(angle: Deg) -> [f64; 2] {
    [angle.cos(), -angle.sin()]
}

fn path(at: Px, radius: f64, points: &[[f64; 2]], width: f64, color: Rgb) -> DrawCommand {
    let points = points.iter().map(|[x, y]| px(at.x + x * radius, at.y + y * radius)).collect();
    DrawCommand::Line { points, closed: false, width, dash: Dash::Solid, color }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Describes a symbol without colours, as in a photocopy: kinds of command and number of points.
    fn shape(of: HoleStatus) -> Vec<String> {
        let inks = status_sign(of, px(0.0, 0.0), 10.0);
        let kinds = inks.iter().map(|ink| match ink {
            DrawCommand::Line { points, dash, .. } => format!("line {} {dash:?}", points.len()),
            DrawCommand::Area { points, .. } => format!("area {}", points.len()),
            DrawCommand::Ring { dash, .. } => format!("ring {dash:?}"),
            DrawCommand::Disc { radius, .. } => format!("disc {radius}"),
            DrawCommand::Text { text, .. } => format!("text {text}"),
        });
        kinds.collect()
    }

    #[test]
    fn dots_differ_by_more_than_colour_too() {
        let dots = [HoleStatus::Good, HoleStatus::Bad, HoleStatus::Missing, HoleStatus::Extra];
        let kinds = dots.map(|of| {
            format!("{:?}", status_sign(of, px(0.0, 0.0), 2.0)).split("color").next().map(str::to_owned)
        });
        for (i, a) in kinds.iter().enumerate() {
            assert!(kinds[i + 1..].iter().all(|b| a != b), "{a:?}");
        }
    }

    #[test]
    fn verdicts_differ_by_more_than_colour() {
        let all =
            [HoleStatus::Good, HoleStatus::Bad, HoleStatus::Missing, HoleStatus::Extra, HoleStatus::Unjudged];
        for (i, a) in all.iter().enumerate() {
            for b in &all[i + 1..] {
                assert_ne!(shape(*a), shape(*b), "{a:?} {b:?}");
            }
        }
    }
}
