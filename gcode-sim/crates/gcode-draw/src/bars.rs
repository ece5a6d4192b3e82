//! Bar charts: horizontal bars below one another, each with its name and its value.
use super::font::Font;
use super::ink::{Align, DrawCommand, Rect, px};
use super::palette;
use super::role::HoleStatus;
use super::sheet::Sheet;
use super::size::Size;
use super::words::Words;
use super::{PictureError, paint, png};

/// A bar chart with a title and notes.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    /// Title above the bars.
    pub title: String,
    /// Lines below the title.
    pub notes: Vec<String>,
    /// Bars from top to bottom; the last ones are omitted and counted in a note if the page is too short.
    pub bars: Vec<Bar>,
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

impl Bars {
    /// Draws the chart as a PNG file of exactly this size.
    ///
    /// # Errors
    /// [`PictureError::Encode`] if the PNG encoder fails.
    pub fn draw(&self, size: Size) -> Result<Vec<u8>, PictureError> {
        png(&paint(&self.lay_out(size)))
    }

    /// Places names at the left, bars behind the longest name, and leaves room for the longest value at the
    /// right.
    fn lay_out(&self, size: Size) -> Sheet {
        let font = Font::embedded();
        let text = size.text();
        let page = Rect::new(0.0, 0.0, f64::from(size.width()), f64::from(size.height())).grown(-2.0 * text);
        let mut words = Words::new(&font, text);
        let mut y = words.head(&page, &self.title, &self.notes) + 1.5 * text;
        let begin = y - 0.3 * text;
        let longest = |of: &dyn Fn(&Bar) -> String| {
            self.bars.iter().map(|bar| font.width(&of(bar), text)).fold(0.0, f64::max)
        };
        let names = longest(&|bar| bar.name.clone()).min(0.3 * page.width());
        let numbers = longest(&|bar| bar.text.clone()).min(0.3 * page.width());
        let left = page.left + names + text;
        let full = (page.right - numbers - text - left).max(0.0);
        let room = ((page.bottom - y) / (2.0 * text)) as usize;
        let shown = if self.bars.len() <= room { self.bars.len() } else { room.saturating_sub(1) };
        // Few bars are thicker, so that they fill the page.
        let pitch = ((page.bottom - y) / shown.max(1) as f64).clamp(2.0 * text, 4.0 * text);
        let longest = self.bars.iter().map(|bar| bar.length).fold(f64::MIN_POSITIVE, f64::max);
        for bar in &self.bars[..shown] {
            let length = full * (bar.length / longest).clamp(0.0, 1.0);
            let (top, bottom) = (y, y + pitch - 0.7 * text);
            let corners =
                [px(left, top), px(left + length, top), px(left + length, bottom), px(left, bottom)];
            words.commands.push(DrawCommand::Area {
                points: corners.to_vec(),
                color: palette::status_colour(HoleStatus::Good),
            });
            let base = (top + bottom) / 2.0 + 0.4 * text;
            let dark = palette::TEXT;
            words.write(px(page.left, base), Align::Left, text, dark, &bar.name, names);
            let behind = px(left + length + 0.5 * text, base);
            words.write(behind, Align::Left, text, dark, &bar.text, numbers);
            y += pitch;
        }
        let mut notes = Vec::new();
        if shown < self.bars.len() {
            let note = format!("{} smaller ones not shown", self.bars.len() - shown);
            let below = px(page.left, y + 1.05 * text);
            words.write(below, Align::Left, text, palette::SOFT_TEXT, &note, page.width());
            notes.push(note);
        }
        words.commands.push(DrawCommand::line(px(left, begin), px(left, y), 1.0, palette::RULE));
        let Words { commands: inks, labels, .. } = words;
        Sheet { size, commands: inks, labels, notes, magnification: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bars(count: usize) -> Bars {
        let bar = |n: usize| Bar {
            name: format!("rotary.centre.{n}"),
            length: 1.0 / (n + 1) as f64,
            text: format!("{:.1} %, 0.0123 mm", 100.0 / (n + 1) as f64),
        };
        Bars {
            title: "Shares".to_owned(),
            notes: vec!["a note".to_owned()],
            bars: (0..count).map(bar).collect(),
        }
    }

    #[test]
    fn no_text_covers_another_and_all_are_on_the_sheet() {
        for (width, height) in [(1200, 800), (640, 480), (2000, 500)] {
            let size = Size::new(width, height).unwrap();
            for count in [0, 1, 12, 60] {
                let sheet = bars(count).lay_out(size);
                let page = Rect::new(0.0, 0.0, f64::from(width), f64::from(height));
                for (index, (place, words)) in sheet.labels.iter().enumerate() {
                    assert!(page.contains(place), "{words:?} at {place:?}");
                    let free = sheet.labels[..index].iter().all(|(other, _)| !place.overlaps(other));
                    assert!(free, "{words:?} covers another, {width}x{height}, {count}");
                }
                assert_eq!(sheet.notes.is_empty(), sheet.labels.len() == 2 + 2 * count);
            }
        }
    }

    #[test]
    fn a_bar_half_as_long_is_half_as_long() {
        let sheet = bars(2).lay_out(Size::new(1200, 800).unwrap());
        let lengths: Vec<f64> = sheet
            .commands
            .iter()
            .filter_map(|ink| match ink {
                DrawCommand::Area { points, .. } => Some(points[1].x - points[0].x),
                _ => None,
            })
            .collect();
        assert!((lengths[0] - 2.0 * lengths[1]).abs() < 1e-9 && lengths[0] > 300.0, "{lengths:?}");
    }
}
