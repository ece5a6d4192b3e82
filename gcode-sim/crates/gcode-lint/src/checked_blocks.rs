//! Blocks of a text that was checked: the check of a later state of it looks at those only that an edit changed.
use gcode_lang::control::Settings;
use gcode_lang::program::Memory;
use gcode_lang::source::SourceId;
use gcode_lang::syntax::{KnownBlocks, ReadBlocks};

use super::context::LoadedProgram;

/// Blocks of one state of a text, with what the rules about a block alone found of each.
#[derive(Debug, Default)]
pub struct CheckedBlocks {
    blocks: ReadBlocks,
    count: usize,
    /// Control of the check, on which the marks of the blocks rest.
    settings: Option<Settings>,
}

impl CheckedBlocks {
    /// Takes the blocks of the first text in memory.
    pub(super) fn new(memory: &Memory, settings: &Settings, programs: Vec<LoadedProgram>) -> Self {
        let Some((_, first)) = memory.sources().iter().next() else { return Self::default() };
        let (mut blocks, mut marks) = (Vec::new(), Vec::new());
        for program in programs {
            if memory.get(program.id).span.source == SourceId(0) {
                blocks.extend(program.blocks);
                marks.extend(program.marks);
            }
        }
        let count = blocks.len();
        let blocks = ReadBlocks::new(first.bytes.clone(), (blocks, marks));
        Self { blocks, count, settings: Some(settings.clone()) }
    }

    /// Returns the number of blocks.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns the blocks that a later state of the text has too; their marks count on the same control only.
    pub(super) fn moved_to(mut self, text: &[u8], settings: &Settings) -> KnownBlocks {
        if self.settings.as_ref() != Some(settings) {
            self.blocks.clear_marks();
        }
        self.blocks.moved_to(text)
    }
}
