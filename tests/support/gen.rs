//! Cases of kind `gen`: the programs that `job.toml` becomes, as one snapshot of all files.
use std::fmt::Write;

use gcode_sim::job::Job;

use crate::Case;

/// Emits `job.toml` and holds every file against `emitted.snap`; nothing is run here.
pub(crate) fn run(case: &Case) {
    let job = Job::parse(&case.text("job.toml")).unwrap_or_else(|error| panic!("{}: {error}", case.name()));
    let mut shown = String::new();
    for (name, text) in gcode_gen::families::emit(&job).files() {
        let _ = write!(shown, "==== {name}\n{text}");
    }
    case.snapshot("emitted", &shown);
}
