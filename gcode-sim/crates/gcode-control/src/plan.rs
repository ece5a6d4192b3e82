//! Plan of a block: made without a change of the control, carried out without an alarm.
use super::cycle_expansion::CyclePlan;
use super::data::Register;
use super::flow::CallOrigins;
use super::lookahead::Lookahead;
use super::notes::Note;
use super::state::State;
use super::variables::{Locals, Value};
use crate::contour::Blend;
use gcode_lang::control::ParameterId;
use gcode_lang::motion::{AxisIndex, EventKind, Position, StopKind};
use gcode_lang::program::m_codes::SkipAlarm;
use gcode_lang::program::modes::GroupSet;
use gcode_lang::program::{OpIndex, ProgramId};
use gcode_lang::source::Span;
use gcode_lang::units::MmPerMin;

/// Everything that one block of words changes. It is kept between blocks, so that most blocks allocate nothing.
#[derive(Debug, Default)]
pub(super) struct BlockPlan {
    pub(super) state: Box<State>,
    /// Events with their seconds.
    pub(super) events: Vec<(EventKind, f64)>,
    /// G31: its move is planned to the end point and may stop earlier.
    pub(super) skip_plan: Option<SkipPlan>,
    /// Events after the motion: spindle and coolant off.
    pub(super) events_after_motion: Vec<(EventKind, f64)>,
    /// Canned cycle, expanded while it is emitted because its length has no bound.
    pub(super) cycle_plan: Option<CyclePlan>,
    pub(super) writes: Vec<TableWrite>,
    /// The word `,R` or `,C` of a cutting move.
    pub(super) corner: Option<Blend>,
    /// True if `lookahead` replaces that of the control.
    pub(super) uses_lookahead: bool,
    pub(super) lookahead: Lookahead,
    /// Modal groups of the block's codes, without group 01.
    pub(super) commanded_groups: GroupSet,
    /// True if the block commands axes, which triggers a modal macro call.
    pub(super) commands_axes: bool,
    /// Axes, as bits, that the block sends to coordinates of the active work coordinate system.
    pub(super) placed_axes: u8,
    /// True if a length offset counts behind G53 although a parameter may have cancelled it.
    pub(super) restores_length: bool,
    /// In the order of their M codes.
    pub(super) stops: Vec<StopKind>,
    /// M codes for the machine builder's logic.
    pub(super) builder_m_codes: Vec<u32>,
    pub(super) notes: Vec<Note>,
    pub(super) flow: BlockFlow,
}

/// Value that G10 or a calling code writes.
#[derive(Clone, Copy, Debug)]
pub(super) enum TableWrite {
    Work {
        system: usize,
        axis: usize,
        value: f64,
        /// The offset is known afterwards: it is no sum of an unknown one.
        is_set: bool,
    },
    Tool {
        register: Register,
        number: u32,
        value: f64,
    },
    /// G10 L21: an axis of a fixture offset.
    Fixture {
        index: usize,
        axis: usize,
        value: f64,
    },
    /// G10 L23: a shift or a rotation of a setting error.
    SettingError {
        index: usize,
        item: usize,
        value: f64,
    },
    /// G10 L52.
    Parameter {
        id: ParameterId,
        value: f64,
        has_no_effect: bool,
    },
    /// Number of a code that calls a subprogram, G10 L85, or an output of M59 and M69.
    Variable {
        number: u32,
        value: Value,
    },
}

/// Planned G31.
#[derive(Clone, Copy, Debug)]
pub(super) struct SkipPlan {
    /// Index among the plan's events.
    pub(super) event: usize,
    pub(super) from: Position,
    pub(super) to: Position,
    pub(super) rate: MmPerMin,
    pub(super) seconds: f64,
    /// Alarm that the block commands after the motion.
    pub(super) alarm: Option<SkipAlarm>,
    /// M75: the signal's position is the first point of G35 and G136.
    pub(super) sets_reference: bool,
    /// Offset that the signal sets.
    pub(super) measurement: Option<OffsetMeasurement>,
    pub(super) span: Span,
}

