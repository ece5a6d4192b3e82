//! Row of a G code: its effect and the facts that others read.
use super::code_facts::CodeFacts;
use super::cycles::Cycle;
use super::modes::{
    CutterSide, CuttingMode, Distance, DynamicOffset, FeedMode, Length, Mirror, ModalGroup, Motion, Plane,
    Polar, PolarInterpolation, ReturnTo, Rotation, Scaling, SpindleMode, StrokeCheck, Unit,
};
use crate::control::Dialect;

/// Effect of a G code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    /// Group 01: motion mode.
    Motion(Motion),
    /// Group 02: plane.
    Plane(Plane),
    /// Group 03: absolute or incremental.
    Distance(Distance),
    /// Group 04: stored stroke check.
    StrokeCheck(StrokeCheck),
    /// Group 05: feed mode.
    FeedMode(FeedMode),
    /// Group 06: inch or metric.
    Unit(Unit),
    /// Group 07: cutter compensation.
    Cutter(CutterSide),
    /// Group 08: tool length compensation.
    Length(Length),
    /// Group 09: canned cycle; `None` is G80.
    Cycle(Option<&'static Cycle>),
    /// Group 10: return level of canned cycles.
    ReturnTo(ReturnTo),
    /// Group 11: scaling.
    Scaling(Scaling),
    /// Group 13: spindle speed mode.
    SpindleMode(SpindleMode),
    /// Group 14: G54 to G59 as 1 to 6.
    Work(u8),
    /// Group 14: G54.1 and G154 with their P.
    AdditionalWork,
    /// Group 14: G110 to G129 of a Haas, which are G154 P1 to P20.
    NumberedWork(u16),
    /// Group 15: cutting mode.
    Cutting(CuttingMode),
    /// Group 16: rotation or tilted plane.
    Rotation(Rotation),
    /// Group 17: polar coordinates.
    Polar(Polar),
    /// Group 21: polar coordinate interpolation.
    PolarInterpolation(PolarInterpolation),
    /// Group 22: mirror image.
    Mirror(Mirror),
    /// Group 23: G254 and G255 of a Haas.
    DynamicOffset(DynamicOffset),
    /// Group 23: G54.2 and G54.4, with P0 to end it.
    UnstatedOffset(DynamicOffset),
    /// Group 00: effect in its own block only.
    OneShot(OneShot),
    /// Feed and lookahead control without an effect on the path.
    NoEffect,
    /// G08: [`Effect::NoEffect`] with a P.
    LookAhead,
    /// G187 of a Haas, with P and E.
    Smoothness,
    /// Code of the machine builder that the user declares to be without effect.
    Declared,
    /// Call; lowering has separated it unless the code is computed.
    Call,
    /// A control may have the code; the simulator does not execute it.
    NotSimulated,
}

impl Effect {
    /// Returns the modal group of a code that stays in force; `None` for any other.
    pub const fn group(self) -> Option<ModalGroup> {
        Some(match self {
            Self::Motion(_) => ModalGroup::Motion,
            Self::Plane(_) => ModalGroup::Plane,
            Self::Distance(_) => ModalGroup::Distance,
            Self::StrokeCheck(_) => ModalGroup::StrokeCheck,
            Self::FeedMode(_) => ModalGroup::FeedMode,
            Self::Unit(_) => ModalGroup::Unit,
            Self::Cutter(_) => ModalGroup::Cutter,
            Self::Length(_) => ModalGroup::Length,
            Self::Cycle(_) => ModalGroup::Cycle,
            Self::ReturnTo(_) => ModalGroup::ReturnTo,
            Self::Scaling(_) => ModalGroup::Scaling,
            Self::SpindleMode(_) => ModalGroup::SpindleMode,
            Self::Work(_) | Self::AdditionalWork | Self::NumberedWork(_) => ModalGroup::Work,
            Self::Cutting(_) => ModalGroup::Cutting,
            Self::Rotation(_) => ModalGroup::Rotation,
            Self::Polar(_) => ModalGroup::Polar,
            Self::PolarInterpolation(_) => ModalGroup::PolarInterpolation,
            Self::Mirror(_) => ModalGroup::Mirror,
            Self::DynamicOffset(_) | Self::UnstatedOffset(_) => ModalGroup::DynamicOffset,
            Self::OneShot(_)
            | Self::NoEffect
            | Self::LookAhead
            | Self::Smoothness
            | Self::Declared
            | Self::Call
            | Self::NotSimulated => return None,
        })
    }

    /// Returns true if events, the end of a block or modal conditions show the effect to a comparison of two runs.
    /// A mode that only the final state shows is not shown: a program can switch it on and off again.
    pub(super) const fn is_shown(self) -> bool {
        match self {
            Self::NoEffect | Self::LookAhead | Self::Smoothness | Self::Declared | Self::StrokeCheck(_) => {
                false
            }
            Self::Motion(_)
            | Self::Plane(_)
            | Self::Distance(_)
            | Self::FeedMode(_)
            | Self::Unit(_)
            | Self::Cutter(_)
            | Self::Length(_)
            | Self::Cycle(_)
            | Self::ReturnTo(_)
            | Self::Scaling(_)
            | Self::Work(_)
            | Self::AdditionalWork
            | Self::NumberedWork(_)
            | Self::Cutting(_)
            | Self::Rotation(_)
            | Self::Polar(_)
            | Self::PolarInterpolation(_)
            | Self::Mirror(_)
            | Self::DynamicOffset(_)
            | Self::UnstatedOffset(_)
            | Self::OneShot(_) => true,
            // The simulator has one state of the spindle mode.
            Self::SpindleMode(_) => true,
            // They call a program or raise an alarm.
            Self::Call | Self::NotSimulated => true,
        }
    }
}

