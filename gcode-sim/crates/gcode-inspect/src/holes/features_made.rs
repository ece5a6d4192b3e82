//! Features that the passes of a drilled hole make, as a reference lists them.
use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};

use super::swallowed::CutEnd;
use super::{DrilledHole, Helix, ToolPass};
use crate::machine::{Machine, PointShape, Tool, ToolKind};
use gcode_lang::motion::SpindleDirection;
use gcode_lang::units::Deg;
use gcode_part::{Feature, FeatureKind, Hand};

/// Parts of a millimetre to which a list gives lengths.
const PARTS: f64 = 1e4;

impl DrilledHole {
    /// Returns how far along the feed the last start of a feed lies that isn't in a wider cut, mm from `entry`: the surface
    /// is deeper.
    pub fn deepest_feed_start(&self) -> f64 {
        let depth = |point: &Point3<f64>| (self.entry - point).dot(&self.axis);
        let mut deepest = f64::NEG_INFINITY;
        let mut cuts: Vec<(f64, f64)> = Vec::new();
        for pass in self.passes() {
            let start = depth(&pass.cut.start);
            let width = pass.diameter.unwrap_or(f64::INFINITY);
            let is_in_a_cut = cuts.iter().any(|(wider, floor)| width <= *wider && start <= *floor);
            if !is_in_a_cut || width == f64::INFINITY {
                deepest = deepest.max(start);
            }
            cuts.push((width, depth(&pass.cut.bottom)));
        }
        deepest
    }

    /// Returns true if a pass goes deeper than `thickness` below the entry, and each that does has its full diameter there.
    /// The end of a tool of unknown shape may be a point of any length.
    pub fn breaks_out(
        &self,
        entry: &Point3<f64>,
        out: &Vector3<f64>,
        thickness: f64,
        machine: &Machine,
    ) -> bool {
        let mut beyond =
            self.passes().filter(|pass| thickness < (entry - pass.cut.bottom).dot(out)).peekable();
        let is_whole = |pass: ToolPass<'_>| {
            let tip = (entry - pass.cut.bottom).dot(out);
            let tool = pass.tool.and_then(|number| machine.find_tool(number));
            let end = match (tool.map(Tool::point), pass.diameter) {
                (Some(PointShape::Flat), _) => Some(0.0),
                (Some(point), Some(diameter)) => point.length(diameter),
                _ => None,
            };
            end.is_some_and(|end| thickness <= tip - end)
        };
        beyond.peek().is_some() && beyond.all(is_whole)
    }

    /// Returns the tools of a hole of several tools whose kind or diameter the machine file lacks, each once.
    pub fn tools_of_unknown_shape(&self, machine: &Machine) -> BTreeSet<u32> {
        let tools: BTreeSet<u32> = self.passes().filter_map(|pass| pass.tool).collect();
        let is_unknown = |number: &u32| {
            let tool = machine.find_tool(*number);
            tool.is_none_or(|tool| tool.kind.is_none()) || machine.diameter_of(Some(*number)).is_none()
        };
        if tools.len() == 1 { BTreeSet::new() } else { tools.into_iter().filter(is_unknown).collect() }
    }

    /// Returns the features of a hole that several tools make, depths from `entry`, in the order of the program. Returns none
    /// of a hole of one diameter, nor where kind or diameter of a tool is unknown: a list without features then says less, and
    /// nothing wrong. A pilot that a wider tool drills away is no feature.
    pub fn features(&self, entry: &Point3<f64>, out: &Vector3<f64>, machine: &Machine) -> Vec<Feature> {
        let depth = |pass: &ToolPass<'_>| (entry - pass.cut.bottom).dot(out);
        let mut deepest: Vec<ToolPass<'_>> = Vec::new();
        for pass in self.passes() {
            let size = |one: &ToolPass<'_>| (one.tool, one.diameter);
            match deepest.iter_mut().find(|other| size(other) == size(&pass)) {
                Some(other) if depth(other) < depth(&pass) => *other = pass,
                Some(_) => {}
                None => deepest.push(pass),
            }
        }
        let is_left = |pass: &&ToolPass<'_>| !is_drilled_away(pass, &deepest, machine);
        let deepest: Vec<ToolPass<'_>> = deepest.iter().filter(is_left).copied().collect();
        let makes_diameter = |pass: &ToolPass<'_>| {
            let is_cone = machine
                .kind_of(pass.tool)
                .is_some_and(|kind| matches!(kind, ToolKind::SpotDrill | ToolKind::Countersink));
            !pass.cut.is_tapping && !is_cone
        };
        let is_plain = deepest.len() == 1 && deepest.iter().all(makes_diameter);
        if is_plain || deepest.iter().any(|pass| pass.axis.dot(out) < 0.0) {
            return Vec::new();
        }
        let features: Option<Vec<Option<Feature>>> =
            deepest.iter().map(|pass| feature(pass, depth(pass), &deepest, machine)).collect();
        features.unwrap_or_default().into_iter().flatten().collect()
    }
}

