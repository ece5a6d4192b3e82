//! Which holes in a wrong place stand where their rows put them: those are explained by what is wrong with the rows, the
//! others are told one by one.
use nalgebra::Point3;

use super::{Comparison, HoleFinding};
use crate::verify::rows::{PatternRow, PatternRows};
use gcode_lang::units::Deg;
use gcode_part::{Pattern, azimuth};

/// What rounding to an increment, 0.01 at the coarsest, leaves between a hole and its place in its row, mm and degrees.
const ROUNDING_ALLOWANCE: f64 = 0.03;

/// Whether an objection to a place is what the rows make of it.
pub(super) fn explains<'c>(
    comparison: &'c Comparison<'c>,
    pattern: &'c Pattern,
) -> Option<impl Fn(&HoleFinding) -> bool + 'c> {
    let rows = PatternRows::of(comparison, pattern)?;
    let scale = rows.typical_gap.0 / rows.nominal_gap(pattern).0;
    let spacing = rows.spacing.map_or(pattern.pitch, |(spacing, _)| spacing);
    let places: Vec<Option<(Deg, f64)>> = comparison
        .actual
        .iter()
        .map(|hole| {
            let at = pattern.crossing(&hole.bottom(), &hole.axis)?;
            Some((Deg(azimuth(&at).0.rem_euclid(360.0)), at.x))
        })
        .collect();
    let within = comparison.tolerances.position.max(ROUNDING_ALLOWANCE);
    let near_row = move |row: &PatternRow, at: Deg, share: f64| {
        let apart = ((at - row.azimuth).0 + 180.0).rem_euclid(360.0) - 180.0;
        apart.abs() <= share
    };
    let mut found_of = vec![None; comparison.nominal.len()];
    comparison.pairs.iter().for_each(|pair| found_of[pair.nominal] = Some(pair.actual));
    Some(move |objection: &HoleFinding| {
        let drilled = objection.extra.or_else(|| objection.nominal.and_then(|wanted| found_of[wanted]));
        match (drilled, objection.nominal) {
            (Some(drilled), _) => places[drilled].is_some_and(|(at, x)| {
                let steps = |row: &PatternRow| (x - row.start) / spacing;
                let on_grid = |row: &PatternRow| (steps(row) - steps(row).round()).abs() * spacing <= within;
                let tolerance = ROUNDING_ALLOWANCE + Deg::atan2(within, pattern.diameter / 2.0).0;
                rows.rows.iter().filter(|row| near_row(row, at, tolerance)).any(on_grid)
            }),
            // The row that stands for this one has its hole there, or ends before it.
            (None, Some(wanted)) => {
                let entry = Point3::from(comparison.nominal[wanted].entry);
                let number = pattern.row_of(&entry);
                let meant = pattern.row_angle() * (number as f64 * scale);
                let begins = entry.x % pattern.pitch;
                let along = ((entry.x - begins) / pattern.pitch).round();
                let Some(row) = rows.rows.iter().find(|row| near_row(row, meant, rows.typical_gap.0 / 4.0))
                else {
                    return true;
                };
                let x = row.start + along * spacing;
                let there = places.iter().flatten().any(|(at, place)| {
                    near_row(row, *at, rows.typical_gap.0 / 4.0) && (place - x).abs() <= within
                });
                // A row that ends right there may end before it.
                there || pattern.length < x + within
            }
            (None, None) => true,
        }
    })
}
