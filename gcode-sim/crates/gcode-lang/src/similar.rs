//! The known name that a misspelt one means.

/// Returns the known name nearest to a misspelt one: one letter left out, added, changed or swapped with its neighbour, two of
/// them in a name of six letters or more. Upper and lower case don't count, and digits have to agree: G53 is no slip of G54.
/// `None` if no name is so near.
pub fn similar<'n>(name: &str, known: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let limit = if name.chars().count() < 6 { 1 } else { 2 };
    let digits = |name: &str| name.chars().filter(char::is_ascii_digit).collect::<String>();
    let alike = known.into_iter().filter(|other| digits(other) == digits(name));
    let near = alike.map(|other| (distance(name, other), other));
    // Of a name of two letters every other one is near.
    let near =
        near.filter(|(distance, other)| *distance <= limit && *distance < other.chars().count().min(3));
    near.min_by_key(|(distance, _)| *distance).map(|(_, other)| other)
}

/// Returns the least number of letters left out, added, changed, or swapped with their neighbour.
fn distance(a: &str, b: &str) -> usize {
    let letters = |text: &str| text.to_lowercase().chars().collect::<Vec<_>>();
    let (a, b) = (letters(a), letters(b));
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, other) in b.iter().enumerate() {
            let changed = last[j] + usize::from(letter != other);
            let mut least = changed.min(last[j + 1] + 1).min(row[j] + 1);
            if 0 < i && 0 < j && *letter == b[j - 1] && a[i - 1] == *other {
                least = least.min(before[j - 1] + 1);
            }
            row.push(least);
        }
        (before, last) = (last, row);
    }
    last.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_one_letter_left_out_added_changed_or_swapped() {
        let known = ["depth", "diameter", "length", "x", "G54"];
        for (slip, meant) in [
            ("dept", Some("depth")),
            ("depthh", Some("depth")),
            ("depht", Some("depth")),
            ("diametre", Some("diameter")),
            ("DEPTH", Some("depth")),
            ("remark", None),
            ("y", None),
            ("deep", None),
            ("G53", None),
        ] {
            assert_eq!(similar(slip, known), meant, "{slip}");
        }
    }
}
