//! A tool that goes deeper than it is long would take the spindle into the part: told where the machine file has its length.
use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::{HoleFinding, HoleInspection};
use crate::findings::TOOL_SHORT;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;

/// The deepest cut of one tool.
struct Deepest<'a> {
    nominal: usize,
    depth: f64,
    place: &'a Backtrace,
    /// In so many holes it goes deeper than it is long.
    holes: usize,
}

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let HoleInspection { comparison, machine, .. } = inspection;
    // A length of 0 is that of a tool whose tip is programmed.
    let length = |tool: u32| machine.find_tool(tool)?.length.filter(|length| 0.0 < *length);
    let mut short: BTreeMap<u32, (f64, Deepest<'_>)> = BTreeMap::new();
    for pair in &comparison.pairs {
        let (wanted, found) = (&comparison.nominal[pair.nominal], &comparison.actual[pair.actual]);
        let below = |p: &Point3<f64>| (Point3::from(wanted.entry) - p).dot(&Vector3::from(wanted.axis));
        let last = (found.tool, below(&found.bottom()), &found.backtrace);
        let cuts = found
            .earlier_passes
            .iter()
            .map(|cut| (cut.tool, below(&cut.bottom), &cut.backtrace))
            .chain([last]);
        let mut deepest: BTreeMap<u32, (f64, &Backtrace)> = BTreeMap::new();
        for (tool, depth, place) in cuts {
            let Some((tool, _)) = tool.and_then(|tool| Some((tool, length(tool)?))) else { continue };
            let before = deepest.entry(tool).or_insert((depth, place));
            if before.0 < depth {
                *before = (depth, place);
            }
        }
        for (tool, (depth, place)) in deepest {
            let Some(length) = length(tool).filter(|length| *length < depth) else { continue };
            let new = Deepest { nominal: pair.nominal, depth, place, holes: 0 };
            let (_, so_far) = short.entry(tool).or_insert((length, new));
            let holes = so_far.holes + 1;
            if so_far.depth < depth {
                *so_far = Deepest { nominal: pair.nominal, depth, place, holes };
            }
            so_far.holes = holes;
        }
    }
    for (tool, (length, deepest)) in short {
        let Deepest { nominal: wanted, depth, place, holes } = deepest;
        let more = if holes > 1 { format!(" (and in {} more holes)", holes - 1) } else { String::new() };
        let message = format!(
            "T{tool} is {length} mm long and goes {depth:.1} mm deep in hole {}{more}: the spindle would \
             enter the part",
            comparison.id(wanted)
        );
        let finding = Diagnostic::new(&TOOL_SHORT, message)
            .help(
                "check that the length in the machine file runs from the spindle gauge line to the tip; \
                 otherwise use a longer tool",
            )
            .with_backtrace(place.clone());
        objections.push(HoleFinding::of_nominal(wanted, finding));
    }
}
