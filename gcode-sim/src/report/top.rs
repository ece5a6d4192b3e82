//! Contents of the top view: actual holes and, with a reference, the verdict on each.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};

use super::figures::{count, with_sign};
use super::work_zeros::zeros;
use gcode_draw::{Cylinder, DrawnHole, HoleStatus, Side, TopView};
use gcode_inspect::holes::{AirStroke, DrilledHole};
use gcode_inspect::machine::{AxisLink, HeadKind, LinkMotion, Machine};
use gcode_inspect::verify::{Answer, Conclusion, Neighbours, Verdict};
use gcode_lang::motion::AxisIndex;
use gcode_lang::source::Span;
use gcode_part::Assumption;
use gcode_part::Feature;
use gcode_part::FeatureKind;
use gcode_part::Hole;
use gcode_part::Pattern;
use gcode_part::PointTree;
use gcode_part::Reference;
use gcode_part::Surface;
use gcode_part::Total;
use gcode_session::Simulation;

/// Builds the view of holes without a reference.
pub fn of_holes(
    name: &str,
    simulation: &Simulation,
    machine: &Machine,
    assumptions: &[Assumption],
) -> TopView {
    let rotary = Rotary::of(machine);
    let found = simulation.hole_list().holes;
    let side = side_along_holes(&found).unwrap_or_else(|| side(machine));
    let holes = simulation.extracted.holes.iter().zip(found).enumerate();
    let drawn =
        holes.zip(features_made(simulation, machine)).map(|((index, (found, hole)), features)| DrawnHole {
            actual: Some(Hole { features, ..hole }),
            rotary_angle: rotary.angle(found),
            further_angles: rotary.further_angles(found),
            ..blank_hole((index + 1).to_string(), HoleStatus::Unjudged)
        });
    let mut holes: Vec<DrawnHole> = drawn.collect();
    hide_constant_rotary(&mut holes);
    TopView {
        name: name.to_owned(),
        side,
        lines: assumption_lines(assumptions, Total::Holes(holes.len())).collect(),
        verdict: simulation.run.stop_sentence().map(|stop| (HoleStatus::Bad, format!("FAIL: {stop}"))),
        rotary: rotary.letter(),
        is_rotary_reversed: rotary.is_reversed(),
        holes,
        zeros: zeros(machine, [&simulation.run]),
        ..TopView::default()
    }
}

/// Largest height at which a feed still begins on the surface, mm.
const SAME_LEVEL: f64 = 1e-6;

/// Returns what the tools make of each hole: its drills, counterbores, threads. Without a known surface, as on a floor that the
/// program mills, the width of a countersink is unknown.
fn features_made(simulation: &Simulation, machine: &Machine) -> Vec<Vec<Feature>> {
    let body = machine.stock.as_ref().and_then(|stock| stock.body(None));
    let mut list = simulation.hole_list();
    body.iter().for_each(|body| list.enter_at(body));
    let holes = simulation.extracted.holes.iter().zip(list.holes);
    let features = holes.map(|(found, hole)| {
        let (entry, out) = (Point3::from(hole.entry), Vector3::from(hole.axis));
        let is_on_body = body.is_some() && (entry - found.entry).dot(&out) < SAME_LEVEL;
        let made = found.features(&entry, &out, machine).into_iter();
        made.filter(|feature| is_on_body || feature.kind != FeatureKind::Countersink).collect()
    });
    features.collect()
}

