//! Rapids of several axes: any axis may arrive first, unless the rates of the axes or LRP give the path.
use std::cell::Cell;

use nalgebra::{Point3, Vector3};

use super::axis_box::{AxisBox, DeepPoint, Deepest};
use super::metal::PointInMetal;
use super::rapids::{PLUNGE_COSINE, error_if, format_point};
use super::tool_lines::deepest;
use super::{HoleExtractor, MotionKind};
use crate::findings::RAPID_INTO_PART;
use crate::machine::{AxisMotion, Pose, RapidPath, TOUCH_DEPTH, ToolPart, arrivals};
use gcode_lang::diag::{Diagnostic, Severity};
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
        if !self.metal.is_known() {
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
        if self.check_path(event, (from, to), start) {
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
        let tip = self.pose_at(to).tip;
        self.check_rapid(event, &start, &tip)
    }

    /// Returns the pose of the tool on the part, which is known at the end of the motion.
    fn pose_at(&self, at: &Position) -> Pose {
        if *at == self.axis_position { self.pose } else { self.machine.forward(at, &self.setup) }
    }

    /// Reports a rapid that cuts if its axes arrive in another order than along the straight path; returns true if one
    /// does.
    fn check_box(&mut self, event: &Event<'_>, all: &AxisBox<'_>, from: &Position) -> bool {
        let mut budget = std::mem::take(&mut self.search_budget);
        let deepest = match (&self.surface, &self.metal.holes) {
            (Some(surface), _) => all.deepest(&distance_from(surface), TOUCH_DEPTH, &mut budget),
            (None, Some(holes)) => all.deepest(&self.metal.bodies(holes), TOUCH_DEPTH, &mut budget),
            (None, None) => Deepest::Clear,
        };
        self.search_budget = budget;
        let found = self.found(event, deepest).and_then(|found| self.uncut_in_box(found, all));
        let Some(found) = found else { return false };
        let depth = self.metal.depth(&found.point).unwrap_or(found.depth);
        let level = self.metal.level_at(&found.point);
        let order = self.arrival_order(&found, all);
        let start = self.machine.forward(from, &self.setup).tip;
        let starts_inside = self.metal.depth(&start).is_some_and(|depth| TOUCH_DEPTH < depth);
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

    /// Returns the point found in metal if it is not removed, or else another point of the box that is not.
    fn uncut_in_box(&self, found: DeepPoint, all: &AxisBox<'_>) -> Option<DeepPoint> {
        let uncut = |travel: &[Point3<f64>; 2]| self.metal.uncut(travel);
        if uncut(&[found.point, found.point]).is_some() {
            return Some(found);
        }
        // What is removed is not followed while an axis rotates.
        let Some(travels) = all.travels() else { return Some(found) };
        let worst = travels.iter().filter_map(uncut).reduce(PointInMetal::deeper)?;
        Some(DeepPoint { point: worst.point, depth: worst.depth, arrived: None })
    }

    /// Reports a rapid during which the flank of the tool, its shank or its holder cuts metal although the tip does not.
    fn check_tool_body(
        &mut self,
        event: &Event<'_>,
        path: &AxisBox<'_>,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
    ) {
        if self.tool_body.is_empty() || self.surface.is_some() && !self.has_left_start {
            return;
        }
        let is_straight = self.machine.is_straight(&AxisMotion { from, to, arc: None });
        let pose = self.pose_at(to);
        let begin = start.unwrap_or(pose.tip);
        let Some(axis) = self.axis_in_motion(&begin, &pose.tip) else { return };
        if is_straight {
            // Out along its axis the tool leaves the way that it has come.
            let along = pose.tip - begin;
            if start.is_none() || PLUNGE_COSINE * along.norm() <= along.dot(&axis) {
                return;
            }
        }
        let surface = self.surface;
        let is_clear = match surface {
            Some(body) => path.is_clear_by_planes(&self.tool_body, |p| body.nearest(p)),
            None => {
                let radius = self.tool_body.iter().map(ToolPart::radius).fold(0.0, f64::max);
                !is_straight || !self.metal.is_touched(&begin, &pose.tip, &axis, radius)
            }
        };
        if is_clear {
            return;
        }
        let travels = match path.len() < 2 {
            true => Some(vec![[begin, pose.tip]]).filter(|_| is_straight),
            false => path.travels(),
        };
        let mut budget = std::mem::take(&mut self.search_budget);
        let mut found: Option<PointInMetal> = None;
        for part in &self.tool_body {
            // A boring bar with the spindle stopped is shifted off the wall.
            if part.is_cutter && self.tool_radius().is_none() && self.metal.is_solid(&[begin, pose.tip]) {
                continue;
            }
            let is_met = Cell::new(false);
            let cut = |line: &[Point3<f64>; 2]| {
                let in_body = surface.and_then(|body| body.piece(&line[0], &line[1], TOUCH_DEPTH));
                is_met.set(is_met.get() || in_body.is_some());
                self.metal.uncut(line)
            };
            let on_travel = |travel| deepest(part, &axis, travel, &self.metal, cut);
            found = travels.iter().flatten().filter_map(on_travel).reduce(PointInMetal::deeper);
            // Between its ends the side of the tool may touch a round body.
            if let Some(body) = surface.filter(|_| found.is_none() && !is_met.get()) {
                let deepest = path.with_tool(*part).deepest(&distance_from(&body), TOUCH_DEPTH, &mut budget);
                found = match deepest {
                    // What is removed is not followed while an axis rotates.
                    Deepest::Metal(DeepPoint { point, depth, .. }) if !is_straight => {
                        Some(PointInMetal { point, depth })
                    }
                    Deepest::Metal(at) => self.metal.uncut(&[at.point, at.point]),
                    Deepest::Clear => None,
                    Deepest::Unknown => {
                        count_unsearched(&mut self.unsearched_rapids, event);
                        None
                    }
                };
            }
            if found.is_some() {
                break;
            }
        }
        self.search_budget = budget;
        let Some(cut) = found else { return };
        // While an axis rotates, the clearance of the job decides; the shape of the tool's end is only assumed.
        let severity = error_if(is_straight || self.process_limits.clearance.is_none());
        let orders = if path.len() < 2 { "" } else { " on some of its paths" };
        self.report_side(event, cut, severity, orders);
    }

    /// Reports a rapid of unknown start at whose end the side of the tool is in metal.
    pub(super) fn check_body_at(&mut self, event: &Event<'_>, tip: &Point3<f64>) {
        let Some(axis) = self.pose.axis else { return };
        let is_left_out = |part: &ToolPart| part.is_cutter && self.tool_radius().is_none();
        let cut =
            self.tool_body.iter().filter(|part| !is_left_out(part)).find_map(|part| {
                deepest(part, &axis, &[*tip, *tip], &self.metal, |line| self.metal.uncut(line))
            });
        if let Some(cut) = cut {
            self.report_side(event, cut, Severity::Error, "");
        }
    }

    fn report_side(&mut self, event: &Event<'_>, cut: PointInMetal, severity: Severity, orders: &str) {
        let level = self.metal.level_at(&cut.point);
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let (depth, point) = (cut.depth, format_point(&cut.point));
            let message = format!(
                "the side of the tool cuts the part in a rapid{orders}, {depth:.3} mm below {level} at {point}"
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
                count_unsearched(&mut self.unsearched_rapids, event);
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

/// Counts a rapid whose search was given up.
fn count_unsearched(unsearched: &mut Option<UnsearchedRapids>, event: &Event<'_>) {
    let first = || UnsearchedRapids { backtrace: event.backtrace(), count: 0 };
    unsearched.get_or_insert_with(first).count += 1;
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
