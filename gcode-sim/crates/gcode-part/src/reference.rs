//! Nominal holes, computed from the geometry of a job or read from a list.
use super::hole::{Hole, HoleList, Unit};
use super::pattern::Pattern;
use super::process::ProcessLimits;
use super::read;
use super::surface::Surface;
use crate::reader::FileError;

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
