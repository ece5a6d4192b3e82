//! The verdict on flutes as text, with the helix angles of both laws side by side.
use std::fmt::Write;

use super::verdict_table::{append_assumptions, append_conclusion};
use gcode_inspect::verify::flutes::{FluteVerdict, LawAngles, NominalFlutes};
use gcode_part::Total;

/// Formats the verdict; lengths in mm, angles in degrees. Values are judged unrounded and shown rounded.
pub fn table(verdict: &FluteVerdict) -> String {
    let mut text = format!(
        "Flutes of a burr, law {}: {}\na helix angle is measured over {} mm of the flute; tolerances are ±\n\n",
        verdict.law, verdict.basis, verdict.gauge
    );
    let number =
        |value: Option<f64>, places: usize| value.map_or("-".to_owned(), |value| format!("{value:.places$}"));
    let deviation =
        |value, places, tolerance: f64| [number(value, places), "0".to_owned(), tolerance.to_string()];
    let range = |min, max, places| format!("{} {}", number(min, places), number(max, places));
    let none = String::new;
    let mut row = |what: &str, [actual, nominal, tolerance]: [String; 3]| {
        let line = format!("{what:<46} {actual:>14} {nominal:>16} {tolerance:>10}");
        let _ = writeln!(text, "{}", line.trim_end());
    };
    row("", ["actual", "nominal", "tolerance"].map(str::to_owned));
    row("flutes", [verdict.flutes.to_string(), verdict.nominal_flutes.to_string(), none()]);
    let contact = deviation(verdict.surface_deviation, 4, verdict.tolerance);
    row("contact deviation from the tooth bottom, mm", contact);
    let angles = range(verdict.helix_min, verdict.helix_max, 2);
    let nominal = format!("{} on cylinder", verdict.helix);
    row("helix angle, minimum and maximum, degrees", [angles, nominal, none()]);
    let helix = deviation(verdict.helix_error, 3, verdict.helix_tolerance);
    row("helix angle deviation from the law, degrees", helix);
    let index = deviation(verdict.index_error, 4, verdict.index_tolerance);
    row("index deviation between neighbours, degrees", index);
    let speeds = range(verdict.speed_min, verdict.speed_max, 1);
    let nominal = verdict.speed.map_or("-".to_owned(), |speed| format!("{speed} mm/min"));
    let percent = verdict.speed.map_or(none(), |_| format!("{:.0} %", 100.0 * verdict.speed_tolerance));
    row("speed along the flutes, minimum and maximum", [speeds, nominal, percent]);
    let least = format!("at least {}", verdict.min_nearest);
    row("minimum distance of neighbours, mm", [number(verdict.nearest, 3), least, none()]);
    let passes = format!("{} {}", verdict.passes, verdict.moves);
    row("passes, and grinding moves in them", [passes, none(), none()]);
    laws(&mut text, &verdict.laws);
    if !verdict.helix_course.is_empty() {
        let _ =
            writeln!(text, "measured: on pass {}, the largest deviation from the law", verdict.course_pass);
        if verdict.laws.iter().any(|law| law.measured.is_none()) {
            let least =
                verdict.helix_course.iter().map(|angles| angles.polar.0).fold(f64::INFINITY, f64::min);
            let _ = writeln!(
                text,
                "-: not measured within 2.5 degrees of that theta; the last {} mm of the flute are one measurement, at theta {least:.1}",
                verdict.gauge
            );
        }
        text.push('\n');
    }
    append_conclusion(&mut text, &verdict.conclusion(), &verdict.likely_causes);
    for what in &verdict.not_checked {
        let _ = writeln!(text, "not checked: {what}");
    }
    append_assumptions(&mut text, &verdict.assumptions, Total::Flutes(verdict.passes));
    text
}

/// Describes the nominal flutes.
pub fn nominal_table(burr: &NominalFlutes) -> String {
    let mut text = format!(
        "{} flutes, law {}, from {:.3} mm behind the end of the cylinder to polar angle {}, the pole {:.3} \
         mm in front of it\n",
        burr.flutes, burr.law, burr.start, burr.tip_angle, -burr.pole
    );
    laws(&mut text, &burr.laws);
    text
}

/// Writes the helix angle by polar angle θ from the tip: measured, and by either law, in degrees.
fn laws(text: &mut String, laws: &[LawAngles]) {
    let _ = writeln!(
        text,
        "\n{:>8} {:>10} {:>15} {:>10}   helix angle, degrees",
        "theta", "measured", "constant-helix", "published"
    );
    for law in laws {
        let measured = law.measured.map_or("-".to_owned(), |angle| format!("{angle:.2}"));
        let _ = writeln!(
            text,
            "{:>8} {measured:>10} {:>15.2} {:>10.2}",
            law.polar, law.constant_helix, law.published
        );
    }
    text.push('\n');
}
