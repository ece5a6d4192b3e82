//! Lines of the drawing: edges, circles, axes through the origin, and the scale bar.
use super::frame::Frame;
use super::ink::{Align, Dash, DrawCommand, Px, Rect, px};
use super::labels::LabelArea;
use super::measure::{bar_length, plain};
use super::obstacle::Obstacle;
use super::palette;
use super::role::{Pen, Point};
use super::scene::{Scene, Shape, Stroke};
use super::symbol;

/// Returns true for pens of the tool path, which labels may cover.
pub(super) fn is_path(pen: Pen) -> bool {
    matches!(pen, Pen::Feed | Pen::Faulty | Pen::Hidden | Pen::Rapid | Pen::Unchanged | Pen::New | Pen::Old)
}

pub(super) fn stroke_ink(stroke: &Stroke, frame: &Frame) -> DrawCommand {
    let (color, width, dash) = palette::pen(stroke.pen, frame.text_size);
    let width = width.max(1.0);
    match &stroke.shape {
        Shape::Line(points) => DrawCommand::Line {
            points: points.iter().map(|p| frame.scale.px(*p)).collect(),
            closed: false,
            width,
            dash,
            color,
        },
        Shape::Circle { centre, radius } => {
            let (centre, radius) = (frame.scale.px(*centre), radius * frame.scale.factor);
            DrawCommand::Ring { centre, radius, width, dash, color }
        }
    }
}

/// Adds a stroke to the label area: labels never cover edges and avoid other lines.
pub(super) fn block_stroke(field: &mut LabelArea, stroke: &Stroke, frame: &Frame) {
    let hard = stroke.pen == Pen::Outline;
    let obstacles: Vec<Obstacle> = match &stroke.shape {
        // A captioned path must stay recognisable, so labels avoid it. A few segments suffice.
        Shape::Line(points) if is_path(stroke.pen) && stroke.caption.is_some() => {
            let step = (points.len() / 40).max(1);
            let ends: Vec<Px> = points.iter().step_by(step).map(|p| frame.scale.px(*p)).collect();
            ends.windows(2).map(|w| Obstacle::Segment(w[0], w[1])).collect()
        }
        _ if is_path(stroke.pen) => Vec::new(),
        Shape::Line(points) => {
            points.windows(2).map(|w| Obstacle::Segment(frame.scale.px(w[0]), frame.scale.px(w[1]))).collect()
        }
        Shape::Circle { centre, radius } => {
            vec![Obstacle::Ring { centre: frame.scale.px(*centre), radius: radius * frame.scale.factor }]
        }
    };
    for obstacle in obstacles {
        if hard { field.block(obstacle) } else { field.discourage(obstacle) }
    }
}

/// Draws centre lines through the origin, a little longer than the drawing, with arrow and name at the
/// positive ends.
pub(super) fn axes(
    scene: &Scene,
    frame: &Frame,
    extent: (Point, Point),
    drawing: Rect,
    field: &mut LabelArea,
) -> Vec<DrawCommand> {
    let text = frame.text_size;
    let part = part(frame, extent);
    let origin = frame.scale.px([0.0, 0.0]);
    let mut inks = Vec::new();
    for axis in &scene.axes {
        let along = [axis.direction[0], -axis.direction[1]];
        let tip = leave(origin, along, part.grown(frame.axis_reach));
        let tail = leave(origin, [-along[0], -along[1]], part.grown(0.9 * text));
        let width = (0.06 * text).max(1.0);
        let dash = Dash::Chain(0.55 * text);
        inks.push(DrawCommand::Line {
            points: vec![tail, tip],
            closed: false,
            width,
            dash,
            color: palette::THIN,
        });
        inks.extend(symbol::arrow(tip.toward(along, -1.1 * text), tip, width, 0.7 * text, palette::TEXT));
        field.discourage(Obstacle::Segment(tail, tip));

        let size = 1.15 * text;
        let wide = frame.font.width(&axis.name, size);
        // The name lies beside the arrow: above a horizontal one, to the right of a vertical one.
        let beside = [-along[1].abs() * -1.0, -along[0].abs()];
        let middle = tip.toward(along, -0.3 * text).toward(beside, 0.45 * size + wide / 2.0);
        let name = Rect::new(middle.x - wide / 2.0, middle.y - size * 0.4, wide, size * 0.8);
        let name = inside(name, drawing);
        inks.push(DrawCommand::text(
            px(name.left, name.top + size * 0.62),
            size,
            axis.name.clone(),
            palette::TEXT,
        ));
        field.block(Obstacle::Box(name.grown(2.0)));
        field.block(Obstacle::Segment(tip.toward(along, -1.1 * text), tip));
    }
    inks
}

