//! The verdict on flutes in words, and the helix angle of both laws side by side.
use std::fmt::Write;

use crate::verify::Answer;
use crate::verify::flutes::{FluteVerdict, Law, WantedFlutes};

/// Lengths in mm, angles in degrees; judged unrounded, shown rounded.
pub fn table(verdict: &FluteVerdict) -> String {
    let mut text = format!(
        "Flutes of a burr, law {}: {}\nmm and degrees; a helix angle is measured over {} mm\n\n",
        verdict.law, verdict.basis, verdict.gauge
    );
    let number = |value: Option<f64>, places: usize| match value {
        Some(value) => format!("{value:.places$}"),
        None => "-".to_owned(),
    };
    let mut row = |what: &str, found: String, wanted: String| {
        let _ = writeln!(text, "{what:<42} {found:>18}  {wanted}");
    };
    row("", "found".to_owned(), "allowed".to_owned());
    row("flutes", verdict.flutes.to_string(), verdict.wanted_flutes.to_string());
    row("contact off the tooth bottom", number(verdict.surface_deviation, 4), verdict.tolerance.to_string());
    row(
        "helix angle, least and greatest",
        format!("{} {}", number(verdict.helix_min, 2), number(verdict.helix_max, 2)),
        format!("{} on the cylinder", verdict.helix),
    );
    row("helix angle off the law", number(verdict.helix_error, 3), verdict.helix_tolerance.to_string());
    row(
        "gap between neighbours off an even one",
        number(verdict.index_error, 4),
        verdict.index_tolerance.to_string(),
    );
    row("neighbours' least distance", number(verdict.nearest, 3), String::new());
    row("passes and grinding moves", format!("{} {}", verdict.passes, verdict.moves), String::new());
    laws(&mut text, &verdict.laws);
    let said = match verdict.verdict {
        Answer::Pass => "PASS",
        Answer::Fail => "FAIL",
    };
    let _ = writeln!(text, "{said}     {} of {} wanted flutes", verdict.flutes, verdict.wanted_flutes);
    for what in &verdict.not_checked {
        let _ = writeln!(text, "not checked: {what}");
    }
    text
}

/// What is wanted, in words.
pub fn wanted(burr: &WantedFlutes) -> String {
    let mut text = format!(
        "{} flutes, law {}, from {:.3} mm behind the end of the cylinder to polar angle {}, the pole {:.3} mm before it\n",
        burr.flutes, burr.law, burr.start, burr.tip_angle, -burr.pole
    );
    laws(&mut text, &burr.laws);
    text
}

/// The helix angle by polar angle θ from the tip: measured on the first flute, and what each law has there.
fn laws(text: &mut String, laws: &[Law]) {
    let _ = writeln!(
        text,
        "\n{:>8} {:>10} {:>15} {:>10}   helix angle",
        "theta", "measured", "constant-helix", "published"
    );
    for law in laws {
        let measured = law.measured.map_or("-".to_owned(), |angle| format!("{angle:.2}"));
        let _ = writeln!(
            text,
            "{:>8} {measured:>10} {:>15.2} {:>10.2}",
            law.theta, law.constant_helix, law.published
        );
    }
    text.push('\n');
}
