//! Table of G codes, one row per code. A code without a row raises an alarm and is never skipped.
use super::cycles::{self, Cycle};
use super::modes::{
    CutterSide, CuttingMode, Distance, FeedMode, Length, Mirror, Motion, Plane, Polar, ReturnTo, Rotation,
    Scaling, SpindleMode, StrokeCheck, Unit,
};
use crate::control::CodeSet;

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
    /// Group 09: drilling cycle; `None` is G80.
    Cycle(Option<&'static Cycle>),
    /// Group 10: return level of cycles.
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
    /// Group 22: mirror image.
    Mirror(Mirror),
    /// Group 00: effect in its own block only.
    OneShot(OneShot),
    /// Feed and lookahead control without an effect on the path.
    NoEffect,
    /// G08: [`Effect::NoEffect`] with a P.
    LookAhead,
    /// G187 of a Haas, with P and E.
    Smoothness,
    /// Call; lowering has separated it unless the code is computed.
    Call,
    /// A control may have the code; the simulator does not execute it.
    NotSimulated,
}

impl Effect {
    /// Returns the modal group of a code that stays in force; `None` for any other.
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

    /// Returns true for reference returns and changes of the coordinate system.
    ///
    /// A control refuses them while G51 is on (operator's manual, scaling).
    pub fn needs_plain_coordinates(self) -> bool {
        use OneShot::{DataInput, DataInputEnd, Dwell, Skip};
        match self {
            Self::Work(_) | Self::AdditionalWork | Self::NumberedWork(_) => true,
            Self::OneShot(one) => !matches!(one, Dwell | DataInput | DataInputEnd | Skip),
            _ => false,
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
    /// G31: skip.
    Skip,
    /// G52: local coordinate system.
    LocalSystem,
    /// G53: machine coordinates.
    MachineSystem,
    /// G92: set the coordinate system.
    SetSystem,
    /// G39: corner arc in cutter compensation.
    CornerArc,
    /// G92.1: preset the coordinate system.
    PresetSystem,
    /// G60: positioning from one side.
    OneSide,
    /// G12 and G13 of a Haas.
    CirclePocket(Motion),
    /// G70 and G71 of a Haas.
    BoltHoles(HolePattern),
}

/// Arrangement of a pattern's holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HolePattern {
    /// Evenly spaced on the full circle.
    Circle,
    /// Spaced by a specified angle.
    Arc,
}

/// Row of the table.
#[derive(Clone, Copy, Debug)]
pub struct GCodeRow {
    /// G code × 10: 541 is G54.1.
    pub code: u32,
    /// Effect.
    pub effect: Effect,
    /// Description in a few words.
    pub help: &'static str,
    /// Controls with this meaning of the code.
    pub code_sets: &'static [CodeSet],
}

/// Returns a row that applies to all controls.
const fn row(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { code, effect, help, code_sets: CodeSet::ALL_CONTROLS }
}

/// Returns a row that does not apply to a Haas.
const fn fanuc(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { code, effect, help, code_sets: CodeSet::FANUC }
}

/// Returns a row for controls with five simultaneous axes; the 0i-F has four.
const fn five_axis(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { code, effect, help, code_sets: CodeSet::FIVE_AXES }
}

/// Returns a row for a Haas alone.
const fn haas(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { code, effect, help, code_sets: CodeSet::HAAS }
}

const fn cycle(index: usize) -> GCodeRow {
    let cycle = &cycles::CYCLES[index];
    row(cycle.code, Effect::Cycle(Some(cycle)), cycle.help)
}

const fn fanuc_cycle(index: usize) -> GCodeRow {
    GCodeRow { code_sets: CodeSet::FANUC, ..cycle(index) }
}

/// All codes in ascending order; a code with several meanings has one row per meaning.
#[rustfmt::skip]
pub const CODES: &[GCodeRow] = &[
    row(0, Effect::Motion(Motion::Rapid), "rapid"),
    row(10, Effect::Motion(Motion::Linear), "straight feed"),
    row(20, Effect::Motion(Motion::Clockwise), "arc, clockwise"),
    fanuc(24, Effect::NotSimulated, "arc in space, clockwise"),
    row(30, Effect::Motion(Motion::Counterclockwise), "arc, counterclockwise"),
    fanuc(34, Effect::NotSimulated, "arc in space, counterclockwise"),
    row(40, Effect::OneShot(OneShot::Dwell), "dwell"),
    fanuc(50, Effect::NoEffect, "look-ahead contour control"),
    fanuc(51, Effect::NoEffect, "look-ahead contour control"),
    fanuc(54, Effect::NotSimulated, "high-precision oscillation"),
    fanuc(71, Effect::NotSimulated, "cylindrical interpolation"),
    fanuc(80, Effect::LookAhead, "look-ahead control"),
    row(90, Effect::NoEffect, "exact stop in this block"),
    row(100, Effect::OneShot(OneShot::DataInput), "offsets from the program"),
    fanuc(106, Effect::NotSimulated, "tool retract"),
    fanuc(110, Effect::OneShot(OneShot::DataInputEnd), "end of data input"),
    haas(120, Effect::OneShot(OneShot::CirclePocket(Motion::Clockwise)), "circular pocket, clockwise"),
    fanuc(121, Effect::NotSimulated, "polar interpolation"),
    haas(130, Effect::OneShot(OneShot::CirclePocket(Motion::Counterclockwise)), "circular pocket, counterclockwise"),
    fanuc(131, Effect::NoEffect, "polar interpolation off"),
    fanuc(150, Effect::Polar(Polar::Off), "polar coordinates off"),
    fanuc(160, Effect::Polar(Polar::On), "polar coordinates"),
    row(170, Effect::Plane(Plane::Xy), "plane X Y"),
    row(180, Effect::Plane(Plane::Zx), "plane Z X"),
    row(190, Effect::Plane(Plane::Yz), "plane Y Z"),
    row(200, Effect::Unit(Unit::Inch), "inches"),
    row(210, Effect::Unit(Unit::Metric), "millimetres"),
    fanuc(220, Effect::StrokeCheck(StrokeCheck::On), "stored stroke check"),
    fanuc(230, Effect::StrokeCheck(StrokeCheck::Off), "stored stroke check off"),
    fanuc(250, Effect::NoEffect, "spindle fluctuation check off"),
    fanuc(260, Effect::NoEffect, "spindle fluctuation check"),
    fanuc(270, Effect::OneShot(OneShot::CheckReference), "check the reference position"),
    row(280, Effect::OneShot(OneShot::Reference), "go to the reference position"),
    row(290, Effect::OneShot(OneShot::FromReference), "come from the reference position"),
    fanuc(300, Effect::OneShot(OneShot::SecondReference), "go to the second reference position"),
    fanuc(301, Effect::NotSimulated, "floating reference position"),
    row(310, Effect::OneShot(OneShot::Skip), "feed until the skip signal"),
    fanuc(318, Effect::NotSimulated, "skip by the electronic gear box"),
    fanuc(330, Effect::Motion(Motion::Thread), "threading"),
    haas(350, Effect::NotSimulated, "tool diameter measurement"),
    haas(360, Effect::NotSimulated, "work offset measurement"),
    row(370, Effect::NotSimulated, "tool length measurement"),
    fanuc(390, Effect::OneShot(OneShot::CornerArc), "arc round a corner, in cutter compensation"),
    row(400, Effect::Cutter(CutterSide::Off), "cutter compensation off"),
    fanuc(401, Effect::NoEffect, "normal direction control off"),
    row(410, Effect::Cutter(CutterSide::Left), "cutter compensation left"),
    fanuc(411, Effect::NotSimulated, "normal direction control"),
    fanuc(412, Effect::NotSimulated, "cutter compensation in space"),
    fanuc(413, Effect::NotSimulated, "cutter compensation in space"),
    fanuc(414, Effect::NotSimulated, "cutter compensation in space"),
    fanuc(415, Effect::NotSimulated, "cutter compensation in space"),
    fanuc(416, Effect::NotSimulated, "cutter compensation in space"),
    row(420, Effect::Cutter(CutterSide::Right), "cutter compensation right"),
    fanuc(421, Effect::NotSimulated, "normal direction control"),
    fanuc(422, Effect::NotSimulated, "cutter compensation in space"),
    fanuc(424, Effect::NotSimulated, "cutter compensation in space"),
    fanuc(425, Effect::NotSimulated, "cutter compensation in space"),
    fanuc(426, Effect::NotSimulated, "cutter compensation in space"),
    row(430, Effect::Length(Length::Plus), "tool length compensation"),
    fanuc(431, Effect::NotSimulated, "tool length compensation along the tool"),
    five_axis(434, Effect::NotSimulated, "tool centre point control"),
    five_axis(435, Effect::NotSimulated, "tool centre point control with tool vectors"),
    fanuc(437, Effect::NotSimulated, "tool offset"),
    row(440, Effect::Length(Length::Minus), "tool length compensation, negative"),
    fanuc(450, Effect::NotSimulated, "tool offset"),
    fanuc(460, Effect::NotSimulated, "tool offset"),
    fanuc(470, Effect::NotSimulated, "tool offset"),
    haas(470, Effect::NotSimulated, "engraving"),
    fanuc(480, Effect::NotSimulated, "tool offset"),
    row(490, Effect::Length(Length::Off), "tool length compensation off"),
    fanuc(491, Effect::NotSimulated, "tool length compensation along the tool off"),
    row(500, Effect::Scaling(Scaling::Off), "scaling off"),
    fanuc(501, Effect::Mirror(Mirror::Off), "mirror image off"),
    fanuc(502, Effect::NoEffect, "polygon turning off"),
    fanuc(510, Effect::Scaling(Scaling::On), "scaling"),
    haas(510, Effect::NotSimulated, "scaling by a factor with a point"),
    fanuc(511, Effect::Mirror(Mirror::On), "mirror image"),
    fanuc(512, Effect::NotSimulated, "polygon turning"),
    row(520, Effect::OneShot(OneShot::LocalSystem), "local coordinate system"),
    row(530, Effect::OneShot(OneShot::MachineSystem), "machine coordinates in this block"),
    fanuc(531, Effect::NotSimulated, "turn the tool to the tilted plane"),
    row(540, Effect::Work(1), "work coordinate system 1"),
    fanuc(541, Effect::AdditionalWork, "additional work coordinate system"),
    fanuc(542, Effect::NotSimulated, "dynamic fixture offset"),
    fanuc(544, Effect::NotSimulated, "workpiece setting error"),
    row(550, Effect::Work(2), "work coordinate system 2"),
    row(560, Effect::Work(3), "work coordinate system 3"),
    row(570, Effect::Work(4), "work coordinate system 4"),
    row(580, Effect::Work(5), "work coordinate system 5"),
    row(590, Effect::Work(6), "work coordinate system 6"),
    row(600, Effect::OneShot(OneShot::OneSide), "positioning from one side"),
    row(610, Effect::Cutting(CuttingMode::ExactStop), "exact stop"),
    fanuc(620, Effect::Cutting(CuttingMode::CornerOverride), "corner override"),
    fanuc(630, Effect::Cutting(CuttingMode::Tapping), "tapping mode"),
    row(640, Effect::Cutting(CuttingMode::Cutting), "cutting mode"),
    row(650, Effect::Call, "macro call"),
    fanuc(660, Effect::Call, "modal macro call"),
    fanuc(661, Effect::Call, "macro call by every block"),
    fanuc(670, Effect::Call, "modal macro call off"),
    row(680, Effect::Rotation(Rotation::On), "rotation"),
    fanuc(681, Effect::NotSimulated, "rotation in space"),
    fanuc(682, Effect::Rotation(Rotation::Tilted), "tilted plane"),
    fanuc(683, Effect::NotSimulated, "tilted plane by the tool"),
    fanuc(684, Effect::NotSimulated, "tilted plane, incremental"),
    row(690, Effect::Rotation(Rotation::Off), "rotation off"),
    haas(700, Effect::OneShot(OneShot::BoltHoles(HolePattern::Circle)), "holes on a circle"),
    haas(710, Effect::OneShot(OneShot::BoltHoles(HolePattern::Arc)), "holes on an arc"),
    haas(720, Effect::NotSimulated, "holes on a line"),
    fanuc(721, Effect::NotSimulated, "figure copy"),
    fanuc(722, Effect::NotSimulated, "figure copy"),
    cycle(0),
    cycle(1),
    cycle(2),
    haas(770, Effect::NotSimulated, "bore from the back"),
    row(800, Effect::Cycle(None), "drilling cycle off"),
    fanuc(804, Effect::NoEffect, "electronic gear box off"),
    cycle(3),
    fanuc(811, Effect::NotSimulated, "chopping"),
    fanuc(814, Effect::NotSimulated, "electronic gear box"),
    cycle(4),
    cycle(5),
    cycle(6),
    fanuc(842, Effect::NotSimulated, "rigid tapping"),
    fanuc(843, Effect::NotSimulated, "rigid tapping, left hand"),
    cycle(7),
    cycle(8),
    fanuc_cycle(9),
    haas(870, Effect::NotSimulated, "bore, retract by hand"),
    fanuc_cycle(10),
    haas(880, Effect::NotSimulated, "bore, dwell, retract by hand"),
    cycle(11),
    row(900, Effect::Distance(Distance::Absolute), "absolute"),
    row(910, Effect::Distance(Distance::Incremental), "incremental"),
    row(920, Effect::OneShot(OneShot::SetSystem), "set the coordinate system"),
    fanuc(921, Effect::OneShot(OneShot::PresetSystem), "preset the coordinate system"),
    row(930, Effect::FeedMode(FeedMode::InverseTime), "inverse time feed"),
    row(940, Effect::FeedMode(FeedMode::PerMinute), "feed per minute"),
    row(950, Effect::FeedMode(FeedMode::PerRevolution), "feed per revolution"),
    fanuc(960, Effect::NotSimulated, "constant surface speed"),
    row(970, Effect::SpindleMode(SpindleMode::Speed), "spindle speed"),
    row(980, Effect::ReturnTo(ReturnTo::Initial), "cycles return to the initial level"),
    row(990, Effect::ReturnTo(ReturnTo::R), "cycles return to R"),
    haas(1000, Effect::NotSimulated, "mirror image off"),
    haas(1010, Effect::NotSimulated, "mirror image"),
    haas(1030, Effect::NoEffect, "limit of blocks read ahead"),
    haas(1070, Effect::NotSimulated, "cylindrical mapping"),
    haas(1100, Effect::NumberedWork(1), "additional work coordinate system 1"),
    haas(1110, Effect::NumberedWork(2), "additional work coordinate system 2"),
    haas(1120, Effect::NumberedWork(3), "additional work coordinate system 3"),
    haas(1130, Effect::NumberedWork(4), "additional work coordinate system 4"),
    haas(1140, Effect::NumberedWork(5), "additional work coordinate system 5"),
    haas(1150, Effect::NumberedWork(6), "additional work coordinate system 6"),
    haas(1160, Effect::NumberedWork(7), "additional work coordinate system 7"),
    haas(1170, Effect::NumberedWork(8), "additional work coordinate system 8"),
    haas(1180, Effect::NumberedWork(9), "additional work coordinate system 9"),
    haas(1190, Effect::NumberedWork(10), "additional work coordinate system 10"),
    haas(1200, Effect::NumberedWork(11), "additional work coordinate system 11"),
    haas(1210, Effect::NumberedWork(12), "additional work coordinate system 12"),
    haas(1220, Effect::NumberedWork(13), "additional work coordinate system 13"),
    haas(1230, Effect::NumberedWork(14), "additional work coordinate system 14"),
    haas(1240, Effect::NumberedWork(15), "additional work coordinate system 15"),
    haas(1250, Effect::NumberedWork(16), "additional work coordinate system 16"),
    haas(1260, Effect::NumberedWork(17), "additional work coordinate system 17"),
    haas(1270, Effect::NumberedWork(18), "additional work coordinate system 18"),
    haas(1280, Effect::NumberedWork(19), "additional work coordinate system 19"),
    haas(1290, Effect::NumberedWork(20), "additional work coordinate system 20"),
    haas(1360, Effect::NotSimulated, "work offset centre measurement"),
    haas(1410, Effect::NotSimulated, "cutter compensation in space"),
    haas(1430, Effect::NotSimulated, "tool length compensation on five axes"),
    fanuc(1500, Effect::NoEffect, "normal direction control off"),
    haas(1500, Effect::NotSimulated, "pocket of any shape"),
    fanuc(1510, Effect::NotSimulated, "normal direction control"),
    fanuc(1520, Effect::NotSimulated, "normal direction control"),
    haas(1540, Effect::AdditionalWork, "additional work coordinate system"),
    haas(1560, Effect::NotSimulated, "broaching"),
    fanuc(1600, Effect::NoEffect, "in-feed control off"),
    fanuc(1610, Effect::NotSimulated, "in-feed control"),
    haas(1670, Effect::NotSimulated, "change of a setting"),
    haas(1740, Effect::NotSimulated, "rigid tapping, left hand, any direction"),
    haas(1840, Effect::NotSimulated, "rigid tapping, any direction"),
    haas(1870, Effect::Smoothness, "smoothness of corners"),
    haas(2340, Effect::NotSimulated, "tool centre point control"),
    haas(2530, Effect::NotSimulated, "turn the tool to the feature coordinate system"),
    haas(2540, Effect::NotSimulated, "dynamic work offset"),
    haas(2550, Effect::NotSimulated, "dynamic work offset off"),
    haas(2660, Effect::NotSimulated, "rapid of all axes in a line"),
    haas(2680, Effect::NotSimulated, "feature coordinate system"),
    haas(2690, Effect::NotSimulated, "feature coordinate system off"),
];

/// Rows of a code × 10 by code set, as indices; 255 for a code that the controls lack.
#[derive(Clone, Copy, Debug)]
pub struct RowLookup([u8; CodeSet::ALL_CONTROLS.len()]);

impl RowLookup {
    const NONE: u8 = u8::MAX;
    const NOT_FOUND: Self = Self([Self::NONE; CodeSet::ALL_CONTROLS.len()]);

