//! A picture of curves alone: a title, notes and a chart.
use super::chart::Chart;
use super::font::Font;
use super::ink::Rect;
use super::sheet::Sheet;
use super::size::Size;
use super::words::Words;
use super::{PictureError, paint, png};

/// A chart with a title and notes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// Title above the chart.
    pub title: String,
    /// Lines below the title.
    pub notes: Vec<String>,
    /// The chart, which fills the rest of the page.
    pub chart: Chart,
}

impl Plot {
    /// Draws the chart as a PNG file of exactly this size.
    ///
    /// # Errors
    /// [`PictureError::Encode`] if the PNG encoder fails.
    pub fn draw(&self, size: Size) -> Result<Vec<u8>, PictureError> {
        png(&paint(&self.lay_out(size)))
    }

    /// Places title and notes above the chart.
    fn lay_out(&self, size: Size) -> Sheet {
        let font = Font::embedded();
        let text = size.text();
        let page = Rect::new(0.0, 0.0, f64::from(size.width()), f64::from(size.height())).grown(-2.0 * text);
        let mut words = Words::new(&font, text);
        let top = words.head(&page, &self.title, &self.notes) + 1.4 * text;
        self.chart.draw(Rect { top, ..page }, &mut words);
        let Words { commands: inks, labels, .. } = words;
        Sheet { size, commands: inks, labels, notes: Vec::new(), magnification: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{ChartMarker, Curve, Graph};
    use crate::ink::DrawCommand;
    use crate::role::{HoleStatus, Pen};

    fn plot(high: f64, length: f64) -> Plot {
        let sign = |part: f64| ChartMarker {
            position: [length * part, high],
            status: HoleStatus::Bad,
            name: "too far".to_owned(),
        };
        let curve = (0..=100).map(|n| [length * f64::from(n) / 100.0, high * libm::sin(f64::from(n) / 15.0)]);
        Plot {
            title: "Readings of an edge finder along O8220.nc".to_owned(),
            notes: vec!["a note".to_owned(), "and another one".to_owned()],
            chart: Chart {
                gaps: vec![[length / 3.0, length / 2.0]],
                x_label: "Way of the ball, mm".to_owned(),
                guides: vec![(0.3 * length, "a place".to_owned()), (0.31 * length, "another".to_owned())],
                graphs: vec![Graph {
                    y_label: "Reading, mm".to_owned(),
                    curves: vec![Curve { points: curve.collect(), pen: Pen::Measured, is_clipped: false }],
                    band: vec![[0.0, -high / 2.0, high / 2.0], [length, -high / 2.0, high / 2.0]],
                    has_zero_line: true,
                    markers: vec![sign(0.9), sign(0.91)],
                }],
            },
        }
    }

    #[test]
    fn no_text_covers_another_and_all_are_on_the_sheet() {
        for (width, height) in [(1200, 800), (640, 480), (2000, 500)] {
            let size = Size::new(width, height).unwrap();
            for (high, length) in [(0.083, 652.3), (1e-5, 0.02), (4.9, 12_345.0), (0.0, 0.0)] {
                let sheet = plot(high, length).lay_out(size);
                let page = Rect::new(0.0, 0.0, f64::from(width), f64::from(height));
                for (index, (place, words)) in sheet.labels.iter().enumerate() {
                    assert!(page.contains(place), "{words:?} at {place:?}");
                    let free = sheet.labels[..index].iter().all(|(other, _)| !place.overlaps(other));
                    assert!(free, "{words:?} covers another, {width}x{height}, {high}");
                }
            }
        }
    }

    /// Twice the ordinate is twice the distance from the zero line.
    #[test]
    fn a_curve_stands_where_its_numbers_say() {
        let mut plot = plot(0.05, 100.0);
        let graph = &mut plot.chart.graphs[0];
        graph.curves[0].points = vec![[0.0, 0.0], [50.0, 0.02], [100.0, 0.04]];
        graph.markers.clear();
        let sheet = plot.lay_out(Size::default());
        let curves = sheet.commands.iter().filter_map(|ink| match ink {
            DrawCommand::Line { points, .. } if points.len() == 3 => Some(points),
            _ => None,
        });
        let [points] = curves.collect::<Vec<_>>()[..] else { panic!("one curve of three points") };
        let (first, middle, last) = (points[0], points[1], points[2]);
        assert!((first.y - middle.y - (middle.y - last.y)).abs() < 1e-9 && first.y - last.y > 300.0);
        assert!((middle.x - first.x - (last.x - middle.x)).abs() < 1e-9 && last.x - first.x > 1000.0);
    }
}
