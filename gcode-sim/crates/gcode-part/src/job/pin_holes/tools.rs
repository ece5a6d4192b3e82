//! The tools of a pin-hole job and their assignment to holes.
use schemars::JsonSchema;
use serde::Deserialize;

use super::Tool;
use crate::job::{FileError, Reader};
use crate::reader::Spanned;
use crate::reader::bounds::{Bounded, FeedRate, Length, SpindleSpeed, ToolLength, ToolNumber};

/// A tool.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileTool {
    /// Its number, and that of its length offset; unique.
    number: Bounded<ToolNumber>,
    /// mm.
    diameter: Bounded<Length>,
    /// From the gauge line to the tip, mm [default: 0].
    length: Option<Bounded<ToolLength>>,
    /// A whole number of r/min.
    speed: Bounded<SpindleSpeed>,
    /// Into the hole, mm/min.
    feed: Bounded<FeedRate>,
    /// Out of the hole, mm/min [default: 200, or feed if that is more].
    retract_feed: Option<Bounded<FeedRate>>,
    /// Its name in messages and on the sheet [default: TOOL and its number].
    name: Option<String>,
}

/// The keys of a hole that select its tools.
pub(super) struct HoleToolSpec<'f> {
    pub(super) id: &'f str,
    pub(super) diameter: &'f Bounded<Length>,
    pub(super) tools: Option<&'f Spanned<Vec<i64>>>,
}

/// Feed into the hole in the paper, mm/min.
const DEFAULT_FEED: f64 = 10.0;
/// Feed out of the hole, mm/min; the tool does not cut there.
const DEFAULT_RETRACT_FEED: f64 = 200.0;
/// Speed in the paper, r/min.
const DEFAULT_SPEED: f64 = 1500.0;

impl FileTool {
    pub(super) fn tool(&self) -> Tool {
        let (number, feed) = (self.number.get(), self.feed.get());
        Tool {
            number: number as u32,
            diameter: self.diameter.get(),
            length: self.length.as_ref().map_or(0.0, Bounded::get),
            speed: self.speed.get(),
            feed,
            retract_feed: self.retract_feed.as_ref().map_or(feed.max(DEFAULT_RETRACT_FEED), Bounded::get),
            name: self.name.clone().unwrap_or_else(|| format!("TOOL {number}")),
        }
    }

    pub(super) fn number(&self) -> &Bounded<ToolNumber> {
        &self.number
    }
}

/// Returns the tools of the paper, a pair for each diameter of the job, and the tool numbers of each hole.
///
/// The paper uses a drill Φ5.9, then a three-flute end mill Φ6, at 1500 r/min and 10 mm/min along the axis.
pub(super) fn default_tools(
    reader: &Reader<'_>,
    holes: &[HoleToolSpec<'_>],
) -> Result<(Vec<Tool>, Vec<Vec<u32>>), FileError> {
    let mut diameters: Vec<f64> = Vec::new();
    let mut of_holes = Vec::new();
    for hole in holes {
        if let Some(tools) = hole.tools {
            return Err(reader.error(tools, "key 'hole.tools' names tools of [[tool]], but there are none"));
        }
        let diameter = hole.diameter.get();
        let index = diameters.iter().position(|d| *d == diameter).unwrap_or_else(|| {
            diameters.push(diameter);
            diameters.len() - 1
        });
        let first = 2 * index as u32 + 1;
        of_holes.push(vec![first, first + 1]);
    }
    let tools = diameters.iter().enumerate().flat_map(|(index, diameter)| {
        let first = 2 * index as u32 + 1;
        // Rounded to tenths of a micrometre, so that 6 gives 5.9 and not 5.8999….
        let drill = if *diameter > 1.0 { (diameter * 1e4 - 1e3).round() / 1e4 } else { diameter * 0.9 };
        [tool(first, drill, "DRILL"), tool(first + 1, *diameter, "END MILL")]
    });
    Ok((tools.collect(), of_holes))
}

fn tool(number: u32, diameter: f64, name: &str) -> Tool {
    Tool {
        number,
        diameter,
        length: 0.0,
        speed: DEFAULT_SPEED,
        feed: DEFAULT_FEED,
        retract_feed: DEFAULT_RETRACT_FEED,
        name: name.to_owned(),
    }
}

/// Returns the tool numbers of each hole: those it names, else every tool that is not larger than it.
///
/// # Errors
/// The last tool of a hole has another diameter, which would leave the hole too small or cut it too large.
pub(super) fn assign(
    reader: &Reader<'_>,
    tools: &[Tool],
    holes: &[HoleToolSpec<'_>],
) -> Result<Vec<Vec<u32>>, FileError> {
    holes.iter().map(|hole| assign_one(reader, tools, hole)).collect()
}

fn assign_one(reader: &Reader<'_>, tools: &[Tool], hole: &HoleToolSpec<'_>) -> Result<Vec<u32>, FileError> {
    let diameter = hole.diameter.get();
    let numbers: Vec<u32> = match hole.tools {
        Some(named) => {
            for number in named.as_ref() {
                if !tools.iter().any(|tool| i64::from(tool.number) == *number) {
                    let message = format!("key 'hole.tools' names tool {number}, which is not in [[tool]]");
                    return Err(reader.error(named, message));
                }
            }
            let order = tools.iter().filter(|tool| named.as_ref().contains(&i64::from(tool.number)));
            order.map(|tool| tool.number).collect()
        }
        None => tools.iter().filter(|tool| tool.diameter <= diameter).map(|tool| tool.number).collect(),
    };
    let last = numbers.last().and_then(|number| tools.iter().find(|tool| tool.number == *number));
    match last {
        Some(tool) if tool.diameter == diameter => Ok(numbers),
        Some(tool) => Err(reader.error(
            hole.diameter,
            format!(
                "key 'hole.diameter' is {diameter}: the last tool of hole '{}' is tool {} of diameter {}; \
                 add a [[tool]] of diameter {diameter} as the last one",
                hole.id, tool.number, tool.diameter
            ),
        )),
        None => Err(reader.error(
            hole.diameter,
            format!(
                "key 'hole.diameter' is {diameter}: every [[tool]] is larger; add one of diameter {diameter}"
            ),
        )),
    }
}
