//! Tools that go deeper than their flutes or their length allow: shank, holder or spindle reach the part.
use super::*;
use crate::findings::TOOL_SHORT;
use crate::machine::{PointShape, TOUCH_DEPTH, Tool};
use crate::verify::hole_cuts::Cut;
use crate::verify::outline::{CutShape, Outline};
use gcode_lang::motion::Backtrace;

/// Part of a tool above its flutes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ToolPart {
    Shank,
    Holder,
    Spindle,
}

/// A part of a tool that reaches the metal in a hole.
struct Collision<'a> {
    nominal: usize,
    /// Depth of its lower end, mm.
    depth: f64,
    backtrace: &'a Backtrace,
}

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, .. } = inspection;
    let parts: BTreeMap<u32, Vec<(ToolPart, f64, f64)>> = machine
        .tools
        .iter()
        .map(|tool| (tool.number, parts(tool)))
        .filter(|(_, all)| !all.is_empty())
        .collect();
    if parts.is_empty() {
        return;
    }
    let mut collisions: BTreeMap<(u32, ToolPart), Vec<Collision<'_>>> = BTreeMap::new();
    for (pair, nominal, drilled) in comparison.matched() {
        let far = pair.from_far_side.map(|index| &comparison.actual[index]);
        for drilled in [Some(drilled), far].into_iter().flatten() {
            let mut outline = None;
            for cut in Cut::all(nominal, drilled, machine) {
                let number = cut.pass.tool.unwrap_or_default();
                for (part, height, radius) in parts.get(&number).into_iter().flatten() {
                    let depth = cut.tip - height;
                    if depth <= TOUCH_DEPTH {
                        continue;
                    }
                    let outline = outline.get_or_insert_with(|| side_outline(nominal, drilled));
                    if is_wider(*radius, depth, &cut, outline.as_ref(), comparison.tolerances.diameter) {
                        let found = Collision { nominal: pair.nominal, depth, backtrace: cut.pass.backtrace };
                        collisions.entry((number, *part)).or_default().push(found);
                    }
                }
            }
        }
    }
    for ((number, part), all) in collisions {
        let Some(tool) = machine.find_tool(number) else { continue };
        let holes = all.chunk_by(|one, other| one.nominal == other.nominal).count();
        let Some(deepest) = all.iter().reduce(|best, one| if best.depth < one.depth { one } else { best })
        else {
            continue;
        };
        let more = match holes {
            1 => String::new(),
            2 => " (and in 1 more hole)".to_owned(),
            _ => format!(" (and in {} more holes)", holes - 1),
        };
        let id = comparison.id(deepest.nominal);
        let (message, help) = describe(tool, part, deepest.depth, &format!("in hole {id}{more}"));
        let finding =
            Diagnostic::new(&TOOL_SHORT, message).help(help).with_backtrace(deepest.backtrace.clone());
        findings.add(Subject::Motion, finding);
    }
}

/// Returns the parts of a tool that must not reach the metal, each with the height of its lower end above the tip and its
/// radius, mm.
fn parts(tool: &Tool) -> Vec<(ToolPart, f64, f64)> {
    let Tool { flute_length, shank_diameter, holder_diameter, holder_length, .. } = tool;
    // A length of 0 means that the tip is programmed.
    let length = tool.length.filter(|length| 0.0 < *length);
    let shank =
        flute_length.zip(*shank_diameter).filter(|(flutes, _)| length.is_none_or(|all| *flutes < all));
    let holder = length.zip(holder_diameter.zip(*holder_length));
    let all = [
        shank.map(|(flutes, diameter)| (ToolPart::Shank, flutes, diameter / 2.0)),
        holder.map(|(length, (diameter, height))| (ToolPart::Holder, length - height, diameter / 2.0)),
        length.map(|length| (ToolPart::Spindle, length, f64::INFINITY)),
    ];
    all.into_iter().flatten().collect()
}

/// Returns the outline of a hole on the side from which it is drilled; `None` if its diameter is unknown.
fn side_outline(nominal: &Hole, drilled: &DrilledHole) -> Option<Outline> {
    match drilled.axis.dot(&Vector3::from(nominal.axis)) < 0.0 {
        true => Outline::of_far_side(nominal),
        false => Outline::of(nominal, 0.0),
    }
}

/// Returns true if a part of a tool is wider than the hole above a depth. A mill takes it round its circle.
fn is_wider(radius: f64, depth: f64, cut: &Cut<'_>, outline: Option<&Outline>, tolerance: f64) -> bool {
    let circle = cut.pass.cut.milled.map_or(0.0, |circle| circle.radius);
    let shape = CutShape { radius, path: circle, start: 0.0, tip: depth, point: PointShape::Flat };
    match outline {
        Some(outline) => exceeds(-2.0 * outline.margin(&shape), tolerance),
        // Nothing is known of a hole without a diameter, but it is no wider than the spindle.
        None => radius.is_infinite(),
    }
}

/// Returns message and help of a collision.
fn describe(tool: &Tool, part: ToolPart, depth: f64, place: &str) -> (String, &'static str) {
    let number = tool.number;
    let size = |diameter: Option<f64>| diameter.unwrap_or_default();
    match part {
        ToolPart::Shank => (
            format!(
                "the shank of T{number}, Φ{}, goes {depth:.1} mm deep {place}: the flutes are {} mm long",
                size(tool.shank_diameter),
                size(tool.flute_length)
            ),
            "use a tool with longer flutes or a thinner shank, or correct the machine file",
        ),
        ToolPart::Holder => (
            format!(
                "the holder of T{number}, Φ{}, goes {depth:.1} mm deep {place}: the tool sticks out by {} mm",
                size(tool.holder_diameter),
                size(tool.length) - size(tool.holder_length)
            ),
            "let the tool stick out farther, use a longer one, or correct the machine file",
        ),
        ToolPart::Spindle => (
            format!(
                "T{number} is {} mm long and goes {:.1} mm deep {place}: the spindle would enter the part",
                size(tool.length),
                size(tool.length) + depth
            ),
            "check that the length in the machine file is in mm, from the spindle gauge line to the tip; otherwise use \
             a longer tool",
        ),
    }
}
