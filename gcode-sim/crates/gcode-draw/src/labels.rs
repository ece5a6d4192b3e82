//! Finds a free position for every label: near its symbol, else farther away on a leader, else none.
//!
//! The search is greedy and deterministic: the most important label first, each at its cheapest free
//! position. A label never covers anything in the area, so two labels never overlap.
use super::ink::{Px, Rect, px};
use super::obstacle::Obstacle;
use super::path_cover::PathCover;
use super::scene::Align;
use gcode_lang::units::Deg;

/// The symbol that a label belongs to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Symbol {
    pub(super) position: Px,
    /// Least distance of labels from the centre, pixels.
    pub(super) clearance: f64,
    pub(super) leader_rule: LeaderRule,
}

/// Obstacles that a leader may cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LeaderRule {
    /// None; the leader ends at the symbol's rim.
    Clear,
    /// Symbols that overlap its own; the leader ends at the symbol's centre.
    OutOfCrowd,
    /// All symbols, but no label.
    ThroughAll,
}

impl Symbol {
    fn align(&self, rect: &Rect) -> Align {
        let aside = rect.centre().x - self.position.x;
        match rect.width() / 4.0 {
            middle if middle < aside => Align::Left,
            middle if aside < -middle => Align::Right,
            _ => Align::Centre,
        }
    }

    fn leader(&self, rect: &Rect) -> (Px, Px) {
        let (at, end) = (self.position, rect.nearest(self.position));
        let length = at.distance(end).max(1e-9);
        let start = if self.leader_rule == LeaderRule::OutOfCrowd { 0.0 } else { self.clearance };
        (at.toward([(end.x - at.x) / length, (end.y - at.y) / length], start), end)
    }
}

/// Position of a label, and its leader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LabelPlacement {
    pub(super) rect: Rect,
    pub(super) leader: Option<(Px, Px)>,
    /// Alignment of the text: lines of unequal length keep to the side towards the symbol.
    pub(super) align: Align,
}

/// The area for labels and its obstacles, sorted into cells for fast queries.
#[derive(Clone)]
pub(super) struct LabelArea {
    area: Rect,
    cell: f64,
    columns: usize,
    cells: Vec<Vec<Obstacle>>,
    /// Lines that a label may interrupt if no better position is free.
    soft_obstacles: Vec<Obstacle>,
    /// Lines of tool paths, which labels avoid where a position nearby is free of them.
    path_cover: PathCover,
}

const DIRECTIONS: u32 = 24;
/// Distances between symbol and label in line heights; from the second on the label has a leader.
const DISTANCES: [f64; 12] = [0.2, 0.7, 1.2, 1.8, 2.6, 3.6, 5.0, 6.5, 9.0, 12.0, 16.0, 21.0];
/// Cost of a label that lies on tool paths throughout, in the costs of a distance of half a line height.
const PATH_COST: f64 = 6.0;
/// Number of distances tried for a label whose leader must not cross other symbols.
const NEAR_DISTANCES: usize = 8;

impl LabelArea {
    pub(super) fn new(area: Rect, cell: f64) -> Self {
        let columns = (area.width() / cell).max(0.0) as usize + 1;
        let rows = (area.height() / cell).max(0.0) as usize + 1;
        Self {
            area,
            cell,
            columns,
            cells: vec![Vec::new(); columns * rows],
            soft_obstacles: Vec::new(),
            path_cover: PathCover::new(area, 0.3 * cell),
        }
    }

    /// Adds an obstacle that no label may cover.
    pub(super) fn block(&mut self, obstacle: Obstacle) {
        let cells = self.touched_cells(&obstacle.bounds());
        for index in cells {
            self.cells[index].push(obstacle);
        }
    }

    /// Adds an obstacle that labels avoid if possible.
    pub(super) fn discourage(&mut self, obstacle: Obstacle) {
        self.soft_obstacles.push(obstacle);
    }

    /// Adds a piece of a tool path, which labels avoid if a position nearby is free.
    pub(super) fn cover(&mut self, from: Px, to: Px) {
        self.path_cover.add(from, to);
    }

    pub(super) fn is_free(&self, rect: &Rect) -> bool {
        self.area.contains(rect)
            && self.touched_cells(rect).into_iter().all(|i| self.cells[i].iter().all(|o| !o.hits(rect)))
    }