/// Builds the view of a verdict: actual and nominal, missing and extra holes.
pub fn of_verdict(
    name: &str,
    simulation: &Simulation,
    reference: &Reference,
    verdict: &Verdict,
    machine: &Machine,
) -> TopView {
    let rotary = Rotary::of(machine);
    let found = &simulation.extracted.holes;
    let by_id: BTreeMap<_, _> = reference.holes.iter().map(|hole| (hole.id.as_deref(), hole)).collect();
    let nominal = |id: &str| by_id.get(&Some(id)).copied();
    let judged = verdict.holes.iter().map(|hole| {
        let difference =
            hole.actual.diameter.zip(hole.nominal.diameter).map(|(actual, nominal)| actual - nominal);
        let remark = hole.error_codes.first().map(|code| match (*code, difference) {
            ("hole-depth", _) => format!("depth {}", with_sign(hole.depth_error)),
            ("hole-diameter", Some(difference)) => format!("diameter {}", with_sign(difference)),
            (other, _) => other.trim_start_matches("hole-").to_owned(),
        });
        DrawnHole {
            nominal: nominal(&hole.id).cloned(),
            actual: Some(found[hole.drilled_index].hole(no_location)),
            position_deviation: Some(hole.position_deviation),
            rotary_angle: rotary.angle(&found[hole.drilled_index]),
            further_angles: rotary.further_angles(&found[hole.drilled_index]),
            remarks: remark.into_iter().collect(),
            ..blank_hole(hole.id.clone(), if hole.ok { HoleStatus::Good } else { HoleStatus::Bad })
        }
    });
    let missing = verdict
        .missing
        .iter()
        .map(|id| DrawnHole { nominal: nominal(id).cloned(), ..blank_hole(id.clone(), HoleStatus::Missing) });
    let extra = verdict.extra.iter().map(|extra| {
        let from = extra.hole.from.as_ref();
        let id = from.map_or_else(String::new, |from| format!("{}:{}", from.program, from.line));
        DrawnHole { actual: Some(extra.hole.clone()), ..blank_hole(id, HoleStatus::Extra) }
    });
    let beside = holes_beside(simulation, reference, machine);
    let mut holes: Vec<DrawnHole> = judged.chain(missing).chain(extra).chain(beside).collect();
    hide_constant_rotary(&mut holes);
    TopView {
        name: name.to_owned(),
        side: side_along_holes(&reference.holes)
            .filter(|_| reference.surface.is_none())
            .unwrap_or_else(|| side(machine)),
        outline: reference.surface.and_then(outline),
        cylinder: cylinder(reference),
        lines: reference
            .pattern
            .iter()
            .map(closing_sentence)
            .chain(verdict.neighbours.iter().flat_map(neighbour_range))
            .chain(assumption_lines(
                &verdict.assumptions,
                Total::Holes(verdict.holes.len() + verdict.extra.len()),
            ))
            .collect(),
        verdict: Some(drawn_conclusion(&verdict.conclusion())),
        tolerance: (!verdict.is_of_motion).then_some(verdict.tolerance),
        rotary: rotary.letter(),
        is_rotary_reversed: rotary.is_reversed(),
        holes,
        zeros: zeros(machine, [&simulation.run]),
        shaft: shaft(reference),
        ..TopView::default()
    }
}

/// Returns a conclusion as the line of a picture, with the status that gives its colour.
pub(super) fn drawn_conclusion(conclusion: &Conclusion<'_>) -> (HoleStatus, String) {
    let status = match conclusion.answer {
        Answer::Pass => HoleStatus::Good,
        Answer::Fail => HoleStatus::Bad,
    };
    (status, conclusion.line())
}

/// Returns a hole without nominal, actual and remarks.
pub(super) fn blank_hole(id: String, status: HoleStatus) -> DrawnHole {
    DrawnHole {
        id,
        nominal: None,
        actual: None,
        status,
        position_deviation: None,
        rotary_angle: None,
        further_angles: Vec::new(),
        remarks: Vec::new(),
    }
}

/// Distance below which two strokes make one hole, and a stroke is one of a nominal hole, mm.
const SAME_PLACE: f64 = 0.5;

/// Length along a stroke within which every hole is, mm.
const ALL_HEIGHTS: f64 = 1e6;

/// Returns the holes that drilling cycles make beside the stated part, as in other vises: nothing judges them.
fn holes_beside(simulation: &Simulation, reference: &Reference, machine: &Machine) -> Vec<DrawnHole> {
    let is_on = |stroke: &AirStroke, entry: [f64; 3]| {
        (Point3::from(entry) - stroke.start).cross(&stroke.out).norm() < SAME_PLACE
    };
    let entries = PointTree::new(reference.holes.iter().map(|hole| Point3::from(hole.entry)));
    let is_listed = |stroke: &AirStroke| {
        let ends = [stroke.out, -stroke.out].map(|out| stroke.start + out * ALL_HEIGHTS);
        let margin = Vector3::repeat(SAME_PLACE);
        let (low, high) = (ends[0].inf(&ends[1]) - margin, ends[0].sup(&ends[1]) + margin);
        let mut is_listed = false;
        entries.in_box(&low, &high, &mut |hole| is_listed |= is_on(stroke, reference.holes[hole].entry));
        is_listed
    };
    let diameter =
        |number: Option<u32>| machine.tools.iter().find(|tool| Some(tool.number) == number)?.diameter;
    let mut made: Vec<(Hole, Span)> = Vec::new();
    for stroke in &simulation.extracted.air_strokes {
        if is_listed(stroke) {
            continue;
        }
        let (own, depth) = (diameter(stroke.tool), (stroke.start - stroke.bottom).norm());
        if let Some((hole, _)) = made.iter_mut().find(|(hole, _)| is_on(stroke, hole.entry)) {
            let below = (Point3::from(hole.entry) - stroke.bottom).dot(&stroke.out);
            (hole.depth, hole.diameter) =
                (hole.depth.max(below), hole.diameter.into_iter().chain(own).reduce(f64::max));
            continue;
        }
        let (entry, axis) = (stroke.start.coords.into(), stroke.out.into());
        made.push((Hole { entry, axis, depth, diameter: own, ..Hole::default() }, stroke.block));
    }
    let drawn = |(hole, block): (Hole, Span)| {
        let (program, line) = simulation.run.locate(block);
        DrawnHole { actual: Some(hole), ..blank_hole(format!("{program}:{line}"), HoleStatus::Unjudged) }
    };
    made.into_iter().map(drawn).collect()
}

