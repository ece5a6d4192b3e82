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

mod block_marks;
mod calls;
mod checked_blocks;
mod components;
mod computed_jumps;
mod context;
mod control_flow;
mod expressions;
mod first_reach;
mod jump_targets;
mod literal;
mod loader;
mod locals;
mod main_programs;
mod modes;
mod parameters;
mod piece;
mod piece_ends;
mod pieces;
mod possible_modes;
mod possible_units;
mod prelude;
#[cfg(test)]
mod property_tests;
mod repetition;
mod role;
mod rule;
pub mod rules;
mod suppression;
mod text_behind_end;
mod units;
mod unset_reads;
mod vacancy;
mod variables;
mod whole_program;

pub use calls::{Argument, CallSite, CalledProgramName, call_site, called_programs};
pub use checked_blocks::CheckedBlocks;
pub use context::CONTROL_ASSUMED;
pub use expressions::{UsedExpressions, ValueUse, block_expressions};
pub use literal::{constant, variable};
pub use main_programs::{main_programs, programs_called_by_others, reachable_programs};

use context::CheckContext;
use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::program::{Library, Memory, Program};
use gcode_lang::source::{Bytes, Span};
use gcode_lang::syntax::KnownBlocks;
use loader::Loader;
use piece_ends::PieceSizes;
use pieces::PieceRules;
pub use variables::{is_common, variables_read};

/// Result of a check: the findings and the texts they refer to.
#[derive(Debug)]
pub struct CheckResult {
    /// Checked programs with their texts.
    pub memory: Memory,
    /// Number of checked programs: those of the file and those they call.
    pub programs: usize,
    /// Findings in the order of the programs and their blocks.
    pub findings: Vec<Diagnostic>,
    /// Number of findings beyond the limit.
    pub left_over: usize,
    /// Blocks of the first text, for [`check_edited`].
    pub blocks: CheckedBlocks,
}

/// Whether the settings of a check are those of the control that executes the programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlKnowledge {
    /// A file or the caller states the control.
    Stated,
    /// The settings are the defaults: options and codes of the machine builder may add what they lack.
    Assumed,
}

impl ControlKnowledge {
    /// Makes a finding that options of the control may remove a note if the control is assumed.
    fn unless_optional(self, finding: Diagnostic) -> Diagnostic {
        match self {
            Self::Stated => finding,
            Self::Assumed => finding.with_severity(Severity::Note).note(CONTROL_ASSUMED),
        }
    }
}

/// Limit of the findings that are kept of a program with more than 100,000 blocks: an editor shows no more.
#[derive(Clone, Copy)]
pub struct FindingLimit<'a> {
    /// Largest number of findings of a kind, the first in the text.
    pub of_kind: usize,
    /// Returns true for a finding that is shown; no other one is kept.
    pub is_shown: &'a dyn Fn(&Diagnostic) -> bool,
}

impl FindingLimit<'_> {
    /// Keeps all findings.
    pub const NONE: Self = Self { of_kind: usize::MAX, is_shown: &|_| true };
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
    memory: Memory,
    settings: &Settings,
    knowledge: ControlKnowledge,
    library: &mut impl Library,
) -> CheckResult {
    check_known((memory, KnownBlocks::default()), (settings, knowledge), FindingLimit::NONE, library)
}

/// Checks a file as [`check_loaded`] does. Blocks of an earlier state of its text are not read again where it is the same, and
/// the rules about a block alone do not look at them again.
pub fn check_edited(
    (name, bytes): (String, Bytes),
    before: CheckedBlocks,
    control: (&Settings, ControlKnowledge),
    limit: FindingLimit<'_>,
    library: &mut impl Library,
) -> CheckResult {
    let known = before.moved_to(&bytes, control.0);
    let mut memory = Memory::default();
    memory.load_known(name, bytes, &known);
    check_known((memory, known), control, limit, library)
}

fn check_known(
    texts: (Memory, KnownBlocks),
    (settings, knowledge): (&Settings, ControlKnowledge),
    limit: FindingLimit<'_>,
    library: &mut impl Library,
) -> CheckResult {
    let rules = PieceRules { knowledge, sizes: PieceSizes::USUAL, limit };
    let mut result = check_sized(texts, settings, library, rules);
    text_behind_end::leave_out(&mut result);
    result
}

fn check_sized(
    (mut memory, mut known): (Memory, KnownBlocks),
    settings: &Settings,
    library: &mut impl Library,
    rules: PieceRules<'_>,
) -> CheckResult {
    let mut loader = Loader::new(&mut memory, settings, library);
    loader.load_found(&mut known, rules.sizes.whole);
    if loader.may_numbers_matter() {
        loader.restore(rules.sizes.whole);
    }
    let mut found = check_programs(&mut loader, &mut known, rules);
    if loader.repetitions.stand_for_found() {
        loader.restore(rules.sizes.whole);
        found = check_programs(&mut loader, &mut known, rules);
    }
    let (findings, left_over) = found;
    let Loader { loaded, long, .. } = loader;
    let programs = loaded.len() + long.len();
    let blocks = match long.is_empty() {
        true => CheckedBlocks::new(&memory, settings, loaded),
        false => CheckedBlocks::default(),
    };
    CheckResult { programs, memory, findings, left_over, blocks }
}

/// Returns the findings of all programs, and the number of those beyond the limit: the long ones in pieces if that is possible,
/// otherwise they are loaded too.
fn check_programs<L: Library>(
    loader: &mut Loader<'_, L>,
    known: &mut KnownBlocks,
    rules: PieceRules<'_>,
) -> (Vec<Diagnostic>, usize) {
    if !loader.long.is_empty() {
        if let Some(found) = pieces::findings(loader, rules) {
            return found;
        }
        loader.load_long(known);
    }
    let units = std::mem::take(&mut loader.loaded);
    let mut context =
        CheckContext::new(loader.memory, (loader.settings, rules.knowledge), units, rules::codes());
    for unit in &mut context.units {
        unit.left_out = loader.repetitions.left_out(unit.id);
    }
    let findings = rules::findings(&context);
    loader.loaded = context.into_loaded();
    loader.repetitions.note_found(&findings);
    (findings, 0)
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
