//! Holes that changed alike or for one reason, told once.
use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::cause::Cause;
use super::change::{Effect, listed};
use super::descriptions::{coordinates, deeper};
use super::pass_changes::PassChange;
use super::steps::near;
use gcode_lang::motion::{Axes, Position};

/// All that is different about one hole.
#[derive(Clone, Debug, Default)]
pub(super) struct HoleDifference {
    /// Where it begins, mm.
    pub moved: Option<Vector3<f64>>,
    /// Degrees.
    pub tilted: Option<f64>,
    /// mm.
    pub deeper: Option<f64>,
    /// Its diameter and its tools: what they are called, and in words.
    pub others: Vec<(&'static str, String)>,
    /// Its passes that end elsewhere and not as the hole does.
    pub strayed: Vec<PassChange>,
}

impl HoleDifference {
    /// What the change is called; nothing where nothing is different.
    pub(super) fn code(&self) -> Option<&'static str> {
        let place = self.moved.map(|_| "hole-moved").or(self.tilted.map(|_| "hole-tilted"));
        let place = place.or(self.deeper.map(|_| "hole-depth"));
        let other = place.or(self.others.first().map(|(code, _)| *code));
        other.or(self.strayed.first().map(|_| "hole-pass"))
    }

    /// It begins or ends elsewhere.
    pub(super) fn is_elsewhere(&self) -> bool {
        self.moved.is_some() || self.tilted.is_some() || self.deeper.is_some()
    }

    fn text(&self, axes: &Axes, tolerance: f64) -> String {
        let mut parts = Vec::new();
        parts.extend(self.moved.map(|way| format!("moved by {}", shown(&way))));
        parts.extend(self.tilted.map(|angle| format!("tilted by {angle:.4}°")));
        parts.extend(self.deeper.map(|mm| format!("{:.4} mm {}", mm.abs(), deeper(mm))));
        parts.extend(self.others.iter().map(|(_, text)| text.clone()));
        parts.extend(self.strayed.iter().map(|pass| pass.text(axes, tolerance)));
        parts.join(", ")
    }
}

/// What is different about one or more holes.
pub(super) struct HoleEffect {
    pub effect: Effect,
    /// The feeds that make it so, by their numbers in either run.
    pub steps: [Vec<usize>; 2],
    /// The blocks that have put the tools in, where it is about a tool.
    pub tools: [Option<usize>; 2],
}

/// A changed hole, by its number in the old run.
pub(super) struct ChangedHole {
    pub hole: usize,
    pub aspects: HoleDifference,
    /// The feed that makes the difference, before and now: the finishing one, where that isn't as it was.
    pub feeds: (usize, usize),
    /// How far that feed ends from where it ended, in machine coordinates.
    pub shift: Position,
    /// The passes that end elsewhere too.
    pub others: Vec<(usize, usize)>,
    pub cause: Cause,
}

/// Some of them that are one entry.
pub(super) struct HoleGroup {
    /// The first is what the group is known by.
    pub all: Vec<ChangedHole>,
    text: String,
}

/// Holes that changed by the same numbers, that the machine makes elsewhere by the same, or that have one cause.
pub(super) fn groups(changed: Vec<ChangedHole>, axes: &Axes, tolerance: f64) -> Vec<HoleGroup> {
    let mut groups: Vec<HoleGroup> = Vec::new();
    for one in changed {
        let text = one.aspects.text(axes, tolerance);
        let alike = groups.iter().position(|group| group.text == text);
        let found = alike.or_else(|| groups.iter().position(|group| group.is_with(&one, tolerance)));
        match found {
            Some(place) => groups[place].all.push(one),
            None => groups.push(HoleGroup { all: vec![one], text }),
        }
    }
    groups
}

impl HoleGroup {
    fn is_with(&self, other: &ChangedHole, tolerance: f64) -> bool {
        let first = &self.all[0];
        let is_strayed = !other.aspects.strayed.is_empty();
        let by_the_same = (other.aspects.is_elsewhere() || is_strayed)
            && !near(&other.shift, &Position::default(), tolerance)
            && near(&first.shift, &other.shift, tolerance);
        let numbers =
            |one: &ChangedHole| one.aspects.strayed.iter().map(PassChange::pass).collect::<Vec<_>>();
        let is_alike = first.aspects.others == other.aspects.others && numbers(first) == numbers(other);
        is_alike && (by_the_same || first.cause == other.cause)
    }

