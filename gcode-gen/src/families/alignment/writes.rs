//! Common variables that a program overwrites, for the heads of programs and macros and for the set-up sheet.
//!
//! A control keeps #500 to #999 while it is switched off, and other cycles of the shop may store values
//! there.

/// Ranges of common variables, inclusive, in ascending order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Writes(pub(super) &'static [(u32, u32)]);

impl Writes {
    /// Returns `#501-#560 #578`, or a statement that there are none.
    pub(super) fn remark(self) -> String {
        Self::all([self])
    }

    /// Merges the ranges of several programs; adjacent ranges are joined.
    pub(super) fn all(several: impl IntoIterator<Item = Self>) -> String {
        let mut ranges: Vec<_> = several.into_iter().flat_map(|one| one.0).copied().collect();
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
        let named: Vec<_> = joined
            .into_iter()
            .map(|(from, to)| if from == to { format!("#{from}") } else { format!("#{from}-#{to}") })
            .collect();
        named.join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_that_meet_are_one() {
        assert_eq!(Writes(&[]).remark(), "NO COMMON VARIABLE");
        assert_eq!(Writes(&[(501, 560), (578, 578)]).remark(), "#501-#560 #578");
        let all = [Writes(&[(580, 585), (600, 699)]), Writes(&[(586, 589), (585, 585), (700, 700)])];
        assert_eq!(Writes::all(all), "#580-#589 #600-#700");
    }
}
