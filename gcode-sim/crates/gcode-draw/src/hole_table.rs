//! Table of the holes in the free part of the panel.
use super::font::{ASCENT, Font};
use super::ink::{DrawCommand, Rect, px};
use super::palette;
use super::scene::{Align, HoleStatus};
use super::symbol;

/// Rows of holes with their columns; empty where a picture has no table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct HoleTable {
    pub(super) columns: Vec<Column>,
    pub(super) rows: Vec<(HoleStatus, Vec<String>)>,
}

/// A column by its head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Column {
    pub(super) head: &'static str,
    /// Columns of the least importance are left out first where the panel is narrow.
    pub(super) importance: u8,
}

/// Least height of the text, pixels.
const LEAST_TEXT: f64 = 9.5;
/// Height of the text in parts of the panel's.
const TEXT: f64 = 0.82;
/// Line spacing and space between columns, in text heights.
const LEADING: f64 = 1.35;
const SPACE: f64 = 0.8;
/// Width of the symbol before a row, in text heights.
const SYMBOL: f64 = 1.4;
/// Least number of rows that are worth a table.
const MIN_ROWS: usize = 3;

impl HoleTable {
    /// Returns the height of all rows with their head beside a text of this height; 0 without rows.
    pub(super) fn height(&self, text: f64) -> f64 {
        let lines = if self.rows.is_empty() { 0 } else { self.rows.len() + 2 };
        LEADING * (TEXT * text).max(LEAST_TEXT) * lines as f64
    }

    /// Draws as many rows as fit, those out of tolerance before the others if not all do.
    pub(super) fn draw(&self, area: Rect, font: &Font, text: f64) -> Vec<DrawCommand> {
        let mut size = (TEXT * text).max(LEAST_TEXT);
        let mut kept: Vec<usize> = (0..self.columns.len()).collect();
        let widths = loop {
            let widths = self.widths(&kept, font, size);
            let width = SYMBOL * size + widths.iter().map(|width| width + SPACE * size).sum::<f64>();
            if width <= area.width() {
                break widths;
            }
            if LEAST_TEXT < size {
                size = (size - 0.5).max(LEAST_TEXT);
            } else {
                let least = kept.iter().copied().min_by_key(|column| self.columns[*column].importance);
                kept.retain(|column| Some(*column) != least);
            }
        };
        let left_out: Vec<&str> =
            (0..self.columns.len()).filter(|c| !kept.contains(c)).map(|c| self.columns[c].head).collect();
        let left_out = match left_out.is_empty() {
            true => Vec::new(),
            false => font.wrapped(&format!("no room for {}", left_out.join(", ")), size, area.width(), 3),
        };
        // A line is the head's, and one counts the rest.
        let all_lines = (area.height() / (LEADING * size)) as usize;
        let lines = all_lines.saturating_sub(left_out.len());
        let count = if self.rows.len() < lines { self.rows.len() } else { lines.saturating_sub(2) };
        if self.rows.is_empty() || count < MIN_ROWS.min(self.rows.len()) {
            let words = format!("no room for a table of {} holes", self.rows.len());
            let words = font.wrapped(&words, size, area.width(), 3);
            let is_fitting = !self.rows.is_empty() && words.len() <= all_lines;
            return if is_fitting {
                text_lines(words, area, area.top + ASCENT * size, size)
            } else {
                Vec::new()
            };
        }
        let mut order: Vec<usize> = (0..self.rows.len()).collect();
        if count < self.rows.len() {
            order.sort_by_key(|row| self.rows[*row].0.is_good());
            order.truncate(count);
        }
        let mut commands = Vec::new();
        let mut base = area.top + ASCENT * size;
        let mut write = |cells: Vec<&str>, color, base: f64| {
            let mut right = area.left + SYMBOL * size;
            for (index, (cell, width)) in cells.into_iter().zip(&widths).enumerate() {
                right += width + if index == 0 { 0.0 } else { SPACE * size };
                // Names begin at the left, numbers end at the right.
                let (align, x) =
                    if index == 0 { (Align::Left, right - width) } else { (Align::Right, right) };
                let (at, text) = (px(x, base), cell.to_owned());
                commands.push(DrawCommand::Text { at, align, size, text, color });
            }
        };
        write(kept.iter().map(|column| self.columns[*column].head).collect(), palette::SOFT_TEXT, base);
        let mut symbols = Vec::new();
        for row in order {
            base += LEADING * size;
            let (status, cells) = &self.rows[row];
            write(kept.iter().map(|column| cells[*column].as_str()).collect(), palette::TEXT, base);
            let at = px(area.left + 0.5 * size, base - 0.36 * size);
            symbols.extend(symbol::status_sign(*status, at, 0.42 * size));
        }
        let rest = self.rows.len() - count;
        if 0 < rest {
            let at = px(area.left, base + LEADING * size);
            commands.push(DrawCommand::text(at, size, format!("… {rest} more"), palette::SOFT_TEXT));
            base += LEADING * size;
        }
        commands.extend(text_lines(left_out, area, base + LEADING * size, size));
        commands.extend(symbols);
        commands
    }

