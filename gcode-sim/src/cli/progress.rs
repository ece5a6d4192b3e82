//! A line on standard error for who waits longer than a second, none where nobody watches; Ctrl-C ends a run with what is
//! known so far.
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use super::output;
use gcode_control::Progress;
use gcode_session::Request;

/// Wider than any line shown.
const WIDTH: usize = 60;

/// Does the work, and meanwhile shows how much of `all` is counted.
pub(super) fn with_progress<T>(all: usize, counted: &AtomicUsize, work: impl FnOnce() -> T) -> T {
    let bar = || {
        let part = (counted.load(Ordering::Relaxed) as f64 / all.max(1) as f64).min(1.0);
        format!("[{:<40}] {:3.0} %", "#".repeat((part * 40.0) as usize), part * 100.0)
    };
    showing(bar, work)
}

/// Does the work, and meanwhile shows how many of `all` cases are done.
pub(super) fn of_cases<T>(all: usize, done: &AtomicUsize, work: impl FnOnce() -> T) -> T {
    showing(|| format!("{} of {all} cases", done.load(Ordering::Relaxed)), work)
}

/// Runs a program, and meanwhile shows how many blocks it has executed. The first Ctrl-C ends the run, the second the
/// process.
pub(super) fn of_run<T>(request: &mut Request, work: impl FnOnce(&Request) -> T) -> T {
    let run = Arc::new(Progress::default());
    request.progress = Some(Arc::clone(&run));
    let watched = Arc::clone(&run);
    // Where no handler can be set, Ctrl-C ends the process as ever.
    _ = ctrlc::set_handler(move || {
        if watched.cancel.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let count = || format!("{} blocks; Ctrl-C ends the run", run.blocks.load(Ordering::Relaxed));
    showing(count, || work(request))
}

/// Does the work, and after a second shows what `line` says of it again and again.
fn showing<T>(line: impl Fn() -> String + Sync, work: impl FnOnce() -> T) -> T {
    if !std::io::stderr().is_terminal() {
        return work();
    }
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let watcher = scope.spawn(|| show(&line, &done));
        let answer = work();
        done.store(true, Ordering::Relaxed);
        watcher.thread().unpark();
        answer
    })
}

fn show(line: &impl Fn() -> String, done: &AtomicBool) {
    std::thread::park_timeout(Duration::from_secs(1));
    let mut shown = false;
    while !done.load(Ordering::Relaxed) {
        output::print_message(&format!("\r{:<WIDTH$}", line()));
        shown = true;
        std::thread::park_timeout(Duration::from_millis(100));
    }
    if shown {
        output::print_message(&format!("\r{:WIDTH$}\r", ""));
    }
}
