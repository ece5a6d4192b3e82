//! Title block, legend and notes beside the drawing.
use super::font::{ASCENT, Font};
use super::frame::{Frame, LegendUse};
use super::ink::{Dash, DrawCommand, Px, Rect, Rgb, px};
use super::measure::plain;
use super::palette;
use super::role::HoleStatus;
use super::scene::{LegendItem, Sample, Scene};
use super::symbol;

/// The areas of drawing, title block and legend on the page.
pub(super) struct Panel {
    pub(super) drawing: Rect,
    page: Rect,
    title: Rect,
    /// Column of the legend; `None` if it continues below the title block.
    legend: Option<Rect>,
}

/// One row of a column.
enum PanelRow {
    Text {
        text: String,
        size: f64,
        color: Rgb,
        important: bool,
    },
    Verdict(HoleStatus, String),
    /// Feature control frame: ⌖ | Φ0.1.
    Zone(f64),
    Sample(Sample, String),
    Gap,
    Rule,
    /// Marks omitted rows.
    Dots,
}

impl PanelRow {
    /// Returns the importance of the row; the least important rows are omitted first.
    fn importance(&self) -> u8 {
        match self {
            Self::Gap => 0,
            Self::Sample(Sample::Pen(_), _) => 1,
            Self::Sample(Sample::Direction | Sample::Displacement, _) => 2,
            Self::Text { important: false, .. } => 3,
            Self::Rule => 4,
            Self::Sample(Sample::Deviation | Sample::Status(_) | Sample::Plain(_), _) => 5,
            Self::Text { important: true, .. } => 6,
            Self::Zone(_) => 7,
            Self::Verdict(..) => 8,
            Self::Dots => 9,
        }
    }
}

/// Largest number of lines of a row; longer texts are cut short.
const MOST_LINES: usize = 3;

impl Panel {
    /// Places the columns beside the drawing on a wide page, below it on a tall one.
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
        // Two lines are reserved for notes, which are known only after the layout.
        let notes = vec!["n".to_owned(), "n".to_owned()];
        let all = LegendUse {
            magnification: Some(1000.0),
            directions: true,
            displacements: true,
            has_plain_good: false,
            has_plain_rest: false,
        };
        let (_, title) = flow(&title_rows(scene, text), column, font, text);
        let (_, legend) = flow(&legend_rows(scene, all, &notes, text), column, font, text);
        let height = title.max(legend) + 2.0 * space;
        let top = (page.bottom - height).max(page.top + 0.55 * page.height()).round();
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
        shown: LegendUse,
        notes: &[String],
    ) -> Vec<DrawCommand> {
        let rule = |from: Px, to: Px| DrawCommand::line(from, to, 1.0, palette::RULE);
        let page = self.page;
        let corners = [
            px(page.left, page.top),
            px(page.right, page.top),
            px(page.right, page.bottom),
            px(page.left, page.bottom),
        ];
        let mut inks = vec![DrawCommand::Line {
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
            inks.extend(fitted(legend, frame, |text| legend_rows(scene, shown, notes, text)));
        } else {
            inks.push(rule(px(drawing.right, drawing.top), px(drawing.right, drawing.bottom)));
            inks.extend(fitted(self.title, frame, |text| {
                let mut rows = title_rows(scene, text);
                rows.push(PanelRow::Rule);
                rows.extend(legend_rows(scene, shown, notes, text));
                rows
            }));
        }
        inks
    }
}

/// Sets the rows in the largest text that fits the column. If even the smallest is too large, the least
/// important rows are omitted and a row of dots marks the omission.
fn fitted(column: Rect, frame: &Frame, rows: impl Fn(f64) -> Vec<PanelRow>) -> Vec<DrawCommand> {
    let least = 9.5f64.min(frame.text_size);
    let mut text = frame.text_size;
    let (mut inks, mut height) = flow(&rows(text), column, &frame.font, text);
    while column.height() < height && least < text {
        text = (text - 0.5).max(least);
        (inks, height) = flow(&rows(text), column, &frame.font, text);
    }
    let mut left = rows(text);
    while column.height() < height
        && let Some((index, _)) = left.iter().enumerate().rev().min_by_key(|(_, row)| row.importance())
    {
        left.remove(index);
        left.retain(|row| !matches!(row, PanelRow::Dots));
        left.push(PanelRow::Dots);
        (inks, height) = flow(&left, column, &frame.font, text);
    }
    inks
}

