//! What a measure of a honeycomb that is wrong by a factor was computed from: numbers that programs take for others.
use std::f64::consts::PI;

use gcode_part::Pattern;
use gcode_part::job::Metric;

/// Factors closer than this are the same: angles and lengths are rounded to the control's increment.
const FACTOR_TOLERANCE: f64 = 5e-5;

/// One number taken for another: the factor it makes, and its words.
struct Cause {
    factor: f64,
    description: String,
}

/// The fewest causes that together make `factor` of a length round the circumference, in words; `None` where nothing
/// known does. `asked`: whether the pitch that was asked for may be among them, as it may of an angle; of a pitch itself
/// the metric may.
pub(super) fn describe_causes(pattern: &Pattern, factor: f64, is_angle: bool) -> Option<String> {
    let all = known_causes(pattern, is_angle);
    let mut best: Option<Vec<&Cause>> = None;
    for set in 1..1u32 << all.len() {
        let chosen: Vec<_> =
            all.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1).map(|(_, c)| c).collect();
        let product: f64 = chosen.iter().map(|cause| cause.factor).product();
        let fewer = best.as_ref().is_none_or(|best| chosen.len() < best.len());
        if fewer && (product / factor - 1.0).abs() < FACTOR_TOLERANCE {
            best = Some(chosen);
        }
    }
    let words: Vec<_> = best?.into_iter().map(|cause| cause.description.as_str()).collect();
    Some(format!("the error matches {}", words.join(" and ")))
}

fn known_causes(pattern: &Pattern, is_angle: bool) -> Vec<Cause> {
    let Pattern { diameter, outer, bore, .. } = *pattern;
    let mut all = vec![Cause {
        factor: 314.0 / (100.0 * PI),
        description: "3.14 used for π (0.0507 % too small)".to_owned(),
    }];
    for (other, name) in [(bore, "bore"), (outer, "outer diameter")] {
        if 0.0 < other && other != diameter {
            let words = format!("the {name} {other} used instead of the pitch diameter {diameter}");
            all.push(Cause { factor: other / diameter, description: words });
        }
    }
    if !is_angle {
        let (other, words) = match pattern.metric {
            Metric::Arc => (
                Metric::Chord,
                "the straight distance (chord) used instead of the distance on the developed surface (arc)",
            ),
            Metric::Chord => (
                Metric::Arc,
                "the distance on the developed surface (arc) used instead of the straight distance (chord)",
            ),
        };
        all.push(Cause {
            factor: pattern.pitch_in_metric(other) / pattern.pitch,
            description: words.to_owned(),
        });
    }
    if let Some(pitch) = pattern.specified_pitch.filter(|_| is_angle) {
        let words =
            format!("the specified pitch {pitch} used instead of the closing pitch {:.4}", pattern.pitch);
        all.push(Cause { factor: pattern.pitch / pitch, description: words });
    }
    all.retain(|cause| FACTOR_TOLERANCE < (cause.factor - 1.0).abs());
    all
}
