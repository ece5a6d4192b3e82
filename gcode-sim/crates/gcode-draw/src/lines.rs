//! Lines of the drawing: edges, circles, axes through the origin, and the scale bar.
use super::ink::{DrawCommand, Ink, Px, Rect, px};
use super::labels::LabelArea;
use super::measure::{Frame, Scale, bar_length, plain};
use super::obstacle::Obstacle;
use super::palette;
use super::scene::{Pen, Point, Scene, Shape, Stroke};
use super::symbol;

/// Radius of the symbol of a zero point in text heights.
pub(super) const ZERO: f64 = 2.0 / 3.0;
/// Radius of the symbol of a place on a path in text heights.
pub(super) const SIGN: f64 = 0.42;

/// Draws a shape of a scene.
pub(super) fn shape_commands(stroke: &Stroke, scale: &Scale, text: f64) -> Vec<DrawCommand> {
    let ink = palette::ink(stroke.pen, stroke.style, text, scale.factor);
    vec![match &stroke.shape {
        Shape::Line(points) => DrawCommand::path(points.iter().map(|p| scale.px(*p)).collect(), ink),
        Shape::Circle { centre, radius } => {
            DrawCommand::Ring { centre: scale.px(*centre), radius: radius * scale.factor, ink }
        }
        Shape::Arrow([from, to]) => return symbol::arrow(scale.px(*from), scale.px(*to), ink, 0.75 * text),
        Shape::Zero(at) => return symbol::zero(scale.px(*at), ZERO * text, palette::pen(Pen::Edge, text)),
        Shape::Sign { at, sign } => return symbol::sign(*sign, scale.px(*at), SIGN * text),
        Shape::Text { at, align, text: words } => {
            let (at, align, text_color) = (scale.px(*at), *align, palette::TEXT);
            DrawCommand::Text { at, align, size: text, text: words.clone(), color: text_color }
        }
    }]
}

/// Adds a stroke to the label area: labels never cover edges, symbols and texts, and avoid other lines.
pub(super) fn block_stroke(field: &mut LabelArea, stroke: &Stroke, frame: &Frame) {
    let is_symbol = matches!(stroke.shape, Shape::Zero(_) | Shape::Sign { .. } | Shape::Text { .. });
    // The frame of a plane view; the floor of an isometric one may lie below numbers.
    let is_upright = |ends: &[Point]| ends[0][0] == ends[1][0] || ends[0][1] == ends[1][1];
    let is_frame = stroke.pen == Pen::Scale
        && matches!(&stroke.shape, Shape::Line(points) if 2 < points.len() && points.windows(2).all(is_upright));
    let hard = stroke.pen == Pen::Outline || is_frame || is_symbol;
    let segments = |points: &[Point], step: usize| -> Vec<Obstacle> {
        let ends: Vec<Px> = points.iter().step_by(step).map(|p| frame.scale.px(*p)).collect();
        ends.windows(2).map(|w| Obstacle::Segment(w[0], w[1])).collect()
    };
    let obstacles: Vec<Obstacle> = match &stroke.shape {
        // A captioned path must stay recognisable, so labels avoid it. A few segments suffice.
        Shape::Line(points) if stroke.pen.is_path() && stroke.caption.is_some() => {
            segments(points, (points.len() / 40).max(1))
        }
        // The area that a cutter sweeps is no line.
        Shape::Line(points) if stroke.pen.is_path() => {
            if stroke.style.is_none_or(|style| style.width.is_none()) {
                points.windows(2).for_each(|w| field.cover(frame.scale.px(w[0]), frame.scale.px(w[1])));
            }
            Vec::new()
        }
        Shape::Circle { .. } | Shape::Arrow(_) if stroke.pen.is_path() => Vec::new(),
        Shape::Line(points) => segments(points, 1),
        Shape::Arrow(ends) => segments(ends, 1),
        Shape::Circle { centre, radius } => {
            vec![Obstacle::Ring { centre: frame.scale.px(*centre), radius: radius * frame.scale.factor }]
        }
        Shape::Zero(at) => {
            vec![Obstacle::Disc { centre: frame.scale.px(*at), radius: ZERO * frame.text_size }]
        }
        Shape::Sign { at, .. } => {
            vec![Obstacle::Disc { centre: frame.scale.px(*at), radius: SIGN * frame.text_size }]
        }
        Shape::Text { at, align, text } => {
            let wide = frame.font.width(text, frame.text_size);
            let at = frame.scale.px(*at);
            let (left, top) = (at.x - align.fraction_left() * wide, at.y - frame.text_size);
            // A space keeps a label beside it from reading as its continuation.
            let gap = 0.7 * frame.text_size;
            vec![Obstacle::Box(Rect::new(left - gap, top, wide + 2.0 * gap, 1.2 * frame.text_size))]
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
        let head = palette::thin(text, palette::TEXT);
        inks.push(DrawCommand::line(tail, tip, palette::pen(Pen::Centre, text)));
        inks.extend(symbol::arrow(tip.toward(along, -1.1 * text), tip, head, 0.7 * text));
        field.discourage(Obstacle::Segment(tail, tip));

        let size = 1.15 * text;
        let wide = frame.font.width(&axis.name, size);
        // The name lies beside the arrow: above a horizontal one, to the right of a vertical one.
        let beside = [-along[1].abs() * -1.0, -along[0].abs()];
        let middle = tip.toward(along, -0.3 * text).toward(beside, 0.45 * size + wide / 2.0);
        let name = inside(Rect::around(middle, (wide, size * 0.8)), drawing);
        let at = px(name.left, name.top + size * 0.62);
        inks.push(DrawCommand::text(at, size, axis.name.clone(), palette::TEXT));
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

/// Draws a bar of a round length, at most a third of the drawing, below what is drawn and from its left edge.
pub(super) fn scale_bar(
    frame: &Frame,
    drawn: &[DrawCommand],
    extent: (Point, Point),
    area: Rect,
) -> Vec<DrawCommand> {
    let text = frame.text_size;
    let length = bar_length(0.3 * area.width() / frame.scale.factor);
    let wide = length * frame.scale.factor;
    let name = format!("{} mm", plain(length));
    let behind = wide + 0.7 * text + frame.font.width(&name, text);
    let left = part(frame, extent).left.min(area.right - text - behind).max(area.left + 0.8 * text);
    let lowest = drawn.iter().map(DrawCommand::bottom).fold(area.top, f64::max);
    let y = (lowest + 1.5 * text).min(area.bottom - 0.9 * text);
    let ink = Ink::solid(0.1 * text, palette::TEXT);
    let tick = 0.4 * text;
    let mut inks = vec![DrawCommand::line(px(left, y), px(left + wide, y), ink)];
    let ticks = [left, left + wide / 2.0, left + wide];
    inks.extend(ticks.map(|x| DrawCommand::line(px(x, y - tick), px(x, y + tick), ink)));
    let at = px(left + wide + 0.7 * text, y + 0.36 * text);
    inks.push(DrawCommand::text(at, text, name, palette::TEXT));
    inks
}
