//! Characteristics for the inspector, one line each, after form 3 of AS9102.
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_inspect::verify::{Distance, HoleVerdict, Neighbours, Verdict};
use gcode_lang::units::{Deg, Mm};
use gcode_part::gauge;
use gcode_part::job::{Alignment, Job, PatternJob, PatternSpec, PatternStep};
use gcode_sim::report::figures::{rounded, short, signed, signed_to};

use crate::check::PackageVerdict;

/// Largest number of holes with lines of their own; larger patterns have common lines.
pub(super) const LISTED: usize = 100;

/// One characteristic. It has no result: a simulation is not a measurement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Characteristic {
    pub reference: String,
    pub name: &'static str,
    pub requirement: String,
    /// Prediction of the simulation.
    pub predicted: String,
}

pub(super) fn characteristics(job: &Job, judgement: &PackageVerdict) -> Vec<Characteristic> {
    match judgement {
        PackageVerdict::Measured => match job {
            Job::Alignment(job) => of_alignment(job),
            Job::PinHoles(_) | Job::Honeycomb(_) | Job::Burr(_) | Job::Pattern(_) => Vec::new(),
        },
        PackageVerdict::Holes(verdict) if verdict.holes.len() <= LISTED => {
            let each = verdict.holes.iter().flat_map(|hole| {
                let mut all = of_hole(job, hole, verdict);
                if let Job::Pattern(job) = job {
                    all.extend(of_steps(job, hole, verdict.depth_tolerance));
                }
                all
            });
            each.chain(verdict.neighbours.iter().flat_map(of_neighbours)).collect()
        }
        PackageVerdict::Holes(verdict) => of_all(verdict),
        PackageVerdict::Flutes(verdict) => of_flutes(verdict),
    }
}

impl Characteristic {
    fn new(
        reference: &str,
        name: &'static str,
        requirement: impl Into<String>,
        predicted: impl Into<String>,
    ) -> Self {
        let (reference, requirement, predicted) =
            (reference.to_owned(), requirement.into(), predicted.into());
        Self { reference, name, requirement, predicted }
    }
}

fn of_hole(job: &Job, hole: &HoleVerdict, verdict: &Verdict) -> Vec<Characteristic> {
    let reference = format!("hole {}", hole.id);
    let position = format!("Φ{}", rounded(hole.position_deviation, 4));
    let actual = format!("{} ({})", rounded(hole.actual.depth, 4), signed(hole.depth_error));
    // A mill goes round a hole that is wider than itself.
    let width_by = if is_milled(job, hole) { "path and tool" } else { "the tool's" };
    hole_characteristics(&reference, hole, verdict, position, actual, width_by)
}

/// Returns true if the tool that finishes a hole goes round it.
fn is_milled(job: &Job, hole: &HoleVerdict) -> bool {
    let Job::Pattern(job) = job else { return false };
    hole.from.tool.and_then(|tool| job.tool(tool)).is_some_and(|tool| tool.operation.is_milling())
}

/// Returns the diameters and threads of a hole that several tools make, or that is a thread, with the depth of each.
fn of_steps(job: &PatternJob, hole: &HoleVerdict, tolerance: f64) -> Vec<Characteristic> {
    let reference = format!("hole {}", hole.id);
    let is_its = |pattern: &&PatternSpec| hole.id.rsplit_once('-').is_some_and(|(id, _)| id == pattern.id);
    let pattern = job.patterns.iter().find(is_its).filter(|_| hole.nominal.diameter.is_none());
    let steps = pattern.into_iter().flat_map(|pattern| &pattern.steps);
    let made = if hole.ok { "as programmed" } else { "not as programmed: see the findings" };
    let of = |step: &PatternStep| {
        let tool = job.tool(step.tool)?;
        let (diameter, depth) = (short(step.diameter(tool)), rounded(step.depth, 3));
        let depth = format!("{depth} ±{tolerance} deep");
        Some(if tool.operation.is_threading() {
            let hand = if tool.is_left_hand() { " LH" } else { "" };
            let size = format!("M{diameter} × {}{hand}, {depth}; gauge", short(tool.increment()));
            Characteristic::new(&reference, "thread", size, made)
        } else {
            Characteristic::new(&reference, "diameter", format!("Φ{diameter}, {depth}"), made)
        })
    };
    steps.filter_map(of).collect()
}

/// Returns position, depth and diameter; the nominal values are those of `hole`.
fn hole_characteristics(
    reference: &str,
    hole: &HoleVerdict,
    verdict: &Verdict,
    position: String,
    depth: String,
    width_by: &str,
) -> Vec<Characteristic> {
    let tolerance = format!("Φ{} (ISO 1101)", verdict.tolerance);
    let nominal = format!("{} ±{}", rounded(hole.nominal.depth, 3), verdict.depth_tolerance);
    let mut all = vec![
        Characteristic::new(reference, "position", tolerance, position),
        Characteristic::new(reference, "depth", nominal, depth),
    ];
    all.extend(hole.nominal.diameter.map(|nominal| {
        let tool = |d: f64| format!("Φ{} ({width_by})", rounded(d, 3));
        let tool = hole.actual.diameter.map_or("unknown".to_owned(), tool);
        let limits = format!("Φ{}, limits: see the drawing", rounded(nominal, 3));
        Characteristic::new(reference, "diameter", limits, tool)
    }));
    all
}

