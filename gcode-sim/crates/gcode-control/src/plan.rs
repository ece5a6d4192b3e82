//! What a block is going to do: made without touching the control, carried out afterwards without failing.
use super::cycle_expansion::CyclePlan;
use super::flow::CallOrigins;
use super::lookahead::Lookahead;
use super::notes::Note;
use super::offsets::Register;
use super::state::State;
use super::variables::{Locals, Value};
use crate::contour::Blend;
use gcode_lang::control::ParameterId;
use gcode_lang::motion::{EventKind, Position, StopKind};
use gcode_lang::program::{OpIndex, ProgramId};
use gcode_lang::source::Span;
use gcode_lang::units::MmPerMin;

/// Everything one block of words changes. Kept between blocks, so that none of them allocates.
#[derive(Debug, Default)]
pub(super) struct BlockPlan {
    pub(super) state: Box<State>,
    /// What the machine is told, with the seconds it takes.
    pub(super) events: Vec<(EventKind, f64)>,
    /// G31: its motion is planned to the end and may stop before.
    pub(super) skip_plan: Option<SkipPlan>,
    /// Told after the motion: spindle and coolant off.
    pub(super) events_after_motion: Vec<(EventKind, f64)>,
    /// A drilling cycle is expanded while it is told: its length has no bound.
    pub(super) cycle_plan: Option<CyclePlan>,
    pub(super) writes: Vec<TableWrite>,
    /// The word `,R` or `,C` of a cutting move.
    pub(super) corner: Option<Blend>,
    /// The block goes by way of what is read ahead, which will be this.
    pub(super) uses_lookahead: bool,
    pub(super) lookahead: Lookahead,
    /// Axes were commanded: what a modal macro call waits for.
    pub(super) commands_axes: bool,
    /// In the order of their M codes.
    pub(super) stops: Vec<StopKind>,
    /// M codes for the machine builder's logic.
    pub(super) auxiliary_codes: Vec<u32>,
    pub(super) notes: Vec<Note>,
    pub(super) flow: BlockFlow,
}

/// What G10 and codes that call write.
#[derive(Clone, Copy, Debug)]
pub(super) enum TableWrite {
    /// System 0 is the external one, 1 to 6 are G54 to G59, 7 and up G54.1 P1….
    Work {
        system: usize,
        axis: usize,
        value: f64,
    },
    Tool {
        register: Register,
        number: u32,
        value: f64,
    },
    /// G10 L52; `kept` where it has no effect.
    Parameter {
        id: ParameterId,
        value: f64,
        has_no_effect: bool,
    },
    /// The number of a code that calls a subprogram, or G10 L85.
    Variable {
        number: u32,
        value: Value,
    },
}

/// A G31 that is planned.
#[derive(Clone, Copy, Debug)]
pub(super) struct SkipPlan {
    /// Its place among the plan's events.
    pub(super) event: usize,
    pub(super) from: Position,
    pub(super) to: Position,
    pub(super) rate: MmPerMin,
    pub(super) seconds: f64,
    pub(super) span: Span,
}

/// Where the program goes after the block.
#[derive(Clone, Debug, Default)]
pub(super) enum BlockFlow {
    #[default]
    Next,
    Call(Box<CallPlan>),
    /// M99, with the number behind P and, once it is found, its place.
    Return {
        number: Option<u32>,
        target: Option<OpIndex>,
    },
    /// G67.
    CancelModal,
    End,
}

/// A call with everything it needs.
#[derive(Clone, Debug)]
pub(super) struct CallPlan {
    pub(super) kind: CallKind,
    pub(super) target: ProgramRef,
    pub(super) repeats: u32,
    /// `M98 P Q`: the sequence number to start at.
    pub(super) start: Option<u32>,
    pub(super) locals: Locals,
    /// G66.1: its own words are arguments at once. Other calls always are.
    pub(super) is_immediate: bool,
    /// The kind of code that calls, where it is no G65, G66 or M98.
    pub(super) origins: CallOrigins,
    /// M198.
    pub(super) is_external: bool,
    pub(super) span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CallKind {
    Macro,
    Subprogram,
    /// G66: stored, not called.
    Modal,
    /// G66.1: stored, and called by its own words.
    EveryBlock,
}

#[derive(Clone, Debug)]
pub(super) enum ProgramRef {
    Number(u32),
    Name(String),
    /// Found in memory.
    Resolved(ProgramId, OpIndex),
}

impl BlockPlan {
    pub(super) fn reset(&mut self, state: &State) {
        let Self {
            state: own,
            events,
            skip_plan: probing,
            events_after_motion: after,
            cycle_plan: drill,
            writes,
            corner,
            uses_lookahead: reads_ahead,
            // Taken from the control where it is read.
            lookahead: _,
            commands_axes: moved,
            stops,
            auxiliary_codes: passed_on,
            notes,
            flow,
        } = self;
        **own = *state;
        events.clear();
        (*probing, *drill, *corner) = (None, None, None);
        after.clear();
        writes.clear();
        (*reads_ahead, *moved) = (false, false);
        stops.clear();
        passed_on.clear();
        notes.clear();
        *flow = BlockFlow::Next;
    }

    pub(super) fn push_event(&mut self, kind: EventKind) {
        self.events.push((kind, 0.0));
    }
}
