//! Cuts of the tools on the axis of a nominal hole, and the feature that each of them makes.
use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use super::outline::CutShape;
use super::{DIAMETER_TOLERANCE, Tolerances};
use crate::holes::{DrilledHole, Helix, ToolPass};
use crate::machine::{Machine, PointShape, Tool, ToolKind, tool_name};
use gcode_lang::units::Deg;
use gcode_part::{DepthTo, Feature, FeatureKind, Hand, Hole, exceeds};

/// Largest difference between the angles of a countersink and its tool, degrees.
const ANGLE_TOLERANCE: f64 = 0.5;

/// Mismatch of a cut of unknown diameter or point, more than that of every known one, mm.
const UNKNOWN_SHAPE: f64 = 1e3;

/// A pass of a tool on the axis of a nominal hole. Depths count from the nominal entry, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut<'a> {
    pub pass: ToolPass<'a>,
    /// Depth at which the feed starts; negative above the entry.
    pub start: f64,
    /// Depth of the tip.
    pub tip: f64,
    pub kind: Option<ToolKind>,
    /// Hand of the tool; `None` if the machine file has none.
    pub hand: Option<Hand>,
    pub point: PointShape,
    /// True for the circle of a mill of unknown kind: it may be a chamfer mill.
    pub may_be_cone: bool,
    /// Helix of a mill along a thread; `None` if it makes none.
    pub thread: Option<Helix>,
    /// True for a void of the stock, which was there before the program.
    pub is_void: bool,
    /// Diameter that the features of the hole give a mill whose own is unknown, mm.
    pub mill: Option<f64>,
}

