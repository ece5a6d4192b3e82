//! Designations of threads as drawings have them: `M10`, `M10x1`, `1/4-20`, `#10-24`, `G1/4`.

/// Nominal diameters and pitches of the coarse series, mm (ISO 261, table 1, first and second choice).
const COARSE: [(f64, f64); 30] = [
    (1.0, 0.25),
    (1.2, 0.25),
    (1.4, 0.3),
    (1.6, 0.35),
    (1.8, 0.35),
    (2.0, 0.4),
    (2.5, 0.45),
    (3.0, 0.5),
    (3.5, 0.6),
    (4.0, 0.7),
    (5.0, 0.8),
    (6.0, 1.0),
    (7.0, 1.0),
    (8.0, 1.25),
    (10.0, 1.5),
    (12.0, 1.75),
    (14.0, 2.0),
    (16.0, 2.0),
    (18.0, 2.5),
    (20.0, 2.5),
    (22.0, 2.5),
    (24.0, 3.0),
    (27.0, 3.0),
    (30.0, 3.5),
    (33.0, 3.5),
    (36.0, 4.0),
    (39.0, 4.0),
    (42.0, 4.5),
    (48.0, 5.0),
    (56.0, 5.5),
];

/// Sizes, diameters in mm and threads an inch of pipe threads where pressure-tight joints are not made on the threads (ISO 228-1,
/// table 1).
const PIPE: [(&str, f64, f64); 12] = [
    ("1/16", 7.723, 28.0),
    ("1/8", 9.728, 28.0),
    ("1/4", 13.157, 19.0),
    ("3/8", 16.662, 19.0),
    ("1/2", 20.955, 14.0),
    ("5/8", 22.911, 14.0),
    ("3/4", 26.441, 14.0),
    ("1", 33.249, 11.0),
    ("1 1/4", 41.910, 11.0),
    ("1 1/2", 47.803, 11.0),
    ("2", 59.614, 11.0),
    ("3", 87.884, 11.0),
];

/// Returns the diameter and the pitch of a thread by its designation, mm: a metric one, whose pitch is the coarse one where
/// it is left out, one of the Unified series by diameter and threads an inch (ASME B1.1), or a pipe thread `G1/4`.
///
/// # Errors
/// What is wrong with a text that begins as a designation; `None` for any other text.
pub(crate) fn parse(text: &str) -> Option<Result<(f64, f64), String>> {
    let text = text.trim().to_lowercase().replace(',', ".");
    if let Some(size) = text.strip_prefix('m') {
        let (diameter, pitch) = match size.split_once(['x', '×', '*']) {
            Some((diameter, pitch)) => (diameter, Some(pitch)),
            None => (size, None),
        };
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let diameter = number(diameter)?;
        return Some(match pitch {
            Some(pitch) => Ok((diameter, number(pitch)?)),
            None => coarse(diameter),
        });
    }
    if let Some(size) = text.strip_prefix('g') {
        let (_, diameter, turns) = PIPE.iter().find(|(name, ..)| *name == size.trim())?;
        return Some(Ok((*diameter, 25.4 / turns)));
    }
    let (size, turns) = text.split_once('-')?;
    let turns: f64 =
        turns.trim_end_matches(|letter: char| letter.is_alphabetic() || letter == ' ').parse().ok()?;
    let inches = match size.strip_prefix('#') {
        Some(number) => 0.060 + 0.013 * f64::from(number.parse::<u8>().ok()?),
        None => size.split(' ').map(fraction).sum::<Option<f64>>()?,
    };
    (turns > 0.0).then(|| Ok((to_places(25.4 * inches), 25.4 / turns)))
}

fn coarse(diameter: f64) -> Result<(f64, f64), String> {
    let entry = COARSE.iter().find(|(nominal, _)| *nominal == diameter).copied();
    entry
        .ok_or_else(|| format!("M{diameter} has no coarse pitch in ISO 261: give one, such as M{diameter}x1"))
}

/// Returns `1/4`, `0.25` or `1` as a number.
fn fraction(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((above, below)) => Some(above.parse::<f64>().ok()? / below.parse::<f64>().ok()?),
        None => text.parse().ok(),
    }
}

/// Rounds to 0.0001 mm, without the noise of the arithmetic.
fn to_places(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::parse;

    /// Expected values from the tables of the standards, 1 in = 25.4 mm.
    #[test]
    fn designations_give_diameter_and_pitch() {
        for (text, diameter, pitch) in [
            ("M10", 10.0, 1.5),
            ("m3", 3.0, 0.5),
            ("M2,5", 2.5, 0.45),
            ("M10x1", 10.0, 1.0),
            ("M10 × 1,25", 10.0, 1.25),
            ("1/4-20", 6.35, 1.27),
            ("1/4-20 UNC", 6.35, 1.27),
            ("#10-24", 4.826, 25.4 / 24.0),
            ("1 1/8-7", 28.575, 25.4 / 7.0),
            (".25-28", 6.35, 25.4 / 28.0),
            ("G1/4", 13.157, 25.4 / 19.0),
            ("G 1 1/2", 47.803, 25.4 / 11.0),
        ] {
            assert_eq!(parse(text), Some(Ok((diameter, pitch))), "{text}");
        }
    }

    #[test]
    fn other_texts_are_no_designations() {
        for text in ["10", "8.5", "M", "Mx1", "M10x", "-5", "1/4-", "G1/7", "Rc1/4", "1/0-0", ""] {
            assert_eq!(parse(text), None, "{text}");
        }
        let message = parse("M9.5").unwrap().unwrap_err();
        assert_eq!(message, "M9.5 has no coarse pitch in ISO 261: give one, such as M9.5x1");
    }
}
