//! State that one block can change besides variables and offset tables: modes, positions, codes with a number, the transform
//! of coordinates. It is small enough to copy, so that a block that raises an alarm leaves no trace.
use super::axis_word_use::AxisWordUse;
use super::kinematics::PartError;
use super::transform::Transform;
use super::virtual_plane::VirtualPlane;
use gcode_lang::motion::{AxisIndex, LengthCompensation, Position, SpindleDirection, UnknownAxes};
use gcode_lang::program::cycles::Cycle;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::{
    CutterSide, CuttingMode, Distance, DynamicOffset, FeedMode, Length, Mirror, ModalCall, ModalGroup,
    Motion, Plane, Polar, PolarInterpolation, ReturnTo, Rotation, Scaling, SpindleMode, StrokeCheck, Unit,
    WorkSystem,
};

/// Control between two blocks; lengths in mm even with G20.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Modal codes.
    pub modal: Modal,
    /// Programmed position in the work coordinate system, before mirror, scaling and rotation, without the tool length.
    pub(super) programmed_position: Position,
    /// Position that #5001… show until the first move after G51.1, G51, G68 or their end.
    pub(super) end_before_transform: Option<EndBeforeTransform>,
    /// Position in machine coordinates, tool length included.
    pub(super) machine_position: Position,
    /// Shift of G52.
    pub(super) g52_shift: Position,
    /// Shift of G92.
    pub(super) g92_shift: Position,
    /// Active tool length offset of each axis.
    pub(super) length_offset: Position,
    /// Part of it that is wear, along the tool; negative with G44.
    pub(super) length_wear: f64,
    /// G28, G30 or G53 has cancelled the length offset, and G43 or G44 is still the modal code: the next H, G43 or
    /// G44 brings the offset back.
    pub(super) is_length_cancelled: bool,
    /// Intermediate point of G28 for G29, from the work zero, tool length included.
    pub(super) intermediate_point: Position,
    /// Axes with an intermediate point, as bits.
    pub(super) intermediate_axes: u8,
    /// Axes that were unknown at the intermediate point.
    pub(super) unknown_intermediate: UnknownAxes,
    /// Axes of unknown position on the part, in programmed coordinates.
    pub(super) unknown: UnknownAxes,
    /// Axes that the last event has stated as unknown, in machine coordinates.
    pub(super) stated_unknown: UnknownAxes,
    /// Axes whose coordinates count from an unknown position since G92, as bits.
    pub(super) unknown_g92_shift: u8,
    /// End of the last G31 in machine coordinates, #5061….
    pub(super) skip_position: Position,
    /// Position of the skip signal of a G31 with M75.
    pub(super) skip_reference: Option<Position>,
    /// Radius of cutter compensation, read by D or G41, G42; negative if it swaps sides.
    pub(super) cutter_radius: f64,
    pub(super) transform: Transform,
    /// Values of G54.2 or G54.4, where they are stated.
    pub(super) part_error: Option<PartError>,
    /// Polar or cylindrical interpolation: machine positions are those of its plane.
    pub(super) virtual_plane: Option<VirtualPlane>,
    /// Modal data of the canned cycle.
    pub cycle: CycleState,
    /// Modal words with a number.
    pub modal_words: ModalWords,
    pub(super) polar: PolarPoint,
    /// Spindle.
    pub spindle: SpindleDirection,
    pub(super) is_coolant_on: bool,
    /// Between G10 L52 and G11.
    pub(super) is_in_parameter_input: bool,
    /// M29.
    pub(super) rigid_tapping: RigidTapping,
    /// Number of the tool in the spindle.
    pub tool: u32,
}

/// Returns true for G02 and G03.
pub(super) fn is_circular(motion: Motion) -> bool {
    matches!(motion, Motion::Clockwise | Motion::Counterclockwise)
}

