//! Holes that changed alike or for one reason, as one effect.
use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::change::{Effect, listed};
use super::descriptions::{coordinates, deeper};
use super::kinds;
use super::pass_changes::{PassChange, describe_pass};
use super::program_text::Cause;
use super::steps::near;
use gcode_lang::diag::FindingKind;
use gcode_lang::motion::{Axes, Position};

/// Differences of one hole.
#[derive(Clone, Debug, Default)]
pub(super) struct HoleDifference {
    /// Displacement of the entry, mm.
    pub moved: Option<Vector3<f64>>,
    /// Angle between the axes, degrees.
    pub tilted: Option<f64>,
    /// Displacement of the bottom along the axis, mm.
    pub depth_change: Option<f64>,
    /// Differences of its diameter and its tools, in words.
    pub tool_differences: Vec<(&'static FindingKind, String)>,
    /// Passes that changed, unlike the hole.
    pub passes: Vec<PassChange>,
}

impl HoleDifference {
    /// Returns the kind of the first difference; `None` if there is none.
    pub(super) fn kind(&self) -> Option<&'static FindingKind> {
        let kind = self.moved.map(|_| &kinds::HOLE_MOVED).or(self.tilted.map(|_| &kinds::HOLE_TILTED));
        let kind = kind.or(self.depth_change.map(|_| &kinds::HOLE_DEPTH));
        let other = kind.or(self.tool_differences.first().map(|(kind, _)| *kind));
        other.or(self.passes.first().map(|_| &kinds::HOLE_PASS))
    }

    /// Returns true if the hole begins or ends at another point.
    pub(super) fn is_displaced(&self) -> bool {
        self.moved.is_some() || self.tilted.is_some() || self.depth_change.is_some()
    }
}

/// An effect on one or more holes.
pub(super) struct HoleEffect {
    pub effect: Effect,
    /// Feeds that make the difference, by their numbers in the old and the new run.
    pub steps: [Vec<usize>; 2],
    /// Blocks that changed the tool, for a difference of a tool.
    pub tools: [Option<usize>; 2],
}

/// A changed hole, by its number in the old run.
pub(super) struct ChangedHole {
    pub hole: usize,
    pub difference: HoleDifference,
    /// Feeds that make the difference, old and new: the finishing ones if their end points differ.
    pub feeds: (usize, usize),
    /// Displacement of the finishing feed's end point, in machine coordinates.
    pub shift: Position,
    /// Passes that end at other points too.
    pub other_pass_feeds: Vec<(usize, usize)>,
    pub cause: Cause,
}

/// Holes of one effect, and the text of the first.
pub(super) struct HoleGroup {
    pub all: Vec<ChangedHole>,
    text: String,
}

/// Groups holes that changed by the same numbers, by the same displacement of the machine, or by one cause.
pub(super) fn groups(changed: Vec<ChangedHole>, axes: &Axes, tolerance: f64) -> Vec<HoleGroup> {
    let mut groups: Vec<HoleGroup> = Vec::new();
    for one in changed {
        let text = describe_differences(std::slice::from_ref(&one), true, axes, tolerance);
        let alike = groups.iter().position(|group| group.text == text);
        match alike.or_else(|| groups.iter().position(|group| is_related(&group.all[0], &one, tolerance))) {
            Some(index) => groups[index].all.push(one),
            None => groups.push(HoleGroup { all: vec![one], text }),
        }
    }
    groups
}

/// Returns true if two holes have the same tools and changed passes, and one displacement or one cause.
fn is_related(first: &ChangedHole, other: &ChangedHole, tolerance: f64) -> bool {
    let numbers =
        |one: &ChangedHole| one.difference.passes.iter().map(|pass| pass.number).collect::<Vec<_>>();
    let is_shifted = (other.difference.is_displaced() || !other.difference.passes.is_empty())
        && !near(&other.shift, &Position::default(), tolerance)
        && near(&first.shift, &other.shift, tolerance);
    first.difference.tool_differences == other.difference.tool_differences
        && numbers(first) == numbers(other)
        && (is_shifted || first.cause == other.cause)
}

impl HoleGroup {
    /// Returns the kind of the effect: that of the difference of its holes that has the highest precedence.
    pub(super) fn kind(&self) -> &'static FindingKind {
        let all = self.all.iter().filter_map(|one| one.difference.kind());
        all.min_by_key(|kind| kinds::precedence(kind.code)).unwrap_or(&kinds::HOLE_MOVED)
    }

    /// Formats the numbers of the holes if they are equal, else the largest of each.
    pub(super) fn message(&self, axes: &Axes, tolerance: f64) -> String {
        let holes: Vec<usize> = self.all.iter().map(|one| one.hole).collect();
        let has_group_text = |one: &ChangedHole| {
            describe_differences(std::slice::from_ref(one), true, axes, tolerance) == self.text
        };
        let is_alike = self.all.iter().all(has_group_text);
        format!("{}: {}", name_holes(&holes), describe_differences(&self.all, is_alike, axes, tolerance))
    }
}

