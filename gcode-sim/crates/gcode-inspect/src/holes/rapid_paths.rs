//! Rapids of several axes: any axis may arrive first, unless the rates of the axes or LRP give the path.
use nalgebra::{Point3, Vector3};

use super::axis_box::{AxisBox, DeepPoint, Deepest};
use super::entries::CutEntries;
use super::rapids::{PLUNGE_COSINE, error_if, format_point};
use super::{HoleExtractor, MotionKind};
use crate::findings::RAPID_INTO_PART;
use crate::machine::{AxisMotion, Pose, RapidPath, TOUCH_DEPTH, arrivals};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{AxisIndex, Backtrace, Event, Position};
use gcode_part::{NearestPoint, Surface};

/// Rapids whose paths are too many to be searched.
#[derive(Clone, Debug)]
pub(crate) struct UnsearchedRapids {
    /// Block of the first.
    pub backtrace: Backtrace,
    /// Their number.
    pub count: u64,
}

impl HoleExtractor<'_> {
    /// Checks a rapid on every path that it can take. `start` is the point from which a straight path on the part moved
    /// freely; `None` if it stays on the current line.
    pub(super) fn check_rapid_paths(
        &mut self,
        event: &Event<'_>,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
    ) {
        if self.surface.is_none() && self.entries.is_none() {
            return;
        }
        let (machine, setup) = (self.machine, self.setup);
        let round = self.axis_about_part().filter(|axis| from[*axis] != to[*axis]);
        if (0..to.0.len()).filter(|axis| from[*axis] != to[*axis]).count() < 2 {
            self.check_leg(event, (from, to), start, round);
            return;
        }
        let mut all = AxisBox::new(machine, &setup, from, to);
        if let Some(axis) = round {
            all.leave_out(axis);
        }
        let legs = match self.rapid_path {
            _ if all.len() < 2 => Some(vec![*to]),
            RapidPath::Straight => Some(vec![*to]),
            RapidPath::Rates(rates) => arrivals(&rates, from, to),
            RapidPath::Any => None,
        };
        let Some(legs) = legs else {
            let is_reported = self.check_path(event, (from, to), start);
            if !is_reported && (self.has_left_start || self.surface.is_none()) {
                let is_reported = self.check_box(event, &all, from);
                if !is_reported {
                    self.check_tool_body(event, &all, (from, to), start);
                }
            }
            return;
        };
        let mut from = from;
        for (leg, to) in legs.iter().enumerate() {
            let begin = if leg == 0 { start } else { Some(machine.forward(from, &setup).tip) };
            self.check_leg(event, (from, to), begin, round);
            from = to;
        }
    }

    /// Checks tip and body of the tool on a path along which all axes arrive together. The rotation of `round` keeps the surface.
    fn check_leg(
        &mut self,
        event: &Event<'_>,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
        round: Option<AxisIndex>,
    ) {
        if self.check_path(event, (from, to), start) || self.surface.is_none() {
            return;
        }
        let setup = self.setup;
        let mut line = AxisBox::line(self.machine, &setup, from, to);
        if let Some(axis) = round {
            line.leave_out(axis);
        }
        self.check_tool_body(event, &line, (from, to), start);
    }

    /// Checks the path between two positions along which all axes arrive together; returns true if it cuts.
    fn check_path(
        &mut self,
        event: &Event<'_>,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
    ) -> bool {
        let travel = AxisMotion { from, to, arc: None };
        if !self.machine.is_straight(&travel) {
            return self.check_curved(event, &travel, MotionKind::Rapid);
        }
        let Some(start) = start else { return false };
        let is_end = *to == self.axis_position;
        let tip = if is_end { self.pose.tip } else { self.machine.forward(to, &self.setup).tip };
        self.check_rapid(event, &start, &tip)
    }

    /// Reports a rapid that cuts if its axes arrive in another order than along the straight path; returns true if one
    /// does.
    fn check_box(&mut self, event: &Event<'_>, all: &AxisBox<'_>, from: &Position) -> bool {
        // Between the corners of a straight box there is nothing else.
        let (corners, radius) = (all.straight_corners(), self.tool_radius());
        let mut budget = std::mem::take(&mut self.search_budget);
        let deepest = match (&self.surface, &self.entries) {
            (Some(surface), entries) => {
                let is_in_cut = |entries: &CutEntries| {
                    corners.as_ref().is_some_and(|corners| entries.are_in_one_cut(radius, corners))
                };
                match all.deepest(&distance_from(surface), TOUCH_DEPTH, &mut budget) {
                    Deepest::Metal(_) if entries.as_ref().is_some_and(is_in_cut) => Deepest::Clear,
                    deepest => deepest,
                }
            }
            (None, Some(entries)) => {
                let is_cut =
                    |hole| corners.as_ref().is_some_and(|corners| entries.are_in_cut(hole, radius, corners));
                all.deepest(&entries.bodies(is_cut), TOUCH_DEPTH, &mut budget)
            }
            (None, None) => Deepest::Clear,
        };
        self.search_budget = budget;
        let Some(found) = self.found(event, deepest) else { return false };
        let depth = self.known_depth(&found.point).unwrap_or(found.depth);
        let level = self.level_at(&found.point);
        let order = self.arrival_order(&found, all);
        let start = self.machine.forward(from, &self.setup).tip;
        let starts_inside = self.known_depth(&start).is_some_and(|depth| TOUCH_DEPTH < depth);
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let point = format_point(&found.point);
            let message = format!("rapid into the part{order}: {depth:.3} mm below {level} at {point}");
            let help = match starts_inside {
                true => "retract by a feed: the axes of a rapid do not stay on a line; or give [rapid] in the machine file",
                false => "move the axes in separate blocks, or give the machine's [rapid] in the machine file",
            };
            Diagnostic::new(kind, message)
                .note("each axis of a rapid moves at its own rate, so that any of them may arrive first")
                .help(help)
        });
        true
    }

    /// Reports a rapid during which the flank of the tool, its shank or its holder cuts a known body although the tip
    /// does not.
    fn check_tool_body(
        &mut self,
        event: &Event<'_>,
        path: &AxisBox<'_>,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
    ) {
        let Some(surface) = self.surface.filter(|_| self.has_left_start) else { return };
        let is_straight = self.machine.is_straight(&AxisMotion { from, to, arc: None });
        let pose = self.machine.forward(to, &self.setup);
        let Some(axis) = pose.axis else { return };
        if is_straight {
            let Some(start) = start else { return };
            // Out along its axis the tool leaves the way that it has come.
            let along = pose.tip - start;
            if PLUNGE_COSINE * along.norm() <= along.dot(&axis) {
                return;
            }
        }
        let parts = self.machine.tool_body(&self.setup);
        if path.is_clear_by_planes(&parts, |p| surface.nearest(p)) {
            return;
        }
        let room = start.filter(|_| is_straight).map_or(0.0, |start| self.room_in_hole(&[start, pose.tip]));
        let mut budget = std::mem::take(&mut self.search_budget);
        let mut found = None;
        for part in parts.into_iter().filter(|part| room < part.radius) {
            // A boring bar with the spindle stopped is shifted off the wall.
            let is_cutter = part.is_cutter;
            if is_cutter && 0.0 < room && self.tool_radius().is_none() {
                continue;
            }
            let deepest = path.with_tool(part).deepest(&distance_from(&surface), TOUCH_DEPTH, &mut budget);
            found = self.found(event, deepest);
            // The metal above a nominal hole goes with the hole: in a steep flank the tool meets it on its way to the entry.
            let is_at_hole = |at: &DeepPoint| {
                let from = Pose { tip: start.unwrap_or(pose.tip), ..pose };
                [from, pose].iter().any(|pose| self.is_over_nominal_hole(&at.point, pose))
            };
            found = found.filter(|at| !(is_cutter && is_straight && is_at_hole(at)));
            if found.is_some() {
                break;
            }
        }
        self.search_budget = budget;
        let Some(found) = found else { return };
        // While an axis rotates, the clearance of the job decides; the shape of the tool's end is only assumed.
        let severity = error_if(is_straight || self.process_limits.clearance.is_none());
        let orders = if path.len() < 2 { "" } else { " on some of its paths" };
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let (depth, point) = (found.depth, format_point(&found.point));
            let message = format!(
                "the side of the tool cuts the part in a rapid{orders}, {depth:.3} mm below the surface at {point}"
            );
            Diagnostic::new(kind, message)
                .with_severity(severity)
                .help("keep the diameters of the tool and its holder away from the part until the feed")
        });
    }

    /// Returns the point that a search has found; counts a search that was given up.
    fn found(&mut self, event: &Event<'_>, deepest: Deepest) -> Option<DeepPoint> {
        match deepest {
            Deepest::Clear => None,
            Deepest::Metal(point) => Some(point),
            Deepest::Unknown => {
                let first = || UnsearchedRapids { backtrace: event.backtrace(), count: 0 };
                self.unsearched_rapids.get_or_insert_with(first).count += 1;
                None
            }
        }
    }

    /// Returns the order of arrival that leads to a corner: ` if X arrives before Y`.
    fn arrival_order(&self, found: &DeepPoint, all: &AxisBox<'_>) -> String {
        let Some(arrived) = found.arrived else { return " on some of its paths".to_owned() };
        let letters = |has_arrived: bool| {
            let some = all.axes().filter(|axis| (arrived >> axis & 1 == 1) == has_arrived);
            some.map(|axis| self.machine.axes.letter(axis).to_string()).collect::<Vec<_>>()
        };
        let (first, last) = (letters(true), letters(false));
        let verb = if first.len() == 1 { "arrives" } else { "arrive" };
        format!(" if {} {verb} before {}", first.join(" and "), last.join(" and "))
    }
}

/// Returns the distance from one body, whatever the reach.
fn distance_from(
    surface: &Surface,
) -> impl Fn(&Point3<f64>, &Vector3<f64>, &mut dyn FnMut(NearestPoint)) -> bool + '_ {
    |p, _, each| {
        each(surface.nearest(p));
        true
    }
}
