//! Loading of the programs under check: those of the files in memory, then those that they call.
use std::collections::BTreeSet;

use gcode_lang::control::Settings;
use gcode_lang::program::{Library, Memory, ProgramId};
use gcode_lang::syntax::KnownBlocks;

use super::calls::{CallSite, CalledProgramName};
use super::context::LoadedProgram;
use super::repetition::Repetitions;

/// Programs that are found, and those of them that are loaded.
pub(super) struct Loader<'a, L> {
    pub memory: &'a mut Memory,
    pub settings: &'a Settings,
    library: &'a mut L,
    pub repetitions: Repetitions,
    pub loaded: Vec<LoadedProgram>,
    /// Programs of the files in memory that are too long to be loaded as a whole.
    pub long: Vec<ProgramId>,
    found: Vec<ProgramId>,
    known: BTreeSet<ProgramId>,
    /// Number of programs of the files in memory.
    first_called: usize,
    next: usize,
}

impl<'a, L: Library> Loader<'a, L> {
    pub(super) fn new(memory: &'a mut Memory, settings: &'a Settings, library: &'a mut L) -> Self {
        let found: Vec<_> = memory.ids().collect();
        let known = found.iter().copied().collect();
        let (loaded, long, first_called) = (Vec::new(), Vec::new(), found.len());
        let repetitions = Repetitions::default();
        Self { memory, settings, library, repetitions, loaded, long, found, known, first_called, next: 0 }
    }

    /// Returns true if a program may lead to a sequence number of another one that is left out. Of a long program it is not known.
    pub(super) fn may_numbers_matter(&self) -> bool {
        let loaded = self.loaded.iter().map(|program| program.id);
        let Self { repetitions, memory, long, .. } = self;
        repetitions.has_numbers() && (!long.is_empty() || repetitions.are_targets(memory, loaded))
    }

    /// Puts the moves back that were left out. Programs that become long are no longer loaded.
    pub(super) fn restore(&mut self, max_blocks: usize) {
        let mut repetitions = std::mem::take(&mut self.repetitions);
        let first_called = self.first_called;
        let long = repetitions.restore_long(self.memory, max_blocks, |id| (id.0 as usize) < first_called);
        self.loaded.retain(|program| !long.contains(&program.id));
        self.long.extend(long.iter().filter(|id| !self.long.contains(id)).copied().collect::<Vec<_>>());
        self.long.sort_unstable();
        repetitions.restore(self.memory, self.settings, &mut self.loaded);
    }

    /// Loads the programs that are found and not loaded, and those that they call, as far as these are found.
    ///
    /// Programs of the files in memory with more than `max_blocks` blocks are not loaded.
    pub(super) fn load_found(&mut self, known_blocks: &mut KnownBlocks, max_blocks: usize) {
        while let Some(id) = self.found.get(self.next).copied() {
            self.repetitions.leave_out(self.memory, id, self.settings);
            let is_long = max_blocks < self.memory.get(id).block_count();
            if is_long && self.next < self.first_called {
                self.long.push(id);
            } else {
                let program = LoadedProgram::new(self.memory, id, known_blocks, self.settings);
                self.find_called(id, &program.calls);
                self.loaded.push(program);
            }
            self.next += 1;
        }
    }

    /// Finds the programs that a program calls. Each program finds what a main program in its folder would find.
    pub(super) fn find_called(&mut self, caller: ProgramId, calls: &[CallSite]) {
        let Self { memory, library, found, known, .. } = self;
        let main = memory.main();
        memory.set_main(caller);
        // A missing program is looked for once, not at each of its calls.
        let mut named = BTreeSet::new();
        let targets = calls.iter().map(|call| &call.target).filter(|target| named.insert(*target));
        for target in targets {
            let called = match target {
                CalledProgramName::Number(number) => memory.fetch(*number, library),
                CalledProgramName::Name(name) => memory.fetch_name(name, library),
                CalledProgramName::Computed | CalledProgramName::Missing => None,
            };
            found.extend(called.filter(|called| known.insert(*called)));
        }
        // The help of a missing program names the one with all digits of P if it is there.
        for call in calls {
            let digits = call.digits_of_p.filter(|_| call.target.find(memory, None).is_none());
            _ = digits.and_then(|digits| memory.fetch(digits, library));
        }
        memory.set_main(main);
    }

    /// Returns true for a program that is under check because another one calls it.
    pub(super) fn is_called(&self, id: ProgramId) -> bool {
        self.first_called <= id.0 as usize
    }

    /// Loads the long programs as a whole.
    pub(super) fn load_long(&mut self, known_blocks: &mut KnownBlocks) {
        for id in std::mem::take(&mut self.long) {
            let program = LoadedProgram::new(self.memory, id, known_blocks, self.settings);
            self.find_called(id, &program.calls);
            let is_before =
                |other: &LoadedProgram| (other.id.0 as usize) < self.first_called && other.id < id;
            let place = self.loaded.partition_point(is_before);
            self.loaded.insert(place, program);
        }
        self.load_found(known_blocks, usize::MAX);
    }
}
