//! Table of G codes, one row per code and meaning.
use super::code_facts as facts;
use super::cycles::{self, Cycle};
use super::g_code_row::{Effect, GCodeRow, HolePattern, MeasuringCode, OneShot};
use super::modes::{
    CutterSide, CuttingMode, Distance, DynamicOffset, FeedMode, Length, Mirror, Motion, Plane, Polar,
    PolarInterpolation, ReturnTo, Rotation, Scaling, SpindleMode, StrokeCheck, Unit,
};
use crate::control::Dialect;

impl GCodeRow {
    /// Returns the row with the given facts in place of those of a modal code.
    const fn with(self, facts: facts::CodeFacts) -> Self {
        Self { facts, ..self }
    }
}

/// Returns a row that applies to all controls.
const fn row(code: u32, effect: Effect, description: &'static str) -> GCodeRow {
    GCodeRow { code, effect, description, facts: facts::MODAL, dialects: Dialect::ALL_CONTROLS }
}

/// Returns a row that does not apply to a Haas.
const fn fanuc(code: u32, effect: Effect, description: &'static str) -> GCodeRow {
    GCodeRow { dialects: Dialect::FANUC, ..row(code, effect, description) }
}

/// Returns a row for controls with five simultaneous axes; the 0i-F has four.
const fn five_axis(code: u32, effect: Effect, description: &'static str) -> GCodeRow {
    GCodeRow { dialects: Dialect::FIVE_AXES, ..row(code, effect, description) }
}

/// Returns a row for a Haas alone.
const fn haas(code: u32, effect: Effect, description: &'static str) -> GCodeRow {
    GCodeRow { dialects: Dialect::HAAS, ..row(code, effect, description) }
}

const fn cycle(cycle: &'static Cycle) -> GCodeRow {
    row(cycle.code, Effect::Cycle(Some(cycle)), cycle.description).with(facts::CYCLE)
}

const fn fanuc_cycle(of: &'static Cycle) -> GCodeRow {
    GCodeRow { dialects: Dialect::FANUC, ..cycle(of) }
}

const fn haas_cycle(of: &'static Cycle) -> GCodeRow {
    GCodeRow { dialects: Dialect::HAAS, ..cycle(of) }
}

/// Rows of all codes that the user declares; their code is that of no table.
pub(super) const DECLARED: GCodeRow = declared(facts::DECLARED);
pub(super) const DECLARED_WAIT: GCodeRow = declared(facts::DECLARED_WAIT);

const fn declared(facts: facts::CodeFacts) -> GCodeRow {
    row(u32::MAX, Effect::Declared, "code of the machine builder, declared").with(facts)
}

