//! Longest common sequence of two lists (E. Myers, *An O(ND) Difference Algorithm and Its Variations*).

/// Largest number of lost and added steps of a search for the fewest; beyond it the search continues piece by
/// piece.
pub(super) const MOST_EDITS: usize = 1_000;

/// Number of lost and added steps of each piece: those of some dozens of holes.
const EDITS_AHEAD: usize = 200;

/// Consecutive equal items of two lists: index of the first in each, and their number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct EqualRun {
    pub old: usize,
    pub new: usize,
    pub length: usize,
}

/// Appends equal items.
pub(super) fn append(runs: &mut Vec<EqualRun>, (old, new, length): (usize, usize, usize)) {
    match runs.last_mut() {
        Some(run) if (run.old + run.length, run.new + run.length) == (old, new) => run.length += length,
        _ if length > 0 => runs.push(EqualRun { old, new, length }),
        _ => {}
    }
}

/// Returns the longest common sequence of two lists of these lengths as pairs of indices, like [`common_runs`].
pub(super) fn common(old: usize, new: usize, same: impl Fn(usize, usize) -> bool) -> Vec<(usize, usize)> {
    let runs = common_runs(old, new, same).into_iter();
    runs.flat_map(|run| (0..run.length).map(move |n| (run.old + n, run.new + n))).collect()
}

/// Returns the longest common sequence of two lists of these lengths; a long one if there are more than
/// [`MOST_EDITS`] edits.
pub(super) fn common_runs(old: usize, new: usize, same: impl Fn(usize, usize) -> bool) -> Vec<EqualRun> {
    common_or_far((old, new), &same, |Middle { before, rows, columns }| {
        piece_by_piece((rows, columns), |i, j| same(before + i, before + j))
    })
}

/// Part of two lists between their equal beginnings and their equal ends.
#[derive(Clone, Copy)]
pub(super) struct Middle {
    /// Number of items before it, in each list.
    pub before: usize,
    /// Its items of the old list, and of the new one.
    pub rows: usize,
    pub columns: usize,
}

/// Returns the longest common sequence of two lists of these lengths. If there are more than [`MOST_EDITS`] edits, `far` returns the
/// equal items of the middle, with indices from its start.
pub(super) fn common_or_far(
    (old, new): (usize, usize),
    same: &impl Fn(usize, usize) -> bool,
    far: impl FnOnce(Middle) -> Vec<EqualRun>,
) -> Vec<EqualRun> {
    let shorter = old.min(new);
    let before = (0..shorter).take_while(|k| same(*k, *k)).count();
    let after = (0..shorter - before).take_while(|k| same(old - 1 - k, new - 1 - k)).count();
    let (rows, columns) = (old - before - after, new - before - after);
    let mut runs = Vec::new();
    append(&mut runs, (0, 0, before));
    if rows > 0 && columns > 0 {
        let ends = |x: usize, y: usize| x == rows && y == columns;
        let found = search((rows, columns), MOST_EDITS, |i, j| same(before + i, before + j), ends);
        for run in found.unwrap_or_else(|_| far(Middle { before, rows, columns })) {
            append(&mut runs, (before + run.old, before + run.new, run.length));
        }
    }
    append(&mut runs, (old - after, new - after, after));
    runs
}

/// Returns the longest common sequence of two lists, like [`common_runs`]. If there are too many edits, items that one list alone has
/// are left out first, see [`shared`]; its keys have indices of the lists.
pub(super) fn common_of_shared<K: IntoIterator<Item = u64>>(
    lengths: [usize; 2],
    same: impl Fn(usize, usize) -> bool,
    (key, keys): (impl Fn(usize, usize) -> u64, impl Fn(usize, usize) -> K),
) -> Vec<EqualRun> {
    common_or_far((lengths[0], lengths[1]), &same, |Middle { before, rows, columns }| {
        let key = |side: usize, index: usize| key(side, before + index);
        let [old, new] =
            shared([rows, columns], (key, |side: usize, index: usize| keys(side, before + index)));
        let mut runs = Vec::new();
        for (i, j) in common(old.len(), new.len(), |i, j| same(before + old[i], before + new[j])) {
            append(&mut runs, (old[i], new[j], 1));
        }
        runs
    })
}

/// Returns the longest common sequence of two lists of lines by their hashes, like [`common_runs`]. If there are too many
/// edits, lines that one list alone has are left out first.
pub(super) fn common_lines(hashes: [&[u64]; 2], is_equal: impl Fn(usize, usize) -> bool) -> Vec<EqualRun> {
    let same = |i: usize, j: usize| hashes[0][i] == hashes[1][j] && is_equal(i, j);
    let key = |side: usize, line: usize| hashes[side][line];
    common_of_shared(hashes.map(<[u64]>::len), same, (key, |side, line| [key(side, line)]))
}

