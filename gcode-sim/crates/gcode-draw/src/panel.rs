//! Title block, legend and notes beside the drawing.
use super::font::{ASCENT, Font};
use super::ink::{DrawCommand, Ink, Px, Rect, Rgb, px};
use super::lines::{SIGN, ZERO};
use super::marks::displacement_commands;
use super::measure::{Frame, plain};
use super::palette;
use super::picture::{LegendItem, LegendUse, Picture, Sample};
use super::scene::{HoleStatus, Pen};
use super::symbol;
use super::ticks::Ticks;

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
            Self::Sample(Sample::Pen(_) | Sample::Line(..) | Sample::Zero, _) => 1,
            Self::Sample(Sample::Direction | Sample::Displacement | Sample::Sign(_), _) => 2,
            Self::Text { important: false, .. } => 3,
            Self::Rule => 4,
            Self::Sample(
                Sample::Deviation
                | Sample::HoleInZone
                | Sample::Status(_)
                | Sample::Plain(_)
                | Sample::Shades(..)
                | Sample::Nothing
                | Sample::Projection(_),
                _,
            ) => 5,
            Self::Text { important: true, .. } => 6,
            Self::Zone(_) => 7,
            Self::Verdict(..) => 8,
            Self::Dots => 9,
        }
    }
}

/// Largest number of lines of a row; longer texts are cut short.
const MOST_LINES: usize = 3;
/// The same of a verdict, which states what was not checked: it is cut to `MOST_LINES` only where nothing else makes
/// room.
const MOST_VERDICT_LINES: usize = 24;
/// Line spacing in parts of the text size.
const LEADING: f64 = 1.28;

