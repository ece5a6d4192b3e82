//! Motion in the metal round the holes of a list: rapids that cut it, feeds beside a hole, and the depth cut so far.
use std::sync::Arc;

use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::axis_box::Bodies;
use super::rapids::format_point;
use crate::findings::{FEED_BESIDE_HOLE, RAPID_INTO_PART};
use crate::machine::{AxisMotion, Pose, TOUCH_DEPTH, ToolKind};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, SpindleDirection};
use gcode_part::{EntryPlanes, NearestPoint, Surface};

/// Largest distance of a feed from the axis of the hole that it cuts, mm, if the hole is narrower.
const MAX_OFFSET: f64 = 0.5;

/// Rounding of a point on a hole's wall, mm.
const ROUNDING: f64 = 1e-6;

/// Height above a hole up to which a tool counts as above it, mm.
const MAX_HEIGHT: f64 = 50.0;

/// Distance of a tool's side from the wall of the hole over which it stands, mm.
const MAX_OVERSIZE: f64 = 0.05;

/// Half diagonal up to which the holes in a box are few, mm.
const SMALL_BOX: f64 = 20.0;

/// Excess of a tool's radius that still fits a hole, mm.
const FIT: f64 = 0.01;

/// Metal round the holes of a list, and how much of it has been cut.
#[derive(Debug)]
pub(super) struct CutEntries {
    planes: Arc<EntryPlanes>,
    /// Cuts of each hole.
    cuts: Vec<Vec<Cut>>,
}

/// Metal that tools have cut from a hole, to one radius; an unknown radius is infinite.
#[derive(Clone, Copy, Debug)]
struct Cut {
    radius: f64,
    /// Depth below the entry, mm.
    depth: f64,
    /// Height above the bottom, for a hole that is entered from the far side too, mm.
    height: f64,
}

/// A point in the metal round a hole.
#[derive(Clone, Copy)]
struct PointInMetal {
    hole: usize,
    point: Point3<f64>,
    depth: f64,
}

impl CutEntries {
    pub(super) fn new(planes: Arc<EntryPlanes>) -> Self {
        Self { cuts: vec![Vec::new(); planes.len()], planes }
    }

    /// Returns true if a point is above every entry, where all holes have one direction.
    pub(super) fn is_above_all(&self, p: &Point3<f64>) -> bool {
        self.planes.is_above_all(p, p)
    }

    /// Returns the metal round the holes as convex bodies, cut or not; without the holes that `is_left_out` names.
    pub(super) fn bodies<'c>(&'c self, is_left_out: impl Fn(usize) -> bool + 'c) -> Box<Bodies<'c>> {
        Box::new(move |p, reach, each: &mut dyn FnMut(NearestPoint)| {
            let (low, high) = (p - reach, p + reach);
            if self.planes.is_above_all(&low, &high) || self.planes.nearest_metal(p) > reach.norm() {
                return true;
            }
            let is_small = reach.norm() <= SMALL_BOX;
            if is_small {
                self.planes.near(&low, &high, &mut |hole| {
                    if !is_left_out(hole) {
                        each(self.planes.collar(hole).rod.nearest(p));
                    }
                });
            }
            is_small
        })
    }

    /// Returns depth and height to which the hole is cut to a radius; an unknown radius fits every hole.
    fn cut_for(&self, hole: usize, radius: Option<f64>) -> (f64, f64) {
        let fits = |cut: &&Cut| radius.is_none_or(|radius| radius <= cut.radius + FIT);
        let cuts = self.cuts[hole].iter().filter(fits);
        cuts.fold((0.0, 0.0), |(depth, height), cut| (cut.depth.max(depth), cut.height.max(height)))
    }

    /// Returns true if the points and all between them lie where a tool of this radius finds the hole cut, or above it.
    pub(super) fn are_in_cut(&self, hole: usize, radius: Option<f64>, points: &[Point3<f64>]) -> bool {
        let collar = self.planes.collar(hole);
        let aside = points.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
        let (depth, height) = self.cut_for(hole, radius.map(|radius| radius + aside));
        let is_above = |p: &Point3<f64>| collar.depth(p) <= depth + TOUCH_DEPTH;
        let is_below = |p: &Point3<f64>| collar.rod.length - collar.depth(p) <= height + TOUCH_DEPTH;
        aside <= collar.hole_radius + ROUNDING
            && (0.0 < depth && points.iter().all(is_above) || 0.0 < height && points.iter().all(is_below))
    }