/// Returns the feature that a pass makes among all of its hole; `Some(None)` of a spot that a wider tool drills away, `None`
/// where the machine file lacks kind or diameter.
fn feature(
    pass: &ToolPass<'_>,
    depth: f64,
    all: &[ToolPass<'_>],
    machine: &Machine,
) -> Option<Option<Feature>> {
    let tool = machine.find_tool(pass.tool?)?;
    let diameter = pass.diameter?;
    if let Some(helix) = pass.cut.thread() {
        return Some(Some(milled_thread(&helix, diameter, depth)));
    }
    let kind = match tool.kind? {
        ToolKind::Tap => return Some(Some(thread(pass, diameter, depth)?)),
        ToolKind::SpotDrill | ToolKind::Countersink => {
            return Some(countersink(pass, tool, depth, all, machine));
        }
        ToolKind::Probe => return None,
        ToolKind::Drill => FeatureKind::Drill,
        ToolKind::Reamer => FeatureKind::Ream,
        ToolKind::BoringBar => FeatureKind::Bore,
        ToolKind::Counterbore => FeatureKind::Counterbore,
        ToolKind::EndMill => {
            let is_deeper = |other: &ToolPass<'_>| (pass.cut.bottom - other.cut.bottom).dot(&pass.axis) > 0.0;
            let is_stepped = all.iter().any(|other| other.diameter < Some(diameter) && is_deeper(other));
            if is_stepped { FeatureKind::Counterbore } else { FeatureKind::Bore }
        }
    };
    Some(Some(Feature { diameter, depth: Some(rounded(depth)), ..Feature::of(kind) }))
}

/// Returns the thread of a tap; `None` without its feed or its speed.
fn thread(pass: &ToolPass<'_>, diameter: f64, depth: f64) -> Option<Feature> {
    let pitch = rounded(pass.cut.feed?.0 / pass.cut.speed.0);
    let hand =
        if pass.cut.direction == SpindleDirection::Counterclockwise { Hand::Left } else { Hand::Right };
    let feature = Feature { diameter, depth: Some(rounded(depth)), hand, ..Feature::of(FeatureKind::Tap) };
    (pitch.is_finite() && pitch > 0.0).then_some(Feature { pitch: Some(pitch), ..feature })
}

/// Returns the thread of a mill along a helix.
fn milled_thread(helix: &Helix, diameter: f64, depth: f64) -> Feature {
    let hand = if helix.lead < 0.0 { Hand::Left } else { Hand::Right };
    let (diameter, pitch) = (rounded(diameter), Some(rounded(helix.lead.abs())));
    Feature { pitch, depth: Some(rounded(depth)), hand, diameter, ..Feature::of(FeatureKind::Tap) }
}

/// Returns the cone that a pointed tool leaves at the entry; `None` if another tool cuts as wide there.
fn countersink(
    pass: &ToolPass<'_>,
    tool: &Tool,
    depth: f64,
    all: &[ToolPass<'_>],
    machine: &Machine,
) -> Option<Feature> {
    let width = width_above_tip(pass, tool, depth)?;
    let PointShape::Pointed(angle) = tool.point() else { return None };
    let is_as_wide = |other: &ToolPass<'_>| {
        let below = depth + (pass.cut.bottom - other.cut.bottom).dot(&pass.axis);
        let other_tool = other.tool.and_then(|number| machine.find_tool(number));
        other.tool != pass.tool
            && other_tool
                .and_then(|tool| width_above_tip(other, tool, below))
                .is_some_and(|other| width <= other)
    };
    (!all.iter().any(is_as_wide)).then(|| Feature {
        diameter: rounded(width),
        angle: Some(angle.0),
        ..Feature::of(FeatureKind::Countersink)
    })
}

/// Returns the width that a pass opens at a height above its tip, mm: of a cone no more than the height gives, besides the
/// circle on which a mill leads it.
fn width_above_tip(pass: &ToolPass<'_>, tool: &Tool, height: f64) -> Option<f64> {
    let (diameter, path) = (pass.diameter?, pass.cut.milled.map_or(0.0, |circle| circle.radius));
    match tool.point() {
        PointShape::Pointed(angle) => Some((2.0 * (path + height * Deg(angle.0 / 2.0).tan())).min(diameter)),
        PointShape::Flat | PointShape::Unknown => Some(diameter),
    }
}

/// Returns true for a pass of which a wider tool on its axis leaves nothing. A thread is cut in what is left.
fn is_drilled_away(pass: &ToolPass<'_>, all: &[ToolPass<'_>], machine: &Machine) -> bool {
    let end = |pass: &ToolPass<'_>| {
        let is_tap = machine.kind_of(pass.tool) == Some(ToolKind::Tap);
        let is_thread = is_tap || pass.cut.is_tapping || pass.cut.thread().is_some();
        let has_core = pass.cut.milled.is_some_and(|circle| circle.core.is_some());
        let end = CutEnd::of(pass.tool, pass.diameter, &pass.cut, machine);
        end.filter(|_| !is_thread && !has_core)
    };
    let Some(own) = end(pass) else { return false };
    all.iter().any(|other| {
        let above = (pass.cut.bottom - other.cut.bottom).dot(&pass.axis);
        end(other).is_some_and(|wider| wider.contains(&own, 0.0, above))
    })
}

/// Rounds to the places of a list.
fn rounded(value: f64) -> f64 {
    (value * PARTS).round() / PARTS
}
