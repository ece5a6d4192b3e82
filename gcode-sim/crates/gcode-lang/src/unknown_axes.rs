//! Axes whose position on the part is unknown, by cause.

/// Axes of unknown position on the part as bits, axis 1 the lowest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct UnknownAxes {
    /// Axes that no absolute word has commanded since the start of the run.
    pub uncommanded: u8,
    /// Axes at machine coordinates (G28, G30, G53) while nothing has set the active work offset.
    pub at_machine_position: u8,
    /// Axes in coordinates that count from an unknown position, as after a G92 there.
    pub shifted: u8,
    /// Axes at machine coordinates whose work offset is set. The position of the gauge line is known; that of a tool of
    /// unknown length is not. None of these counts as unknown in itself.
    pub at_known_machine_position: u8,
}

impl UnknownAxes {
    /// Returns the unknown axes, of every cause.
    pub fn all(self) -> u8 {
        self.uncommanded | self.at_machine_position | self.shifted
    }

    /// Returns true if every position is known.
    pub fn is_none(self) -> bool {
        self.all() == 0
    }

    /// Returns the unknown ones of some axes.
    pub fn only(self, axes: u8) -> Self {
        self.map(|unknown| unknown & axes)
    }

    /// Returns the unknown axes after some have become known.
    pub fn without(self, axes: u8) -> Self {
        self.only(!axes)
    }

    /// Returns the axes that are unknown in either of two.
    pub fn union(self, other: Self) -> Self {
        Self {
            uncommanded: self.uncommanded | other.uncommanded,
            at_machine_position: self.at_machine_position | other.at_machine_position,
            shifted: self.shifted | other.shifted,
            at_known_machine_position: self.at_known_machine_position | other.at_known_machine_position,
        }
    }

    /// Returns the unknown axes with one group of axes as in `other`.
    pub fn with_axes_of(self, axes: u8, other: Self) -> Self {
        self.without(axes).union(other.only(axes))
    }

    /// Returns the axes with a function applied to those of each cause.
    pub fn map(self, change: impl Fn(u8) -> u8) -> Self {
        Self {
            uncommanded: change(self.uncommanded),
            at_machine_position: change(self.at_machine_position),
            shifted: change(self.shifted),
            at_known_machine_position: change(self.at_known_machine_position),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_of_axes_takes_the_causes_of_another_state() {
        let start = UnknownAxes { uncommanded: 0b111, ..UnknownAxes::default() };
        let home = UnknownAxes { at_machine_position: 0b110, ..UnknownAxes::default() };
        let mixed = start.with_axes_of(0b100, home);
        assert_eq!((mixed.uncommanded, mixed.at_machine_position, mixed.all()), (0b011, 0b100, 0b111));
        assert!(mixed.without(0b111).is_none());
    }
}
