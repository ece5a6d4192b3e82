//! Progress of long work: a line on standard error after one second, only on a terminal. Ctrl-C ends a run
//! and keeps the results so far.
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use super::output;
use gcode_control::Progress;
use gcode_prove::Watch;
use gcode_session::Request;

/// Width of the line; larger than any line shown.
const WIDTH: usize = 60;

/// Times in a second that the line is shown.
const TICKS: usize = 10;

/// Does the work and shows which part of `all` is counted.
pub(super) fn with_progress<T>(all: usize, counted: &AtomicUsize, work: impl FnOnce() -> T) -> T {
    let bar = || {
        let part = (counted.load(Ordering::Relaxed) as f64 / all.max(1) as f64).min(1.0);
        format!("[{:<40}] {:3.0} %", "#".repeat((part * 40.0) as usize), part * 100.0)
    };
    showing(bar, work)
}

/// Does the work and shows how many of `all` cases are done.
pub(super) fn of_cases<T>(all: usize, done: &AtomicUsize, work: impl FnOnce() -> T) -> T {
    showing(|| format!("{} of {all} cases", done.load(Ordering::Relaxed)), work)
}

/// Runs a program and shows the number of executed blocks. The first Ctrl-C ends the run, the second the
/// process.
pub(super) fn of_run<T>(request: &mut Request, work: impl FnOnce(&Request) -> T) -> T {
    let run = Arc::new(Progress::default());
    request.progress = Some(Arc::clone(&run));
    let watched = Arc::clone(&run);
    // If no handler can be set, Ctrl-C ends the process as usual.
    _ = ctrlc::set_handler(move || {
        if watched.cancel.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let count = || format!("{} blocks; Ctrl-C ends the run", run.blocks.load(Ordering::Relaxed));
    showing(count, || work(request))
}

/// Runs two programs at once and shows the number of executed blocks. The first Ctrl-C ends both runs, the second the
/// process.
pub(super) fn of_two_runs<T: Send>(
    requests: [&mut Request; 2],
    run_one: impl FnOnce(&Request) -> T + Send,
    run_other: impl FnOnce(&Request) -> T + Send,
) -> [T; 2] {
    let runs: [Arc<Progress>; 2] = Default::default();
    let [one, other] = requests;
    (one.progress, other.progress) = (Some(Arc::clone(&runs[0])), Some(Arc::clone(&runs[1])));
    let watched = runs.clone();
    // If no handler can be set, Ctrl-C ends the process as usual.
    _ = ctrlc::set_handler(move || {
        if watched.iter().any(|run| run.cancel.swap(true, Ordering::Relaxed)) {
            std::process::exit(130);
        }
    });
    let count = || {
        let blocks: u64 = runs.iter().map(|run| run.blocks.load(Ordering::Relaxed)).sum();
        format!("{blocks} blocks; Ctrl-C ends the runs")
    };
    showing(count, || {
        std::thread::scope(|scope| {
            let first = scope.spawn(|| run_one(one));
            let second = run_other(other);
            [first.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), second]
        })
    })
}

/// Proves claims and shows how many boxes and runs there have been.
pub(super) fn of_proof<T>(watch: &Watch<'_>, work: impl FnOnce() -> T) -> T {
    let line = || format!("{} boxes, {} runs, {} s", watch.boxes(), watch.runs(), watch.elapsed().as_secs());
    showing(line, work)
}

/// Does work without a measure of its progress, and shows what it is and how long it takes.
pub fn of_work<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let seconds = AtomicUsize::new(0);
    let line = || format!("{what}, {} s", seconds.fetch_add(1, Ordering::Relaxed) / TICKS + 1);
    showing(line, work)
}

/// Does the work and, from one second on, repeatedly shows the text of `line`.
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
        std::thread::park_timeout(Duration::from_millis(1000 / TICKS as u64));
    }
    if shown {
        output::print_message(&format!("\r{:WIDTH$}\r", ""));
    }
}