/// Returns the characteristics of a pattern: the extremes over all holes.
fn of_all(verdict: &Verdict) -> Vec<Characteristic> {
    let reference = format!("all {} holes", verdict.holes.len());
    let worst = format!("at most Φ{}", rounded(verdict.worst.unwrap_or(0.0), 4));
    let errors = || verdict.holes.iter().map(|hole| hole.depth_error);
    let (least, most) = (errors().fold(f64::INFINITY, f64::min), errors().fold(f64::NEG_INFINITY, f64::max));
    let off = format!("{} to {}", signed(least), signed(most));
    let Some(first) = verdict.holes.first() else { return Vec::new() };
    let mut all = hole_characteristics(&reference, first, verdict, worst, off, "the tool's");
    all.extend(verdict.neighbours.iter().flat_map(of_neighbours));
    all
}

fn of_neighbours(neighbours: &Neighbours) -> Vec<Characteristic> {
    let Neighbours { metric, nominal, with_six, with_six_nominal, min, max } = neighbours;
    let place = |distance: &Option<Distance>| match distance {
        Some(Distance { distance, between: [one, other] }) => {
            format!("{} between {one} and {other}", rounded(*distance, 4))
        }
        None => "none".to_owned(),
    };
    let pitch = || format!("{} ({metric})", rounded(*nominal, 4));
    let new = |name: &'static str, requirement: String, predicted: String| {
        Characteristic::new("neighbours", name, requirement, predicted)
    };
    vec![
        new("minimum distance", pitch(), place(min)),
        new("maximum distance", pitch(), place(max)),
        new("holes with all six neighbours", with_six_nominal.to_string(), with_six.to_string()),
    ]
}

fn of_flutes(verdict: &FluteVerdict) -> Vec<Characteristic> {
    let number = |value: Option<f64>, places: usize| value.map_or("-".to_owned(), |v| rounded(v, places));
    let (nominal, flutes) = (verdict.nominal_flutes.to_string(), verdict.flutes.to_string());
    let (surface, helix) =
        (format!("at most {}", verdict.tolerance), format!("0° ±{}°", verdict.helix_tolerance));
    let helix_error = format!("{}°", number(verdict.helix_error, 3));
    let index = format!("even ±{}°", verdict.index_tolerance);
    let index_error = format!("{}° off", number(verdict.index_error, 4));
    let off = number(verdict.surface_deviation, 4);
    let mut all = vec![
        Characteristic::new("flutes", "number", nominal, flutes),
        Characteristic::new("tooth bottom", "contact deviation", surface, off),
        Characteristic::new("flutes", "helix angle deviation", helix, helix_error),
        Characteristic::new("flutes", "index between neighbours", index, index_error),
    ];
    // Helix angles can be measured at these polar angles, on the specified law.
    all.extend(verdict.laws.iter().map(|law| {
        let nominal = if verdict.law == "published" { law.published } else { law.constant_helix };
        let requirement = format!("{}° ±{}°", rounded(nominal, 2), verdict.helix_tolerance);
        let place = format!("{}° from the tip", law.polar);
        let found = law.measured.map_or("not measured".to_owned(), |angle| format!("{}°", rounded(angle, 2)));
        Characteristic::new(&place, "helix angle", requirement, found)
    }));
    all
}

/// Returns the characteristics of a part's position: sine table, chord, run-out at both heights.
fn of_alignment(job: &Alignment) -> Vec<Characteristic> {
    let table = &job.sine_table;
    let setting = gauge::sine_setting(Mm(table.length), Deg(table.phi), &table.gauge_blocks);
    let height = |x: f64| {
        let part = x / job.surface.a;
        job.surface.b * (1.0 - part * part).sqrt()
    };
    let (e, f) = (job.chord.e_radius, job.chord.f_radius);
    let (across, up) = (e - f, height(e) - height(f));
    let chord = (across * across + up * up).sqrt();
    let limits = &job.limits();
    let blocks = format!("{}″ error of the blocks", signed_to(setting.remainder, 2));
    let run_out = format!("#580 #581 ±{} mm, #582 #583 ±{}°", short(limits.shift), short(limits.tilt));
    let best = "the model's; #572 is the difference of the best pair";
    let first = [
        Characteristic::new("sine table", "angle", format!("{}°", short(table.phi)), blocks),
        Characteristic::new("chord E F", "length", rounded(chord, 4), best),
    ];
    let heights = job.runout.heights.map(|y| format!("y {}", short(y)));
    let heights =
        heights.map(|place| Characteristic::new(&place, "run-out", "see the drawing", "not predicted"));
    let dial = format!("±{} mm", short(limits.dial));
    let last = [
        Characteristic::new("O8210, last pass", "shift and tilt", run_out, "not predicted"),
        Characteristic::new("O8220", "dial along the ellipse", dial, "not predicted"),
    ];
    first.into_iter().chain(heights).chain(last).collect()
}
