//! The embedded font (DejaVu Sans, a subset; licence in `assets/`): text widths and glyph coverage.
use ab_glyph::{Font as _, FontRef, Glyph, PxScale, ScaleFont, point};

use super::ink::Px;

/// Latin, Greek, Cyrillic and drawing symbols.
static TTF: &[u8] = include_bytes!("../assets/DejaVuSans-subset.ttf");

/// Heights in parts of the em, for placing lines of text.
pub(super) const ASCENT: f64 = 0.76;
pub(super) const DESCENT: f64 = 0.22;

pub(super) struct Font(FontRef<'static>);

impl Font {
    pub(super) fn embedded() -> Self {
        Self(FontRef::try_from_slice(TTF).expect("the embedded font is a font: every picture test reads it"))
    }

    /// Returns the bytes of the font's file.
    pub(super) fn file(&self) -> &'static [u8] {
        TTF
    }

    /// Returns the number of a character's glyph.
    pub(super) fn glyph(&self, character: char) -> u16 {
        self.0.glyph_id(character).0
    }

    /// Returns the width in pixels at an em of `size` pixels.
    pub(super) fn width(&self, text: &str, size: f64) -> f64 {
        let font = self.0.as_scaled(self.scale(size));
        text.chars().map(|c| f64::from(font.h_advance(font.glyph_id(c)))).sum()
    }

    /// Returns `text`, or the longest beginning that fits into `width` with an ellipsis.
    pub(super) fn fitted(&self, text: &str, size: f64, width: f64) -> String {
        if self.width(text, size) <= width {
            return text.to_owned();
        }
        let mut short = String::new();
        for c in text.chars() {
            short.push(c);
            if width < self.width(&format!("{short}…"), size) {
                short.pop();
                break;
            }
        }
        format!("{}…", short.trim_end())
    }

    /// Breaks a text into lines of at most `width`, at spaces but not at no-break spaces. Words wider than a
    /// line are cut short, and so is the last of more than `most` lines.
    pub(super) fn wrapped(&self, text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split(' ').filter(|word| !word.is_empty()) {
            let lines_full = most <= lines.len();
            match lines.last_mut() {
                Some(line) if self.width(&format!("{line} {word}"), size) <= width => {
                    line.push(' ');
                    line.push_str(word);
                }
                Some(line) if lines_full => {
                    *line = self.fitted(&format!("{line} {word}"), size, width);
                    break;
                }
                _ => lines.push(self.fitted(word, size, width)),
            }
        }
        lines
    }

    /// Calls `pixel(x, y, coverage)` for every pixel the text touches; `at` is its left end on the base line.
    pub(super) fn cover(&self, text: &str, size: f64, at: Px, mut pixel: impl FnMut(i64, i64, f32)) {
        let scale = self.scale(size);
        let font = self.0.as_scaled(scale);
        let mut x = at.x as f32;
        for c in text.chars() {
            let id = font.glyph_id(c);
            let glyph = Glyph { id, scale, position: point(x, at.y as f32) };
            if let Some(outlined) = font.outline_glyph(glyph) {
                let corner = outlined.px_bounds().min;
                outlined.draw(|dx, dy, coverage| {
                    pixel(corner.x as i64 + i64::from(dx), corner.y as i64 + i64::from(dy), coverage);
                });
            }
            x += font.h_advance(id);
        }
    }

    /// ab_glyph scales by ascent − descent, drawings by the em.
    fn scale(&self, size: f64) -> PxScale {
        let em = self.0.units_per_em().unwrap_or(self.0.height_unscaled());
        PxScale::from(size as f32 * self.0.height_unscaled() / em)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_of_a_drawing_is_in_the_font() {
        let font = Font::embedded();
        for c in "ABCxyz0123456789 Φ°±−×·…αβγφ⌀→≤µ‹›Жя".chars() {
            assert_ne!(font.0.glyph_id(c).0, 0, "{c}");
        }
    }

    #[test]
    fn width_grows_with_size_and_text() {
        let font = Font::embedded();
        // DejaVu Sans: all digits are 1303/2048 of the em wide.
        assert!((font.width("0123456789", 2048.0) - 13030.0).abs() < 0.5);
        assert!((font.width("8", 12.0) - 12.0 * 1303.0 / 2048.0).abs() < 0.01);
    }

    #[test]
    fn long_text_is_broken_or_cut() {
        let font = Font::embedded();
        let width = font.width("predicted by", 12.0);
        assert_eq!(font.wrapped("predicted by simulation", 12.0, width, 3), ["predicted by", "simulation"]);
        let cut = font.wrapped("predicted by simulation", 12.0, width, 1);
        assert!(cut.len() == 1 && cut[0].ends_with('…'), "{cut:?}");
        let cut = font.fitted("a_very_long_programme_name.nc", 12.0, 60.0);
        assert!(cut.ends_with('…') && font.width(&cut, 12.0) <= 60.0, "{cut}");
    }
}
