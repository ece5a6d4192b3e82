//! Holes of a honeycomb on a cylinder about x.
//!
//! Rows are laid round the cylinder. At the resulting pitch a hole is as far from its neighbours in the next
//! row as from those in its own.
//!
//! Part frame: x along the cylinder's axis, with the origin at the first hole of the first row; the first row
//! lies at +z, and azimuth counts from z towards y. Both senses give the same holes.
use std::sync::Arc;

use super::hole::Hole;
use super::nominal_axes::NominalAxes;
use super::pattern::{Pattern, point, solve_pitch};
use super::reference::{ProcessLimits, Reference, ToolProcess};
use super::surface::Surface;
use crate::job::{Cylinder, Drill, Honeycomb, Metric, Spacing};
use crate::reader::FileError;
use gcode_lang::units::Deg;

/// Limit of the number of holes, above that of any cylinder drilled hole by hole.
const MAX_HOLES: f64 = 200_000.0;

/// Returns the nominal holes of a honeycomb job.
///
/// # Errors
/// A pattern that does not close, or whose holes overlap or exceed the limit.
pub(super) fn reference(job: &Honeycomb) -> Result<Reference, FileError> {
    let pattern = pattern(job)?;
    let (outer, drill) = (job.cylinder.outer() / 2.0, job.drill);
    check_drillable(job, &pattern)?;
    let mut holes = Vec::new();
    for row in 0..pattern.rows {
        let azimuth = Deg(f64::from(row) * 360.0 / f64::from(pattern.rows));
        let start = if row % 2 == 0 { 0.0 } else { pattern.pitch / 2.0 };
        let places = (0u32..).map(|hole| (hole, start + f64::from(hole) * pattern.pitch));
        let name = format!("r{row}h");
        let (first, out) = (point(0.0, azimuth, outer), point(0.0, azimuth, 1.0));
        for (hole, x) in places.take_while(|(_, x)| *x <= job.cylinder.length) {
            holes.push(Hole {
                id: Some([name.as_str(), &hole.to_string()].concat()),
                entry: [x, first.y, first.z],
                axis: out.coords.into(),
                depth: drill.depth,
                diameter: Some(drill.diameter),
                ..Hole::default()
            });
        }
    }
    let process_limits =
        ProcessLimits { hole_axes: Arc::new(NominalAxes::of(&holes)), ..process_limits(job) };
    Ok(Reference {
        holes,
        position: Some(job.tolerance.position),
        depth: Some(job.tolerance.depth),
        surface: Some(Surface::Cylinder { radius: outer }),
        stock: None,
        process_limits,
        pattern: Some(pattern),
        open_depths: Vec::new(),
        unread: Vec::new(),
        note: None,
    })
}

fn process_limits(job: &Honeycomb) -> ProcessLimits {
    let Drill { speed, feed, depth, diameter, .. } = job.drill;
    ProcessLimits {
        clearance: Some(job.machine.clearance()),
        approach: job.machine.clearance,
        retract: job.machine.retract,
        rotary: Some(job.machine.rotary),
        clamp: job.machine.clamp,
        tools: vec![ToolProcess {
            number: job.drill.number(),
            offset: job.drill.number,
            speed,
            feed,
            // Shallower holes are drilled without pecks.
            peck: job.drill.peck.filter(|_| 3.0 * diameter < depth),
            depth: None,
        }],
        ..ProcessLimits::default()
    }
}

/// Returns the number of rows and the pitch at which all six neighbours are equally far.
fn pattern(job: &Honeycomb) -> Result<Pattern, FileError> {
    let (diameter, metric) = (job.cylinder.diameter, job.pattern.metric);
    let error = |message: String| Err(FileError { line: None, message });
    let (rows, asked) = match job.pattern.spacing() {
        Spacing::Divisions(divisions) => (2 * divisions, None),
        Spacing::Pitch(pitch) => match nearest_count(diameter, pitch) {
            Some(count) => (2 * count, Some(pitch)),
            None => {
                return error(format!(
                    "key 'pattern.pitch': {pitch} round diameter {diameter} gives more than {MAX_HOLES} \
                     rows: use a larger pitch"
                ));
            }
        },
    };
    if rows < 4 {
        return error(format!(
            "key 'pattern.pitch': fewer than two rows of one group fit round diameter {diameter}: use a smaller pitch"
        ));
    }
    let (Cylinder { length, bore, .. }, outer) = (job.cylinder, job.cylinder.outer());
    let pitch = solve_pitch(metric, diameter, rows);
    Ok(Pattern { metric, diameter, rows, pitch, specified_pitch: asked, length, outer, bore })
}

