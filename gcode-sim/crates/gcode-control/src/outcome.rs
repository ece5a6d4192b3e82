//! How long a run may take, and how it ends or stops.
use std::sync::atomic::{AtomicBool, AtomicU64};

use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Backtrace, StopKind};
use gcode_lang::source::Span;

/// How long a run may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Blocks executed, macro statements included.
    pub blocks: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { blocks: 10_000_000 }
    }
}

/// Between a run and who waits for it: how far it is, and whether it should end now.
#[derive(Debug, Default)]
pub struct Progress {
    /// Blocks executed, now and then.
    pub blocks: AtomicU64,
    /// Set from outside: the run ends as by its limit, and what is known so far stays.
    pub cancel: AtomicBool,
}

/// How a run ended.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// M02, M30, the M99 that ends the run, or the program's end.
    End,
    Alarm(AlarmStop),
    /// The limit of blocks or of moves, [`Progress::cancel`], or a loop that provably never ends ([`Control::endless_loop`](super::Control::endless_loop)).
    Limit,
}

/// Where and why the control stopped.
#[derive(Clone, Debug)]
pub struct AlarmStop {
    pub alarm: Alarm,
    /// The part of the block it is about.
    pub span: Span,
    /// The block, and the calls that led to it.
    pub backtrace: Backtrace,
}

/// An operator stop.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorStop {
    pub kind: StopKind,
    pub text: String,
    /// The variables that the text names, with their values.
    pub variables: Vec<(u32, f64)>,
}