/// Offset that a skip signal sets.
#[derive(Clone, Copy, Debug)]
pub(super) enum OffsetMeasurement {
    /// G36 and G136: the active work zero, at the probed point or half-way to another.
    WorkZero {
        /// Axes of the block, as bits.
        axes: u8,
        /// I, J and K.
        shift: Position,
        /// Point of M75; `None` for G36.
        other: Option<Position>,
    },
    /// G35: the diameter or radius, from the distance of two points.
    ToolDiameter {
        number: u32,
        other: Position,
        /// Width of the probe, mm.
        width: f64,
    },
    /// G37: the length with which the tip of the tool is at `target`.
    ToolLength {
        number: u32,
        axis: AxisIndex,
        target: f64,
        /// −1 for G44.
        sign: f64,
    },
}

/// Continuation of the program after the block.
#[derive(Clone, Debug, Default)]
pub(super) enum BlockFlow {
    #[default]
    Next,
    Call(Box<CallPlan>),
    /// M99, with the sequence number of P and, once resolved, its operation.
    Return {
        number: Option<u32>,
        target: Option<OpIndex>,
    },
    /// M96 of a Haas: to a sequence number and, once resolved, its operation.
    Jump {
        number: u32,
        target: OpIndex,
    },
    /// G67.
    CancelModal,
    End,
}

/// Planned call.
#[derive(Clone, Debug)]
pub(super) struct CallPlan {
    pub(super) kind: CallKind,
    pub(super) target: ProgramRef,
    pub(super) repeats: u32,
    /// All digits of P, if the first ones are the repeats.
    pub(super) digits_of_p: Option<u32>,
    /// Sequence number to start at: Q of M98.
    pub(super) start: Option<u32>,
    pub(super) locals: Locals,
    /// False for a G66.1 that only stores its macro.
    pub(super) is_immediate: bool,
    /// Kind of code that calls, other than G65, G66 and M98.
    pub(super) origins: CallOrigins,
    /// M198.
    pub(super) is_external: bool,
    pub(super) span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CallKind {
    Macro,
    Subprogram,
    /// G66: stored, called after moves.
    Modal,
    /// G66.1: stored, called by every block.
    EveryBlock,
}

#[derive(Clone, Debug)]
pub(super) enum ProgramRef {
    Number(u32),
    Name(String),
    /// Program in memory and the operation to start at.
    Resolved(ProgramId, OpIndex),
}

impl BlockPlan {
    /// Empties the plan and starts at a state; allocations are kept.
    pub(super) fn reset(&mut self, start: &State) {
        let Self {
            state,
            events,
            skip_plan,
            events_after_motion,
            cycle_plan,
            writes,
            corner,
            uses_lookahead,
            // Valid with `uses_lookahead` only.
            lookahead: _,
            commanded_groups,
            commands_axes,
            placed_axes,
            restores_length,
            stops,
            builder_m_codes,
            notes,
            flow,
        } = self;
        **state = *start;
        (*skip_plan, *cycle_plan, *corner, *flow) = (None, None, None, BlockFlow::Next);
        (*uses_lookahead, *commands_axes, *placed_axes) = (false, false, 0);
        *restores_length = false;
        *commanded_groups = GroupSet::default();
        events.clear();
        events_after_motion.clear();
        writes.clear();
        stops.clear();
        builder_m_codes.clear();
        notes.clear();
    }

    /// Adds an event that takes no time.
    pub(super) fn push_event(&mut self, kind: EventKind) {
        self.events.push((kind, 0.0));
    }

    /// Repeats the event of the unknown axes if it is the last: its move has no travel.
    pub(super) fn repeat_unknown_axes(&mut self) {
        if let Some((kind @ EventKind::PositionUnknown { .. }, _)) = self.events.last() {
            self.events.push((kind.clone(), 0.0));
        }
    }

    /// Adds a move; the machine then stands at its end.
    pub(super) fn push_move(&mut self, kind: EventKind, seconds: f64) {
        self.state.machine_position = kind.end().copied().unwrap_or(self.state.machine_position);
        self.events.push((kind, seconds));
    }
}
