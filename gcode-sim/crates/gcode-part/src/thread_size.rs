//! Designations of threads as drawings have them: `M10`, `M10x1 LH`, `1/4-20 UNC-2B`, `#10-24`, `G1/4`.
use super::hand::Hand;

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

/// Sizes of the Unified coarse and fine series, each with its threads an inch (ASME B1.1, table 2 and 3); 0 where a series has
/// none.
const UNIFIED: [(&str, f64, f64); 31] = [
    ("#0", 0.0, 80.0),
    ("#1", 64.0, 72.0),
    ("#2", 56.0, 64.0),
    ("#3", 48.0, 56.0),
    ("#4", 40.0, 48.0),
    ("#5", 40.0, 44.0),
    ("#6", 32.0, 40.0),
    ("#8", 32.0, 36.0),
    ("#10", 24.0, 32.0),
    ("#12", 24.0, 28.0),
    ("1/4", 20.0, 28.0),
    ("5/16", 18.0, 24.0),
    ("3/8", 16.0, 24.0),
    ("7/16", 14.0, 20.0),
    ("1/2", 13.0, 20.0),
    ("9/16", 12.0, 18.0),
    ("5/8", 11.0, 18.0),
    ("3/4", 10.0, 16.0),
    ("7/8", 9.0, 14.0),
    ("1", 8.0, 12.0),
    ("1 1/8", 7.0, 12.0),
    ("1 1/4", 7.0, 12.0),
    ("1 3/8", 6.0, 12.0),
    ("1 1/2", 6.0, 12.0),
    ("1 3/4", 5.0, 0.0),
    ("2", 4.5, 0.0),
    ("2 1/4", 4.5, 0.0),
    ("2 1/2", 4.0, 0.0),
    ("2 3/4", 4.0, 0.0),
    ("3", 4.0, 0.0),
    ("4", 4.0, 0.0),
];

/// Words for the hand, in the languages of the columns.
const HANDS: [(&str, Hand); 6] = [
    ("lh", Hand::Left),
    ("left", Hand::Left),
    ("links", Hand::Left),
    ("rh", Hand::Right),
    ("right", Hand::Right),
    ("rechts", Hand::Right),
];

/// Thread that a designation names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ThreadSize {
    /// Nominal diameter, mm.
    pub diameter: f64,
    /// Pitch, mm.
    pub pitch: f64,
    /// Hand; `None` if the designation states none.
    pub hand: Option<Hand>,
}

/// Returns the thread of a designation: a metric one, whose pitch is the coarse one where it is left out, one of the Unified
/// series by diameter and threads an inch, or a pipe thread `G1/4`. The hand and the tolerance of a nut may follow: `LH`, `6H`,
/// `2B`, and behind a Unified thread its series.
///
/// # Errors
/// What is wrong with a text that begins as a designation; `None` for any other text.
pub(crate) fn parse(text: &str) -> Option<Result<ThreadSize, String>> {
    let text = text.trim().to_lowercase().replace(',', ".");
    if let Some(size) = text.strip_prefix('m') {
        let (diameter, rest) = number_before(size)?;
        let rest = rest.trim_start();
        let (pitch, rest) = match rest.strip_prefix(['x', '×', '*']) {
            Some(pitch) => number_before(pitch.trim_start()).map(|(pitch, rest)| (Ok(pitch), rest))?,
            None => (coarse(diameter), rest),
        };
        return Some(pitch.and_then(|pitch| with_suffix(&text, diameter, pitch, rest, None)));
    }
    if let Some(size) = text.strip_prefix('g') {
        let size = size.trim_start();
        let end = size.find(|sign: char| sign.is_alphabetic() || sign == '-').unwrap_or(size.len());
        let (_, diameter, turns) = PIPE.iter().find(|(name, ..)| *name == size[..end].trim())?;
        return Some(with_suffix(&text, *diameter, 25.4 / turns, &size[end..], None));
    }
    let (size, turns) = text.split_once('-')?;
    let (turns, rest) = number_before(turns)?;
    let of_number = UNIFIED.iter().find(|(name, coarse, fine)| {
        // Drawings write 10-32 for #10-32.
        name.strip_prefix('#') == Some(size) && (turns == *coarse || turns == *fine)
    });
    let size = of_number.map_or(size, |(name, ..)| name);
    let inches = match size.strip_prefix('#') {
        Some(number) => 0.060 + 0.013 * f64::from(number.parse::<u8>().ok()?),
        None => size.split(' ').map(fraction).sum::<Option<f64>>()?,
    };
    if turns <= 0.0 || !inches.is_finite() {
        return None;
    }
    let series = UNIFIED.iter().find(|(name, ..)| *name == size).map_or((0.0, 0.0), |(_, c, f)| (*c, *f));
    let (diameter, pitch) = (to_places(25.4 * inches), 25.4 / turns);
    Some(with_suffix(&text, diameter, pitch, rest, Some((turns, series))))
}

