//! The part as a probe finds it on the machine, read from a job file of any family.
use super::nominal::NominalPart;
use super::reference::ReferenceError;
use super::surface::Surface;
use crate::job::{Job, Rotary};

/// A surface that is there to be touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbedPart {
    pub surface: Surface,
    /// Of the stylus ball, mm, where the job says it.
    pub radius: Option<f64>,
    /// The axis that its programs turn it by, where they measure while it turns.
    pub rotary: Option<Rotary>,
}

impl ProbedPart {
    /// Reads a job file's text.
    pub fn parse(text: &str) -> Result<Self, ReferenceError> {
        let told = |e: crate::reader::FileError| ReferenceError { line: e.line, message: e.message };
        let job = Job::parse(text).map_err(told)?;
        if let Job::Alignment(job) = job {
            let surface = Surface::Ellipsoid { a: job.surface.a, b: job.surface.b };
            return Ok(Self { surface, radius: Some(job.probe_radius), rotary: Some(job.machine.rotary) });
        }
        let surface = NominalPart::from_job(&job)?.into_holes().and_then(|reference| reference.surface);
        let message = "this family's part has no surface to probe".to_owned();
        let surface = surface.ok_or(ReferenceError { line: None, message })?;
        Ok(Self { surface, radius: None, rotary: None })
    }
}
