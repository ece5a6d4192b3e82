//! Two revisions of a program held against each other by what they do: holes, motion, stops, and what they leave behind.
//!
//! Nothing of the text is compared: sequence numbers, spaces, comments, names of locals and the way a number is written
//! make no difference unless the control does something else because of them.
mod align;
mod holes;
mod left;
mod motion;
mod record;
mod steps;
mod store;

use serde::Serialize;

pub use record::{MOST_STEPS, Record, Revision, Totals, Where};
pub use store::StoreError;

use self::align::align;

/// One difference that matters.
#[derive(Clone, Debug, Serialize)]
pub struct Change {
    /// A stable name such as `hole-moved`.
    pub code: &'static str,
    /// What is different, with numbers and units; makes sense alone.
    pub message: String,
    /// The first block of the old revision that does it, where there is one.
    pub old: Option<Where>,
    /// … and of the new one.
    pub new: Option<Where>,
}

impl Change {
    fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into(), old: None, new: None }
    }

    fn once_at(self, place: Option<&Where>) -> Self {
        Self { old: place.cloned(), ..self }
    }

    fn now_at(self, place: Option<&Where>) -> Self {
        Self { new: place.cloned(), ..self }
    }
}

/// Everything that is different: how the runs ended and the holes first, then the motion that no changed hole explains, then the rest.
///
/// `tolerance` is in mm, and in degrees for axes that turn: what differs by less is the same.
pub fn changes(old: &Record, new: &Record, tolerance: f64) -> Vec<Change> {
    let links = align(&old.steps, &new.steps, tolerance);
    let holes = holes::compare(old, new, &links, tolerance);
    let mut all: Vec<Change> = left::outcome(old, new).into_iter().collect();
    all.extend(holes.changes);
    all.extend(motion::compare(old, new, &links, &holes.moved, tolerance));
    all.extend(left::compare(old, new, tolerance));
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
