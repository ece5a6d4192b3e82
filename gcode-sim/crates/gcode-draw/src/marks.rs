//! Holes on the sheet: symbol, axis direction, and the dial that shows the deviation enlarged.
use super::deviation_dials::{Detail, DeviationDials, MIN_SIGN_DISTANCE};
use super::ink::{DrawCommand, Ink, Px};
use super::labels::LabelArea;
use super::measure::Frame;
use super::obstacle::Obstacle;
use super::palette;
use super::scene::{HoleStatus, Mark, Scene, ZoneDeviation};
use super::symbol;
use gcode_lang::units::Deg;

/// A drawn hole.
#[derive(Clone, Debug)]
pub(super) struct DrawnMark {
    pub(super) centre: Px,
    /// Least distance of labels from the centre, pixels.
    pub(super) label_clearance: f64,
    /// Whether symbols overlap, so that a label needs a leader to the exact centre.
    pub(super) is_crowded: bool,
    pub(super) commands: Vec<DrawCommand>,
    /// Whether the deviation is longer than drawn.
    pub(super) is_truncated: bool,
    /// Whether a dotted line leads to the actual position instead.
    pub(super) has_displacement_line: bool,
    /// Whether the axis is drawn.
    pub(super) has_axis_arrow: bool,
}

/// Largest drawn deviation, in radii of the tolerance zone.
const MAX_DEVIATION_RADII: f64 = 1.7;

/// Draws the holes and blocks their positions for labels.
pub(super) fn draw_marks(
    scene: &Scene,
    frame: &Frame,
    dials: &DeviationDials,
    field: &mut LabelArea,
) -> Vec<DrawnMark> {
    let mut drawn: Vec<DrawnMark> = Vec::new();
    for (index, mark) in scene.marks.iter().enumerate() {
        let hole = match (dials.dial(index), mark.deviation) {
            (Some(dial), Some(deviation)) => {
                draw_dial(mark, deviation, dial, dials.badge(index, frame.text_size), frame, field)
            }
            _ => draw_sign(mark, index, frame, dials, &drawn, field),
        };
        field.block(Obstacle::Disc { centre: hole.centre, radius: hole.label_clearance });
        drawn.push(hole);
    }
    drawn
}

/// Draws the zone's circle with the hole in its centre, the deviation, and the status symbol on the rim.
fn draw_dial(
    mark: &Mark,
    deviation: ZoneDeviation,
    (times, zone): (f64, f64),
    badge: f64,
    frame: &Frame,
    field: &mut LabelArea,
) -> DrawnMark {
    let text = frame.text_size;
    let centre = frame.scale.px(mark.position);
    let hole = (mark.radius * frame.scale.factor).max(0.28 * text);
    let mut inks = Vec::new();
    // A zone within its hole would hide the path there, and the circles of its features.
    if mark.rim == 0.0 && hole < zone {
        inks.push(DrawCommand::Disc { centre, radius: zone, color: palette::PAPER });
    }
    inks.extend([
        DrawCommand::Ring { centre, radius: zone, ink: palette::zone(text) },
        DrawCommand::Ring { centre, radius: hole, ink: palette::thin(text, palette::TEXT) },
    ]);
    let (mut cut, mut strayed) = (false, false);
    match mark.actual.map(|found| frame.scale.px(found)) {
        Some(found) if 2.0 * zone < centre.distance(found) => {
            inks.extend(displacement_line(centre, found, hole, text, field));
            strayed = true;
        }
        _ => {
            let enlarge = times * frame.scale.factor;
            let (lines, beyond) = deviation_commands(mark.status, deviation, enlarge, centre, zone, text);
            inks.extend(lines);
            if let Some(tip) = beyond {
                field.block(Obstacle::Segment(centre, tip));
                cut = true;
            }
        }
    }
    let directed = projected_axis(mark).is_some();
    let mut taken = Vec::new();
    let [right, up] = deviation.entry;
    if zone / 3.0 < libm::hypot(right, up) * times * frame.scale.factor {
        taken.push(Deg::atan2(up, right));
    }
    if let Some((along, projected)) = projected_axis(mark) {
        inks.extend(axis_arrow(centre, along, projected, zone, text, field));
        taken.push(Deg::atan2(-along[1], along[0]));
    }
    let at = centre.toward(symbol::direction(badge_angle(&taken)), zone);
    inks.extend(symbol::status_sign(mark.status, at, badge));
    field.block(Obstacle::Disc { centre: at, radius: badge * 1.2 });
    DrawnMark {
        centre,
        label_clearance: zone.max(rim(mark, frame)) + 0.15 * text,
        is_crowded: false,
        commands: inks,
        is_truncated: cut,
        has_displacement_line: strayed,
        has_axis_arrow: directed,
    }
}