/// Returns the extent of the drawing on the sheet.
fn part(frame: &Frame, (low, high): (Point, Point)) -> Rect {
    let (low, high) = (frame.scale.px(low), frame.scale.px(high));
    Rect { left: low.x, top: high.y, right: high.x, bottom: low.y }
}

/// Returns true if a dial of the largest size would cover an axis arrow.
pub(super) fn are_arrows_hidden(scene: &Scene, frame: &Frame, extent: (Point, Point)) -> bool {
    let origin = frame.scale.px([0.0, 0.0]);
    let with_dial = scene.marks.iter().filter(|mark| mark.deviation.is_some() && scene.zone.is_some());
    let dials: Vec<Obstacle> = with_dial
        .map(|mark| Obstacle::Disc {
            centre: frame.scale.px(mark.position),
            radius: frame.largest_dial + 0.5 * frame.text_size,
        })
        .collect();
    scene.axes.iter().any(|axis| {
        let along = [axis.direction[0], -axis.direction[1]];
        let tip = leave(origin, along, part(frame, extent).grown(frame.axis_reach));
        let neck = tip.toward(along, -1.1 * frame.text_size);
        dials.iter().any(|dial| dial.crosses(neck, tip))
    })
}

/// Moves the rectangle by the least amount so that it lies in `area`.
fn inside(rect: Rect, area: Rect) -> Rect {
    let x = (area.left - rect.left).max(0.0) + (area.right - rect.right).min(0.0);
    let y = (area.top - rect.top).max(0.0) + (area.bottom - rect.bottom).min(0.0);
    Rect::new(rect.left + x, rect.top + y, rect.width(), rect.height())
}

/// Returns the point where a ray from inside the rectangle leaves it.
fn leave(from: Px, along: [f64; 2], rect: Rect) -> Px {
    let reach = |slope: f64, low: f64, high: f64| match slope {
        s if s > 1e-9 => high / s,
        s if s < -1e-9 => low / s,
        _ => f64::INFINITY,
    };
    let x = reach(along[0], rect.left - from.x, rect.right - from.x);
    let y = reach(along[1], rect.top - from.y, rect.bottom - from.y);
    from.toward(along, x.min(y).max(0.0))
}

/// Draws a bar of a round length, at most a third of the drawing.
pub(super) fn scale_bar(frame: &Frame, area: Rect) -> Vec<DrawCommand> {
    let text = frame.text_size;
    let length = bar_length(0.3 * area.width() / frame.scale.factor);
    let (left, wide) = (area.left + 0.8 * text, length * frame.scale.factor);
    let y = area.bottom - 0.9 * text;
    let width = (0.1 * text).max(1.0);
    let tick = 0.4 * text;
    let mut inks = vec![DrawCommand::line(px(left, y), px(left + wide, y), width, palette::TEXT)];
    for x in [left, left + wide / 2.0, left + wide] {
        inks.push(DrawCommand::line(px(x, y - tick), px(x, y + tick), width, palette::TEXT));
    }
    let caption = format!("{} mm", plain(length));
    let at = px(left + wide + 0.7 * text, y + 0.36 * text);
    inks.push(DrawCommand::Text { at, align: Align::Left, size: text, text: caption, color: palette::TEXT });
    inks
}
