//! Rapids of several axes: any axis may arrive first, unless the rates of the axes or LRP give the path.
use nalgebra::Point3;

use super::axis_box::{AxisBox, DeepPoint};
use super::rapids::{TOUCH_DEPTH, format_point};
use super::{HoleExtractor, MotionKind};
use crate::findings::RAPID_INTO_PART;
use crate::machine::{AxisMotion, RapidPath, arrivals};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{AxisIndex, Event, Position};
use gcode_part::NearestPoint;

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
        let reachable = AxisBox::new(machine, &setup, from, to);
        if reachable.axes.len() < 2 || self.rapid_path == RapidPath::Straight {
            self.check_path(event, (from, to), start);
            return;
        }
        if let RapidPath::Rates(rates) = self.rapid_path
            && let Some(path) = arrivals(&rates, from, to)
        {
            let mut last = *from;
            for leg in path {
                self.check_path(event, (&last, &leg), Some(machine.forward(&last, &setup).tip));
                last = leg;
            }
            return;
        }
        let is_reported = self.check_path(event, (from, to), start);
        if !is_reported && (self.has_been_outside || self.surface.is_none()) {
            self.check_box(event, &reachable, from);
        }
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
        let tip = self.machine.forward(to, &self.setup).tip;
        start.is_some_and(|start| self.check_rapid(event, &start, &tip))
    }

    /// Reports a rapid that cuts if its axes arrive in another order than along the straight path.
    fn check_box(&mut self, event: &Event<'_>, reachable: &AxisBox<'_>, from: &Position) {
        let deepest = match (&self.surface, &self.entries) {
            (Some(surface), _) => {
                let bodies = |p: &Point3<f64>, _: f64, each: &mut dyn FnMut(NearestPoint)| each(surface.nearest(p));
                reachable.deepest(&bodies, TOUCH_DEPTH)
            }
            (None, Some(entries)) => reachable.deepest(&entries.bodies(), TOUCH_DEPTH),
            (None, None) => None,
        };
        let Some(found) = deepest else { return };
        let depth = self.known_depth(&found.tip).unwrap_or(found.depth);
        let level = match self.hole_at(&found.tip) {
            Some(id) => format!("the nominal entry of hole {id}"),
            None => "the surface".to_owned(),
        };
        let order = self.arrival_order(&found, &reachable.axes);
        let start = self.machine.forward(from, &self.setup).tip;
        let starts_inside = self.known_depth(&start).is_some_and(|depth| TOUCH_DEPTH < depth);
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let point = format_point(&found.tip);
            let message = format!("rapid into the part{order}: {depth:.3} mm below {level} at {point}");
            let help = match starts_inside {
                true => "retract by a feed: the axes of a rapid do not stay on a line; or give [rapid] in the machine file",
                false => "move the axes in separate blocks, or give the machine's [rapid] in the machine file",
            };
            Diagnostic::new(kind, message)
                .note("each axis of a rapid moves at its own rate, so that any of them may arrive first")
                .help(help)
        });
    }

    /// Returns the order of arrival that leads to a corner: ` if X arrives before Y`.
    fn arrival_order(&self, found: &DeepPoint, axes: &[AxisIndex]) -> String {
        let Some(arrived) = found.arrived else { return " on some of its paths".to_owned() };
        let letters = |has_arrived: bool| {
            let some = axes.iter().filter(|axis| (arrived >> **axis & 1 == 1) == has_arrived);
            some.map(|axis| self.machine.axes.letter(*axis).to_string()).collect::<Vec<_>>()
        };
        let (first, last) = (letters(true), letters(false));
        let verb = if first.len() == 1 { "arrives" } else { "arrive" };
        format!(" if {} {verb} before {}", first.join(" and "), last.join(" and "))
    }
}
