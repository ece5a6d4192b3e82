//! Operations to events: a control that can be stepped block by block, held and looked at.
//!
//! The modules stand in the order in which they use one another. At the top are values and the parts that own them:
//! `data` (settings and tables), `registers` (what a program can read), `flow` (where the program is) and `run_log` (what
//! is recorded). A `planner` makes the plan of a block of words, an `executor` carries it out, and `control` adds the
//! programs. What one block does reads from top to bottom in `block`.
mod contour;

mod block_effects;
mod checked;
mod functions;
mod modal_state;
pub mod notes;
mod offsets;
mod operand_stack;
mod outcome;
mod state;
mod transform;
mod variables;
mod words;

mod coordinates;
mod cycle_expansion;
mod data;
mod linear_motion;
mod lookahead;
mod pecks;
mod quantities;
mod stroke_limits;

mod clock;
mod flow;
mod panel;
mod plan;
mod run_log;

mod arguments;
mod evaluation;
mod registers;
pub mod static_eval;
mod system_variables;
mod word_values;

mod arcs;
mod calls;
mod code_calls;
mod code_words;
mod cycles;
mod data_input;
mod endpoints;
mod lookahead_request;
mod m_codes;
mod modal_codes;
mod moves;
mod one_shot_codes;
mod parameters;
mod patterns;
mod planner;
mod pockets;
mod probing;
mod reference;
mod threading;
mod transform_codes;
mod transform_order;
mod work_offset_use;

mod executor;
mod loop_detection;
mod plain_move;
mod plan_commit;
mod print;
mod statements;

mod accessors;
mod block;
mod block_commands;
mod call_execution;
mod control;
mod observer;
mod residual_state;
mod run;
mod unsimulated;

pub use self::block_commands::{BlockCommands, modal_code};
pub use self::control::Control;
pub use self::modal_state::Modal;
pub use self::notes::Note;
pub use self::observer::Observer;
pub use self::outcome::{AlarmStop, Limits, OperatorStop, Outcome, Progress};
pub use self::print::printable;
pub use self::residual_state::{ResidualKind, ResidualValue, mode_name};
pub use self::state::{Codes, State};
pub use self::unsimulated::UnsimulatedCodes;
pub use self::variables::{Value, Vars};
