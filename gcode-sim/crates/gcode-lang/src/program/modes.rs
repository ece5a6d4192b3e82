//! States of the modal groups: one type per group, each state with its G code × 10 as #4001… reads it.

use crate::control::Dialect;

macro_rules! groups {
    ($($name:ident = $number:literal, $what:literal;)+) => {
        /// Modal group of G codes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum ModalGroup {
            $(#[doc = concat!("Group ", $number, ": ", $what, ".")] $name = $number,)+
        }

        impl ModalGroup {
            /// Returns what the codes of the group decide: `plane of arcs and drilling`.
            pub const fn subject(self) -> &'static str {
                match self { $(Self::$name => $what),+ }
            }
        }

        /// All modal groups in ascending order.
        pub const GROUPS: &[ModalGroup] = &[$(ModalGroup::$name),+];
    };
}

groups! {
    Motion = 1, "motion";
    Plane = 2, "plane of arcs and drilling";
    Distance = 3, "absolute or incremental";
    StrokeCheck = 4, "stored stroke check";
    FeedMode = 5, "feed mode";
    Unit = 6, "inch or metric";
    Cutter = 7, "cutter compensation";
    Length = 8, "tool length compensation";
    Cycle = 9, "canned cycle";
    ReturnTo = 10, "return level of canned cycles";
    Scaling = 11, "scaling";
    ModalCall = 12, "modal macro calls";
    SpindleMode = 13, "spindle speed mode";
    Work = 14, "work coordinate system";
    Cutting = 15, "cutting mode";
    Rotation = 16, "coordinate system rotation";
    Polar = 17, "polar coordinates";
    NormalDirection = 18, "normal direction control";
    AlternateNormalDirection = 19, "normal direction control by its other number";
    InFeed = 20, "in-feed control";
    PolarInterpolation = 21, "polar coordinate interpolation";
    Mirror = 22, "mirror image";
    DynamicOffset = 23, "dynamic work offset of a Haas";
}

impl ModalGroup {
    /// Returns the group with a number of #4001…; `None` if there is none.
    pub fn of(number: u32) -> Option<Self> {
        GROUPS.iter().copied().find(|group| group.number() == number)
    }

    /// Returns the number of the group as in #4001….
    pub const fn number(self) -> u32 {
        self as u32
    }
}

/// Set of modal groups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GroupSet(u32);

impl GroupSet {
    /// Returns the set of these groups.
    pub fn of(groups: &[ModalGroup]) -> Self {
        Self(groups.iter().fold(0, |set, group| set | 1 << group.number()))
    }

    /// Adds a group.
    pub fn insert(&mut self, group: ModalGroup) {
        self.0 |= 1 << group.number();
    }

    /// Returns true if the group is in the set.
    pub fn contains(self, group: ModalGroup) -> bool {
        self.0 >> group.number() & 1 == 1
    }

    /// Returns true for the empty set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns the groups of either set.
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns the groups that `other` lacks.
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

macro_rules! group {
    ($(#[$doc:meta])* $name:ident { $($(#[$default:ident])? $state:ident = $code:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            $(#[doc = concat!("State of G code × 10 ", $code, ".")] $(#[$default])? $state,)+
        }

        impl $name {
            /// Returns the G code × 10 of the state.
            pub const fn code(self) -> u32 {
                match self {
                    $(Self::$state => $code,)+
                }
            }
        }
    };
}

group!(/// Group 01: motion.
    Motion { #[default] Rapid = 0, Linear = 10, Clockwise = 20, Counterclockwise = 30, Thread = 330, });
group!(/// Group 02: plane of arcs and drilling.
    Plane { #[default] Xy = 170, Zx = 180, Yz = 190, });
group!(/// Group 03: absolute or incremental.
    Distance { #[default] Absolute = 900, Incremental = 910, });
group!(/// Group 04: stored stroke check.
    StrokeCheck { #[default] On = 220, Off = 230, });
group!(/// Group 05: feed mode.
    FeedMode { InverseTime = 930, #[default] PerMinute = 940, PerRevolution = 950, });
group!(/// Group 06: inch or metric.
    Unit { Inch = 200, #[default] Metric = 210, });
group!(/// Group 07: cutter compensation.
    CutterSide { #[default] Off = 400, Left = 410, Right = 420, });
group!(/// Group 08: tool length compensation.
    Length { Plus = 430, Minus = 440, TipByAngles = 434, TipByVector = 435, TipOfHaas = 2340, #[default] Off = 490, });
group!(/// Group 10: return level of canned cycles.
    ReturnTo { #[default] Initial = 980, R = 990, });
group!(/// Group 11: scaling.
    Scaling { #[default] Off = 500, On = 510, });
group!(/// Group 12: modal macro calls.
    ModalCall { #[default] Off = 670, AfterMoves = 660, EveryBlock = 661, });
group!(/// Group 13: spindle speed mode.
    SpindleMode { SurfaceSpeed = 960, #[default] Speed = 970, });
group!(/// Group 15: cutting mode.
    CuttingMode { ExactStop = 610, CornerOverride = 620, Tapping = 630, #[default] Cutting = 640, });
group!(/// Group 16: coordinate system rotation.
    Rotation { On = 680, #[default] Off = 690, Tilted = 682, AlongTool = 683, TiltedFurther = 684, Feature = 2680, });
group!(/// Group 17: polar coordinates.
    Polar { #[default] Off = 150, On = 160, });
group!(/// Group 21: polar coordinate interpolation.
    PolarInterpolation { #[default] Off = 131, On = 121, });
group!(/// Group 22: mirror image.
    Mirror { #[default] Off = 501, On = 511, });
group!(/// Group 23: dynamic work offset of a Haas; G54.2 and G54.4 of a Fanuc, whose values nothing states.
    DynamicOffset { #[default] Off = 2550, On = 2540, Fixture = 542, SettingError = 544, });

/// Group 14: work coordinate system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WorkSystem {
    /// G54 to G59 as 1 to 6.
    Standard(u8),
    /// G54.1 with its P.
    Additional(u16),
}

impl Default for WorkSystem {
    fn default() -> Self {
        Self::Standard(1)
    }
}

impl WorkSystem {
    /// Returns the G code × 10.
    pub fn code(self) -> u32 {
        match self {
            Self::Standard(number) => 530 + 10 * u32::from(number),
            Self::Additional(_) => 541,
        }
    }

    /// Returns the code in a dialect: `G55`, `G54.1 P3`, on a Haas `G154 P3`.
    pub fn name(self, dialect: Dialect) -> String {
        match self {
            Self::Standard(_) => format!("G{}", self.code() / 10),
            Self::Additional(number) if dialect == Dialect::HaasNgc => format!("G154 P{number}"),
            Self::Additional(number) => format!("G54.1 P{number}"),
        }
    }

    /// Returns the variable of the offset of axis 1.
    pub fn first_variable(self) -> u32 {
        match self {
            Self::Standard(number) => 5201 + 20 * u32::from(number),
            Self::Additional(number) => 13_981 + 20 * u32::from(number),
        }
    }
}
