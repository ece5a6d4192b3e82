//! Pictures of a chart or of bars alone, below a title and notes.
use super::chart::Chart;
use super::font::Font;
use super::ink::{DrawCommand, Rect, px};
use super::palette;
use super::scene::{Align, HoleStatus};
use super::sheet::Sheet;
use super::size::Size;
use super::words::Words;
use super::{FileFormat, PictureError};

/// A chart or bars with a title and notes.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Title above the chart.
    pub title: String,
    /// Lines below the title.
    pub notes: Vec<String>,
    /// Contents, which fill the rest of the page.
    pub body: PlotBody,
}

/// Contents of a plot.
#[derive(Clone, Debug, PartialEq)]
pub enum PlotBody {
    /// Graphs over a common abscissa.
    Chart(Chart),
    /// Horizontal bars from top to bottom; the last ones are omitted and counted in a note if the page is too
    /// short.
    Bars(Vec<Bar>),
}

/// One bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Text to the left of the bar.
    pub name: String,
    /// Relative length, 0 to 1; the longest bar fills the width.
    pub length: f64,
    /// Text to the right of the bar.
    pub text: String,
}

impl Plot {
    /// Draws the plot as a file of exactly this size.
    ///
    /// # Errors
    /// [`PictureError::Encode`] if the PNG encoder fails.
    pub fn draw(&self, size: Size, format: FileFormat) -> Result<Vec<u8>, PictureError> {
        format.encode(&self.lay_out(size), &self.title)
    }

    /// Places title and notes above the contents.
    fn lay_out(&self, size: Size) -> Sheet {
        let font = Font::embedded();
        let text = size.text();
        let page = size.page().grown(-2.0 * text);
        let mut words = Words::new(&font, text, size);
        let top = words.head(&page, &self.title, &self.notes) + 1.4 * text;
        match &self.body {
            PlotBody::Chart(chart) => chart.draw(Rect { top, ..page }, &mut words),
            PlotBody::Bars(bars) => draw_bars(bars, Rect { top: top + 0.1 * text, ..page }, &mut words),
        }
        words.sheet
    }
}

