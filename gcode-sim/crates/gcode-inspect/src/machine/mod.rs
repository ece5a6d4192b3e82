//! The machine: the axes that carry the part and the tool, the head, the tools, and the position of the part.
//!
//! Forward kinematics is the definition; every other computation has to agree with it.
mod chain;
mod error;
mod file;
mod from_job;
mod head;
mod inverse;
mod kinematics;
mod path;
mod probe;
mod random;
mod rapid;
mod sources;
mod tool_body;
mod tool_shape;
mod touch;
mod wheel;

use nalgebra::{IsometryMatrix3, Point3, Translation3, Unit, Vector3};

pub use chain::{AxisLink, Chain, LinkMotion};
pub use error::{Distribution, PeriodicError};
pub use file::{ErrorFile, File as MachineFile, error_file};
pub use head::{Head, HeadKind, HeadMessage};
pub use path::AxisMotion;
pub use probe::Probe;
pub use random::RandomStream;
pub use rapid::RapidPath;
pub(crate) use rapid::arrivals;
pub use sources::{ErrorSource, Quantity};
pub(crate) use tool_body::{COS_30, TOUCH_DEPTH, ToolPart};
pub use tool_shape::ToolKind;
pub(crate) use tool_shape::{PointShape, tool_name};
pub(crate) use touch::BALL_CHORD_TOLERANCE;
pub use wheel::Wheel;

use gcode_lang::control::{Dialect, Increment};
use gcode_lang::motion::{Axes, AxisIndex, Position};
use gcode_lang::program::modes::{self, WorkSystem};
use gcode_lang::units::Deg;
use gcode_part::{Hand, Stock};

/// Rotation and translation of a point; lengths in mm.
pub type Frame = IsometryMatrix3<f64>;

/// A machine: the axes of its control, what each of them carries, and the set-up of a job.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Axes of the control.
    pub axes: Axes,
    /// Family of controls.
    pub dialect: Dialect,
    /// Least input increment.
    pub increment: Increment,
    /// Unit of programs at power-on; `None` if nothing states it, which counts as mm.
    pub unit: Option<modes::Unit>,
    /// Axes that carry the part, from the bed outwards.
    pub table: Chain,
    /// True if no machine file and no job describes the table.
    pub has_default_table: bool,
    /// Axes that carry the tool: those of X, Y and Z that do not carry the part.
    pub slides: Chain,
    /// Head that holds the tool.
    pub head: Head,
    /// Wheel of a grinder.
    pub wheel: Option<Wheel>,
    /// Tool table.
    pub tools: Vec<Tool>,
    /// Work offsets at the start of a run.
    pub offsets: Vec<WorkOffset>,
    /// Known positions of axes at the start of a run, in the work coordinate system active then, mm or degrees.
    pub start: Vec<(AxisIndex, f64)>,
    /// Position of the part.
    pub part: Placement,
    /// Touch probe.
    pub probe: Option<Probe>,
    /// Path of a rapid of several axes.
    pub rapid: RapidPath,
    /// Solid material of the part; `None` for that of the reference.
    pub stock: Option<Stock>,
}

/// A tool of the machine's tool table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tool {
    /// Number of the tool.
    pub number: u32,
    /// Distance from the spindle's gauge line to the tip, mm; `None` for the length of the tool length offset
    /// in effect.
    pub length: Option<f64>,
    /// Diameter, mm; `None` if unknown.
    pub diameter: Option<f64>,
    /// Distance from the tip to the shank, mm; `None` without a shank.
    pub flute_length: Option<f64>,
    /// Diameter of the shank, mm.
    pub shank_diameter: Option<f64>,
    /// Diameter of the holder, mm; `None` if unknown.
    pub holder_diameter: Option<f64>,
    /// Length of the holder below the gauge line, mm.
    pub holder_length: Option<f64>,
    /// Geometry of the length offset H of the tool's number, mm, of a tool without `length`; `None` for that of the control.
    pub length_offset: Option<f64>,
    /// Cutter radius offset D of the tool's number, mm; `None` for that of the control.
    pub radius_offset: Option<f64>,
    /// Kind; `None` if unknown.
    pub kind: Option<ToolKind>,
    /// Full angle of the point, 180° of a flat end; `None` if unknown.
    pub point_angle: Option<Deg>,
    /// Hand that the machine file states.
    pub hand: Option<Hand>,
}

