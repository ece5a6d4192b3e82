//! A control: executes programs block by block and emits what the machine does as events.
//!
//! **In:** programs in a [`Memory`](gcode_lang::program::Memory), the [`Settings`](gcode_lang::control::Settings) of the
//! control, a [`Library`](gcode_lang::program::Library) for called programs that aren't in memory.
//! **Out:** [events](gcode_lang::motion::EventKind) in machine coordinates to an
//! [`EventSink`](gcode_lang::motion::EventSink), each with its block and its time; the [`Outcome`] of the run; and the
//! [`Control`] itself, with variables, positions, modes, stops and notes as the run leaves them.
//!
//! ```
//! use gcode_control::{Control, Limits, Outcome, Value};
//! use gcode_lang::control::Settings;
//! use gcode_lang::motion::{Event, EventKind, EventSink};
//! use gcode_lang::program::{Memory, NoLibrary};
//!
//! struct Depths(Vec<f64>);
//! impl EventSink for Depths {
//!     fn event(&mut self, event: &Event<'_>) {
//!         if let EventKind::Feed { to, .. } = event.kind {
//!             self.0.push(to[2]);
//!         }
//!     }
//! }
//!
//! let mut memory = Memory::default();
//! memory.load("O1.nc", *b"O1\n#100=2*3\nG90 G83 X10. Z-#100 R1. Q3. F100\nM30\n");
//! let mut control = Control::new(memory, Settings::default());
//! let mut depths = Depths(Vec::new());
//! let outcome = control.run(Limits::default(), &mut NoLibrary, &mut depths);
//!
//! assert!(matches!(outcome, Outcome::End));
//! assert_eq!(depths.0, [-2.0, -5.0, -6.0]);
//! assert_eq!(control.variable(100), Ok(Value::Number(6.0)));
//! ```
//!
//! The modules stand in the order in which they use one another. At the top are values and the parts that own them:
//! `data` (settings and tables), `registers` (what a program can read), `flow` (the position in the programs) and `outcome` (what
//! is recorded). A `planner` makes the plan of a block of words, an `executor` carries it out, and `control` adds the
//! programs. One block reads from top to bottom in `block`; a canned cycle goes from there to `block_codes` (the cycle
//! becomes modal), `cycles` (its words are checked) and `cycle_expansion` (its moves).
#![warn(missing_docs)]

mod contour;

mod kinematics;
pub mod notes;
mod outcome;
mod plane;
mod plane_arc;
mod state;
mod transform;
mod variables;

mod functions;
mod words;

mod data;

mod coordinates;
mod virtual_plane;

mod cycle_expansion;
mod lookahead;
mod quantities;

mod flow;
mod linear_motion;
mod plan;

mod registers;

mod evaluation;
mod system_variables;
mod word_values;

pub mod static_eval;

mod planner;

mod arcs;
mod askew_tapping;
mod block_codes;
mod calls;
mod circle_pocket;
mod cycles;
mod data_input;
mod engraving;
mod lookahead_request;
mod measuring;
mod move_repeats;
mod moves;
mod one_shot_codes;
mod part_error;
mod plane_codes;
mod plane_moves;
mod pocket;
mod probing;
mod tip_control;
mod tool_axis;
mod transform_codes;
mod virtual_plane_codes;

mod executor;

mod loop_detection;
mod plain_move;
mod statements;

mod control;

mod axis_word_use;
mod block;
mod call_execution;
mod checkpoint;
mod haas_outputs;
mod inspection;
mod next_block;
mod next_reads;
mod residual_state;
pub mod static_plan;
mod unknown_position;

pub mod slice;
pub mod symbolic;

pub use self::checkpoint::Checkpoint;
pub use self::control::{Control, Observer};
pub use self::inspection::{Evaluation, StackedProgram};
pub use self::next_block::{BlockCommands, UnsimulatedCodes, modal_code};
pub use self::notes::Note;
pub use self::outcome::{AlarmStop, Limits, OperatorStop, Outcome, Progress, UnsetWorkOffset};
pub use self::residual_state::{ResidualKind, ResidualValue, mode_name};
pub use self::state::{Modal, ModalWords, State};
pub use self::statements::printable;
pub use self::variables::{Locals, Value, Vars};
