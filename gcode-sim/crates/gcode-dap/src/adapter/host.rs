//! What the adapter needs from outside: files.
use std::rc::Rc;

use crate::protocol::arguments::Launch;
use gcode_inspect::verify::Tolerances;
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_part::Reference;
use gcode_session::Request;

/// A program that is ready to run.
pub struct LaunchedProgram {
    /// The program and the conditions of its run.
    pub request: Request,
    /// Called programs.
    pub library: Box<dyn Library>,
    /// The nominal holes, with their tolerances.
    pub reference: Option<(Reference, Tolerances)>,
}

/// Reader of files for an adapter.
pub trait Host {
    /// Reads everything that a launch names.
    ///
    /// # Errors
    /// A sentence on what can't be used.
    fn launch(&mut self, arguments: &Launch) -> Result<LaunchedProgram, String>;

    /// Reads the text of a program.
    ///
    /// # Errors
    /// A sentence on why it can't be read.
    fn program_text(&mut self, path: &str) -> Result<Bytes, String>;

    /// Returns a path from the root, as a client can open it.
    fn absolute(&self, path: &str) -> String;

    /// Returns a function that returns the one path of a file that several paths may name.
    fn canonical(&self) -> Rc<dyn Fn(&str) -> String>;

    /// Returns true if a message of the client waits: long work gives way to it.
    fn has_message(&self) -> bool {
        false
    }
}
