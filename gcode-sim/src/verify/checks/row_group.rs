//! A honeycomb has two groups of rows, one half a pitch later in x than the other: where all rows begin alike, one is
//! missing.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::verify::rows::Rows;

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    let Some(pattern) = comparison.pattern.filter(|_| !comparison.missing.is_empty()) else { return };
    let Some(rows) = Rows::of(comparison, pattern).filter(|rows| rows.in_step(pattern)) else { return };
    let (half, start) = (pattern.pitch / 2.0, rows.rows[0].start);
    let step = pattern.step();
    let second = comparison.wanted.iter().filter(|hole| {
        let late = (hole.entry[0] / pattern.pitch).fract();
        (0.25..0.75).contains(&late)
    });
    let message = format!(
        "one of two groups of rows is missing, half of the pattern: all {} rows begin at x {start:.3}, none is staggered; {} of {} wanted holes \
         belong to the other group",
        rows.rows.len(),
        second.count(),
        comparison.wanted.len()
    );
    let finding = Diagnostic::error("row-group", message)
        .help(format!(
            "drill the second group too: {:.4}° further round than the first, half a pitch ({half:.3} mm) later in x",
            step.0
        ))
        .at(comparison.found[rows.rows[0].first].place.clone());
    objections.push(Objection { wanted: None, finding });
}