/// Draws a dotted line to the actual position of a hole too far off to need enlarging.
fn displacement_line(centre: Px, found: Px, hole: f64, text: f64, field: &mut LabelArea) -> [DrawCommand; 2] {
    let radius = hole.max(0.3 * text);
    field.block(Obstacle::Disc { centre: found, radius: radius + 0.1 * text });
    field.block(Obstacle::Segment(centre, found));
    displacement_commands(centre, found, radius, text)
}

/// Draws a dotted line and a circle at its end.
pub(super) fn displacement_commands(from: Px, to: Px, radius: f64, text: f64) -> [DrawCommand; 2] {
    let ink = palette::thin(text, palette::TEXT);
    let dotted = Ink::dashed(ink.width, ink.color, [0.15 * text, 0.2 * text]);
    [DrawCommand::line(from, to, dotted), DrawCommand::Ring { centre: to, radius, ink }]
}

/// Draws lines from the centre to the deviation at the entry and on to that at the bottom: a tilted hole
/// shows as a line across its dial. A deviation longer than drawn ends in an arrow, whose tip is returned.
fn deviation_commands(
    status: HoleStatus,
    deviation: ZoneDeviation,
    enlarge: f64,
    centre: Px,
    zone: f64,
    text: f64,
) -> (Vec<DrawCommand>, Option<Px>) {
    let ink = Ink::solid((0.12 * text).max(1.4), palette::status_colour(status));
    let mut inks = Vec::new();
    let mut beyond = None;
    let ends = [deviation.entry, deviation.bottom].map(|[right, up]| {
        let (x, y) = (right * enlarge, -up * enlarge);
        let length = libm::hypot(x, y);
        let short = (MAX_DEVIATION_RADII * zone / length).min(1.0);
        let end = centre.toward([x, y], short);
        if short < 1.0 {
            inks.extend(symbol::arrow(centre, end, ink, 0.6 * text));
            beyond = Some(end);
        } else {
            inks.push(DrawCommand::line(centre, end, ink));
        }
        end
    });
    inks.push(DrawCommand::line(ends[0], ends[1], ink));
    if beyond.is_none() {
        let (radius, color) = ((0.14 * text).max(1.6), ink.color);
        inks.push(DrawCommand::Disc { centre: ends[0], radius, color });
    }
    (inks, beyond)
}

