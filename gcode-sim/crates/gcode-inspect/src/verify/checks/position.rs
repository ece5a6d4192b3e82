//! The axis of every hole must lie in its zone: judged unrounded, told apart by whether it leans or stands aside.
use super::{Comparison, HoleFinding};
use crate::verify::HolePair;
use gcode_lang::diag::Diagnostic;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<HoleFinding>) {
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
        "Φ{:.4} where Φ{} is allowed ({:.4} mm at the entry, {:.4} mm at the bottom)",
        deviation.zone_diameter(),
        comparison.tolerances.position,
        deviation.at_entry,
        deviation.at_bottom
    );
    // Leaning alone, over the hole's depth, would already be more than the other half of the zone allows.
    let finding = if leans > deviation.at_entry.min(deviation.at_bottom)
        && leans > comparison.tolerances.position / 4.0
    {
        Diagnostic::error("hole-tilted", format!("hole {id} leans by {:.3}°: {limits}", deviation.tilt.0))
            .help("check the head's angle, and that the feed runs along the hole")
    } else {
        let d: Vec<_> = (0..3).map(|i| format!("{:+.4}", deviation.entry[i] - wanted.entry[i])).collect();
        Diagnostic::error("hole-position", format!("hole {id} stands aside by {}: {limits}", d.join(" ")))
            .help("the three numbers are actual less nominal in x, y, z of the part: correct the programmed point")
    };
    finding.at(found.backtrace.clone())
}
