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
    for tilt in TILTS {
        let wanted = table.phi - f64::from(table.sign) * tilt;
        // The macro refuses what no sine table is set to.
        if !(0.0..=45.0).contains(&wanted) {
            continue;
        }
        let run = bench.run(Placement::default(), vec![(583, tilt)])?;
        tried.refusals.extend(bench.stopped(&run));
        tried.seconds = run.control.seconds().0;
        let [angle, height, change, left] = [590, 591, 592, 593].map(|number| common(&run, number));
        // Half a step, and what doubles round off.
        let off = (height - table.length * Deg(wanted).sin()).abs();
        worst = worst.max(off);
        let made = Deg::asin(height / table.length);
        let holds = off <= step / 2.0 + 1e-9
            && (angle - wanted).abs() < 1e-9
            && ((made.0 - wanted) * 3600.0 - left).abs() < 1e-3
            && (height - change - table.length * Deg(table.phi).sin()).abs() < 1e-9;
        if !holds {
            let message = format!(
                "for a tilt of {tilt} degrees it tells PHI {angle}, H {height}, {change} more, {left} seconds left; PHI {wanted} is wanted"
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
