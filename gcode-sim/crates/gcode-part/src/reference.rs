//! Nominal holes with their tolerances, and the limits of the process.
use std::sync::Arc;

use super::csv_list::CsvList;
use super::entry_planes::{EntryPlanes, Metal};
use super::hole::{Hole, HoleList, Unit};
use super::nominal_axes::NominalAxes;
use super::pattern::Pattern;
use super::read;
use super::stock::Stock;
use super::surface::Surface;
use crate::job::{Clamp, Rotary};
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
    /// Solid material of the part, if it is not that inside the surface.
    pub stock: Option<Stock>,
    /// Limits of the process that the reference specifies.
    pub process_limits: ProcessLimits,
    /// Nominal relation of neighbouring holes; `None` for parts without a pattern.
    pub pattern: Option<Pattern>,
    /// Holes whose depth a list leaves out, by their indices: those of the program count, and are not compared.
    pub open_depths: Vec<usize>,
    /// What the reader of a list took for granted, in one sentence.
    pub note: Option<String>,
    /// Columns of a list that the reader does not use, but for remarks: statements of the drawing that nothing compares.
    pub unread: Vec<String>,
}

impl Reference {
    /// Returns the reference of a hole list. Holes without an id get `#` and their number.
    ///
    /// # Errors
    /// A list without holes, values that are not finite or not positive, axes that are not unit vectors, and duplicate ids.
    pub fn of_list(list: HoleList) -> Result<Self, FileError> {
        let list = list.in_mm();
        if let Some(stopped) = list.stopped {
            let message = format!("the list is of a run that stopped: {stopped}");
            return Err(FileError { line: None, message });
        }
        if list.holes.is_empty() {
            return Err(FileError {
                line: None,
                message: "holes: none; a reference needs one at least".into(),
            });
        }
        if let Some(fault) = list.stock.as_ref().and_then(Stock::fault) {
            return Err(FileError { line: None, message: format!("stock: {fault}") });
        }
        let holes = read::check_all(list.holes)?;
        let hole_axes = Arc::new(NominalAxes::of(&holes));
        Ok(Self {
            holes,
            stock: list.stock,
            process_limits: ProcessLimits { hole_axes, ..ProcessLimits::default() },
            ..Self::without_holes()
        })
    }

    /// Returns the reference of a program for which none is named: it has no hole. Only the motion is judged, and each hole that
    /// the program makes is extra.
    pub fn without_holes() -> Self {
        Self {
            holes: Vec::new(),
            position: None,
            depth: None,
            surface: None,
            stock: None,
            process_limits: ProcessLimits::default(),
            pattern: None,
            open_depths: Vec::new(),
            note: None,
            unread: Vec::new(),
        }
    }

    /// Returns the reference of a list read as CSV.
    pub(super) fn of_csv(list: CsvList) -> Result<Self, FileError> {
        let CsvList { holes, open_depths, note, unread } = list;
        Ok(Self { open_depths, note, unread, ..Self::of_list(holes)? })
    }

    /// Sets depths of holes, by their indices, whose list leaves them out.
    pub fn set_depths(&mut self, depths: impl IntoIterator<Item = (usize, f64)>) {
        for (hole, depth) in depths {
            self.holes[hole].depth = depth;
        }
        self.process_limits.hole_axes = Arc::new(NominalAxes::of(&self.holes));
    }

    /// Returns what is known to be metal; `of_machine` is the stock of the machine file, which that of the reference
    /// overrides. Without either the body is the part inside its surface; a hole list has none.
    pub fn metal(&self, of_machine: Option<&Stock>) -> Metal {
        let stock = self.stock.as_ref().or(of_machine);
        Metal {
            body: self.body(of_machine),
            entries: Some(Arc::new(EntryPlanes::of(&self.holes, self.depth_tolerance()))),
            pockets: stock.map(Stock::pockets).unwrap_or_default(),
            voids: stock.map(Stock::voids).unwrap_or_default(),
        }
    }

    /// Returns the tolerance of a depth, either way, mm; ±0.1 by default.
    pub fn depth_tolerance(&self) -> f64 {
        self.depth.unwrap_or(0.1)
    }

    /// Returns the body of [`Self::metal`].
    pub fn body(&self, of_machine: Option<&Stock>) -> Option<Surface> {
        self.stock.as_ref().or(of_machine).map_or(self.surface, |stock| stock.body(self.surface))
    }

    /// Returns the hole list that `reference` writes.
    pub fn list(&self) -> HoleList {
        HoleList {
            unit: Unit::Mm,
            holes: self.holes.clone(),
            stock: self.stock.clone(),
            assumptions: None,
            stopped: None,
        }
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
    /// Axes of the nominal holes: a mill that plunges there drills, and passes nearer to another one are another hole's.
    pub hole_axes: Arc<NominalAxes>,
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
    /// Depth of its tip in every hole, mm; `None` for that of the hole or feature.
    pub depth: Option<f64>,
}

impl ProcessLimits {
    /// Returns the limits of a tool. If the program selects none, a single tool is taken to be in the
    /// spindle.
    pub fn tool_process(&self, tool: Option<u32>) -> Option<&ToolProcess> {
        match tool {
            Some(number) => self.tools.iter().find(|process| process.number == number),
            None => self.tools.first().filter(|_| self.tools.len() == 1),
        }
    }
}