/// Group 00: code that acts in its own block only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OneShot {
    /// G04: dwell.
    Dwell,
    /// G10: data input.
    DataInput,
    /// G10.6: point to which the tool retracts at the operator's signal.
    RetractPoint,
    /// G11: end of data input.
    DataInputEnd,
    /// G27: reference position check.
    CheckReference,
    /// G28: move to the reference position.
    Reference,
    /// G29: move from the reference position.
    FromReference,
    /// G30: move to the second, third or fourth reference position.
    SecondReference,
    /// G266 of a Haas: rapid in a straight line, E the percentage of the rapid rate.
    StraightRapid,
    /// G31: skip.
    Skip,
    /// G35, G36, G37 and G136 of a Haas: a skip whose signal sets an offset.
    Measure(MeasuringCode),
    /// G52: set the local coordinate system.
    SetLocalCoordinateSystem,
    /// G53: machine coordinate system.
    MachineCoordinateSystem,
    /// G92: set the work coordinate system.
    SetWorkCoordinateSystem,
    /// G53.1, and G253 of a Haas: rotary axes point the tool along Z of the tilted plane.
    ToolAxis {
        /// G53.6: the tip stays on the part.
        keeps_tip: bool,
    },
    /// G39: corner arc in cutter compensation.
    CornerArc,
    /// G92.1: preset the work coordinate system.
    PresetWorkCoordinateSystem,
    /// G60: single direction positioning.
    SingleDirection,
    /// G45 to G48: travel extended by 1, −1, 2 or −2 tool offsets.
    ToolOffset(i8),
    /// G12 and G13 of a Haas.
    CirclePocket(Motion),
    /// G47 of a Haas.
    Engraving,
    /// G70, G71 and G72 of a Haas.
    BoltHoles(HolePattern),
    /// G07.1: cylindrical interpolation.
    Cylinder,
    /// G107 of a Haas: a linear axis wrapped round a cylinder.
    WrappedAxis,
    /// G150 of a Haas: its outline is the program P.
    Pocket,
    /// G174 and G184 of a Haas.
    AskewTapping {
        /// G174: the spindle turns counterclockwise on its way in.
        is_left_handed: bool,
    },
}

impl OneShot {
    /// Returns true for a cut that a skip signal ends.
    pub fn is_skip(self) -> bool {
        matches!(self, Self::Skip | Self::Measure(_))
    }

    /// Returns true for G28 and G30, which move to a reference position.
    pub fn moves_to_reference(self) -> bool {
        matches!(self, Self::Reference | Self::SecondReference)
    }

    /// Returns true for a code that moves to machine coordinates: G28, G30 and G53.
    pub fn moves_on_machine(self) -> bool {
        self == Self::MachineCoordinateSystem || self.moves_to_reference()
    }
}

/// Code of a Haas that sets an offset where a skip signal comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuringCode {
    /// G35: tool diameter.
    ToolDiameter,
    /// G36: work zero.
    WorkZero,
    /// G136: work zero half-way between two points.
    WorkCentre,
    /// G37: tool length.
    ToolLength,
}

impl MeasuringCode {
    /// Returns the name of the code.
    pub fn name(self) -> &'static str {
        match self {
            Self::ToolDiameter => "G35",
            Self::WorkZero => "G36",
            Self::WorkCentre => "G136",
            Self::ToolLength => "G37",
        }
    }
}

/// Arrangement of a pattern's holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HolePattern {
    /// Evenly spaced on the full circle.
    Circle,
    /// Spaced by a specified angle.
    Arc,
    /// Evenly spaced on a straight line.
    Line,
}

/// Row of the table.
#[derive(Clone, Copy, Debug)]
pub struct GCodeRow {
    /// G code × 10: 541 is G54.1.
    pub code: u32,
    /// Effect in a run.
    pub effect: Effect,
    /// Facts for readers of the code that do not execute it.
    pub facts: CodeFacts,
    /// Description in a few words.
    pub description: &'static str,
    /// Controls with this meaning of the code.
    pub dialects: &'static [Dialect],
}

impl GCodeRow {
    /// Returns the modal group of a code that stays in force; `None` for any other.
    pub fn group(&self) -> Option<u32> {
        self.effect.group().map(ModalGroup::number)
    }
}

/// Returns the number of a code × 10 as manuals write it: `00`, `02.2`, `54.1`.
pub fn spelled(code: u32) -> String {
    let (whole, tenth) = (code / 10, code % 10);
    if tenth == 0 { format!("{whole:02}") } else { format!("{whole:02}.{tenth}") }
}

/// Returns a code × 10 with its letter: `G28`, `G00`, `G05.1`.
pub fn name(code: u32) -> String {
    format!("G{}", spelled(code))
}
