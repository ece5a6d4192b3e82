//! The operator stops of a side, with a mark if the other side makes them differently.
use std::borrow::Cow;

use super::{Page, ReviewSide};
use gcode_review::BlockLocation;

/// An operator stop.
pub(super) struct Stop<'a> {
    pub location: Cow<'a, BlockLocation>,
    /// Difference in the other program, if any.
    pub mark: Option<&'static str>,
}

/// Returns the stops in the order of execution.
pub(super) fn stops<'a>(page: &Page<'_>, side: &ReviewSide<'a>) -> Vec<Stop<'a>> {
    let compared = page.old.map(|(_, difference)| difference.compared);
    let (index, [alone, changed]) = match side.word {
        "old" => (0, ["not executed here by the new program", "executed differently by the new program"]),
        _ => (1, ["not executed here by the old program", "executed differently by the old program"]),
    };
    let mark = |step: usize| {
        let compared = compared?;
        let is_of = |steps: &[Vec<usize>; 2]| steps[index].binary_search(&step).is_ok();
        if is_of(&compared.unpaired_steps) { Some(alone) } else { is_of(&compared.steps).then_some(changed) }
    };
    let all = side.observed.revision.record.stops();
    all.map(|(step, location)| Stop { location, mark: mark(step) }).collect()
}
