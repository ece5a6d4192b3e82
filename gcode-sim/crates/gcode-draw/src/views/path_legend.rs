//! The legend of the picture of a tool path.
use super::path_strokes::{PathDrawer, class_style};
use super::path_view::{Arrangement, ColorBy, RunKind, StandardView};
use super::top::TopView;
use crate::measure::plain;
use crate::picture::{LegendItem, Sample};
use crate::scene::{Pen, Scene, Shape, Sign, Stroke, Style, Tint};
use crate::side::Projection;

/// Largest number of tools or programs in the legend.
const MAX_CLASSES: usize = 12;

/// Returns the legend of a picture: what its scene has and no more.
pub(super) fn legend(
    view: &TopView,
    drawer: &PathDrawer<'_>,
    scene: &Scene,
    arrangement: &Arrangement,
    (letter, sign): (char, f64),
    is_shown: impl Fn(usize) -> bool,
) -> Vec<LegendItem> {
    let path = drawer.path;
    let mut items = view.status_legend(&scene.marks);
    let is_shaded = |stroke: &Stroke| matches!(stroke.style, Some(Style { tint: Some(Tint::Shade(_)), .. }));
    if let Some(scale) = drawer.shades.filter(|_| scene.strokes.iter().any(is_shaded)) {
        items.push(match (arrangement.color_by, scale.is_flat()) {
            (ColorBy::Feed, false) => {
                LegendItem::new(Sample::Shades(scale.low, scale.high), "feed rate, mm/min")
            }
            (ColorBy::Feed, true) => {
                LegendItem::new(Sample::Nothing, format!("all feeds: F{}", plain(scale.low)))
            }
            (_, false) => LegendItem::new(
                Sample::Shades(sign * scale.low, sign * scale.high),
                format!("{letter} of the feeds, mm"),
            ),
            (_, true) => {
                let at = number(sign * scale.low);
                let all = if scale.plunge.is_some() { "all cuts" } else { "all feeds" };
                LegendItem::new(Sample::Nothing, format!("{all} at {letter} = {at} mm"))
            }
        });
        items.extend(scale.plunge.map(|highest| {
            let from = number(sign * highest);
            LegendItem::new(Sample::Nothing, format!("plunges and retracts up to {letter} = {from} mm"))
        }));
    }
    if arrangement.color_by != ColorBy::Program {
        items.extend(tool_lines(drawer, is_shown));
    } else {
        let mut used: Vec<usize> =
            path.runs.iter().filter(|run| run.kind == RunKind::Feed).map(|run| run.program).collect();
        used.sort_unstable();
        used.dedup();
        let line = |program: usize| {
            let name = path.programs.get(program).map_or("", String::as_str);
            LegendItem::new(Sample::Line(Pen::Feed, class_style(program)), name)
        };
        items.extend(used.iter().take(MAX_CLASSES).map(|program| line(*program)));
        items.extend(more(used.len(), "program"));
    }
    // A line along the sight is a point.
    let is_seen = |stroke: &Stroke| match &stroke.shape {
        Shape::Line(points) => points.iter().any(|point| drawer.is_apart(*point, points[0])),
        _ => true,
    };
    let has_pen = |pen: Pen| scene.strokes.iter().any(|stroke| stroke.pen == pen && is_seen(stroke));
    let has_tint = |tint: Tint| {
        scene.strokes.iter().any(|stroke| stroke.style.is_some_and(|style| style.tint == Some(tint)))
    };
    let has_sign = |of: Sign| {
        scene.strokes.iter().any(|stroke| matches!(stroke.shape, Shape::Sign { sign, .. } if sign == of))
    };
    let has_zero = scene.strokes.iter().any(|stroke| matches!(stroke.shape, Shape::Zero(_)));
    let pale = Style { tint: Some(Tint::Pale), width: Some(0.6), ..Style::default() };
    let outline = if path.stock.is_some() { "stock" } else { "part outline" };
    let has_void = path.stock.as_ref().is_some_and(|stock| !stock.voids().is_empty());
    let has_hidden = arrangement.views.contains(&StandardView::Isometric);
    let void = if has_hidden { "void of the stock, hidden edge" } else { "void of the stock" };
    let is_limit = path.places.iter().any(|place| place.sign == Sign::Alarm && place.label == "limit");
    let stopped = if is_limit { "limit of the run" } else { "alarm" };
    let others = [
        (has_pen(Pen::Rapid), Sample::Pen(Pen::Rapid), "rapid"),
        (has_pen(Pen::Probe), Sample::Pen(Pen::Probe), "probing move"),
        (has_tint(Tint::Pale), Sample::Line(Pen::Feed, pale), "swept by the cutter"),
        (has_pen(Pen::Thread), Sample::Pen(Pen::Thread), "thread"),
        (has_pen(Pen::Outline), Sample::Pen(Pen::Outline), outline),
        (has_void, Sample::Pen(Pen::Construction), void),
        (has_pen(Pen::Limit), Sample::Pen(Pen::Limit), "travel limit of the tip"),
        (has_zero, Sample::Zero, "work zero"),
        (has_sign(Sign::Start), Sample::Sign(Sign::Start), "start"),
        (has_sign(Sign::End), Sample::Sign(Sign::End), "end"),
        (has_sign(Sign::Stop), Sample::Sign(Sign::Stop), "stop"),
        (has_sign(Sign::Alarm), Sample::Sign(Sign::Alarm), stopped),
    ];
    let drawn = others.into_iter().filter(|(is_drawn, ..)| *is_drawn);
    items.extend(drawn.map(|(_, sample, text)| LegendItem::new(sample, text)));
    let plane_views = arrangement.views.iter().filter(|view| **view != StandardView::Isometric).count();
    if 1 < plane_views {
        let words = match arrangement.projection {
            Projection::Third => "third-angle projection",
            Projection::First => "first-angle projection",
        };
        items.push(LegendItem::new(Sample::Projection(arrangement.projection), words));
    }
    items
}

/// Returns a line for each tool whose feeds are drawn as lines.
fn tool_lines(drawer: &PathDrawer<'_>, is_shown: impl Fn(usize) -> bool) -> Vec<LegendItem> {
    let path = drawer.path;
    let mut cutting: Vec<(usize, usize)> =
        drawer.tool_order.iter().enumerate().filter_map(|(tool, order)| Some(((*order)?, tool))).collect();
    cutting.retain(|(_, tool)| is_shown(*tool));
    cutting.sort_unstable();
    let line = |tool: usize| {
        let run = path.runs.iter().find(|run| run.kind == RunKind::Feed && run.tool == tool)?;
        let mut style = drawer.style(run);
        if drawer.color_by != ColorBy::Tool {
            style.tint = Some(Tint::Shade(0.25));
        }
        Some(LegendItem::new(Sample::Line(Pen::Feed, style), path.tools[tool].name.clone()))
    };
    let lines = cutting.iter().take(MAX_CLASSES).filter_map(|(_, tool)| line(*tool));
    lines.chain(more(cutting.len(), "tool")).collect()
}

fn more(count: usize, what: &str) -> Option<LegendItem> {
    let more = count.checked_sub(MAX_CLASSES).filter(|more| 0 < *more)?;
    let plural = if more == 1 { "" } else { "s" };
    Some(LegendItem::new(Sample::Nothing, format!("and {more} more {what}{plural}")))
}

/// Formats a number with a true minus sign.
fn number(value: f64) -> String {
    plain(value).replace('-', "−")
}