    /// Returns the row of the code on a control.
    #[inline]
    pub fn row_for(&self, set: CodeSet) -> Option<&'static GCodeRow> {
        CODES.get(usize::from(self.0[set as usize]))
    }
}

/// Returns the rows of a code × 10.
#[inline]
pub fn find(code: u32) -> RowLookup {
    LOOKUP.get(code as usize).copied().unwrap_or(RowLookup::NOT_FOUND)
}

/// Rows of every code × 10 up to the last one.
const LOOKUP: [RowLookup; LAST_CODE + 1] = {
    assert!(CODES.len() <= RowLookup::NONE as usize);
    let mut all = [RowLookup::NOT_FOUND; LAST_CODE + 1];
    let mut place = 0;
    while place < CODES.len() {
        let row = &CODES[place];
        let mut set = 0;
        while set < row.code_sets.len() {
            all[row.code as usize].0[row.code_sets[set] as usize] = place as u8;
            set += 1;
        }
        place += 1;
    }
    all
};

const LAST_CODE: usize = CODES[CODES.len() - 1].code as usize;

/// Returns the number of a code × 10 as written, `54.1`.
pub fn spelled(code: u32) -> String {
    if code.is_multiple_of(10) { format!("{}", code / 10) } else { format!("{}.{}", code / 10, code % 10) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_ascend_and_a_control_has_one_for_each_code() {
        for pair in CODES.windows(2) {
            let once = pair[0].code_sets.iter().all(|set| !pair[1].code_sets.contains(set));
            let ascends = pair[0].code < pair[1].code || pair[0].code == pair[1].code && once;
            assert!(ascends, "G{}", spelled(pair[1].code));
        }
        assert!(find(143).row_for(CodeSet::Fanuc31i).is_none());
    }

    #[test]
    fn a_code_is_what_its_control_makes_of_it() {
        let effect = |code, set| find(code).row_for(set).map(|row| row.effect);
        assert_eq!(effect(1540, CodeSet::Haas), Some(Effect::AdditionalWork));
        assert_eq!(effect(1540, CodeSet::Fanuc31i), None);
        assert_eq!(effect(510, CodeSet::Fanuc31i), Some(Effect::Scaling(Scaling::On)));
        assert_eq!(effect(510, CodeSet::Haas), Some(Effect::NotSimulated));
        assert_eq!(effect(434, CodeSet::Fanuc0iF), None);
    }
}
