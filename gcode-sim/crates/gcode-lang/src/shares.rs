//! Work on the blocks of a long program, or on the holes of a long list, shared by the cores.
use std::panic::resume_unwind;
use std::thread;

/// Number of blocks or holes from which threads share a work: fewer are done sooner than a thread starts.
const MIN_TO_SHARE: usize = 2000;

/// Returns the number of blocks or holes in the share of one thread; at least 1.
pub fn share_length(blocks: usize) -> usize {
    // The system is asked for long programs alone: the answer takes as long as the work on a short one.
    let cores = || thread::available_parallelism().map_or(1, usize::from);
    let threads = if blocks < MIN_TO_SHARE { 1 } else { cores() };
    blocks.div_ceil(threads).max(1)
}

/// Does the work of each share, all at the same time; this thread takes the first.
pub fn work_on<T: Send>(shares: impl IntoIterator<Item = T>, work: impl Fn(T) + Sync) {
    let mut shares = shares.into_iter();
    let own = shares.next();
    let work = &work;
    thread::scope(|scope| {
        for share in shares {
            scope.spawn(move || work(share));
        }
        own.map(work)
    });
}

/// Returns the results of two works on this many blocks or holes, which are done at the same time if they are many.
pub fn both<A: Send, B>(count: usize, one: impl FnOnce() -> A + Send, other: impl FnOnce() -> B) -> (A, B) {
    if count <= share_length(count) {
        return (one(), other());
    }
    thread::scope(|scope| {
        let one = scope.spawn(one);
        let other = other();
        (one.join().unwrap_or_else(|panic| resume_unwind(panic)), other)
    })
}

/// Returns the results of each item, in the order of the items.
pub fn map<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    map_shares(items, |share| share.iter().map(&work).collect())
}

/// Returns the results of each share of the items, one behind the other. The results must not depend on where a share begins.
pub fn map_shares<T: Sync, R: Send>(items: &[T], work: impl Fn(&[T]) -> Vec<R> + Sync) -> Vec<R> {
    let length = share_length(items.len());
    if items.len() <= length {
        return work(items);
    }
    let mut shares: Vec<(&[T], Vec<R>)> = items.chunks(length).map(|share| (share, Vec::new())).collect();
    work_on(&mut shares, |(share, results)| *results = work(share));
    let mut results = shares.into_iter().map(|(_, results)| results);
    let mut all = results.next().unwrap_or_default();
    results.for_each(|mut share| all.append(&mut share));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_results_are_in_the_order_of_the_items() {
        for count in [0, 1, MIN_TO_SHARE - 1, MIN_TO_SHARE, 5 * MIN_TO_SHARE + 1] {
            let items: Vec<usize> = (0..count).collect();
            assert!(map(&items, |item| 2 * item).into_iter().eq((0..count).map(|item| 2 * item)), "{count}");
        }
    }
}