/// Returns the indices of the items that both of two lists may have: one of an item's `keys` is the `key` of an item of the other
/// list. Both functions take the number of the list and an index.
pub(super) fn shared<K: IntoIterator<Item = u64>>(
    lengths: [usize; 2],
    (key, keys): (impl Fn(usize, usize) -> u64, impl Fn(usize, usize) -> K),
) -> [Vec<usize>; 2] {
    let filters = [0, 1].map(|side| HashFilter::of(lengths[side], |index| key(side, index)));
    let candidates = [0, 1].map(|side| {
        let may_be_shared =
            |index: &usize| keys(side, *index).into_iter().any(|key| filters[1 - side].may_contain(key));
        (0..lengths[side]).filter(may_be_shared).collect::<Vec<_>>()
    });
    let candidate_keys = [0, 1].map(|side| {
        let mut keys: Vec<u64> = candidates[side].iter().map(|index| key(side, *index)).collect();
        keys.sort_unstable();
        keys
    });
    let mut shared = candidates;
    for (side, indices) in shared.iter_mut().enumerate() {
        let other = &candidate_keys[1 - side];
        indices.retain(|index| keys(side, *index).into_iter().any(|key| other.binary_search(&key).is_ok()));
    }
    shared
}

/// Bloom filter of hashes, two bits for each: a few other hashes are found too.
struct HashFilter {
    bits: Vec<u64>,
}

impl HashFilter {
    fn of(length: usize, hash: impl Fn(usize) -> u64) -> Self {
        let mut filter = Self { bits: vec![0; (length / 4).next_power_of_two()] };
        for hash in (0..length).map(hash) {
            let (index, bits) = filter.place(hash);
            filter.bits[index] |= bits;
        }
        filter
    }

    fn place(&self, hash: u64) -> (usize, u64) {
        ((hash >> 12) as usize & (self.bits.len() - 1), 1 << (hash & 63) | 1 << (hash >> 6 & 63))
    }

    fn may_contain(&self, hash: u64) -> bool {
        let (index, bits) = self.place(hash);
        self.bits[index] & bits == bits
    }
}

/// Searches piece by piece; each piece ends at the farthest point of [`EDITS_AHEAD`] edits.
pub(super) fn piece_by_piece(
    (rows, columns): (usize, usize),
    same: impl Fn(usize, usize) -> bool,
) -> Vec<EqualRun> {
    let mut all = Vec::new();
    let (mut i, mut j) = (0, 0);
    while i < rows && j < columns {
        let left = (rows - i, columns - j);
        let piece = search(left, EDITS_AHEAD, |a, b| same(i + a, j + b), |x, y| (x, y) == left);
        let (runs, (x, y)) = piece.map_or_else(|far| far, |runs| (runs, left));
        runs.iter().for_each(|run| append(&mut all, (i + run.old, j + run.new, run.length)));
        (i, j) = (i + x, j + y);
    }
    all
}

/// Equal items up to the farthest point of a search, and that point.
type FarthestPoint = (Vec<EqualRun>, (usize, usize));

/// Searches like Myers: for every number of edits up to `most` the farthest point on each diagonal, up to the first
/// end.
///
/// # Errors
/// The equal items up to the farthest point of all, and that point, if no end is in reach.
pub(super) fn search(
    (rows, columns): (usize, usize),
    most: usize,
    same: impl Fn(usize, usize) -> bool,
    is_end: impl Fn(usize, usize) -> bool,
) -> Result<Vec<EqualRun>, FarthestPoint> {
    let (n, m) = (rows as isize, columns as isize);
    let most = (rows + columns).min(most) as isize;
    let index = |k: isize| (k + most + 1) as usize;
    let mut farthest = vec![0_isize; 2 * most as usize + 3];
    let mut history: Vec<Vec<isize>> = Vec::new();
    let (mut reached, mut by) = ((0, 0), 0);
    for edits in 0..=most {
        history.push(farthest[index(-edits - 1)..=index(edits + 1)].to_vec());
        for k in (-edits..=edits).step_by(2) {
            let down = k == -edits || k != edits && farthest[index(k - 1)] < farthest[index(k + 1)];
            let mut x = if down { farthest[index(k + 1)] } else { farthest[index(k - 1)] + 1 };
            while x < n && x - k < m && same(x as usize, (x - k) as usize) {
                x += 1;
            }
            farthest[index(k)] = x;
            if let (Ok(row), Ok(column)) = (usize::try_from(x), usize::try_from(x - k))
                && row <= rows
                && column <= columns
            {
                if is_end(row, column) {
                    return Ok(trace(&history, x, x - k));
                }
                if reached.0 + reached.1 < row + column {
                    (reached, by) = ((row, column), history.len());
                }
            }
        }
    }
    Err((trace(&history[..by], reached.0 as isize, reached.1 as isize), reached))
}

