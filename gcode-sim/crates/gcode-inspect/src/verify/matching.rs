//! Matching of drilled and nominal holes, the nearest pairs first.
use std::collections::BTreeMap;
use std::sync::OnceLock;

use nalgebra::{Point3, Vector3};

use super::followers::{MIN_ALIKE_COSINE, shared_passages};
use super::position::Deviation;
use super::{DIAMETER_TOLERANCE, Tolerances, bottom};
use crate::holes::{DrilledHole, PassCut, ToolPass};
use crate::machine::{COS_30, Machine, ToolKind, ToolPart};
use gcode_lang::shares;
use gcode_part::{
    EntryPlanes, FeatureKind, Hole, LocalSearch, MAX_BREAK_THROUGH, POINT_LENGTH, Pattern, PointTree,
    Surface, Taper, exceeds,
};

/// Largest distance of a drilled hole's axis from a matching nominal entry and bottom, mm.
const MAX_LINE_DISTANCE: f64 = 5.0;

/// Least distance within which holes are matched first, mm.
const FIRST_DISTANCE: f64 = 0.01;

/// Largest difference of the depths of two passes that are one pass and its repetition, mm.
const MAX_DEPTH_DIFFERENCE: f64 = 0.01;

/// Largest difference between distances that count as equal, mm.
const NEARNESS: f64 = 1e-6;

/// Cosine of 30°: between directions that differ by more a hole is another one, not a tilted one.
const TILTED_HOLE_COSINE: f64 = COS_30;

/// A nominal hole and the drilled one matched with it, by their indices in the lists.
#[derive(Clone, Copy, Debug)]
pub struct HolePair {
    /// Index of the nominal hole.
    pub nominal: usize,
    /// Index of the drilled hole.
    pub actual: usize,
    /// Deviation of the drilled hole.
    pub deviation: Deviation,
    /// Index of a further drilled hole, from the other side of a through hole.
    pub from_far_side: Option<usize>,
}

/// Nominal and drilled holes, and their matching.
#[derive(Debug)]
pub struct Comparison<'a> {
    /// Nominal holes.
    pub nominal: &'a [Hole],
    /// Drilled holes.
    pub actual: &'a [DrilledHole],
    /// Tolerances of the inspection.
    pub tolerances: Tolerances,
    /// Pattern of the nominal holes; `None` if the reference has none.
    pub pattern: Option<&'a Pattern>,
    /// Matched holes, in the order of the nominal ones.
    pub pairs: Vec<HolePair>,
    /// Nominal holes without a drilled one.
    pub missing: Vec<usize>,
    /// Drilled holes without a nominal one, and repeated ones that are no spring passes.
    pub extra: Vec<usize>,
    /// Spring passes in drilled holes.
    pub repeated: Vec<usize>,
    /// Feeds beside the part, which cut nothing.
    pub in_air: Vec<usize>,
    /// The nominal hole matched with a line, by the first drilled hole of the line.
    nominal_by_line: Vec<Option<usize>>,
    /// Entries of the nominal holes, for the first query.
    pub(super) entries: OnceLock<PointTree>,
    /// Metal round the nominal holes, for the first query.
    pub(super) collars: OnceLock<EntryPlanes>,
    /// Largest diameter of a drilled hole whose list has none, mm, for the first query.
    pub(super) widest_open: OnceLock<f64>,
}

