//! The table of G codes: one row per code. A code without a row is an alarm, never skipped.
use super::cycles::{self, Cycle};
use super::modes::{
    CutterSide, CuttingMode, Distance, FeedMode, Length, Mirror, Motion, Plane, Polar, ReturnTo, Rotation,
    Scaling, SpindleMode, StrokeCheck, Unit,
};

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
    /// G54.1 with its P.
    AdditionalWork,
    Cutting(CuttingMode),
    Rotation(Rotation),
    Polar(Polar),
    Mirror(Mirror),
    OneShot(OneShot),
    /// Feed and look-ahead control that moves nothing elsewhere.
    NoEffect,
    /// G08: as [`Effect::NoEffect`], with a P.
    LookAhead,
    /// Calls, which lowering has taken out of the words where the code is a literal.
    Call,
    /// A control may have it; this one does not execute it.
    NotSimulated,
}

impl Effect {
    /// Reference returns and what changes the coordinate system: not while G51 is on (operator's manual, scaling).
    pub fn needs_plain_coordinates(self) -> bool {
        use OneShot::{DataInput, DataInputEnd, Dwell, Skip};
        match self {
            Self::Work(_) | Self::AdditionalWork => true,
            Self::OneShot(one) => !matches!(one, Dwell | DataInput | DataInputEnd | Skip),
            _ => false,
        }
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
    PresetSystem,
    OneSide,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// G code × 10: 541 is G54.1.
    pub code: u32,
    pub effect: Effect,
    pub help: &'static str,
}

const fn row(code: u32, effect: Effect, help: &'static str) -> Row {
    Row { code, effect, help }
}

const fn cycle(index: usize) -> Row {
    let cycle = &cycles::CYCLES[index];
    row(cycle.code, Effect::Cycle(Some(cycle)), cycle.help)
}

/// All codes in ascending order.
#[rustfmt::skip]
pub const CODES: &[Row] = &[
    row(0, Effect::Motion(Motion::Rapid), "rapid"),
    row(10, Effect::Motion(Motion::Linear), "straight feed"),
    row(20, Effect::Motion(Motion::Clockwise), "arc, clockwise"),
    row(24, Effect::NotSimulated, "arc in space, clockwise"),
    row(30, Effect::Motion(Motion::Counterclockwise), "arc, counterclockwise"),
    row(34, Effect::NotSimulated, "arc in space, counterclockwise"),
    row(40, Effect::OneShot(OneShot::Dwell), "dwell"),
    row(50, Effect::NoEffect, "look-ahead contour control"),
    row(51, Effect::NoEffect, "look-ahead contour control"),
    row(54, Effect::NotSimulated, "high-precision oscillation"),
    row(71, Effect::NotSimulated, "cylindrical interpolation"),
    row(80, Effect::LookAhead, "look-ahead control"),
    row(90, Effect::NoEffect, "exact stop in this block"),
    row(100, Effect::OneShot(OneShot::DataInput), "offsets from the program"),
    row(106, Effect::NotSimulated, "tool retract"),
    row(110, Effect::OneShot(OneShot::DataInputEnd), "end of data input"),
    row(121, Effect::NotSimulated, "polar interpolation"),
    row(131, Effect::NoEffect, "polar interpolation off"),
    row(150, Effect::Polar(Polar::Off), "polar coordinates off"),
    row(160, Effect::Polar(Polar::On), "polar coordinates"),
    row(170, Effect::Plane(Plane::Xy), "plane X Y"),
    row(180, Effect::Plane(Plane::Zx), "plane Z X"),
    row(190, Effect::Plane(Plane::Yz), "plane Y Z"),
    row(200, Effect::Unit(Unit::Inch), "inches"),
    row(210, Effect::Unit(Unit::Metric), "millimetres"),
    row(220, Effect::StrokeCheck(StrokeCheck::On), "stored stroke check"),
    row(230, Effect::StrokeCheck(StrokeCheck::Off), "stored stroke check off"),
    row(250, Effect::NoEffect, "spindle fluctuation check off"),
    row(260, Effect::NoEffect, "spindle fluctuation check"),
    row(270, Effect::OneShot(OneShot::CheckReference), "check the reference position"),
    row(280, Effect::OneShot(OneShot::Reference), "go to the reference position"),
    row(290, Effect::OneShot(OneShot::FromReference), "come from the reference position"),
    row(300, Effect::OneShot(OneShot::SecondReference), "go to the second reference position"),
    row(301, Effect::NotSimulated, "floating reference position"),
    row(310, Effect::OneShot(OneShot::Skip), "feed until the skip signal"),
    row(318, Effect::NotSimulated, "skip by the electronic gear box"),
    row(330, Effect::Motion(Motion::Thread), "threading"),
    row(370, Effect::NotSimulated, "tool length measurement"),
    row(390, Effect::NotSimulated, "corner arc"),
    row(400, Effect::Cutter(CutterSide::Off), "cutter compensation off"),
    row(401, Effect::NoEffect, "normal direction control off"),
    row(410, Effect::Cutter(CutterSide::Left), "cutter compensation left"),
    row(411, Effect::NotSimulated, "normal direction control"),
    row(412, Effect::NotSimulated, "cutter compensation in space"),
    row(413, Effect::NotSimulated, "cutter compensation in space"),
    row(414, Effect::NotSimulated, "cutter compensation in space"),
    row(415, Effect::NotSimulated, "cutter compensation in space"),
    row(416, Effect::NotSimulated, "cutter compensation in space"),
    row(420, Effect::Cutter(CutterSide::Right), "cutter compensation right"),
    row(421, Effect::NotSimulated, "normal direction control"),
    row(422, Effect::NotSimulated, "cutter compensation in space"),
    row(424, Effect::NotSimulated, "cutter compensation in space"),
    row(425, Effect::NotSimulated, "cutter compensation in space"),
    row(426, Effect::NotSimulated, "cutter compensation in space"),
    row(430, Effect::Length(Length::Plus), "tool length compensation"),
    row(431, Effect::NotSimulated, "tool length compensation along the tool"),
    row(434, Effect::NotSimulated, "tool centre point control"),
    row(435, Effect::NotSimulated, "tool centre point control with tool vectors"),
    row(437, Effect::NotSimulated, "tool offset"),
    row(440, Effect::Length(Length::Minus), "tool length compensation, negative"),
    row(450, Effect::NotSimulated, "tool offset"),
    row(460, Effect::NotSimulated, "tool offset"),
    row(470, Effect::NotSimulated, "tool offset"),
    row(480, Effect::NotSimulated, "tool offset"),
    row(490, Effect::Length(Length::Off), "tool length compensation off"),
    row(491, Effect::NotSimulated, "tool length compensation along the tool off"),
    row(500, Effect::Scaling(Scaling::Off), "scaling off"),
    row(501, Effect::Mirror(Mirror::Off), "mirror image off"),
    row(502, Effect::NoEffect, "polygon turning off"),
    row(510, Effect::Scaling(Scaling::On), "scaling"),
    row(511, Effect::Mirror(Mirror::On), "mirror image"),
    row(512, Effect::NotSimulated, "polygon turning"),
    row(520, Effect::OneShot(OneShot::LocalSystem), "local coordinate system"),
    row(530, Effect::OneShot(OneShot::MachineSystem), "machine coordinates in this block"),
    row(531, Effect::NotSimulated, "turn the tool to the tilted plane"),
    row(540, Effect::Work(1), "work coordinate system 1"),
    row(541, Effect::AdditionalWork, "additional work coordinate system"),
    row(542, Effect::NotSimulated, "dynamic fixture offset"),
    row(544, Effect::NotSimulated, "workpiece setting error"),
    row(550, Effect::Work(2), "work coordinate system 2"),
    row(560, Effect::Work(3), "work coordinate system 3"),
    row(570, Effect::Work(4), "work coordinate system 4"),
    row(580, Effect::Work(5), "work coordinate system 5"),
    row(590, Effect::Work(6), "work coordinate system 6"),
    row(600, Effect::OneShot(OneShot::OneSide), "positioning from one side"),
    row(610, Effect::Cutting(CuttingMode::ExactStop), "exact stop"),
    row(620, Effect::Cutting(CuttingMode::CornerOverride), "corner override"),
    row(630, Effect::Cutting(CuttingMode::Tapping), "tapping mode"),
    row(640, Effect::Cutting(CuttingMode::Cutting), "cutting mode"),
    row(650, Effect::Call, "macro call"),
    row(660, Effect::Call, "modal macro call"),
    row(661, Effect::Call, "macro call by every block"),
    row(670, Effect::Call, "modal macro call off"),
    row(680, Effect::Rotation(Rotation::On), "rotation"),
    row(681, Effect::NotSimulated, "rotation in space"),
    row(682, Effect::Rotation(Rotation::Tilted), "tilted plane"),
    row(683, Effect::NotSimulated, "tilted plane by the tool"),
    row(684, Effect::NotSimulated, "tilted plane, incremental"),
    row(690, Effect::Rotation(Rotation::Off), "rotation off"),
    row(721, Effect::NotSimulated, "figure copy"),
    row(722, Effect::NotSimulated, "figure copy"),
    cycle(0),
    cycle(1),
    cycle(2),
    row(800, Effect::Cycle(None), "drilling cycle off"),
    row(804, Effect::NoEffect, "electronic gear box off"),
    cycle(3),
    row(811, Effect::NotSimulated, "chopping"),
    row(814, Effect::NotSimulated, "electronic gear box"),
    cycle(4),
    cycle(5),
    cycle(6),
    row(842, Effect::NotSimulated, "rigid tapping"),
    row(843, Effect::NotSimulated, "rigid tapping, left hand"),
    cycle(7),
    cycle(8),
    cycle(9),
    cycle(10),
    cycle(11),
    row(900, Effect::Distance(Distance::Absolute), "absolute"),
    row(910, Effect::Distance(Distance::Incremental), "incremental"),
    row(920, Effect::OneShot(OneShot::SetSystem), "set the coordinate system"),
    row(921, Effect::OneShot(OneShot::PresetSystem), "preset the coordinate system"),
    row(930, Effect::FeedMode(FeedMode::InverseTime), "inverse time feed"),
    row(940, Effect::FeedMode(FeedMode::PerMinute), "feed per minute"),
    row(950, Effect::FeedMode(FeedMode::PerRevolution), "feed per revolution"),
    row(960, Effect::NotSimulated, "constant surface speed"),
    row(970, Effect::SpindleMode(SpindleMode::Speed), "spindle speed"),
    row(980, Effect::ReturnTo(ReturnTo::Initial), "cycles return to the initial level"),
    row(990, Effect::ReturnTo(ReturnTo::R), "cycles return to R"),
    row(1500, Effect::NoEffect, "normal direction control off"),
    row(1510, Effect::NotSimulated, "normal direction control"),
    row(1520, Effect::NotSimulated, "normal direction control"),
    row(1600, Effect::NoEffect, "in-feed control off"),
    row(1610, Effect::NotSimulated, "in-feed control"),
];

/// The row of a code × 10.
pub fn find(code: u32) -> Option<&'static Row> {
    CODES.binary_search_by_key(&code, |row| row.code).ok().map(|index| &CODES[index])
}

/// A code × 10 as it is written: `54.1`.
pub fn spelled(code: u32) -> String {
    if code.is_multiple_of(10) { format!("{}", code / 10) } else { format!("{}.{}", code / 10, code % 10) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_ascend_so_that_the_search_finds_them() {
        for pair in CODES.windows(2) {
            assert!(pair[0].code < pair[1].code, "G{}", spelled(pair[1].code));
        }
        assert!(find(143).is_none() && find(1430).is_none());
    }
}
