//! Sizes of drills as drawings in inches have them: fractions, `21/64` and `1 1/8`, numbers, `#7`, and letters, `Q`.

/// Diameters of the numbers 1 to 60, inches (ASME B94.11M, table 1).
const NUMBERS: [f64; 60] = [
    0.2280, 0.2210, 0.2130, 0.2090, 0.2055, 0.2040, 0.2010, 0.1990, 0.1960, 0.1935, 0.1910, 0.1890, 0.1850,
    0.1820, 0.1800, 0.1770, 0.1730, 0.1695, 0.1660, 0.1610, 0.1590, 0.1570, 0.1540, 0.1520, 0.1495, 0.1470,
    0.1440, 0.1405, 0.1360, 0.1285, 0.1200, 0.1160, 0.1130, 0.1110, 0.1100, 0.1065, 0.1040, 0.1015, 0.0995,
    0.0980, 0.0960, 0.0935, 0.0890, 0.0860, 0.0820, 0.0810, 0.0785, 0.0760, 0.0730, 0.0700, 0.0670, 0.0635,
    0.0595, 0.0550, 0.0520, 0.0465, 0.0430, 0.0420, 0.0410, 0.0400,
];

/// Letters and their diameters, inches (ASME B94.11M, table 1). X is left out: in a table it may be a mark.
const LETTERS: [(&str, f64); 25] = [
    ("A", 0.234),
    ("B", 0.238),
    ("C", 0.242),
    ("D", 0.246),
    ("E", 0.250),
    ("F", 0.257),
    ("G", 0.261),
    ("H", 0.266),
    ("I", 0.272),
    ("J", 0.277),
    ("K", 0.281),
    ("L", 0.290),
    ("M", 0.295),
    ("N", 0.302),
    ("O", 0.316),
    ("P", 0.323),
    ("Q", 0.332),
    ("R", 0.339),
    ("S", 0.348),
    ("T", 0.358),
    ("U", 0.368),
    ("V", 0.377),
    ("W", 0.386),
    ("Y", 0.404),
    ("Z", 0.413),
];

/// Returns the diameter of a size in inches; `None` for any other text, as a plain number.
pub(crate) fn inches(text: &str) -> Option<f64> {
    let text = text.trim_end_matches('"').trim();
    if let Some(number) = text.strip_prefix('#') {
        return NUMBERS.get(number.parse::<usize>().ok()?.checked_sub(1)?).copied();
    }
    if let Some((_, inches)) = LETTERS.iter().find(|(letter, _)| *letter == text) {
        return Some(*inches);
    }
    let (whole, fraction) = text.split_once(' ').unwrap_or(("0", text));
    let (above, below) = fraction.split_once('/')?;
    let whole_number = |text: &str| text.parse::<u16>().ok().map(f64::from);
    let below = whole_number(below).filter(|below| 0.0 < *below)?;
    Some(whole_number(whole)? + whole_number(above)? / below)
}

#[cfg(test)]
mod tests {
    use super::inches;

    /// 21/64 = 0.328125; #7 is the tap drill of 1/4-20, 0.201; Q that of 3/8-24, 0.332.
    #[test]
    fn sizes_of_drills_are_inches() {
        for (text, size) in [
            ("21/64", 0.328_125),
            ("1/4\"", 0.25),
            ("1 1/8", 1.125),
            ("#1", 0.228),
            ("#7", 0.201),
            ("#29", 0.136),
            ("#60", 0.04),
            ("F", 0.257),
            ("Q", 0.332),
            ("Z", 0.413),
        ] {
            assert_eq!(inches(text), Some(size), "{text}");
        }
        for text in ["7", "8.5", ".201", "x", "X", "q", "#0", "#61", "1/0", "1/", "/4", "1-1/8", "AA", ""] {
            assert_eq!(inches(text), None, "{text}");
        }
    }
}
