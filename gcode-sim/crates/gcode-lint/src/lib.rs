//! Checker of programs without a run: program text in, findings out.
//!
//! A finding is a fault at which a control raises an alarm, or a mistake that the control does not notice. The
//! programs of the file and those they call form one context (`context`): the control flow between their blocks
//! (`control_flow`), their calls (`calls`), the vacancy of local variables (`vacancy`) and the reads of unset ones
//! (`unset_reads`). Moves that repeat an earlier one are left out of it (`repetition`). Each rule, a row of
//! [`rules::ALL`], reports its findings about this context. A comment `(CHECK-OFF NAME)` on a block, or in the head of a
//! program, turns a rule off there (`suppression`).
//!
//! ```
//! use gcode_lang::control::Settings;
//! use gcode_lang::program::NoLibrary;
//!
//! let text = *b"O1\nG0 X1.5\nGOTO 90\nM30\n";
//! let result = gcode_lint::check("O1.nc", text, &Settings::default(), &mut NoLibrary);
//! assert_eq!(result.findings.len(), 1);
//! assert_eq!(result.findings[0].code(), "missing-n");
//! assert_eq!(result.findings[0].message, "PS0128: sequence number N90 is not in O0001");
//! ```
#![warn(missing_docs)]

mod calls;
mod components;
mod context;
mod control_flow;
mod expressions;
mod first_reach;
mod literal;
mod main_programs;
mod modes;
mod parameters;
mod possible_modes;
mod prelude;
mod repetition;
mod rule;
pub mod rules;
mod suppression;
mod unset_reads;
mod vacancy;
mod variables;

use std::collections::BTreeSet;

pub use calls::{Argument, CallSite, CalledProgramName, call_site, called_programs};
pub use expressions::{UsedExpressions, ValueUse, block_expressions};
pub use literal::{constant, variable};
pub use main_programs::{main_programs, programs_called_by_others};

use context::CheckContext;
use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::program::{Library, Memory, Program, ProgramId};
use gcode_lang::source::{Bytes, Span};
use repetition::Repetitions;
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

/// Whether the settings of a check are those of the control that executes the programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlKnowledge {
    /// A file or the caller states the control.
    Stated,
    /// The settings are the defaults: options and codes of the machine builder may add what they lack.
    Assumed,
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
    check_loaded(memory, settings, ControlKnowledge::Stated, library)
}

/// Checks the programs in memory as [`check`] does.
///
/// A finding that an option of the control would remove is a note if the control is assumed.
pub fn check_loaded(
    mut memory: Memory,
    settings: &Settings,
    knowledge: ControlKnowledge,
    library: &mut impl Library,
) -> CheckResult {
    let mut repetitions = Repetitions::default();
    let programs = load_called_programs(&mut memory, settings, library, &mut repetitions);
    let mut context = CheckContext::new(&memory, (settings, knowledge), &programs, rules::codes());
    for (unit, id) in context.units.iter_mut().zip(&programs) {
        unit.left_out_numbers = repetitions.take_numbers(*id);
    }
    let mut findings = rules::findings(&context);
    if !repetitions.is_exact(&context, &findings) {
        repetitions.restore(&mut memory);
        let context = CheckContext::new(&memory, (settings, knowledge), &programs, rules::codes());
        findings = rules::findings(&context);
    }
    CheckResult { programs: programs.len(), memory, findings }
}

/// Returns the programs in memory, followed by the programs that they call, as far as these are found.
fn load_called_programs(
    memory: &mut Memory,
    settings: &Settings,
    library: &mut impl Library,
    repetitions: &mut Repetitions,
) -> Vec<ProgramId> {
    let mut found: Vec<_> = memory.ids().collect();
    let mut known: BTreeSet<_> = found.iter().copied().collect();
    let (main, mut next) = (memory.main(), 0);
    while let Some(id) = found.get(next).copied() {
        // Each program finds what a main program in its folder would find.
        memory.set_main(id);
        repetitions.leave_out(memory, id, settings);
        let mut targets = calls::called_programs(memory.lower_program(id), settings);
        // A missing program is looked for once, not at each of its calls.
        let mut named = BTreeSet::new();
        targets.retain(|target| named.insert(target.clone()));
        for target in targets {
            let called = match target {
                CalledProgramName::Number(number) => memory.fetch(number, library),
                CalledProgramName::Name(name) => memory.fetch_name(&name, library),
                CalledProgramName::Computed | CalledProgramName::Missing => None,
            };
            found.extend(called.filter(|called| known.insert(*called)));
        }
        next += 1;
    }
    memory.set_main(main);
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
