//! Rapids of several axes: any axis may arrive first, unless the rates of the axes or LRP give the path.
use nalgebra::{Point3, Unit, Vector3};

use super::axis_box::{AxisBox, DeepPoint, Deepest};
use super::metal::PointInMetal;
use super::near_metal::{Contact, Judged, NearMetal};
use super::rapids::{error_if, format_point};
use super::swept_tool::{TipPaths, contact, faces};
use super::{HoleExtractor, MotionKind};
use crate::findings::RAPID_INTO_PART;
use crate::machine::{AxisMotion, Pose, RapidPath, TOUCH_DEPTH, ToolPart, arrivals};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{AxisIndex, Backtrace, Event, Position};

/// Search for metal on the paths of the tool that may be given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Search {
    /// Along every path that a rapid of several axes can take.
    Paths,
    /// On the one path of a rapid.
    Rapid(OnPath),
    /// On the path of a feed.
    Feed(OnPath),
}

/// What may make a search for metal on one path too long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum OnPath {
    /// An axis rotates.
    Turning,
    /// The metal is what many feeds have left.
    Straight,
}

/// Motions that nothing judges, by their reasons.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnjudgedMotions {
    /// Rapids at machine positions by tools of unknown length without an offset.
    pub rapids_of_unknown_tip: UnsearchedMotions,
    /// Probing moves through metal, up to a signal.
    pub probes_in_metal: UnsearchedMotions,
    /// Probing moves through metal that no signal ends.
    pub probes_without_signal: UnsearchedMotions,
    /// Probing moves before the first tool change.
    pub probes_of_start_tool: UnsearchedMotions,
    /// Shifts in a hole of tools that may be boring bars or not.
    pub shifts_of_unknown_kind: UnsearchedMotions,
    /// Shifts of boring bars whose spindle has stopped at any angle.
    pub shifts_without_angle: UnsearchedMotions,
}

/// Motions that are not searched to the end: the first, and their number.
#[derive(Clone, Debug, Default)]
pub(crate) struct UnsearchedMotions(Option<(Backtrace, u64)>);

impl UnsearchedMotions {
    /// Counts a motion whose search was given up.
    pub(super) fn count(&mut self, backtrace: impl FnOnce() -> Backtrace) {
        self.0.get_or_insert_with(|| (backtrace(), 0)).1 += 1;
    }

    /// Returns the number of all.
    pub(super) fn number(&self) -> u64 {
        self.0.as_ref().map_or(0, |(_, count)| *count)
    }

