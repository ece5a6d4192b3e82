//! Two revisions of a program held against each other by what they do: holes, motion, stops, and what they leave behind.
//!
//! Nothing of the text is compared: sequence numbers, spaces, comments, names of locals and the way a number is written
//! make no difference unless the control does something else because of them.
mod align;
mod holes;
mod left;
mod motion;
mod steps;

use crate::diag::{Diagnostic, Severity};
use crate::motion::Place;
use crate::program::Library;
use crate::session::{self, Request, SessionError, Simulation};

use self::align::align;
use self::steps::{Recorder, Step};

/// One revision, executed.
#[derive(Debug)]
pub struct Revision {
    pub simulation: Simulation,
    steps: Vec<Step>,
}

/// More steps than this aren't compared: a loop that never ends must not fill the memory.
pub const MOST_STEPS: usize = 1_000_000;

impl Revision {
    /// Executes a program and writes down what the machine is told.
    pub fn of(request: &Request, library: &mut impl Library) -> Result<Self, SessionError> {
        let mut recorder = Recorder::default();
        let mut simulation = session::simulate_beside(request, library, None, &mut recorder)?;
        if recorder.too_many {
            let message = format!("more than {MOST_STEPS} moves: those behind them aren't compared");
            simulation.extracted.findings.push(Diagnostic::new(Severity::Alarm, "limit", message));
        }
        Ok(Self { simulation, steps: recorder.steps })
    }

    /// Why the run stopped before its end, or can't be compared to its end.
    pub fn stopped(&self) -> impl Iterator<Item = &Diagnostic> {
        self.simulation.extracted.findings.iter().filter(|finding| finding.severity == Severity::Alarm)
    }
}

/// One difference that matters.
#[derive(Clone, Debug)]
pub struct Change {
    /// A stable name such as `hole-moved`.
    pub code: &'static str,
    /// What is different, with numbers and units; makes sense alone.
    pub message: String,
    /// The first block of the old revision that does it, where there is one.
    pub old: Option<Place>,
    /// … and of the new one.
    pub new: Option<Place>,
}

impl Change {
    fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into(), old: None, new: None }
    }

    fn once_at(mut self, place: &Place) -> Self {
        self.old = Some(place.clone());
        self
    }

    fn now_at(mut self, place: &Place) -> Self {
        self.new = Some(place.clone());
        self
    }
}

/// Everything that is different: how the runs ended and the holes first, then the motion that no changed hole explains, then the rest.
///
/// `tolerance` is in mm, and in degrees for axes that turn: what differs by less is the same.
pub fn changes(old: &Revision, new: &Revision, tolerance: f64) -> Vec<Change> {
    let links = align(&old.steps, &new.steps, tolerance);
    let holes = holes::compare(old, new, &links, tolerance);
    let (run_old, run_new) = (&old.simulation.run, &new.simulation.run);
    let mut all: Vec<Change> = left::outcome(run_old, run_new).into_iter().collect();
    all.extend(holes.changes);
    all.extend(motion::compare(old, new, &links, &holes.moved, tolerance));
    all.extend(left::compare(run_old, run_new, tolerance));
    all
}

/// `1, 2, 5`; long lists are cut.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 6;
    if names.len() <= SHOWN {
        return names.join(", ");
    }
    format!("{} and {} more", names[..SHOWN].join(", "), names.len() - SHOWN)
}