impl Tool {
    /// Returns the geometry of the length offset of its number that the machine file states: its length, or that of a tool
    /// touched off at the part.
    pub fn stated_length_offset(&self) -> Option<f64> {
        self.length.or(self.length_offset)
    }

    /// Returns its hand: right unless stated; `None` if its kind is unknown too.
    pub fn known_hand(&self) -> Option<Hand> {
        self.hand.or(self.kind.map(|_| Hand::Right))
    }
}

/// A work offset at the start of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkOffset {
    /// The work coordinate system.
    pub system: WorkSystem,
    /// Values of the axes named, mm or degrees; the others are 0.
    pub values: Vec<(AxisIndex, f64)>,
}

impl WorkOffset {
    /// Returns the axes named, as bits.
    pub fn axes(&self) -> u8 {
        self.values.iter().fold(0, |bits, (axis, _)| bits | 1 << axis)
    }
}

/// Position of the part on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Nominal origin of the part in machine coordinates, with all axes of the table at 0.
    pub origin: Point3<f64>,
    /// Shift of the actual part from the nominal position, applied after the tilt.
    pub shift: Vector3<f64>,
    /// Tilt of the actual part about x, then y, then z, through its origin.
    pub tilt: [Deg; 3],
}

/// State besides the axes that determines the tip: set by the operator, by M06 and by the length offset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setup {
    /// Angle of a head set by hand; `None` before the first setting.
    pub head_angle: Option<Deg>,
    /// Tool in the spindle; `None` if unknown.
    pub tool: Option<u32>,
    /// Tool length offset contained in every machine position.
    pub offset: Position,
    /// Part of it that is wear: the tool deviates by it from its measured length.
    pub wear: Position,
}

/// Tip and direction of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Tip of the tool.
    pub tip: Point3<f64>,
    /// Direction from the tip to the spindle, out of the part; `None` if unknown.
    pub axis: Option<Unit<Vector3<f64>>>,
}

impl Default for Machine {
    /// Returns the machine of the paper.
    ///
    /// X, Y and Z carry the tool. B about Y carries the part, whose origin is on B's axis and at machine
    /// zero. A and C are axes of the control that carry nothing. The direction of the head is unknown.
    fn default() -> Self {
        let axes = Axes::default();
        Self {
            slides: Chain::default_slides(&axes, &Chain::default()),
            table: Chain::default_table(&axes, Point3::origin()),
            has_default_table: true,
            axes,
            dialect: Dialect::default(),
            increment: Increment::default(),
            unit: None,
            head: Head::new(HeadKind::Free, 0.0),
            wheel: None,
            tools: Vec::new(),
            offsets: Vec::new(),
            start: Vec::new(),
            part: Placement::default(),
            probe: None,
            rapid: RapidPath::default(),
            stock: None,
        }
    }
}

impl Default for Placement {
    fn default() -> Self {
        Self { origin: Point3::origin(), shift: Vector3::zeros(), tilt: [Deg::ZERO; 3] }
    }
}

impl Placement {
    /// Returns the transformation from the part's frame to machine coordinates with all axes of the table at
    /// 0.
    pub fn frame(&self) -> Frame {
        let [x, y, z] = self.tilt;
        let rotation = chain::rotation_about(&Vector3::z_axis(), z)
            * chain::rotation_about(&Vector3::y_axis(), y)
            * chain::rotation_about(&Vector3::x_axis(), x);
        Frame::from_parts(Translation3::from(self.origin.coords + self.shift), rotation)
    }
}

impl Machine {
    /// Returns the transformation from the part's frame to machine coordinates with the axes at `at`.
    pub fn part_frame(&self, at: &Position) -> Frame {
        self.table.frame(at) * self.part.frame()
    }

    /// Returns the pose of the tool in machine coordinates.
    ///
    /// The position of the axes is the head's pivot. The tip is the pivot's distance from the gauge line plus
    /// the tool length away from it, along the tool. If the direction of the tool is unknown, the tip is the
    /// control's own: the position minus the length offset without its wear.
    pub(crate) fn tool_pose(&self, at: &Position, setup: &Setup) -> Pose {
        let carried = self.slides.carried_origin(at);
        match self.head.direction(at, setup) {
            Some(axis) => {
                let reach = self.head.pivot + self.tip_distance(setup, &axis);
                Pose { tip: carried + self.head.tip_displacement(at, &axis, reach), axis: Some(axis) }
            }
            None => Pose { tip: carried - self.measured_length(setup), axis: None },
        }
    }

