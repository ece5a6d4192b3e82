//! The feed, the motion mode and the canned cycle that are possible before a block.
use gcode_control::static_plan::{CertainModes, ModesInForce};
use gcode_lang::program::cycles::{Cycle, DRILLING as DRILLING_CYCLE};
use gcode_lang::program::g_codes::{Effect, OneShot};
use gcode_lang::program::modes::{CutterSide, Distance, FeedMode, Length, Mirror, Motion, Rotation, Scaling};

/// A cycle that needs no word of its own.
static DRILLING: Cycle = DRILLING_CYCLE;

/// Possible modes before a block: each but `certain` is true if it holds on some path to the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PossibleModes {
    /// F is commanded.
    pub has_feed: bool,
    /// The motion mode is G00.
    pub is_rapid: bool,
    /// The motion mode is not an arc.
    pub is_straight: bool,
    /// No canned cycle is in force.
    pub is_outside_cycle: bool,
    /// A canned cycle is in force.
    pub is_in_cycle: bool,
    /// The cycle in force, if it is the same on all paths.
    pub cycle: Option<&'static Cycle>,
    /// The depth of a peck is commanded.
    pub has_pecks: bool,
    /// The feed mode is G93.
    pub is_inverse_time: bool,
    /// The feed mode is another one.
    pub is_other_feed_mode: bool,
    /// The mode is G90.
    pub is_absolute: bool,
    /// No earlier block lacks F. The first that does stops the control, and its F serves the blocks after it.
    pub is_unreported: bool,
    /// Modes that are on along every path to the block.
    pub certain: CertainModes,
}

impl PossibleModes {
    /// Modes at power-on; a setting of the control decides between G00 and G01.
    pub(super) const POWER_ON: Self = Self {
        has_feed: false,
        is_rapid: true,
        is_straight: true,
        is_outside_cycle: true,
        is_in_cycle: false,
        cycle: None,
        has_pecks: false,
        is_inverse_time: false,
        is_other_feed_mode: true,
        is_absolute: true,
        is_unreported: true,
        certain: CertainModes::POWER_ON,
    };
    pub(super) const ANYTHING: Self = Self {
        has_feed: true,
        is_in_cycle: true,
        has_pecks: true,
        is_inverse_time: true,
        certain: CertainModes::NONE,
        ..Self::POWER_ON
    };

    pub(super) fn join(self, other: Self) -> Self {
        Self {
            has_feed: self.has_feed | other.has_feed,
            is_rapid: self.is_rapid | other.is_rapid,
            is_straight: self.is_straight | other.is_straight,
            is_outside_cycle: self.is_outside_cycle | other.is_outside_cycle,
            is_in_cycle: self.is_in_cycle | other.is_in_cycle,
            cycle: match (self.is_in_cycle, other.is_in_cycle) {
                (true, true) => self.cycle.filter(|_| self.cycle == other.cycle),
                (true, false) => self.cycle,
                (false, _) => other.cycle,
            },
            has_pecks: self.has_pecks | other.has_pecks,
            is_inverse_time: self.is_inverse_time | other.is_inverse_time,
            is_other_feed_mode: self.is_other_feed_mode | other.is_other_feed_mode,
            is_absolute: self.is_absolute | other.is_absolute,
            is_unreported: self.is_unreported | other.is_unreported,
            certain: self.certain.join(other.certain),
        }
    }

    pub(super) fn with_unknown_motion(self) -> Self {
        Self {
            is_rapid: true,
            is_straight: true,
            is_outside_cycle: true,
            is_in_cycle: true,
            cycle: None,
            has_pecks: true,
            // A computed G code may be any.
            is_other_feed_mode: true,
            is_absolute: true,
            certain: CertainModes::NONE,
            ..self
        }
    }

    /// Returns the modes after a G code; a code of group 01 ends a cycle.
    pub(super) fn after_effect(self, effect: Effect) -> Self {
        match effect {
            Effect::Motion(motion) => Self {
                is_rapid: motion == Motion::Rapid,
                is_straight: !matches!(motion, Motion::Clockwise | Motion::Counterclockwise),
                is_outside_cycle: true,
                is_in_cycle: false,
                cycle: None,
                has_pecks: false,
                ..self
            },
            Effect::Cycle(cycle) => Self {
                is_outside_cycle: cycle.is_none(),
                is_in_cycle: cycle.is_some(),
                cycle,
                has_pecks: cycle.is_some() && self.has_pecks,
                ..self
            },
            Effect::FeedMode(mode) => Self {
                is_inverse_time: mode == FeedMode::InverseTime,
                is_other_feed_mode: mode != FeedMode::InverseTime,
                certain: CertainModes { inverse_time: mode == FeedMode::InverseTime, ..self.certain },
                ..self
            },
            Effect::Distance(distance) => Self { is_absolute: distance == Distance::Absolute, ..self },
            Effect::Rotation(rotation) => self.with_certain(|modes| {
                modes.rotation = rotation == Rotation::On;
                modes.level = rotation == Rotation::Off;
                modes.plane = !matches!(rotation, Rotation::On | Rotation::Off);
                modes.aligned = rotation == Rotation::AlongTool;
            }),
            Effect::OneShot(OneShot::ToolAxis { .. }) => {
                self.with_certain(|modes| modes.aligned = modes.plane)
            }
            Effect::Length(length) => self.with_certain(|modes| {
                modes.tip = matches!(length, Length::TipByAngles | Length::TipByVector | Length::TipOfHaas)
            }),
            Effect::Scaling(scaling) => self.with_certain(|modes| modes.scaling = scaling == Scaling::On),
            Effect::Mirror(mirror) => self.with_certain(|modes| modes.mirror = mirror == Mirror::On),
            Effect::Cutter(side) => self.with_certain(|modes| modes.cutter = side != CutterSide::Off),
            _ => self,
        }
    }

    /// Returns the modes after a change of those that are certain.
    pub(super) fn with_certain(mut self, change: impl FnOnce(&mut CertainModes)) -> Self {
        change(&mut self.certain);
        self
    }

    /// Returns the modes in which a block can be read, the one that accepts most first.
    pub(crate) fn in_force(self) -> impl Iterator<Item = ModesInForce> {
        let motion = match (self.is_rapid, self.is_straight) {
            (true, _) => Motion::Rapid,
            (false, true) => Motion::Linear,
            (false, false) => Motion::Clockwise,
        };
        let modes = ModesInForce { motion, cycle: None, has_pecks: self.has_pecks, certain: self.certain };
        let in_cycle = ModesInForce { cycle: Some(self.cycle.unwrap_or(&DRILLING)), ..modes };
        let cycle = self.is_in_cycle.then_some(in_cycle);
        cycle.into_iter().chain(self.is_outside_cycle.then_some(modes))
    }
}