/// Removes the angles of the rotary axes that are at 0 for every hole.
pub(super) fn hide_constant_rotary(holes: &mut [DrawnHole]) {
    if holes.iter().all(|hole| hole.rotary_angle.is_none_or(|turn| turn == 0.0)) {
        holes.iter_mut().for_each(|hole| hole.rotary_angle = None);
    }
    let all = holes.iter().flat_map(|hole| &hole.further_angles);
    let turned: BTreeSet<char> = all.filter(|(_, turn)| *turn != 0.0).map(|(letter, _)| *letter).collect();
    holes.iter_mut().for_each(|hole| hole.further_angles.retain(|(letter, _)| turned.contains(letter)));
}

/// Returns the next of 1, 2, 5, 10, 20, … from `value` on.
pub(super) fn round_up(value: f64) -> f64 {
    let decade = libm::pow(10.0, libm::floor(libm::log10(value)));
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| value <= step * decade * (1.0 + 1e-9));
    step.unwrap_or(10.0) * decade
}

/// Returns the equatorial and the polar radius of an ellipsoid.
pub(super) fn outline(surface: Surface) -> Option<[f64; 2]> {
    match surface {
        Surface::Ellipsoid { a, b } => Some([a, b]),
        Surface::Cylinder { .. } | Surface::Block { .. } | Surface::Rod(_) => None,
    }
}

/// Returns the side along which most holes point: seen across, a plate would be a line.
pub(super) fn side_along_holes(holes: &[Hole]) -> Option<Side> {
    let is_along = |hole: &Hole, side: Side| 0.99 < Vector3::from(hole.axis).dot(&side.towards()).abs();
    let are_most = |side: &Side| holes.len() < 2 * holes.iter().filter(|hole| is_along(hole, *side)).count();
    [Side::Y, Side::Z, Side::X].into_iter().find(are_most)
}

/// Returns the side of the spindle: +z for a fixed spindle along z, else +y.
pub(super) fn side(machine: &Machine) -> Side {
    match machine.head.kind {
        HeadKind::Fixed(out) if out.z > 0.99 => Side::Z,
        _ => Side::Y,
    }
}

pub(super) fn cylinder(reference: &Reference) -> Option<Cylinder> {
    match (reference.surface, reference.pattern) {
        (Some(Surface::Cylinder { radius }), Some(pattern)) => {
            let Pattern { diameter, length, rows, .. } = pattern;
            Some(Cylinder { outer: radius, radius: diameter / 2.0, length, rows })
        }
        _ => None,
    }
}

/// Returns the radius of a cylinder whose length is unknown.
fn shaft(reference: &Reference) -> Option<f64> {
    match (reference.surface, reference.pattern) {
        (Some(Surface::Cylinder { radius }), None) => Some(radius),
        _ => None,
    }
}

/// Returns `91 + 91 rows close with pitch 9.9659 (arc)`.
fn closing_sentence(pattern: &Pattern) -> String {
    let (half, metric) = (pattern.rows / 2, pattern.metric.name());
    format!("{half} + {half} rows close with pitch {:.4} ({metric})", pattern.pitch)
}

/// Returns the distances of the nearest and the farthest neighbours.
fn neighbour_range(neighbours: &Neighbours) -> Option<String> {
    let (min, max) = (neighbours.min.as_ref()?, neighbours.max.as_ref()?);
    Some(format!("neighbours {:.4} to {:.4} mm apart", min.distance, max.distance))
}

/// Number of assumptions that a picture lists.
const MAX_ASSUMPTIONS: usize = 3;

/// Returns a line for each of the first assumptions, and the number of the others; `total` is the number of all holes or
/// flutes.
pub(super) fn assumption_lines(
    assumptions: &[Assumption],
    total: Total,
) -> impl Iterator<Item = String> + '_ {
    let first = assumptions.iter().take(MAX_ASSUMPTIONS);
    let more = assumptions.len().saturating_sub(MAX_ASSUMPTIONS);
    let first = first.map(move |assumption| format!("assumes {}", assumption.sentence(total)));
    first.chain((0 < more).then(|| format!("and {}", count(more, "more assumption"))))
}

/// Locates no block: a picture shows none.
pub(super) fn no_location(_: gcode_lang::source::Span) -> (String, u32) {
    (String::new(), 0)
}

/// The rotary axes, whose angles are shown at each hole: the first of the table, the others of table and head.
pub(super) struct Rotary {
    first: Option<(AxisIndex, char, bool)>,
    further: Vec<(AxisIndex, char)>,
}

