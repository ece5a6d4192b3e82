//! The wanted holes: computed from a job's geometry, or read from a list.
use super::hole::{Hole, HoleList, Unit};
use super::pattern::Pattern;
use super::process::ProcessLimits;
use super::read;
pub(crate) use super::read::ReferenceError;
use super::surface::Surface;

/// What the holes of a program are held against.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Every hole has an id here.
    pub holes: Vec<Hole>,
    /// Diameter of the tolerance zone in mm, where the reference says it.
    pub position: Option<f64>,
    /// How far a depth may be off, in mm, where the reference says it.
    pub depth: Option<f64>,
    pub surface: Option<Surface>,
    /// How the part is to be worked, as far as the reference says it.
    pub process_limits: ProcessLimits,
    /// What the holes' neighbours must be like, of a part where that matters.
    pub pattern: Option<Pattern>,
}

impl Reference {
    /// A list of holes, each given an id where it has none.
    pub fn of_list(list: HoleList) -> Result<Self, ReferenceError> {
        Ok(Self {
            holes: read::check_all(list.holes)?,
            position: None,
            depth: None,
            surface: None,
            process_limits: ProcessLimits::default(),
            pattern: None,
        })
    }

    /// The document that `reference` writes.
    pub fn list(&self) -> HoleList {
        HoleList { unit: Unit::Mm, holes: self.holes.clone() }
    }
}
