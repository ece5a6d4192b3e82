//! Table of G codes, one row per code and meaning.
use super::code_facts as facts;
use super::cycles::{self, Cycle};
use super::g_code_row::{Effect, GCodeRow, HolePattern, OneShot};
use super::modes::{
    CutterSide, CuttingMode, Distance, FeedMode, Length, Mirror, Motion, Plane, Polar, ReturnTo, Rotation,
    Scaling, SpindleMode, StrokeCheck, Unit,
};
use crate::control::Dialect;

impl GCodeRow {
    /// Returns the row with the given facts in place of those of a modal code.
    const fn with(self, facts: facts::CodeFacts) -> Self {
        Self { facts, ..self }
    }
}

/// Returns a row that applies to all controls.
const fn row(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { code, effect, help, facts: facts::MODAL, dialects: Dialect::ALL_CONTROLS }
}

/// Returns a row that does not apply to a Haas.
const fn fanuc(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { dialects: Dialect::FANUC, ..row(code, effect, help) }
}

/// Returns a row for controls with five simultaneous axes; the 0i-F has four.
const fn five_axis(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { dialects: Dialect::FIVE_AXES, ..row(code, effect, help) }
}

/// Returns a row for a Haas alone.
const fn haas(code: u32, effect: Effect, help: &'static str) -> GCodeRow {
    GCodeRow { dialects: Dialect::HAAS, ..row(code, effect, help) }
}

const fn cycle(cycle: &'static Cycle) -> GCodeRow {
    row(cycle.code, Effect::Cycle(Some(cycle)), cycle.help).with(facts::CYCLE)
}

const fn fanuc_cycle(of: &'static Cycle) -> GCodeRow {
    GCodeRow { dialects: Dialect::FANUC, ..cycle(of) }
}