impl<'a> Comparison<'a> {
    /// Matches the holes.
    pub fn new(
        nominal: &'a [Hole],
        actual: &'a [DrilledHole],
        tolerances: Tolerances,
        pattern: Option<&'a Pattern>,
    ) -> Self {
        // Beyond half the distance to its neighbour a hole is that neighbour.
        let near = pattern.map_or(MAX_LINE_DISTANCE, |pattern| MAX_LINE_DISTANCE.min(pattern.pitch / 4.0));
        let reach = near.max(2.0 * tolerances.position);
        // A through hole may be drilled from its far side.
        let through: Vec<usize> = (0..nominal.len()).filter(|index| nominal[*index].through).collect();
        let far_ends = through.iter().map(|index| bottom(&nominal[*index]));
        // In a through hole a feed may begin anywhere.
        let depths = nominal.iter().map(|hole| hole.depth).filter(|_| !through.is_empty());
        let inside = depths.fold(0.0, f64::max);
        let tree = PointTree::new(nominal.iter().map(|hole| Point3::from(hole.entry)).chain(far_ends));
        let candidates_within =
            |index: usize, distance: f64, search: &mut LocalSearch, candidates: &mut Vec<HolePair>| {
                let hole = &actual[index];
                let deepest = hole.bottom();
                // The finishing tool may begin inside the cut of another one, and a mill in a void whose wall it cuts above its end.
                let wall = hole.surface.filter(|_| hole.finishing_cut.milled.is_some());
                let starts = hole.passes().map(|pass| pass.cut.start).chain(wall);
                let ends = (hole.entry.inf(&deepest), hole.entry.sup(&deepest));
                let (low, high) = starts.fold(ends, |(low, high), start| (low.inf(&start), high.sup(&start)));
                let along = hole.axis.into_inner().abs() * (2.0 * (reach - distance) + inside);
                let margin = along + Vector3::repeat(distance);
                let (low, high) = (low - margin, high + margin);
                let before = candidates.len();
                search.in_box(&tree, &low, &high, &mut |point| {
                    let other = point.checked_sub(nominal.len()).map_or(point, |far_end| through[far_end]);
                    let cosine = hole.axis.dot(&Vector3::from(nominal[other].axis));
                    // The nearer end of a through hole is the one from which it is drilled.
                    let is_far_end = nominal.len() <= point;
                    if cosine.abs() < TILTED_HOLE_COSINE || is_far_end != (cosine < 0.0) {
                        return;
                    }
                    if let Some(deviation) = Deviation::new(&nominal[other], &deepest, &hole.axis)
                        && deviation.zone_diameter() <= 2.0 * distance
                    {
                        let pair = HolePair { nominal: other, actual: index, deviation, from_far_side: None };
                        candidates.push(pair);
                    }
                });
                candidates[before..].sort_unstable_by_key(|pair| pair.nominal);
            };
        let mut pair_of = vec![None; nominal.len()];
        let mut is_taken = vec![false; actual.len()];
        let mut candidates: Vec<HolePair>;
        // Most holes are near their nominal ones: those are matched first, in the same order as all at once. From the far
        // side of a through hole a match waits for all others.
        let mut distance =
            if through.is_empty() { reach.min(FIRST_DISTANCE.max(2.0 * tolerances.position)) } else { reach };
        loop {
            let open: Vec<usize> = (0..actual.len()).filter(|index| !is_taken[*index]).collect();
            candidates = shares::map_shares(&open, |open| {
                let (mut search, mut candidates) = (LocalSearch::default(), Vec::new());
                open.iter()
                    .for_each(|index| candidates_within(*index, distance, &mut search, &mut candidates));
                candidates
            });
            assign_nearest(&candidates, (nominal, actual), &mut pair_of, &mut is_taken);
            if reach <= distance {
                break;
            }
            distance = reach.min(4.0 * distance);
        }
        let mut pairs: Vec<HolePair> = pair_of.iter().flatten().copied().collect();
        if !through.is_empty() {
            join_far_sides(nominal, actual, &candidates, &mut pairs, &mut is_taken);
            let missing = candidates.iter().filter(|pair| pair_of[pair.nominal].is_none());
            let missing = missing.map(|pair| (pair.nominal, pair.actual));
            let partners = pair_of.iter().flatten().map(|pair| (pair.actual, pair.nominal)).collect();
            let shared = shared_passages(nominal, actual, missing, &partners, tolerances);
            let is_shared = |pair: &&HolePair| shared.get(&pair.nominal) == Some(&pair.actual);
            for pair in candidates.iter().filter(is_shared) {
                pair_of[pair.nominal] = Some(*pair);
                pairs.push(*pair);
            }
            pairs.sort_by_key(|pair| pair.nominal);
        }
        // The holes may be a part of a list, whose indices they keep.
        let lines = actual.iter().map(|hole| hole.first_on_line + 1).max().unwrap_or(0);
        let mut nominal_by_line = vec![None; lines];
        for pair in &pairs {
            for drilled in [pair.actual].into_iter().chain(pair.from_far_side) {
                nominal_by_line[actual[drilled].first_on_line] = Some(pair.nominal);
            }
        }
        let missing = (0..nominal.len()).filter(|index| pair_of[*index].is_none()).collect();
        let is_spring_pass = |index: &usize| {
            let hole = &actual[*index];
            let on_line: Option<usize> = nominal_by_line[hole.first_on_line];
            on_line.is_some_and(|index| is_spring_pass(hole, &nominal[index], actual, tolerances))
        };
        let left_over = (0..actual.len()).filter(|index| !is_taken[*index]);
        let (repeated, extra) = left_over.partition(is_spring_pass);
        Self {
            nominal,
            actual,
            tolerances,
            pattern,
            pairs,
            missing,
            extra,
            repeated,
            in_air: Vec::new(),
            nominal_by_line,
            entries: OnceLock::new(),
            collars: OnceLock::new(),
            widest_open: OnceLock::new(),
        }
    }