    /// Places a label of this size beside a symbol and blocks its position; `line` is the height of a text
    /// line.
    pub(super) fn place(
        &mut self,
        symbol: Symbol,
        (width, height): (f64, f64),
        line: f64,
    ) -> Option<LabelPlacement> {
        let Symbol { position: at, clearance: clear, .. } = symbol;
        let reach =
            if symbol.leader_rule == LeaderRule::ThroughAll { DISTANCES.len() } else { NEAR_DISTANCES };
        let mut best: Option<(f64, LabelPlacement)> = None;
        for (step, distance) in DISTANCES.iter().take(reach).enumerate() {
            for turn in 0..DIRECTIONS {
                // The search starts at the upper right and alternates sides: readers expect a number there.
                let side = if turn % 2 == 0 { 1.0 } else { -1.0 };
                let off = f64::from(turn.div_ceil(2)) * side * 360.0 / f64::from(DIRECTIONS);
                let angle = Deg(-30.0 + off);
                let cost = distance * 2.0 + off.abs() / 180.0;
                if best.is_some_and(|(least, _)| least <= cost) {
                    continue;
                }
                let direction = [angle.cos(), angle.sin()];
                let far = clear + distance * line;
                // The box touches the circle of radius `far` with a side or a corner.
                let lean = direction.map(|part| (1.5 * part).clamp(-1.0, 1.0));
                let middle = px(
                    at.x + direction[0] * far + lean[0] * width / 2.0,
                    at.y + direction[1] * far + lean[1] * height / 2.0,
                );
                let rect = Rect::around(middle, (width, height));
                if !self.is_free(&rect) {
                    continue;
                }
                let is_doubtful = self.is_nearer_to_another(&rect, symbol);
                let leader = (symbol.leader_rule != LeaderRule::Clear || 0 < step || is_doubtful)
                    .then(|| symbol.leader(&rect));
                if leader.is_some_and(|leader| self.is_crossed(leader, symbol)) {
                    continue;
                }
                let doubt = if is_doubtful { 3.0 } else { 0.0 };
                let covered = self.soft_obstacles.iter().filter(|o| o.hits(&rect)).count();
                let cost = cost + doubt + 2.0 * covered as f64 + PATH_COST * self.path_cover.share(&rect);
                if best.is_none_or(|(least, _)| cost < least) {
                    best = Some((cost, LabelPlacement { rect, leader, align: symbol.align(&rect) }));
                }
            }
        }
        let (_, spot) = best?;
        self.block(Obstacle::Box(spot.rect));
        if let Some((from, to)) = spot.leader {
            self.block(Obstacle::Segment(from, to));
        }
        Some(spot)
    }

    /// Centres a label on the first free point of `middles`.
    pub(super) fn place_on(
        &mut self,
        middles: impl IntoIterator<Item = Px>,
        size: (f64, f64),
    ) -> Option<LabelPlacement> {
        let rects = middles.into_iter().map(|middle| Rect::around(middle, size));
        let rect = rects.into_iter().find(|rect| self.is_free(rect))?;
        self.block(Obstacle::Box(rect));
        Some(LabelPlacement { rect, leader: None, align: Align::Centre })
    }

    /// Returns true if a reader would assign the label to another symbol.
    fn is_nearer_to_another(&self, rect: &Rect, symbol: Symbol) -> bool {
        let own = rect.nearest(symbol.position).distance(symbol.position) - symbol.clearance;
        let cells = self.touched_cells(&rect.grown(1.5 * own.max(0.0)));
        cells.into_iter().flat_map(|i| &self.cells[i]).any(|o| match *o {
            Obstacle::Disc { centre, radius } => {
                symbol.clearance < centre.distance(symbol.position)
                    && rect.nearest(centre).distance(centre) - radius < 1.5 * own
            }
            Obstacle::Box(_) | Obstacle::Ring { .. } | Obstacle::Segment(..) => false,
        })
    }

