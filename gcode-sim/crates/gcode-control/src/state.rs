//! What one block can change besides variables and offset tables: small enough to copy, so that a block that alarms
//! leaves no trace.
use super::modal_state::Modal;
use super::transform::Transform;
use gcode_lang::motion::{AxisIndex, LengthCompensation, Position, SpindleDirection};
use gcode_lang::program::modes::{Length, Motion};

/// The control between two blocks. Lengths in mm, whatever G20 says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    pub modal: Modal,
    /// Where the program stands in its work coordinate system, before mirror, scaling and rotation, without the
    /// tool length.
    pub programmed: Position,
    /// Until the next move after G51.1, G51, G68 or their end: what #5001… show.
    pub last_end_point: Option<EndPoint>,
    /// The same in machine coordinates, tool length included.
    pub machine: Position,
    /// G52.
    pub local_offset: Position,
    /// G92.
    pub coordinate_shift: Position,
    /// The tool length offset in effect on each axis.
    pub length_offset: Position,
    /// G28: the intermediate point for G29, from the work coordinate system's zero, tool length included; and the axes
    /// that have one.
    pub intermediate: Position,
    pub has_intermediate: u8,
    /// The axes that stand where machine coordinates have sent them while nothing had set the work offset in effect.
    pub work_zero_unknown: u8,
    /// #5061…: where the last G31 ended, in machine coordinates.
    pub skip_position: Position,
    /// The radius of cutter compensation, as D or G41, G42 have found it; negative where it swaps sides.
    pub cutter_radius: f64,
    pub transform: Transform,
    pub cycle: CycleState,
    pub codes: Codes,
    pub polar: PolarPoint,
    pub spindle: SpindleDirection,
    pub is_coolant_on: bool,
    /// Between G10 L52 and G11.
    pub is_in_parameter_input: bool,
    /// The tool in the spindle.
    pub tool: u32,
}

impl State {
    /// Notes whether the place of an axis on the part is known.
    pub(super) fn set_work_zero_unknown(&mut self, axis: AxisIndex, is_unknown: bool) {
        self.work_zero_unknown = self.work_zero_unknown & !(1 << axis) | u8::from(is_unknown) << axis;
    }

    /// Puts a code of group 01 in force, which ends a drilling cycle (operator's manual, canned cycle for drilling).
    #[inline]
    pub(super) fn set_motion_mode(&mut self, motion: Motion) {
        self.modal.motion = motion;
        if self.modal.cycle.take().is_some() {
            self.cycle = CycleState::default();
        }
    }

    /// What the tool length offset comes of.
    pub fn length_compensation(&self) -> LengthCompensation {
        match self.modal.length {
            Length::Off => LengthCompensation::Off,
            Length::Plus => LengthCompensation::Plus(self.codes.h),
            Length::Minus => LengthCompensation::Minus(self.codes.h),
        }
    }
}

/// Where the last move ended, as it was programmed, while the program stands elsewhere in its coordinates because a
/// transform was switched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EndPoint {
    pub programmed: Position,
    /// The tool in the work coordinate system when the transform was switched: an offset that changes later moves both.
    pub work: Position,
}

/// What G16 keeps from block to block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolarPoint {
    /// mm; `None` before one was commanded.
    pub radius: Option<f64>,
    /// Degrees.
    pub angle: f64,
    /// The radius was commanded in G91: it is measured from where the tool stands, not from the work zero.
    pub is_incremental: bool,
}

/// Codes with a number that stays: #4107…#4130.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Codes {
    /// In the unit and mode it was commanded in.
    pub f: f64,
    pub s: f64,
    pub b: f64,
    pub d: u32,
    pub h: u32,
    pub m: u32,
    pub t: u32,
    pub n: u32,
    pub o: u32,
}

/// The modal data of a drilling cycle; G80 and group 01 clear it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CycleState {
    /// The axis that the cycle drills along, from its first block on.
    pub axis: Option<AxisIndex>,
    /// Where that axis stood when the cycle began.
    pub initial: f64,
    /// There it stood in machine coordinates, as in [`State::work_zero_unknown`].
    pub is_initial_unknown: bool,
    pub r: CycleLevel,
    pub z: CycleLevel,
    pub p: f64,
    pub q: Option<f64>,
    /// I, J and K of a Haas.
    pub pecks: Option<PeckSchedule>,
}

/// Pecks that become shorter, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeckSchedule {
    pub first: f64,
    pub decrement: f64,
    pub minimum: f64,
}

/// A level as commanded: G91 counts R from the initial level and Z from R.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CycleLevel {
    pub value: f64,
    pub is_incremental: bool,
    /// It was, in this cycle.
    pub is_commanded: bool,
}

impl CycleState {
    /// With pecks that come out as written where G51 makes `stretch` of each millimetre of the levels.
    pub(super) fn unscaled(self, stretch: f64) -> Self {
        let pecks = self.pecks.map(|pecks| PeckSchedule {
            first: pecks.first / stretch,
            decrement: pecks.decrement / stretch,
            minimum: pecks.minimum / stretch,
        });
        Self { q: self.q.map(|q| q / stretch), pecks, ..self }
    }

    pub(super) fn is_r_unknown(&self) -> bool {
        self.r.is_incremental && self.is_initial_unknown
    }

    pub(super) fn r_level(&self) -> f64 {
        if self.r.is_incremental { self.initial + self.r.value } else { self.r.value }
    }

    pub(super) fn z_level(&self) -> f64 {
        if self.z.is_incremental { self.r_level() + self.z.value } else { self.z.value }
    }
}
