//! What `diff` finds between two programs, as the tests of it ask.
use gcode_inspect::machine::Machine;
use gcode_lang::program::NoLibrary;
use gcode_review::{Change, Revision, changes};
use gcode_session::Request;

/// From how many mm on a difference is one.
const TOLERANCE: f64 = 0.0001;

/// A program, run on the machine that is taken where none is told.
pub fn revision(text: &str) -> Revision {
    revision_on(&Machine::default(), text)
}

fn revision_on(machine: &Machine, text: &str) -> Revision {
    let request = Request::new("O1.nc", text.as_bytes(), machine.clone());
    Revision::of(&request, &mut NoLibrary, None).unwrap()
}

/// What is different between two programs.
pub fn find_changes(old: &str, new: &str) -> Vec<Change> {
    find_changes_on(&Machine::default(), old, new)
}

/// What is different between two programs on a machine.
pub fn find_changes_on(machine: &Machine, old: &str, new: &str) -> Vec<Change> {
    let [old, new] = [old, new].map(|text| revision_on(machine, text).record);
    changes(&old, &new, TOLERANCE)
}

/// What is different, as `code: message`.
pub fn messages(old: &str, new: &str) -> Vec<String> {
    texts(&find_changes(old, new))
}

/// Entries as `code: message`, their headlines.
pub fn texts(found: &[Change]) -> Vec<String> {
    found.iter().map(|change| format!("{}: {}", change.code, change.message)).collect()
}

/// What is different between two programs, each entry with all that stands beside its headline: `code: message | code: message`.
pub fn effects(old: &str, new: &str) -> Vec<String> {
    effect_texts(&find_changes(old, new))
}

/// Entries with all that stands beside their headlines.
pub fn effect_texts(found: &[Change]) -> Vec<String> {
    let whole = |change: &Change| {
        let effects = change.effects().map(|(code, message)| format!("{code}: {message}"));
        effects.collect::<Vec<_>>().join(" | ")
    };
    found.iter().map(whole).collect()
}
