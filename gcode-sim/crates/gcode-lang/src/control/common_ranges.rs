//! Ranges of common variables that an option or a machine builder adds: `400-499,900000-907399`.

/// Regular expression of the text.
pub(super) const PATTERN: &str = "^(0|[0-9]{3,6} *- *[0-9]{3,6}( *, *[0-9]{3,6} *- *[0-9]{3,6})*)$";

/// Permitted values, as in messages.
pub(super) const ALLOWED: &str = "ranges as 400-499,98000-98499, or 0";

/// Largest number of variables in all ranges.
const MOST: u32 = 100_000;

/// Variables with a meaning of their own on every control, with that meaning.
const TAKEN: &[(u32, u32, &str)] = &[
    (0, 33, "are locals"),
    (100, 199, "are common variables of every control"),
    (500, 999, "are common variables of every control"),
    (1000, 9999, "are system variables"),
    (11_000, 20_000, "are system variables"),
    (100_001, 100_200, "are system variables"),
];

/// Reads ranges, in ascending order; `0` is none. The error is the reason for the refusal.
pub(super) fn read(text: &str) -> Result<Vec<(u32, u32)>, String> {
    if text == "0" {
        return Ok(Vec::new());
    }
    let mut ranges = text.split(',').map(range).collect::<Result<Vec<_>, _>>()?;
    ranges.sort_unstable();
    for pair in ranges.windows(2) {
        if pair[1].0 <= pair[0].1 {
            return Err(format!("two ranges have #{}", pair[1].0));
        }
    }
    let count: u32 = ranges.iter().map(|(from, to)| to - from + 1).sum();
    if count > MOST { Err(format!("{count} variables, at most {MOST}")) } else { Ok(ranges) }
}

fn range(text: &str) -> Result<(u32, u32), String> {
    let number = |text: &str| text.trim().parse::<u32>().ok().filter(|number| *number <= 999_999);
    let ends = text.split_once('-').and_then(|(from, to)| Some((number(from)?, number(to)?)));
    let (from, to) = ends.ok_or_else(|| ALLOWED.to_owned())?;
    if to < from {
        return Err(format!("#{from} to #{to} ends before it begins"));
    }
    match TAKEN.iter().find(|(first, last, _)| from <= *last && *first <= to) {
        Some((first, last, what)) => Err(format!("#{first} to #{last} {what}")),
        None => Ok((from, to)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_in_any_order() {
        let builder = read("900000-907399, 400 - 499").unwrap();
        assert_eq!(builder, [(400, 499), (900_000, 907_399)]);
        assert_eq!(read("0").unwrap(), []);
        assert_eq!(read("34-99,200-499").unwrap(), [(34, 99), (200, 499)]);
    }

    #[test]
    fn a_refused_range_says_why() {
        for (text, reason) in [
            ("450-510", "#500 to #999 are common variables of every control"),
            ("5001-5010", "#1000 to #9999 are system variables"),
            ("499-400", "#499 to #400 ends before it begins"),
            ("400-499,450-460", "two ranges have #450"),
            ("400", ALLOWED),
            ("200000-400000", "200001 variables, at most 100000"),
        ] {
            assert_eq!(read(text).unwrap_err(), reason);
        }
    }
}
