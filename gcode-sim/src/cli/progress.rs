//! A line on standard error for who waits longer than a second; none where nobody watches.
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use super::output;

/// Does the work, and meanwhile shows how much of `all` is counted.
pub(super) fn watched<T>(all: usize, counted: &AtomicUsize, work: impl FnOnce() -> T) -> T {
    if !std::io::stderr().is_terminal() {
        return work();
    }
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let watcher = scope.spawn(|| watch(all, counted, &done));
        let answer = work();
        done.store(true, Ordering::Relaxed);
        watcher.thread().unpark();
        answer
    })
}

fn watch(all: usize, counted: &AtomicUsize, done: &AtomicBool) {
    std::thread::park_timeout(Duration::from_secs(1));
    let mut shown = false;
    while !done.load(Ordering::Relaxed) {
        let part = (counted.load(Ordering::Relaxed) as f64 / all.max(1) as f64).min(1.0);
        let bar = "#".repeat((part * 40.0) as usize);
        output::tell(&format!("\r[{bar:<40}] {:3.0} %", part * 100.0));
        shown = true;
        std::thread::park_timeout(Duration::from_millis(100));
    }
    if shown {
        output::tell(&format!("\r{:48}\r", ""));
    }
}