    /// Returns true if an obstacle lies across the leader.
    fn is_crossed(&self, (from, to): (Px, Px), symbol: Symbol) -> bool {
        let passable = |o: &Obstacle| match (symbol.leader_rule, *o) {
            (LeaderRule::Clear, _) | (_, Obstacle::Box(_) | Obstacle::Ring { .. }) => false,
            (LeaderRule::ThroughAll, Obstacle::Disc { .. } | Obstacle::Segment(..)) => true,
            (LeaderRule::OutOfCrowd, Obstacle::Disc { centre, radius }) => {
                centre.distance(symbol.position) < symbol.clearance + radius
            }
            (LeaderRule::OutOfCrowd, Obstacle::Segment(a, b)) => {
                a.distance(symbol.position).min(b.distance(symbol.position)) < 2.0 * symbol.clearance
            }
        };
        let bounds = Obstacle::Segment(from, to).bounds();
        let cells = self.touched_cells(&bounds);
        cells.into_iter().any(|i| self.cells[i].iter().any(|o| !passable(o) && o.crosses(from, to)))
    }

    fn touched_cells(&self, rect: &Rect) -> Vec<usize> {
        let rows = self.cells.len() / self.columns;
        let clamp = |v: f64, most: usize| ((v / self.cell).max(0.0) as usize).min(most - 1);
        let [left, right] = [rect.left, rect.right].map(|x| clamp(x - self.area.left, self.columns));
        let [top, bottom] = [rect.top, rect.bottom].map(|y| clamp(y - self.area.top, rows));
        (top..=bottom).flat_map(|row| (left..=right).map(move |column| row * self.columns + column)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn symbol(x: f64, y: f64, clear: f64) -> Symbol {
        Symbol { position: px(x, y), clearance: clear, leader_rule: LeaderRule::Clear }
    }

    fn field() -> LabelArea {
        LabelArea::new(Rect::new(0.0, 0.0, 400.0, 300.0), 40.0)
    }

    #[test]
    fn a_label_without_neighbours_is_at_the_upper_right() {
        let spot = field().place(symbol(200.0, 150.0, 10.0), (30.0, 12.0), 12.0).unwrap();
        assert!(200.0 < spot.rect.left && spot.rect.bottom < 150.0, "{spot:?}");
        assert_eq!(spot.leader, None);
    }

    #[test]
    fn a_label_in_a_corner_stays_on_the_sheet() {
        let spot = field().place(symbol(398.0, 2.0, 5.0), (60.0, 24.0), 12.0).unwrap();
        assert!(Rect::new(0.0, 0.0, 400.0, 300.0).contains(&spot.rect), "{spot:?}");
    }

    #[test]
    fn a_label_without_room_beside_its_symbol_gets_a_leader() {
        let mut field = field();
        field.block(Obstacle::Ring { centre: px(200.0, 150.0), radius: 16.0 });
        let spot = field.place(symbol(200.0, 150.0, 10.0), (30.0, 12.0), 12.0).unwrap();
        assert!(!Obstacle::Ring { centre: px(200.0, 150.0), radius: 16.0 }.hits(&spot.rect));
        field.block(Obstacle::Disc { centre: px(100.0, 100.0), radius: 26.0 });
        let spot = field.place(symbol(100.0, 100.0, 10.0), (30.0, 12.0), 12.0);
        // The leader itself would cross the disc that fills the surroundings.
        assert_eq!(spot, None);
    }

    #[test]
    fn a_full_field_takes_no_label() {
        let mut field = field();
        field.block(Obstacle::Box(Rect::new(0.0, 0.0, 400.0, 300.0)));
        assert_eq!(field.place(symbol(200.0, 150.0, 10.0), (30.0, 12.0), 12.0), None);
    }

    proptest! {
        #[test]
        fn no_two_labels_overlap_and_none_leaves_the_area(
            symbols in prop::collection::vec((0.0f64..400.0, 0.0f64..300.0, 8.0f64..70.0), 1..60),
        ) {
            let mut field = field();
            for (x, y, _) in &symbols {
                field.block(Obstacle::Disc { centre: px(*x, *y), radius: 5.0 });
            }
            let mut placed: Vec<LabelPlacement> = Vec::new();
            for (x, y, width) in &symbols {
                placed.extend(field.place(symbol(*x, *y, 6.0), (*width, 12.0), 12.0));
            }
            for (i, spot) in placed.iter().enumerate() {
                prop_assert!(Rect::new(0.0, 0.0, 400.0, 300.0).contains(&spot.rect));
                for other in &placed[i + 1..] {
                    prop_assert!(!spot.rect.overlaps(&other.rect));
                }
                for (x, y, _) in &symbols {
                    prop_assert!(5.0 <= spot.rect.nearest(px(*x, *y)).distance(px(*x, *y)) + 1e-9);
                }
            }
        }
    }
}