fn title_rows(scene: &Scene, text: f64) -> Vec<PanelRow> {
    let title = &scene.title;
    let line = |words: &str, size: f64, color: Rgb, important: bool| PanelRow::Text {
        text: words.to_owned(),
        size,
        color,
        important,
    };
    let mut rows = vec![
        line(&title.name, 1.25 * text, palette::TEXT, true),
        line(&title.view, text, palette::SOFT_TEXT, true),
        PanelRow::Gap,
    ];
    if let Some((standing, words)) = &title.verdict {
        rows.push(PanelRow::Verdict(*standing, words.clone()));
    }
    rows.extend(title.position.map(PanelRow::Zone));
    rows.extend(title.lines.iter().enumerate().map(|(n, words)| line(words, text, palette::TEXT, n == 0)));
    if !title.caution.is_empty() {
        rows.push(line(&title.caution, text, palette::SOFT_TEXT, true));
    }
    rows
}

fn legend_rows(scene: &Scene, shown: LegendUse, notes: &[String], text: f64) -> Vec<PanelRow> {
    let item = |item: &LegendItem| {
        let words = match item.sample {
            Sample::Deviation => format!("{} ×{}", item.text, plain(shown.magnification?)),
            Sample::Direction if !shown.directions => return None,
            Sample::Displacement if !shown.displacements => return None,
            Sample::Direction
            | Sample::Displacement
            | Sample::Pen(_)
            | Sample::Status(_)
            | Sample::Plain(_) => item.text.clone(),
        };
        let sample = match item.sample {
            Sample::Status(standing) if shown.has_plain_good && standing.is_good() => Sample::Plain(standing),
            Sample::Status(standing) if shown.has_plain_rest && !standing.is_good() => {
                Sample::Plain(standing)
            }
            sample => sample,
        };
        Some(PanelRow::Sample(sample, words))
    };
    let mut rows: Vec<PanelRow> = scene.legend.iter().filter_map(item).collect();
    if !notes.is_empty() {
        rows.push(PanelRow::Rule);
    }
    let note = |n: &String| PanelRow::Text {
        text: n.clone(),
        size: text,
        color: palette::SOFT_TEXT,
        important: true,
    };
    rows.extend(notes.iter().map(note));
    rows
}

/// Sets the rows below each other; returns the commands and the height.
fn flow(rows: &[PanelRow], column: Rect, font: &Font, text: f64) -> (Vec<DrawCommand>, f64) {
    let mut inks = Vec::new();
    let mut y = column.top;
    let leading = 1.28;
    let indent = 2.1 * text;
    for row in rows {
        match row {
            PanelRow::Gap => y += 0.5 * text,
            PanelRow::Rule => {
                y += 0.45 * text;
                inks.push(DrawCommand::line(
                    px(column.left, y.round() + 0.5),
                    px(column.right, y.round() + 0.5),
                    1.0,
                    palette::RULE,
                ));
                y += 0.55 * text;
            }
            PanelRow::Dots => {
                inks.push(DrawCommand::text(px(column.left, y + ASCENT * text), text, "…", palette::TEXT));
                y += leading * text;
            }
            PanelRow::Text { text: words, size, color, .. } => {
                for line in font.wrapped(words, *size, column.width(), MOST_LINES) {
                    inks.push(DrawCommand::text(px(column.left, y + ASCENT * size), *size, line, *color));
                    y += leading * size;
                }
            }
            PanelRow::Zone(zone) => y += zone_frame(*zone, px(column.left, y), font, text, &mut inks),
            PanelRow::Verdict(standing, words) => {
                inks.extend(symbol::status_sign(
                    *standing,
                    px(column.left + 0.8 * text, y + 0.5 * text),
                    0.62 * text,
                ));
                y += indented(words, px(column.left + indent, y), column.right, font, text, &mut inks);
            }
            PanelRow::Sample(sample, words) => {
                inks.extend(sample_inks(*sample, px(column.left + 0.8 * text, y + 0.5 * text), text));
                y += indented(words, px(column.left + indent, y), column.right, font, text, &mut inks);
            }
        }
    }
    (inks, y - column.top)
}