/// All codes in ascending order; a code with several meanings has one row per meaning.
#[rustfmt::skip]
pub(super) const CODES: &[GCodeRow] = &[
    row(0, Effect::Motion(Motion::Rapid), "positioning (rapid traverse)"),
    row(10, Effect::Motion(Motion::Linear), "linear interpolation (cutting feed)"),
    row(20, Effect::Motion(Motion::Clockwise), "circular interpolation, clockwise"),
    fanuc(22, Effect::NotSimulated, "involute interpolation, clockwise"),
    fanuc(23, Effect::NotSimulated, "exponential interpolation, clockwise"),
    fanuc(24, Effect::NotSimulated, "three-dimensional circular interpolation, clockwise"),
    row(30, Effect::Motion(Motion::Counterclockwise), "circular interpolation, counterclockwise"),
    fanuc(32, Effect::NotSimulated, "involute interpolation, counterclockwise"),
    fanuc(33, Effect::NotSimulated, "exponential interpolation, counterclockwise"),
    fanuc(34, Effect::NotSimulated, "three-dimensional circular interpolation, counterclockwise"),
    row(40, Effect::OneShot(OneShot::Dwell), "dwell").with(facts::DWELL),
    fanuc(50, Effect::NoEffect, "AI contour control, high-speed cycle machining").with(facts::CONTOUR_CONTROL),
    fanuc(51, Effect::NoEffect, "AI contour control, smooth interpolation").with(facts::SMOOTH_CONTOUR_CONTROL),
    fanuc(54, Effect::NoEffect, "HRV3, 4 on/off").with(facts::WITHOUT_EFFECT),
    fanuc(62, Effect::NotSimulated, "NURBS interpolation"),
    fanuc(70, Effect::NotSimulated, "hypothetical axis interpolation"),
    fanuc(71, Effect::OneShot(OneShot::Cylinder), "cylindrical interpolation").with(facts::CYLINDER),
    fanuc(80, Effect::LookAhead, "advanced preview control").with(facts::LOOK_AHEAD),
    row(90, Effect::NoEffect, "exact stop").with(facts::EXACT_STOP),
    row(100, Effect::OneShot(OneShot::DataInput), "programmable data input").with(facts::DATA_INPUT),
    fanuc(106, Effect::OneShot(OneShot::RetractPoint), "tool retract and recover").with(facts::RETRACT_POINT),
    fanuc(110, Effect::OneShot(OneShot::DataInputEnd), "programmable data input mode cancel").with(facts::DATA_INPUT_END),
    haas(120, Effect::OneShot(OneShot::CirclePocket(Motion::Clockwise)), "circular pocket milling, clockwise").with(facts::CIRCLE_POCKET),
    fanuc(121, Effect::PolarInterpolation(PolarInterpolation::On), "polar coordinate interpolation mode").with(facts::VIRTUAL_PLANE),
    haas(130, Effect::OneShot(OneShot::CirclePocket(Motion::Counterclockwise)), "circular pocket milling, counterclockwise").with(facts::CIRCLE_POCKET),
    fanuc(131, Effect::PolarInterpolation(PolarInterpolation::Off), "polar coordinate interpolation cancel mode").with(facts::VIRTUAL_PLANE),
    fanuc(150, Effect::Polar(Polar::Off), "polar coordinates command cancel"),
    fanuc(160, Effect::Polar(Polar::On), "polar coordinates command"),
    row(170, Effect::Plane(Plane::Xy), "XpYp plane selection"),
    row(180, Effect::Plane(Plane::Zx), "ZpXp plane selection"),
    row(190, Effect::Plane(Plane::Yz), "YpZp plane selection"),
    row(200, Effect::Unit(Unit::Inch), "input in inch"),
    row(210, Effect::Unit(Unit::Metric), "input in mm"),
    fanuc(220, Effect::StrokeCheck(StrokeCheck::On), "stored stroke check on").with(facts::MODE_WITHOUT_EFFECT),
    fanuc(230, Effect::StrokeCheck(StrokeCheck::Off), "stored stroke check off").with(facts::MODE_WITHOUT_EFFECT),
    fanuc(250, Effect::NoEffect, "spindle speed fluctuation detection off").with(facts::WITHOUT_EFFECT),
    fanuc(260, Effect::NoEffect, "spindle speed fluctuation detection on").with(facts::WITHOUT_EFFECT),
    fanuc(270, Effect::OneShot(OneShot::CheckReference), "reference position return check").with(facts::CHECK_REFERENCE),
    row(280, Effect::OneShot(OneShot::Reference), "automatic return to reference position").with(facts::REFERENCE),
    row(290, Effect::OneShot(OneShot::FromReference), "movement from reference position").with(facts::FROM_REFERENCE),
    fanuc(300, Effect::OneShot(OneShot::SecondReference), "2nd, 3rd and 4th reference position return").with(facts::SECOND_REFERENCE),
    fanuc(301, Effect::NotSimulated, "floating reference position return"),
    row(310, Effect::OneShot(OneShot::Skip), "skip function").with(facts::SKIP),
    fanuc(318, Effect::NotSimulated, "EGB-axis skip"),
    fanuc(319, Effect::NotSimulated, "continuous high-speed skip"),
    fanuc(330, Effect::Motion(Motion::Thread), "threading"),
    haas(350, Effect::OneShot(OneShot::Measure(MeasuringCode::ToolDiameter)), "automatic tool diameter measurement").with(facts::MEASURE),
    haas(360, Effect::OneShot(OneShot::Measure(MeasuringCode::WorkZero)), "automatic work offset measurement").with(facts::MEASURE),
    fanuc(370, Effect::NotSimulated, "automatic tool length measurement"),
    haas(370, Effect::OneShot(OneShot::Measure(MeasuringCode::ToolLength)), "automatic tool length measurement").with(facts::MEASURE),
    fanuc(390, Effect::OneShot(OneShot::CornerArc), "cutter compensation: corner circular interpolation").with(facts::CORNER_ARC),
    row(400, Effect::Cutter(CutterSide::Off), "cutter compensation cancel"),
    fanuc(401, Effect::NoEffect, "normal direction control cancel mode").with(facts::WITHOUT_EFFECT),
    row(410, Effect::Cutter(CutterSide::Left), "cutter compensation left"),
    fanuc(411, Effect::NotSimulated, "normal direction control left"),
    fanuc(412, Effect::NotSimulated, "three-dimensional cutter compensation left, type 1"),
    fanuc(413, Effect::NotSimulated, "three-dimensional cutter compensation, leading edge offset"),
    fanuc(414, Effect::NotSimulated, "three-dimensional cutter compensation left, type 1 (FS16i format)"),
    fanuc(415, Effect::NotSimulated, "three-dimensional cutter compensation left, type 1 (FS16i format)"),
    fanuc(416, Effect::NotSimulated, "three-dimensional cutter compensation left, type 2"),
    row(420, Effect::Cutter(CutterSide::Right), "cutter compensation right"),
    fanuc(421, Effect::NotSimulated, "normal direction control right"),
    fanuc(422, Effect::NotSimulated, "three-dimensional cutter compensation right, type 1"),
    fanuc(424, Effect::NotSimulated, "three-dimensional cutter compensation right, type 1 (FS16i format)"),
    fanuc(425, Effect::NotSimulated, "three-dimensional cutter compensation right, type 1 (FS16i format)"),
    fanuc(426, Effect::NotSimulated, "three-dimensional cutter compensation right, type 2"),
    row(430, Effect::Length(Length::Plus), "tool length compensation +"),
    fanuc(431, Effect::NotSimulated, "tool length compensation in tool axis direction"),
    five_axis(434, Effect::Length(Length::TipByAngles), "tool centre point control, type 1"),
    five_axis(435, Effect::Length(Length::TipByVector), "tool centre point control, type 2"),
    fanuc(437, Effect::NotSimulated, "tool offset"),
    row(440, Effect::Length(Length::Minus), "tool length compensation -"),
    fanuc(450, Effect::OneShot(OneShot::ToolOffset(1)), "tool offset: increase").with(facts::TOOL_OFFSET),
    fanuc(460, Effect::OneShot(OneShot::ToolOffset(-1)), "tool offset: decrease").with(facts::TOOL_OFFSET),
    fanuc(470, Effect::OneShot(OneShot::ToolOffset(2)), "tool offset: double increase").with(facts::TOOL_OFFSET),
    haas(470, Effect::OneShot(OneShot::Engraving), "text engraving").with(facts::ENGRAVING),
    fanuc(480, Effect::OneShot(OneShot::ToolOffset(-2)), "tool offset: double decrease").with(facts::TOOL_OFFSET),
    row(490, Effect::Length(Length::Off), "tool length compensation cancel"),
    fanuc(491, Effect::NotSimulated, "tool length compensation cancel"),
    row(500, Effect::Scaling(Scaling::Off), "scaling cancel").with(facts::SCALING_OFF),
    fanuc(501, Effect::Mirror(Mirror::Off), "programmable mirror image cancel"),
    fanuc(502, Effect::NoEffect, "polygon turning cancel").with(facts::WITHOUT_EFFECT),
    row(510, Effect::Scaling(Scaling::On), "scaling").with(facts::SCALING),
    fanuc(511, Effect::Mirror(Mirror::On), "programmable mirror image").with(facts::MIRROR),
    fanuc(512, Effect::NotSimulated, "polygon turning"),
    row(520, Effect::OneShot(OneShot::SetLocalCoordinateSystem), "local coordinate system setting").with(facts::SET_COORDINATE_SYSTEM),
    row(530, Effect::OneShot(OneShot::MachineCoordinateSystem), "machine coordinate system setting").with(facts::MACHINE_COORDINATE_SYSTEM),
    fanuc(531, Effect::OneShot(OneShot::ToolAxis { keeps_tip: false }), "tool axis direction control").with(facts::TOOL_AXIS),
    fanuc(536, Effect::OneShot(OneShot::ToolAxis { keeps_tip: true }), "tool centre point retention tool axis direction control").with(facts::TOOL_AXIS),
    row(540, Effect::Work(1), "workpiece coordinate system 1 selection").with(facts::WORK),
    fanuc(541, Effect::AdditionalWork, "additional workpiece coordinate system selection").with(facts::WORK),
    fanuc(542, Effect::UnstatedOffset(DynamicOffset::Fixture), "rotary table dynamic fixture offset").with(facts::UNSTATED_OFFSET),
    fanuc(544, Effect::UnstatedOffset(DynamicOffset::SettingError), "workpiece setting error compensation").with(facts::UNSTATED_OFFSET),
    row(550, Effect::Work(2), "workpiece coordinate system 2 selection").with(facts::WORK),
    row(560, Effect::Work(3), "workpiece coordinate system 3 selection").with(facts::WORK),
    row(570, Effect::Work(4), "workpiece coordinate system 4 selection").with(facts::WORK),
    row(580, Effect::Work(5), "workpiece coordinate system 5 selection").with(facts::WORK),
    row(590, Effect::Work(6), "workpiece coordinate system 6 selection").with(facts::WORK),
    row(600, Effect::OneShot(OneShot::SingleDirection), "single direction positioning").with(facts::SINGLE_DIRECTION),
    row(610, Effect::Cutting(CuttingMode::ExactStop), "exact stop mode"),
    fanuc(611, Effect::NoEffect, "geometry compensation, an accuracy mode of some builders").with(facts::ACCURACY_MODE),
    fanuc(620, Effect::Cutting(CuttingMode::CornerOverride), "automatic corner override"),
    fanuc(630, Effect::Cutting(CuttingMode::Tapping), "tapping mode"),
    row(640, Effect::Cutting(CuttingMode::Cutting), "cutting mode"),
    row(650, Effect::Call, "macro call"),
    fanuc(660, Effect::Call, "macro modal call A"),
    fanuc(661, Effect::Call, "macro modal call B"),
    fanuc(670, Effect::Call, "macro modal call A/B cancel"),
    row(680, Effect::Rotation(Rotation::On), "coordinate system rotation").with(facts::ROTATION),
    fanuc(681, Effect::NotSimulated, "three-dimensional coordinate conversion"),
    fanuc(682, Effect::Rotation(Rotation::Tilted), "tilted working plane indexing").with(facts::TILT),
    fanuc(683, Effect::Rotation(Rotation::AlongTool), "tilted working plane indexing by tool axis direction").with(facts::TILT),
    fanuc(684, Effect::Rotation(Rotation::TiltedFurther), "tilted working plane indexing, incremental multi-command").with(facts::TILT),
    row(690, Effect::Rotation(Rotation::Off), "coordinate system rotation cancel"),
    haas(700, Effect::OneShot(OneShot::BoltHoles(HolePattern::Circle)), "bolt hole circle").with(facts::BOLT_HOLES),
    haas(710, Effect::OneShot(OneShot::BoltHoles(HolePattern::Arc)), "bolt hole arc").with(facts::BOLT_HOLES),
    haas(720, Effect::OneShot(OneShot::BoltHoles(HolePattern::Line)), "bolt holes along an angle").with(facts::BOLT_HOLES),
    fanuc(721, Effect::NotSimulated, "figure copying: rotary copy"),
    fanuc(722, Effect::NotSimulated, "figure copying: linear copy"),
    cycle(&cycles::HIGH_SPEED_PECK_DRILLING),
    cycle(&cycles::LEFT_HANDED_TAPPING),
    cycle(&cycles::FINE_BORING),
    haas_cycle(&cycles::BACK_BORING_OF_HAAS),
    row(800, Effect::Cycle(None), "canned cycle cancel"),
    fanuc(804, Effect::NoEffect, "electronic gear box: synchronisation cancel").with(facts::WITHOUT_EFFECT),
    cycle(&cycles::DRILLING),
    fanuc(811, Effect::NotSimulated, "chopping function"),
    fanuc(814, Effect::NotSimulated, "electronic gear box: synchronisation start"),
    cycle(&cycles::COUNTER_BORING),
    cycle(&cycles::PECK_DRILLING),
    cycle(&cycles::TAPPING),
    fanuc_cycle(&cycles::RIGID_TAPPING),
    fanuc_cycle(&cycles::LEFT_HANDED_RIGID_TAPPING),
    cycle(&cycles::BORING_FEED_RETRACT),
    cycle(&cycles::BORING_SPINDLE_STOP),
    fanuc_cycle(&cycles::BACK_BORING),
    haas_cycle(&cycles::BORING_STOP_OF_HAAS),
    cycle(&cycles::BORING_MANUAL_RETRACT),
    cycle(&cycles::BORING_DWELL),
    row(900, Effect::Distance(Distance::Absolute), "absolute programming"),
    row(910, Effect::Distance(Distance::Incremental), "incremental programming"),
    row(920, Effect::OneShot(OneShot::SetWorkCoordinateSystem), "workpiece coordinate system setting").with(facts::SET_COORDINATE_SYSTEM),
    fanuc(921, Effect::OneShot(OneShot::PresetWorkCoordinateSystem), "workpiece coordinate system preset").with(facts::SET_COORDINATE_SYSTEM),
    row(930, Effect::FeedMode(FeedMode::InverseTime), "inverse time feed"),
    row(940, Effect::FeedMode(FeedMode::PerMinute), "feed per minute"),
    row(950, Effect::FeedMode(FeedMode::PerRevolution), "feed per revolution"),
    fanuc(960, Effect::NotSimulated, "constant surface speed control"),
    row(970, Effect::SpindleMode(SpindleMode::Speed), "constant surface speed control cancel"),
    row(980, Effect::ReturnTo(ReturnTo::Initial), "canned cycle: return to initial level"),
    row(990, Effect::ReturnTo(ReturnTo::R), "canned cycle: return to R point level"),
    haas(1000, Effect::Mirror(Mirror::Off), "mirror image cancel"),
    haas(1010, Effect::Mirror(Mirror::On), "mirror image").with(facts::MIRROR),
    haas(1030, Effect::NoEffect, "limit of block lookahead").with(facts::WITHOUT_EFFECT),
    haas(1070, Effect::OneShot(OneShot::WrappedAxis), "cylindrical mapping").with(facts::CYLINDER),
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
    fanuc(1311, Effect::NoEffect, "geometric intelligence, an accuracy mode of some builders").with(facts::ACCURACY_MODE),
    haas(1360, Effect::OneShot(OneShot::Measure(MeasuringCode::WorkCentre)), "automatic work offset centre measurement").with(facts::MEASURE),
    haas(1410, Effect::NotSimulated, "3D+ cutter compensation"),
    haas(1430, Effect::NotSimulated, "5-axis tool length compensation +"),
    fanuc(1500, Effect::NoEffect, "normal direction control cancel mode").with(facts::WITHOUT_EFFECT),
    haas(1500, Effect::OneShot(OneShot::Pocket), "general purpose pocket milling").with(facts::POCKET),
    fanuc(1510, Effect::NotSimulated, "normal direction control left"),
    fanuc(1520, Effect::NotSimulated, "normal direction control right"),
    haas(1530, Effect::NotSimulated, "5-axis high-speed peck drilling canned cycle"),
    haas(1540, Effect::AdditionalWork, "additional work coordinate system").with(facts::WORK),
    haas(1550, Effect::NotSimulated, "5-axis reverse tapping canned cycle"),
    haas(1560, Effect::NotSimulated, "broaching canned cycle"),
    fanuc(1600, Effect::NoEffect, "in-feed control cancel").with(facts::WITHOUT_EFFECT),
    fanuc(1610, Effect::NotSimulated, "in-feed control"),
    haas(1610, Effect::NotSimulated, "5-axis drilling canned cycle"),
    haas(1620, Effect::NotSimulated, "5-axis spot drilling canned cycle"),
    haas(1630, Effect::NotSimulated, "5-axis peck drilling canned cycle"),
    haas(1640, Effect::NotSimulated, "5-axis tapping canned cycle"),
    haas(1650, Effect::NotSimulated, "5-axis boring canned cycle"),
    haas(1660, Effect::NotSimulated, "5-axis boring canned cycle, stop and rapid out"),
    haas(1670, Effect::NotSimulated, "modify setting"),
    haas(1690, Effect::NotSimulated, "5-axis boring canned cycle with a dwell"),
    haas(1740, Effect::OneShot(OneShot::AskewTapping { is_left_handed: true }), "counterclockwise non-vertical rigid tapping").with(facts::ASKEW_TAPPING),
    haas(1840, Effect::OneShot(OneShot::AskewTapping { is_left_handed: false }), "clockwise non-vertical rigid tapping").with(facts::ASKEW_TAPPING),
    haas(1870, Effect::Smoothness, "smoothness level setting").with(facts::SMOOTHNESS),
    haas(1880, Effect::NotSimulated, "program from the pallet schedule table"),
    haas(2340, Effect::Length(Length::TipOfHaas), "tool centre point control"),
    haas(2530, Effect::OneShot(OneShot::ToolAxis { keeps_tip: false }), "orient spindle normal to feature coordinate system").with(facts::TOOL_AXIS),
    haas(2540, Effect::DynamicOffset(DynamicOffset::On), "dynamic work offset"),
    haas(2550, Effect::DynamicOffset(DynamicOffset::Off), "dynamic work offset cancel"),
    haas(2660, Effect::OneShot(OneShot::StraightRapid), "linear rapid motion of all axes").with(facts::STRAIGHT_RAPID),
    haas(2680, Effect::Rotation(Rotation::Feature), "feature coordinate system on").with(facts::TILT),
    haas(2690, Effect::Rotation(Rotation::Off), "feature coordinate system off"),
    fanuc(3320, Effect::NoEffect, "high-speed machining, an accuracy mode of some builders").with(facts::ACCURACY_MODE),
];