    /// Returns the depth in a through hole below which nominal holes from the far side, on its axis and at least as wide,
    /// remove the metal; infinite without one.
    pub(super) fn counter_depth(&self, hole: &Hole, diameter: f64) -> f64 {
        let (entry, out) = (Point3::from(hole.entry), Vector3::from(hole.axis));
        let far = entry - out * (hole.depth + MAX_BREAK_THROUGH);
        let mut least = f64::INFINITY;
        self.entries_between(&entry, &far, &mut |index| {
            let other = &self.nominal[index];
            let offset = Point3::from(other.entry) - entry;
            let is_opposite = out.dot(&Vector3::from(other.axis)) < -MIN_ALIKE_COSINE;
            let is_on_axis = offset.cross(&out).norm() <= self.tolerances.position / 2.0;
            let begins = -offset.dot(&out);
            if is_opposite && is_on_axis && !exceeds(hole.depth - begins, self.tolerances.depth) {
                least = least.min(begins + self.tolerances.depth - full_depth(other, diameter));
            }
        });
        least
    }

    /// Takes repeated passes of taps and reamers as extra ones unless they follow the pass that they repeat: called again later,
    /// they don't spring, and a thread or a fit suffers.
    pub(super) fn reject_second_finishing(&mut self, machine: &Machine) {
        let actual = self.actual;
        let is_rejected = |index: &usize| {
            let again = &actual[*index];
            let kind = machine.kind_of(again.tool);
            let is_fit =
                again.finishing_cut.is_tapping || matches!(kind, Some(ToolKind::Tap | ToolKind::Reamer));
            let on_line = actual[again.first_on_line..].iter();
            let mut passes = on_line
                .take_while(|hole| hole.first_on_line == again.first_on_line)
                .flat_map(DrilledHole::passes);
            let before = again.finishing_cut.order.wrapping_sub(1);
            is_fit && !passes.any(|pass| pass.tool == again.tool && pass.cut.order == before)
        };
        let (rejected, repeated): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.repeated).into_iter().partition(is_rejected);
        self.repeated = repeated;
        if !rejected.is_empty() {
            self.extra.extend(rejected);
            self.extra.sort_unstable();
        }
    }

    /// Returns the diameter of the widest nominal hole that each tool finishes whose own one is unknown.
    fn widest_by_tool(&self, machine: &Machine) -> BTreeMap<Option<u32>, f64> {
        let mut widest = BTreeMap::new();
        for (_, nominal, drilled) in self.matched() {
            let Some(diameter) = nominal.diameter.filter(|_| machine.diameter_of(drilled.tool).is_none())
            else {
                continue;
            };
            let known = widest.entry(drilled.tool).or_insert(diameter);
            *known = known.max(diameter);
        }
        widest
    }

    /// Leaves out of the extra holes the feeds whose tool stays in the air. A tool of unknown diameter is as wide as the holes
    /// that it finishes; one that finishes none counts by its tip.
    /// Those near a missing hole stay: they explain it, as the rows of a pattern do that lacks holes.
    pub(super) fn leave_out_air_feeds(&mut self, surface: &Surface, voids: &[Surface], machine: &Machine) {
        if self.pattern.is_some() && !self.missing.is_empty() {
            return;
        }
        let (nominal, actual, missing) = (self.nominal, self.actual, &self.missing);
        let widest_by_tool = self.widest_by_tool(machine);
        let is_left_out = |index: &usize| {
            let end = actual[*index].bottom();
            let is_near = |nominal: &Hole| {
                let entry = Point3::from(nominal.entry);
                (entry - end).cross(&actual[*index].axis).norm() <= MAX_LINE_DISTANCE
            };
            // A feed across the tool has no depth: its ends count.
            let is_known = actual[*index].unknown_axes.is_none();
            let is_in_air = is_known
                && actual[*index].passes().all(|pass| {
                    let nominal = widest_by_tool.get(&pass.tool).copied();
                    is_in_air(&pass, surface, machine, nominal)
                });
            // A circle in a void that meets no metal, neither on its axis nor at its wall.
            let hole = &actual[*index];
            let is_in_void = |pass: ToolPass<'_>| {
                let is_inside = |p: &Point3<f64>| voids.iter().any(|void| void.value(p) < 0.0);
                pass.cut.milled.is_some() && pass.diameter.is_some() && is_inside(&pass.cut.bottom)
            };
            let is_clear = is_known && hole.surface.is_none() && hole.passes().all(is_in_void);
            (is_in_air || is_clear) && !missing.iter().any(|missing| is_near(&nominal[*missing]))
        };
        (self.in_air, self.extra) = std::mem::take(&mut self.extra).into_iter().partition(is_left_out);
    }

    /// Returns the matched pairs with their holes.
    pub(super) fn matched(&self) -> impl Iterator<Item = (&HolePair, &'a Hole, &'a DrilledHole)> {
        let (nominal, actual) = (self.nominal, self.actual);
        self.pairs.iter().map(move |pair| (pair, &nominal[pair.nominal], &actual[pair.actual]))
    }

    /// Returns the drilled hole that gives a pair its diameter: what is cut from the far side, if that alone is as wide as
    /// nominal.
    pub(super) fn finishing(&self, pair: &HolePair) -> &'a DrilledHole {
        let nominal = self.nominal[pair.nominal].diameter;
        let off = |drilled: &DrilledHole| Some(drilled.diameter? - nominal?);
        let limit = self.tolerances.diameter;
        let near = &self.actual[pair.actual];
        let is_narrow = off(near).is_some_and(|off| exceeds(-off, limit));
        let far = pair.from_far_side.filter(|_| is_narrow).map(|index| &self.actual[index]);
        let is_as_wide = |far: &&DrilledHole| off(far).is_some_and(|off| !exceeds(off.abs(), limit));
        far.filter(is_as_wide).unwrap_or(near)
    }

    /// Returns the pair of a nominal hole; `None` of a missing one.
    pub(super) fn pair_of(&self, nominal: usize) -> Option<&HolePair> {
        let place = self.pairs.binary_search_by_key(&nominal, |pair| pair.nominal).ok()?;
        Some(&self.pairs[place])
    }

    /// Returns the nominal hole that an extra hole drills a second time; `None` if there is none.
    pub fn nominal_on_line_of(&self, extra: usize) -> Option<usize> {
        self.nominal_by_line[self.actual[extra].first_on_line]
    }

    /// Returns the nominal hole whose first pass lies on the line of a drilled one; `None` if there is none.
    pub(super) fn nominal_on_line(&self, drilled: &DrilledHole) -> Option<usize> {
        let on_line = |pair: &&HolePair| pair.actual == drilled.first_on_line;
        self.pairs.iter().find(on_line).map(|pair| pair.nominal)
    }

    /// Returns the point of the pattern's cylinder at which a drilled hole crosses it; `None` if it misses.
    pub(super) fn crossing(&self, actual: usize) -> Option<Point3<f64>> {
        let hole = &self.actual[actual];
        self.pattern?.crossing(&hole.bottom(), &hole.axis)
    }

    /// Returns true if the axis of a pair lies in its tolerance zone.
    pub(super) fn is_in_place(&self, pair: &HolePair) -> bool {
        !exceeds(pair.deviation.zone_diameter(), self.tolerances.position)
    }

    /// Returns true if no hole is missing or extra, and every axis lies in its zone.
    pub fn is_all_in_place(&self) -> bool {
        self.missing.is_empty()
            && self.extra.is_empty()
            && self.pairs.iter().all(|pair| self.is_in_place(pair))
    }

    /// Returns the id of a nominal hole.
    pub fn id(&self, nominal: usize) -> &str {
        self.nominal[nominal].id.as_deref().unwrap_or("?")
    }
}

