//! Proves or refutes claims on a program for all values of its variables' ranges at once.
//!
//! **In:** a [`Setup`] that gives controls, each as before its first block; [`Ask`]: ranges of variables, conditions on them,
//! claims, variables whose bounds are wanted. **Out:** a [`ProofAnswer`]: each claim is proved, refuted by a point that the control
//! has run, or undecided with the part of the volume that is left; bounds that hold every double a run gives.
//!
//! ```
//! use std::time::Duration;
//! use gcode_control::Control;
//! use gcode_lang::control::Settings;
//! use gcode_lang::program::{Memory, NoLibrary};
//! use gcode_prove::{Ask, Setup, ClaimVerdict, Watch, prove};
//!
//! struct OneProgram;
//! impl Setup for OneProgram {
//!     type Library = NoLibrary;
//!     fn control(&self, _: &[(String, String)]) -> Result<Control, String> {
//!         let mut memory = Memory::default();
//!         memory.load("O1.nc", *b"O1\nIF[#1 LT 0]GOTO 9\n#100=SQRT[#1]\nM30\nN9 #3000=1(NEGATIVE)\n");
//!         Ok(Control::new(memory, Settings::default()))
//!     }
//!     fn library(&self) -> NoLibrary {
//!         NoLibrary
//!     }
//! }
//!
//! let text = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect();
//! let ask = Ask {
//!     ranges: text(&["#1=-4..4"]),
//!     claims: text(&["alarm MC3001", "#100 LE 2", "no-alarm"]),
//!     ..Ask::default()
//! };
//! let answer = prove(&OneProgram, &ask, &Watch::new(&|| Duration::ZERO, Duration::from_secs(5))).unwrap();
//! let verdicts: Vec<_> = answer.claims.iter().map(|claim| claim.verdict).collect();
//! assert_eq!(verdicts, [ClaimVerdict::Proved, ClaimVerdict::Proved, ClaimVerdict::Refuted]);
//! let point = answer.claims[2].counterexample.as_ref().unwrap();
//! assert!(point[0].0 == 1 && point[0].1 < 0.0);
//! ```
//!
//! The modules stand in the order in which they use one another: a request is read (`request`), `tree` follows the ways of the
//! program over `nodes`, `region` examines a box, `joined` one whose ways are too many, and `division` divides it, `points` and `witness` single points; `search` and `worker` are the work of a
//! thread on the `shared` queue. `trace` lists the ways of a box with their moves, for proofs that compare them with a part.
#![warn(missing_docs)]

mod request;
mod watch;

mod nodes;

mod leaf;
mod tree;

mod region;

mod division;

mod points;
mod witness;

mod joined;
mod shared;

mod search;
mod simplify;
mod variable_bounds;
mod worker;

mod answer;

#[cfg(test)]
mod arithmetic_tests;
mod exact;
mod trace;

pub use answer::{
    Ask, ClaimAnswer, ClaimVerdict, ProofAnswer, ProveError, Setup, VariableBounds, prove, sample,
};
pub use exact::{Atom, ExactForm, ExactForms, Polynomial};
pub use request::RequestError;
pub use search::radical_inverse;
pub use trace::{MoveKind, Trace, TracedEnd, TracedMove, TracedStop, TracedWay, trace};
pub use watch::Watch;
