//! Work on the blocks of a long program, shared by the cores.
use std::thread;

/// Number of blocks from which threads share a work: fewer are done sooner than a thread starts.
const MIN_TO_SHARE: usize = 2000;

/// Returns the number of blocks in the share of one thread; at least 1.
pub(crate) fn share_length(blocks: usize) -> usize {
    // The system is asked for long programs alone: the answer takes as long as the work on a short one.
    let cores = || thread::available_parallelism().map_or(1, usize::from);
    let threads = if blocks < MIN_TO_SHARE { 1 } else { cores() };
    blocks.div_ceil(threads).max(1)
}

/// Does the work of each share, all at the same time; this thread takes the first.
pub(crate) fn work_on<T: Send>(shares: impl IntoIterator<Item = T>, work: impl Fn(T) + Sync) {
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