/// Draws a hole without a dial: the symbol marks the position. The symbol of an extra hole on top of another
/// moves aside. One of hundreds is drawn to scale, foreshortened by its tilt.
fn draw_sign(
    mark: &Mark,
    index: usize,
    frame: &Frame,
    dials: &DeviationDials,
    before: &[DrawnMark],
    field: &mut LabelArea,
) -> DrawnMark {
    let text = frame.text_size;
    let nominal = frame.scale.px(mark.position);
    let true_radius = mark.radius * frame.scale.factor;
    let badge = dials.badge(index, text);
    let is_dot = dials.is_dot(index);
    let radius = match is_dot {
        true if 0.0 < true_radius => true_radius.max(symbol::LEAST_HOLE),
        true => badge,
        false => true_radius.min(1.2 * text).max(badge),
    };
    let mut inks = Vec::new();
    let mut centre = nominal;
    if mark.status == HoleStatus::Extra
        && !is_dot
        && let Some(other) = before.iter().find(|d| d.centre.distance(nominal) < MIN_SIGN_DISTANCE * text)
    {
        let step = other.label_clearance + radius + 0.3 * text;
        let free = |c: &Px| before.iter().all(|d| d.label_clearance + radius <= c.distance(d.centre));
        let mut around =
            (0..8).map(|i| other.centre.toward(symbol::direction(Deg(200.0 + 45.0 * f64::from(i))), step));
        if let Some(beside) = around.find(free) {
            inks.push(DrawCommand::line(nominal, beside, palette::thin(text, palette::TEXT)));
            centre = beside;
        }
    }
    if radius < true_radius {
        let ink = palette::thin(text, palette::TEXT);
        inks.push(DrawCommand::Ring { centre: nominal, radius: true_radius, ink });
    }
    let far = mark.actual.map(|found| frame.scale.px(found)).filter(|found| text < nominal.distance(*found));
    let strayed = far.is_some();
    if let Some(found) = far {
        inks.extend(displacement_line(nominal, found, true_radius, text, field));
    }
    if is_dot {
        let (along, projected) = projected_axis(mark).unwrap_or(([0.0, 1.0], 0.0));
        let flat = (1.0 - projected * projected).max(0.0).sqrt();
        inks.extend(symbol::hole(mark.status, centre, radius, along, flat));
    } else {
        inks.extend(symbol::status_sign(mark.status, centre, radius));
    }
    let direction = projected_axis(mark).filter(|_| dials.detail != Detail::SignsWithoutAxes && !is_dot);
    let directed = direction.is_some();
    if let Some((along, projected)) = direction {
        inks.extend(axis_arrow(centre, along, projected, radius * 1.15, text, field));
    }
    DrawnMark {
        centre,
        label_clearance: (radius * 1.2).max(rim(mark, frame)) + 0.15 * text,
        is_crowded: dials.is_crowded(index, text),
        commands: inks,
        is_truncated: false,
        has_displacement_line: strayed,
        has_axis_arrow: directed,
    }
}

/// Radius of a circle beyond which a label has room inside it, in text heights.
const WIDE_RIM: f64 = 3.0;

/// Returns the radius of the largest circle about a hole that labels must leave clear, pixels.
fn rim(mark: &Mark, frame: &Frame) -> f64 {
    let radius = mark.rim.max(mark.radius) * frame.scale.factor;
    if radius < WIDE_RIM * frame.text_size { radius } else { 0.0 }
}

/// Returns the sheet direction of the hole axis and its projected length; `None` if it points at the reader.
fn projected_axis(mark: &Mark) -> Option<([f64; 2], f64)> {
    let [right, up] = mark.direction?;
    let projected = libm::hypot(right, up);
    (0.02 < projected).then(|| ([right / projected, -up / projected], projected))
}

/// Returns true if the axis of a hole does not point at the reader.
pub(super) fn has_axis_arrow(mark: &Mark) -> bool {
    projected_axis(mark).is_some()
}

/// Draws the projected hole axis; the arrow is longer, the more the hole lies across the view.
fn axis_arrow(
    centre: Px,
    along: [f64; 2],
    projected: f64,
    from: f64,
    text: f64,
    field: &mut LabelArea,
) -> Vec<DrawCommand> {
    let start = centre.toward(along, from);
    let end = centre.toward(along, from + text * (0.55 + 1.3 * projected));
    field.block(Obstacle::Segment(start, end));
    symbol::arrow(start, end, Ink::solid(0.08 * text, palette::TEXT), 0.5 * text)
}

/// Chooses an angle on the dial's rim clear of arrow and deviation: upper right if possible.
fn badge_angle(taken: &[Deg]) -> Deg {
    let apart = |angle: f64, other: &Deg| {
        let turn = (angle - other.0).rem_euclid(360.0);
        turn.min(360.0 - turn)
    };
    let free = |angle: f64| taken.iter().map(|other| apart(angle, other)).fold(60.0, f64::min);
    let choices = [45.0, 135.0, -45.0, -135.0, 0.0, 180.0, 90.0, -90.0];
    // Equally free angles: the first wins.
    Deg(choices.into_iter().fold(45.0, |best, angle| if free(best) < free(angle) { angle } else { best }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verdict_covers_neither_arrow_nor_deviation() {
        assert_eq!(badge_angle(&[]), Deg(45.0));
        assert_eq!(badge_angle(&[Deg(10.0)]), Deg(135.0));
        assert_eq!(badge_angle(&[Deg(10.0), Deg(100.0)]), Deg(-135.0));
        assert_eq!(badge_angle(&[Deg(-170.0)]), Deg(45.0));
    }
}
