//! The work zero of patterns: the entries of the holes in the coordinates of the program, and the offsets in words.
use gcode_draw::{Align, Pen};
use gcode_inspect::verify::Verdict;
use gcode_lang::units::Deg;
use gcode_part::job::{HomeReturn, PatternJob, PatternPlace};
use gcode_sim::report::figures::short;
use maud::Markup;

use super::drawing::Drawing;

/// Width of the field of holes, paper units.
const FIELD: f64 = 300.0;

/// Returns the offsets and signs in words.
pub(super) fn words(job: &PatternJob) -> Vec<String> {
    let mut all = match job.place() {
        PatternPlace::Plate => {
            vec!["G54: X0 Y0 is the zero point of the drawing, Z0 the surface of the plate.".to_owned()]
        }
        PatternPlace::Cylinder { diameter, rotary } => vec![
            format!(
                "G54: X0 is the zero point of the drawing, Y0 the axis of the cylinder, Z0 its surface, {} mm from the axis.",
                short(diameter / 2.0)
            ),
            format!(
                "{0} rotates about X; {0} = {1}y of the drawing. {0}0 has angle 0 on top, and positive angles lie \
                 towards Y+.",
                rotary.letter,
                if rotary.sign < 0 { "−" } else { "" }
            ),
        ],
        PatternPlace::Face { face, tilt, rotary } => {
            let [x, y, z] = face.origin.map(short);
            let [i, j, k] = face.angles.map(short);
            vec![
                format!(
                    "G54 is the zero point of the part with {}0 and {}0; in this job both axes go through it.",
                    tilt.letter, rotary.letter
                ),
                format!(
                    "The face begins at X{x} Y{y} Z{z} and is turned by I{i} J{j} K{k}: G68.2, then G53.1."
                ),
            ]
        }
    };
    if let Some(clamp) = job.machine.clamp {
        all.push(format!("M{} releases the rotary before it rotates, M{} clamps it.", clamp.off, clamp.on));
    }
    let home = match job.machine.home {
        HomeReturn::G28 => Some("G91 G28 Z0."),
        HomeReturn::G53 => Some("G53 G00 Z0."),
        HomeReturn::None => None,
    };
    all.push(home.map_or_else(
        || {
            "Before a tool change the program leaves Z at the retract height: M06 must retract by itself."
                .to_owned()
        },
        |block| format!("Z goes home before each tool change and at the end: {block}"),
    ));
    all.push("Tool lengths: H of each tool has its own number, called by G43.".to_owned());
    all.push(format!(
        "Between holes the tool is {} mm above the surface: clamps and fixtures end below that. Start with the tool \
         clear of the part.",
        short(job.machine.retract())
    ));
    all
}

/// Draws the entries from above: on a cylinder the angle is up, elsewhere y of the part.
pub(super) fn drawing(job: &PatternJob, verdict: &Verdict) -> Markup {
    let is_cylinder = matches!(job.place(), PatternPlace::Cylinder { .. });
    let point = |[x, y, z]: [f64; 3]| if is_cylinder { [x, Deg::atan2(y, z).0] } else { [x, y] };
    let points: Vec<_> = verdict.holes.iter().map(|hole| point(hole.nominal.entry)).collect();
    let reach = |at: usize| {
        let values = points.iter().map(|point| point[at]);
        values.fold([0.0f64, 0.0f64], |[low, high], value| [low.min(value), high.max(value)])
    };
    let ([left, right], [bottom, top]) = (reach(0), reach(1));
    let unit = ((right - left).max(top - bottom) / FIELD).max(1e-3);
    let height = (top - bottom) / unit + 90.0;
    let mut drawing = Drawing::new([70.0 - left / unit, 45.0 + top / unit], height, unit);
    drawing.line(Pen::Centre, [[left - 30.0 * unit, 0.0], [right + 30.0 * unit, 0.0]]);
    drawing.line(Pen::Centre, [[0.0, bottom - 25.0 * unit], [0.0, top + 25.0 * unit]]);
    drawing.text([right, 0.0], 34.0, -4.0, Align::Left, "X");
    let up = if is_cylinder { "angle, degrees" } else { "Y" };
    drawing.text([0.0, top], 0.0, 30.0, Align::Centre, up);
    drawing.zero([0.0, 0.0], 12.0, -20.0, "G54");
    for (hole, place) in verdict.holes.iter().zip(&points) {
        // A width in mm has no meaning along an axis of angles.
        let radius = widest(job, &hole.id).filter(|_| !is_cylinder).map_or(4.0 * unit, |width| width / 2.0);
        drawing.circle(*place, radius);
    }
    drawing.markup("The entries of the holes from above with the work zero")
}

/// Returns the largest diameter that the tools make in a hole, mm.
fn widest(job: &PatternJob, hole: &str) -> Option<f64> {
    let (id, _) = hole.rsplit_once('-')?;
    let pattern = job.patterns.iter().find(|pattern| pattern.id == id)?;
    let widths = pattern.steps.iter().filter_map(|step| Some(step.diameter(job.tool(step.tool)?)));
    widths.reduce(f64::max)
}
