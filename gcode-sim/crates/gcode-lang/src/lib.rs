//! Language of Fanuc Custom Macro B: program text in, lowered programs out.
//!
//! [`syntax`] reads a text to a tree of programs, blocks, words and statements; reading never fails. [`program`]
//! lowers the blocks of a [`program::Memory`] to operations with looked-up codes and postfix expressions. A block
//! that cannot run becomes the [`alarm`] that a control raises when it reaches it.
//!
//! The other modules hold the data shared with the crates that execute, check and report programs: [`control`] the
//! settings of a control, [`motion`] the events of a machine, [`source`] texts and spans, [`units`] quantities and
//! [`diag`] findings, and [`shares`] long works among the cores.
//!
//! ```
//! use gcode_lang::program::{Memory, OpKind};
//!
//! let mut memory = Memory::default();
//! memory.load("plate.nc", *b"O1(PLATE)\nN10 G0 X1.5\nN20 IF[#1 GT 2]GOTO 10\nX..5\nM30\n");
//! let program = memory.lower_program(memory.find(1).unwrap());
//! assert_eq!(program.label(), "O0001");
//! assert_eq!(program.find_number(20, 0), Some(2));
//! assert!(matches!(program.ops()[1].kind(), OpKind::Words(words) if words.list.len() == 2));
//! let OpKind::Alarm(alarm) = program.ops()[3].kind() else { panic!("X..5 is not a number") };
//! assert_eq!(alarm.node.code().to_string(), "PS0007");
//! ```
#![warn(missing_docs)]

pub mod alarm;
pub mod control;
pub mod diag;
mod length_compensation;
pub mod motion;
pub mod program;
pub mod shares;
mod similar;
pub mod source;
pub mod syntax;
pub mod units;
mod unknown_axes;

pub use similar::similar;
