//! What is drawn of dashed lines already, so that no piece is drawn twice: dashes would fill each other's gaps.
use std::collections::BTreeMap;

use crate::scene::{Point, Shape, Stroke, Style};

/// Cells of a view through which lines of earlier runs go, with their directions: dashes of two lines so close would fill each
/// other's gaps, as of two arcs on one circle with other chords.
pub(super) struct DrawnCells {
    low: Point,
    cell: f64,
    columns: usize,
    rows: usize,
    /// Directions of the lines through each cell, as bits.
    directions: Vec<u16>,
    /// Cells and directions of the current run.
    pending: Vec<(usize, u16)>,
}

/// Distance below which two lines are one on the sheet, in parts of the extent of the views: two pixels.
pub(super) const SAME_LINE: f64 = 0.0015;
/// Number of directions of a line in half a turn.
const LINE_DIRECTIONS: f64 = 16.0;

impl DrawnCells {
    pub(super) fn new([low, high]: [Point; 2], cell: f64) -> Self {
        let count = |axis: usize| ((high[axis] - low[axis]) / cell).clamp(0.0, 2000.0) as usize + 1;
        let (columns, rows) = (count(0), count(1));
        Self { low, cell, columns, rows, directions: vec![0; columns * rows], pending: Vec::new() }
    }

    /// Calls `each` with points along a segment, a cell apart, as column and row.
    fn walk(&self, [from, to]: [Point; 2], mut each: impl FnMut(i64, i64)) {
        let steps = (distance(from, to) / self.cell).ceil().clamp(1.0, 4000.0);
        for step in 0..=steps as u32 {
            let share = f64::from(step) / steps;
            let at = |axis: usize| {
                ((from[axis] + (to[axis] - from[axis]) * share - self.low[axis]) / self.cell).floor() as i64
            };
            each(at(0), at(1));
        }
    }

    fn index(&self, column: i64, row: i64) -> Option<usize> {
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        (column < self.columns && row < self.rows).then(|| row * self.columns + column)
    }

    /// Returns true if lines of earlier runs in nearly the same direction go beside all of a segment.
    pub(super) fn covers(&self, segment: [Point; 2]) -> bool {
        let direction = direction_bit(segment);
        let near = direction | direction.rotate_left(1) | direction.rotate_right(1);
        let mut is_covered = true;
        self.walk(segment, |column, row| {
            let has_line = |across: i64, up: i64| {
                self.index(column + across, row + up).is_some_and(|index| self.directions[index] & near != 0)
            };
            is_covered &= (-1..=1).any(|across| (-1..=1).any(|up| has_line(across, up)));
        });
        is_covered
    }

    pub(super) fn add(&mut self, segment: [Point; 2]) {
        let direction = direction_bit(segment);
        let mut cells = Vec::new();
        self.walk(segment, |column, row| cells.extend(self.index(column, row)));
        self.pending.extend(cells.into_iter().map(|index| (index, direction)));
    }

    /// Ends a run: the next ones are compared with it.
    pub(super) fn end_run(&mut self) {
        for (index, direction) in self.pending.drain(..) {
            self.directions[index] |= direction;
        }
    }
}

/// Returns the direction of a segment, without its sense, as one of 16 bits.
fn direction_bit([from, to]: [Point; 2]) -> u16 {
    let angle = libm::atan2(to[1] - from[1], to[0] - from[0]) / std::f64::consts::PI;
    1 << ((angle * LINE_DIRECTIONS).round() as i64).rem_euclid(LINE_DIRECTIONS as i64)
}

/// Segments that are drawn, by the lines on which they lie, so that no piece of a dashed line is drawn twice.
pub(super) struct DrawnSegments {
    /// Distance of lines that a sheet can't tell apart, mm.
    grid: f64,
    /// Pieces by direction and distance of their line from the origin: positions along it.
    pieces: BTreeMap<(i64, i64), Vec<[f64; 2]>>,
}

/// Number of directions that are told apart in a unit of their components.
const DIRECTIONS: f64 = 1e5;

impl DrawnSegments {
    pub(super) fn new(grid: f64) -> Self {
        Self { grid, pieces: BTreeMap::new() }
    }

