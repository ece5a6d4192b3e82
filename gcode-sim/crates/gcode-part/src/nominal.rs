//! The nominal part, computed from the geometry of a job or read from a list of holes, and the limits of the process.
use super::flutes::Flutes;
use super::hole::{Hole, HoleList, Unit};
use super::honeycomb::Pattern;
use super::read;
use super::surface::Surface;
use crate::job::{Clamp, Job, Rotary};
use crate::reader::FileError;

/// Nominal part, the reference of `verify`.
#[derive(Clone, Debug, PartialEq)]
pub enum NominalPart {
    /// Holes, each with its nominal position.
    Holes(Reference),
    /// The flutes of a burr.
    Flutes(Flutes),
}

impl NominalPart {
    /// Parses a job file, or a list of holes as JSON or CSV. The start of the text decides, because it may
    /// come from a pipe.
    ///
    /// # Errors
    /// Text that is none of these, an invalid list or job, and a job of the family `alignment`.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim().is_empty() {
            let message = "the file is empty: give a hole list (JSON or CSV) or a job file".to_owned();
            return Err(FileError { line: None, message });
        }
        if text.trim_start().starts_with('{') {
            return Reference::of_list(read::json(text)?).map(Self::Holes);
        }
        if read::is_csv(text) {
            return Reference::of_list(read::csv(text)?).map(Self::Holes);
        }
        if read::has_semicolons(text) {
            let message = "the columns are separated by ';': use ',' between them, and points in the numbers";
            return Err(FileError { line: Some(1), message: message.to_owned() });
        }
        if !text.contains("family") {
            let message = "neither a hole list (JSON or CSV) nor a job file with its key 'family'".to_owned();
            return Err(FileError { line: None, message });
        }
        Self::from_job(&Job::parse(text)?)
    }

    /// Returns the nominal part computed from the geometry of a job.
    ///
    /// # Errors
    /// A job of the family `alignment`, which makes no part, and holes that are impossible on the surface.
    pub fn from_job(job: &Job) -> Result<Self, FileError> {
        match job {
            Job::PinHoles(job) => super::pin_holes::reference(job).map(Self::Holes),
            Job::Honeycomb(job) => super::honeycomb::reference(job).map(Self::Holes),
            Job::Burr(job) => Ok(Self::Flutes(Flutes::from_job(job))),
            Job::Alignment(_) => {
                let message = "the family 'alignment' measures the position of a part and makes nothing, \
                               so there is no reference to verify against: run its programs with gcode-sim \
                               run --part JOB.toml"
                    .to_owned();
                Err(FileError { line: None, message })
            }
        }
    }

    /// Returns the holes; `None` for a burr.
    pub fn into_holes(self) -> Option<Reference> {
        match self {
            Self::Holes(reference) => Some(reference),
            Self::Flutes(_) => None,
        }
    }
}

/// Nominal holes with their tolerances.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Holes, each with an id.
    pub holes: Vec<Hole>,
    /// Diameter of the tolerance zone, mm; `None` if the reference does not specify it.
    pub position: Option<f64>,
    /// Tolerance of a depth, either way, mm; `None` if the reference does not specify it.
    pub depth: Option<f64>,
    /// Surface of the part; `None` for a hole list.
    pub surface: Option<Surface>,
    /// Limits of the process that the reference specifies.
    pub process_limits: ProcessLimits,
    /// Nominal relation of neighbouring holes; `None` for parts without a pattern.
    pub pattern: Option<Pattern>,
}

impl Reference {
    /// Returns the reference of a hole list. Holes without an id get `#` and their number.
    ///
    /// # Errors
    /// Values that are not finite or not positive, axes that are not unit vectors, and duplicate ids.
    pub fn of_list(list: HoleList) -> Result<Self, FileError> {
        Ok(Self {
            holes: read::check_all(list.holes)?,
            position: None,
            depth: None,
            surface: None,
            process_limits: ProcessLimits::default(),
            pattern: None,
        })
    }

    /// Returns the hole list that `reference` writes.
    pub fn list(&self) -> HoleList {
        HoleList { unit: Unit::Mm, holes: self.holes.clone() }
    }
}

/// Limits for a program's motion. An unspecified value is `None` and is not checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProcessLimits {
    /// Height above the surface at which the feed begins, mm.
    pub clearance: Option<f64>,
    /// The clearance if the job specifies it explicitly: no rapid ends nearer to the part.
    pub approach: Option<f64>,
    /// Least height above the surface while the rotary table rotates, mm.
    pub retract: Option<f64>,
    /// Rotary table of the job.
    pub rotary: Option<Rotary>,
    /// M codes that clamp and release the rotary table; they have no other effect.
    pub clamp: Option<Clamp>,
    /// Limits of each tool.
    pub tools: Vec<ToolProcess>,
}

/// Limits of one tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolProcess {
    /// Number of the tool.
    pub number: u32,
    /// Number of the tool's length offset, H.
    pub offset: Option<u32>,
    /// Spindle speed, r/min.
    pub speed: Option<f64>,
    /// Feed into the part, mm/min.
    pub feed: Option<f64>,
    /// Largest depth of cut before a retract, mm.
    pub peck: Option<f64>,
}

impl ProcessLimits {
    /// Returns the limits of a tool. If the program selects none, a single tool is taken to be in the
    /// spindle.
    pub fn tool_process(&self, tool: Option<u32>) -> Option<&ToolProcess> {
        match tool {
            Some(number) => self.tools.iter().find(|duty| duty.number == number),
            None => self.tools.first().filter(|_| self.tools.len() == 1),
        }
    }
}

/// A surface for touch probes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbedPart {
    /// Surface of the part.
    pub surface: Surface,
    /// Radius of the stylus ball, mm; `None` if the job has none.
    pub radius: Option<f64>,
    /// Rotary axis of programs that measure while it rotates; `None` for other families.
    pub rotary: Option<Rotary>,
}

impl ProbedPart {
    /// Parses the text of a job file.
    ///
    /// # Errors
    /// An invalid job, and a family whose part has no surface.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let job = Job::parse(text)?;
        if let Job::Alignment(job) = job {
            let surface = Surface::Ellipsoid { a: job.surface.a, b: job.surface.b };
            return Ok(Self { surface, radius: Some(job.probe.radius), rotary: Some(job.machine.rotary) });
        }
        let surface = NominalPart::from_job(&job)?.into_holes().and_then(|reference| reference.surface);
        let message = "this family's part has no surface to probe".to_owned();
        let surface = surface.ok_or(FileError { line: None, message })?;
        Ok(Self { surface, radius: None, rotary: None })
    }
}
