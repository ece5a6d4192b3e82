//! How a part is to be worked, as far as a reference says it: heights, the rotary and its clamp, what the tools run at.
use crate::job::{Clamp, Rotary};

/// What a program's motion is held against besides the holes that come of it. What isn't said is no demand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProcessLimits {
    /// From so far above the surface the tool feeds, mm.
    pub clearance: Option<f64>,
    /// The same where the job says it in so many words: no rapid ends nearer to the part.
    pub approach: Option<f64>,
    /// So far above the surface the tool is at least while the rotary table turns, mm.
    pub retract: Option<f64>,
    pub rotary: Option<Rotary>,
    /// The M codes that hold the rotary table and let it go: all that they do is known.
    pub clamp: Option<Clamp>,
    pub tools: Vec<ToolProcess>,
}

/// What is said of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolProcess {
    pub number: u32,
    /// The number of its length offset, H.
    pub offset: Option<u32>,
    /// r/min.
    pub speed: Option<f64>,
    /// Into the part, mm/min.
    pub feed: Option<f64>,
    /// It cuts no more than this before it comes back, mm.
    pub peck: Option<f64>,
}

impl ProcessLimits {
    /// What is said of a tool; where the program puts none in, the only one there is is in the spindle.
    pub fn tool_process(&self, tool: Option<u32>) -> Option<&ToolProcess> {
        match tool {
            Some(number) => self.tools.iter().find(|duty| duty.number == number),
            None => self.tools.first().filter(|_| self.tools.len() == 1),
        }
    }
}