impl State {
    /// Applies a code of group 01, which ends a canned cycle (operator's manual, canned cycle for drilling).
    #[inline]
    pub(super) fn set_motion_mode(&mut self, motion: Motion) {
        self.modal.motion = motion;
        if self.modal.cycle.take().is_some() {
            self.cycle = CycleState::default();
            self.rigid_tapping = RigidTapping::Off;
        }
    }

    /// Returns true if blocks of axis words move on arcs.
    pub(super) fn moves_on_arc(&self) -> bool {
        self.modal.cycle.is_none() && is_circular(self.modal.motion)
    }

    /// Returns the G code × 10 of a group that is in force: the active one as in #4001…, and G49 where G28, G30 or G53 has
    /// cancelled the length offset of G43 or G44.
    pub fn code_in_force(&self, group: ModalGroup) -> u32 {
        match group {
            ModalGroup::Length if self.is_length_cancelled => Length::Off.code(),
            group => self.modal.code_in(group),
        }
    }

    /// Returns the source of the tool length offset.
    pub(super) fn length_compensation(&self) -> LengthCompensation {
        match self.modal.length {
            _ if self.is_length_cancelled => LengthCompensation::Off,
            Length::Off => LengthCompensation::Off,
            Length::Plus | Length::TipByAngles | Length::TipByVector | Length::TipOfHaas => {
                LengthCompensation::Plus(self.modal_words.h)
            }
            Length::Minus => LengthCompensation::Minus(self.modal_words.h),
        }
    }
}

/// Rigid tapping: after M29 G84 and G74 turn the spindle themselves until the cycle ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum RigidTapping {
    /// No M29.
    #[default]
    Off,
    /// M29 without S, which may be a code of the machine builder. Only a tapping cycle shows that it isn't.
    Possible {
        /// An axis has moved since.
        has_moved: bool,
    },
    /// M29 with S in its block.
    Certain,
}

impl RigidTapping {
    /// Takes note of a move, or of a code that a control does not accept between M29 and its cycle.
    pub(super) fn record_move(&mut self) {
        if let Self::Possible { has_moved } = self {
            *has_moved = true;
        }
    }

    /// Ends a possible rigid tapping at a code that starts or stops the spindle or changes the tool.
    pub(super) fn end_if_possible(&mut self) {
        if let Self::Possible { .. } = self {
            *self = Self::Off;
        }
    }
}

/// Programmed end of the last move, after a change of the transform has changed the programmed position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct EndBeforeTransform {
    pub(super) programmed: Position,
    /// Tool position in the work coordinate system at the change; later changes of an offset move both.
    pub(super) work: Position,
}

/// Polar coordinates that G16 keeps from block to block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PolarPoint {
    /// mm; `None` until one is commanded.
    pub(super) radius: Option<f64>,
    /// Degrees.
    pub(super) angle: f64,
    /// The radius was commanded in G91: it counts from the current position, not from the work zero.
    pub(super) is_incremental: bool,
}

/// Words whose number stays in effect: #4107…#4130.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModalWords {
    /// Feed, in the unit and mode in which it was commanded.
    pub f: f64,
    pub(super) mode_of_f: FeedMode,
    /// Spindle speed.
    pub s: f64,
    /// B code.
    pub b: f64,
    /// Number of the cutter radius offset.
    pub d: u32,
    /// Number of the tool length offset.
    pub h: u32,
    /// M code.
    pub m: u32,
    /// T code.
    pub t: u32,
    /// Sequence number.
    pub n: u32,
    /// Program number.
    pub o: u32,
}

/// Modal data of a canned cycle; G80 and group 01 clear it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CycleState {
    /// Drilling axis, from the first block of the cycle on.
    pub(super) axis: Option<AxisIndex>,
    /// Position of that axis when the cycle began.
    pub(super) initial: f64,
    /// Axes that were unknown then.
    pub(super) initial_unknown: UnknownAxes,
    pub(super) r: CycleLevel,
    pub(super) z: CycleLevel,
    pub(super) p: f64,
    /// Depth of a peck, or shift.
    pub q: Option<f64>,
    /// I, J and K of a Haas.
    pub(super) pecks: Option<PeckSchedule>,
    /// K beside Q in G73 of a Haas: the depth of the pecks between two retracts to R.
    pub(super) depth_to_retract: Option<f64>,
    /// I and J of G76 and G77 of a Haas: the shift off the wall.
    pub(super) shift: Option<[f64; 2]>,
}

