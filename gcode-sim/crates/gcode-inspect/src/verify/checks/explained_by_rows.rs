//! Positions that follow from the rows: a hole that lies where its misplaced row puts it has no fault of its own.
use super::*;
use crate::flutes::wrap_angle;
use crate::verify::rows::{PatternRow, full_azimuth};

/// Largest distance of a hole from its position in the row due to rounding to 0.01, mm and degrees.
const ROUNDING_ALLOWANCE: f64 = 0.03;

/// Returns a predicate that is true for subjects whose position follows from the rows; `None` without rows.
pub(super) fn explains<'c>(inspection: &'c HoleInspection<'c>) -> Option<impl Fn(Subject) -> bool + 'c> {
    let comparison = &inspection.comparison;
    let rows = inspection.rows.as_ref()?;
    let pattern = rows.pattern;
    let scale = rows.typical_gap.0 / rows.nominal_gap().0;
    let spacing = rows.spacing.map_or(pattern.pitch, |(spacing, _)| spacing);
    let positions: Vec<Option<(Deg, f64)>> = (0..comparison.actual.len())
        .map(|index| comparison.crossing(index).map(|at| (full_azimuth(&at), at.x)))
        .collect();
    let within = comparison.tolerances.position.max(ROUNDING_ALLOWANCE);
    let is_near =
        |row: &PatternRow, at: Deg, tolerance: f64| wrap_angle((at - row.azimuth).0).abs() <= tolerance;
    let actual_of: BTreeMap<usize, usize> =
        comparison.pairs.iter().map(|pair| (pair.nominal, pair.actual)).collect();
    let is_on_grid = move |(at, x): (Deg, f64)| {
        let tolerance = ROUNDING_ALLOWANCE + Deg::atan2(within, pattern.diameter / 2.0).0;
        rows.rows.iter().filter(|row| is_near(row, at, tolerance)).any(|row| {
            let steps = (x - row.start) / spacing;
            (steps - steps.round()).abs() * spacing <= within
        })
    };
    Some(move |subject: Subject| match subject {
        Subject::Extra(actual) => positions[actual].is_some_and(is_on_grid),
        Subject::Nominal(nominal) => {
            if let Some(actual) = actual_of.get(&nominal) {
                return positions[*actual].is_some_and(is_on_grid);
            }
            // The row in place of this one has its hole there, or ends before it.
            let entry = Point3::from(comparison.nominal[nominal].entry);
            let azimuth = pattern.row_angle() * (pattern.row_of(&entry) as f64 * scale);
            let tolerance = rows.typical_gap.0 / 4.0;
            let Some(row) = rows.rows.iter().find(|row| is_near(row, azimuth, tolerance)) else {
                return true;
            };
            let x = row.start + ((entry.x - entry.x % pattern.pitch) / pattern.pitch).round() * spacing;
            let is_there =
                |(angle, along): &(Deg, f64)| is_near(row, *angle, tolerance) && (along - x).abs() <= within;
            positions.iter().flatten().any(is_there) || pattern.length < x + within
        }
        Subject::Whole | Subject::Motion => true,
    })
}
