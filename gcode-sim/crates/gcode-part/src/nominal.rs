//! The nominal part, computed from the geometry of a job or read from a list of holes.
use super::csv_list;
use super::flutes::Flutes;
use super::read;
use super::reference::Reference;
use super::surface::Surface;
use crate::job::{Job, Rotary};
use crate::reader::FileError;

/// Nominal part, the reference of `verify`.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a program has one part")]
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
        if let Some((line, message)) = csv_list::wrong_header(text) {
            return Err(FileError { line: Some(line), message });
        }
        if csv_list::is_csv(text) {
            return Reference::of_csv(csv_list::csv(text)?).map(Self::Holes);
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
            Job::Pattern(job) => super::drawn_pattern::reference(job).map(Self::Holes),
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