/// Pecks that become shorter, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PeckSchedule {
    pub(super) first: f64,
    pub(super) decrement: f64,
    pub(super) minimum: f64,
}

/// Level as commanded: G91 counts R from the initial level and Z from R.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CycleLevel {
    pub(super) value: f64,
    pub(super) is_incremental: bool,
    /// The level was commanded in this cycle.
    pub(super) is_commanded: bool,
}

impl CycleState {
    /// Returns the cycle with pecks that have their commanded length after the scaling of the levels by `scale_factor`.
    pub(super) fn with_unscaled_pecks(self, scale_factor: f64) -> Self {
        let pecks = self.pecks.map(|pecks| PeckSchedule {
            first: pecks.first / scale_factor,
            decrement: pecks.decrement / scale_factor,
            minimum: pecks.minimum / scale_factor,
        });
        let depth_to_retract = self.depth_to_retract.map(|depth| depth / scale_factor);
        Self { q: self.q.map(|q| q / scale_factor), pecks, depth_to_retract, ..self }
    }

    /// Returns the axes that are unknown at the R point level; `absolute` are those in G90.
    pub(super) fn r_unknown(&self, absolute: UnknownAxes) -> UnknownAxes {
        if self.r.is_incremental { self.initial_unknown } else { absolute }
    }

    pub(super) fn r_level(&self) -> f64 {
        if self.r.is_incremental { self.initial + self.r.value } else { self.r.value }
    }

    pub(super) fn z_level(&self) -> f64 {
        if self.z.is_incremental { self.r_level() + self.z.value } else { self.z.value }
    }
}

/// Modal codes: one typed field per group, so that they can't contradict one another; `Default` is power-on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Modal {
    /// Group 01: motion.
    pub motion: Motion,
    pub(super) plane: Plane,
    pub(super) distance: Distance,
    pub(super) stroke_check: StrokeCheck,
    pub(super) feed_mode: FeedMode,
    pub(super) unit: Unit,
    pub(super) cutter: CutterSide,
    pub(super) length: Length,
    /// Group 09: canned cycle; `None` is G80.
    pub cycle: Option<&'static Cycle>,
    pub(super) return_to: ReturnTo,
    pub(super) scaling: Scaling,
    pub(super) call: ModalCall,
    pub(super) spindle_mode: SpindleMode,
    /// Group 14: work coordinate system.
    pub work: WorkSystem,
    pub(super) cutting: CuttingMode,
    pub(super) rotation: Rotation,
    pub(super) polar: Polar,
    pub(super) polar_interpolation: PolarInterpolation,
    pub(super) mirror: Mirror,
    pub(super) dynamic: DynamicOffset,
}