/// Collects the diagonal steps on the way back through the farthest points.
fn trace(history: &[Vec<isize>], n: isize, m: isize) -> Vec<EqualRun> {
    let mut back = Vec::new();
    let (mut x, mut y) = (n, m);
    for (edits, farthest) in history.iter().enumerate().rev() {
        let edits = edits as isize;
        let at = |k: isize| farthest[(k + edits + 1) as usize];
        let k = x - y;
        let down = k == -edits || k != edits && at(k - 1) < at(k + 1);
        let (before_x, before_y) = match (edits, down) {
            (0, _) => (0, 0),
            (_, true) => (at(k + 1), at(k + 1) - k - 1),
            (_, false) => (at(k - 1), at(k - 1) - k + 1),
        };
        let (start_x, start_y) = match (edits, down) {
            (0, _) => (0, 0),
            (_, true) => (before_x, before_y + 1),
            (_, false) => (before_x + 1, before_y),
        };
        let length = (x - start_x).min(y - start_y).max(0);
        (x, y) = (x - length, y - length);
        back.push((x as usize, y as usize, length as usize));
        (x, y) = (before_x, before_y);
    }
    let mut runs = Vec::new();
    back.into_iter().rev().for_each(|run| append(&mut runs, run));
    runs
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pairs(old: &str, new: &str) -> Vec<(usize, usize)> {
        let (old, new) = (old.as_bytes(), new.as_bytes());
        common(old.len(), new.len(), |i, j| old[i] == new[j])
    }

    /// The example of the paper: ABCABBA and CBABAC have a common sequence of four.
    #[test]
    fn the_papers_example_has_four_in_common() {
        assert_eq!(pairs("ABCABBA", "CBABAC").len(), 4);
    }

    #[test]
    fn one_inserted_step_leaves_the_others_paired() {
        assert_eq!(pairs("ABCD", "ABXCD"), [(0, 0), (1, 1), (2, 3), (3, 4)]);
        assert_eq!(pairs("ABXCD", "ABCD"), [(0, 0), (1, 1), (3, 2), (4, 3)]);
        assert_eq!(pairs("", "AB"), []);
    }

    /// A thousand holes more pecks than the fewest edits are searched for.
    #[test]
    fn steps_that_come_in_every_hole_leave_the_others_paired() {
        let (old, new) = ("abc".repeat(1000), "axxbxxc".repeat(1000));
        assert_eq!(pairs(&old, &new).len(), 3000);
        assert_eq!(pairs(&new, &old).len(), 3000);
        assert_eq!(pairs(&"a".repeat(1500), &"b".repeat(1500)), []);
    }

    /// Length of the longest common sequence by dynamic programming.
    fn longest(a: &[u8], b: &[u8]) -> usize {
        let mut table = vec![vec![0; b.len() + 1]; a.len() + 1];
        for i in 0..a.len() {
            for j in 0..b.len() {
                table[i + 1][j + 1] =
                    if a[i] == b[j] { table[i][j] + 1 } else { table[i][j + 1].max(table[i + 1][j]) };
            }
        }
        table[a.len()][b.len()]
    }

    proptest! {
        /// Few remainders, so that the filter of one list holds hashes that the other alone has.
        #[test]
        fn shared_lines_are_those_of_both_lists(
            old in prop::collection::vec((0_u64..3, 0_u64..40), 0..40),
            new in prop::collection::vec((0_u64..3, 0_u64..40), 0..40),
        ) {
            let hashes = |all: &[(u64, u64)]| -> Vec<u64> {
                all.iter().map(|(high, low)| high << 50 | low).collect()
            };
            let lists = [hashes(&old), hashes(&new)];
            let key = |side: usize, line: usize| lists[side][line];
            let shared = shared([0, 1].map(|side| lists[side].len()), (key, |side, line| [key(side, line)]));
            for side in 0..2 {
                let expected: Vec<usize> =
                    (0..lists[side].len()).filter(|k| lists[1 - side].contains(&lists[side][*k])).collect();
                prop_assert_eq!(&shared[side], &expected);
            }
        }

        #[test]
        fn the_common_sequence_is_common_and_the_longest(old in "[ABC]{0,30}", new in "[ABC]{0,30}") {
            let found = pairs(&old, &new);
            prop_assert!(found.iter().all(|(i, j)| old.as_bytes()[*i] == new.as_bytes()[*j]));
            prop_assert!(found.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 < w[1].1));
            prop_assert_eq!(found.len(), longest(old.as_bytes(), new.as_bytes()));
        }
    }
}
