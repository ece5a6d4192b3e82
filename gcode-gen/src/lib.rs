//! Emits parametric macro programs: the control computes the geometry, the generator orders the calls.
//!
//! **In:** a job file of one of the [`families`]. **Out:** a [`package::Package`] of programs and a machine file;
//! [`check`] runs it as the control would and verifies its effect against the job's geometry, [`sheet`] makes the
//! set-up sheet, [`proof`] proves the macros for all values of a job's quantities, and [`report`] formats the
//! result. [`cli`] writes the files if the verdict is a pass. A module uses only those listed above it.
//!
//! ```
//! use gcode_gen::check::check;
//! use gcode_gen::families::{ALL, emit};
//! use gcode_part::job::Job;
//!
//! let honeycomb = ALL.iter().find(|family| family.name == "honeycomb").unwrap();
//! let job = Job::parse(&honeycomb.new_job.replace("length = 300.0", "length = 20.0"))?;
//! let package = emit(&job);
//! assert_eq!(package.mains, [8300]);
//! assert!(package.main().unwrap().text.contains("G65 P8301 D500. B10. E0. H0. X20."));
//! assert!(check(&job, &package)?.refusals.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod nc;

pub mod package;

mod order;

pub mod families;

pub mod check;

pub mod proved;

pub mod sheet;

pub mod proof;

pub mod report;

pub mod cli;
