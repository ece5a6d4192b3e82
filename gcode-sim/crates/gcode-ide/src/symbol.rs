//! Symbol at a place: a variable, a sequence number, a program or an argument.
use gcode_lang::syntax::ast::ProgramName;
use gcode_lint::CalledProgramName;

use crate::block_entries::NAMED;
use crate::entry::EntryKind;
use crate::project::{ProgramKey, Project, program_name};
use crate::scope::VariableScope;
use crate::text::{FileId, TextRange, line_range};

/// Symbol that other places may refer to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// Variable with a known number.
    Variable {
        /// Number.
        number: u32,
        /// Scope.
        scope: VariableScope,
        /// Program that contains the place, which decides which local is meant.
        program: ProgramKey,
    },
    /// Variable whose number is computed: `#[#1+3]`.
    ComputedVariable,
    /// Sequence number; several programs for an M99 P in a program with several callers.
    SequenceNumber {
        /// Number.
        number: u32,
        /// Programs that may contain it.
        programs: Vec<ProgramKey>,
    },
    /// Jump whose sequence number is computed.
    ComputedJump,
    /// Program.
    Program {
        /// Name.
        name: ProgramName,
    },
    /// Call whose program is computed.
    ComputedCall,
    /// Argument of a macro call.
    Argument {
        /// Letter.
        letter: char,
        /// Local that it sets.
        local: u32,
        /// Called program; `None` if it is not in the project.
        called: Option<ProgramKey>,
    },
}

impl Project {
    /// Returns the symbol at an offset, with its range.
    pub fn symbol_at(&self, file: FileId, offset: u32) -> Option<(Symbol, TextRange)> {
        let index = self.file(file)?;
        let program = self.program_at(file, offset)?;
        let outline = self.program(program)?;
        let line = line_range(index.text(), offset);
        let mut found: Option<(Symbol, TextRange)> = None;
        // The narrowest symbol; one that ends at the offset gives way to one that contains it.
        let rank = |range: TextRange| (range.end == offset, range.len());
        let mut offer = |symbol: Symbol, range: TextRange| {
            let is_better = |(_, other): &(Symbol, TextRange)| rank(range) < rank(*other);
            if range.touches(offset) && !range.is_empty() && found.as_ref().is_none_or(is_better) {
                found = Some((symbol, range));
            }
        };
        offer(Symbol::Program { name: outline.name.clone() }, outline.name_range);
        for entry in index.entries(TextRange::new(line.start, line.end + 1)) {
            let number = entry.value;
            let symbol = match entry.kind {
                EntryKind::Number => Symbol::SequenceNumber { number, programs: vec![program] },
                EntryKind::Goto | EntryKind::LocalCall => {
                    Symbol::SequenceNumber { number, programs: vec![program] }
                }
                EntryKind::ReturnTo => {
                    Symbol::SequenceNumber { number, programs: self.return_programs(program) }
                }
                EntryKind::StartAt => {
                    let programs = self.started_programs(program, entry.range);
                    Symbol::SequenceNumber { number, programs }
                }
                EntryKind::ComputedGoto | EntryKind::ComputedReturn | EntryKind::ComputedStart => {
                    Symbol::ComputedJump
                }
                EntryKind::Read | EntryKind::Write if number == NAMED => {
                    match self.named_variable(file, entry.range) {
                        Some(number) => {
                            let scope = VariableScope::of(number, self.settings());
                            Symbol::Variable { number, scope, program }
                        }
                        None => Symbol::ComputedVariable,
                    }
                }
                EntryKind::Read | EntryKind::Write => {
                    let scope = VariableScope::of(number, self.settings());
                    Symbol::Variable { number, scope, program }
                }
                EntryKind::ComputedRead | EntryKind::ComputedWrite => Symbol::ComputedVariable,
                EntryKind::Call => {
                    let Some(call) = entry.call() else { continue };
                    let symbol = match program_name(&call.record.target) {
                        Some(name) => Symbol::Program { name },
                        None => Symbol::ComputedCall,
                    };
                    let called = self.called_program(file, &call.record.target);
                    for argument in &call.record.arguments {
                        let (letter, local) = (char::from(argument.letter), argument.local());
                        offer(Symbol::Argument { letter, local, called }, call.place(argument.range()));
                    }
                    let names_program = call.record.target != CalledProgramName::Missing;
                    if let Some(range) = call.target_range() {
                        offer(symbol.clone(), range);
                    }
                    if !names_program {
                        continue;
                    }
                    symbol
                }
                _ => continue,
            };
            offer(symbol, entry.range);
        }
        found
    }

    /// Returns the programs in which an M99 P of a program continues: its callers, or itself if it has none.
    pub(crate) fn return_programs(&self, key: ProgramKey) -> Vec<ProgramKey> {
        let mut callers: Vec<_> = self.calls_to(key).map(|(from, _)| from).collect();
        callers.dedup();
        if callers.is_empty() { vec![key] } else { callers }
    }

    /// Returns the program that the call beside a Q starts.
    pub(crate) fn started_programs(&self, key: ProgramKey, start: TextRange) -> Vec<ProgramKey> {
        let call = self
            .calls_of(key)
            .find(|call| call.block().start <= start.start && start.end <= call.block().end);
        call.and_then(|call| self.called_program(key.file, &call.record.target)).into_iter().collect()
    }
}
