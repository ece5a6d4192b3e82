//! What can be known of a program without running it: faults that a control would meet, and slips it would not notice.
//!
//! The program and the ones it calls by number are read into one subject (`subject`): their blocks with the ways from
//! one to another (`flow`), what is called from where (`calls`), which locals are vacant where (`vacancy`) and read
//! there (`unset`). The rules, a file each in [`rules`], look at that and say what they find. A comment
//! `(CHECK-OFF NAME)` on a block, or at the head of a program for all of it, silences a rule there (`silence`).
#![warn(missing_docs)]

mod calls;
mod components;
mod context;
mod control_flow;
mod expressions;
mod first_reach;
mod literal;
mod parameters;
pub mod rules;
mod suppression;
mod unset_reads;
mod vacancy;
mod variables;

use std::collections::BTreeSet;

pub use calls::{CalledProgramName, called_programs as called};

use context::CheckContext;
use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::program::{Library, Memory, Program, ProgramId};
use gcode_lang::source::{Bytes, Span};
pub use variables::variables_read;

/// Result of a check: the findings and the texts they refer to.
#[derive(Debug)]
pub struct CheckResult {
    /// Checked programs with their texts.
    pub memory: Memory,
    /// Number of checked programs: those of the file and those they call.
    pub programs: usize,
    /// Findings in the order of the programs and their blocks.
    pub findings: Vec<Diagnostic>,
}

/// Checks all programs of a file and the programs that they call.
///
/// A file without a program has no findings, and `programs` is 0.
pub fn check(
    name: impl Into<String>,
    bytes: impl Into<Bytes>,
    settings: &Settings,
    library: &mut impl Library,
) -> CheckResult {
    let mut memory = Memory::default();
    memory.load(name, bytes);
    check_loaded(memory, settings, library)
}

/// Checks the programs in memory as [`check`] does.
pub fn check_loaded(mut memory: Memory, settings: &Settings, library: &mut impl Library) -> CheckResult {
    let programs = load_called_programs(&mut memory, settings, library);
    let context = CheckContext::new(&memory, settings, &programs, rules::names());
    let findings = rules::findings(&context);
    CheckResult { programs: programs.len(), memory, findings }
}

/// Returns the programs in memory, followed by the programs that they call, as far as these are found.
fn load_called_programs(
    memory: &mut Memory,
    settings: &Settings,
    library: &mut impl Library,
) -> Vec<ProgramId> {
    let mut found: Vec<_> = memory.ids().collect();
    let mut known: BTreeSet<_> = found.iter().copied().collect();
    let mut next = 0;
    while let Some(id) = found.get(next) {
        for target in calls::called_programs(memory.lower_program(*id), settings) {
            let called = match target {
                CalledProgramName::Number(number) => memory.fetch(number, library),
                CalledProgramName::Name(name) => memory.fetch_name(&name, library),
                CalledProgramName::Computed | CalledProgramName::Missing => None,
            };
            found.extend(called.filter(|called| known.insert(*called)));
        }
        next += 1;
    }
    found
}

impl CheckResult {
    /// Returns true if there is an error or a warning; notes do not count.
    pub fn has_findings(&self) -> bool {
        self.count(Severity::Warning) + self.count(Severity::Error) > 0
    }

    /// Returns the number of findings of one severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|finding| finding.severity == severity).count()
    }

    /// Returns the program that contains a place.
    pub fn program(&self, span: Span) -> Option<&Program> {
        self.memory.program_at(span)
    }
}
