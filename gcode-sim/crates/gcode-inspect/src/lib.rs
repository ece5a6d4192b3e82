//! Inspection of simulated parts: motion of a run in, holes, flutes, readings and a verdict out.
//!
//! In go the events of a run, a [`machine::Machine`] and the nominal part of `gcode-part`. The sinks follow the tool on
//! the part: [`holes`] extracts drilled holes, [`flutes`] the path of a grinder's wheel, [`stylus`] the readings of an
//! edge finder. [`verify`] compares holes and flutes with the nominal ones; every finding has a row in [`findings`].
//! [`budget`] computes the deviations of many parts from the errors of machine and set-up.
//!
//! ```
//! use gcode_inspect::holes::HoleExtractor;
//! use gcode_inspect::machine::Machine;
//! use gcode_inspect::verify::{Answer, Tolerances, verify};
//! use gcode_lang::motion::{Event, EventKind, EventSink, Position, SpindleDirection};
//! use gcode_lang::source::{SourceId, Span};
//! use gcode_lang::units::{MmPerMin, Rpm, Seconds};
//!
//! let list = r#"{ "unit": "mm", "holes": [
//!     { "id": "1", "entry": [5, 0, 0], "axis": [0, 0, 1], "depth": 10 }
//! ] }"#;
//! let reference = gcode_part::NominalPart::parse(list).unwrap().into_holes().unwrap();
//! let machine = Machine::default();
//! let mut extractor = HoleExtractor::new(&machine);
//! let at = |z| Position([5.0, 0.0, z, 0.0, 0.0, 0.0, 0.0, 0.0]);
//! for kind in [
//!     EventKind::Spindle { direction: SpindleDirection::Clockwise, speed: Rpm(1500.0), is_rigid: false, is_oriented: false },
//!     EventKind::Rapid { to: at(2.0) },
//!     EventKind::Feed { to: at(-10.25), rate: MmPerMin(100.0) },
//!     EventKind::Rapid { to: at(2.0) },
//! ] {
//!     let block = Span { source: SourceId(0), start: 0, end: 0 };
//!     extractor.event(&Event { kind: &kind, seconds: Seconds::ZERO, block, calls: &None });
//! }
//! let locate = |_| ("O0001".to_owned(), 1);
//! let tolerances = Tolerances::of(&reference, None);
//! let verdict = verify(&extractor.finish(), &reference, tolerances, &machine, &locate);
//! // The hole is in position and a quarter of a millimetre too deep.
//! assert_eq!((verdict.verdict, verdict.holes[0].position_deviation), (Answer::Fail, 0.0));
//! assert_eq!(verdict.findings[0].code, "hole-depth");
//! ```
#![warn(missing_docs)]

pub mod budget;
pub mod drawn_move;
pub mod findings;
pub mod flutes;
pub mod holes;
pub mod machine;
pub mod stylus;
pub mod tool_path;
pub mod verify;
