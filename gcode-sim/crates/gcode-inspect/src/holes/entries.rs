//! Motion in the metal round the holes of a list: rapids that cut it, feeds beside a hole, and the depth cut so far.
use std::sync::Arc;

use nalgebra::Point3;

use super::HoleExtractor;
use super::axis_box::Bodies;
use super::rapids::{TOUCH_DEPTH, format_point};
use crate::findings::{FEED_BESIDE_HOLE, RAPID_INTO_PART};
use crate::machine::AxisMotion;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Event;
use gcode_part::{EntryPlanes, NearestPoint};

/// Largest distance of a feed from the axis of the hole that it cuts, mm, if the hole is narrower.
const MAX_OFFSET: f64 = 0.5;

/// Rounding of a point on a hole's wall, mm.
const ROUNDING: f64 = 1e-6;

/// Excess of a tool's radius that still fits a hole, mm.
const FIT: f64 = 0.01;

/// Metal round the holes of a list, and how much of it has been cut.
#[derive(Debug)]
pub(super) struct CutEntries {
    planes: Arc<EntryPlanes>,
    /// Cuts of each hole.
    cuts: Vec<Vec<Cut>>,
}

/// Depth below the entry plane that tools of one radius have cut; an unknown radius is infinite.
#[derive(Clone, Copy, Debug)]
struct Cut {
    radius: f64,
    depth: f64,
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

    /// Returns the metal round the holes as convex bodies, holes that are cut included.
    pub(super) fn bodies(&self) -> Box<Bodies<'_>> {
        Box::new(|p, reach, each: &mut dyn FnMut(NearestPoint)| {
            let margin = nalgebra::Vector3::repeat(reach);
            self.planes.near(&(p - margin), &(p + margin), &mut |hole| each(self.planes.collar(hole).rod.nearest(p)));
        })
    }

    /// Returns the depth to which a tool of this radius finds the hole cut; an unknown radius fits every hole.
    fn depth_for(&self, hole: usize, radius: Option<f64>) -> f64 {
        let fits = |cut: &&Cut| radius.is_none_or(|radius| radius <= cut.radius + FIT);
        self.cuts[hole].iter().filter(fits).map(|cut| cut.depth).fold(0.0, f64::max)
    }

    fn record(&mut self, hole: usize, radius: Option<f64>, depth: f64) {
        let radius = radius.unwrap_or(f64::INFINITY);
        let cuts = &mut self.cuts[hole];
        match cuts.iter_mut().find(|cut| cut.radius == radius) {
            Some(cut) => cut.depth = cut.depth.max(depth),
            None => cuts.push(Cut { radius, depth }),
        }
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
                self.record(hole, radius, ends.iter().map(|p| collar.depth(p)).fold(0.0, f64::max));
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

    /// Returns the id of the hole in whose metal a point is; `None` if there is none.
    pub(super) fn hole_at(&self, p: &Point3<f64>) -> Option<&str> {
        let entries = self.entries.as_ref()?;
        Some(entries.planes.id(entries.deepest_at(p)?.0))
    }

    fn tool_radius(&self) -> Option<f64> {
        self.machine.diameter_of(self.setup.tool).map(|diameter| diameter / 2.0)
    }

    /// Reports a straight rapid through metal round a hole; returns true if there is any.
    pub(super) fn check_rapid_at_holes(
        &mut self,
        event: &Event<'_>,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) -> bool {
        let Some(entries) = &self.entries else { return false };
        let (planes, radius) = (&entries.planes, self.tool_radius());
        let mut worst: Option<PointInMetal> = None;
        planes.near(&from.inf(to), &from.sup(to), &mut |hole| {
            let collar = planes.collar(hole);
            let Some(ends) = collar.piece(from, to, TOUCH_DEPTH) else { return };
            let in_wall = ends.iter().find(|p| collar.hole_radius + ROUNDING < collar.from_axis(p));
            let deeper = ends.iter().max_by(|a, b| collar.depth(a).total_cmp(&collar.depth(b)));
            let deep = deeper.filter(|p| entries.depth_for(hole, radius) + TOUCH_DEPTH < collar.depth(p));
            if let Some(point) = deep.or(in_wall) {
                let depth = collar.depth(point);
                if worst.is_none_or(|worst| worst.depth < depth) {
                    worst = Some(PointInMetal { hole, point: *point, depth });
                }
            }
        });
        let Some(PointInMetal { hole, point, depth }) = worst else { return false };
        let id = planes.id(hole);
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let point = format_point(&point);
            let message =
                format!("rapid into the metal at hole {id}, {depth:.3} mm below its nominal entry, at {point}");
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
        let Some(PointInMetal { hole, point, depth }) = deepest else { return };
        let id = entries.planes.id(hole);
        self.findings.add(&FEED_BESIDE_HOLE, &event.backtrace(), 0, |kind| {
            let point = format_point(&point);
            let message =
                format!("the feed cuts beside hole {id}, {depth:.3} mm below its nominal entry, at {point}");
            Diagnostic::new(kind, message).help("retract above the entry of the hole before a motion beside it")
        });
    }

    /// Follows a curved motion in chords; a rapid returns true if it cuts.
    pub(super) fn follow_curve_at_holes(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
        is_rapid: bool,
    ) -> bool {
        let Some(entries) = &self.entries else { return false };
        let chords = |tolerance: f64| {
            let mut tips = Vec::new();
            self.machine.for_each_pose(travel, &self.setup, tolerance, |pose| tips.push(pose.tip));
            tips
        };
        // Coarse chords come first: most paths are far away.
        let coarse = 20.0;
        let margin = nalgebra::Vector3::repeat(coarse);
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
