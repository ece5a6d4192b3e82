//! A honeycomb has two groups of rows, one half a pitch later in x than the other: where all rows begin alike, one is
//! missing, or stands where the other does.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::verify::rows::Rows;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    let Some(pattern) = comparison.pattern.filter(|_| !comparison.missing.is_empty()) else { return };
    let late = |x: f64| (0.25..0.75).contains(&(x / pattern.pitch).fract());
    let second = comparison.wanted.iter().filter(|hole| late(hole.entry[0])).count();
    let Some(rows) = Rows::of(comparison, pattern).filter(|rows| rows.in_step(pattern)) else { return };
    // On a cylinder shorter than half a pitch there is one group anyway.
    if second == 0 {
        return;
    }
    let (half, count, first) = (pattern.pitch / 2.0, rows.rows.len(), rows.rows[0]);
    let (message, help) = match rows.one_group(pattern) {
        true => (
            format!(
                "one of two groups of rows is missing, half of the pattern: all {count} rows begin at x {:.3}, none is \
                 staggered; {second} of {} wanted holes belong to the other group",
                first.start,
                comparison.wanted.len()
            ),
            format!(
                "drill the second group too: {:.4}° further round than the first, half a pitch ({half:.3} mm) later in x",
                pattern.step().0
            ),
        ),
        false => (
            format!("no row is staggered: all {count} rows begin at x {:.3}", first.start),
            format!("every second row begins half a pitch later in x: {half:.3} mm"),
        ),
    };
    let finding =
        Diagnostic::error("row-group", message).help(help).at(comparison.found[first.first].place.clone());
    objections.push(Objection { wanted: None, finding });
}
