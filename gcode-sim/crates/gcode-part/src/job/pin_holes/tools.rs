//! The tools of a pin-hole job and their assignment to holes.
use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::Deserialize;

use super::{HoleSpec, PinHoles};
use crate::job::{FileError, Reader};
use crate::reader::bounds::{Depth, FeedRate, Length, SpindleSpeed, ToolLength, ToolNumber};
use crate::reader::{FileKey, Optional};

/// A tool.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// Its number, and that of its length offset; unique.
    #[serde(with = "ToolNumber")]
    pub number: u32,
    /// Diameter, mm.
    #[serde(with = "Length")]
    pub diameter: f64,
    /// Length from the gauge line to the tip, mm.
    #[serde(default = "ToolLength::default", with = "ToolLength")]
    pub length: f64,
    /// Spindle speed, a whole number of r/min.
    #[serde(with = "SpindleSpeed")]
    pub speed: f64,
    /// Feed into the hole, mm/min.
    #[serde(with = "FeedRate")]
    pub feed: f64,
    /// Feed out of the hole, mm/min [default: 200, or feed if that is more].
    #[serde(default, with = "Optional::<FeedRate>")]
    retract_feed: Option<f64>,
    /// Depth of a peck, mm: after each the tool comes out of the hole [default: none, it drills in one go].
    #[serde(default, with = "Optional::<Depth>")]
    pub peck: Option<f64>,
    /// Depth of its tip in every hole, mm, as of a centre drill: less than that of the hole [default: that of the hole].
    #[serde(default, with = "Optional::<Depth>")]
    pub depth: Option<f64>,
    /// Its name in messages and on the sheet [default: TOOL and its number].
    name: Option<String>,
}

impl Tool {
    /// Returns the feed out of the hole, mm/min; the tool does not cut there.
    pub fn retract_feed(&self) -> f64 {
        self.retract_feed.unwrap_or(self.feed.max(200.0))
    }

    /// Returns the name in messages and on the set-up sheet.
    pub fn name(&self) -> String {
        self.name.clone().unwrap_or_else(|| format!("TOOL {}", self.number))
    }

    /// Returns the depth of its tip in a hole, mm.
    pub fn depth_in(&self, hole: &HoleSpec) -> f64 {
        self.depth.unwrap_or(hole.depth)
    }
}

impl PinHoles {
    /// Returns true if X and Y are programmed for the tool's tip instead of the head's pivot.
    pub fn is_tip_programmed(&self) -> bool {
        self.machine.head.pivot == 0.0 && self.tools.iter().all(|tool| tool.length == 0.0)
    }

    /// Adds the tools of the paper, a pair for each diameter of the job.
    ///
    /// The paper uses a drill Φ5.9, then a three-flute end mill Φ6, at 1500 r/min and 10 mm/min along the axis.
    pub(super) fn add_default_tools(&mut self, reader: &Reader<'_>) -> Result<(), FileError> {
        let mut diameters: Vec<f64> = Vec::new();
        for (place, hole) in self.holes.iter_mut().enumerate() {
            if hole.named_tools.is_some() {
                let message = "key 'hole.tools' names tools of [[tool]], but there are none";
                return Err(reader.error_at(&format!("hole.{place}.tools"), message));
            }
            let index = diameters.iter().position(|d| *d == hole.diameter).unwrap_or_else(|| {
                diameters.push(hole.diameter);
                diameters.len() - 1
            });
            let first = 2 * index as u32 + 1;
            hole.tools = vec![first, first + 1];
        }
        let pairs = diameters.iter().zip((1u32..).step_by(2)).flat_map(|(diameter, first)| {
            // Rounded to tenths of a micrometre, so that 6 gives 5.9 and not 5.8999….
            let drill = if *diameter > 1.0 { (diameter * 1e4 - 1e3).round() / 1e4 } else { diameter * 0.9 };
            [tool(first, drill, "DRILL"), tool(first + 1, *diameter, "END MILL")]
        });
        self.tools = pairs.collect();
        Ok(())
    }

    /// Assigns to each hole the tools that it names, else every tool that is not larger than it.
    ///
    /// # Errors
    /// The last tool of a hole has another diameter, which would leave the hole too small or cut it too large.
    pub(super) fn assign_tools(&mut self, reader: &Reader<'_>) -> Result<(), FileError> {
        let tools = &self.tools;
        if tools.is_empty() {
            return Err(reader.error_at("hole.0.id", "'tool' is empty: remove it, or add a [[tool]]"));
        }
        let mut numbers = BTreeSet::new();
        if let Some(index) = tools.iter().position(|tool| !numbers.insert(tool.number)) {
            let message = format!("key 'tool.number': {} is used twice", tools[index].number);
            return Err(reader.error_at(&format!("tool.{index}.number"), message));
        }
        for (place, hole) in self.holes.iter_mut().enumerate() {
            let names = |tool: &Tool, named: &[i64]| named.contains(&i64::from(tool.number));
            let of_hole: Vec<&Tool> = match &hole.named_tools {
                Some(named) => {
                    let is_known = |number: &i64| tools.iter().any(|tool| names(tool, &[*number]));
                    if let Some(number) = named.iter().find(|number| !is_known(number)) {
                        let message =
                            format!("key 'hole.tools' names tool {number}, which is not in [[tool]]");
                        return Err(reader.error_at(&format!("hole.{place}.tools"), message));
                    }
                    tools.iter().filter(|tool| names(tool, named)).collect()
                }
                None => tools.iter().filter(|tool| tool.diameter <= hole.diameter).collect(),
            };
            let diameter = hole.diameter;
            let allowed = match of_hole.last() {
                Some(last) => format!(
                    "the last tool of hole '{}' is tool {} of diameter {}; add a [[tool]] of diameter \
                     {diameter} as the last one",
                    hole.id, last.number, last.diameter
                ),
                None => format!("every [[tool]] is larger; add one of diameter {diameter}"),
            };
            let is_made = of_hole.last().is_some_and(|last| last.diameter == diameter);
            reader.check(is_made, &format!("hole.{place}.diameter"), diameter, allowed)?;
            for tool in &of_hole {
                check_depth(reader, tools, tool, hole, of_hole.last().is_some_and(|last| last == tool))?;
            }
            hole.tools = of_hole.iter().map(|tool| tool.number).collect();
        }
        Ok(())
    }
}

/// Checks that a tool with a depth of its own stays above the bottom of a hole, which the hole's last tool makes.
fn check_depth(
    reader: &Reader<'_>,
    tools: &[Tool],
    tool: &Tool,
    hole: &HoleSpec,
    is_last: bool,
) -> Result<(), FileError> {
    let Some(depth) = tool.depth else { return Ok(()) };
    let index = tools.iter().position(|one| one.number == tool.number).unwrap_or_default();
    let key = format!("tool.{index}.depth");
    if is_last {
        let message = format!(
            "key 'tool.depth' is for tools before the last one of a hole: tool {} finishes hole '{}', whose own depth counts; \
             remove it",
            tool.number, hole.id
        );
        return Err(reader.error_at(&key, message));
    }
    let allowed = format_args!("below the depth {} mm of hole '{}'", hole.depth, hole.id);
    reader.check(depth < hole.depth, &key, depth, allowed)
}

fn tool(number: u32, diameter: f64, name: &str) -> Tool {
    Tool {
        number,
        diameter,
        length: ToolLength::default(),
        speed: 1500.0,
        feed: 10.0,
        retract_feed: None,
        peck: None,
        depth: None,
        name: Some(name.to_owned()),
    }
}
