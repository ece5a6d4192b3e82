//! The sine table's program for tilts either way: the height has to make the angle that takes the tilt away.
use gcode_sim::machine::Placement;
use gcode_sim::units::Deg;

use super::{Bench, CheckError, Tried, common};

/// Tilts of the part about z, degrees.
const TILTS: [f64; 3] = [0.0, 0.08, -0.031];

pub(super) fn tried(bench: &Bench<'_>) -> Result<Tried, CheckError> {
    let table = &bench.job.sine_table;
    let step = table.gauge_blocks.step().mm();
    let mut tried = Tried::default();
    let mut worst = 0.0_f64;
    // After the first run-out the table stands at the job's angle; after another one as the stop before has left it.
    let set = [None, Some(table.phi + 0.05)];
    for (tilt, set) in TILTS.into_iter().flat_map(|tilt| set.map(|set| (tilt, set))) {
        let stands = set.unwrap_or(table.phi);
        let wanted = stands - f64::from(table.sign) * tilt;
        // The macro refuses what no sine table is set to.
        if !(0.0..=45.0).contains(&wanted) || !(0.0..=45.0).contains(&stands) {
            continue;
        }
        let run = bench.run(
            Placement::default(),
            [(583, tilt), (585, 0.0)].into_iter().chain(set.map(|set| (596, set))).collect(),
        )?;
        tried.refusals.extend(bench.stopped(&run));
        tried.seconds = run.control.seconds().0;
        let [angle, height, change, left] = [586, 587, 588, 589].map(|number| common(&run, number));
        // Half a step, and what doubles round off.
        let off = (height - table.length * Deg(wanted).sin()).abs();
        worst = worst.max(off);
        let made = Deg::asin(height / table.length);
        let holds = off <= step / 2.0 + 1e-9
            && (angle - wanted).abs() < 1e-9
            && ((made.0 - wanted) * 3600.0 - left).abs() < 1e-3
            && (height - change - table.length * Deg(stands).sin()).abs() < 1e-9
            && (common(&run, 596) - made.0).abs() < 1e-9
            && common(&run, 583).is_nan();
        if !holds {
            let message = format!(
                "for a tilt of {tilt} degrees on a table at {stands} it tells PHI {angle}, H {height}, {change} more, {left} seconds left; PHI {wanted} is wanted"
            );
            tried.refusals.push(format!("{}: {message}\n", bench.name()));
        }
    }
    tried.report = format!(
        "{}  the sine table's height for each tilt to within {worst:.4} mm, half a step of {} being {}\n",
        bench.name(),
        table.gauge_blocks.name,
        step / 2.0
    );
    Ok(tried)
}