    /// Returns the block of the first and the number of all; `None` without one.
    pub(crate) fn first(&self) -> Option<&(Backtrace, u64)> {
        self.0.as_ref()
    }
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
        // A block is reported once, with its first point.
        self.search_budget.is_any_enough = self.findings.has(&RAPID_INTO_PART, event.block, 0);
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
            let is_reported =
                self.check_path(event, (from, to), start) || self.check_turns_alone(event, (from, to));
            if !is_reported && (self.has_left_start || self.surface.is_none()) {
                let is_reported = self.check_box(event, &all, (from, to), start);
                if !is_reported {
                    self.check_tool_body(event, || all, (from, to), start);
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

    /// Checks a rotation before the other axes of a rapid move, and one behind them; returns true if one cuts.
    fn check_turns_alone(&mut self, event: &Event<'_>, (from, to): (&Position, &Position)) -> bool {
        if self.surface.is_some() {
            return false;
        }
        let (mut first, mut last) = (*from, *to);
        for (axis, _) in self.machine.axes.iter().filter(|(axis, _)| self.machine.axes.is_rotary(*axis)) {
            (first[axis], last[axis]) = (to[axis], from[axis]);
        }
        [(from, &first), (&last, to)].into_iter().any(|(from, to)| {
            let travel = AxisMotion { from, to, arc: None };
            !self.machine.is_straight(&travel) && self.check_turned_body(event, &travel)
        })
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
        let (machine, setup) = (self.machine, self.setup);
        let line = || {
            let mut line = AxisBox::line(machine, &setup, from, to);
            if let Some(axis) = round {
                line.leave_out(axis);
            }
            line
        };
        self.check_tool_body(event, line, (from, to), start);
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
    fn check_box(
        &mut self,
        event: &Event<'_>,
        all: &AxisBox<'_>,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
    ) -> bool {
        let mut budget = std::mem::take(&mut self.search_budget);
        let deepest = match (&self.surface, &self.metal.holes) {
            (Some(_), _) => all.deepest(&self.metal.left_stock(), TOUCH_DEPTH, &mut budget),
            (None, Some(holes)) => all.deepest(&self.metal.bodies(holes), TOUCH_DEPTH, &mut budget),
            (None, None) => Deepest::Clear,
        };
        self.search_budget = budget;
        let found = self.found(event, deepest).and_then(|found| self.uncut_in_box(event, found, all));
        let Some(found) = found else { return false };
        let depth = self.metal.depth(&found.point).unwrap_or(found.depth);
        let level = self.metal.level_at(&found.point);
        let order = self.arrival_order(&found, all);
        let begin = start;
        let start = self.machine.forward(from, &self.setup).tip;
        let starts_inside = self.metal.depth(&start).is_some_and(|depth| TOUCH_DEPTH < depth);
        let remedy = self.straight_rapids((from, to), begin);
        self.add_rapid_into_part(event, |kind| {
            let point = format_point(&found.point);
            let message = format!("rapid into the part{order}: {depth:.3} mm below {level} at {point}");
            let help = match starts_inside {
                true => "retract by a feed: the axes of a rapid do not stay on a line; or give [rapid] in the machine file",
                false => "move the axes in separate blocks, or give the machine's [rapid] in the machine file",
            };
            Diagnostic::new(kind, message)
                .note("each axis of a rapid moves at its own rate, so that any of them may arrive first")
                .help(format!("{help}{remedy}"))
        });
        true
    }

    /// Returns the point found in metal if it is not removed, or else another point of the box that is not.
    fn uncut_in_box(&mut self, event: &Event<'_>, found: DeepPoint, all: &AxisBox<'_>) -> Option<DeepPoint> {
        if self.metal.uncut(&[found.point, found.point]).is_some() {
            return Some(found);
        }
        // What is removed is not followed while an axis rotates.
        let Some((start, sides)) = all.sides() else { return Some(found) };
        let contact = faces(start, &sides).map_or(Contact::Unknown, |faces| {
            NearMetal::of_strips(&self.metal, &faces, Judged::Uncut(None)).contact(&faces)
        });
        let PointInMetal { point, depth } = self.in_rapid(event, contact, Search::Paths)?;
        Some(DeepPoint { point, depth, arrived: None })
    }

    /// Reports a rapid during which the flank of the tool, its shank or its holder cuts metal although the tip does not. Most rapids
    /// are far from it, and need no `path`.
    fn check_tool_body<'p>(
        &mut self,
        event: &Event<'_>,
        path: impl FnOnce() -> AxisBox<'p>,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
    ) {
        if self.surface.is_some() && !self.has_left_start {
            return;
        }
        let is_straight = self.machine.is_straight(&AxisMotion { from, to, arc: None });
        let tip = self.pose_at(to).tip;
        let begin = start.unwrap_or(tip);
        let Some(axis) = self.axis_in_motion(&begin, &tip) else { return };
        // Out along its axis the tool leaves the way that it has come, unless it has cut wider than it is above.
        let out = (tip - begin).dot(&axis);
        let is_way_back = 0.0 < out && (tip - begin - axis.into_inner() * out).norm() <= TOUCH_DEPTH;
        if is_straight && (start.is_none() || is_way_back && !self.cuts_undercut()) {
            return;
        }
        let mut parts = self.tool_body.iter();
        let is_searched = self.surface.is_some() || !is_straight;
        if !is_searched && !parts.any(|part| self.may_cut(part, &[begin, tip], &axis)) {
            return;
        }
        let path = path();
        let sides = match path.len() < 2 {
            true => Some((begin, vec![tip - begin])),
            false => path.sides(),
        };
        let paths =
            sides.filter(|_| is_straight).map(|(start, sides)| TipPaths::in_box(start, &sides, &axis));
        let contact = self.body_contact(&path, paths, &axis);
        let search = match path.len() < 2 {
            true => Search::Rapid(if is_straight { OnPath::Straight } else { OnPath::Turning }),
            false => Search::Paths,
        };
        let Some(cut) = self.in_rapid(event, contact, search) else { return };
        // While an axis rotates, the clearance of the job decides; the shape of the tool's end is only assumed.
        let severity = error_if(is_straight || self.process_limits.clearance.is_none());
        let (orders, remedy) = match path.len() < 2 {
            true => ("", ""),
            false => (" on some of its paths", self.straight_rapids((from, to), start)),
        };
        self.report_side(event, cut, severity, (orders, remedy));
    }

    /// Returns true for a tool whose edges are wider than a part above them: a side cutter, or a cutter for T slots.
    pub(super) fn cuts_undercut(&self) -> bool {
        let edges = || self.tool_body.iter().filter(|part| part.is_cutter);
        self.tool_body.iter().any(|above| {
            edges().any(|edge| edge.to <= above.from && above.radius() + TOUCH_DEPTH < edge.radius())
        })
    }

    /// Returns the largest radius of the tool's parts, mm; 0 if it is unknown.
    pub(super) fn body_radius(&self) -> f64 {
        self.tool_body.iter().map(ToolPart::radius).fold(0.0, f64::max)
    }

    /// Finds metal that a part of the tool meets on some paths; `paths` are those of its tip while nothing rotates, `Some(None)` if
    /// they are oblique to the tool in several ways: the deepest point in the body decides on them.
    pub(super) fn body_contact(
        &mut self,
        path: &AxisBox<'_>,
        paths: Option<Option<TipPaths>>,
        axis: &Unit<Vector3<f64>>,
    ) -> Contact {
        let surface = self.surface;
        if surface.is_some_and(|body| path.is_clear_by_planes(&self.tool_body, |p| body.nearest(p))) {
            return Contact::Clear;
        }
        let is_shifted = self.tool_radius().is_none();
        let mut budget = std::mem::take(&mut self.search_budget);
        let mut in_part = |part: &ToolPart| match (paths, surface) {
            (Some(Some(paths)), _) => contact(part, axis, &paths, &self.metal, Judged::Uncut(None)),
            (Some(None), None) => Contact::Unknown,
            (None, None) => Contact::Clear,
            (_, Some(_)) => {
                match path.with_tool(*part).deepest(&self.metal.left_stock(), TOUCH_DEPTH, &mut budget) {
                    Deepest::Clear => Contact::Clear,
                    Deepest::Unknown => Contact::Unknown,
                    // What is removed is not followed while an axis rotates.
                    Deepest::Metal(DeepPoint { point, depth, .. }) if paths.is_none() => {
                        Contact::Metal(PointInMetal { point, depth })
                    }
                    Deepest::Metal(at) => {
                        self.metal.uncut(&[at.point, at.point]).map_or(Contact::Unknown, Contact::Metal)
                    }
                }
            }
        };
        let parts = self.tool_body.iter().filter(|part| !(part.is_cutter && is_shifted));
        let found = parts.map(&mut in_part).find(|contact| !matches!(contact, Contact::Clear));
        self.search_budget = budget;
        found.unwrap_or(Contact::Clear)
    }

    /// Returns the metal that a search for a rapid has found; counts the rapid if the search was given up.
    pub(super) fn in_rapid(
        &mut self,
        event: &Event<'_>,
        contact: Contact,
        search: Search,
    ) -> Option<PointInMetal> {
        match contact {
            Contact::Clear => None,
            Contact::Metal(at) => Some(at),
            Contact::Unknown => {
                self.count_unsearched(event, search);
                None
            }
        }
    }

    /// Counts a motion whose search was given up.
    pub(super) fn count_unsearched(&mut self, event: &Event<'_>, search: Search) {
        self.unsearched.entry(search).or_default().count(|| event.backtrace());
    }

    /// Reports a rapid of unknown start at whose end the side of the tool is in metal.
    pub(super) fn check_body_at(&mut self, event: &Event<'_>, tip: &Point3<f64>) {
        let Some(axis) = self.pose.axis else { return };
        let stands = TipPaths::line(&[*tip, *tip]);
        let (setup, at) = (self.setup, self.axis_position);
        let at = AxisBox::line(self.machine, &setup, &at, &at);
        let contact = self.body_contact(&at, Some(Some(stands)), &axis);
        if let Some(cut) = self.in_rapid(event, contact, Search::Rapid(OnPath::Straight)) {
            self.report_side(event, cut, Severity::Error, ("", ""));
        }
    }

    /// Reports a rapid while an axis rotates, by which the body of the tool cuts the metal round a hole; returns true if it does.
    pub(super) fn check_turned_body(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>) -> bool {
        let cut = self.turned_body_contact(event, travel);
        if let Some(cut) = cut {
            self.report_side(event, cut, Severity::Error, (" while an axis rotates", ""));
        }
        cut.is_some()
    }

    /// Returns what a machine whose rapids are straight lines needs, if the line between two positions is free: its tip has been
    /// compared before.
    fn straight_rapids(
        &mut self,
        (from, to): (&Position, &Position),
        start: Option<Point3<f64>>,
    ) -> &'static str {
        const REMEDY: &str = "; if all its rapids are straight lines (parameter 1401#1), as this one would be free, give --control LRP=1";
        let is_straight = self.machine.is_straight(&AxisMotion { from, to, arc: None });
        // Without a start the tool leaves a hole the way that it has come.
        let Some(begin) = start else { return if is_straight { REMEDY } else { "" } };
        let (setup, tip) = (self.setup, self.pose_at(to).tip);
        let Some(axis) = self.axis_in_motion(&begin, &tip) else { return "" };
        let line = AxisBox::line(self.machine, &setup, from, to);
        let paths = is_straight.then(|| Some(TipPaths::line(&[begin, tip])));
        match self.body_contact(&line, paths, &axis) {
            Contact::Clear => REMEDY,
            Contact::Metal(_) | Contact::Unknown => "",
        }
    }

    pub(super) fn report_side(
        &mut self,
        event: &Event<'_>,
        cut: PointInMetal,
        severity: Severity,
        (orders, remedy): (&str, &str),
    ) {
        let level = self.metal.level_at(&cut.point);
        self.add_rapid_into_part(event, |kind| {
            let (depth, point) = (cut.depth, format_point(&cut.point));
            let message = format!(
                "the side of the tool cuts the part in a rapid{orders}, {depth:.3} mm below {level} at {point}"
            );
            Diagnostic::new(kind, message)
                .with_severity(severity)
                .help(format!(
                    "keep the diameters of the tool and its holder away from the part until the feed{remedy}"
                ))
        });
    }

    /// Returns the point that a search has found; counts a search that was given up.
    fn found(&mut self, event: &Event<'_>, deepest: Deepest) -> Option<DeepPoint> {
        match deepest {
            Deepest::Clear => None,
            Deepest::Metal(point) => Some(point),
            Deepest::Unknown => {
                self.count_unsearched(event, Search::Paths);
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
