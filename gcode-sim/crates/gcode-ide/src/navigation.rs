//! Definition and references of the symbol at a place.
use gcode_lang::syntax::ast::ProgramName;

use crate::block_entries::NAMED;
use crate::entry::EntryKind;
use crate::file_index::PlacedEntry;
use crate::head_comment::meanings;
use crate::project::{ProgramKey, Project, program_name};
use crate::scope::{VariableScope, canonical};
use crate::symbol::Symbol;
use crate::text::{FileId, Location, TextRange, line_range};

/// Use that a place makes of a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Access {
    /// Sequence number of a block, O word of a program.
    Declaration,
    /// Value read, jump, call.
    Read,
    /// Assignment, argument of a call.
    Write,
}

/// Place that refers to a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reference {
    /// Place.
    pub location: Location,
    /// Use.
    pub access: Access,
}

/// Definition of the symbol at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// Range of the symbol at the place.
    pub origin: TextRange,
    /// Places of its definition, the likeliest first.
    pub targets: Vec<NavigationTarget>,
}

/// Place to go to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NavigationTarget {
    /// File.
    pub file: FileId,
    /// Program or block.
    pub range: TextRange,
    /// Name in the range.
    pub selection: TextRange,
}

impl Project {
    /// Returns the definition of the symbol at an offset.
    pub fn definition(&self, file: FileId, offset: u32) -> Option<Definition> {
        let (symbol, origin) = self.symbol_at(file, offset)?;
        let targets = match symbol {
            Symbol::Variable { number, program, .. } => self.variable_definitions(number, program),
            Symbol::Argument { local, called, .. } => self.argument_definitions(local, called?),
            Symbol::SequenceNumber { number, programs } => {
                let found = programs.iter().filter_map(|key| self.find_number(*key, number, file, offset));
                found.map(|location| self.block_target(location)).collect()
            }
            Symbol::Program { name } => self.program_targets(&name, file),
            Symbol::ComputedVariable | Symbol::ComputedJump | Symbol::ComputedCall => return None,
        };
        (!targets.is_empty()).then_some(Definition { origin, targets })
    }

    /// Returns the references of the symbol at an offset, by the name of their file and by place.
    pub fn references(&self, file: FileId, offset: u32, with_declaration: bool) -> Vec<Reference> {
        let Some((symbol, _)) = self.symbol_at(file, offset) else { return Vec::new() };
        let mut found = self.symbol_references(&symbol, file);
        found.retain(|reference| with_declaration || reference.access != Access::Declaration);
        found
    }

    /// Returns the references in the same file.
    pub fn highlights(&self, file: FileId, offset: u32) -> Vec<Reference> {
        let mut found = self.references(file, offset, true);
        found.retain(|reference| reference.location.file == file);
        found
    }

    /// Returns all places of a symbol.
    pub(crate) fn symbol_references(&self, symbol: &Symbol, file: FileId) -> Vec<Reference> {
        let mut found = match symbol {
            Symbol::Variable { number, scope, program } => {
                self.variable_references(*number, *scope, *program)
            }
            Symbol::Argument { local, called: Some(called), .. } => {
                self.variable_references(*local, VariableScope::Local, *called)
            }
            Symbol::SequenceNumber { number, programs } => {
                programs.iter().flat_map(|key| self.number_references(*key, *number)).collect()
            }
            Symbol::Program { name } => self.program_references(name, file),
            Symbol::Argument { called: None, .. }
            | Symbol::ComputedVariable
            | Symbol::ComputedJump
            | Symbol::ComputedCall => Vec::new(),
        };
        found.sort_unstable();
        found.dedup();
        let mut by_file: Vec<_> =
            found.chunk_by(|one, other| one.location.file == other.location.file).collect();
        by_file.sort_by_key(|references| self.file_name(references[0].location.file));
        by_file.concat()
    }

    fn variable_references(&self, number: u32, scope: VariableScope, program: ProgramKey) -> Vec<Reference> {
        let number = canonical(number, self.settings());
        let mut found = Vec::new();
        let keys = match scope {
            VariableScope::Local => self.programs_of_level(program),
            _ => self.programs().map(|(key, _)| key).collect(),
        };
        for key in &keys {
            let Some(index) = self.file(key.file) else { continue };
            for entry in index.program_entries(key.program) {
                let access = match entry.kind {
                    EntryKind::Read => Access::Read,
                    EntryKind::Write => Access::Write,
                    _ => continue,
                };
                let value = match entry.value {
                    NAMED => self.named_variable(key.file, entry.range).unwrap_or(NAMED),
                    value => value,
                };
                if canonical(value, self.settings()) == number {
                    found.push(Reference {
                        location: Location { file: key.file, range: entry.range },
                        access,
                    });
                }
            }
        }
        if scope == VariableScope::Local {
            for (from, call) in self.all_calls().filter(|(_, call)| call.record.has_own_locals) {
                let arguments = call.record.arguments.iter().filter(|argument| argument.local() == number);
                let mut arguments = arguments.peekable();
                if arguments.peek().is_none() {
                    continue;
                }
                if self.called_program(from.file, &call.record.target).is_some_and(|key| keys.contains(&key))
                {
                    found.extend(arguments.map(|argument| {
                        let location = Location { file: from.file, range: call.place(argument.range()) };
                        Reference { location, access: Access::Write }
                    }));
                }
            }
        }
        found
    }

    /// Returns a sequence number of a program and the jumps to it.
    pub(crate) fn number_references(&self, key: ProgramKey, number: u32) -> Vec<Reference> {
        let places = self.sequence_numbers(key).into_iter().filter(|(other, _)| *other == number);
        places.map(|(_, reference)| reference).collect()
    }

