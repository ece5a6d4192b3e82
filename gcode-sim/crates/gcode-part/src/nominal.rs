//! The nominal part, computed from the geometry of a job or read from a list of holes.
use super::csv_list;
use super::flutes::Flutes;
use super::read;
use super::reference::Reference;
use crate::job::Job;
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
        if let Some(job) = Self::job(text)? {
            return Self::from_job(&job);
        }
        let text = without_mark(text);
        if text.trim_start().starts_with('{') {
            return Reference::of_list(read::json(text)?).map(Self::Holes);
        }
        Reference::of_csv(csv_list::csv(text)?).map(Self::Holes)
    }

    /// Returns the job if the text is a job file; `None` for a list of holes.
    pub(super) fn job(text: &str) -> Result<Option<Job>, FileError> {
        let text = without_mark(text);
        if text.trim().is_empty() {
            let message = "the file is empty: give a hole list (JSON or CSV) or a job file".to_owned();
            return Err(FileError { line: None, message });
        }
        if text.trim_start().starts_with('{') {
            return Ok(None);
        }
        if let Some((line, message)) = csv_list::wrong_header(text) {
            return Err(FileError { line: Some(line), message });
        }
        if csv_list::is_csv(text) {
            return Ok(None);
        }
        if !text.contains("family") {
            let message = "neither a hole list (JSON or CSV) nor a job file with its key 'family'".to_owned();
            return Err(FileError { line: None, message });
        }
        Job::parse(text).map(Some)
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

/// Returns a text without its byte order mark.
fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}