impl Rotary {
    pub(super) fn of(machine: &Machine) -> Self {
        let turns = |link: &&AxisLink| matches!(link.motion, LinkMotion::Rotary { .. });
        let letter = |link: &AxisLink| (link.axis, machine.axes.letter(link.axis));
        let mut of_table = machine.table.0.iter().filter(turns);
        let first = of_table.next().map(|link| (letter(link).0, letter(link).1, is_link_reversed(link)));
        let of_head = match &machine.head.kind {
            HeadKind::Axes { chain, .. } => chain.0.as_slice(),
            HeadKind::Free | HeadKind::Fixed(_) | HeadKind::Manual { .. } | HeadKind::Axis { .. } => &[],
        };
        Self { first, further: of_table.chain(of_head.iter().filter(turns)).map(letter).collect() }
    }

    pub(super) fn letter(&self) -> String {
        self.first.map_or_else(String::new, |(_, letter, _)| letter.to_string())
    }

    pub(super) fn is_reversed(&self) -> bool {
        self.first.is_some_and(|(_, _, backwards)| backwards)
    }

    pub(super) fn angle(&self, found: &DrilledHole) -> Option<f64> {
        self.first.map(|(axis, ..)| found.axis_position[axis])
    }

    pub(super) fn further_angles(&self, found: &DrilledHole) -> Vec<(char, f64)> {
        self.further.iter().map(|(axis, letter)| (*letter, found.axis_position[*axis])).collect()
    }
}

/// Returns true if the axis decreases about +x, the axis of every cylinder.
fn is_link_reversed(link: &AxisLink) -> bool {
    matches!(link.motion, LinkMotion::Rotary { about, .. } if link.sign * about.x < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holes(axes: &[[f64; 3]]) -> Vec<Hole> {
        let hole = |axis: &[f64; 3]| Hole {
            id: None,
            entry: [0.0; 3],
            axis: *axis,
            depth: 10.0,
            diameter: None,
            ..Hole::default()
        };
        axes.iter().map(hole).collect()
    }

    /// A spot of 90°, 3 deep, is 6 wide at the surface. That of the second hole is fed from −10 to −18: where the floor is that it
    /// counts from, is unknown.
    #[test]
    fn a_cone_below_the_surface_has_no_width() {
        let tool = |kind: &str| format!("[[tool]]\nkind = \"{kind}\"\n");
        let head = "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n";
        let stock = "[stock]\nkind = \"box\"\nmin = [0.0, 0.0, -40.0]\nmax = [50.0, 20.0, 0.0]\n";
        let spot = tool("spot-drill") + "number = 1\ndiameter = 10.0\npoint_angle = 90.0\n";
        let drill = tool("drill") + "number = 2\ndiameter = 5.0\npoint_angle = 180.0\n";
        let machine = Machine::parse(&format!("{head}{stock}{spot}{drill}")).unwrap();
        let text = "O1\nT1 M06\nS1000 M03\nG90 G54 G00 X10. Y10. Z50.\nG98 G81 Z-3. R2. F100.\nX30. Z-18. R-10.\nG80\n\
                    T2 M06\nS1000 M03\nG98 G81 X10. Y10. Z-10. R2. F100.\nX30. Z-25. R-10.\nG80\nM30\n";
        let request = gcode_session::Request::new("O1.nc", text.as_bytes(), machine);
        let simulation =
            gcode_session::simulate(&request, &mut gcode_lang::program::NoLibrary, None).unwrap();
        let made = features_made(&simulation, &request.machine);
        let cone = |hole: usize| made[hole].iter().find(|made| made.kind == FeatureKind::Countersink);
        assert_eq!((made.len(), cone(0).map(|cone| cone.diameter.round()), cone(1)), (2, Some(6.0), None));
    }

    #[test]
    fn a_part_is_seen_along_most_of_its_holes() {
        let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        assert_eq!(side_along_holes(&holes(&[z, z])), Some(Side::Z));
        assert_eq!(side_along_holes(&holes(&[[0.0, 0.0, -1.0]])), Some(Side::Z), "drilled from below");
        assert_eq!(side_along_holes(&holes(&[x, x, y])), Some(Side::X));
        assert_eq!(side_along_holes(&holes(&[y])), Some(Side::Y));
        // A tenth of a radian off z still counts as z, a fifth does not: cos 0.1 = 0.995, cos 0.2 = 0.980.
        assert_eq!(side_along_holes(&holes(&[[0.0, 0.0998, 0.9950]])), Some(Side::Z));
        assert_eq!(side_along_holes(&holes(&[[0.0, 0.1987, 0.9801]])), None);
        assert_eq!(side_along_holes(&holes(&[y, z])), None, "no more along one than along the other");
        assert_eq!(side_along_holes(&[]), None);
    }
}