    /// Returns the sequence numbers of a program, and the jumps to them from the whole project.
    pub(crate) fn sequence_numbers(&self, key: ProgramKey) -> Vec<(u32, Reference)> {
        let mut found = Vec::new();
        let mut push = |key: ProgramKey, entry: &PlacedEntry<'_>, access: Access| {
            let location = Location { file: key.file, range: entry.range };
            found.push((entry.value, Reference { location, access }));
        };
        let is_main = self.calls_to(key).next().is_none();
        let mut is_parameter = false;
        for entry in self.file(key.file).iter().flat_map(|index| index.program_entries(key.program)) {
            match entry.kind {
                EntryKind::ParametersBegin => is_parameter = true,
                EntryKind::ParametersEnd => is_parameter = false,
                EntryKind::Number if !is_parameter => push(key, &entry, Access::Declaration),
                EntryKind::Goto | EntryKind::LocalCall => push(key, &entry, Access::Read),
                EntryKind::ReturnTo if is_main => push(key, &entry, Access::Read),
                _ => {}
            }
        }
        for (other, _) in self.programs() {
            let Some(index) = self.file(other.file) else { continue };
            for entry in index.program_entries(other.program) {
                let programs = match entry.kind {
                    EntryKind::ReturnTo if other != key => self.return_programs(other),
                    EntryKind::StartAt => self.started_programs(other, entry.range),
                    _ => continue,
                };
                if programs.contains(&key) {
                    push(other, &entry, Access::Read);
                }
            }
        }
        found
    }

    fn program_references(&self, name: &ProgramName, from: FileId) -> Vec<Reference> {
        let targets = self.reached_programs(name, from);
        let declared = targets.iter().filter_map(|key| {
            let range = self.program(*key)?.name_range;
            let location = Location { file: key.file, range };
            Some(Reference { location, access: Access::Declaration })
        });
        let calls = self.all_calls().filter(|(key, call)| {
            let is_named = program_name(&call.record.target).as_ref() == Some(name);
            let called = || self.called_program(key.file, &call.record.target);
            is_named && called().is_none_or(|called| targets.contains(&called))
        });
        let calls = calls.map(|(key, call)| {
            let range = call.target_range().unwrap_or(call.code);
            Reference { location: Location { file: key.file, range }, access: Access::Read }
        });
        declared.chain(calls).collect()
    }

    /// Returns the block with a sequence number that a jump at an offset finds: the next one, otherwise the first.
    pub(crate) fn find_number(
        &self,
        key: ProgramKey,
        number: u32,
        file: FileId,
        offset: u32,
    ) -> Option<Location> {
        let declared = self.number_references(key, number);
        let mut places = declared.iter().filter(|reference| reference.access == Access::Declaration);
        let is_behind = |place: &&Reference| key.file != file || place.location.range.end >= offset;
        let next = places.clone().find(is_behind);
        next.or_else(|| places.next()).map(|place| place.location)
    }

    fn block_target(&self, Location { file, range: selection }: Location) -> NavigationTarget {
        let line =
            self.file(file).map(|index| line_range(index.text(), selection.start)).unwrap_or(selection);
        NavigationTarget { file, range: TextRange::new(selection.start, line.end), selection }
    }

    pub(crate) fn program_targets(&self, name: &ProgramName, from: FileId) -> Vec<NavigationTarget> {
        let keys = self.reached_programs(name, from).into_iter();
        let targets = keys.filter_map(|key| {
            let outline = self.program(key)?;
            Some(NavigationTarget { file: key.file, range: outline.range, selection: outline.name_range })
        });
        targets.collect()
    }

    /// Returns where a variable gets its value: in its own program, otherwise in the others.
    fn variable_definitions(&self, number: u32, program: ProgramKey) -> Vec<NavigationTarget> {
        let scope = VariableScope::of(number, self.settings());
        let references = self.variable_references(number, scope, program);
        let own = self.program(program).map(|outline| outline.range).unwrap_or_default();
        let is_own = |location: &Location| {
            location.file == program.file
                && own.start <= location.range.start
                && location.range.end <= own.end
        };
        let writes = references.iter().filter(|reference| reference.access == Access::Write);
        let mut writes: Vec<_> = writes.map(|reference| reference.location).collect();
        writes.sort_by_key(|location| (!is_own(location), self.file_name(location.file), *location));
        if let Some(first) = writes.first().filter(|location| is_own(location)) {
            return vec![self.block_target(*first)];
        }
        if let Some(comment) = self.meaning_range(number, program) {
            return vec![self.block_target(comment)];
        }
        writes.into_iter().map(|location| self.block_target(location)).collect()
    }

    fn meaning_range(&self, number: u32, key: ProgramKey) -> Option<Location> {
        let meanings = meanings(self.file(key.file)?, key.program);
        let meaning = meanings.into_iter().find(|meaning| meaning.number == number)?;
        Some(Location { file: key.file, range: meaning.range })
    }

    /// Returns where a macro states or first uses the local of an argument.
    fn argument_definitions(&self, local: u32, called: ProgramKey) -> Vec<NavigationTarget> {
        let stated = self.meaning_range(local, called);
        let first = || {
            let mut entries = self.file(called.file)?.program_entries(called.program);
            let read = entries.find(|entry| entry.kind == EntryKind::Read && entry.value == local)?;
            Some(Location { file: called.file, range: read.range })
        };
        if let Some(location) = stated.or_else(first) {
            return vec![self.block_target(location)];
        }
        let outline = self.program(called).into_iter();
        outline
            .map(|outline| NavigationTarget {
                file: called.file,
                range: outline.range,
                selection: outline.name_range,
            })
            .collect()
    }
}
