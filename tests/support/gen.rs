//! Cases of kind `gen`: the main programs and the machine file that `job.toml` becomes. The resident macros stand in
//! `macros/` and `examples/`, where they are compared byte for byte.
use std::fmt::Write;

use gcode_gen::package::file_name;
use gcode_part::job::Job;

use crate::Case;

/// Emits `job.toml` and compares what belongs to it alone with `emitted.snap`; nothing is run here.
pub(crate) fn run(case: &Case) {
    let job = Job::parse(&case.text("job.toml")).unwrap_or_else(|error| panic!("{}: {error}", case.name()));
    let mut shown = String::new();
    let package = gcode_gen::families::emit(&job);
    let mains: Vec<_> = package.mains.iter().map(|number| file_name(*number)).collect();
    for (name, text) in
        package.files().into_iter().filter(|(name, _)| mains.contains(name) || name == "machine.toml")
    {
        let _ = write!(shown, "==== {name}\n{text}");
    }
    case.snapshot("emitted", &shown);
}