impl Panel {
    /// Places the columns beside the drawing on a wide page, below it on a tall one.
    pub(super) fn beside(page: Rect, picture: &Picture, font: &Font, text: f64) -> Self {
        let space = 0.6 * text;
        if page.height() <= page.width() {
            let width = (0.29 * page.width()).max(14.5 * text).min(0.4 * page.width());
            let left = (page.right - width).round();
            let title = Rect { left, ..page }.grown(-space);
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
            ..LegendUse::default()
        };
        let (_, title) = flow(&title_rows(picture, text), column, font, text, MOST_VERDICT_LINES);
        let (_, legend) = flow(&legend_rows(picture, all, &notes, text), column, font, text, MOST_LINES);
        let table = picture.table.height(text);
        let height = title.max(legend).max(title.min(legend) + text + table) + 2.0 * space;
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

    pub(super) fn commands(
        &self,
        picture: &Picture,
        frame: &Frame,
        shown: LegendUse,
        notes: &[String],
    ) -> Vec<DrawCommand> {
        let rule = |from: Px, to: Px| DrawCommand::line(from, to, palette::RULE);
        let (page, drawing) = (self.page, self.drawing);
        let mut commands = vec![DrawCommand::outline(page.corners(), palette::RULE)];
        let title = |text: f64| title_rows(picture, text);
        let legend = |text: f64| legend_rows(picture, shown, notes, text);
        if let Some(column) = self.legend {
            commands.push(rule(px(drawing.left, drawing.bottom), px(drawing.right, drawing.bottom)));
            commands.push(rule(px(page.centre().x, drawing.bottom), px(page.centre().x, page.bottom)));
            let mut rest: Vec<Rect> = Vec::new();
            for (column, (inks, height)) in
                [(self.title, fitted(self.title, frame, title)), (column, fitted(column, frame, legend))]
            {
                commands.extend(inks);
                rest.push(Rect { top: column.top + height + frame.text_size, ..column });
            }
            let roomiest = rest.into_iter().max_by(|a, b| a.height().total_cmp(&b.height()));
            let table = roomiest.map(|rest| picture.table.draw(rest, &frame.font, frame.text_size));
            commands.extend(table.into_iter().flatten());
        } else {
            commands.push(rule(px(drawing.right, drawing.top), px(drawing.right, drawing.bottom)));
            let both =
                |text: f64| title(text).into_iter().chain([PanelRow::Rule]).chain(legend(text)).collect();
            let (inks, height) = fitted(self.title, frame, both);
            commands.extend(inks);
            let rest = Rect { top: self.title.top + height + frame.text_size, ..self.title };
            commands.extend(picture.table.draw(rest, &frame.font, frame.text_size));
        }
        commands
    }
}

/// Sets the rows in the largest text that fits the column. If even the smallest is too large, the least
/// important rows are omitted and a row of dots marks the omission; last a long verdict is cut short. Returns the
/// height too.
fn fitted(column: Rect, frame: &Frame, rows: impl Fn(f64) -> Vec<PanelRow>) -> (Vec<DrawCommand>, f64) {
    let least = 9.5f64.min(frame.text_size);
    let mut text = frame.text_size;
    let set = |rows: &[PanelRow], text: f64, lines: usize| flow(rows, column, &frame.font, text, lines);
    let (mut inks, mut height) = set(&rows(text), text, MOST_VERDICT_LINES);
    while column.height() < height && least < text {
        text = (text - 0.5).max(least);
        (inks, height) = set(&rows(text), text, MOST_VERDICT_LINES);
    }
    let mut left = rows(text);
    let mut lines = MOST_VERDICT_LINES;
    while column.height() < height
        && let Some((index, row)) = left.iter().enumerate().rev().min_by_key(|(_, row)| row.importance())
    {
        if matches!(row, PanelRow::Verdict(..)) && MOST_LINES < lines {
            lines -= 1;
        } else {
            left.remove(index);
            left.retain(|row| !matches!(row, PanelRow::Dots));
            left.push(PanelRow::Dots);
        }
        (inks, height) = set(&left, text, lines);
    }
    (inks, height)
}

fn title_rows(picture: &Picture, text: f64) -> Vec<PanelRow> {
    let title = &picture.title;
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
    rows.extend(title.verdict.clone().map(|(status, words)| PanelRow::Verdict(status, words)));
    rows.extend(title.position.map(PanelRow::Zone));
    rows.extend(title.lines.iter().enumerate().map(|(n, words)| line(words, text, palette::TEXT, n == 0)));
    if !title.caution.is_empty() {
        rows.push(line(&title.caution, text, palette::SOFT_TEXT, true));
    }
    rows
}

fn legend_rows(picture: &Picture, shown: LegendUse, notes: &[String], text: f64) -> Vec<PanelRow> {
    let item = |item: &LegendItem| {
        let sample = match item.sample {
            Sample::Direction if !shown.directions => return None,
            Sample::Displacement if !shown.displacements => return None,
            Sample::Deviation => {
                let words = format!("{} ×{}", item.text, plain(shown.magnification?));
                return Some(PanelRow::Sample(Sample::Deviation, words));
            }
            Sample::HoleInZone if shown.magnification.is_none() => return None,
            Sample::Status(status) if shown.has_plain_good && status.is_good() => Sample::Plain(status),
            Sample::Status(status) if shown.has_plain_rest && !status.is_good() => Sample::Plain(status),
            sample => sample,
        };
        Some(PanelRow::Sample(sample, item.text.clone()))
    };
    let mut rows: Vec<PanelRow> = picture.legend.iter().filter_map(item).collect();
    if !notes.is_empty() {
        rows.push(PanelRow::Rule);
    }
    let (size, color) = (text, palette::SOFT_TEXT);
    rows.extend(notes.iter().map(|note| PanelRow::Text { text: note.clone(), size, color, important: true }));
    rows
}

/// Sets the rows below each other, a verdict in at most `verdict_lines`; returns the commands and the height.
fn flow(
    rows: &[PanelRow],
    column: Rect,
    font: &Font,
    text: f64,
    verdict_lines: usize,
) -> (Vec<DrawCommand>, f64) {
    let mut commands = Vec::new();
    let mut y = column.top;
    let write_lines =
        |words: &str, at: Px, (size, most): (f64, usize), color, commands: &mut Vec<DrawCommand>| {
            let lines = font.wrapped(words, size, column.right - at.x, most);
            let count = lines.len();
            for (n, line) in lines.into_iter().enumerate() {
                let base = px(at.x, at.y + size * (ASCENT + LEADING * n as f64));
                commands.push(DrawCommand::text(base, size, line, color));
            }
            LEADING * size * count as f64
        };
    let write = |words: &str, at: Px, size: f64, color: Rgb, commands: &mut Vec<DrawCommand>| {
        write_lines(words, at, (size, MOST_LINES), color, commands)
    };
    for row in rows {
        let sign = px(column.left + 0.8 * text, y + 0.5 * text);
        let left = px(column.left, y);
        match row {
            PanelRow::Gap => y += 0.5 * text,
            PanelRow::Rule => {
                let level = (y + 0.45 * text).round() + 0.5;
                commands.push(DrawCommand::line(
                    px(column.left, level),
                    px(column.right, level),
                    palette::RULE,
                ));
                y += text;
            }
            PanelRow::Dots => y += write("…", left, text, palette::TEXT, &mut commands),
            PanelRow::Text { text: words, size, color, .. } => {
                y += write(words, left, *size, *color, &mut commands);
            }
            PanelRow::Zone(zone) => y += zone_frame(*zone, left, font, text, &mut commands),
            PanelRow::Sample(Sample::Shades(low, high), words) => {
                y += write(words, left, text, palette::TEXT, &mut commands);
                let bar = Rect::new(left.x, y + 0.2 * text, column.width(), 0.8 * text);
                commands.extend(shades(bar, (*low, *high), font, text));
                y += 2.6 * text;
            }
            PanelRow::Verdict(_, words) | PanelRow::Sample(_, words) => {
                commands.extend(match row {
                    PanelRow::Verdict(status, _) => symbol::status_sign(*status, sign, 0.62 * text),
                    PanelRow::Sample(sample, _) => sample_commands(*sample, sign, text),
                    _ => Vec::new(),
                });
                let indented = px(column.left + 2.1 * text, y);
                let most = if matches!(row, PanelRow::Verdict(..)) { verdict_lines } else { MOST_LINES };
                let height = write_lines(words, indented, (text, most), palette::TEXT, &mut commands);
                y += height.max(LEADING * text);
            }
        }
    }
    (commands, y - column.top)
}

/// Draws the scale of shades with round numbers below it.
fn shades(bar: Rect, (low, high): (f64, f64), font: &Font, text: f64) -> Vec<DrawCommand> {
    const STEPS: u32 = 64;
    // Whole pixels leave no seams between the steps.
    let at = |share: f64| (bar.left + share * bar.width()).round();
    let step = |n: u32| f64::from(n) / f64::from(STEPS);
    let mut commands: Vec<DrawCommand> = (0..STEPS)
        .map(|n| {
            let points = Rect { left: at(step(n)), right: at(step(n + 1)), ..bar }.corners();
            DrawCommand::Area { points, color: palette::shade(step(n)) }
        })
        .collect();
    // Fewer than three numbers are no scale.
    let of = |most: &f64| Ticks::over(low.min(high), high.max(low), *most);
    let fine = [4.0, 6.0, 8.0].iter().map(of).find(|ticks| 3 <= ticks.all().count());
    let ticks = fine.unwrap_or_else(|| of(&10.0));
    for value in ticks.all() {
        let (x, name) = (at((value - low) / (high - low)), ticks.name(value));
        let end = px(x, bar.bottom + 0.25 * text);
        commands.push(DrawCommand::line(px(x, bar.bottom), end, palette::thin(text, palette::TEXT)));
        let half = font.width(&name, 0.9 * text) / 2.0;
        let middle = x.clamp(bar.left + half, bar.right - half);
        let at = px(middle - half, bar.bottom + 1.1 * text);
        commands.push(DrawCommand::text(at, 0.9 * text, name, palette::TEXT));
    }
    commands
}

/// Draws the feature control frame; returns its height.
fn zone_frame(zone: f64, at: Px, font: &Font, text: f64, commands: &mut Vec<DrawCommand>) -> f64 {
    let words = format!("Φ{}", plain(zone));
    let high = 1.7 * text;
    let (first, second) = ((1.9 * text).round(), (font.width(&words, text) + 0.8 * text).round());
    let (left, top) = (at.x.round() + 0.5, (at.y + 0.1 * text).round() + 0.5);
    for (x, wide) in [(left, first), (left + first, second)] {
        let cell = Rect::new(x, top, wide, high.round());
        commands.push(DrawCommand::outline(cell.corners(), Ink::solid(1.0, palette::TEXT)));
    }
    let middle = px(left + 0.95 * text, top + high / 2.0);
    commands.extend(symbol::position(middle, 0.62 * text, Ink::solid(0.08 * text, palette::TEXT)));
    let base = px(left + first + 0.4 * text, top + 1.18 * text);
    commands.push(DrawCommand::text(base, text, words, palette::TEXT));
    high + 0.45 * text
}

fn sample_commands(sample: Sample, middle: Px, text: f64) -> Vec<DrawCommand> {
    let half = 0.8 * text;
    let (left, right) = (px(middle.x - half, middle.y), px(middle.x + half, middle.y));
    match sample {
        Sample::Status(status) => symbol::status_sign(status, middle, 0.5 * text),
        Sample::Plain(status) => symbol::hole(status, middle, 0.4 * text, [0.0, 1.0], 1.0),
        Sample::Pen(pen) => vec![DrawCommand::line(left, right, palette::pen(pen, text))],
        Sample::Line(pen, style) => {
            let ink = palette::ink(pen, Some(style), text, text);
            let inset = if style.width.is_some() { ink.width / 2.0 } else { 0.0 };
            let end = left.x + palette::SAMPLE * text;
            vec![DrawCommand::line(px(left.x + inset, left.y), px(end - inset, left.y), ink)]
        }
        Sample::Sign(sign) => symbol::sign(sign, middle, SIGN * text),
        Sample::Zero => symbol::zero(middle, 0.8 * ZERO * text, palette::pen(Pen::Edge, text)),
        Sample::Projection(projection) => symbol::projection(projection, middle, text),
        // Shades have a row of their own height.
        Sample::Shades(..) | Sample::Nothing => Vec::new(),
        Sample::Direction => symbol::arrow(left, right, Ink::solid(0.08 * text, palette::TEXT), 0.5 * text),
        Sample::Displacement => displacement_commands(left, right, 0.3 * text, text).into(),
        Sample::HoleInZone => {
            let ink = palette::thin(text, palette::TEXT);
            vec![DrawCommand::Ring { centre: middle, radius: 0.28 * text, ink }]
        }
        Sample::Deviation => {
            let end = px(middle.x + 0.3 * text, middle.y - 0.2 * text);
            let color = palette::status_colour(HoleStatus::Good);
            vec![
                DrawCommand::Ring { centre: middle, radius: 0.62 * text, ink: palette::zone(text) },
                DrawCommand::line(middle, end, Ink::solid((0.13 * text).max(1.5), color)),
                DrawCommand::Disc { centre: end, radius: (0.17 * text).max(1.8), color },
            ]
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{FileFormat, HoleStatus, Size, TopView, draw, top_view};

    fn svg(verdict: String) -> String {
        let view = TopView { verdict: Some((HoleStatus::Good, verdict)), ..TopView::default() };
        String::from_utf8(draw(&top_view(&view), Size::default(), FileFormat::Svg).unwrap()).unwrap()
    }

    /// Ten lines are more than other rows have; each aspect that was not checked is there.
    #[test]
    fn a_verdict_is_whole() {
        let aspects: Vec<String> = (1..=20).map(|number| format!("aspect-{number}")).collect();
        let picture = svg(format!("PASS; not checked: {}", aspects.join(", ")));
        assert!(aspects.iter().all(|aspect| picture.contains(aspect)), "{picture}");
    }

    /// More than fits on the sheet is cut, and its end says so.
    #[test]
    fn a_verdict_longer_than_the_sheet_is_cut() {
        let aspects: Vec<String> = (1..=900).map(|number| format!("aspect-{number}")).collect();
        let picture = svg(format!("PASS; not checked: {}", aspects.join(", ")));
        assert!(picture.contains("aspect-1,") && !picture.contains("aspect-900") && picture.contains('…'));
    }
}
