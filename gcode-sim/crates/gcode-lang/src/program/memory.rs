//! A control's program memory: the texts, and the programs in them by number.
use std::collections::BTreeMap;

use super::{Op, OpIndex, Program, outline};
use crate::source::{Bytes, SourceId, Sources, Span};
use crate::syntax::ast::ProgramName;

/// A program in [`Memory`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ProgramId(pub u32);

/// Where a called program comes from that isn't in memory. The command line looks in folders, tests in a map.
pub trait Library {
    /// The file that holds program O`number`: its name and its bytes.
    fn program(&mut self, number: u32) -> Option<(String, Vec<u8>)>;

    /// The file that holds the program `<name>`.
    fn named(&mut self, _: &str) -> Option<(String, Vec<u8>)> {
        None
    }

    /// What couldn't be read while a program was looked for.
    fn read_error(&self) -> Option<String> {
        None
    }
}

/// Nothing but what is in memory.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoLibrary;

impl Library for NoLibrary {
    fn program(&mut self, _: u32) -> Option<(String, Vec<u8>)> {
        None
    }
}

impl<L: Library + ?Sized> Library for &mut L {
    fn program(&mut self, number: u32) -> Option<(String, Vec<u8>)> {
        (**self).program(number)
    }

    fn named(&mut self, name: &str) -> Option<(String, Vec<u8>)> {
        (**self).named(name)
    }

    fn read_error(&self) -> Option<String> {
        (**self).read_error()
    }
}

/// Programs by number and by name.
#[derive(Debug, Default)]
pub struct Memory {
    sources: Sources,
    programs: Vec<Program>,
    numbers: BTreeMap<u32, ProgramId>,
    names: BTreeMap<String, ProgramId>,
    /// Programs whose number was taken already.
    duplicates: Vec<ProgramId>,
}

impl Memory {
    /// Reads the outline of a file. Of two programs with one number the first stays, as on a control, which refuses
    /// the second: see [`Memory::refused`].
    pub fn load(&mut self, name: impl Into<String>, bytes: impl Into<Bytes>) -> SourceId {
        let source = self.sources.add(name, bytes);
        let bytes = &self.sources.get(source).bytes;
        for program in outline::programs(source, bytes) {
            let id = ProgramId(self.programs.len() as u32);
            match &program.name {
                ProgramName::Number(number) => {
                    if *self.numbers.entry(*number).or_insert(id) != id {
                        self.duplicates.push(id);
                    }
                }
                ProgramName::Name(name) => {
                    if *self.names.entry(name.clone()).or_insert(id) != id {
                        self.duplicates.push(id);
                    }
                }
                ProgramName::Unnamed => {}
            }
            self.programs.push(program);
        }
        source
    }

    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Programs that can't be called, because an earlier one has the same number or name.
    pub fn duplicates(&self) -> impl Iterator<Item = &Program> {
        self.duplicates.iter().map(|id| self.get(*id))
    }

    pub fn programs(&self) -> &[Program] {
        &self.programs
    }

    /// The programs in the order they were read.
    pub fn ids(&self) -> impl Iterator<Item = ProgramId> + use<> {
        (0..self.programs.len() as u32).map(ProgramId)
    }

    pub fn get(&self, id: ProgramId) -> &Program {
        &self.programs[id.0 as usize]
    }

    /// A program whose blocks can be [made ready](Program::ready).
    #[inline]
    pub fn get_mut(&mut self, id: ProgramId) -> Option<&mut Program> {
        self.programs.get_mut(id.0 as usize)
    }

    /// One block of a program, lowered; `None` behind the last.
    pub fn lower_block(&mut self, id: ProgramId, index: OpIndex) -> Option<&Op> {
        self.get_mut(id)?.lower_block(index).map(|(_, op)| op)
    }

    /// A program with all of its blocks lowered: [`Program::ops`].
    pub fn lower_program(&mut self, id: ProgramId) -> &Program {
        let program = &mut self.programs[id.0 as usize];
        let Program { blocks, loops, .. } = program;
        blocks.lower_all(loops);
        program
    }

    /// The place of a block, read anew.
    pub fn block_span(&self, id: ProgramId, index: OpIndex) -> Option<Span> {
        self.get(id).blocks.tree(index).map(|tree| tree.span)
    }

    /// The program with this O number.
    pub fn find(&self, number: u32) -> Option<ProgramId> {
        self.numbers.get(&number).copied()
    }

    /// The program called `<name>`; `<O0123>` is program O0123.
    pub fn find_name(&self, name: &str) -> Option<ProgramId> {
        match ProgramName::of(name.to_owned()) {
            ProgramName::Number(number) => self.find(number),
            ProgramName::Name(name) => self.names.get(&name).copied(),
            ProgramName::Unnamed => None,
        }
    }

    /// The program with this O number, asked of the library where it isn't in memory yet.
    pub fn fetch(&mut self, number: u32, library: &mut impl Library) -> Option<ProgramId> {
        if let Some(id) = self.find(number) {
            return Some(id);
        }
        let (name, bytes) = library.program(number)?;
        let first = self.programs.len();
        self.load(name, bytes);
        if self.find(number).is_none() && self.programs.get(first)?.name == ProgramName::Unnamed {
            // A file named after its program that leaves the O word out.
            self.numbers.insert(number, ProgramId(first as u32));
        }
        self.find(number)
    }

    /// The program called `<name>`, asked of the library where it isn't in memory yet.
    pub fn fetch_name(&mut self, name: &str, library: &mut impl Library) -> Option<ProgramId> {
        if let Some(id) = self.find_name(name) {
            return Some(id);
        }
        let name = match ProgramName::of(name.to_owned()) {
            ProgramName::Number(number) => return self.fetch(number, library),
            ProgramName::Name(name) => name,
            ProgramName::Unnamed => return None,
        };
        let (file, bytes) = library.named(&name)?;
        let first = self.programs.len();
        self.load(file, bytes);
        if self.find_name(&name).is_none() && self.programs.get(first)?.name == ProgramName::Unnamed {
            // A file named after its program that leaves the name out.
            self.names.insert(name.clone(), ProgramId(first as u32));
        }
        self.find_name(&name)
    }

    /// The program that a place belongs to.
    pub fn program_at(&self, span: Span) -> Option<&Program> {
        // They stand in the order of their texts, and in the order of their places there.
        let before = |p: &Program| (p.span.source, p.span.end) < (span.source, span.start);
        let found = self.programs.get(self.programs.partition_point(before))?;
        (found.span.source == span.source && found.span.start <= span.start).then_some(found)
    }
}