    /// Returns the pose of the tool in the part's frame.
    pub fn forward(&self, at: &Position, setup: &Setup) -> Pose {
        self.tool_pose(at, setup).relative_to(&self.part_frame(at))
    }

    /// Returns the tool length from the tool table, or else that of the length offset without wear, mm.
    pub(crate) fn tool_length(&self, setup: &Setup) -> f64 {
        self.length_of(setup.tool).unwrap_or_else(|| self.measured_length(setup).norm())
    }

    /// Returns the length offset without its wear: wear moves the tip of a tool that is as long as measured.
    fn measured_length(&self, setup: &Setup) -> Vector3<f64> {
        self.slides.displacement(&setup.offset) - self.slides.displacement(&setup.wear)
    }

    /// Returns the distance from the gauge line to the tip against `axis`, the tool's direction out of the part, mm: the
    /// length of the tool, or else the length offset without wear. A touched-off offset counts from machine zero and is negative; the one
    /// that the file states counts while none is in effect. An offset is along the tool, or, in tool centre point control, along the
    /// tool with the head at 0.
    fn tip_distance(&self, setup: &Setup, axis: &Unit<Vector3<f64>>) -> f64 {
        if let Some(length) = self.length_of(setup.tool) {
            return length;
        }
        let offset = self.measured_length(setup);
        let is_along = |axis: &Vector3<f64>| offset.dot(axis).abs() > (1.0 - 1e-9) * offset.norm();
        let at_zero = self.head.direction(&Position::default(), setup);
        let basis = at_zero.filter(|zero| !is_along(axis) && is_along(zero)).unwrap_or(*axis);
        let is_touched_off = offset.dot(&basis) < -0.5 * offset.norm();
        match offset.norm() {
            0.0 => self.touched_off(setup.tool).unwrap_or(0.0),
            length if is_touched_off => -length,
            length => length,
        }
    }

    /// Returns the tool with this number; `None` if the tool table lacks it.
    pub(crate) fn find_tool(&self, number: u32) -> Option<&Tool> {
        self.tools.iter().find(|tool| tool.number == number)
    }

    /// Returns the length of the tool in the spindle, mm; `None` if the tool or its length is unknown.
    pub(crate) fn length_of(&self, tool: Option<u32>) -> Option<f64> {
        self.find_tool(tool?)?.length
    }

    /// Returns true if the file says where the tip of a tool is without a length offset.
    pub(crate) fn has_tip(&self, tool: Option<u32>) -> bool {
        self.length_of(tool).is_some() || self.touched_off(tool).is_some()
    }

    /// Returns the length offset that the file states for a tool touched off at the part, mm, which is negative; `None` for any other.
    fn touched_off(&self, tool: Option<u32>) -> Option<f64> {
        self.find_tool(tool?)?.length_offset.filter(|offset| *offset < 0.0)
    }

    /// Returns the diameter of the tool in the spindle, mm; `None` if the tool or its diameter is unknown.
    pub(crate) fn diameter_of(&self, tool: Option<u32>) -> Option<f64> {
        self.find_tool(tool?)?.diameter
    }

    /// Returns the shape of the end of the tool in the spindle.
    pub(crate) fn point_of(&self, tool: Option<u32>) -> PointShape {
        tool.and_then(|number| self.find_tool(number)).map_or(PointShape::Unknown, Tool::point)
    }

    /// Returns true if the tool table has a touch probe.
    pub fn has_probe_tool(&self) -> bool {
        self.tools.iter().any(|tool| tool.kind == Some(ToolKind::Probe))
    }

    /// Returns the kind of the tool in the spindle; `None` if the tool or its kind is unknown.
    pub(crate) fn kind_of(&self, tool: Option<u32>) -> Option<ToolKind> {
        self.find_tool(tool?)?.kind
    }

    /// Returns the rotary axes of a table that nothing describes, as bits: a program without them needs none.
    pub(crate) fn assumed_rotary_axes(&self) -> u8 {
        match self.has_default_table {
            true => self.table.rotary_axes().fold(0, |axes, axis| axes | 1 << axis),
            false => 0,
        }
    }

    /// Returns those of some axes, as bits, that move something on this machine, without an assumed rotary.
    pub fn needed_axes(&self, axes: u8) -> u8 {
        self.used_axes() & axes & !self.assumed_rotary_axes()
    }

    /// Returns the axes that move the tool, the part, the head or the wheel, as bits.
    pub fn used_axes(&self) -> u8 {
        let used = self.axes.iter().filter(|(axis, _)| self.is_axis_used(*axis));
        used.fold(0, |all, (axis, _)| all | 1 << axis)
    }

