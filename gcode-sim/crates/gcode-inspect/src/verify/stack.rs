//! Cuts of the tools on the axis of a nominal hole, and the feature that each of them makes.
use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::Tolerances;
use super::outline::CutShape;
use crate::holes::{DrilledHole, ToolPass};
use crate::machine::{Machine, PointShape, Tool, ToolKind};
use gcode_part::{DepthTo, Feature, FeatureKind, Hole, exceeds};

/// Largest difference between the angles of a countersink and its tool, degrees.
const ANGLE_TOLERANCE: f64 = 0.5;

/// A pass of a tool on the axis of a nominal hole. Depths count from the nominal entry, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut<'a> {
    pub pass: ToolPass<'a>,
    /// Depth at which the feed starts; negative above the entry.
    pub start: f64,
    /// Depth of the tip.
    pub tip: f64,
    pub kind: Option<ToolKind>,
    pub point: PointShape,
}

impl<'a> Cut<'a> {
    /// Returns the passes of a drilled hole in the order of the program. For one from the far side of a through hole, depths
    /// count from there.
    pub(super) fn all(nominal: &Hole, drilled: &'a DrilledHole, machine: &Machine) -> Vec<Self> {
        let (mut entry, mut out) = (Point3::from(nominal.entry), Vector3::from(nominal.axis));
        if drilled.axis.dot(&out) < 0.0 {
            entry -= out * nominal.depth;
            out = -out;
        }
        let depth = |point: &Point3<f64>| (entry - point).dot(&out);
        let cut = |pass: ToolPass<'a>| {
            let tool = pass.tool.and_then(|number| machine.find_tool(number));
            let is_milled = pass.cut.milled.is_some();
            Self {
                pass,
                start: depth(&pass.cut.start),
                tip: depth(&pass.cut.bottom),
                kind: tool.and_then(|tool| tool.kind).or(is_milled.then_some(ToolKind::EndMill)),
                point: if is_milled {
                    PointShape::Flat
                } else {
                    tool.map_or(PointShape::Unknown, Tool::point)
                },
            }
        };
        drilled.passes().map(cut).collect()
    }

    /// Returns true if a pass has the same tool and diameter: a mill cuts several diameters.
    pub(super) fn is_same_size(&self, other: &ToolPass<'_>) -> bool {
        (self.pass.tool, self.pass.diameter) == (other.tool, other.diameter)
    }

    pub(super) fn is_tap(&self) -> bool {
        self.pass.cut.is_tapping || self.kind == Some(ToolKind::Tap)
    }

    /// Returns the name of the tool, `T1`, with its diameter.
    pub(super) fn name(&self) -> String {
        let tool = self.pass.tool.map_or("the tool".to_owned(), |number| format!("T{number}"));
        self.pass.diameter.map_or(tool.clone(), |diameter| format!("{tool}, Φ{diameter},"))
    }

    /// Returns the outline; `None` if the diameter is unknown.
    pub(super) fn shape(&self) -> Option<CutShape> {
        let radius = self.pass.diameter? / 2.0;
        Some(CutShape { radius, start: self.start, tip: self.tip, point: self.point })
    }

    /// Returns the depth of the full diameter; `None` if the tool's end is unknown.
    pub(super) fn full_depth(&self, diameter: f64) -> Option<f64> {
        Some(self.tip - self.point.length(self.pass.diameter.unwrap_or(diameter))?)
    }

    /// Returns how far the cut is from making a feature, the least for the best; `None` if it can't make it.
    pub(super) fn mismatch(&self, feature: &Feature, tolerances: Tolerances) -> Option<f64> {
        let is_thread = feature.kind == FeatureKind::Tap;
        if is_thread != self.is_tap() || self.kind.is_some_and(|kind| !kind.can_make(feature.kind)) {
            return None;
        }
        // A tap that does not reverse tears the thread out.
        if is_thread && !self.pass.cut.is_tapping {
            return None;
        }
        let deep = (self.tip - feature.bottom()).abs();
        if let (FeatureKind::Countersink, Some(angle)) = (feature.kind, feature.angle) {
            let is_narrow = |own: f64| exceeds(feature.diameter - own, tolerances.diameter);
            return match self.point {
                PointShape::Flat => None,
                _ if self.pass.diameter.is_some_and(is_narrow) => None,
                PointShape::Pointed(own) => {
                    (!exceeds((own.0 - angle).abs(), ANGLE_TOLERANCE)).then_some(deep)
                }
                PointShape::Unknown => Some(1e3 + deep),
            };
        }
        if feature.kind == FeatureKind::Counterbore && matches!(self.point, PointShape::Pointed(_)) {
            return None;
        }
        match self.pass.diameter.map(|own| (own - feature.diameter).abs()) {
            Some(off) => (!exceeds(off, tolerances.diameter)).then_some(100.0 * off + 1e-3 * deep),
            None => Some(1e3 + deep),
        }
    }

    /// Returns the actual depth of a feature that this cut makes, to be compared with [`Feature::bottom`]; `None` if the
    /// tool's end is unknown.
    pub(super) fn depth_of(&self, feature: &Feature) -> Option<f64> {
        match (feature.kind, feature.to, feature.angle) {
            (FeatureKind::Drill, DepthTo::Full, Some(angle)) if self.point == PointShape::Unknown => {
                let point = PointShape::Pointed(gcode_lang::units::Deg(angle));
                Some(self.tip - point.length(self.pass.diameter.unwrap_or(feature.diameter))?)
            }
            (FeatureKind::Drill, DepthTo::Full, _) => self.full_depth(feature.diameter),
            _ => Some(self.tip),
        }
    }
}

/// Returns the cut that makes each feature of a hole, by index: the best pairs first, of each tool its deepest cut.
pub(super) fn assign(features: &[Feature], cuts: &[Cut<'_>], tolerances: Tolerances) -> Vec<Option<usize>> {
    let size = |cut: &Cut<'_>| (cut.pass.tool, cut.pass.diameter.map(f64::to_bits));
    let mut deepest: BTreeMap<_, f64> = BTreeMap::new();
    for cut in cuts {
        let tip = deepest.entry(size(cut)).or_insert(cut.tip);
        *tip = tip.max(cut.tip);
    }
    let is_deepest = |cut: &Cut<'_>| deepest.get(&size(cut)) == Some(&cut.tip);
    let mut pairs = Vec::new();
    for (index, feature) in features.iter().enumerate() {
        for (number, cut) in cuts.iter().enumerate().filter(|(_, cut)| is_deepest(cut)) {
            pairs.extend(cut.mismatch(feature, tolerances).map(|off| (off, index, number)));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let (mut made_by, mut is_used) = (vec![None; features.len()], vec![false; cuts.len()]);
    for (_, feature, cut) in pairs {
        if made_by[feature].is_none() && !is_used[cut] {
            made_by[feature] = Some(cut);
            is_used[cut] = true;
        }
    }
    made_by
}
