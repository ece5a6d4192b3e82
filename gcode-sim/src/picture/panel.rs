//! Title block, legend and notes beside the drawing.
use super::font::{ASCENT, Font};
use super::ink::{Dash, Ink, Px, Rect, Rgb, px};
use super::measure::plain;
use super::palette;
use super::scene::{LegendItem, Sample, Scene, Standing};
use super::sheet::Frame;
use super::symbol;

/// Where the drawing goes, and the columns beside it or below it.
pub(super) struct Panel {
    pub(super) drawing: Rect,
    page: Rect,
    title: Rect,
    /// Below the title block where nothing else is said.
    legend: Option<Rect>,
}

/// One line or group of lines of a column.
enum Row {
    Text {
        text: String,
        size: f64,
        color: Rgb,
    },
    Verdict(Standing, String),
    /// ⌖ | Φ0.1 as a feature control frame has it.
    Zone(f64),
    Sample(Sample, String),
    Gap,
    Rule,
}

impl Panel {
    /// Beside the drawing on a wide page, below it on a tall one.
    pub(super) fn beside(page: Rect, scene: &Scene, font: &Font, text: f64) -> Self {
        let space = 0.6 * text;
        if page.height() <= page.width() {
            let width = (0.29 * page.width()).max(14.5 * text).min(0.4 * page.width());
            let left = (page.right - width).round();
            let title = Rect {
                left: left + space,
                top: page.top + space,
                right: page.right - space,
                bottom: page.bottom - space,
            };
            return Self { drawing: Rect { right: left, ..page }, page, title, legend: None };
        }
        let middle = page.centre().x;
        let column = Rect::new(0.0, 0.0, page.width() / 2.0 - 2.0 * space, 0.0);
        // Two lines are kept for notes, which are known only when everything has its place.
        let notes = vec!["n".to_owned(), "n".to_owned()];
        let (_, title) = flow(&title_rows(scene, text), column, font, text);
        let (_, legend) = flow(&legend_rows(scene, Some(1000.0), &notes, text), column, font, text);
        let height = title.max(legend) + 2.0 * space;
        let top = (page.bottom - height).max(page.top + 0.4 * page.height()).round();
        let column = |left: f64, right: f64| Rect {
            left: left + space,
            top: top + space,
            right: right - space,
            bottom: page.bottom,
        };
        Self {
            drawing: Rect { bottom: top, ..page },
            page,
            title: column(page.left, middle),
            legend: Some(column(middle, page.right)),
        }
    }

    pub(super) fn inks(
        &self,
        scene: &Scene,
        frame: &Frame,
        magnified: Option<f64>,
        notes: &[String],
    ) -> Vec<Ink> {
        let rule = |from: Px, to: Px| Ink::line(from, to, 1.0, palette::RULE);
        let page = self.page;
        let corners = [
            px(page.left, page.top),
            px(page.right, page.top),
            px(page.right, page.bottom),
            px(page.left, page.bottom),
        ];
        let mut inks = vec![Ink::Line {
            points: corners.to_vec(),
            closed: true,
            width: 1.0,
            dash: Dash::Solid,
            color: palette::RULE,
        }];
        let drawing = self.drawing;
        if let Some(legend) = self.legend {
            inks.push(rule(px(drawing.left, drawing.bottom), px(drawing.right, drawing.bottom)));
            inks.push(rule(px(page.centre().x, drawing.bottom), px(page.centre().x, page.bottom)));
            inks.extend(fitted(self.title, frame, |text| title_rows(scene, text)));
            inks.extend(fitted(legend, frame, |text| legend_rows(scene, magnified, notes, text)));
        } else {
            inks.push(rule(px(drawing.right, drawing.top), px(drawing.right, drawing.bottom)));
            inks.extend(fitted(self.title, frame, |text| {
                let mut rows = title_rows(scene, text);
                rows.push(Row::Rule);
                rows.extend(legend_rows(scene, magnified, notes, text));
                rows
            }));
        }
        inks
    }
}

/// The rows in the largest text that the column has room for.
fn fitted(column: Rect, frame: &Frame, rows: impl Fn(f64) -> Vec<Row>) -> Vec<Ink> {
    let least = 9.5f64.min(frame.text);
    let mut text = frame.text;
    loop {
        let (inks, height) = flow(&rows(text), column, &frame.font, text);
        if height <= column.height() || text <= least {
            return inks;
        }
        text = (text - 0.5).max(least);
    }
}

fn title_rows(scene: &Scene, text: f64) -> Vec<Row> {
    let title = &scene.title;
    let line = |t: &str, size: f64, color: Rgb| Row::Text { text: t.to_owned(), size, color };
    let mut rows = vec![
        line(&title.name, 1.25 * text, palette::TEXT),
        line(&title.view, text, palette::SOFT_TEXT),
        Row::Gap,
    ];
    if let Some((standing, words)) = &title.verdict {
        rows.push(Row::Verdict(*standing, words.clone()));
    }
    rows.extend(title.position.map(Row::Zone));
    rows.extend(title.lines.iter().map(|t| line(t, text, palette::TEXT)));
    if !title.caution.is_empty() {
        rows.push(line(&title.caution, text, palette::SOFT_TEXT));
    }
    rows
}

