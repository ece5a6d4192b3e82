//! Rows of drilled holes round a cylinder: the azimuth of each and its start in x.
use nalgebra::Point3;

use super::Comparison;
use gcode_lang::units::Deg;
use gcode_part::{Pattern, azimuth};

/// Holes of one azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PatternRow {
    /// 0 to 360.
    pub azimuth: Deg,
    /// Least x, mm.
    pub start: f64,
    /// Index of the drilled hole at that x.
    pub first: usize,
}

/// All rows in the order of their azimuths.
#[derive(Debug)]
pub(super) struct PatternRows<'a> {
    pub pattern: &'a Pattern,
    pub rows: Vec<PatternRow>,
    /// Gap from each row to the next, the last one to the first.
    pub gaps: Vec<Deg>,
    /// Mean of the gaps that differ from most by no more than rounding.
    pub typical_gap: Deg,
    /// Typical distance of the holes in the first row with several, mm, and that row.
    pub spacing: Option<(f64, PatternRow)>,
}

/// Least number of rows that show an order.
const MIN_ROWS: usize = 4;

impl<'a> PatternRows<'a> {
    /// Groups the drilled holes by azimuth. `None` with too few rows, and if all holes are in place: rows only explain
    /// faults of holes.
    pub(super) fn of(comparison: &Comparison<'_>, pattern: &'a Pattern) -> Option<Self> {
        if comparison.is_all_in_place() {
            return None;
        }
        // A hole that misses the cylinder is in no row.
        let position = |index| {
            let at = comparison.crossing(index)?;
            Some((full_azimuth(&at), at.x, index))
        };
        let mut positions: Vec<(Deg, f64, usize)> =
            (0..comparison.actual.len()).filter_map(position).collect();
        positions.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        // Holes drilled at one angle have one azimuth; a row drilled twice may be near it.
        let same = pattern.row_angle().0 / 100.0;
        let mut rows: Vec<(PatternRow, Vec<f64>)> = Vec::new();
        let mut last = Deg(f64::NEG_INFINITY);
        for (azimuth, start, first) in positions {
            match rows.last_mut() {
                Some((row, xs)) if (azimuth - last).0 <= same => {
                    xs.push(start);
                    if start < row.start {
                        (row.start, row.first) = (start, first);
                    }
                }
                _ => rows.push((PatternRow { azimuth, start, first }, vec![start])),
            }
            last = azimuth;
        }
        let (mut rows, mut along): (Vec<PatternRow>, Vec<Vec<f64>>) = rows.into_iter().unzip();
        // A row just below 360° is the one at 0°.
        if let [begin, .., end] = rows.as_mut_slice()
            && begin.azimuth.0 + 360.0 - last.0 <= same
        {
            if end.start < begin.start {
                (begin.start, begin.first) = (end.start, end.first);
            }
            rows.pop();
        }
        if rows.len() < MIN_ROWS {
            return None;
        }
        let next = rows.iter().skip(1).map(|row| row.azimuth).chain([rows[0].azimuth + Deg(360.0)]);
        let gaps: Vec<Deg> = rows.iter().zip(next).map(|(row, next)| next - row.azimuth).collect();
        let typical_gap = Deg(typical_mean(gaps.iter().map(|gap| gap.0))?);
        let spacing = rows.iter().zip(&mut along).find(|(_, xs)| xs.len() > 2).and_then(|(row, xs)| {
            xs.sort_by(f64::total_cmp);
            // A hole drilled twice is no neighbour of itself.
            xs.dedup_by(|x, last| *x - *last <= pattern.pitch / 100.0);
            Some((typical_mean(xs.windows(2).map(|pair| pair[1] - pair[0]))?, *row))
        });
        Some(Self { pattern, rows, gaps, typical_gap, spacing })
    }

    /// Returns true if most rows are whole numbers of the typical gap from the first, within a tolerance: rows
    /// that are rotated one by one have a mean that fits no other.
    pub(super) fn is_evenly_spaced(&self, tolerance: Deg) -> bool {
        let is_even = |row: &&PatternRow| {
            let gaps = (row.azimuth - self.rows[0].azimuth).0 / self.typical_gap.0;
            (gaps - gaps.round()).abs() * self.typical_gap.0 <= tolerance.0
        };
        4 * self.rows.len() <= 5 * self.rows.iter().filter(is_even).count()
    }

    /// Returns true if every row begins where the first does; every second one should begin half a pitch later.
    pub(super) fn is_aligned(&self) -> bool {
        self.rows.iter().all(|row| {
            let pitches = (row.start - self.rows[0].start) / self.pattern.pitch;
            (pitches - pitches.round()).abs() < 0.1
        })
    }

    /// Returns true if the rows are those of one group: all aligned, and too far apart for both groups.
    pub(super) fn is_single_group(&self) -> bool {
        self.is_aligned() && self.typical_gap.0 > 1.25 * self.pattern.row_angle().0
    }

    /// Returns the nominal gap of these rows: of both groups in turn, or of one alone.
    pub(super) fn nominal_gap(&self) -> Deg {
        self.pattern.row_angle() * if self.is_single_group() { 2.0 } else { 1.0 }
    }
}

/// Returns the azimuth of a point, 0 to 360.
pub(super) fn full_azimuth(p: &Point3<f64>) -> Deg {
    Deg(azimuth(p).0.rem_euclid(360.0))
}

/// Returns the mean of the numbers within 2 % of the median, which is what rounding makes of equal ones. With enough
/// numbers, the one that differs most is left out: a small seam is no rounding.
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

    /// 360/257/2 = 0.700389 commanded to 0.001: gaps of 0.700 and 0.701, and a seam.
    #[test]
    fn rounded_gaps_have_the_mean_of_the_exact_ones() {
        let angles: Vec<f64> = (0..514).map(|row| (f64::from(row) * 700.389_105).round() / 1000.0).collect();
        let gaps = angles.windows(2).map(|pair| pair[1] - pair[0]).chain([9.9]);
        assert!((typical_mean(gaps).unwrap() - 0.700_389).abs() < 1e-5);
        assert_eq!(typical_mean([3.0].into_iter()), Some(3.0));
        assert_eq!(typical_mean(std::iter::empty()), None);
    }
}