    /// Returns true if the axis moves the tool, the part, the head or the wheel.
    pub(crate) fn is_axis_used(&self, axis: AxisIndex) -> bool {
        let wheel =
            self.wheel.is_some_and(|wheel| wheel.swivel_axis.is_some_and(|(swivel, _)| swivel == axis));
        self.head.has_axis(axis) || wheel || self.table.has_axis(axis) || self.slides.has_axis(axis)
    }
}

impl Pose {
    /// Returns the pose in the coordinates of `frame`.
    pub(crate) fn relative_to(&self, frame: &Frame) -> Self {
        Self {
            tip: frame.inverse_transform_point(&self.tip),
            axis: self.axis.map(|axis| frame.rotation.inverse_transform_unit_vector(&axis)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rotation by `degrees` about +y, written out: x' = x·c + z·s, z' = −x·s + z·c.
    fn about_y(p: [f64; 3], degrees: f64) -> Point3<f64> {
        let (s, c) = (Deg(degrees).sin(), Deg(degrees).cos());
        Point3::new(p[0] * c + p[2] * s, p[1], -p[0] * s + p[2] * c)
    }

    fn at(machine: &Machine, values: &[(u8, f64)]) -> Position {
        let mut position = Position::default();
        for (letter, value) in values {
            position[machine.axes.find(*letter).unwrap()] = *value;
        }
        position
    }

    #[test]
    fn b_equal_to_the_azimuth_brings_a_point_to_the_plane_z_0() {
        let machine = Machine::default();
        let point = [300.0 * Deg(72.0).cos(), 50.0, 300.0 * Deg(72.0).sin()];
        let there = machine.part_frame(&at(&machine, &[(b'B', 72.0)])) * Point3::from(point);
        assert!((there - Point3::new(300.0, 50.0, 0.0)).norm() < 1e-10, "{there}");
        assert!((there - about_y(point, 72.0)).norm() < 1e-10);
    }

    #[test]
    fn with_the_opposite_sign_minus_the_azimuth_does() {
        let mut machine = Machine::default();
        machine.table.0[0].sign = -1.0;
        let point = Point3::new(300.0 * Deg(200.0).cos(), 0.0, 300.0 * Deg(200.0).sin());
        let there = machine.part_frame(&at(&machine, &[(b'B', -200.0)])) * point;
        assert!((there - Point3::new(300.0, 0.0, 0.0)).norm() < 1e-10, "{there}");
    }

    #[test]
    fn the_tip_is_pivot_and_tool_length_below_the_pivot_point_along_the_head() {
        let machine = Machine {
            head: Head::new(HeadKind::Manual { start: None }, 100.0),
            tools: vec![Tool { number: 2, length: Some(150.0), diameter: None, ..Tool::default() }],
            ..Machine::default()
        };
        let setup = Setup { head_angle: Some(Deg(30.0)), tool: Some(2), ..Setup::default() };
        let pose = machine.tool_pose(&at(&machine, &[(b'X', 400.0), (b'Y', 300.0)]), &setup);
        // 250 mm along (cos 30°, sin 30°) = (216.506…, 125).
        assert!((pose.tip - Point3::new(400.0 - 216.506_350_946, 175.0, 0.0)).norm() < 1e-8, "{}", pose.tip);
    }

    #[test]
    fn a_length_offset_without_a_tool_table_puts_the_tip_at_the_programmed_point() {
        let machine = Machine::default();
        let offset = at(&machine, &[(b'Z', 120.0)]);
        let setup = Setup { offset, ..Setup::default() };
        let pose = machine.forward(&at(&machine, &[(b'X', 5.0), (b'Z', 130.0)]), &setup);
        assert!((pose.tip - Point3::new(5.0, 0.0, 10.0)).norm() < 1e-12);
    }

    #[test]
    fn a_misplaced_part_is_tilted_about_x_then_y_then_z_and_shifted() {
        let part = Placement {
            shift: Vector3::new(1.0, 2.0, 3.0),
            tilt: [Deg(90.0), Deg(90.0), Deg::ZERO],
            ..Placement::default()
        };
        // (0, 1, 0) about x by 90°: (0, 0, 1); about y by 90°: (1, 0, 0); shifted: (2, 2, 3).
        let there = part.frame() * Point3::new(0.0, 1.0, 0.0);
        assert!((there - Point3::new(2.0, 2.0, 3.0)).norm() < 1e-12, "{there}");
    }
}