    /// Returns true if the points and all between them lie in one hole, where a tool of this radius finds it cut.
    pub(super) fn are_in_one_cut(&self, radius: Option<f64>, points: &[Point3<f64>]) -> bool {
        let Some(first) = points.first() else { return false };
        let (low, high) = points.iter().fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
        let mut is_in_cut = false;
        self.planes.near(&low, &high, &mut |hole| is_in_cut |= self.are_in_cut(hole, radius, points));
        is_in_cut
    }

    /// Returns the largest radius about two points and all between them that is cut, in a hole and above it.
    fn room_about(&self, points: &[Point3<f64>; 2]) -> Option<f64> {
        let margin = Vector3::repeat(MAX_HEIGHT);
        let mut room: Option<f64> = None;
        for p in points {
            self.planes.around(&(p - margin), &(p + margin), &mut |hole| {
                let collar = self.planes.collar(hole);
                let aside = points.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
                let depth = points.iter().map(|p| collar.depth(p)).fold(f64::NEG_INFINITY, f64::max);
                for cut in self.cuts[hole].iter().filter(|cut| depth <= cut.depth + TOUCH_DEPTH) {
                    let free = if cut.radius.is_finite() { cut.radius } else { collar.hole_radius } - aside;
                    room = Some(room.map_or(free, |room| room.max(free)));
                }
            });
        }
        room
    }

    /// Records the cut of a feed inside a hole; `ends` are those of its piece in the collar.
    fn record(
        &mut self,
        hole: usize,
        radius: Option<f64>,
        from: &Point3<f64>,
        to: &Point3<f64>,
        ends: &[Point3<f64>; 2],
    ) {
        let collar = self.planes.collar(hole);
        let aside = ends.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
        let radius = radius.map_or(f64::INFINITY, |radius| radius + aside);
        let is_from_below = collar.rod.length < collar.depth(from) && collar.depth(to) < collar.depth(from);
        let deeper = |p: &Point3<f64>| collar.depth(p);
        let depth = ends.iter().map(deeper).fold(0.0, f64::max);
        // Along the hole the bottom of the collar does not limit the cut.
        let depth = if collar.is_parallel(&(to - from)) { deeper(to).max(depth) } else { depth };
        let height = ends.iter().map(|p| collar.rod.length - collar.depth(p)).fold(0.0, f64::max);
        let cut = match is_from_below {
            true => Cut { radius, depth: 0.0, height },
            false => Cut { radius, depth, height: 0.0 },
        };
        let cuts = &mut self.cuts[hole];
        match cuts.iter_mut().find(|other| other.radius == radius) {
            Some(other) => {
                (other.depth, other.height) = (other.depth.max(cut.depth), other.height.max(cut.height));
            }
            None => cuts.push(cut),
        }
    }

    /// Returns the deepest point of a straight travel in metal that a tool of this radius finds uncut, `Some(None)` if it
    /// leads through cut holes alone, and `None` beside all holes.
    fn uncut_between(
        &self,
        radius: Option<f64>,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) -> Option<Option<PointInMetal>> {
        let mut worst: Option<Option<PointInMetal>> = None;
        self.planes.near(&from.inf(to), &from.sup(to), &mut |hole| {
            let collar = self.planes.collar(hole);
            let Some([a, b]) = collar.piece(from, to, TOUCH_DEPTH) else { return };
            let worst = worst.get_or_insert(None);
            let point = if collar.depth(&a) < collar.depth(&b) { b } else { a };
            let depth = collar.depth(&point);
            if worst.is_none_or(|worst| worst.depth < depth) && !self.are_in_one_cut(radius, &[a, b]) {
                *worst = Some(PointInMetal { hole, point, depth });
            }
        });
        worst
    }

    /// Follows a straight feed of a tool. Returns its deepest point beside a hole; along a hole there is none.
    fn cut_by_feed(
        &mut self,
        radius: Option<f64>,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) -> Option<PointInMetal> {
        let (planes, along) = (Arc::clone(&self.planes), to - from);
        let mut beside: Option<PointInMetal> = None;
        let mut is_along_hole = false;
        planes.near(&from.inf(to), &from.sup(to), &mut |hole| {
            let collar = planes.collar(hole);
            let Some(ends) = collar.piece(from, to, TOUCH_DEPTH) else { return };
            let within = collar.hole_radius.max(MAX_OFFSET) + ROUNDING;
            let Some(point) = ends.iter().find(|p| within < collar.from_axis(p)) else {
                is_along_hole |= collar.is_parallel(&along);
                self.record(hole, radius, from, to, &ends);
                return;
            };
            let depth = collar.depth(point);
            let is_beside = collar.has_diameter && !collar.is_parallel(&along);
            if is_beside && beside.is_none_or(|beside| beside.depth < depth) {
                beside = Some(PointInMetal { hole, point: *point, depth });
            }
        });
        beside.filter(|_| !is_along_hole)
    }