    /// The change's name: of all that is different about its holes the first.
    pub(super) fn code(&self) -> &'static str {
        let all = ["hole-moved", "hole-tilted", "hole-depth"];
        let codes: Vec<_> = self.all.iter().filter_map(|one| one.aspects.code()).collect();
        let place = all.into_iter().find(|code| codes.contains(code));
        place.or(codes.first().copied()).unwrap_or("hole-moved")
    }

    /// With all their numbers where these are the same, else the largest of each.
    pub(super) fn message(&self, axes: &Axes, tolerance: f64) -> String {
        let holes: Vec<usize> = self.all.iter().map(|one| one.hole).collect();
        let is_alike = self.all.iter().all(|one| one.aspects.text(axes, tolerance) == self.text);
        let text = if is_alike { self.text.clone() } else { self.ranges(axes, tolerance) };
        format!("{}: {text}", named(&holes))
    }

    fn ranges(&self, axes: &Axes, tolerance: f64) -> String {
        let mut parts = Vec::new();
        let moved = self.all.iter().filter_map(|one| Some((one.hole, one.aspects.moved?)));
        if let Some((hole, way)) = moved.max_by(|(_, a), (_, b)| a.norm().total_cmp(&b.norm())) {
            let first = &self.all[0].shift;
            let by_machine = self.all.iter().all(|one| near(&one.shift, first, tolerance));
            let by = match by_machine {
                true => format!("by {} of the machine, up to ", coordinates(first, axes, tolerance, true)),
                false => "by up to ".to_owned(),
            };
            parts.push(format!("moved {by}{:.4} mm (hole {}: {})", way.norm(), hole + 1, shown(&way)));
        }
        let tilted = self.all.iter().filter_map(|one| one.aspects.tilted);
        parts.extend(tilted.max_by(f64::total_cmp).map(|angle| format!("tilted by up to {angle:.4}°")));
        for less in [false, true] {
            let deepers = self.all.iter().filter_map(|one| one.aspects.deeper);
            let most = deepers.filter(|mm| (*mm < 0.0) == less).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            parts.extend(most.map(|mm| format!("up to {:.4} mm {}", mm.abs(), deeper(mm))));
        }
        parts.extend(self.all[0].aspects.others.iter().map(|(_, text)| text.clone()));
        // The same passes have strayed in every hole.
        for (place, first) in self.all[0].aspects.strayed.iter().enumerate() {
            let alike = self.all.iter().filter_map(|one| one.aspects.strayed.get(place));
            parts.push(first.up_to(alike, axes, tolerance));
        }
        parts.join(", ")
    }
}

fn shown(way: &Vector3<f64>) -> String {
    let [x, y, z] = [way.x, way.y, way.z].map(plain);
    format!("{x:+.4} {y:+.4} {z:+.4} mm")
}

/// `hole 5`, `holes 1, 2, 5`.
pub(super) fn named(holes: &[usize]) -> String {
    let names: Vec<String> = holes.iter().map(|hole| (hole + 1).to_string()).collect();
    format!("{} {}", if holes.len() == 1 { "hole" } else { "holes" }, listed(&names))
}

/// Returns 0 instead of −0 and of values that would be printed as −0.
pub(super) fn plain(value: f64) -> f64 {
    if value.abs() < 5e-5 { 0.0 } else { value }
}

/// Runs of holes that follow one another, or that one block makes: `place` tells the block of each.
pub(super) fn runs(
    holes: &[usize],
    firsts: &[usize],
    place: impl Fn(usize) -> Option<usize>,
) -> Vec<Vec<usize>> {
    let order = |hole: usize| firsts.binary_search(&hole).unwrap_or(hole);
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let mut of_block: BTreeMap<Option<usize>, usize> = BTreeMap::new();
    // The hole before, and its run.
    let mut before: Option<(usize, usize)> = None;
    for hole in holes.iter().copied() {
        let next = before.filter(|(last, _)| order(*last) + 1 == order(hole)).map(|(_, run)| run);
        let run = of_block.get(&place(hole)).copied().or(next).unwrap_or(runs.len());
        of_block.insert(place(hole), run);
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
        assert_eq!(runs(&[0, 2, 4, 5, 7], &all, block), [vec![0, 4, 5], vec![2], vec![7]]);
        assert_eq!(runs(&[1, 2, 3], &all, block), [vec![1, 2, 3]]);
    }
}