/// Completes a thread by what follows its size. `unified` are the threads an inch of a Unified thread, and those of its size in
/// the coarse and the fine series.
fn with_suffix(
    text: &str,
    diameter: f64,
    pitch: f64,
    suffix: &str,
    unified: Option<(f64, (f64, f64))>,
) -> Result<ThreadSize, String> {
    let mut hand = None;
    for word in suffix.split([' ', '-', '–', '(', ')']).filter(|word| !word.is_empty()) {
        let in_series = unified.map(|(turns, (coarse, fine))| match word {
            "un" | "unef" | "uns" => Some(turns),
            "unc" => Some(coarse),
            "unf" => Some(fine),
            _ => None,
        });
        match (HANDS.iter().find(|(name, _)| *name == word), in_series.flatten(), unified) {
            (Some((_, one)), ..) => hand = Some(*one),
            (None, Some(turns), Some((own, _))) if turns == own => {}
            (None, Some(turns), Some((own, _))) if turns > 0.0 => {
                return Err(format!(
                    "'{text}': {} of this size has {turns} threads an inch, not {own}",
                    word.to_uppercase()
                ));
            }
            (None, Some(_), _) => {
                return Err(format!("'{text}': the series {} has no such size", word.to_uppercase()));
            }
            _ if is_tolerance(word) => {}
            _ => {
                return Err(format!(
                    "'{text}': '{word}' is unknown; behind the size of a thread stand its hand (LH, RH), the tolerance \
                     (6H, 2B) or a Unified series (UNC, UNF, UNEF, UNS, UN); any other thread is its diameter and pitch in \
                     numbers"
                ));
            }
        }
    }
    Ok(ThreadSize { diameter, pitch, hand })
}

/// Returns true for the tolerance class of a nut: `6h` (ISO 965-1) or `2b` (ASME B1.1).
fn is_tolerance(word: &str) -> bool {
    matches!(word.as_bytes(), [b'4'..=b'8', b'g' | b'h'] | [b'1'..=b'3', b'b'])
}

/// Returns the number with which a text begins, and what follows it.
fn number_before(text: &str) -> Option<(f64, &str)> {
    let end = text.find(|sign: char| !(sign.is_ascii_digit() || sign == '.')).unwrap_or(text.len());
    Some((text[..end].parse().ok()?, &text[end..]))
}

fn coarse(diameter: f64) -> Result<f64, String> {
    let pitch = COARSE.iter().find_map(|(nominal, pitch)| (*nominal == diameter).then_some(*pitch));
    pitch
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
    use super::super::hand::Hand;
    use super::{ThreadSize, parse};

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
            ("10-32", 4.826, 25.4 / 32.0),
            ("8-32", 4.1656, 25.4 / 32.0),
            ("1-8", 25.4, 25.4 / 8.0),
            ("1-64", 1.8542, 25.4 / 64.0),
            ("1/4-28 UNF-2B", 6.35, 25.4 / 28.0),
            ("3/8-32 UNEF", 9.525, 25.4 / 32.0),
            ("M10x1-6H", 10.0, 1.0),
            ("G1/4", 13.157, 25.4 / 19.0),
            ("G 1 1/2", 47.803, 25.4 / 11.0),
        ] {
            assert_eq!(parse(text), Some(Ok(ThreadSize { diameter, pitch, hand: None })), "{text}");
        }
    }

    #[test]
    fn a_hand_behind_the_size_is_the_threads_hand() {
        for (text, diameter, pitch) in [
            ("1/4-20 LH", 6.35, 1.27),
            ("M8x1.25LH", 8.0, 1.25),
            ("M8 LH", 8.0, 1.25),
            ("1/4-20 UNC-2B-LH", 6.35, 1.27),
        ] {
            let hand = Some(Hand::Left);
            assert_eq!(parse(text), Some(Ok(ThreadSize { diameter, pitch, hand })), "{text}");
        }
        assert_eq!(parse("G1/4 RH").unwrap().unwrap().hand, Some(Hand::Right));
    }

    #[test]
    fn what_follows_a_size_is_known_or_an_error() {
        for (text, part) in [
            ("1/4-18 NPT", "'npt' is unknown"),
            ("1/4-19 BSPP", "'bspp' is unknown"),
            ("1/4-20 xyz", "'xyz' is unknown"),
            ("1/4-20 UNF", "UNF of this size has 28 threads an inch, not 20"),
            ("1/4-28 UNC", "UNC of this size has 20 threads an inch, not 28"),
            ("2-12 UNF", "the series UNF has no such size"),
            ("M8 2x", "'2x' is unknown"),
        ] {
            let message = parse(text).unwrap().unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
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
