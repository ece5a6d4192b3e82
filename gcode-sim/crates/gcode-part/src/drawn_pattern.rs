//! Holes of a pattern job: each point follows from the one before it by a displacement of the plane, and a frame carries it to
//! its place on the part.
//!
//! A displacement of the plane is a complex product and a sum, and a place is a rigid displacement of space: on a cylinder the
//! rotation about its axis, on a tilted face the product of three rotations.
use std::sync::Arc;

use nalgebra::{Complex, Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::feature::{Feature, FeatureKind};
use super::hole::{Hole, HoleList, Unit};
use super::nominal_axes::NominalAxes;
use super::reference::{ProcessLimits, Reference, ToolProcess};
use super::surface::Surface;
use crate::job::{HoleLayout, Operation, PatternJob, PatternPlace, PatternSpec, PatternStep, PatternTool};
use crate::reader::FileError;
use gcode_lang::units::Deg;

/// Returns the nominal holes of a pattern job.
///
/// # Errors
/// A hole with values that no reference may have.
pub(super) fn reference(job: &PatternJob) -> Result<Reference, FileError> {
    let place = job.place();
    let mut holes = Vec::new();
    for pattern in &job.patterns {
        let frames = frames(pattern, place).into_iter().zip(1u32..);
        let kept = frames.filter(|(_, number)| !pattern.skip.contains(number));
        holes.extend(kept.map(|(frame, number)| hole(job, pattern, number, &frame)));
    }
    let list = HoleList { unit: Unit::Mm, holes, stock: None, assumptions: None, stopped: None };
    let reference = Reference::of_list(list)?;
    let surface = match place {
        PatternPlace::Cylinder { diameter, .. } => Some(Surface::Cylinder { radius: diameter / 2.0 }),
        PatternPlace::Plate | PatternPlace::Face { .. } => None,
    };
    let process_limits =
        ProcessLimits { hole_axes: Arc::new(NominalAxes::of(&reference.holes)), ..process_limits(job) };
    Ok(Reference {
        position: Some(job.tolerance.position),
        depth: Some(job.tolerance.depth),
        surface,
        process_limits,
        ..reference
    })
}

fn process_limits(job: &PatternJob) -> ProcessLimits {
    let rotary = match job.place() {
        PatternPlace::Cylinder { rotary, .. } => Some(rotary),
        PatternPlace::Plate | PatternPlace::Face { .. } => None,
    };
    let limits = |tool: &PatternTool| ToolProcess {
        number: tool.number,
        offset: Some(tool.number),
        speed: Some(tool.speed),
        feed: tool.feed(),
        peck: Some(tool.increment()).filter(|_| tool.operation == Operation::Peck),
        depth: None,
    };
    ProcessLimits {
        clearance: Some(job.machine.clearance()),
        approach: job.machine.clearance,
        retract: job.machine.retract.filter(|_| rotary.is_some()),
        rotary,
        clamp: job.machine.clamp,
        tools: job.tools.iter().map(limits).collect(),
        ..ProcessLimits::default()
    }
}

/// Returns a hole in the frame of its entry.
fn hole(job: &PatternJob, pattern: &PatternSpec, number: u32, frame: &Isometry3<f64>) -> Hole {
    let steps = pattern.steps.iter().filter_map(|step| Some((step, job.tool(step.tool)?)));
    let steps: Vec<(&PatternStep, &PatternTool)> = steps.filter(|(_, tool)| !tool.only_spots()).collect();
    let deepest = steps.iter().map(|(step, _)| step.depth).fold(0.0, f64::max);
    let hole = Hole {
        id: Some(format!("{}-{number}", pattern.id)),
        entry: frame.transform_point(&Point3::origin()).coords.into(),
        axis: frame.transform_vector(&Vector3::z()).into(),
        depth: deepest,
        ..Hole::default()
    };
    match steps.as_slice() {
        [(step, tool)] if !tool.operation.is_threading() => {
            Hole { diameter: Some(step.diameter(tool)), ..hole }
        }
        _ => {
            let features = steps.iter().map(|(step, tool)| feature(step, tool, deepest)).collect();
            Hole { features, ..hole }
        }
    }
}

fn feature(step: &PatternStep, tool: &PatternTool, deepest: f64) -> Feature {
    let kind = match tool.operation {
        Operation::SpotDrill | Operation::Drill | Operation::Peck => FeatureKind::Drill,
        Operation::Bore => FeatureKind::Bore,
        Operation::MillCircle if step.depth < deepest => FeatureKind::Counterbore,
        Operation::MillCircle => FeatureKind::Bore,
        Operation::Tap | Operation::ThreadMill => FeatureKind::Tap,
    };
    Feature {
        diameter: step.diameter(tool),
        depth: Some(step.depth),
        pitch: Some(tool.increment()).filter(|_| kind == FeatureKind::Tap),
        hand: tool.hand(),
        ..Feature::of(kind)
    }
}

/// Returns the frame of every hole: its origin is the entry, its z points out of the part.
fn frames(pattern: &PatternSpec, place: PatternPlace) -> Vec<Isometry3<f64>> {
    match place {
        PatternPlace::Plate => points(pattern).into_iter().map(on_plane).collect(),
        PatternPlace::Face { face, .. } => {
            let [x, y, z] = face.origin;
            let [first, tilt, last] = face.angles.map(Deg);
            let rotation =
                turned(Vector3::z(), first) * turned(Vector3::x(), tilt) * turned(Vector3::z(), last);
            let plane = Isometry3::from_parts(Translation3::new(x, y, z), rotation);
            points(pattern).into_iter().map(|point| plane * on_plane(point)).collect()
        }
        PatternPlace::Cylinder { diameter, .. } => {
            let circumference = std::f64::consts::PI * diameter;
            let is_developed = matches!(pattern.layout(), HoleLayout::Circle(_) | HoleLayout::Arc(_));
            // The y of circles and arcs is a length on the developed surface, all others are angles.
            let per_y = if is_developed { 360.0 / circumference } else { 1.0 };
            let round = |point: Complex<f64>| {
                // From z towards y is the negative sense about x.
                let azimuth = Deg(pattern.y + (point.im - pattern.y) * per_y);
                turned(Vector3::x(), -azimuth) * Translation3::new(point.re, 0.0, diameter / 2.0)
            };
            points(pattern).into_iter().map(round).collect()
        }
    }
}

fn on_plane(point: Complex<f64>) -> Isometry3<f64> {
    Isometry3::translation(point.re, point.im, 0.0)
}

/// Returns the rotation about a unit vector.
fn turned(about: Vector3<f64>, angle: Deg) -> UnitQuaternion<f64> {
    let half = Deg(angle.0 / 2.0);
    UnitQuaternion::new_normalize(Quaternion::from_parts(half.cos(), about * half.sin()))
}

/// Returns the unit of a direction.
fn direction(angle: Deg) -> Complex<f64> {
    Complex::new(angle.cos(), angle.sin())
}

/// Returns the points in the plane of the pattern, those that are left out included.
fn points(pattern: &PatternSpec) -> Vec<Complex<f64>> {
    let zero = Complex::new(pattern.x, pattern.y);
    let round = |diameter: f64, holes: u32, first: f64, step: f64| {
        let (arm, step) = (direction(Deg(first)) * (diameter / 2.0), direction(Deg(step)));
        let arms = std::iter::successors(Some(arm), |arm| Some(arm * step));
        arms.take(holes as usize).map(|arm| zero + arm).collect()
    };
    let lattice = |columns: u32, rows: u32, [along, across]: [f64; 2], angle: f64| {
        let along = direction(Deg(angle)) * along;
        let across = direction(Deg(angle)) * Complex::i() * across;
        let starts = std::iter::successors(Some(zero), |start| Some(start + across)).take(rows as usize);
        let row =
            |start| std::iter::successors(Some(start), |point| Some(point + along)).take(columns as usize);
        starts.flat_map(row).collect()
    };
    match pattern.layout() {
        HoleLayout::Circle(circle) => {
            let sense = if circle.clockwise { -1.0 } else { 1.0 };
            round(circle.diameter, circle.holes, circle.angle, sense * 360.0 / f64::from(circle.holes))
        }
        HoleLayout::Arc(arc) => round(arc.diameter, arc.holes, arc.angle, arc.step),
        HoleLayout::Grid(grid) => lattice(grid.columns, grid.rows, grid.pitch, grid.angle),
        HoleLayout::Line(line) => lattice(line.holes, 1, [line.pitch, 0.0], line.angle),
        HoleLayout::Points(list) => list.iter().map(|[x, y]| zero + Complex::new(*x, *y)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;

    /// The entries and axes of a pattern with these lines, on a place with these.
    fn holes(place: &str, layout: &str) -> Vec<Hole> {
        let text = format!(
            "family = \"pattern\"\ncontrol = {{ dialect = \"fanuc-31i\", increment = \"IS-B\" }}\n\
             tolerance = {{ position = 0.1 }}\n{place}\n\
             [[tool]]\nnumber = 1\noperation = \"drill\"\ndiameter = 6.0\nspeed = 1000\nfeed = 100.0\n\
             [[pattern]]\nid = \"A\"\nmake = [{{ tool = 1, depth = 10.0 }}]\n{layout}\n"
        );
        match Job::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}")) {
            Job::Pattern(job) => reference(&job).unwrap().holes,
            other => panic!("another family: {other:?}"),
        }
    }

    fn near(found: [f64; 3], expected: [f64; 3]) {
        let off = found.iter().zip(&expected).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9, "{found:?} is not {expected:?}");
    }

    /// Four holes from -90° at radius 5: below, right, above, left of the centre; clockwise the right and the left change.
    #[test]
    fn a_circle_runs_either_way() {
        for (sense, expected) in [
            ("false", [[10.0, 15.0], [15.0, 20.0], [10.0, 25.0], [5.0, 20.0]]),
            ("true", [[10.0, 15.0], [5.0, 20.0], [10.0, 25.0], [15.0, 20.0]]),
        ] {
            let circle = format!(
                "x = 10.0\ny = 20.0\ncircle = {{ diameter = 10.0, holes = 4, angle = -90.0, clockwise = {sense} }}"
            );
            let found = holes("", &circle);
            found.iter().zip(expected).for_each(|(hole, [x, y])| near(hole.entry, [x, y, 0.0]));
            assert_eq!(found.len(), 4);
        }
    }

    /// A grid turned by 90°: its columns run up, its rows to the left. Holes 2 and 3 are left out.
    #[test]
    fn a_grid_turns_about_its_first_hole() {
        let grid =
            "x = 1.0\ngrid = { columns = 2, rows = 2, pitch = [10.0, 4.0], angle = 90.0 }\nskip = [2, 3]";
        let found = holes("", grid);
        assert_eq!(found.iter().map(|hole| hole.id.clone().unwrap()).collect::<Vec<_>>(), ["A-1", "A-4"]);
        near(found[0].entry, [1.0, 0.0, 0.0]);
        near(found[1].entry, [-3.0, 10.0, 0.0]);
    }

    /// On Φ40 a quarter turn is 10π mm of the surface: a circle of that radius has its top at 90°, where y is 20.
    #[test]
    fn a_circle_lies_on_the_developed_cylinder() {
        let place = "machine = { rotary = { letter = \"A\", sign = 1 } }\ncylinder = { diameter = 40.0 }";
        let circle = format!("circle = {{ diameter = {}, holes = 4 }}", 20.0 * std::f64::consts::PI);
        let found = holes(place, &circle);
        near(found[1].entry, [0.0, 20.0, 0.0]);
        near(found[1].axis, [0.0, 1.0, 0.0]);
        near(found[3].entry, [0.0, -20.0, 0.0]);
        near(found[0].entry, [10.0 * std::f64::consts::PI, 0.0, 20.0]);
        let line = holes(place, "y = -30.0\nline = { holes = 2, pitch = 120.0, angle = 90.0 }");
        near(line[1].entry, [0.0, 20.0, 0.0]);
    }

    /// I90 brings x to +y, J90 then z to +x and y to +z.
    #[test]
    fn a_face_turns_as_g68_2_does() {
        let place = "machine = { tilt = { letter = \"A\", sign = -1 }, rotary = { letter = \"C\", sign = -1 } }\n\
                     face = { origin = [50.0, 20.0, -10.0], angles = [90.0, 90.0, 0.0] }";
        let found = holes(place, "points = [[5.0, 7.0]]");
        near(found[0].entry, [50.0, 25.0, -3.0]);
        near(found[0].axis, [1.0, 0.0, 0.0]);
    }
}