/// Returns the depth down to which a hole is at least as wide as `diameter`, mm. A drill's point may end it.
fn full_depth(hole: &Hole, diameter: f64) -> f64 {
    let depth = |kind: FeatureKind, own: f64, bottom: f64| match kind {
        FeatureKind::Drill => bottom - POINT_LENGTH * own,
        _ => bottom,
    };
    if hole.features.is_empty() {
        let own = hole.diameter.filter(|own| diameter <= *own + DIAMETER_TOLERANCE);
        return own.map_or(0.0, |own| depth(FeatureKind::Drill, own, hole.depth));
    }
    let wide = hole.features.iter().filter(|one| {
        !matches!(one.kind, FeatureKind::Countersink | FeatureKind::Tap)
            && diameter <= one.diameter + DIAMETER_TOLERANCE
    });
    wide.map(|one| depth(one.kind, one.diameter, one.bottom())).fold(0.0, f64::max)
}

/// Returns true if a tool goes a second time to the same depth of a hole, within the tolerance of its position: a spring pass,
/// which cuts nothing. A tap spoils the thread unless it is in step with it.
fn is_spring_pass(
    again: &DrilledHole,
    nominal: &Hole,
    actual: &[DrilledHole],
    tolerances: Tolerances,
) -> bool {
    let is_in_place = Deviation::new(nominal, &again.bottom(), &again.axis)
        .is_some_and(|deviation| !exceeds(deviation.zone_diameter(), tolerances.position));
    let is_same = |pass: &ToolPass<'_>| {
        let deeper = (pass.cut.bottom - again.bottom()).dot(&again.axis);
        let is_in_thread = !pass.cut.is_tapping || is_in_step(&pass.cut, &again.finishing_cut, &again.axis);
        pass.tool == again.tool && is_in_thread && deeper.abs() <= MAX_DEPTH_DIFFERENCE
    };
    let mut earlier = actual.get(again.first_on_line).into_iter().flat_map(DrilledHole::passes);
    is_in_place && earlier.any(|pass| is_same(&pass))
}

