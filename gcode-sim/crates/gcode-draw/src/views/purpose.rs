//! Purpose of a picture of holes, a verdict or a comparison of revisions, and its wording.
use crate::scene::HoleStatus;

/// Purpose of a picture, which selects the words of the title block and the legend.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PicturePurpose {
    /// Comparison with a reference.
    #[default]
    Verdict,
    /// Comparison with another revision of the program.
    Change,
}

impl PicturePurpose {
    /// Returns the word of a status, beside a hole and in the headline, and its legend text.
    fn words(self, status: HoleStatus) -> [&'static str; 2] {
        match (self, status) {
            (Self::Verdict, HoleStatus::Good) => ["in tolerance", "in tolerance"],
            (Self::Verdict, HoleStatus::Bad) => ["out", "out of tolerance"],
            (Self::Verdict, HoleStatus::Missing) => ["missing", "missing: not made"],
            (Self::Verdict, HoleStatus::Extra) => ["extra", "extra: not in the reference"],
            (Self::Change, HoleStatus::Good) => ["unchanged", "unchanged"],
            (Self::Change, HoleStatus::Bad) => ["changed", "changed: symbol at the old position"],
            (Self::Change, HoleStatus::Missing) => ["lost", "lost: only in the old program"],
            (Self::Change, HoleStatus::Extra) => ["added", "added: only in the new program"],
            (_, HoleStatus::Unjudged) => ["not verified", "hole, not verified"],
        }
    }

    /// Returns the word beside a hole that is missing or extra, and in the headline.
    pub(super) fn status_word(self, status: HoleStatus) -> &'static str {
        self.words(status)[0]
    }

    /// Returns the legend text of a status.
    pub(super) fn legend(self, status: HoleStatus) -> &'static str {
        self.words(status)[1]
    }

    /// Returns the text before the largest deviation.
    pub(super) fn worst_label(self) -> &'static str {
        match self {
            Self::Verdict => "worst position",
            Self::Change => "largest change of position",
        }
    }

    /// Returns true if a position is shown with this many decimals; a change is shown only if it is not 0.
    pub(super) fn shows_deviation(self, phi: f64, decimals: i32) -> bool {
        self == Self::Verdict || 0.5 <= phi * libm::pow(10.0, f64::from(decimals))
    }

    /// Returns the legend text of the line to a hole's actual position.
    pub(super) fn displacement_label(self) -> &'static str {
        match self {
            Self::Verdict => "to the actual position",
            Self::Change => "to the new position",
        }
    }

    /// Returns the legend text before the diameter of the deviation circle.
    pub(super) fn deviation_label(self) -> &'static str {
        match self {
            Self::Verdict => "deviation in the tolerance zone",
            Self::Change => "displacement in a circle",
        }
    }
}

/// Returns status and headline of a comparison: `3 of 5 unchanged, 2 lost`. `counts` are the unchanged, changed, lost and
/// added holes, `others` the differences that no hole shows.
pub(super) fn change_headline(counts: [usize; 4], others: usize) -> Option<(HoleStatus, String)> {
    let purpose = PicturePurpose::Change;
    let [good, bad, missing, extra] = counts;
    let all = good + bad + missing;
    if all + extra + others == 0 {
        return None;
    }
    let wrong = [(bad, HoleStatus::Bad), (missing, HoleStatus::Missing), (extra, HoleStatus::Extra)];
    let wrong = wrong.into_iter().filter(|(number, _)| 0 < *number);
    let wrong = wrong.map(|(number, status)| format!("{number} {}", purpose.status_word(status)));
    let same = (0 < all).then(|| format!("{good} of {all} {}", purpose.status_word(HoleStatus::Good)));
    let others_words = match others {
        0 => None,
        1 => Some("1 other change".to_owned()),
        _ => Some(format!("{others} other changes")),
    };
    let is_same = all == good && extra + others == 0;
    let words: Vec<String> = same.into_iter().chain(wrong).chain(others_words).collect();
    Some((if is_same { HoleStatus::Good } else { HoleStatus::Bad }, words.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_headline_counts_the_statuses() {
        use HoleStatus::{Bad, Good};
        for (counts, others, status, words) in [
            ([4, 0, 0, 0], 0, Good, "4 of 4 unchanged"),
            ([2, 1, 0, 1], 0, Bad, "2 of 3 unchanged, 1 changed, 1 added"),
            ([4, 0, 0, 0], 1, Bad, "4 of 4 unchanged, 1 other change"),
            ([0; 4], 2, Bad, "2 other changes"),
        ] {
            assert_eq!(change_headline(counts, others), Some((status, words.to_owned())));
        }
        assert_eq!(change_headline([0; 4], 0), None);
    }
}
