//! The machine that a job assumes, without errors.
use nalgebra::{Point3, Unit, Vector3};

use super::{AxisLink, Chain, Head, HeadKind, Machine, Placement, Probe, Tool, ToolKind};
use gcode_lang::units::Deg;
use gcode_part::job::{self, Job, Operation, PatternJob, PatternPlace, PatternTool, Rotary};

impl Machine {
    /// Returns the arrangement of the job's family. `None` if the control lacks the rotary axis, and for a
    /// burr, which needs the machine file next to its programs.
    pub fn from_job(job: &Job) -> Option<Self> {
        let nominal = Self {
            dialect: job.control().dialect,
            increment: job.control().increment,
            has_default_table: false,
            ..Self::default()
        };
        match job {
            Job::PinHoles(job) => {
                let axes = &nominal.axes;
                let kind = match job.machine.head.kind() {
                    job::HeadKind::Manual => HeadKind::Manual { start: None },
                    job::HeadKind::Axis(letter) => {
                        HeadKind::Axis { axis: axes.find(letter as u8)?, sign: 1.0, zero: Deg::ZERO }
                    }
                };
                let tool = |tool: &job::Tool| Tool {
                    number: tool.number,
                    length: Some(tool.length),
                    diameter: Some(tool.diameter),
                    ..Tool::default()
                };
                Some(Self {
                    table: nominal.rotary_table(job.machine.rotary, Vector3::y_axis(), Point3::origin())?,
                    head: Head::new(kind, job.machine.head.pivot),
                    tools: job.tools.iter().map(tool).collect(),
                    ..nominal
                })
            }
            Job::Honeycomb(job) => {
                // Z0 of the programs is on the surface of the cylinder.
                let origin = Point3::new(0.0, 0.0, -job.cylinder.outer() / 2.0);
                let diameter = Some(job.drill.diameter);
                Some(Self {
                    table: nominal.rotary_table(job.machine.rotary, Vector3::x_axis(), origin)?,
                    head: Head::new(HeadKind::Fixed(Vector3::z_axis()), 0.0),
                    tools: vec![Tool {
                        number: job.drill.number(),
                        length: None,
                        diameter,
                        ..Tool::default()
                    }],
                    part: Placement { origin, ..Placement::default() },
                    ..nominal
                })
            }
            Job::Pattern(job) => nominal.of_pattern(job),
            Job::Burr(_) => None,
            // The programmed point is the centre of the ball; the head does not move.
            Job::Alignment(job) => Some(Self {
                table: nominal.rotary_table(job.machine.rotary, Vector3::y_axis(), Point3::origin())?,
                probe: Some(Probe::new(job.probe.radius)),
                ..nominal
            }),
        }
    }

    fn of_pattern(self, job: &PatternJob) -> Option<Self> {
        let (table, origin) = match job.place() {
            PatternPlace::Plate => (Chain::default(), Point3::origin()),
            // Z0 of the programs is on the surface of the cylinder.
            PatternPlace::Cylinder { diameter, rotary } => {
                let origin = Point3::new(0.0, 0.0, -diameter / 2.0);
                (self.rotary_table(rotary, Vector3::x_axis(), origin)?, origin)
            }
            PatternPlace::Face { tilt, rotary, .. } => {
                let bed = self.rotary_table(tilt, Vector3::x_axis(), Point3::origin())?;
                let on_it = self.rotary_table(rotary, Vector3::z_axis(), Point3::origin())?;
                (Chain(bed.0.into_iter().chain(on_it.0).collect()), Point3::origin())
            }
        };
        let kind = |operation: Operation| match operation {
            Operation::SpotDrill => Some(ToolKind::SpotDrill),
            Operation::Drill | Operation::Peck => Some(ToolKind::Drill),
            Operation::Tap => Some(ToolKind::Tap),
            Operation::Bore => Some(ToolKind::BoringBar),
            Operation::MillCircle => Some(ToolKind::EndMill),
            Operation::ThreadMill => None,
        };
        let tool = |tool: &PatternTool| Tool {
            number: tool.number,
            kind: kind(tool.operation),
            length: None,
            diameter: Some(tool.diameter),
            ..Tool::default()
        };
        Some(Self {
            table,
            head: Head::new(HeadKind::Fixed(Vector3::z_axis()), 0.0),
            tools: job.tools.iter().map(tool).collect(),
            part: Placement { origin, ..Placement::default() },
            ..self
        })
    }

    fn rotary_table(&self, rotary: Rotary, about: Unit<Vector3<f64>>, centre: Point3<f64>) -> Option<Chain> {
        let axis = self.axes.find(rotary.letter as u8)?;
        Some(Chain(vec![AxisLink::rotary(axis, about, centre, f64::from(rotary.sign))]))
    }
}