impl<'a> Cut<'a> {
    /// Returns the passes of a drilled hole in the order of the program. For one from the far side of a through hole, depths
    /// count from there.
    pub(super) fn all(nominal: &Hole, drilled: &'a DrilledHole, machine: &Machine) -> Vec<Self> {
        let (entry, out) = side(nominal, &drilled.axis);
        let depth = |point: &Point3<f64>| (entry - point).dot(&out);
        let cut = |pass: ToolPass<'a>| {
            let tool = pass.tool.and_then(|number| machine.find_tool(number));
            let is_milled = pass.cut.milled.is_some();
            let thread = milled_thread(nominal, &pass);
            // A helix that makes a hole counts from the highest point of its last turn.
            let below = thread.filter(|helix| !helix.is_thread).map_or(0.0, |helix| helix.lead.abs());
            let point = match tool.map_or(PointShape::Unknown, Tool::point) {
                PointShape::Unknown if is_milled => PointShape::Flat,
                point => point,
            };
            // A circle is that of an end mill, or of a chamfer mill.
            let is_end_mill = is_milled && point == PointShape::Flat;
            let may_be_cone = is_milled
                && tool.is_none_or(|tool| tool.kind.is_none() && tool.point() == PointShape::Unknown);
            Self {
                pass,
                thread,
                start: depth(&pass.cut.start),
                tip: depth(&pass.cut.bottom) + below,
                kind: tool.and_then(|tool| tool.kind).or(is_end_mill.then_some(ToolKind::EndMill)),
                hand: tool.and_then(|tool| tool.known_hand()),
                point,
                may_be_cone,
                is_void: false,
                mill: None,
            }
        };
        drilled.passes().map(cut).collect()
    }

    /// Returns a cut from the opposite direction whose full diameter comes out at the entry of a hole, as one from the entry;
    /// `None` of another one.
    pub(super) fn through_from_behind(self, nominal: &Hole) -> Option<Self> {
        let (entry, out) = (Point3::from(nominal.entry), Vector3::from(nominal.axis));
        let depth = |point: &Point3<f64>| (entry - point).dot(&out);
        let diameter = self.pass.diameter?;
        let point = self.point.length(diameter).or(PointShape::DRILL.length(diameter))?;
        let end = depth(&self.pass.cut.bottom) + point;
        let tip = depth(&self.pass.cut.start);
        (!exceeds(end, 0.0)).then_some(Self { start: end, tip, point: PointShape::Flat, ..self })
    }

    /// Returns the circle of a mill with the diameter that the features of the hole give it.
    pub(super) fn of_mill(&self, mill: f64) -> Self {
        let diameter = Some(2.0 * self.path_radius() + mill);
        Self { pass: ToolPass { diameter, ..self.pass }, mill: Some(mill), ..*self }
    }

    /// Returns what the diameter of a mill rests on that the machine file lacks.
    pub(super) fn mill_note(&self) -> Option<String> {
        let (mill, tool) = (self.mill?, tool_name(self.pass.tool));
        Some(format!(
            "the machine file has no diameter of {tool}: it counts as Φ{mill:.3}, with which its circles make most of the features"
        ))
    }

    /// Returns true if a pass has the same tool and diameter: a mill cuts several diameters.
    pub(super) fn is_same_size(&self, other: &ToolPass<'_>) -> bool {
        (self.pass.tool, self.pass.diameter) == (other.tool, other.diameter)
    }

    /// Returns true if another pass is made before this one.
    pub(super) fn follows(&self, other: &Self) -> bool {
        other.is_void || other.pass.cut.order < self.pass.cut.order
    }

    /// Returns true if a mill goes round the axis; false for a stroke.
    pub(super) fn is_circle(&self) -> bool {
        self.pass.cut.milled.is_some()
    }

    /// Returns true for a tap, and for a mill along a thread.
    pub(super) fn is_thread(&self) -> bool {
        self.thread.is_some() || self.kind.map_or(self.pass.cut.is_tapping, |kind| kind == ToolKind::Tap)
    }

    /// Returns true for a tap that doesn't reverse in the hole, which tears its thread out.
    pub(super) fn is_stuck_tap(&self) -> bool {
        self.is_thread() && self.thread.is_none() && !self.pass.cut.is_tapping
    }

    /// Returns false if a tool of this kind can't make a feature.
    fn can_make(&self, feature: FeatureKind) -> bool {
        if self.may_be_cone && feature == FeatureKind::Countersink {
            return self.thread.is_none();
        }
        self.kind.is_none_or(|kind| match self.thread {
            Some(_) => feature == FeatureKind::Tap && !kind.cuts_with_end(),
            // The flat end of a drill leaves the floor of a counterbore.
            None if kind == ToolKind::Drill && self.point == PointShape::Flat => {
                kind.can_make(feature) || feature == FeatureKind::Counterbore
            }
            // An end mill with a point is a chamfer mill.
            None if kind == ToolKind::EndMill && matches!(self.point, PointShape::Pointed(_)) => {
                kind.can_make(feature) || feature == FeatureKind::Countersink
            }
            None => kind.can_make(feature),
        })
    }

    /// Returns the name of the tool, `T1`, with its diameter.
    pub(super) fn name(&self) -> String {
        let tool = if self.is_void { "the void".to_owned() } else { tool_name(self.pass.tool) };
        self.pass.diameter.map_or(tool.clone(), |diameter| format!("{tool}, Φ{diameter},"))
    }

    /// Returns the outline; `None` if the diameter is unknown.
    pub(super) fn shape(&self) -> Option<CutShape> {
        let path = self.path_radius();
        let radius = self.pass.diameter? / 2.0 - path;
        Some(CutShape { radius, path, start: self.start, tip: self.tip, point: self.point })
    }

    /// Returns the depth of the full diameter; `None` if the tool's end is unknown.
    pub(super) fn full_depth(&self, diameter: f64) -> Option<f64> {
        let own = self.pass.diameter.unwrap_or(diameter) - 2.0 * self.path_radius();
        Some(self.tip - self.point.length(own)?)
    }

    /// Returns what the point of a mill leaves at the wall of a circle of a diameter; `None` of a flat end.
    pub(super) fn cone_note(&self, diameter: f64) -> Option<String> {
        let length = self.point.length(diameter - 2.0 * self.path_radius()).filter(|length| 0.0 < *length)?;
        Some(format!(
            "its tip goes {:.3} mm deep; the full diameter begins {length:.3} mm above the tip, behind the point",
            self.tip
        ))
    }

    /// Returns the depth of the tip; of a cone that is milled round the axis, that of the point of the whole cone. A mill of unknown
    /// shape has the angle of the countersink.
    fn cone_tip(&self, feature: &Feature) -> f64 {
        let stated = feature.angle.filter(|_| self.may_be_cone);
        let point = stated.map_or(self.point, |angle| PointShape::Pointed(Deg(angle)));
        match (feature.kind, point) {
            (FeatureKind::Countersink, PointShape::Pointed(angle)) => {
                self.tip + self.path_radius() / Deg(angle.0 / 2.0).tan()
            }
            _ => self.tip,
        }
    }

    /// Returns the depths between which it cuts the whole wall of its diameter. A mill of unknown flutes clears all above it.
    pub(super) fn wall(&self) -> [f64; 2] {
        let lower = self.full_depth(self.pass.diameter.unwrap_or(0.0)).unwrap_or(self.tip);
        let upper = self.pass.cut.milled.map_or(self.start, |circle| self.tip - circle.wall);
        [upper, lower]
    }

    /// Returns the radius of a mill's circle; 0 of a stroke.
    pub(super) fn path_radius(&self) -> f64 {
        self.pass.cut.milled.map_or(0.0, |circle| circle.radius)
    }

    /// Returns how far the cut is from making a feature, the least for the best; `None` if it can't make it.
    pub(super) fn mismatch(&self, feature: &Feature, tolerances: Tolerances) -> Option<f64> {
        let is_thread = feature.kind == FeatureKind::Tap;
        if is_thread != self.is_thread() || !self.can_make(feature.kind) || is_thread && self.is_stuck_tap() {
            return None;
        }
        let deep = (self.cone_tip(feature) - feature.bottom()).abs();
        if let (FeatureKind::Countersink, Some(angle)) = (feature.kind, feature.angle) {
            let is_narrow = |own: f64| exceeds(feature.diameter - own, tolerances.diameter);
            return match self.point {
                PointShape::Flat if !self.may_be_cone => None,
                _ if self.pass.diameter.is_some_and(is_narrow) => None,
                PointShape::Pointed(own) => {
                    (!exceeds((own.0 - angle).abs(), ANGLE_TOLERANCE)).then_some(deep)
                }
                PointShape::Flat | PointShape::Unknown => Some(UNKNOWN_SHAPE + deep),
            };
        }
        if feature.kind == FeatureKind::Counterbore && matches!(self.point, PointShape::Pointed(_)) {
            return None;
        }
        match self.pass.diameter.map(|own| (own - feature.diameter).abs()) {
            Some(off) => (!exceeds(off, tolerances.diameter)).then_some(100.0 * off + 1e-3 * deep),
            None => Some(UNKNOWN_SHAPE + deep),
        }
    }

    /// Returns the actual depth of a feature that this cut makes, to be compared with [`Feature::bottom`]; `None` if the
    /// tool's end is unknown.
    pub(super) fn depth_of(&self, feature: &Feature) -> Option<f64> {
        match (feature.kind, feature.to, feature.angle) {
            (FeatureKind::Countersink, ..) => Some(self.cone_tip(feature)),
            // A mill leaves the cone of its point at the wall.
            _ if self.is_circle() => self.full_depth(feature.diameter),
            (FeatureKind::Drill, DepthTo::Full, Some(angle)) if self.point == PointShape::Unknown => {
                let point = PointShape::Pointed(Deg(angle));
                Some(self.tip - point.length(self.pass.diameter.unwrap_or(feature.diameter))?)
            }
            (FeatureKind::Drill, DepthTo::Full, _) => self.full_depth(feature.diameter),
            _ => Some(self.tip),
        }
    }
}