fn legend_rows(scene: &Scene, magnified: Option<f64>, notes: &[String], text: f64) -> Vec<Row> {
    let item = |item: &LegendItem| match (item.sample, magnified) {
        (Sample::Misfit, None) => None,
        (Sample::Misfit, Some(times)) => {
            Some(Row::Sample(item.sample, format!("{} ×{}", item.text, plain(times))))
        }
        _ => Some(Row::Sample(item.sample, item.text.clone())),
    };
    let mut rows: Vec<Row> = scene.legend.iter().filter_map(item).collect();
    if !notes.is_empty() {
        rows.push(Row::Rule);
    }
    rows.extend(notes.iter().map(|n| Row::Text { text: n.clone(), size: text, color: palette::SOFT_TEXT }));
    rows
}

/// Sets the rows below each other; also says how high they are.
fn flow(rows: &[Row], column: Rect, font: &Font, text: f64) -> (Vec<Ink>, f64) {
    let mut inks = Vec::new();
    let mut y = column.top;
    let leading = 1.28;
    let indent = 2.1 * text;
    for row in rows {
        match row {
            Row::Gap => y += 0.5 * text,
            Row::Rule => {
                y += 0.45 * text;
                inks.push(Ink::line(
                    px(column.left, y.round() + 0.5),
                    px(column.right, y.round() + 0.5),
                    1.0,
                    palette::RULE,
                ));
                y += 0.55 * text;
            }
            Row::Text { text: words, size, color } => {
                for line in font.wrapped(words, *size, column.width()) {
                    inks.push(Ink::text(px(column.left, y + ASCENT * size), *size, line, *color));
                    y += leading * size;
                }
            }
            Row::Zone(zone) => y += zone_frame(*zone, px(column.left, y), font, text, &mut inks),
            Row::Verdict(standing, words) => {
                inks.extend(symbol::standing(
                    *standing,
                    px(column.left + 0.8 * text, y + 0.5 * text),
                    0.62 * text,
                ));
                y += indented(words, px(column.left + indent, y), column.right, font, text, &mut inks);
            }
            Row::Sample(sample, words) => {
                inks.extend(sample_inks(*sample, px(column.left + 0.8 * text, y + 0.5 * text), text));
                y += indented(words, px(column.left + indent, y), column.right, font, text, &mut inks);
            }
        }
    }
    (inks, y - column.top)
}

fn indented(words: &str, at: Px, right: f64, font: &Font, text: f64, inks: &mut Vec<Ink>) -> f64 {
    let lines = font.wrapped(words, text, right - at.x);
    let height = 1.28 * text * lines.len().max(1) as f64;
    for (n, line) in lines.into_iter().enumerate() {
        inks.push(Ink::text(px(at.x, at.y + text * (ASCENT + 1.28 * n as f64)), text, line, palette::TEXT));
    }
    height
}

fn zone_frame(zone: f64, at: Px, font: &Font, text: f64, inks: &mut Vec<Ink>) -> f64 {
    let words = format!("Φ{}", plain(zone));
    let high = 1.7 * text;
    let (first, second) = (1.9 * text, font.width(&words, text) + 0.8 * text);
    let top = (at.y + 0.1 * text).round() + 0.5;
    let left = at.x.round() + 0.5;
    for (x, wide) in [(left, first), (left + first.round(), second)] {
        let (right, bottom) = (x + wide.round(), top + high.round());
        let points = vec![px(x, top), px(right, top), px(right, bottom), px(x, bottom)];
        inks.push(Ink::Line { points, closed: true, width: 1.0, dash: Dash::Solid, color: palette::TEXT });
    }
    let middle = px(left + first / 2.0, top + high / 2.0);
    inks.extend(symbol::position(middle, 0.62 * text, (0.08 * text).max(1.0), palette::TEXT));
    inks.push(Ink::text(
        px(left + first.round() + 0.4 * text, top + 1.18 * text),
        text,
        words,
        palette::TEXT,
    ));
    high + 0.45 * text
}

fn sample_inks(sample: Sample, middle: Px, text: f64) -> Vec<Ink> {
    let half = 0.8 * text;
    let (left, right) = (px(middle.x - half, middle.y), px(middle.x + half, middle.y));
    match sample {
        Sample::Standing(standing) => symbol::standing(standing, middle, 0.5 * text),
        Sample::Pen(pen) => {
            let (color, width, dash) = palette::pen(pen, text);
            vec![Ink::Line { points: vec![left, right], closed: false, width: width.max(1.0), dash, color }]
        }
        Sample::Direction => symbol::arrow(left, right, (0.08 * text).max(1.0), 0.5 * text, palette::TEXT),
        Sample::Misfit => {
            let thin = (0.06 * text).max(1.0);
            let end = px(middle.x + 0.3 * text, middle.y - 0.2 * text);
            let color = palette::standing(Standing::Good);
            vec![
                Ink::Ring {
                    centre: middle,
                    radius: 0.62 * text,
                    width: thin,
                    dash: Dash::Solid,
                    color: palette::THIN,
                },
                Ink::line(middle, end, (0.13 * text).max(1.5), color),
                Ink::Disc { centre: end, radius: (0.17 * text).max(1.8), color },
            ]
        }
    }
}
