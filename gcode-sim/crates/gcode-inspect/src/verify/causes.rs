//! Probable causes of a honeycomb measure that is wrong by a factor: one number used instead of another.
use std::f64::consts::PI;

use gcode_part::Pattern;
use gcode_part::job::Metric;

/// Factors closer than this are equal: angles and lengths are rounded to the control's increment.
const FACTOR_TOLERANCE: f64 = 5e-5;

/// Returns the fewest causes that together produce `factor`, in words; `None` if the known ones do not.
///
/// `is_angle`: the measure is an angle, which may follow from the specified pitch; else a pitch, which may be measured
/// in the other metric.
pub(super) fn describe_causes(pattern: &Pattern, factor: f64, is_angle: bool) -> Option<String> {
    let all = known_causes(pattern, is_angle);
    let subset = |set: u32| all.iter().enumerate().filter(move |(index, _)| set >> index & 1 == 1);
    let matches = |set: &u32| {
        let product: f64 = subset(*set).map(|(_, (factor, _))| factor).product();
        (product / factor - 1.0).abs() < FACTOR_TOLERANCE
    };
    let best = (1..1u32 << all.len()).filter(matches).min_by_key(|set| set.count_ones())?;
    let words: Vec<_> = subset(best).map(|(_, (_, words))| words.as_str()).collect();
    Some(format!("the error matches {}", words.join(" and ")))
}

/// Returns the factor of each cause and its description.
fn known_causes(pattern: &Pattern, is_angle: bool) -> Vec<(f64, String)> {
    let Pattern { diameter, outer, bore, .. } = *pattern;
    let mut all = vec![(314.0 / (100.0 * PI), "3.14 used for π (0.0507 % too small)".to_owned())];
    for (other, name) in [(bore, "bore"), (outer, "outer diameter")] {
        if 0.0 < other && other != diameter {
            let words = format!("the {name} {other} used instead of the pitch diameter {diameter}");
            all.push((other / diameter, words));
        }
    }
    if !is_angle {
        let (straight, developed) =
            ("the straight distance (chord)", "the distance on the developed surface (arc)");
        let (other, used, nominal) = match pattern.metric {
            Metric::Arc => (Metric::Chord, straight, developed),
            Metric::Chord => (Metric::Arc, developed, straight),
        };
        let factor = pattern.pitch_in_metric(other) / pattern.pitch;
        all.push((factor, format!("{used} used instead of {nominal}")));
    }
    if let Some(pitch) = pattern.specified_pitch.filter(|_| is_angle) {
        let words =
            format!("the specified pitch {pitch} used instead of the closing pitch {:.4}", pattern.pitch);
        all.push((pattern.pitch / pitch, words));
    }
    all.retain(|(factor, _)| FACTOR_TOLERANCE < (factor - 1.0).abs());
    all
}
