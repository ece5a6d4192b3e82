//! A G code's row: what a run does by it, and what others have to know of it.
use super::code_facts::CodeFacts;
use super::cycles::Cycle;
use super::modes::{
    CutterSide, CuttingMode, Distance, FeedMode, Length, Mirror, Motion, Plane, Polar, ReturnTo, Rotation,
    Scaling, SpindleMode, StrokeCheck, Unit,
};
use crate::control::CodeSet;

/// What a G code does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    Motion(Motion),
    Plane(Plane),
    Distance(Distance),
    StrokeCheck(StrokeCheck),
    FeedMode(FeedMode),
    Unit(Unit),
    Cutter(CutterSide),
    Length(Length),
    /// `None` is G80.
    Cycle(Option<&'static Cycle>),
    ReturnTo(ReturnTo),
    Scaling(Scaling),
    SpindleMode(SpindleMode),
    /// G54 to G59 as 1 to 6.
    Work(u8),
    /// G54.1 and G154 with their P.
    AdditionalWork,
    /// G110 to G129 of a Haas: G154 P1 to P20.
    NumberedWork(u16),
    Cutting(CuttingMode),
    Rotation(Rotation),
    Polar(Polar),
    Mirror(Mirror),
    OneShot(OneShot),
    /// Feed and look-ahead control that moves nothing elsewhere.
    NoEffect,
    /// G08: as [`Effect::NoEffect`], with a P.
    LookAhead,
    /// G187 of a Haas, with P and E.
    Smoothness,
    /// Calls, which lowering has taken out of the words where the code is a literal.
    Call,
    /// A control may have it; this one does not execute it.
    NotSimulated,
}

impl Effect {
    /// The group of a code that stays in force.
    pub fn group(self) -> Option<u32> {
        Some(match self {
            Self::Motion(_) => 1,
            Self::Plane(_) => 2,
            Self::Distance(_) => 3,
            Self::StrokeCheck(_) => 4,
            Self::FeedMode(_) => 5,
            Self::Unit(_) => 6,
            Self::Cutter(_) => 7,
            Self::Length(_) => 8,
            Self::Cycle(_) => 9,
            Self::ReturnTo(_) => 10,
            Self::Scaling(_) => 11,
            Self::SpindleMode(_) => 13,
            Self::Work(_) | Self::AdditionalWork | Self::NumberedWork(_) => 14,
            Self::Cutting(_) => 15,
            Self::Rotation(_) => 16,
            Self::Polar(_) => 17,
            Self::Mirror(_) => 22,
            Self::OneShot(_)
            | Self::NoEffect
            | Self::LookAhead
            | Self::Smoothness
            | Self::Call
            | Self::NotSimulated => return None,
        })
    }
}

/// Group 00: acts in its own block only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OneShot {
    Dwell,
    DataInput,
    DataInputEnd,
    CheckReference,
    Reference,
    FromReference,
    SecondReference,
    Skip,
    LocalSystem,
    MachineSystem,
    SetSystem,
    CornerArc,
    PresetSystem,
    OneSide,
    /// G12 and G13 of a Haas.
    CirclePocket(Motion),
    /// G70 and G71 of a Haas.
    BoltHoles(HolePattern),
}

/// How a pattern places its holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HolePattern {
    /// All round.
    Circle,
    /// By a given angle from hole to hole.
    Arc,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct GCodeRow {
    /// G code × 10: 541 is G54.1.
    pub code: u32,
    /// What a run does by it.
    pub effect: Effect,
    /// What others have to know of it.
    pub facts: CodeFacts,
    pub help: &'static str,
    /// The controls that have it so.
    pub code_sets: &'static [CodeSet],
}

impl GCodeRow {
    /// The group of a code that stays in force.
    pub fn group(&self) -> Option<u32> {
        self.effect.group()
    }
}

/// A code × 10 as it is written: `54.1`.
pub fn spelled(code: u32) -> String {
    if code.is_multiple_of(10) { format!("{}", code / 10) } else { format!("{}.{}", code / 10, code % 10) }
}

/// A code × 10 as programs write it: `G28`, `G00`, `G05.1`.
pub fn name(code: u32) -> String {
    if code < 100 { format!("G0{}", spelled(code)) } else { format!("G{}", spelled(code)) }
}
