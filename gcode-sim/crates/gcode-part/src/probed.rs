//! The part as a touch probe meets it, read from a job file of any family.
use super::nominal::NominalPart;
use super::surface::Surface;
use crate::job::{Job, Rotary};
use crate::reader::FileError;

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