/// Returns the helix of a pass along a thread: one that makes no hole, or one as wide as a thread of the hole.
fn milled_thread(nominal: &Hole, pass: &ToolPass<'_>) -> Option<Helix> {
    let helix = pass.cut.helix()?;
    let is_as_wide = |feature: &Feature| {
        let off = pass.diameter.map(|own| (own - feature.diameter).abs());
        feature.kind == FeatureKind::Tap && off.is_none_or(|off| !exceeds(off, DIAMETER_TOLERANCE))
    };
    (helix.is_thread || nominal.features.iter().any(is_as_wide)).then_some(helix)
}

/// Returns the entry and the direction out of the part on the side from which a pass along `axis` cuts a hole.
pub(super) fn side(nominal: &Hole, axis: &Unit<Vector3<f64>>) -> (Point3<f64>, Vector3<f64>) {
    let (entry, out) = (Point3::from(nominal.entry), Vector3::from(nominal.axis));
    if axis.dot(&out) < 0.0 { (entry - out * nominal.depth, -out) } else { (entry, out) }
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

/// Returns the deepest circle of a mill that has the diameter of a feature and makes no other one; the cut that makes the
/// feature, `made`, if that is no circle.
pub(super) fn deepest_circle<'a>(
    feature: &Feature,
    made: usize,
    cuts: &[Cut<'a>],
    made_by: &[Option<usize>],
    tolerances: Tolerances,
) -> Cut<'a> {
    let is_other = |cut: &Cut<'_>| made_by.iter().flatten().any(|made| cut.is_same_size(&cuts[*made].pass));
    let is_sized = |cut: &&Cut<'_>| {
        cut.is_circle()
            && cut.pass.diameter.is_some()
            && !is_other(cut)
            && cut.mismatch(feature, tolerances).is_some()
    };
    let circles = cuts.iter().filter(|_| cuts[made].is_circle()).filter(is_sized);
    circles.fold(cuts[made], |deepest, cut| if deepest.tip < cut.tip { *cut } else { deepest })
}

/// Returns the deepest of the widest circles of a mill of unknown diameter; `None` if another tool cuts deeper: its cut may
/// be as wide.
pub(super) fn widest_circle<'a>(cuts: &[Cut<'a>], tolerances: Tolerances) -> Option<Cut<'a>> {
    let circles = || {
        let unsized_cuts = cuts.iter().filter(|cut| cut.pass.diameter.is_none());
        unsized_cuts.filter_map(|cut| Some((cut.pass.cut.milled?.radius, cut)))
    };
    let (radius, widest) = circles().max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    let is_as_wide = |(own, cut): &(f64, &Cut<'_>)| {
        cut.pass.tool == widest.pass.tool && !exceeds(2.0 * (radius - own), tolerances.diameter)
    };
    let (_, deepest) = circles().filter(is_as_wide).max_by(|(_, a), (_, b)| a.tip.total_cmp(&b.tip))?;
    let is_known = cuts.iter().all(|cut| cut.pass.tool == deepest.pass.tool || cut.tip <= deepest.tip);
    is_known.then_some(*deepest)
}
