//! Texts of a chart, each with its box: title, notes, names and numbers.
use super::font::Font;
use super::ink::{DrawCommand, Px, Rect, Rgb, px};
use super::palette;
use super::scene::Align;
use super::sheet::Sheet;
use super::size::Size;

pub(super) struct Words<'f> {
    pub(super) font: &'f Font,
    /// Height of ordinary text, pixels.
    pub(super) text_size: f64,
    pub(super) sheet: Sheet,
}

impl<'f> Words<'f> {
    pub(super) fn new(font: &'f Font, text_size: f64, size: Size) -> Self {
        Self { font, text_size, sheet: Sheet::empty(size.page()) }
    }

    /// Writes a larger title and a line for each note from the page's top; returns the last base line.
    pub(super) fn head(&mut self, page: &Rect, title: &str, notes: &[String]) -> f64 {
        let text = self.text_size;
        let mut y = page.top + 1.4 * text;
        self.write(px(page.left, y), Align::Left, 1.4 * text, palette::TEXT, title, page.width());
        for note in notes {
            y += 1.6 * text;
            self.write(px(page.left, y), Align::Left, text, palette::SOFT_TEXT, note, page.width());
        }
        y
    }

    /// Writes a text on the base line through `at` unless it would cover another.
    pub(super) fn write_if_free(&mut self, at: Px, align: Align, size: f64, color: Rgb, words: &str) {
        let rect = self.rect(at, align, size, words);
        if self.sheet.labels.iter().all(|(other, _)| !other.overlaps(&rect)) {
            self.write(at, align, size, color, words, f64::INFINITY);
        }
    }

    /// Writes a text on the base line through `at`, shortened to `width`.
    pub(super) fn write(&mut self, at: Px, align: Align, size: f64, color: Rgb, words: &str, width: f64) {
        let words = self.font.fitted(words, size, width);
        let rect = self.rect(at, align, size, &words);
        self.sheet.labels.push((rect, vec![words.clone()]));
        self.sheet.commands.push(DrawCommand::Text { at, align, size, text: words, color });
    }

    /// Returns the box of a text on the base line through `at`.
    pub(super) fn rect(&self, at: Px, align: Align, size: f64, words: &str) -> Rect {
        let wide = self.font.width(words, size);
        Rect::new(at.x - align.fraction_left() * wide, at.y - size, wide, 1.2 * size)
    }
}