/// Returns true if a tap follows the thread of its earlier pass: rigid tapping goes on with the same pitch, from a height whole
/// pitches away.
fn is_in_step(one: &PassCut, again: &PassCut, axis: &Vector3<f64>) -> bool {
    let off = step_off(one, again, axis);
    is_one_run(one, again) && off.is_some_and(|off| off <= MAX_DEPTH_DIFFERENCE)
}

/// Returns true if the spindle keeps its angle at each height between two strokes of a tap.
pub(super) fn is_one_run(one: &PassCut, again: &PassCut) -> bool {
    again.is_tapping && 0 < again.rigid_run && again.rigid_run == one.rigid_run
}

/// Returns how far the start of a tap's stroke is from whole pitches above that of an earlier one, mm; `None` if their pitches
/// differ.
pub(super) fn step_off(one: &PassCut, again: &PassCut, axis: &Vector3<f64>) -> Option<f64> {
    let pitch = |cut: &PassCut| cut.feed.map(|feed| feed.0 / cut.speed.0);
    let (own, other) = pitch(again).zip(pitch(one))?;
    let turns = (again.start - one.start).dot(axis) / own;
    (!exceeds((own - other).abs(), 1e-6)).then_some((turns - turns.round()).abs() * own)
}

/// Returns true if a pass cuts nothing of the body; `nominal` is the diameter of a tool that the tool table lacks. A circle that
/// leaves a core goes round the metal: its tip alone counts.
fn is_in_air(pass: &ToolPass<'_>, surface: &Surface, machine: &Machine, nominal: Option<f64>) -> bool {
    let PassCut { start, bottom, milled, .. } = pass.cut;
    if surface.value(&surface.deepest_between(&start, &bottom)) <= 0.0 {
        return false;
    }
    let cuts = |part: ToolPart| part.cuts(surface, (&bottom, &pass.axis), &(start - bottom));
    let own = machine.diameter_of(pass.tool);
    if let (None, None, Some(diameter)) = (own, milled, nominal) {
        let from = POINT_LENGTH * diameter;
        return !cuts(ToolPart::flutes(from, from, diameter / 2.0));
    }
    let Some((own, cut)) = own.zip(pass.diameter).filter(|_| milled.is_none_or(|cut| cut.core.is_none()))
    else {
        return true;
    };
    // A circle cuts wider than its tool.
    let wider = |part: ToolPart| {
        let taper = Taper { radius: part.taper.radius + (cut - own) / 2.0, ..part.taper };
        ToolPart { taper, ..part }
    };
    let mut parts = machine.tool_end(pass.tool).into_iter().map(wider);
    !parts.any(cuts)
}

