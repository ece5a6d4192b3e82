//! Texts of the blocks of a program: where each begins and ends, without its operation.
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::source::{Bytes, SourceId, Span, line_length};
use crate::syntax::{ast, block_at};

/// Text that contains a program.
#[derive(Clone, Debug)]
pub(super) struct ProgramText {
    pub(super) source: SourceId,
    pub(super) bytes: Bytes,
    /// Length without the trailer.
    pub(super) length: usize,
}

impl ProgramText {
    pub(super) fn content(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// Texts of the blocks of a program, by their indices. Copies share the text and the starts of the blocks.
#[derive(Clone, Debug)]
pub struct BlockTexts {
    pub(super) text: ProgramText,
    pub(super) starts: Arc<Vec<u32>>,
    /// Trees of the blocks that do not begin their line.
    pub(super) separate_trees: Arc<BTreeMap<u32, ast::Block>>,
}

impl BlockTexts {
    pub(super) fn new(text: ProgramText, starts: Vec<u32>, apart: BTreeMap<u32, ast::Block>) -> Self {
        Self { text, starts: Arc::new(starts), separate_trees: Arc::new(apart) }
    }

    /// Returns the number of blocks.
    pub fn count(&self) -> usize {
        self.starts.len()
    }

    /// Returns the text that contains the blocks.
    pub fn source(&self) -> SourceId {
        self.text.source
    }

    /// Returns the offset of a block.
    pub fn start(&self, index: usize) -> u32 {
        self.starts[index]
    }

    /// Returns the index of the block that begins at an offset.
    pub fn index_at(&self, start: u32) -> Option<usize> {
        self.starts.binary_search(&start).ok()
    }

    /// Returns the first block that begins at an offset or after it.
    pub fn first_from(&self, offset: u32) -> usize {
        self.starts.partition_point(|start| *start < offset)
    }

    /// Returns everything from the start of a block to that of the next one.
    pub fn up_to_next(&self, index: usize) -> &[u8] {
        let content = self.text.content();
        let end = self.starts.get(index + 1).map_or(content.len(), |next| *next as usize);
        &content[self.starts[index] as usize..end]
    }

    /// Returns the span of a block.
    pub fn span(&self, index: usize) -> Span {
        let (source, start) = (self.text.source, self.starts[index]);
        let text = self.up_to_next(index);
        let line = &text[..line_length(text)];
        // A line of words alone is its block: no comment, no second block, no program number behind it.
        let is_plain = |byte: &u8| matches!(byte, b' '..=b'~') && !b"(;/%Oo:<".contains(byte);
        let length = line.iter().rposition(|byte| *byte != b' ').map_or(0, |last| last + 1);
        if line.len() < text.len() && !line.is_empty() && line[..length].iter().all(is_plain) {
            return Span { source, start, end: start + length as u32 };
        }
        self.tree(index).map_or(Span { source, start, end: start }, |block| block.span)
    }

    /// Returns the tree of a block, read again from the text.
    pub fn tree(&self, index: usize) -> Option<ast::Block> {
        let start = *self.starts.get(index)?;
        match self.separate_trees.get(&(index as u32)) {
            Some(block) => Some(block.clone()),
            None => block_at(self.text.source, self.text.content(), start),
        }
    }
}
