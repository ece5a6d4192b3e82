//! Common variables that the programs overwrite, for the heads of programs and macros and for the set-up sheet.
//!
//! A control keeps #500 to #999 while it is switched off, and other cycles of the shop may store values
//! there.

/// Programs with the ranges of common variables that they write themselves, inclusive.
const WRITES: &[(u32, &[(u32, u32)])] = &[
    (super::chord::MATCH, &[(501, 560), (570, 578)]),
    (super::chord::TOUCH, &[(501, 560), (578, 578)]),
    (super::runout::MAIN, &[(585, 585), (590, 595)]),
    (super::runout::FIT, &[(580, 585), (600, 699), (800, 931), (936, 946)]),
    (super::sine::MAIN, &[(583, 583), (596, 596)]),
    (super::sine::TABLE, &[(586, 589)]),
];

/// Returns `#501-#560 #578`, the ranges of several programs merged, or a statement that there are none.
pub(super) fn remark(programs: impl IntoIterator<Item = u32>) -> String {
    let of_program = |number| WRITES.iter().filter(move |(program, _)| *program == number);
    merged(programs.into_iter().flat_map(of_program).flat_map(|(_, ranges)| *ranges).copied().collect())
}

/// Joins ranges that overlap or meet.
fn merged(mut ranges: Vec<(u32, u32)>) -> String {
    ranges.sort_unstable();
    let mut joined: Vec<(u32, u32)> = Vec::new();
    for (from, to) in ranges {
        match joined.last_mut() {
            Some(last) if from <= last.1 + 1 => last.1 = last.1.max(to),
            _ => joined.push((from, to)),
        }
    }
    if joined.is_empty() {
        return "NO COMMON VARIABLE".to_owned();
    }
    let range =
        |(from, to): (u32, u32)| if from == to { format!("#{from}") } else { format!("#{from}-#{to}") };
    joined.into_iter().map(range).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_that_meet_are_one() {
        assert_eq!(merged(Vec::new()), "NO COMMON VARIABLE");
        assert_eq!(merged(vec![(501, 560), (578, 578)]), "#501-#560 #578");
        let all = vec![(580, 585), (600, 699), (586, 589), (585, 585), (700, 700)];
        assert_eq!(merged(all), "#580-#589 #600-#700");
    }
}
