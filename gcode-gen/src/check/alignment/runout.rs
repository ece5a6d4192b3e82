//! The run-out program on parts whose shift and tilt are known: it has to find them by probing alone.
use gcode_sim::machine::Placement;
use gcode_sim::units::Deg;

use super::{Bench, CheckError, Tried, common};

/// What has to be found to within this: mm, degrees.
const ALLOWED: [f64; 2] = [0.01, 0.004];

/// Shift in mm and tilt in degrees about x, y and z. Neither a shift in y nor a turn about y is asked for; the others
/// have to be found in spite of them.
const STANDS: [[[f64; 3]; 2]; 4] = [
    [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
    [[0.3, 0.0, -0.3], [0.3, 0.0, 0.3]],
    [[-0.3, 0.2, 0.25], [-0.3, 0.0, 0.2]],
    [[0.2, -0.3, 0.3], [0.2, 0.3, -0.3]],
];

pub(super) fn tried(bench: &Bench<'_>) -> Result<Tried, CheckError> {
    let mut tried = Tried::default();
    let mut worst = [0.0_f64; 2];
    for [shift, tilt] in STANDS {
        let part = Placement { shift: shift.into(), tilt: tilt.map(Deg), ..Placement::default() };
        let run = bench.run(part, Vec::new())?;
        let stopped = bench.stopped(&run);
        tried.seconds = run.control.seconds().0;
        if !stopped.is_empty() {
            let stands =
                format!("{}: with the part shifted by {shift:?} and tilted by {tilt:?}\n", bench.name());
            tried.refusals.push(stands);
            tried.refusals.extend(stopped);
            continue;
        }
        for (number, real, kind) in
            [(580, shift[0], 0), (581, shift[2], 0), (582, tilt[0], 1), (583, tilt[2], 1)]
        {
            let off = (common(&run, number) - real).abs();
            worst[kind] = worst[kind].max(off);
            if off.is_nan() || off > ALLOWED[kind] {
                let message = format!("#{number} is {} where it is {real}", common(&run, number));
                tried.refusals.push(format!("{}: {message}\n", bench.name()));
            }
        }
    }
    let [shift, tilt] = worst;
    tried.report = format!(
        "{}  shifts of up to 0.3 mm and tilts of up to 0.3 degrees are found to {shift:.4} mm and {tilt:.4} degrees\n",
        bench.name()
    );
    Ok(tried)
}