/// Places names at the left, bars behind the longest name, and leaves room for the longest value at the right.
fn draw_bars(bars: &[Bar], area: Rect, words: &mut Words<'_>) {
    let (text, font) = (words.text_size, words.font);
    let widest = |texts: &mut dyn Iterator<Item = &String>| {
        texts.map(|one| font.width(one, text)).fold(0.0, f64::max).min(0.3 * area.width())
    };
    let names = widest(&mut bars.iter().map(|bar| &bar.name));
    let numbers = widest(&mut bars.iter().map(|bar| &bar.text));
    let left = area.left + names + text;
    let full = (area.right - numbers - text - left).max(0.0);
    let room = (area.height() / (2.0 * text)) as usize;
    let shown = if bars.len() <= room { bars.len() } else { room.saturating_sub(1) };
    // Few bars are thicker, so that they fill the page.
    let pitch = (area.height() / shown.max(1) as f64).clamp(2.0 * text, 4.0 * text);
    let longest = bars.iter().map(|bar| bar.length).fold(f64::MIN_POSITIVE, f64::max);
    let mut y = area.top;
    for bar in &bars[..shown] {
        let length = full * (bar.length / longest).clamp(0.0, 1.0);
        let rect = Rect::new(left, y, length, pitch - 0.7 * text);
        let color = palette::status_colour(HoleStatus::Good);
        words.sheet.commands.push(DrawCommand::Area { points: rect.corners(), color });
        let base = rect.centre().y + 0.4 * text;
        words.write(px(area.left, base), Align::Left, text, palette::TEXT, &bar.name, names);
        let behind = px(left + length + 0.5 * text, base);
        words.write(behind, Align::Left, text, palette::TEXT, &bar.text, numbers);
        y += pitch;
    }
    if shown < bars.len() {
        let note = format!("{} smaller ones not shown", bars.len() - shown);
        let below = px(area.left, y + 1.05 * text);
        words.write(below, Align::Left, text, palette::SOFT_TEXT, &note, area.width());
        words.sheet.notes.push(note);
    }
    let begin = px(left, area.top - 0.3 * text);
    words.sheet.commands.push(DrawCommand::line(begin, px(left, y), palette::RULE));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{ChartMarker, Curve, Graph};
    use crate::scene::Pen;

    fn chart(high: f64, length: f64) -> Chart {
        let sign = |part: f64| ChartMarker {
            position: [length * part, high],
            status: HoleStatus::Bad,
            name: "out of limits".to_owned(),
        };
        let curve = (0..=100).map(|n| [length * f64::from(n) / 100.0, high * libm::sin(f64::from(n) / 15.0)]);
        Chart {
            gaps: vec![[length / 3.0, length / 2.0]],
            x_label: "Path of the ball, mm".to_owned(),
            guides: vec![(0.3 * length, "a label".to_owned()), (0.31 * length, "another".to_owned())],
            graphs: vec![Graph {
                y_label: "Reading, mm".to_owned(),
                curves: vec![Curve { points: curve.collect(), pen: Pen::Measured, is_clipped: false }],
                band: vec![[0.0, -high / 2.0, high / 2.0], [length, -high / 2.0, high / 2.0]],
                has_zero_line: true,
                markers: vec![sign(0.9), sign(0.91)],
            }],
        }
    }

    fn bars(count: usize) -> PlotBody {
        let bar = |n: usize| Bar {
            name: format!("rotary.centre.{n}"),
            length: 1.0 / (n + 1) as f64,
            text: format!("{:.1} %, 0.0123 mm", 100.0 / (n + 1) as f64),
        };
        PlotBody::Bars((0..count).map(bar).collect())
    }

    fn plot(body: PlotBody) -> Plot {
        let title = "Readings of an edge finder along O8220.nc".to_owned();
        Plot { title, notes: vec!["a note".to_owned(), "and another one".to_owned()], body }
    }

    #[test]
    fn texts_neither_overlap_nor_leave_the_sheet() {
        let charts = [(0.083, 652.3), (1e-5, 0.02), (4.9, 12_345.0), (0.0, 0.0)];
        let charts = charts.map(|(high, length)| PlotBody::Chart(chart(high, length)));
        let plots: Vec<Plot> = charts.into_iter().chain([0, 1, 12, 60].map(bars)).map(plot).collect();
        for (width, height) in [(1200, 800), (640, 480), (2000, 500)] {
            let size = Size::new(width, height).unwrap();
            for plot in &plots {
                let sheet = plot.lay_out(size);
                for (index, (rect, words)) in sheet.labels.iter().enumerate() {
                    assert!(size.page().contains(rect), "{words:?} at {rect:?}");
                    let free = sheet.labels[..index].iter().all(|(other, _)| !rect.overlaps(other));
                    assert!(free, "{words:?} covers another, {width}x{height}");
                }
                if let PlotBody::Bars(bars) = &plot.body {
                    assert_eq!(sheet.notes.is_empty(), sheet.labels.len() == 3 + 2 * bars.len());
                }
            }
        }
    }

    /// Twice the ordinate is twice the distance from the zero line.
    #[test]
    fn a_curve_is_drawn_to_scale() {
        let mut chart = chart(0.05, 100.0);
        let graph = &mut chart.graphs[0];
        graph.curves[0].points = vec![[0.0, 0.0], [50.0, 0.02], [100.0, 0.04]];
        graph.markers.clear();
        let sheet = plot(PlotBody::Chart(chart)).lay_out(Size::default());
        let curves = sheet.commands.iter().filter_map(|command| match command {
            DrawCommand::Line { points, .. } if points.len() == 3 => Some(points),
            _ => None,
        });
        let [points] = curves.collect::<Vec<_>>()[..] else { panic!("one curve of three points") };
        let (first, middle, last) = (points[0], points[1], points[2]);
        assert!((first.y - middle.y - (middle.y - last.y)).abs() < 1e-9 && first.y - last.y > 300.0);
        assert!((middle.x - first.x - (last.x - middle.x)).abs() < 1e-9 && last.x - first.x > 1000.0);
    }

    #[test]
    fn bars_are_drawn_to_scale() {
        let sheet = plot(bars(2)).lay_out(Size::new(1200, 800).unwrap());
        let areas = sheet.commands.iter().filter_map(|command| match command {
            DrawCommand::Area { points, .. } => Some(points[1].x - points[0].x),
            _ => None,
        });
        let lengths: Vec<f64> = areas.collect();
        assert!((lengths[0] - 2.0 * lengths[1]).abs() < 1e-9 && lengths[0] > 300.0, "{lengths:?}");
    }
}