fn indented(words: &str, at: Px, right: f64, font: &Font, text: f64, inks: &mut Vec<DrawCommand>) -> f64 {
    let lines = font.wrapped(words, text, right - at.x, MOST_LINES);
    let height = 1.28 * text * lines.len().max(1) as f64;
    for (n, line) in lines.into_iter().enumerate() {
        inks.push(DrawCommand::text(
            px(at.x, at.y + text * (ASCENT + 1.28 * n as f64)),
            text,
            line,
            palette::TEXT,
        ));
    }
    height
}

fn zone_frame(zone: f64, at: Px, font: &Font, text: f64, inks: &mut Vec<DrawCommand>) -> f64 {
    let words = format!("Φ{}", plain(zone));
    let high = 1.7 * text;
    let (first, second) = (1.9 * text, font.width(&words, text) + 0.8 * text);
    let top = (at.y + 0.1 * text).round() + 0.5;
    let left = at.x.round() + 0.5;
    for (x, wide) in [(left, first), (left + first.round(), second)] {
        let (right, bottom) = (x + wide.round(), top + high.round());
        let points = vec![px(x, top), px(right, top), px(right, bottom), px(x, bottom)];
        inks.push(DrawCommand::Line {
            points,
            closed: true,
            width: 1.0,
            dash: Dash::Solid,
            color: palette::TEXT,
        });
    }
    let middle = px(left + first / 2.0, top + high / 2.0);
    inks.extend(symbol::position(middle, 0.62 * text, (0.08 * text).max(1.0), palette::TEXT));
    inks.push(DrawCommand::text(
        px(left + first.round() + 0.4 * text, top + 1.18 * text),
        text,
        words,
        palette::TEXT,
    ));
    high + 0.45 * text
}

fn sample_inks(sample: Sample, middle: Px, text: f64) -> Vec<DrawCommand> {
    let half = 0.8 * text;
    let (left, right) = (px(middle.x - half, middle.y), px(middle.x + half, middle.y));
    match sample {
        Sample::Status(standing) => symbol::status_sign(standing, middle, 0.5 * text),
        Sample::Plain(standing) => symbol::hole(standing, middle, 0.4 * text, [0.0, 1.0], 1.0),
        Sample::Pen(pen) => {
            let (color, width, dash) = palette::pen(pen, text);
            vec![DrawCommand::Line {
                points: vec![left, right],
                closed: false,
                width: width.max(1.0),
                dash,
                color,
            }]
        }
        Sample::Direction => symbol::arrow(left, right, (0.08 * text).max(1.0), 0.5 * text, palette::TEXT),
        Sample::Displacement => {
            let (width, dash) = ((0.06 * text).max(1.0), Dash::Pattern([0.15 * text, 0.2 * text]));
            let color = palette::TEXT;
            vec![
                DrawCommand::Line { points: vec![left, right], closed: false, width, dash, color },
                DrawCommand::Ring { centre: right, radius: 0.3 * text, width, dash: Dash::Solid, color },
            ]
        }
        Sample::Deviation => {
            let thin = (0.06 * text).max(1.0);
            let end = px(middle.x + 0.3 * text, middle.y - 0.2 * text);
            let color = palette::status_colour(HoleStatus::Good);
            vec![
                DrawCommand::Ring {
                    centre: middle,
                    radius: 0.62 * text,
                    width: thin,
                    dash: Dash::Solid,
                    color: palette::THIN,
                },
                DrawCommand::line(middle, end, (0.13 * text).max(1.5), color),
                DrawCommand::Disc { centre: end, radius: (0.17 * text).max(1.8), color },
            ]
        }
    }
}
