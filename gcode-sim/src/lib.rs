//! Results as documents, and the command line `gcode-sim`, as a library.
//!
//! The program reads Fanuc Custom Macro B, executes it as the control would, follows the tool on the part, and
//! compares the holes with a reference computed without NC code. The crates below this one do that work;
//! this library adds the outer layers, which `gcode-gen` shares:
//!
//! - [`report`] turns runs, holes, verdicts and changes into text, JSON, CSV, SARIF, pages and pictures;
//! - [`schema`] derives the JSON Schemas of the files that are read and of the results;
//! - [`cli`] is the command line: [`cli::main`] takes the arguments and returns the exit status, and its public
//!   modules read inputs, write outputs and find called programs.
//!
//! A module uses only those listed above it.
//!
//! ```
//! use gcode_inspect::machine::Machine;
//! use gcode_lang::program::NoLibrary;
//! use gcode_session::{Request, run};
//! use gcode_sim::report::diagnostic;
//!
//! let request = Request::new("O1.nc", b"O1\n#100=2/0\nM30\n".as_slice(), Machine::default());
//! let run = run(&request, &mut NoLibrary, &mut ())?;
//! let finding = run.stop_finding().expect("a division by zero is an alarm");
//! let text = diagnostic::render(&finding, run.control.memory().sources());
//! assert!(text.contains("division by zero") && text.contains("#100=2/0"));
//! # Ok::<(), gcode_session::SessionError>(())
//! ```
#![warn(missing_docs)]

pub mod report;

pub mod schema;

pub mod cli;
