//! Answers of an editor: program text in; symbols, explanations and edits out, in byte offsets.
//!
//! A [`Project`] holds the texts that an editor knows, each with its [`FileIndex`], which an edit updates. Its methods
//! answer what editors ask: [definitions](Project::definition) and [references](Project::references),
//! [symbols](Project::document_symbols), [hover](Project::hover), [completions](Project::completions),
//! [signatures](Project::signature_help), [rename](Project::rename), [renumber](Project::renumber),
//! [format](Project::format), [quick fixes](Project::quick_fixes), [tokens](Project::semantic_tokens),
//! [folding](Project::folding_ranges), the [call hierarchy](Project::call_item) and [links](Project::document_links).
//! No protocol, no files, no run. A line that cannot be read leaves the answers about the others as they are.
//!
//! ```
//! use gcode_ide::{FileId, Project};
//! use gcode_lang::control::Settings;
//!
//! let mut project = Project::new(Settings::default());
//! let (main, library) = (FileId(0), FileId(1));
//! project.set_file(main, "O1.nc", *b"O1\nG65 P9001 A5.\nGOTO 20\nN20 M30\n");
//! project.set_file(library, "O9001.nc", *b"O9001(DRILL)\nG0 X#1\nM99\n");
//!
//! let call = project.definition(main, 8).unwrap();
//! assert_eq!((call.targets[0].file, call.targets[0].selection.start), (library, 0));
//! let jump = project.definition(main, 22).unwrap();
//! assert_eq!(jump.targets[0].selection.start, 25);
//! assert_eq!(project.references(library, 17, true).len(), 2, "#1 and the argument A");
//! ```
#![warn(missing_docs)]

mod block_entries;
mod call_hierarchy;
mod chunk;
mod chunk_builder;
mod code_text;
mod completion;
mod entry;
mod file_index;
mod folding;
mod format;
mod head_comment;
mod hover;
mod language_text;
mod lexer;
mod links;
mod meaning;
mod navigation;
#[cfg(test)]
mod navigation_tests;
mod project;
#[cfg(test)]
mod property_tests;
mod quick_fix;
mod rename;
mod renumber;
mod scope;
mod semantic_tokens;
mod signature;
mod symbol;
mod symbols;
mod system_text;
#[cfg(test)]
mod testing;
mod text;
mod trimming;

pub use call_hierarchy::{CallGroup, CallItem};
pub use completion::{Completion, CompletionKind};
pub use file_index::{FileIndex, ProgramOutline};
pub use folding::{FoldingKind, FoldingRange};
pub use hover::Hover;
pub use links::{DocumentLink, PageLink};
pub use navigation::{Access, Definition, NavigationTarget, Reference};
pub use project::{ProgramKey, Project};
pub use quick_fix::QuickFix;
pub use rename::RenameTarget;
pub use scope::VariableScope;
pub use semantic_tokens::{SemanticToken, TokenKind};
pub use signature::{SignatureHelp, SignatureParameter};
pub use symbol::Symbol;
pub use symbols::{DocumentSymbol, SymbolKind, WorkspaceSymbol};
pub use text::{FileEdit, FileId, Location, Refusal, TextEdit, TextRange, apply_edits};
pub use trimming::FormatOptions;
