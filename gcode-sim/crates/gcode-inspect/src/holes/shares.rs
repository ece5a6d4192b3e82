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

    /// Returns the first and the last share of all; `None` if there are none.
    pub(super) fn extent(&self) -> Option<[f64; 2]> {
        let pieces = self.pieces.iter().copied();
        pieces
            .reduce(|[first, last], [other_first, other_last]| [first.min(other_first), last.max(other_last)])
    }

    /// Returns true if some shares are between two.
    pub(super) fn meets(&self, [from, to]: [f64; 2]) -> bool {
        self.pieces.iter().any(|[first, last]| *first <= to && from <= *last)
    }

    /// Orders the pieces as the travel has them.
    pub(super) fn sort(&mut self) {
        self.pieces.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    }

    /// Joins pieces that overlap.
    pub(super) fn join(&mut self) {
        self.sort();
        self.pieces.dedup_by(|next, [_, last]| {
            let overlaps = next[0] <= *last;
            if overlaps {
                *last = last.max(next[1]);
            }
            overlaps
        });
    }

    /// Keeps the shares that are among others, which do not overlap.
    pub(super) fn keep_common(&mut self, others: &Self) {
        let both = |[first, last]: &[f64; 2]| {
            let common = [first, last].map(|share| *share);
            others.pieces.iter().filter_map(move |[from, to]| {
                let piece = [common[0].max(*from), common[1].min(*to)];
                (piece[0] <= piece[1]).then_some(piece)
            })
        };
        self.pieces = self.pieces.iter().flat_map(both).collect();
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn holds(shares: &Shares, share: f64) -> bool {
        shares.pieces().iter().any(|[first, last]| *first <= share && share <= *last)
    }

    proptest! {
        /// Joined and common shares hold a share if and only if the pieces do.
        #[test]
        fn pieces_are_sets_of_shares(
            one in prop::collection::vec((0.0..1.0f64, 0.0..0.3f64), 0..8),
            other in prop::collection::vec((0.0..1.0f64, 0.0..0.3f64), 0..8),
            at in prop::collection::vec(0.0..1.3f64, 30),
        ) {
            let shares = |pieces: &[(f64, f64)]| {
                let mut shares = Shares::default();
                shares.extend(pieces.iter().map(|(first, length)| [*first, first + length]));
                shares
            };
            let (one, other) = (shares(&one), shares(&other));
            let mut joined = other.clone();
            joined.join();
            prop_assert!(joined.pieces().windows(2).all(|pair| pair[0][1] < pair[1][0]));
            let mut common = one.clone();
            common.keep_common(&joined);
            for share in at {
                prop_assert_eq!(holds(&joined, share), holds(&other, share));
                prop_assert_eq!(holds(&common, share), holds(&one, share) && holds(&other, share));
                prop_assert_eq!(one.meets([share, share]), holds(&one, share));
            }
        }
    }
}
