//! Trial of the chord program on candidates at known positions: it must choose the pair of an exhaustive
//! search and bring E and F to their model coordinates.
use gcode_inspect::machine::{Machine, Placement};
use gcode_lang::motion::Position;
use gcode_lang::units::Deg;
use gcode_part::job::{Alignment, SurfaceSpec};
use gcode_session::Run;

use super::{CheckError, TrialProgram, TrialResult, common_variable, search};
use crate::families::alignment::CHORD_MATCH;

type Point = [f64; 3];

/// The candidates that are E and F themselves, as numbers from 1.
const TRUE_PAIR: [usize; 2] = [3, 8];

/// Positions of a part after the run-out correction: shift along y in mm, rotation about y in degrees.
const TRIAL_PLACEMENTS: [(f64, f64); 2] = [(-0.3, 0.25), (0.1, -0.2)];

pub(super) fn run_trial(bench: &TrialProgram<'_>) -> Result<TrialResult, CheckError> {
    let job = bench.job;
    let mut tried = bench.result();
    let (mut off, allowed) = (0.0_f64, tolerance(job));
    let mut farthest = 0.0_f64;
    for (high, turned) in TRIAL_PLACEMENTS {
        let tilt = [Deg::ZERO, Deg(turned), Deg::ZERO];
        let part = Placement { shift: [0.0, high, 0.0].into(), tilt, ..Placement::default() };
        let measured = candidates(job).map(|points| points.map(|p| transform(&part, p)));
        for (points, end) in measured.iter().zip(ends(job)) {
            let distances =
                points.iter().flat_map(|p| p.iter().zip(end).map(|(value, end)| (value - end).abs()));
            farthest = distances.fold(farthest, f64::max);
        }
        let variables = [501, 531].into_iter().zip(&measured).flat_map(|(first, points)| {
            (first..).zip(points.iter().take(job.chord.candidates as usize).flatten().copied())
        });
        let run = bench.run(part, variables.collect())?;
        tried.refusals.extend(bench.stop_messages(&run));
        tried.seconds = run.control.seconds().0;
        let (pair, difference) = best_pair(job, &measured);
        let actual = [570, 571, 572].map(|number| common_variable(&run, number));
        let expected = [pair[0] as f64, pair[1] as f64, difference];
        if !actual.iter().zip(expected).all(|(actual, expected)| (actual - expected).abs() < 1e-6) {
            tried.refuse(format!(
                "#570 to #572 are {actual:?}; a search through all pairs gives {expected:?}"
            ));
        }
        for (end, name) in ends(job).into_iter().zip(["E", "F"]) {
            let there = corrected_position(bench, &run, part, end)?;
            let far = distance(there, end);
            off = off.max(far);
            if far.is_nan() || far > allowed {
                tried.refuse(format!("{name} is at {there:?} after the correction, {far} mm from {end:?}"));
            }
        }
    }
    if !tried.refusals.is_empty() {
        tried.refusals.extend(search::search_advice(bench, "the candidates of these parts are", farthest));
    }
    check_touched_candidates(bench, &mut tried)?;
    let count = job.chord.candidates;
    tried.report(format!(
        "the pair of points that fits the model best, of all {count} by {count}; after the correction E and F are {off:.4} mm \
         from their model positions"
    ));
    Ok(tried)
}

/// Lets the program touch the candidates itself, on a part that is too high: they must be points of its
/// surface.
fn check_touched_candidates(bench: &TrialProgram<'_>, tried: &mut TrialResult) -> Result<(), CheckError> {
    let job = bench.job;
    let SurfaceSpec { a, b, .. } = job.surface;
    let high = 0.3;
    let part = Placement { shift: [0.0, high, 0.0].into(), ..Placement::default() };
    tried.seconds = {
        let run = bench.run(part, Vec::new())?;
        tried.refusals.extend(bench.stop_messages(&run));
        run.control.seconds().0
    };
    // O8201 uses the points up; this replacement leaves them.
    let mut package = bench.package.clone();
    for program in package.programs.iter_mut().filter(|program| program.number == CHORD_MATCH) {
        program.text = format!("%\nO{CHORD_MATCH}\nM99\n%\n");
    }
    let run = TrialProgram { package: &package, ..*bench }.run(part, Vec::new())?;
    let count = job.chord.candidates;
    for first in (501..501 + 3 * count).chain(531..531 + 3 * count).step_by(3) {
        let [x, y, z] = [0, 1, 2].map(|axis| common_variable(&run, first + axis));
        let [x, y, z] = [x / a, (y - high) / b, z / a];
        let off = ((x * x + y * y + z * z).sqrt() - 1.0) * a.min(b);
        if off.is_nan() || off.abs() > 0.001 {
            tried.refuse(format!("the point in #{first} is {off} mm off the touched surface"));
        }
    }
    Ok(())
}