    /// Returns the hole in whose metal a point is deepest, and the depth.
    fn deepest_at(&self, p: &Point3<f64>) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        self.planes.near(p, p, &mut |hole| {
            let collar = self.planes.collar(hole);
            let depth = collar.depth(p);
            if collar.contains(p, TOUCH_DEPTH) && best.is_none_or(|(_, most)| most < depth) {
                best = Some((hole, depth));
            }
        });
        best
    }
}

impl HoleExtractor<'_> {
    /// Returns the depth of a point below the surface or, without one, below the entry of the hole it is at, mm; `None` if
    /// neither is known there.
    pub(super) fn known_depth(&self, p: &Point3<f64>) -> Option<f64> {
        match self.surface {
            Some(surface) => Some(surface.depth(p)),
            None => Some(self.entries.as_ref()?.deepest_at(p)?.1),
        }
    }

    /// Returns the level from which [`Self::known_depth`] counts: `the surface`, or `the nominal entry of hole 1`.
    pub(super) fn level_at(&self, p: &Point3<f64>) -> String {
        let entries = self.entries.as_ref().filter(|_| self.surface.is_none());
        match entries.and_then(|entries| Some(entries.planes.id(entries.deepest_at(p)?.0))) {
            Some(id) => format!("the nominal entry of hole {id}"),
            None => "the surface".to_owned(),
        }
    }

    /// Returns true if all that a straight travel has below the surface lies in a hole that is cut already.
    pub(super) fn is_in_cut_hole(
        &self,
        surface: &Surface,
        (from, to): (&Point3<f64>, &Point3<f64>),
        deepest: &Point3<f64>,
    ) -> bool {
        let Some(entries) = &self.entries else { return false };
        let Some((along, length)) = Unit::try_new_and_get(to - from, 1e-9) else {
            return entries.are_in_one_cut(self.tool_radius(), &[*deepest]);
        };
        let at = (deepest - from).dot(&along);
        let end = |out: Unit<Vector3<f64>>, most: f64| {
            let inside = surface.exit(deepest, &out).map_or(most, |exit| (exit - deepest).norm());
            deepest + out.into_inner() * inside.min(most)
        };
        entries.are_in_one_cut(self.tool_radius(), &[end(along, length - at), end(-along, at)])
    }

    /// Returns true if a travel leads through metal that is known, false if all that is known there is cut, and `None` if
    /// nothing is known.
    pub(super) fn cuts_known_metal(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<bool> {
        if let Some(surface) = self.surface {
            let deepest = surface.deepest_between(from, to);
            let is_inside = TOUCH_DEPTH < surface.depth(&deepest);
            return Some(is_inside && !self.is_in_cut_hole(&surface, (from, to), &deepest));
        }
        let (entries, radius) = (self.entries.as_ref()?, self.tool_radius());
        match entries.uncut_between(radius, from, to)? {
            Some(_) => Some(true),
            None => entries.are_in_one_cut(radius, &[*from, *to]).then_some(false),
        }
    }

    /// Returns the largest radius about a straight travel that is cut, with [`FIT`] added; 0 beside the cut holes.
    pub(super) fn room_in_hole(&self, points: &[Point3<f64>; 2]) -> f64 {
        let room = self.entries.as_ref().and_then(|entries| entries.room_about(points));
        room.map_or(0.0, |room| room + FIT)
    }

    /// Returns true for a point in a nominal hole, or in the metal above it, if the tool stands above the entry in the
    /// direction of the hole.
    pub(super) fn is_over_nominal_hole(&self, p: &Point3<f64>, pose: &Pose) -> bool {
        let (Some(entries), Some(axis)) = (&self.entries, pose.axis) else { return false };
        let radius = self.machine.diameter_of(self.setup.tool).unwrap_or(0.0) / 2.0;
        let margin = Vector3::repeat(MAX_HEIGHT);
        let mut is_over = false;
        entries.planes.around(&(p - margin), &(p + margin), &mut |hole| {
            let collar = entries.planes.collar(hole);
            let within = collar.hole_radius.max(radius) + MAX_OVERSIZE;
            is_over |= collar.is_parallel(&axis)
                && collar.depth(&pose.tip) <= TOUCH_DEPTH
                && collar.from_axis(&pose.tip) <= within - radius
                && collar.from_axis(p) <= within
                && collar.depth(p) <= collar.rod.length;
        });
        is_over
    }

    /// Returns true if a cylinder of this radius about two tips stays within a nominal hole. One without a diameter may be
    /// as wide as a tool that covers its axis.
    pub(super) fn is_within_nominal_hole(
        &self,
        tips: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        radius: f64,
    ) -> bool {
        let Some(entries) = &self.entries else { return false };
        let margin = Vector3::repeat(MAX_HEIGHT);
        let (low, high) = (tips[0].inf(&tips[1]) - margin, tips[0].sup(&tips[1]) + margin);
        let mut is_within = false;
        entries.planes.around(&low, &high, &mut |hole| {
            let collar = entries.planes.collar(hole);
            let aside = tips.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
            let room = if collar.has_diameter { collar.hole_radius + MAX_OVERSIZE - radius } else { radius };
            is_within |= collar.is_parallel(axis) && aside <= room;
        });
        is_within
    }

    /// Returns the radius of the tool; `None` if it is unknown, and for a boring bar with the spindle stopped, which is
    /// shifted off the wall. A tool of unknown kind that has turned may be one.
    pub(super) fn tool_radius(&self) -> Option<f64> {
        let tool = self.machine.find_tool(self.setup.tool?)?;
        let may_be_shifted = match tool.kind {
            Some(ToolKind::BoringBar) => true,
            None => self.has_tool_turned,
            Some(_) => false,
        };
        if may_be_shifted && self.cutting_state.spindle_direction == SpindleDirection::Off {
            return None;
        }
        tool.diameter.map(|diameter| diameter / 2.0)
    }

    /// Reports a straight rapid through metal round a hole; returns true if there is any.
    pub(super) fn check_rapid_at_holes(
        &mut self,
        event: &Event<'_>,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) -> bool {
        let Some(entries) = &self.entries else { return false };
        let (planes, worst) =
            (&entries.planes, entries.uncut_between(self.tool_radius(), from, to).flatten());
        let Some(PointInMetal { hole, point, depth }) = worst else { return false };
        let id = planes.id(hole);
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let point = format_point(&point);
            let message = format!(
                "rapid into the metal at hole {id}, {depth:.3} mm below its nominal entry, at {point}"
            );
            Diagnostic::new(kind, message)
                .help("end the rapid above the entry of the hole; only a feed may enter the metal")
        });
        true
    }

    /// Follows a feed through points: inside a hole it cuts the hole deeper, beside one it cuts what has to stay.
    pub(super) fn follow_feed_at_holes(&mut self, event: &Event<'_>, path: &[Point3<f64>]) {
        let radius = self.tool_radius();
        let Some(entries) = &mut self.entries else { return };
        let cut = path.windows(2).filter_map(|chord| entries.cut_by_feed(radius, &chord[0], &chord[1]));
        let deepest = cut.reduce(|a, b| if a.depth < b.depth { b } else { a });
        // In a known body other checks cover such feeds.
        let Some(PointInMetal { hole, point, depth }) = deepest.filter(|_| self.surface.is_none()) else {
            return;
        };
        let id = entries.planes.id(hole);
        self.findings.add(&FEED_BESIDE_HOLE, &event.backtrace(), 0, |kind| {
            let point = format_point(&point);
            let message =
                format!("the feed cuts beside hole {id}, {depth:.3} mm below its nominal entry, at {point}");
            Diagnostic::new(kind, message)
                .help("retract above the entry of the hole before a motion beside it")
        });
    }

    /// Follows a curved motion in chords; a rapid returns true if it cuts metal round a hole.
    pub(super) fn follow_curve_at_holes(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
        is_rapid: bool,
    ) -> bool {
        let Some(entries) = self.entries.as_ref().filter(|_| !is_rapid || self.surface.is_none()) else {
            return false;
        };
        let chords = |tolerance: f64| {
            let mut tips = Vec::new();
            self.machine.for_each_pose(travel, &self.setup, tolerance, |pose| tips.push(pose.tip));
            tips
        };
        // Coarse chords come first: most paths are far away.
        let coarse = 20.0;
        let margin = Vector3::repeat(coarse);
        let mut is_near = false;
        for chord in chords(coarse).windows(2) {
            let (low, high) = (chord[0].inf(&chord[1]) - margin, chord[0].sup(&chord[1]) + margin);
            entries.planes.near(&low, &high, &mut |_| is_near = true);
        }
        if !is_near {
            return false;
        }
        let path = chords(TOUCH_DEPTH);
        if !is_rapid {
            self.follow_feed_at_holes(event, &path);
            return false;
        }
        path.windows(2).any(|chord| self.check_rapid_at_holes(event, &chord[0], &chord[1]))
    }
}
