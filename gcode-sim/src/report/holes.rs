//! A list of holes as a table and as CSV.
use std::fmt::Write;

use super::verdict_table::append_assumptions;
use gcode_part::{Feature, HoleList, STOPPED, Total, Unit};

/// Point from which the depth of each hole counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The part's surface.
    Surface,
    /// Start of the cutting feed: the surface is unknown.
    FeedStart,
}

/// Formats one line per hole, lengths in mm.
pub(crate) fn text(list: &HoleList, origin: Origin) -> String {
    let (points, length, title) = match origin {
        Origin::Surface => (
            ["entry x", "entry y", "entry z"],
            "depth",
            "entry: on the surface; axis: unit vector out of the part; depth: from the entry",
        ),
        Origin::FeedStart => (
            ["fed from x", "fed from y", "fed from z"],
            "deepest",
            "fed from: start of the last tool's feed (R point level); axis: unit vector out of the part\n\
             deepest: from there to the deepest point of any tool",
        ),
    };
    let mut text = format!("{title}\n");
    let [x, y, z] = points;
    let _ = writeln!(
        text,
        "{:<6}{x:>11}{y:>11}{z:>11}  {:>9}{:>9}{:>9}{length:>9}{:>8}  from",
        "hole", "axis i", "axis j", "axis k", "Φ"
    );
    for (index, hole) in list.holes.iter().enumerate() {
        let name = hole.id.clone().unwrap_or_else(|| (index + 1).to_string());
        let [x, y, z] = hole.entry.map(plain);
        let [i, j, k] = hole.axis.map(plain);
        let diameter = hole.diameter.map_or_else(|| "-".to_owned(), |d| format!("{d:.2}"));
        let from = hole.from.as_ref().map_or_else(String::new, |from| {
            let tool = from.tool.map(|tool| format!(" T{tool}")).unwrap_or_default();
            format!("{}:{}{tool}", from.program, from.line)
        });
        let _ = writeln!(
            text,
            "{name:<6}{x:>11.4}{y:>11.4}{z:>11.4}  {i:>9.5}{j:>9.5}{k:>9.5}{:>9.3}{diameter:>8}  {from}",
            hole.depth
        );
    }
    let plural = if list.holes.len() == 1 { "" } else { "s" };
    let _ = writeln!(text, "{} hole{plural}, mm, in the part's frame", list.holes.len());
    append_assumptions(
        &mut text,
        list.assumptions.as_deref().unwrap_or_default(),
        Total::Holes(list.holes.len()),
    );
    text
}

/// Formats the columns of a reference in CSV; the last line states that the run stopped.
pub(crate) fn csv(list: &HoleList) -> String {
    let has_features = list.holes.iter().any(|hole| !hole.features.is_empty());
    let unit = if list.unit == Unit::Inch { " [inch]" } else { "" };
    let mut text = format!("id,x{unit},y{unit},z{unit},i,j,k,depth{unit},diameter{unit}");
    let has_through = list.holes.iter().any(|hole| hole.through);
    text.push_str(if has_features { ",features" } else { "" });
    text.push_str(if has_through { ",through\n" } else { "\n" });
    for (index, hole) in list.holes.iter().enumerate() {
        let id = hole.id.clone().unwrap_or_else(|| (index + 1).to_string());
        let quoted =
            if id.contains([',', '"', '\n']) { format!("\"{}\"", id.replace('"', "\"\"")) } else { id };
        let numbers = hole.entry.iter().chain(&hole.axis).map(|v| plain(*v).to_string()).collect::<Vec<_>>();
        let diameter = hole.diameter.map(|d| d.to_string()).unwrap_or_default();
        let _ = write!(text, "{quoted},{},{},{diameter}", numbers.join(","), hole.depth);
        if has_features {
            let features = hole.features.iter().map(Feature::cell).collect::<Vec<_>>();
            let _ = write!(text, ",{}", features.join("; "));
        }
        if has_through {
            text.push_str(if hole.through { ",yes" } else { "," });
        }
        text.push('\n');
    }
    if let Some(sentence) = &list.stopped {
        let _ = writeln!(text, "{STOPPED}{sentence}");
    }
    text
}

/// Replaces −0 and rounding residues by 0.
fn plain(value: f64) -> f64 {
    if value.abs() < 5e-13 { 0.0 } else { value }
}