/// Returns the allowed error: half an increment of each axis, and half an increment of the rotary axis at the
/// equator.
fn tolerance(job: &Alignment) -> f64 {
    let increment = job.control.increment.size();
    increment + job.surface.a * Deg(increment / 2.0).to_rad()
}

/// Returns E and F of the model.
fn ends(job: &Alignment) -> [Point; 2] {
    let SurfaceSpec { a, b, .. } = job.surface;
    [job.chord.e_radius, job.chord.f_radius].map(|x| [x, b * (1.0 - (x / a) * (x / a)).sqrt(), 0.0])
}

/// Returns ten points of the surface round each of E and F, one of them E or F itself. The two groups are
/// arranged differently, so that no two pairs are alike.
fn candidates(job: &Alignment) -> [[Point; 10]; 2] {
    let SurfaceSpec { a, b, .. } = job.surface;
    let count = job.chord.candidates as usize;
    let mut all = ends(job).map(|end| [end; 10]);
    for (points, (true_one, step)) in all.iter_mut().zip(TRUE_PAIR.into_iter().zip([137.5, 71.3])) {
        for (index, p) in points.iter_mut().enumerate().filter(|(index, _)| index + 1 != true_one.min(count))
        {
            let angle = Deg(step * (index + 1) as f64);
            let [along, across] = [angle.cos(), angle.sin()].map(|part| part * job.chord.circle / 2.0);
            let [x, y, z] = [p[0] + along, p[1] - along, across];
            // Projected back onto the surface, from its centre.
            let beyond = ((x * x + z * z) / (a * a) + y * y / (b * b)).sqrt();
            *p = [x, y, z].map(|c| c / beyond);
        }
    }
    all
}

/// Returns the pair whose distance is nearest to the model's, as numbers from 1, and the excess of its
/// distance.
fn best_pair(job: &Alignment, [e, f]: &[[Point; 10]; 2]) -> ([usize; 2], f64) {
    let [model_e, model_f] = ends(job);
    let model = distance(model_e, model_f);
    let count = job.chord.candidates as usize;
    let pairs = (1..=count).flat_map(|i| (1..=count).map(move |k| [i, k]));
    let longer = |[i, k]: [usize; 2]| distance(e[i - 1], f[k - 1]) - model;
    let best = pairs.min_by(|one, other| longer(*one).abs().total_cmp(&longer(*other).abs()));
    let best = best.unwrap_or_default();
    (best, longer(best))
}

/// Returns a point of the misplaced part in the corrected work coordinates, with the rotary axis at its
/// corrected 0.
fn corrected_position(
    bench: &TrialProgram<'_>,
    run: &Run,
    part: Placement,
    p: Point,
) -> Result<Point, CheckError> {
    let machine = Machine { part, ..bench.machine()? };
    let offset = |axis: usize| common_variable(run, 5221 + axis as u32);
    let letter = bench.job.machine.rotary.letter;
    let rotary = machine.axes.find(letter as u8);
    let rotary = rotary.ok_or_else(|| bench.broken(&format!("the machine has no axis {letter}")))?;
    let mut at = Position::default();
    at[rotary] = offset(rotary);
    let [x, y, z]: Point = machine.part_frame(&at).transform_point(&p.into()).coords.into();
    Ok([x - offset(0), y - offset(1), z - offset(2)])
}

fn transform(part: &Placement, p: Point) -> Point {
    part.frame().transform_point(&p.into()).coords.into()
}

fn distance(p: Point, q: Point) -> f64 {
    let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    (x * x + y * y + z * z).sqrt()
}
