//! Shares of a travel, from 0 at its start to 1 at its end.

/// Disjoint pieces of a travel, as shares of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Shares {
    pieces: Vec<[f64; 2]>,
}

impl Shares {
    /// Adds a piece.
    pub(super) fn push(&mut self, piece: [f64; 2]) {
        self.pieces.push(piece);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    pub(super) fn pieces(&self) -> &[[f64; 2]] {
        &self.pieces
    }

    /// Returns the least and the largest share.
    pub(super) fn extent(&self) -> Option<[f64; 2]> {
        self.pieces.iter().copied().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Takes away the shares between two.
    pub(super) fn take_away(&mut self, [from, to]: [f64; 2]) {
        let mut index = 0;
        while let Some([first, last]) = self.pieces.get(index).copied() {
            if last < from || to < first {
                index += 1;
                continue;
            }
            self.pieces.swap_remove(index);
            // What lies before and behind is disjoint from the shares taken away.
            let before = (first < from).then_some([first, from.next_down()]);
            let behind = (to < last).then_some([to.next_up(), last]);
            self.pieces.extend(before.into_iter().chain(behind));
        }
    }
}
