//! Debugger for Custom Macro B: a run that goes forwards and backwards, and the Debug Adapter Protocol over it.
//!
//! **In:** messages of a client ([`Adapter::receive`]), and a [`Host`] that reads files. **Out:** messages for the client
//! ([`Adapter::take_messages`]). A run goes on in slices ([`Adapter::work`]), so that requests are heard in between; the crate
//! itself reads and writes nothing.
//!
//! The modules stand in the order in which they use one another. `run` is a run that goes back: checkpoints at growing
//! distances, and the same blocks again from the last of them. `debuggee` adds breakpoints, exceptions and steps. Neither knows
//! the protocol; its types are in `protocol` alone, and `adapter` translates.
//!
//! ```
//! use std::rc::Rc;
//!
//! use gcode_dap::{Adapter, Host, LaunchArguments, LaunchedProgram};
//! use gcode_inspect::machine::Machine;
//! use gcode_lang::program::NoLibrary;
//! use gcode_lang::source::Bytes;
//! use gcode_session::Request;
//!
//! struct OneProgram;
//! impl Host for OneProgram {
//!     fn launch(&mut self, arguments: &LaunchArguments) -> Result<LaunchedProgram, String> {
//!         let text = self.program_text(&arguments.program)?;
//!         let request = Request::new(&arguments.program, text, Machine::default());
//!         Ok(LaunchedProgram { request, library: Box::new(NoLibrary), reference: None })
//!     }
//!     fn program_text(&mut self, _: &str) -> Result<Bytes, String> {
//!         Ok(b"O1\n#1=2\n#2=#1*3\nM30\n".as_slice().into())
//!     }
//!     fn absolute(&self, path: &str) -> String {
//!         format!("/nc/{path}")
//!     }
//!     fn canonical(&self) -> Rc<dyn Fn(&str) -> String> {
//!         Rc::new(str::to_owned)
//!     }
//! }
//!
//! let mut adapter = Adapter::new(OneProgram);
//! for (seq, request) in [
//!     r#""command":"initialize","arguments":{"adapterID":"gcode-sim"}"#,
//!     r#""command":"launch","arguments":{"program":"O1.nc","stopOnEntry":true}"#,
//!     r#""command":"configurationDone""#,
//!     r#""command":"next","arguments":{"threadId":1}"#,
//! ]
//! .iter()
//! .enumerate()
//! {
//!     adapter.receive(format!(r#"{{"seq":{seq},"type":"request",{request}}}"#).as_bytes());
//! }
//! while adapter.is_running() {
//!     adapter.work();
//! }
//! adapter.receive(br##"{"seq":9,"type":"request","command":"evaluate","arguments":{"expression":"#1*10"}}"##);
//! let messages = adapter.take_messages();
//! assert!(messages.last().unwrap().contains(r#""result":"20""#));
//! ```
#![warn(missing_docs)]

mod run;

mod debuggee;

mod protocol;

mod adapter;

pub use adapter::{Adapter, Host, LaunchedProgram};
pub use protocol::arguments::Launch as LaunchArguments;
