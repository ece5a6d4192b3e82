//! Position of each hole: its axis lies in the tolerance zone, unrounded. A deviation is a tilt or an offset.
use super::*;
use crate::findings::{HOLE_POSITION, HOLE_TILTED};

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, nominal, drilled) in comparison.matched().filter(|(pair, ..)| !comparison.is_in_place(pair)) {
        let finding = finding(comparison, pair, nominal).with_backtrace(drilled.backtrace.clone());
        findings.add(Subject::Nominal(pair.nominal), finding);
    }
}

fn finding(comparison: &Comparison<'_>, pair: &HolePair, nominal: &Hole) -> Diagnostic {
    let (deviation, id) = (&pair.deviation, comparison.id(pair.nominal));
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
        let message = format!("hole {id} is tilted by {:.3}°: {limits}", deviation.tilt.0);
        return Diagnostic::new(&HOLE_TILTED, message)
            .help("check the head angle, and that the feed runs along the hole");
    }
    let [x, y, z] = [0, 1, 2].map(|i| deviation.entry[i] - nominal.entry[i]);
    let note = format!("actual − nominal at the entry, part coordinates: x {x:+.4}, y {y:+.4}, z {z:+.4} mm");
    Diagnostic::new(&HOLE_POSITION, format!("hole {id} is out of position: {limits}"))
        .note(note)
        .help("correct the programmed point")
}