/// Matches the nominal and drilled holes that are left: the nearest pairs first, of equally near ones the first in the list;
/// those from the far side of a through hole after all others.
fn assign_nearest(
    candidates: &[HolePair],
    (nominal, actual): (&[Hole], &[DrilledHole]),
    pair_of: &mut [Option<HolePair>],
    is_taken: &mut [bool],
) {
    // A repeated pass comes last; of the steps of a hole, which are as near, that of the same depth comes first.
    let nearness = |(index, pair): (usize, &HolePair)| {
        let (hole, other) = (&nominal[pair.nominal], &actual[pair.actual]);
        let off = (other.bottom() - bottom(hole)).dot(&Vector3::from(hole.axis)).abs();
        let whole = |length: f64| (length / NEARNESS).round() as u64;
        let is_far = is_from_far_side(pair, nominal, actual);
        let is_again = other.first_on_line != pair.actual;
        (is_far, whole(pair.deviation.zone_diameter()), is_again, whole(off), index)
    };
    let mut order: Vec<(bool, u64, bool, u64, usize)> = candidates.iter().enumerate().map(nearness).collect();
    order.sort_unstable();
    for (.., index) in order {
        let pair = candidates[index];
        if pair_of[pair.nominal].is_none() && !is_taken[pair.actual] {
            pair_of[pair.nominal] = Some(pair);
            is_taken[pair.actual] = true;
        }
    }
}

/// Returns true if a hole is drilled from the far side of a through hole.
fn is_from_far_side(pair: &HolePair, nominal: &[Hole], actual: &[DrilledHole]) -> bool {
    let nominal = &nominal[pair.nominal];
    nominal.through && actual[pair.actual].axis.dot(&Vector3::from(nominal.axis)) < 0.0
}

/// Adds to the pair of each through hole the nearest hole that is left over on its other side. The pair itself is the one
/// from the side of the nominal entry, if there are two.
fn join_far_sides(
    nominal: &[Hole],
    actual: &[DrilledHole],
    candidates: &[HolePair],
    pairs: &mut [HolePair],
    is_taken: &mut [bool],
) {
    let is_far = |pair: &HolePair| is_from_far_side(pair, nominal, actual);
    let mut left_over: BTreeMap<usize, Vec<&HolePair>> = BTreeMap::new();
    for candidate in candidates.iter().filter(|one| nominal[one.nominal].through && !is_taken[one.actual]) {
        left_over.entry(candidate.nominal).or_default().push(candidate);
    }
    for pair in pairs.iter_mut() {
        let others = left_over.get(&pair.nominal).into_iter().flatten();
        let others = others.filter(|other| is_far(other) != is_far(pair) && !is_taken[other.actual]);
        let nearness = |one: &&&HolePair| one.deviation.zone_diameter().to_bits();
        let Some(other) = others.min_by_key(nearness) else { continue };
        is_taken[other.actual] = true;
        let (near, far) = if is_far(pair) { (**other, *pair) } else { (*pair, **other) };
        *pair = HolePair { from_far_side: Some(far.actual), ..near };
    }
}
