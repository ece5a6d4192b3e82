//! Positions of a long run in little memory: axis by axis, in pieces, each in the smallest form that has the same bits.
use gcode_lang::motion::{MAX_AXES, Position};

/// Number of positions of a piece.
const PIECE: usize = 256;

/// Number of units of a coordinate in a millimetre or a degree.
const UNITS: f64 = 10_000.0;

/// Positions by their indices.
#[derive(Clone, Debug, Default)]
pub(super) struct Positions {
    pieces: Vec<Piece>,
    /// Positions of the last piece, up to [`PIECE`].
    open: Vec<Position>,
}

/// Some positions: the first of them, and the coordinates of the axes that move.
#[derive(Clone, Debug)]
struct Piece {
    first: Position,
    moving: Box<[(u8, AxisPiece)]>,
}

impl Piece {
    fn of(positions: &[Position]) -> Self {
        let first = positions.first().copied().unwrap_or_default();
        let is_moving = |axis: &usize| {
            positions.iter().any(|position| position[*axis].to_bits() != first[*axis].to_bits())
        };
        let of = |axis: usize| (axis as u8, AxisPiece::of(positions.iter().map(|position| position[axis])));
        Self { first, moving: (0..MAX_AXES).filter(is_moving).map(of).collect() }
    }

    fn get(&self, index: usize) -> Position {
        let mut position = self.first;
        for (axis, piece) in &self.moving {
            position[usize::from(*axis)] = piece.get(index);
        }
        position
    }
}

/// Coordinates of one axis in a piece.
#[derive(Clone, Debug)]
enum AxisPiece {
    /// Whole numbers of ten-thousandths: the nearest number to each has the bits of the coordinate.
    Units(Box<[i32]>),
    /// The same, as multiples of `unit` above the first.
    Offsets { first: i32, unit: i32, offsets: Box<[i16]> },
    /// Any others.
    Numbers(Box<[f64]>),
}

impl AxisPiece {
    fn of(coordinates: impl Iterator<Item = f64> + Clone) -> Self {
        let is_same = |a: f64, b: f64| a.to_bits() == b.to_bits();
        let units = |one: f64| {
            let units = (one * UNITS).round() as i32;
            is_same(f64::from(units) / UNITS, one).then_some(units)
        };
        let all: Option<Box<[i32]>> = coordinates.clone().map(units).collect();
        let Some(all) = all else { return Self::Numbers(coordinates.collect()) };
        [10, 1].into_iter().find_map(|unit| Self::offsets(&all, unit)).unwrap_or(Self::Units(all))
    }

    /// Returns the offsets from the first of some coordinates; `None` if one is too large or no multiple of `unit`.
    fn offsets(units: &[i32], unit: i32) -> Option<Self> {
        let first = *units.first()?;
        let offset = |one: &i32| {
            let offset = one.checked_sub(first)?;
            (offset % unit == 0).then(|| i16::try_from(offset / unit).ok())?
        };
        Some(Self::Offsets { first, unit, offsets: units.iter().map(offset).collect::<Option<_>>()? })
    }

    fn get(&self, index: usize) -> f64 {
        match self {
            Self::Units(units) => f64::from(units[index]) / UNITS,
            Self::Offsets { first, unit, offsets } => {
                f64::from(first + unit * i32::from(offsets[index])) / UNITS
            }
            Self::Numbers(all) => all[index],
        }
    }
}

impl Positions {
    /// Appends a position.
    pub(super) fn push(&mut self, position: Position) {
        self.open.push(position);
        if self.open.len() == PIECE {
            self.pieces.push(Piece::of(&self.open));
            self.open.clear();
        }
    }

    pub(super) fn len(&self) -> usize {
        self.pieces.len() * PIECE + self.open.len()
    }

    /// Returns a position.
    pub(super) fn get(&self, index: usize) -> Position {
        match self.pieces.get(index / PIECE) {
            Some(piece) => piece.get(index % PIECE),
            None => self.open[index % PIECE],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_returns_the_same_bits() {
        let kinds: [fn(usize) -> f64; 8] = [
            |_| -0.0,
            |n| n as f64 / 1000.0,
            |n| -(n as f64) / 1000.0 * 129.0,
            |n| -(n as f64) / 10_000.0 * 129.0,
            |n| if n % 2 == 0 { 214_748.0 } else { -214_748.0 },
            |n| 0.1 + n as f64 / 10.0,
            |n| (n as f64).sqrt(),
            |n| n as f64 * 1e6,
        ];
        for kind in kinds {
            let mut all = Positions::default();
            let position = |n: usize| Position([kind(n), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, kind(2 * n)]);
            (0..3 * PIECE / 2).for_each(|n| all.push(position(n)));
            assert_eq!(all.len(), 3 * PIECE / 2);
            for n in 0..all.len() {
                assert_eq!(all.get(n).0.map(f64::to_bits), position(n).0.map(f64::to_bits), "{n}");
            }
        }
    }
}
