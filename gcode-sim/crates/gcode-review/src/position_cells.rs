//! Cells of the end points of moves, by which moves are found to which a whole list has no equal one.
use gcode_lang::motion::{MAX_AXES, Position};

use super::steps::StepKind;

/// Cubes of one size that fill the space of the axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct PositionCells {
    /// Largest deviation of equal coordinates.
    tolerance: f64,
    size: f64,
}

impl PositionCells {
    /// Creates cells in which few points are as near to a side as the tolerance.
    pub(super) fn new(tolerance: f64) -> Self {
        // More than the tolerance, so that rounding hides no equal point.
        let tolerance = tolerance * 1.001 + 1e-9;
        Self { tolerance, size: 10.0 * tolerance }
    }

    /// Returns the number of the cell of a coordinate. Whole multiples of a cell lie in its middle.
    fn cell(&self, coordinate: f64) -> i64 {
        (coordinate / self.size + 0.5).floor() as i64
    }

    /// Returns the key of a step: that of what it does and of the cell of its end. All commands have one.
    pub(super) fn key(&self, kind: &StepKind, end: &Position) -> u64 {
        end.0.iter().fold(seed(kind), |key, coordinate| mixed(key, self.cell(*coordinate)))
    }

    /// Returns the keys of all steps that are equal to a step.
    pub(super) fn keys(&self, kind: &StepKind, end: &Position) -> impl Iterator<Item = u64> + use<> {
        let cells = *self;
        let [low, high] = [-1.0, 1.0].map(|sign| end.0.map(|one| cells.cell(one + sign * cells.tolerance)));
        let seed = seed(kind);
        let doubled = (0..MAX_AXES).filter(|axis| low[*axis] != high[*axis] && seed != COMMAND).count();
        (0..1_u32 << doubled).map(move |choice| {
            let mut choice = choice;
            let mut key = seed;
            for axis in 0..MAX_AXES {
                let mut cell = low[axis];
                if low[axis] != high[axis] {
                    cell = if choice & 1 == 0 { low[axis] } else { high[axis] };
                    choice >>= 1;
                }
                key = mixed(key, cell);
            }
            key
        })
    }
}

/// Seed of all commands.
const COMMAND: u64 = 0;

fn seed(kind: &StepKind) -> u64 {
    match kind {
        StepKind::Rapid => 1,
        StepKind::Feed(_) => 2,
        StepKind::Arc(..) => 3,
        StepKind::Probe(_) => 4,
        _ => COMMAND,
    }
}

/// Returns a key with the number of one more cell. A command has no place.
fn mixed(key: u64, cell: i64) -> u64 {
    if key == COMMAND {
        return COMMAND;
    }
    let key = (key ^ cell as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (key ^ key >> 29) | 1
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::steps::near;
    use super::*;

    proptest! {
        /// Of two points as near as the tolerance, the key of one is among the keys of the other, also at the sides of cells.
        #[test]
        fn equal_points_share_a_key(
            thousandths in prop::array::uniform8(-400_000_i32..400_000),
            shifts in prop::array::uniform8(-1.0_f64..=1.0),
            cells in prop::array::uniform8(0_u8..3),
            tolerance in prop_oneof![Just(0.0), Just(1e-4), Just(0.01)],
        ) {
            let size = PositionCells::new(tolerance).size;
            let at = |axis: usize| match cells[axis] {
                0 => f64::from(thousandths[axis]) / 1000.0,
                1 => (f64::from(thousandths[axis]) + 0.5) * size,
                _ => 0.0,
            };
            let a = Position(std::array::from_fn(at));
            let b = Position(std::array::from_fn(|axis| at(axis) + shifts[axis] * tolerance));
            prop_assume!(near(&a, &b, tolerance));
            let all = PositionCells::new(tolerance);
            let kind = StepKind::Rapid;
            prop_assert!(all.keys(&kind, &a).any(|key| key == all.key(&kind, &b)));
            prop_assert!(all.keys(&kind, &b).any(|key| key == all.key(&kind, &a)));
        }
    }

    #[test]
    fn moves_of_another_kind_or_to_another_point_share_none() {
        let cells = PositionCells::new(1e-4);
        let at = |x: f64| Position([x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let key = cells.key(&StepKind::Rapid, &at(1.0));
        assert!(!cells.keys(&StepKind::Feed(1.0), &at(1.0)).any(|other| other == key));
        assert!(!cells.keys(&StepKind::Rapid, &at(1.002)).any(|other| other == key));
        // Commands are equal wherever they stand.
        let dwell = cells.key(&StepKind::Dwell(1.0), &at(1.0));
        assert!(cells.keys(&StepKind::Tool(2), &at(5.0)).eq([dwell]));
    }
}