    fn widths(&self, kept: &[usize], font: &Font, size: f64) -> Vec<f64> {
        let width = |column: &usize| {
            let head = font.width(self.columns[*column].head, size);
            self.rows.iter().map(|(_, cells)| font.width(&cells[*column], size)).fold(head, f64::max)
        };
        kept.iter().map(width).collect()
    }
}

/// Writes lines from a base line down.
fn text_lines(lines: Vec<String>, area: Rect, base: f64, size: f64) -> Vec<DrawCommand> {
    let line = |(number, text): (usize, String)| {
        let at = px(area.left, base + LEADING * size * number as f64);
        DrawCommand::text(at, size, text, palette::SOFT_TEXT)
    };
    lines.into_iter().enumerate().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(count: usize) -> HoleTable {
        let column = |(head, importance)| Column { head, importance };
        let row = |n: usize| {
            let status = if n == 30 { HoleStatus::Bad } else { HoleStatus::Good };
            (status, vec![n.to_string(), format!("{}.25", 10 * n), "12".to_owned()])
        };
        HoleTable {
            columns: [("hole", 9), ("x", 8), ("depth", 1)].map(column).into(),
            rows: (1..=count).map(row).collect(),
        }
    }

    fn texts(table: &HoleTable, width: f64, height: f64) -> Vec<String> {
        let drawn = table.draw(Rect::new(0.0, 0.0, width, height), &Font::embedded(), 20.0);
        let text = |command| match command {
            DrawCommand::Text { text, .. } => Some(text),
            _ => None,
        };
        drawn.into_iter().filter_map(text).collect()
    }

    #[test]
    fn all_rows_are_shown_where_they_fit() {
        assert_eq!(texts(&table(2), 300.0, 300.0)[..6], ["hole", "x", "depth", "1", "10.25", "12"]);
        assert_eq!(texts(&table(2), 300.0, 300.0).len(), 9);
    }

    /// Lines of 16.4 · 1.35 = 22.14 pixels: nine in 200, of which the head and the rest take one each.
    #[test]
    fn a_bad_hole_is_shown_before_good_ones_that_do_not_fit() {
        let all = texts(&table(40), 300.0, 200.0);
        assert_eq!((all.len(), all[3].as_str(), all[6].as_str()), (3 + 7 * 3 + 1, "30", "1"));
        assert_eq!(all.last().unwrap(), "… 33 more");
    }

    #[test]
    fn a_narrow_panel_leaves_the_least_important_column_out() {
        let narrow = texts(&table(3), 90.0, 300.0);
        assert_eq!(narrow[..3], ["hole", "x", "1"]);
        assert_eq!(narrow[8..].join(" "), "no room for depth");
        assert_eq!(
            texts(&table(3), 300.0, 60.0),
            ["no room for a table of 3 holes"],
            "too low for three rows"
        );
        assert!(texts(&table(3), 300.0, 15.0).is_empty(), "no room for a line");
    }
}
