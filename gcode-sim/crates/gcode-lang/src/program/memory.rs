//! Program memory of a control: the texts, and their programs by number and name.
use std::collections::BTreeMap;

use super::{Op, OpIndex, OpKind, Program, outline};
use crate::source::{Bytes, SourceId, Sources, Span};
use crate::syntax::KnownBlocks;
use crate::syntax::ast::{self, Folder, ProgramName, ProgramPath};

/// Index of a program in its [`Memory`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ProgramId(pub u32);

/// Source of called programs that are not in memory: folders for the command line, a map in tests.
pub trait Library {
    /// Returns name and content of the file that holds program O`number`.
    fn program(&mut self, number: u32) -> Option<(String, Bytes)>;

    /// Returns name and content of the file that holds program `<name>`.
    fn named(&mut self, _: &str) -> Option<(String, Bytes)> {
        None
    }

    /// Returns the failure to read a file during the last search.
    fn read_error(&self) -> Option<String> {
        None
    }
}

/// Library without programs.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoLibrary;

impl Library for NoLibrary {
    fn program(&mut self, _: u32) -> Option<(String, Bytes)> {
        None
    }
}

impl<L: Library + ?Sized> Library for &mut L {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        (**self).program(number)
    }

    fn named(&mut self, name: &str) -> Option<(String, Bytes)> {
        (**self).named(name)
    }

    fn read_error(&self) -> Option<String> {
        (**self).read_error()
    }
}

/// Folders that a control searches for a called program after that of the main program, in this order.
const COMMON_FOLDERS: [&str; 4] = ["CNC_MEM/USER/LIBRARY", "CNC_MEM/MTB2", "CNC_MEM/MTB1", "CNC_MEM/SYSTEM"];

/// Rank of folders that a control does not search.
const OUT_OF_REACH: usize = COMMON_FOLDERS.len() + 2;

/// Returns the place of a folder in the order of search from `own`, 0 for `own` itself.
fn search_rank(folder: Option<&Folder>, own: &Folder) -> usize {
    let Some(folder) = folder else { return COMMON_FOLDERS.len() + 1 };
    let common = COMMON_FOLDERS.iter().position(|path| folder.path() == *path);
    if folder == own { 0 } else { common.map_or(OUT_OF_REACH, |place| place + 1) }
}

/// Programs by number and by name.
#[derive(Debug, Default)]
pub struct Memory {
    sources: Sources,
    programs: Vec<Program>,
    main: ProgramId,
    /// Programs by name, in the order loaded; each is in another folder.
    by_name: BTreeMap<ProgramName, Vec<ProgramId>>,
    /// Programs whose number or name an earlier program has.
    duplicates: Vec<ProgramId>,
}

impl Memory {
    /// Loads a file and outlines its programs.
    ///
    /// The first of two programs with one number stays, as on a control, which refuses the second: see
    /// [`Memory::duplicates`].
    pub fn load(&mut self, name: impl Into<String>, bytes: impl Into<Bytes>) -> SourceId {
        self.load_known(name, bytes, &KnownBlocks::default())
    }

    /// Loads the first file as [`Memory::load`] does. Known blocks of it are not read again.
    pub fn load_known(
        &mut self,
        name: impl Into<String>,
        bytes: impl Into<Bytes>,
        known: &KnownBlocks,
    ) -> SourceId {
        let source = self.sources.add(name, bytes);
        let bytes = &self.sources.get(source).bytes;
        for program in outline::programs(source, bytes, known) {
            let id = ProgramId(self.programs.len() as u32);
            if program.name != ProgramName::Unnamed {
                let same_name = self.by_name.entry(program.name.clone()).or_default();
                let is_duplicate =
                    |other: &ProgramId| self.programs[other.0 as usize].folder == program.folder;
                let list = if same_name.iter().any(is_duplicate) { &mut self.duplicates } else { same_name };
                list.push(id);
            }
            self.programs.push(program);
        }
        source
    }

    /// Returns the same programs without lowered blocks; ids and spans stay valid.
    pub fn reload(&self) -> Self {
        let mut memory = Self::default();
        for (_, source) in self.sources.iter() {
            memory.load(source.name.clone(), source.bytes.clone());
        }
        Self { main: self.main, by_name: self.by_name.clone(), ..memory }
    }

    /// Returns the first program with this path; without one the only program whose path ends so.
    pub fn find_path(&self, path: &ProgramPath) -> Option<ProgramId> {
        let named = || self.ids().filter(|id| self.get(*id).name == path.name);
        let is_in_folder = |program: &Program| path.folder.is_none() || path.folder == program.folder;
        named().find(|id| is_in_folder(self.get(*id))).or_else(|| {
            let end = path.folder.as_ref()?;
            let ends_so =
                |program: &Program| program.folder.as_ref().is_some_and(|folder| folder.ends_with(end));
            let mut found = named().filter(|id| ends_so(self.get(*id)));
            found.next().filter(|_| found.next().is_none())
        })
    }

    /// Chooses the main program; without a choice it is the first.
    pub fn set_main(&mut self, main: ProgramId) {
        self.main = main;
    }

    /// Returns the id of the main program.
    pub fn main(&self) -> ProgramId {
        self.main
    }

    /// Returns the loaded texts.
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Iterates over the programs that cannot be called, because an earlier one has the same number or name.
    pub fn duplicates(&self) -> impl Iterator<Item = &Program> {
        self.duplicates.iter().map(|id| self.get(*id))
    }

    /// Returns the programs in the order loaded.
    pub fn programs(&self) -> &[Program] {
        &self.programs
    }

    /// Iterates over the ids of the programs in the order loaded.
    pub fn ids(&self) -> impl Iterator<Item = ProgramId> + use<> {
        (0..self.programs.len() as u32).map(ProgramId)
    }