    /// Adds a segment; returns the pieces of it that are not drawn yet, in its own direction.
    pub(super) fn add(&mut self, [from, to]: [Point; 2]) -> Vec<[Point; 2]> {
        let length = distance(from, to);
        if length < self.grid {
            return vec![[from, to]];
        }
        let along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        let is_forward = 0.0 < along[0] || along[0] == 0.0 && 0.0 < along[1];
        let axis = if is_forward { along } else { along.map(|part| -part) };
        let off = axis[0] * from[1] - axis[1] * from[0];
        let position = |point: Point| axis[0] * point[0] + axis[1] * point[1];
        let key = ((axis[1] * DIRECTIONS).round() as i64, (off / self.grid).round() as i64);
        let (mut first, mut last) = (position(from), position(to));
        if !is_forward {
            (first, last) = (last, first);
        }
        let drawn = self.pieces.entry(key).or_default();
        let mut rest = vec![[first, last]];
        for [start, end] in drawn.iter() {
            let without = |[first, last]: [f64; 2]| {
                [[first, last.min(*start)], [first.max(*end), last]].into_iter().filter(|[a, b]| a < b)
            };
            rest = rest.into_iter().flat_map(without).collect();
        }
        rest.retain(|[first, last]| self.grid <= last - first);
        drawn.push([first, last]);
        *drawn = joined(std::mem::take(drawn));
        let whole = rest.as_slice() == [[first, last]];
        rest.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if !is_forward {
            rest.reverse();
        }
        let at = |mm: f64| [axis[0] * mm - axis[1] * off, axis[1] * mm + axis[0] * off];
        let ends =
            |[first, last]: [f64; 2]| if is_forward { [at(first), at(last)] } else { [at(last), at(first)] };
        if whole { vec![[from, to]] } else { rest.into_iter().map(ends).collect() }
    }

    /// Returns the parts of a stroke that are not drawn yet; their dashes keep their places.
    pub(super) fn without_repeats(&mut self, stroke: Stroke) -> Vec<Stroke> {
        let Shape::Line(points) = &stroke.shape else { return vec![stroke] };
        let style = stroke.style.unwrap_or_default();
        let (mut parts, mut line, mut before, mut start) = (Vec::new(), Vec::new(), style.phase, style.phase);
        let mut end = |line: &mut Vec<Point>, phase: f64| {
            let points = std::mem::take(line);
            if 1 < points.len() {
                let style = Some(Style { phase, ..style });
                parts.push(Stroke { style, ..Stroke::new(stroke.pen, Shape::Line(points)) });
            }
        };
        for pair in points.windows(2) {
            for [from, to] in self.add([pair[0], pair[1]]) {
                if line.last() != Some(&from) {
                    end(&mut line, start);
                    start = before + distance(pair[0], from);
                    line = vec![from];
                }
                line.push(to);
            }
            before += distance(pair[0], pair[1]);
        }
        end(&mut line, start);
        parts.reverse();
        parts
    }
}

/// Joins pieces of a line that meet.
fn joined(mut pieces: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    pieces.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut all: Vec<[f64; 2]> = Vec::new();
    for piece in pieces {
        match all.last_mut() {
            Some(last) if piece[0] <= last[1] => last[1] = last[1].max(piece[1]),
            _ => all.push(piece),
        }
    }
    all
}

pub(super) fn distance(from: Point, to: Point) -> f64 {
    libm::hypot(to[0] - from[0], to[1] - from[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::arc;

    /// On one line, in both directions: what is drawn already is left out. A line beside it is another.
    #[test]
    fn no_piece_of_a_line_is_drawn_twice() {
        let mut drawn = DrawnSegments::new(0.01);
        assert_eq!(drawn.add([[10.0, 5.0], [30.0, 5.0]]), [[[10.0, 5.0], [30.0, 5.0]]]);
        assert_eq!(drawn.add([[30.0, 5.0], [10.0, 5.0]]), Vec::<[Point; 2]>::new());
        let rest = drawn.add([[40.0, 5.0], [0.0, 5.0]]);
        assert_eq!(rest, [[[40.0, 5.0], [30.0, 5.0]], [[10.0, 5.0], [0.0, 5.0]]]);
        assert_eq!(drawn.add([[10.0, 6.0], [30.0, 6.0]]).len(), 1);
        assert_eq!(drawn.add([[20.0, 0.0], [20.0, 30.0]]).len(), 1, "across it");
    }

    /// An arc of another run with other chords, at most 0.04 off the first one, and a line across both.
    #[test]
    fn a_line_beside_another_run_is_not_drawn_again() {
        let circle = |step: u32| -> Vec<Point> {
            arc([50.0, 50.0], [40.0, 40.0], [0.0, 90.0]).into_iter().step_by(step as usize).collect()
        };
        let mut cells = DrawnCells::new([[0.0, 0.0], [100.0, 100.0]], 0.5);
        for pair in circle(4).windows(2) {
            assert!(!cells.covers([pair[0], pair[1]]), "its own run does not count");
            cells.add([pair[0], pair[1]]);
        }
        cells.end_run();
        assert!(circle(3).windows(2).all(|pair| cells.covers([pair[0], pair[1]])));
        assert!(!cells.covers([[50.0, 50.0], [90.0, 90.0]]), "across it");
        assert!(!cells.covers([[80.0, 50.0], [80.0, 60.0]]), "beside it");
    }
}
