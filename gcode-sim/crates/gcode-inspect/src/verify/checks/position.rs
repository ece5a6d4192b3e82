//! Position of each hole: its axis lies in the tolerance zone, unrounded. A deviation is a tilt or an offset.
use super::*;
use crate::findings::{HOLE_POSITION, HOLE_TILTED};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, nominal, drilled) in comparison.matched() {
        let sides = [(pair.deviation, drilled, "")].into_iter().chain(far_side(comparison, pair, nominal));
        for (deviation, drilled, side) in sides {
            if exceeds(deviation.zone_diameter(), comparison.tolerances.position) {
                let name = format!("hole {}{side}", comparison.id(pair.nominal));
                let finding = finding(comparison, &deviation, nominal, &name);
                let finding = repeated_note(comparison, pair.nominal, drilled)
                    .into_iter()
                    .fold(finding, Diagnostic::note);
                findings
                    .add(Subject::Nominal(pair.nominal), finding.with_backtrace(drilled.backtrace.clone()));
            }
        }
    }
}

/// Returns a note on a hole that is drilled on the line of another one, and is itself missing.
fn repeated_note(comparison: &Comparison<'_>, nominal: usize, drilled: &DrilledHole) -> Option<String> {
    let is_repeated = !std::ptr::eq(drilled, &comparison.actual[drilled.first_on_line]);
    let on_line = is_repeated.then(|| comparison.nominal_on_line(drilled)).flatten()?;
    let own = comparison.id(nominal);
    let other = comparison.id(on_line);
    (on_line != nominal).then(|| format!("hole {other} is drilled twice, and hole {own} itself is missing"))
}

/// Returns the part of a through hole that is drilled from its far side.
fn far_side<'a>(
    comparison: &Comparison<'a>,
    pair: &HolePair,
    nominal: &Hole,
) -> Option<(Deviation, &'a DrilledHole, &'static str)> {
    let drilled = &comparison.actual[pair.from_far_side?];
    let deviation = Deviation::new(nominal, &drilled.bottom(), &drilled.axis)?;
    Some((deviation, drilled, ", drilled from its far side,"))
}

fn finding(comparison: &Comparison<'_>, deviation: &Deviation, nominal: &Hole, name: &str) -> Diagnostic {
    let limits = format!(
        "Φ{:.4}, tolerance Φ{} (axis off by {:.4} mm at the entry, {:.4} mm at the bottom)",
        deviation.zone_diameter(),
        comparison.tolerances.position,
        deviation.at_entry,
        deviation.at_bottom
    );
    // Over the hole's depth the tilt alone exceeds what the rest of the zone allows.
    let tilt_offset = deviation.tilt.tan() * nominal.depth;
    if tilt_offset > deviation.at_entry.min(deviation.at_bottom)
        && tilt_offset > comparison.tolerances.position / 4.0
    {
        let message = format!("{name} is tilted by {:.3}°: {limits}", deviation.tilt.0);
        return Diagnostic::new(&HOLE_TILTED, message)
            .help("check the head angle, and that the feed runs along the hole");
    }
    let [x, y, z] = [0, 1, 2].map(|i| deviation.entry[i] - nominal.entry[i]);
    let note = format!("actual − nominal at the entry, part coordinates: x {x:+.4}, y {y:+.4}, z {z:+.4} mm");
    Diagnostic::new(&HOLE_POSITION, format!("{name} is out of position: {limits}"))
        .note(note)
        .help("correct the programmed point")
}