/// Formats the differences of holes, with the numbers of the first if all of them are equal, else with the largest.
fn describe_differences(holes: &[ChangedHole], is_alike: bool, axes: &Axes, tolerance: f64) -> String {
    let up_to = if is_alike { "" } else { "up to " };
    let differences = || holes.iter().map(|one| &one.difference);
    let mut parts = Vec::new();
    let moved = holes.iter().filter_map(|one| Some((one.hole, one.difference.moved?)));
    if let Some((hole, shift)) = moved.max_by(|(_, a), (_, b)| a.norm().total_cmp(&b.norm())) {
        let first = &holes[0].shift;
        parts.push(if is_alike {
            format!("moved by {}", format_shift(&shift))
        } else if holes.iter().all(|one| near(&one.shift, first, tolerance)) {
            let by = coordinates(first, axes, tolerance, true);
            format!(
                "moved by {by} of the machine, up to {:.4} mm (hole {}: {})",
                shift.norm(),
                hole + 1,
                format_shift(&shift)
            )
        } else {
            format!("moved by up to {:.4} mm (hole {}: {})", shift.norm(), hole + 1, format_shift(&shift))
        });
    }
    let tilted = differences().filter_map(|one| one.tilted).max_by(f64::total_cmp);
    parts.extend(tilted.map(|angle| format!("tilted by {up_to}{angle:.4}°")));
    for is_less in [false, true] {
        let depths = differences().filter_map(|one| one.depth_change).filter(|mm| (*mm < 0.0) == is_less);
        let most = depths.max_by(|a, b| a.abs().total_cmp(&b.abs()));
        parts.extend(most.map(|mm| format!("{up_to}{:.4} mm {}", mm.abs(), deeper(mm))));
    }
    let first = &holes[0].difference;
    parts.extend(first.tool_differences.iter().map(|(_, text)| text.clone()));
    // All holes have the same changed passes.
    for index in 0..first.passes.len() {
        let alike: Vec<&PassChange> = differences().filter_map(|one| one.passes.get(index)).collect();
        parts.push(describe_pass(&alike, is_alike, axes, tolerance));
    }
    parts.join(", ")
}

fn format_shift(shift: &Vector3<f64>) -> String {
    let [x, y, z] = [shift.x, shift.y, shift.z].map(without_negative_zero);
    format!("{x:+.4} {y:+.4} {z:+.4} mm")
}

/// Formats holes as `hole 5`, `holes 1, 2, 5`.
pub(super) fn name_holes(holes: &[usize]) -> String {
    let names: Vec<String> = holes.iter().map(|hole| (hole + 1).to_string()).collect();
    format!("{} {}", if holes.len() == 1 { "hole" } else { "holes" }, listed(&names))
}

/// Returns 0 instead of −0 and of values that would be printed as −0.
pub(super) fn without_negative_zero(value: f64) -> f64 {
    if value.abs() < 5e-5 { 0.0 } else { value }
}

/// Returns runs of consecutive holes, or of holes that one block makes; `block_of` returns the block of each.
pub(super) fn consecutive_holes(
    holes: &[usize],
    firsts: &[usize],
    block_of: impl Fn(usize) -> Option<usize>,
) -> Vec<Vec<usize>> {
    let order = |hole: usize| firsts.binary_search(&hole).unwrap_or(hole);
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let mut of_block: BTreeMap<Option<usize>, usize> = BTreeMap::new();
    // The hole before, and its run.
    let mut before: Option<(usize, usize)> = None;
    for hole in holes.iter().copied() {
        let next = before.filter(|(last, _)| order(*last) + 1 == order(hole)).map(|(_, run)| run);
        let run = of_block.get(&block_of(hole)).copied().or(next).unwrap_or(runs.len());
        of_block.insert(block_of(hole), run);
        before = Some((hole, run));
        match runs.get_mut(run) {
            Some(run) => run.push(hole),
            None => runs.push(vec![hole]),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_in_a_row_or_of_one_block_are_one_run() {
        let all: Vec<usize> = (0..8).collect();
        let block = |hole: usize| Some([1, 2, 3, 4, 1, 5, 6, 6][hole]);
        // 0 and 4 are of one block, 4 and 5 follow one another; 7 is of the block of none of these.
        assert_eq!(consecutive_holes(&[0, 2, 4, 5, 7], &all, block), [vec![0, 4, 5], vec![2], vec![7]]);
        assert_eq!(consecutive_holes(&[1, 2, 3], &all, block), [vec![1, 2, 3]]);
    }
}
