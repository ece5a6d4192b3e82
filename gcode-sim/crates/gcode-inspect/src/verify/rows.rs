//! The rows round a cylinder that the drilled holes stand in: at which azimuth, and where each begins in x.
use super::Comparison;
use gcode_lang::units::Deg;
use gcode_part::{Pattern, azimuth};

/// Holes of one azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PatternRow {
    /// 0 to 360.
    pub(super) azimuth: Deg,
    /// The least x, mm.
    pub(super) start: f64,
    /// The hole there, by its number.
    pub(super) first: usize,
}

/// All rows in the order of their azimuths.
#[derive(Debug)]
pub(super) struct PatternRows {
    pub(super) rows: Vec<PatternRow>,
    /// From each row to the next, from the last one round to the first.
    pub(super) gaps: Vec<Deg>,
    /// The mean of those that are about as large as most: single ones are rounded to the rotary's increment.
    pub(super) typical_gap: Deg,
    /// From hole to hole in the first row that has several, mm, as usual; and that row.
    pub(super) spacing: Option<(f64, PatternRow)>,
}

/// Fewer rows show no order.
const MIN_ROWS: usize = 4;

impl PatternRows {
    /// `None` where there are too few to speak of, and where all holes are in their places: what is said of rows only
    /// explains what is wrong with holes.
    pub(super) fn of(comparison: &Comparison<'_>, pattern: &Pattern) -> Option<Self> {
        if comparison.is_all_in_place() {
            return None;
        }
        let mut places: Vec<(Deg, f64, usize)> = Vec::with_capacity(comparison.actual.len());
        for (index, hole) in comparison.actual.iter().enumerate() {
            // A hole that misses the cylinder is in no row; the others' rows are still told.
            let Some(at) = pattern.crossing(&hole.bottom(), &hole.axis) else { continue };
            places.push((Deg(azimuth(&at).0.rem_euclid(360.0)), at.x, index));
        }
        places.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        // What is drilled at one angle lies at one angle; a row drilled twice may lie near by.
        let same = pattern.row_angle().0 / 100.0;
        let mut rows: Vec<PatternRow> = Vec::new();
        let mut along: Vec<Vec<f64>> = Vec::new();
        let mut last = Deg(f64::NEG_INFINITY);
        for (azimuth, start, first) in places {
            match rows.last_mut() {
                Some(row) if (azimuth - last).0 <= same => {
                    along.last_mut().into_iter().for_each(|xs| xs.push(start));
                    if start < row.start {
                        (row.start, row.first) = (start, first);
                    }
                }
                _ => {
                    rows.push(PatternRow { azimuth, start, first });
                    along.push(vec![start]);
                }
            }
            last = azimuth;
        }
        // What is just below 360 belongs to what is at 0.
        if let (Some(end), Some(begin)) = (rows.last().copied(), rows.first().copied())
            && rows.len() > 1
            && begin.azimuth.0 + 360.0 - last.0 <= same
        {
            rows.pop();
            if end.start < begin.start {
                (rows[0].start, rows[0].first) = (end.start, end.first);
            }
        }
        if rows.len() < MIN_ROWS {
            return None;
        }
        let round = rows.iter().skip(1).map(|row| row.azimuth).chain([rows[0].azimuth + Deg(360.0)]);
        let gaps: Vec<Deg> = rows.iter().zip(round).map(|(row, next)| next - row.azimuth).collect();
        let usual = Deg(typical_mean(gaps.iter().map(|gap| gap.0))?);
        let several = rows.iter().zip(&mut along).find(|(_, xs)| xs.len() > 2);
        let spacing = several.and_then(|(row, xs)| {
            xs.sort_by(f64::total_cmp);
            // A hole drilled twice is no neighbour of itself.
            xs.dedup_by(|x, last| *x - *last <= pattern.pitch / 100.0);
            Some((self::typical_mean(xs.windows(2).map(|pair| pair[1] - pair[0]))?, *row))
        });
        Some(Self { rows, gaps, typical_gap: usual, spacing })
    }

    /// Whether most rows stand whole numbers of the usual gap from the first, to so many degrees: single rows that are turned
    /// change the mean and leave it to fit no other.
    pub(super) fn is_evenly_spaced(&self, within: Deg) -> bool {
        let off = |row: &&PatternRow| {
            let gaps = (row.azimuth - self.rows[0].azimuth).0 / self.typical_gap.0;
            (gaps - gaps.round()).abs() * self.typical_gap.0 <= within.0
        };
        4 * self.rows.len() <= 5 * self.rows.iter().filter(off).count()
    }

    /// Whether every row begins where the first does, where every second one should begin half a pitch later.
    pub(super) fn is_aligned(&self, pattern: &Pattern) -> bool {
        let off = |row: &PatternRow| {
            let pitches = (row.start - self.rows[0].start) / pattern.pitch;
            (pitches - pitches.round()).abs()
        };
        self.rows.iter().all(|row| off(row) < 0.1)
    }

    /// Whether the rows are those of one group: none begins late, and they stand too far apart for both.
    pub(super) fn is_single_group(&self, pattern: &Pattern) -> bool {
        self.is_aligned(pattern) && self.typical_gap.0 > 1.25 * pattern.row_angle().0
    }

    /// From row to row as the pattern wants it, of rows that stand as these do: both groups in turn, or one alone.
    pub(super) fn nominal_gap(&self, pattern: &Pattern) -> Deg {
        if self.is_single_group(pattern) { pattern.row_angle() * 2.0 } else { pattern.row_angle() }
    }
}

/// The mean of the numbers that differ from the middle one by no more than rounding makes of them, 2 %; the one that
/// differs most isn't among them where there are enough, for a small seam is no rounding.
fn typical_mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    let middle = *sorted.get(sorted.len().checked_sub(1)? / 2)?;
    let off = |number: f64| (number - middle).abs();
    sorted.sort_by(|a, b| off(*a).total_cmp(&off(*b)));
    let most = sorted.len() - usize::from(sorted.len() >= MIN_ROWS);
    let alike = sorted[..most].iter().filter(|number| off(**number) <= 0.02 * middle.abs());
    let (sum, count) = alike.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
    Some(sum / count)
}

#[cfg(test)]
mod tests {
    use super::typical_mean;

    /// 360/257/2 = 0.700389 commanded to 0.001: gaps of 0.700 and 0.701, and a seam that isn't usual.
    #[test]
    fn rounded_gaps_have_the_mean_they_were_made_from() {
        let angles: Vec<f64> = (0..514).map(|row| (f64::from(row) * 700.389_105).round() / 1000.0).collect();
        let gaps = angles.windows(2).map(|pair| pair[1] - pair[0]).chain([9.9]);
        assert!((typical_mean(gaps).unwrap() - 0.700_389).abs() < 1e-5);
        assert_eq!(typical_mean([3.0].into_iter()), Some(3.0));
        assert_eq!(typical_mean(std::iter::empty()), None);
    }
}
