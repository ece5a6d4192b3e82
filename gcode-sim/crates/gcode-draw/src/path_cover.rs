//! Grid of the places on a sheet through which tool paths run, so that labels can avoid a million lines as quickly as ten.
use super::ink::{Px, Rect, px};

/// Cells of a sheet, each with or without a line.
#[derive(Clone, Debug)]
pub(super) struct PathCover {
    area: Rect,
    cell: f64,
    columns: usize,
    is_covered: Vec<bool>,
}

impl PathCover {
    pub(super) fn new(area: Rect, cell: f64) -> Self {
        let count = |length: f64| (length / cell).max(0.0) as usize + 1;
        let (columns, rows) = (count(area.width()), count(area.height()));
        Self { area, cell, columns, is_covered: vec![false; columns * rows] }
    }

    /// Covers the cells that a line runs through; what lies outside the sheet is left out.
    pub(super) fn add(&mut self, from: Px, to: Px) {
        let steps = (2.0 * from.distance(to) / self.cell).ceil().clamp(1.0, 20_000.0);
        for step in 0..=steps as u32 {
            let share = f64::from(step) / steps;
            let at = px(from.x + (to.x - from.x) * share, from.y + (to.y - from.y) * share);
            if let Some(index) = self.index(at) {
                self.is_covered[index] = true;
            }
        }
    }

    fn index(&self, at: Px) -> Option<usize> {
        let (right, down) = (at.x - self.area.left, at.y - self.area.top);
        let is_inside =
            0.0 <= right && 0.0 <= down && right <= self.area.width() && down <= self.area.height();
        is_inside.then(|| (down / self.cell) as usize * self.columns + (right / self.cell) as usize)
    }

    /// Returns the part of a rectangle's cells that lines run through, 0 to 1.
    pub(super) fn share(&self, rect: &Rect) -> f64 {
        let range = |from: f64, to: f64, start: f64| {
            let cell = |at: f64| ((at - start) / self.cell).max(0.0) as usize;
            cell(from)..=cell(to)
        };
        let rows = self.is_covered.len() / self.columns;
        let down = range(rect.top, rect.bottom, self.area.top);
        let across = range(rect.left, rect.right, self.area.left);
        let cells = down.flat_map(|row| across.clone().map(move |column| (row, column)));
        let cells: Vec<_> = cells.filter(|(row, column)| *row < rows && *column < self.columns).collect();
        let covered =
            cells.iter().filter(|(row, column)| self.is_covered[row * self.columns + column]).count();
        covered as f64 / cells.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells of 10 pixels; the line runs through those of one row.
    #[test]
    fn a_rectangle_is_covered_where_a_line_runs_through_it() {
        let mut cover = PathCover::new(Rect::new(0.0, 0.0, 100.0, 50.0), 10.0);
        cover.add(px(0.0, 25.0), px(99.0, 25.0));
        assert_eq!(cover.share(&Rect::new(1.0, 31.0, 38.0, 8.0)), 0.0);
        assert_eq!(cover.share(&Rect::new(1.0, 21.0, 38.0, 8.0)), 1.0);
        // Two rows, of which the line has one.
        assert_eq!(cover.share(&Rect::new(1.0, 21.0, 38.0, 18.0)), 0.5);
        cover.add(px(-500.0, -500.0), px(-400.0, -400.0));
        assert_eq!(cover.share(&Rect::new(0.0, 0.0, 100.0, 9.0)), 0.0, "outside the sheet");
    }
}