/// Returns the rows of each group whose closing pitch is nearest to the specified one; `None` if there are
/// too many.
///
/// The closing pitch of each count is measured on the developed surface, in either metric. Its difference
/// from the specified pitch adds up over the rows; the count with the least sum wins. Of two equal sums the
/// larger count wins, with the smaller pitch.
fn nearest_count(diameter: f64, asked: f64) -> Option<u32> {
    let too_far = |count: u32| asked < solve_pitch(Metric::Arc, diameter, 2 * count);
    // More rows mean a smaller pitch: the search finds the last count that is too far apart and the first
    // that is not.
    let (mut far, mut near) = (0, 1);
    while too_far(near) {
        if MAX_HOLES < f64::from(near) {
            return None;
        }
        (far, near) = (near, 2 * near);
    }
    while far + 1 < near {
        let middle = far + (near - far) / 2;
        if too_far(middle) { far = middle } else { near = middle }
    }
    if far == 0 {
        return Some(near);
    }
    let sum = |count: u32| f64::from(count) * (solve_pitch(Metric::Arc, diameter, 2 * count) - asked).abs();
    Some(if sum(far) < sum(near) { far } else { near })
}

/// Checks that the holes do not overlap, down to their bottoms in the material, and that their number is
/// within the limit.
fn check_drillable(job: &Honeycomb, pattern: &Pattern) -> Result<(), FileError> {
    let deepest = (job.cylinder.outer() / 2.0 - job.drill.depth).max(job.cylinder.bore / 2.0);
    let p = pattern.pitch;
    let apart = |x: f64, rows: f64, radius: f64| {
        (point(x, pattern.row_angle() * rows, radius) - point(0.0, Deg::ZERO, radius)).norm()
    };
    let error = |message: String| Err(FileError { line: None, message });
    for (x, rows, what) in
        [(p, 0.0, "in a row"), (p / 2.0, 1.0, "of neighbouring rows"), (0.0, 2.0, "of one group")]
    {
        let distance = apart(x, rows, deepest);
        if distance <= job.drill.diameter {
            return error(format!(
                "the holes overlap: with {} rows the pitch is {p:.3} mm, and holes {what} are \
                 {distance:.3} mm apart at radius {deepest:.3}, where they end, with a drill of {} mm: use \
                 a larger pitch, a smaller drill or depth",
                pattern.rows, job.drill.diameter
            ));
        }
    }
    let holes = f64::from(pattern.rows) * (job.cylinder.length / p + 1.0);
    if holes > MAX_HOLES {
        return error(format!(
            "the pattern has {holes:.0} holes, at most {MAX_HOLES}: use a larger pitch, or a part of the pattern"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::job::Job;

    fn job(changes: &[(&str, &str)]) -> Honeycomb {
        let mut text = String::from(
            "family = \"honeycomb\"\n[control]\ndialect = \"fanuc-31i\"\nincrement = \"IS-B\"\n[machine]\n\
             rotary = { letter = \"B\", sign = 1 }\n[tolerance]\nposition = 0.1\n[cylinder]\ndiameter = 500\n\
             length = 300\n[pattern]\npitch = 10\nmetric = \"arc\"\n[drill]\ndiameter = 5\ndepth = 12\n",
        );
        for (from, to) in changes {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        match Job::parse(&text) {
            Ok(Job::Honeycomb(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    fn holes(changes: &[(&str, &str)]) -> Reference {
        reference(&job(changes)).unwrap()
    }

    fn refused(changes: &[(&str, &str)]) -> String {
        reference(&job(changes)).unwrap_err().to_string()
    }

    /// π·500/17.3205 = 90.69: 91 rows of each group. π·500/182/cos 30° = 9.96593; 300 of that are 30.1.
    #[test]
    fn the_example_worked_by_hand() {
        let reference = holes(&[]);
        let pattern = reference.pattern.unwrap();
        assert_eq!(pattern.rows, 182);
        assert!((pattern.pitch - 9.965_930_572_7).abs() < 1e-9, "{}", pattern.pitch);
        assert_eq!(reference.holes.len(), 91 * 31 + 91 * 30);
        let hole = reference.holes.iter().find(|h| h.id.as_deref() == Some("r91h2")).unwrap();
        assert!((hole.entry[0] - 2.5 * 9.965_930_572_7).abs() < 1e-8, "an odd row begins half a pitch later");
        assert!(hole.entry[1].abs() < 1e-9 && (hole.entry[2] + 250.0).abs() < 1e-9, "half a turn: {hole:?}");
    }

    /// 100·sin 3.75°/cos 30° = 7.55210.
    #[test]
    fn a_chord_worked_by_hand() {
        let tube = [("pitch = 10", "divisions = 24"), ("arc", "chord"), ("diameter = 500", "diameter = 100")];
        let pattern = holes(&tube).pattern.unwrap();
        assert_eq!((pattern.rows, pattern.specified_pitch), (48, None));
        assert!((pattern.pitch - 7.552_103).abs() < 1e-5, "{}", pattern.pitch);
    }

    /// Four and a half rows fit at a pitch of π·60/(4.5·√3) = 24.184.
    #[test]
    fn rows_are_rounded_to_the_nearest() {
        let rows = |pitch: &str| {
            let small = [("diameter = 500", "diameter = 60"), ("pitch = 10", pitch)];
            holes(&small).pattern.unwrap().rows
        };
        assert_eq!((rows("pitch = 24.18"), rows("pitch = 24.19")), (10, 8));
    }

    #[test]
    fn every_hole_inside_has_six_neighbours_at_the_pitch_to_the_micrometre() {
        for metric in ["arc", "chord"] {
            for (diameter, pitch) in [(500.0, 40.0), (80.0, 13.7), (60.0, 31.0), (233.3, 21.0)] {
                let (d, p) = (format!("diameter = {diameter}"), format!("pitch = {pitch}"));
                let reference = holes(&[("diameter = 500", &d), ("pitch = 10", &p), ("arc", metric)]);
                let pattern = reference.pattern.unwrap();
                let (p, inside) = (pattern.pitch, 1.01 * pattern.pitch..=300.0 - 1.01 * pattern.pitch);
                let places: Vec<Point3<f64>> =
                    reference.holes.iter().map(|h| Point3::from(h.entry)).collect();
                let mut seen = 0;
                for (index, at) in places.iter().enumerate().filter(|(_, at)| inside.contains(&at.x)) {
                    let others = places.iter().enumerate().filter(|(other, _)| *other != index);
                    let mut all: Vec<f64> = others.map(|(_, other)| pattern.distance(at, other)).collect();
                    all.sort_by(f64::total_cmp);
                    assert!(
                        all[..6].iter().all(|d| (d - p).abs() < 1e-6),
                        "{diameter} {metric}: {:?}",
                        &all[..7]
                    );
                    assert!(all[6] > 1.2 * p, "{diameter} {metric}: a seventh at {}", all[6]);
                    seen += 1;
                }
                assert!(seen > 20, "{seen}");
            }
        }
    }

    #[test]
    fn an_impossible_pattern_is_refused_with_its_numbers() {
        let deep = refused(&[("pitch = 10", "pitch = 5.1"), ("depth = 12", "depth = 40")]);
        let expected =
            "the holes overlap: with 356 rows the pitch is 5.095 mm, and holes of neighbouring rows are 4.";
        assert!(deep.starts_with(expected), "{deep}");
        let close = refused(&[("pitch = 10", "divisions = 200")]);
        let expected =
            "the holes overlap: with 400 rows the pitch is 4.534 mm, and holes in a row are 4.534 mm";
        assert!(close.starts_with(expected), "{close}");
        let many = refused(&[
            ("pitch = 10", "pitch = 1"),
            ("diameter = 5\n", "diameter = 0.5\n"),
            ("length = 300", "length = 3000"),
        ]);
        assert!(many.starts_with("the pattern has 54"), "{many}");
        // The bore ends the holes where they are still apart.
        let tube = ("length = 300", "length = 300\nbore = 498");
        holes(&[("pitch = 10", "pitch = 5.2"), ("depth = 12", "depth = 40"), tube]);
    }

    /// Diameter 100, counted by hand: 100π is 314.159 round; rows of one group are 1.7320508·pitch apart.
    /// 17.7 → 30.657, 10.247 of them; 17.3 → 29.964, 10.484; 17.27 → 29.913, 10.503; 16.9 → 29.272, 10.732;
    /// 120 → 207.846, 1.51; 125 → 216.506, 1.45: one row of a group is no pattern.
    #[test]
    fn the_count_is_the_one_that_leaves_least_over() {
        for (pitch, count) in
            [(17.7, 10), (17.3, 10), (17.27, 11), (16.9, 11), (120.0, 2), (125.0, 1), (400.0, 1)]
        {
            assert_eq!(nearest_count(100.0, pitch), Some(count), "{pitch}");
        }
        assert_eq!(nearest_count(100.0, 0.000_1), None, "1.8 million rows");
    }

    /// A hole lies at x = length, to the last bit.
    #[test]
    fn the_last_hole_may_stand_at_the_very_end() {
        let pitch = holes(&[]).pattern.unwrap().pitch;
        let count = |length: f64| {
            let length = format!("length = {length:?}");
            holes(&[("length = 300", &length)]).holes.len()
        };
        assert_eq!(count(pitch), 91 * 2 + 91);
        assert_eq!(count(pitch * 0.999_999), 91 + 91);
        assert_eq!(count(pitch * 0.499_999), 91, "odd rows have no hole");
    }
}
