//! Shares of a travel, from 0 at its start to 1 at its end.

/// Disjoint pieces of a travel, as shares of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Shares {
    pieces: Vec<[f64; 2]>,
}

impl Shares {
    /// Adds disjoint pieces.
    pub(super) fn extend(&mut self, pieces: impl IntoIterator<Item = [f64; 2]>) {
        self.pieces.extend(pieces);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    pub(super) fn pieces(&self) -> &[[f64; 2]] {
        &self.pieces
    }

    /// Takes away a piece; returns true if any of it was there.
    pub(super) fn take_away(&mut self, piece: Option<[f64; 2]>) -> bool {
        let Some([from, to]) = piece else { return false };
        let (mut index, mut is_taken) = (0, false);
        while let Some([first, last]) = self.pieces.get(index).copied() {
            if last < from || to < first {
                index += 1;
                continue;
            }
            is_taken = true;
            self.pieces.swap_remove(index);
            // What lies before and behind is disjoint from the shares taken away.
            let before = (first < from).then_some([first, from.next_down()]);
            let behind = (to < last).then_some([to.next_up(), last]);
            self.pieces.extend(before.into_iter().chain(behind));
        }
        is_taken
    }
}
