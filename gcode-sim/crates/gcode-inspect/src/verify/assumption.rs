//! Denied assumptions: each is an error.
use crate::findings::ASSUMPTION;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_part::{Assumption, Total};

/// Returns an error for each assumption with its block; `total` is the number of all holes or flutes of the result.
pub fn denied_assumptions(assumptions: &[(Assumption, Backtrace)], total: Total) -> Vec<Diagnostic> {
    let error = |(assumption, backtrace): &(Assumption, Backtrace)| {
        let message = format!("{}: an assumption, and --deny forbids it", assumption.sentence(total));
        Diagnostic::new(&ASSUMPTION, message)
            .with_backtrace(backtrace.clone())
            .help("set it in the program before it is read, or state it in the machine file: tool lengths, work offsets")
    };
    assumptions.iter().map(error).collect()
}

/// Returns `2 assumptions are denied`.
pub fn denied_words(count: usize) -> String {
    if count == 1 { "1 assumption is denied".to_owned() } else { format!("{count} assumptions are denied") }
}
