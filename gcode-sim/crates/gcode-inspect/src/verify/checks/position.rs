//! The axis of every hole must lie in its zone: judged unrounded, told apart by whether it leans or stands aside.
use super::{Comparison, HoleFinding, HoleInspection};
use crate::findings::{HOLE_POSITION, HOLE_TILTED};
use crate::verify::HolePair;
use gcode_lang::diag::Diagnostic;

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    for pair in &comparison.pairs {
        if pair.deviation.zone_diameter() > comparison.tolerances.position {
            objections.push(HoleFinding::of_nominal(pair.nominal, finding(comparison, pair)));
        }
    }
}

fn finding(comparison: &Comparison<'_>, pair: &HolePair) -> Diagnostic {
    let deviation = &pair.deviation;
    let (wanted, found) = (&comparison.nominal[pair.nominal], &comparison.actual[pair.actual]);
    let id = comparison.id(pair.nominal);
    let leans = deviation.tilt.tan() * wanted.depth;
    let limits = format!(
        "Φ{:.4}, tolerance Φ{} (axis off by {:.4} mm at the entry, {:.4} mm at the bottom)",
        deviation.zone_diameter(),
        comparison.tolerances.position,
        deviation.at_entry,
        deviation.at_bottom
    );
    // Leaning alone, over the hole's depth, would already be more than the other half of the zone allows.
    let finding = if leans > deviation.at_entry.min(deviation.at_bottom)
        && leans > comparison.tolerances.position / 4.0
    {
        Diagnostic::new(&HOLE_TILTED, format!("hole {id} is tilted by {:.3}°: {limits}", deviation.tilt.0))
            .help("check the head angle, and that the feed runs along the hole")
    } else {
        let [x, y, z] = [0, 1, 2].map(|i| deviation.entry[i] - wanted.entry[i]);
        Diagnostic::new(&HOLE_POSITION, format!("hole {id} is out of position: {limits}"))
            .note(format!(
                "actual − nominal at the entry, part coordinates: x {x:+.4}, y {y:+.4}, z {z:+.4} mm"
            ))
            .help("correct the programmed point")
    };
    finding.with_backtrace(found.backtrace.clone())
}
