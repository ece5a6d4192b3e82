//! Trial of the sine table's program for tilts in both directions: the height must give the angle that
//! cancels the tilt.
use gcode_inspect::machine::Placement;
use gcode_lang::units::Deg;
use gcode_part::gauge::Thickness;
use gcode_part::job::SineTable;
use gcode_sim::report::figures::short;

use super::{CheckError, TrialProgram, TrialResult, common_variable};
use crate::families::alignment::{LARGEST_TILT, STEEPEST, gap};

/// Tilts of the part about z, degrees.
const TILTS: [f64; 3] = [0.0, 0.08, -0.031];

pub(super) fn run_trial(bench: &TrialProgram<'_>) -> Result<TrialResult, CheckError> {
    let table = &bench.job.sine_table;
    let step = table.gauge_blocks.step().mm();
    let mut tried = bench.result();
    let mut worst = 0.0_f64;
    // After the first run-out the table is at the job's angle; after a later one at the angle of the previous
    // setting.
    let set = [None, Some(table.phi + 0.05)];
    for (tilt, set) in TILTS.into_iter().flat_map(|tilt| set.map(|set| (tilt, set))) {
        let present = set.unwrap_or(table.phi);
        let nominal = present - f64::from(table.sign) * tilt;
        // The macro refuses angles outside a sine table's range.
        if !(0.0..=45.0).contains(&nominal) || !(0.0..=45.0).contains(&present) {
            continue;
        }
        let run = bench.run(
            Placement::default(),
            [(583, tilt), (585, 0.0)].into_iter().chain(set.map(|set| (596, set))).collect(),
        )?;
        tried.refusals.extend(bench.stop_messages(&run));
        tried.seconds = run.control.seconds().0;
        let [angle, height, change, left] = [586, 587, 588, 589].map(|number| common_variable(&run, number));
        // Half a step, and the rounding of doubles.
        let off = (height - table.length * Deg(nominal).sin()).abs();
        worst = worst.max(off);
        let made = Deg::asin(height / table.length);
        let holds = off <= step / 2.0 + 1e-9
            && (angle - nominal).abs() < 1e-9
            && ((made.0 - nominal) * 3600.0 - left).abs() < 1e-3
            && (height - change - table.length * Deg(present).sin()).abs() < 1e-9
            && (common_variable(&run, 596) - made.0).abs() < 1e-9
            && common_variable(&run, 583).is_nan();
        if !holds {
            tried.refuse(format!(
                "for a tilt of {tilt} degrees on a table at {present} the program gives PHI {angle}, H \
                 {height}, {change} more, {left} seconds left; nominal PHI {nominal}"
            ));
        }
    }
    warnings(table).for_each(|warning| tried.warn(warning));
    tried.report(format!(
        "the sine table's height right within {worst:.4} mm at each tilt; the gauge blocks of {} allow {}, half a step",
        table.gauge_blocks.name,
        step / 2.0
    ));
    Ok(tried)
}

/// Returns warnings of tilts that the macro corrects but this table cannot be set for.
fn warnings(table: &SineTable) -> impl Iterator<Item = String> {
    let phi = short(table.phi);
    let room = table.phi.min(STEEPEST - table.phi);
    let side = if table.phi < LARGEST_TILT { "0" } else { "45" };
    let edge = (room < LARGEST_TILT).then(|| {
        format!(
            "key 'sine_table.phi' is {phi}: a tilt of more than {} degrees in one direction takes it \
             beyond {side}, which O8230 refuses (PHI BEYOND 0. TO 45.); set a part with such a tilt by hand",
            short(room)
        )
    });
    let stack = gap(table).map(|Thickness(half_microns)| {
        format!(
            "key 'sine_table.phi' is {phi}: within {} degree of it the set '{}' has gaps, the lowest at \
             {:.4} mm; where O8230 gives a height without a stack, put blocks with this difference under \
             both rollers",
            short(LARGEST_TILT),
            table.gauge_blocks.name,
            f64::from(half_microns) / 2000.0
        )
    });
    edge.into_iter().chain(stack)
}

#[cfg(test)]
mod tests {
    use gcode_part::job::Job;

    use super::*;
    use crate::families::alignment::FAMILY;

    fn warnings_at(phi: &str) -> String {
        let Ok(Job::Alignment(job)) =
            Job::parse(&FAMILY.new_job.replace("phi = 38.5", &format!("phi = {phi}")))
        else {
            panic!("phi {phi}");
        };
        warnings(&job.sine_table).collect::<Vec<_>>().join("\n")
    }

    /// L = 200: at 0.5° from 0 on, where 0.001 has no stack; at 5° from 13.951 on.
    #[test]
    fn a_table_that_cannot_be_set_for_some_tilts_is_warned_of() {
        for (phi, edge, lowest) in [
            ("0.5", Some("0.5 degrees in one direction takes it beyond 0"), true),
            ("44.9", Some("0.1 degrees in one direction takes it beyond 45"), false),
            ("38.5", None, false),
            ("5.0", None, false),
        ] {
            let messages = warnings_at(phi);
            assert_eq!(messages.contains("PHI BEYOND 0. TO 45."), edge.is_some(), "{messages}");
            assert!(edge.is_none_or(|edge| messages.contains(edge)), "{messages}");
            assert_eq!(messages.contains("has gaps, the lowest at 0.0010 mm"), lowest, "{messages}");
            assert_eq!(messages.contains("gaps"), lowest, "{messages}");
        }
    }
}
