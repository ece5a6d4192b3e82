//! Language server for Fanuc Custom Macro B: messages of the Language Server Protocol 3.17 in, answers and diagnostics out.
//!
//! [`serve`] takes a connection, which may be a pair of channels, and a [`Host`] for files, reports and pages. The answers
//! come from `gcode-ide`, diagnostics from `gcode-lint`, values and deviations from runs by `gcode-session`. Types of the
//! protocol are in this crate alone.
//!
//! Messages are taken one after the other. Checks, runs and proofs go on in threads of their own, each on a snapshot of the
//! documents, so that a key press never waits for them; an edit ends the runs of the text before it.
//!
//! ```
//! use std::path::{Path, PathBuf};
//! use std::sync::Arc;
//!
//! use gcode_lang::program::Library;
//! use gcode_lang::source::Bytes;
//! use gcode_lsp::{SessionEnd, Host, LibrarySource, serve};
//! use gcode_session::Request;
//! use gcode_session::files::FileAccess;
//! use lsp_server::{Connection, Message, Notification};
//! use serde_json::Value;
//!
//! struct NoFiles;
//!
//! impl FileAccess for NoFiles {
//!     fn program(&self, path: &Path) -> Result<Bytes, String> {
//!         Err(format!("no {}", path.display()))
//!     }
//!     fn text(&self, path: &Path) -> Result<String, String> {
//!         Err(format!("no {}", path.display()))
//!     }
//!     fn files(&self, _: &Path) -> Result<Vec<PathBuf>, String> {
//!         Ok(Vec::new())
//!     }
//!     fn is_file(&self, _: &Path) -> bool {
//!         false
//!     }
//!     fn canonical(&self, folder: &Path) -> Option<PathBuf> {
//!         Some(folder.to_owned())
//!     }
//! }
//!
//! impl Host for NoFiles {
//!     fn stamp(&self, _: &Path) -> Option<u64> {
//!         None
//!     }
//!     fn folders(&self, _: &Path) -> Vec<PathBuf> {
//!         Vec::new()
//!     }
//!     fn reference(&self, path: &Path) -> Result<String, String> {
//!         self.text(path)
//!     }
//!     fn run_report(&self, _: &Request, _: &mut dyn Library) -> Result<Value, String> {
//!         Err("no reports".to_owned())
//!     }
//!     fn verdict_report(
//!         &self,
//!         _: &Request,
//!         _: &mut dyn Library,
//!         _: Option<&Path>,
//!     ) -> Result<Option<Value>, String> {
//!         Err("no reports".to_owned())
//!     }
//!     fn proof_report(
//!         &self,
//!         _: &Request,
//!         _: LibrarySource<'_>,
//!         _: (&[String], &[String]),
//!     ) -> Result<Value, String> {
//!         Err("no proofs".to_owned())
//!     }
//!     fn write_page(&self, _: &Request, _: &mut dyn Library, _: Option<&Path>) -> Result<PathBuf, String> {
//!         Err("no pages".to_owned())
//!     }
//!     fn page(&self, _: &Request, _: &mut dyn Library, _: Option<&Path>) -> Result<String, String> {
//!         Err("no pages".to_owned())
//!     }
//! }
//!
//! let (server, client) = Connection::memory();
//! client.sender.send(Message::Notification(Notification::new("exit".to_owned(), Value::Null)))?;
//! assert_eq!(serve(&server, Arc::new(NoFiles)), SessionEnd::Exit);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod background_run;
mod capabilities;
mod check_basis;
mod checker;
mod client;
mod code_actions;
mod commands;
mod configuration;
mod document_uri;
mod edits;
mod failure;
mod findings;
mod hint_refresh;
mod hints;
mod host;
mod navigation;
mod notifications;
mod offered_edit;
mod overlay;
mod program_setup;
mod proof;
#[cfg(test)]
mod property_tests;
mod requests;
mod run_facts;
mod runs;
mod semantic_tokens;
mod server;
mod snapshot;
mod state;
#[cfg(test)]
mod testing;
mod text_document;
mod text_help;
mod workspace_scan;

pub use host::{Host, LibrarySource};
pub use server::{SessionEnd, serve};
