//! The verdict on flutes as text, with the helix angles of both laws side by side.
use std::fmt::Write;

use gcode_inspect::verify::Answer;
use gcode_inspect::verify::flutes::{FluteVerdict, LawAngles, NominalFlutes};

/// Formats the verdict; lengths in mm, angles in degrees. Values are judged unrounded and shown rounded.
pub fn table(verdict: &FluteVerdict) -> String {
    let mut text = format!(
        "Flutes of a burr, law {}: {}\na helix angle is measured over {} mm of the flute; tolerances are ±\n\n",
        verdict.law, verdict.basis, verdict.gauge
    );
    let number = |value: Option<f64>, places: usize| match value {
        Some(value) => format!("{value:.places$}"),
        None => "-".to_owned(),
    };
    let mut row = |what: &str, found: String, wanted: String, tolerance: String| {
        let line = format!("{what:<46} {found:>14} {wanted:>16} {tolerance:>10}");
        let _ = writeln!(text, "{}", line.trim_end());
    };
    let [found, wanted, tolerance] = ["actual", "nominal", "tolerance"].map(str::to_owned);
    row("", found, wanted, tolerance);
    row("flutes", verdict.flutes.to_string(), verdict.nominal_flutes.to_string(), String::new());
    row(
        "contact deviation from the tooth bottom, mm",
        number(verdict.surface_deviation, 4),
        "0".to_owned(),
        verdict.tolerance.to_string(),
    );
    row(
        "helix angle, minimum and maximum, degrees",
        format!("{} {}", number(verdict.helix_min, 2), number(verdict.helix_max, 2)),
        format!("{} on cylinder", verdict.helix),
        String::new(),
    );
    row(
        "helix angle deviation from the law, degrees",
        number(verdict.helix_error, 3),
        "0".to_owned(),
        verdict.helix_tolerance.to_string(),
    );
    row(
        "index deviation between neighbours, degrees",
        number(verdict.index_error, 4),
        "0".to_owned(),
        verdict.index_tolerance.to_string(),
    );
    row(
        "speed along the flutes, minimum and maximum",
        format!("{} {}", number(verdict.speed_min, 1), number(verdict.speed_max, 1)),
        verdict.speed.map_or("-".to_owned(), |speed| format!("{speed} mm/min")),
        verdict.speed.map_or(String::new(), |_| format!("{:.0} %", 100.0 * verdict.speed_tolerance)),
    );
    row(
        "minimum distance of neighbours, mm",
        number(verdict.nearest, 3),
        format!("at least {}", verdict.min_nearest),
        String::new(),
    );
    row(
        "passes, and grinding moves in them",
        format!("{} {}", verdict.passes, verdict.moves),
        String::new(),
        String::new(),
    );
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
    let said = match verdict.verdict {
        Answer::Pass => "PASS",
        Answer::Fail => "FAIL",
    };
    let _ = writeln!(text, "{said}     {}", verdict.sentence());
    for what in &verdict.not_checked {
        let _ = writeln!(text, "not checked: {what}");
    }
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