/// All codes in ascending order; a code with several meanings has one row per meaning.
#[rustfmt::skip]
pub(super) const CODES: &[GCodeRow] = &[
    row(0, Effect::Motion(Motion::Rapid), "rapid"),
    row(10, Effect::Motion(Motion::Linear), "straight feed"),
    row(20, Effect::Motion(Motion::Clockwise), "arc, clockwise"),
    fanuc(24, Effect::NotSimulated, "arc in space, clockwise"),
    row(30, Effect::Motion(Motion::Counterclockwise), "arc, counterclockwise"),
    fanuc(34, Effect::NotSimulated, "arc in space, counterclockwise"),
    row(40, Effect::OneShot(OneShot::Dwell), "dwell").with(facts::DWELL),
    fanuc(50, Effect::NoEffect, "look-ahead contour control").with(facts::CONTOUR_CONTROL),
    fanuc(51, Effect::NoEffect, "look-ahead contour control").with(facts::SMOOTH_CONTOUR_CONTROL),
    fanuc(54, Effect::NotSimulated, "high-precision oscillation"),
    fanuc(71, Effect::NotSimulated, "cylindrical interpolation"),
    fanuc(80, Effect::LookAhead, "look-ahead control").with(facts::LOOK_AHEAD),
    row(90, Effect::NoEffect, "exact stop in this block").with(facts::EXACT_STOP),
    row(100, Effect::OneShot(OneShot::DataInput), "offsets from the program").with(facts::DATA_INPUT),
    fanuc(106, Effect::NotSimulated, "tool retract"),
    fanuc(110, Effect::OneShot(OneShot::DataInputEnd), "end of data input").with(facts::DATA_INPUT_END),
    haas(120, Effect::OneShot(OneShot::CirclePocket(Motion::Clockwise)), "circular pocket, clockwise").with(facts::PATTERN),
    fanuc(121, Effect::NotSimulated, "polar interpolation"),
    haas(130, Effect::OneShot(OneShot::CirclePocket(Motion::Counterclockwise)), "circular pocket, counterclockwise").with(facts::PATTERN),
    fanuc(131, Effect::NoEffect, "polar interpolation off").with(facts::WITHOUT_EFFECT),
    fanuc(150, Effect::Polar(Polar::Off), "polar coordinates off"),
    fanuc(160, Effect::Polar(Polar::On), "polar coordinates"),
    row(170, Effect::Plane(Plane::Xy), "plane X Y"),
    row(180, Effect::Plane(Plane::Zx), "plane Z X"),
    row(190, Effect::Plane(Plane::Yz), "plane Y Z"),
    row(200, Effect::Unit(Unit::Inch), "inches"),
    row(210, Effect::Unit(Unit::Metric), "millimetres"),
    fanuc(220, Effect::StrokeCheck(StrokeCheck::On), "stored stroke check"),
    fanuc(230, Effect::StrokeCheck(StrokeCheck::Off), "stored stroke check off"),
    fanuc(250, Effect::NoEffect, "spindle fluctuation check off").with(facts::WITHOUT_EFFECT),
    fanuc(260, Effect::NoEffect, "spindle fluctuation check").with(facts::WITHOUT_EFFECT),
    fanuc(270, Effect::OneShot(OneShot::CheckReference), "check the reference position").with(facts::CHECK_REFERENCE),
    row(280, Effect::OneShot(OneShot::Reference), "go to the reference position").with(facts::REFERENCE),
    row(290, Effect::OneShot(OneShot::FromReference), "come from the reference position").with(facts::FROM_REFERENCE),
    fanuc(300, Effect::OneShot(OneShot::SecondReference), "go to the second reference position").with(facts::SECOND_REFERENCE),
    fanuc(301, Effect::NotSimulated, "floating reference position"),
    row(310, Effect::OneShot(OneShot::Skip), "feed until the skip signal").with(facts::SKIP),
    fanuc(318, Effect::NotSimulated, "skip by the electronic gear box"),
    fanuc(330, Effect::Motion(Motion::Thread), "threading"),
    haas(350, Effect::NotSimulated, "tool diameter measurement"),
    haas(360, Effect::NotSimulated, "work offset measurement"),
    row(370, Effect::NotSimulated, "tool length measurement"),
    fanuc(390, Effect::OneShot(OneShot::CornerArc), "arc round a corner, in cutter compensation").with(facts::CORNER_ARC),
    row(400, Effect::Cutter(CutterSide::Off), "cutter compensation off"),
    fanuc(401, Effect::NoEffect, "normal direction control off").with(facts::WITHOUT_EFFECT),
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
    fanuc(450, Effect::NotSimulated, "tool offset").with(facts::TOOL_OFFSET),
    fanuc(460, Effect::NotSimulated, "tool offset").with(facts::TOOL_OFFSET),
    fanuc(470, Effect::NotSimulated, "tool offset").with(facts::TOOL_OFFSET),
    haas(470, Effect::NotSimulated, "engraving").with(facts::TOOL_OFFSET),
    fanuc(480, Effect::NotSimulated, "tool offset").with(facts::TOOL_OFFSET),
    row(490, Effect::Length(Length::Off), "tool length compensation off"),
    fanuc(491, Effect::NotSimulated, "tool length compensation along the tool off"),
    row(500, Effect::Scaling(Scaling::Off), "scaling off").with(facts::SCALING_OFF),
    fanuc(501, Effect::Mirror(Mirror::Off), "mirror image off"),
    fanuc(502, Effect::NoEffect, "polygon turning off").with(facts::WITHOUT_EFFECT),
    fanuc(510, Effect::Scaling(Scaling::On), "scaling").with(facts::SCALING),
    haas(510, Effect::NotSimulated, "scaling by a factor with a point"),
    fanuc(511, Effect::Mirror(Mirror::On), "mirror image").with(facts::MIRROR),
    fanuc(512, Effect::NotSimulated, "polygon turning"),
    row(520, Effect::OneShot(OneShot::LocalSystem), "local coordinate system").with(facts::SET_SYSTEM),
    row(530, Effect::OneShot(OneShot::MachineSystem), "machine coordinates in this block").with(facts::MACHINE_SYSTEM),
    fanuc(531, Effect::NotSimulated, "turn the tool to the tilted plane"),
    row(540, Effect::Work(1), "work coordinate system 1").with(facts::WORK),
    fanuc(541, Effect::AdditionalWork, "additional work coordinate system").with(facts::WORK),
    fanuc(542, Effect::NotSimulated, "dynamic fixture offset"),
    fanuc(544, Effect::NotSimulated, "workpiece setting error"),
    row(550, Effect::Work(2), "work coordinate system 2").with(facts::WORK),
    row(560, Effect::Work(3), "work coordinate system 3").with(facts::WORK),
    row(570, Effect::Work(4), "work coordinate system 4").with(facts::WORK),
    row(580, Effect::Work(5), "work coordinate system 5").with(facts::WORK),
    row(590, Effect::Work(6), "work coordinate system 6").with(facts::WORK),
    row(600, Effect::OneShot(OneShot::OneSide), "positioning from one side").with(facts::ONE_SIDE),
    row(610, Effect::Cutting(CuttingMode::ExactStop), "exact stop"),
    fanuc(620, Effect::Cutting(CuttingMode::CornerOverride), "corner override"),
    fanuc(630, Effect::Cutting(CuttingMode::Tapping), "tapping mode"),
    row(640, Effect::Cutting(CuttingMode::Cutting), "cutting mode"),
    row(650, Effect::Call, "macro call"),
    fanuc(660, Effect::Call, "modal macro call"),
    fanuc(661, Effect::Call, "macro call by every block"),
    fanuc(670, Effect::Call, "modal macro call off"),
    row(680, Effect::Rotation(Rotation::On), "rotation").with(facts::ROTATION),
    fanuc(681, Effect::NotSimulated, "rotation in space"),
    fanuc(682, Effect::Rotation(Rotation::Tilted), "tilted plane").with(facts::TILT),
    fanuc(683, Effect::NotSimulated, "tilted plane by the tool"),
    fanuc(684, Effect::NotSimulated, "tilted plane, incremental"),
    row(690, Effect::Rotation(Rotation::Off), "rotation off"),
    haas(700, Effect::OneShot(OneShot::BoltHoles(HolePattern::Circle)), "holes on a circle").with(facts::PATTERN),
    haas(710, Effect::OneShot(OneShot::BoltHoles(HolePattern::Arc)), "holes on an arc").with(facts::PATTERN),
    haas(720, Effect::NotSimulated, "holes on a line"),
    fanuc(721, Effect::NotSimulated, "figure copy"),
    fanuc(722, Effect::NotSimulated, "figure copy"),
    cycle(&cycles::PECK_DRILL_SHORT),
    cycle(&cycles::TAP_LEFT_HAND),
    cycle(&cycles::BORE_SHIFT),
    haas(770, Effect::NotSimulated, "bore from the back"),
    row(800, Effect::Cycle(None), "canned cycle off"),
    fanuc(804, Effect::NoEffect, "electronic gear box off").with(facts::WITHOUT_EFFECT),
    cycle(&cycles::DRILL),
    fanuc(811, Effect::NotSimulated, "chopping"),
    fanuc(814, Effect::NotSimulated, "electronic gear box"),
    cycle(&cycles::DRILL_DWELL),
    cycle(&cycles::PECK_DRILL),
    cycle(&cycles::TAP),
    fanuc(842, Effect::NotSimulated, "rigid tapping"),
    fanuc(843, Effect::NotSimulated, "rigid tapping, left hand"),
    cycle(&cycles::BORE_FEED_BACK),
    cycle(&cycles::BORE_SPINDLE_STOP),
    fanuc_cycle(&cycles::BACK_BORE),
    haas(870, Effect::NotSimulated, "bore, retract by hand"),
    fanuc_cycle(&cycles::BORE_BY_HAND),
    haas(880, Effect::NotSimulated, "bore, dwell, retract by hand"),
    cycle(&cycles::BORE_DWELL),
    row(900, Effect::Distance(Distance::Absolute), "absolute"),
    row(910, Effect::Distance(Distance::Incremental), "incremental"),
    row(920, Effect::OneShot(OneShot::SetSystem), "set the coordinate system").with(facts::SET_SYSTEM),
    fanuc(921, Effect::OneShot(OneShot::PresetSystem), "preset the coordinate system").with(facts::SET_SYSTEM),
    row(930, Effect::FeedMode(FeedMode::InverseTime), "inverse time feed"),
    row(940, Effect::FeedMode(FeedMode::PerMinute), "feed per minute"),
    row(950, Effect::FeedMode(FeedMode::PerRevolution), "feed per revolution"),
    fanuc(960, Effect::NotSimulated, "constant surface speed"),
    row(970, Effect::SpindleMode(SpindleMode::Speed), "spindle speed"),
    row(980, Effect::ReturnTo(ReturnTo::Initial), "cycles return to the initial level"),
    row(990, Effect::ReturnTo(ReturnTo::R), "cycles return to R"),
    haas(1000, Effect::NotSimulated, "mirror image off"),
    haas(1010, Effect::NotSimulated, "mirror image"),
    haas(1030, Effect::NoEffect, "limit of blocks read ahead").with(facts::WITHOUT_EFFECT),
    haas(1070, Effect::NotSimulated, "cylindrical mapping"),
    haas(1100, Effect::NumberedWork(1), "additional work coordinate system 1").with(facts::WORK),
    haas(1110, Effect::NumberedWork(2), "additional work coordinate system 2").with(facts::WORK),
    haas(1120, Effect::NumberedWork(3), "additional work coordinate system 3").with(facts::WORK),
    haas(1130, Effect::NumberedWork(4), "additional work coordinate system 4").with(facts::WORK),
    haas(1140, Effect::NumberedWork(5), "additional work coordinate system 5").with(facts::WORK),
    haas(1150, Effect::NumberedWork(6), "additional work coordinate system 6").with(facts::WORK),
    haas(1160, Effect::NumberedWork(7), "additional work coordinate system 7").with(facts::WORK),
    haas(1170, Effect::NumberedWork(8), "additional work coordinate system 8").with(facts::WORK),
    haas(1180, Effect::NumberedWork(9), "additional work coordinate system 9").with(facts::WORK),
    haas(1190, Effect::NumberedWork(10), "additional work coordinate system 10").with(facts::WORK),
    haas(1200, Effect::NumberedWork(11), "additional work coordinate system 11").with(facts::WORK),
    haas(1210, Effect::NumberedWork(12), "additional work coordinate system 12").with(facts::WORK),
    haas(1220, Effect::NumberedWork(13), "additional work coordinate system 13").with(facts::WORK),
    haas(1230, Effect::NumberedWork(14), "additional work coordinate system 14").with(facts::WORK),
    haas(1240, Effect::NumberedWork(15), "additional work coordinate system 15").with(facts::WORK),
    haas(1250, Effect::NumberedWork(16), "additional work coordinate system 16").with(facts::WORK),
    haas(1260, Effect::NumberedWork(17), "additional work coordinate system 17").with(facts::WORK),
    haas(1270, Effect::NumberedWork(18), "additional work coordinate system 18").with(facts::WORK),
    haas(1280, Effect::NumberedWork(19), "additional work coordinate system 19").with(facts::WORK),
    haas(1290, Effect::NumberedWork(20), "additional work coordinate system 20").with(facts::WORK),
    haas(1360, Effect::NotSimulated, "work offset centre measurement"),
    haas(1410, Effect::NotSimulated, "cutter compensation in space"),
    haas(1430, Effect::NotSimulated, "tool length compensation on five axes"),
    fanuc(1500, Effect::NoEffect, "normal direction control off").with(facts::WITHOUT_EFFECT),
    haas(1500, Effect::NotSimulated, "pocket of any shape"),
    fanuc(1510, Effect::NotSimulated, "normal direction control"),
    fanuc(1520, Effect::NotSimulated, "normal direction control"),
    haas(1540, Effect::AdditionalWork, "additional work coordinate system").with(facts::WORK),
    haas(1560, Effect::NotSimulated, "broaching"),
    fanuc(1600, Effect::NoEffect, "in-feed control off").with(facts::WITHOUT_EFFECT),
    fanuc(1610, Effect::NotSimulated, "in-feed control"),
    haas(1670, Effect::NotSimulated, "change of a setting"),
    haas(1740, Effect::NotSimulated, "rigid tapping, left hand, any direction"),
    haas(1840, Effect::NotSimulated, "rigid tapping, any direction"),
    haas(1870, Effect::Smoothness, "smoothness of corners").with(facts::SMOOTHNESS),
    haas(2340, Effect::NotSimulated, "tool centre point control"),
    haas(2530, Effect::NotSimulated, "turn the tool to the feature coordinate system"),
    haas(2540, Effect::NotSimulated, "dynamic work offset"),
    haas(2550, Effect::NotSimulated, "dynamic work offset off"),
    haas(2660, Effect::NotSimulated, "rapid of all axes in a line"),
    haas(2680, Effect::NotSimulated, "feature coordinate system"),
    haas(2690, Effect::NotSimulated, "feature coordinate system off"),
];
