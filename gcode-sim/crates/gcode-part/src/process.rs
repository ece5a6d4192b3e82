//! Limits of the process that a reference specifies: heights, the rotary table and its clamp, cutting data of
//! the tools.
use crate::job::{Clamp, Rotary};

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