    /// Returns the program with this id.
    ///
    /// # Panics
    ///
    /// If the id comes from another memory.
    pub fn get(&self, id: ProgramId) -> &Program {
        &self.programs[id.0 as usize]
    }

    /// Returns a program whose blocks can be [lowered](Program::lower_block).
    #[inline]
    pub fn get_mut(&mut self, id: ProgramId) -> Option<&mut Program> {
        self.programs.get_mut(id.0 as usize)
    }

    /// Lowers one block of a program; `None` after the last block.
    pub fn lower_block(&mut self, id: ProgramId, index: OpIndex) -> Option<&Op> {
        self.get_mut(id)?.lower_block(index).map(|(_, op)| op)
    }

    /// Lowers one block of a program and returns its operation without its guards.
    pub(super) fn take_op(&mut self, id: ProgramId, index: OpIndex) -> Option<OpKind> {
        self.get_mut(id)?.take_op(index)
    }

    /// Lowers all blocks of a program, as [`Program::ops`] requires.
    pub fn lower_program(&mut self, id: ProgramId) -> &Program {
        let program = &mut self.programs[id.0 as usize];
        let Program { blocks, loops, .. } = program;
        blocks.lower_all(loops);
        program
    }

    /// Lowers all blocks of a program and returns their trees: known blocks, which are taken, and the others read once.
    pub fn lower_with_trees(&mut self, id: ProgramId, known: &mut KnownBlocks) -> Vec<ast::Block> {
        let Program { blocks, loops, span, .. } = &mut self.programs[id.0 as usize];
        let mut none = KnownBlocks::default();
        // Known blocks are those of the first text.
        let known = if span.source == SourceId(0) { known } else { &mut none };
        blocks.lower_with_trees(loops, known)
    }

    /// Replaces a program by another form of it and returns it.
    pub fn replace(&mut self, id: ProgramId, program: Program) -> Program {
        std::mem::replace(&mut self.programs[id.0 as usize], program)
    }

    /// Returns the span of a block, read again from its text.
    pub fn block_span(&self, id: ProgramId, index: OpIndex) -> Option<Span> {
        self.get(id).blocks.tree(index).map(|tree| tree.span)
    }

    /// Returns the program with this O number, as a call of the main program finds it.
    pub fn find(&self, number: u32) -> Option<ProgramId> {
        self.find_from(&ProgramName::Number(number), self.main_folder())
    }

    /// Returns the program that a call from a folder finds: in that folder, in the common folders, outside folders, then in any
    /// other folder. A caller outside folders finds the first loaded.
    pub fn find_from(&self, name: &ProgramName, folder: Option<&Folder>) -> Option<ProgramId> {
        let same_name = self.by_name.get(name)?;
        let Some(own) = folder else { return same_name.first().copied() };
        let rank = |id: &ProgramId| search_rank(self.get(*id).folder.as_ref(), own);
        same_name.iter().min_by_key(|id| rank(id)).copied()
    }

    /// Returns true if a program is in a folder that a control does not search for a call of the main program.
    pub fn is_out_of_reach(&self, id: ProgramId) -> bool {
        let folder = self.get(id).folder.as_ref();
        self.main_folder().is_some_and(|own| search_rank(folder, own) == OUT_OF_REACH)
    }

    fn main_folder(&self) -> Option<&Folder> {
        self.programs.get(self.main.0 as usize)?.folder.as_ref()
    }

    /// Returns the program with this O number, loaded from the library if it is not in memory.
    pub fn fetch(&mut self, number: u32, library: &mut impl Library) -> Option<ProgramId> {
        self.fetch_program(ProgramName::Number(number), library)
    }

    /// Returns the program called `<name>`, loaded from the library if it is not in memory.
    pub fn fetch_name(&mut self, name: &str, library: &mut impl Library) -> Option<ProgramId> {
        self.fetch_program(ProgramName::of(name.to_owned()), library)
    }

    fn fetch_program(&mut self, name: ProgramName, library: &mut impl Library) -> Option<ProgramId> {
        if let Some(found) = self.find_from(&name, self.main_folder()) {
            return Some(found);
        }
        let (file, bytes) = match &name {
            ProgramName::Number(number) => library.program(*number)?,
            ProgramName::Name(name) => library.named(name)?,
            ProgramName::Unnamed => return None,
        };
        let first = ProgramId(self.programs.len() as u32);
        self.load(file, bytes);
        // A file named after its program may omit the O word or the name.
        if self.programs.get(first.0 as usize)?.name == ProgramName::Unnamed {
            self.by_name.entry(name.clone()).or_default().push(first);
        }
        self.find_from(&name, self.main_folder())
    }

    /// Returns the program that contains a span.
    pub fn program_at(&self, span: Span) -> Option<&Program> {
        self.id_at(span).map(|id| self.get(id))
    }

    /// Returns the label of the program that contains a span, else the name of the text, and the line: `O8101`, 31.
    pub fn locate(&self, span: Span) -> (String, u32) {
        let name = || self.sources.get(span.source).name.clone();
        (self.program_at(span).map_or_else(name, Program::label), self.sources.line_column(span).line)
    }

    /// Returns the id of the program that contains a span.
    pub fn id_at(&self, span: Span) -> Option<ProgramId> {
        // Programs are sorted by text, and by offset within it.
        let before = |p: &Program| (p.span.source, p.span.end) < (span.source, span.start);
        let index = self.programs.partition_point(before);
        let found = self.programs.get(index)?;
        let is_in = found.span.source == span.source && found.span.start <= span.start;
        is_in.then_some(ProgramId(index as u32))
    }
}