impl Modal {
    /// Applies a G code and returns the use that it makes of the axis words of its block, if any. Codes of group 01 are
    /// applied by [`State::set_motion_mode`].
    pub(super) fn apply(&mut self, effect: Effect) -> Option<AxisWordUse> {
        match effect {
            Effect::Plane(plane) => self.plane = plane,
            Effect::Distance(distance) => self.distance = distance,
            Effect::StrokeCheck(check) => {
                self.stroke_check = check;
                return (check == StrokeCheck::On).then_some(AxisWordUse::Limits);
            }
            Effect::FeedMode(mode) => self.feed_mode = mode,
            Effect::Unit(unit) => self.unit = unit,
            Effect::Cutter(side) => self.cutter = side,
            Effect::Length(length) => self.length = length,
            Effect::Cycle(cycle) => self.cycle = cycle,
            Effect::ReturnTo(to) => self.return_to = to,
            Effect::SpindleMode(mode) => self.spindle_mode = mode,
            Effect::Work(number) => self.work = WorkSystem::Standard(number),
            Effect::NumberedWork(number) => self.work = WorkSystem::Additional(number),
            Effect::Cutting(mode) => self.cutting = mode,
            Effect::Polar(polar) => self.polar = polar,
            Effect::DynamicOffset(dynamic) => self.dynamic = dynamic,
            Effect::Scaling(scaling) => {
                self.scaling = scaling;
                return (scaling == Scaling::On).then_some(AxisWordUse::Scale);
            }
            Effect::Rotation(rotation) => {
                self.rotation = rotation;
                return match rotation {
                    Rotation::Off => None,
                    Rotation::On => Some(AxisWordUse::Rotate),
                    Rotation::Tilted | Rotation::TiltedFurther | Rotation::AlongTool | Rotation::Feature => {
                        Some(AxisWordUse::Tilt)
                    }
                };
            }
            Effect::Mirror(mirror) => {
                self.mirror = mirror;
                return Some(AxisWordUse::Mirror { is_on: mirror == Mirror::On });
            }
            Effect::PolarInterpolation(mode) => {
                self.polar_interpolation = mode;
                return Some(AxisWordUse::PolarInterpolation { is_on: mode == PolarInterpolation::On });
            }
            Effect::AdditionalWork => return Some(AxisWordUse::AdditionalWork),
            Effect::OneShot(one) => return Some(AxisWordUse::OneShot(one)),
            Effect::Motion(_)
            | Effect::UnstatedOffset(_)
            | Effect::NoEffect
            | Effect::LookAhead
            | Effect::Smoothness
            | Effect::Declared
            | Effect::Call
            | Effect::NotSimulated => {}
        }
        None
    }

    /// Returns the active G code × 10 of a group by its number, as #4001…; `None` if there is no such group.
    pub fn code(&self, group: u32) -> Option<u32> {
        ModalGroup::of(group).map(|group| self.code_in(group))
    }

    /// Returns the active G code × 10 of a group.
    pub fn code_in(&self, group: ModalGroup) -> u32 {
        match group {
            ModalGroup::Motion => self.motion.code(),
            ModalGroup::Plane => self.plane.code(),
            ModalGroup::Distance => self.distance.code(),
            ModalGroup::StrokeCheck => self.stroke_check.code(),
            ModalGroup::FeedMode => self.feed_mode.code(),
            ModalGroup::Unit => self.unit.code(),
            ModalGroup::Cutter => self.cutter.code(),
            ModalGroup::Length => self.length.code(),
            ModalGroup::Cycle => self.cycle.map_or(800, |cycle| cycle.code),
            ModalGroup::ReturnTo => self.return_to.code(),
            ModalGroup::Scaling => self.scaling.code(),
            ModalGroup::ModalCall => self.call.code(),
            ModalGroup::SpindleMode => self.spindle_mode.code(),
            ModalGroup::Work => self.work.code(),
            ModalGroup::Cutting => self.cutting.code(),
            ModalGroup::Rotation => self.rotation.code(),
            ModalGroup::Polar => self.polar.code(),
            // Normal direction control and in-feed control are always off.
            ModalGroup::NormalDirection | ModalGroup::AlternateNormalDirection => 401,
            ModalGroup::InFeed => 1600,
            ModalGroup::PolarInterpolation => self.polar_interpolation.code(),
            ModalGroup::Mirror => self.mirror.code(),
            ModalGroup::DynamicOffset => self.dynamic.code(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::program::modes::GROUPS;

    #[test]
    fn power_on_codes_are_those_of_the_manuals() {
        let modal = Modal::default();
        let codes: Vec<_> = GROUPS.iter().map(|group| modal.code_in(*group)).collect();
        let expected = [
            0, 170, 900, 220, 940, 210, 400, 490, 800, 980, 500, 670, 970, 540, 640, 690, 150, 401, 401,
            1600, 131, 501, 2550,
        ];
        assert_eq!(codes, expected);
    }
}
