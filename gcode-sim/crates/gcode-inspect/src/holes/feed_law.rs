//! What feeds may remove: the nominal holes and the stated pockets, and nothing else of the part.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::line::CuttingLine;
use super::metal::{FeedPart, PointInMetal};
use super::rapids::{PLUNGE_COSINE, format_point};
use super::removed_metal::Profile;
use super::tool_lines::lines;
use crate::findings::FEED_BESIDE_HOLE;
use crate::machine::{AxisMotion, ToolKind};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event, SpindleDirection};

/// Largest deviation of an arc from the chords by which it removes metal, mm.
const CHORD_TOLERANCE: f64 = 0.005;

/// Deviation of the chords that show whether an arc is near the metal, mm.
const COARSE_TOLERANCE: f64 = 5.0;

/// Radius up to which a mill of unknown diameter may remove metal, mm.
const MAX_RADIUS: f64 = 25.0;

/// What a feed removes of the metal that has to stay.
#[derive(Clone, Copy)]
struct Spoilt {
    at: PointInMetal,
    /// False if the tip removes it.
    is_side: bool,
}

impl HoleExtractor<'_> {
    /// Applies a change of the tool or its length.
    pub(super) fn update_tool_body(&mut self) {
        self.tool_body = self.machine.tool_body(&self.setup);
        self.profile = (!self.tool_body.is_empty()).then(|| Profile::of_tool(&self.tool_body));
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

    /// Follows a feed through points: it removes metal. Reports what it must not remove, where the positions of the axes
    /// are known.
    pub(super) fn remove_by_feed(&mut self, event: &Event<'_>, path: &[Point3<f64>], is_known: bool) {
        if !self.metal.is_known() {
            return;
        }
        let radius = self.tool_radius().unwrap_or(0.0);
        let mut worst: Option<Spoilt> = None;
        for chord in path.windows(2) {
            let (from, to) = (chord[0], chord[1]);
            let Some(axis) = self.axis_in_motion(&from, &to) else { continue };
            if !self.metal.is_touched(&from, &to, &axis, radius) {
                continue;
            }
            if is_known && !is_along(&axis, &(to - from)) {
                let spoilt = self.spoilt(&[from, to], &axis);
                worst = match (worst, spoilt) {
                    (Some(worst), Some(spoilt)) if spoilt.at.depth <= worst.at.depth => Some(worst),
                    (worst, spoilt) => spoilt.or(worst),
                };
            }
            self.remove(&[from, to], &axis);
        }
        if let Some(spoilt) = worst {
            self.report_spoilt(&event.backtrace(), spoilt);
        }
    }

    /// Follows a feed on an arc in chords.
    pub(super) fn remove_by_arc(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>, is_known: bool) {
        // Coarse chords come first: most paths are far away.
        let reach = self.tool_radius().unwrap_or(0.0) + COARSE_TOLERANCE;
        let is_near = self.chords(travel, COARSE_TOLERANCE).windows(2).any(|chord| {
            let axis = self.axis_in_motion(&chord[0], &chord[1]);
            axis.is_some_and(|axis| self.metal.is_touched(&chord[0], &chord[1], &axis, reach))
        });
        if is_near {
            let path = self.chords(travel, CHORD_TOLERANCE);
            self.remove_by_feed(event, &path, is_known);
        }
    }

    /// Returns the direction of the tool; if it is unknown, that of a nominal hole to which the motion is parallel, or Z.
    pub(super) fn axis_in_motion(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<Unit<Vector3<f64>>> {
        if self.pose.axis.is_some() {
            return self.pose.axis;
        }
        let (mut parallel, mut any) = (None, None);
        if let Some(holes) = &self.metal.holes {
            holes.near(&from.inf(to), &from.sup(to), &mut |hole| {
                let collar = holes.collar(hole);
                any = Some(collar.rod.axis);
                if collar.is_parallel(&(to - from)) {
                    parallel = any;
                }
            });
        }
        parallel.or_else(|| self.tool_direction()).or(any)
    }

    /// Adds what a straight feed removes.
    fn remove(&mut self, travel: &[Point3<f64>; 2], axis: &Unit<Vector3<f64>>) {
        let [from, to] = *travel;
        if let Some(profile) = &self.profile {
            // A stopped bar is shifted off the wall and cuts nothing.
            if self.tool_radius().is_some() {
                self.metal.removed.add(from, to, *axis, profile);
            }
            return;
        }
        // A tool of unknown diameter cuts a nominal hole to its width.
        let mut room: Option<f64> = None;
        self.metal.around(travel, |collar| {
            let aside = travel.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
            if collar.is_parallel(axis) && aside <= collar.hole_radius {
                room = Some(room.unwrap_or(0.0).max(collar.hole_radius - aside));
            }
        });
        let profile = match room {
            Some(room) => Profile::flat(room, true),
            None if is_along(axis, &(to - from)) => Profile::flat(0.0, true),
            None => {
                if self.surface.is_some() && !self.unsized_mills.contains(&self.setup.tool) {
                    self.unsized_mills.push(self.setup.tool);
                }
                Profile::flat(MAX_RADIUS, false)
            }
        };
        self.metal.removed.add(from, to, *axis, &profile);
    }

    /// Returns what a feed removes of the metal that has to stay. With a known body the side of the tool counts too.
    fn spoilt(&self, travel: &[Point3<f64>; 2], axis: &Unit<Vector3<f64>>) -> Option<Spoilt> {
        if self.surface.is_some() && !self.has_left_start {
            return None;
        }
        match self.metal.spoilt(travel, FeedPart::Tip) {
            Some(at) => Some(Spoilt { at, is_side: false }),
            None => self.spoilt_by_side(travel, axis).map(|at| Spoilt { at, is_side: true }),
        }
    }

    fn spoilt_by_side(&self, travel: &[Point3<f64>; 2], axis: &Unit<Vector3<f64>>) -> Option<PointInMetal> {
        let surface = self.surface.filter(|_| self.pose.axis.is_some())?;
        let along = travel[1] - travel[0];
        self.tool_body.iter().find_map(|part| {
            if !part.cuts(&surface, (&travel[0], axis), &along) {
                return None;
            }
            let base = travel.map(|tip| tip + axis.into_inner() * part.from);
            if self.metal.is_allowed(&base, axis, part.radius) {
                return None;
            }
            let lines = lines(part, axis, travel).into_iter();
            let points = lines.filter_map(|line| self.metal.spoilt(&line, FeedPart::Side(part.radius)));
            points.reduce(PointInMetal::deeper)
        })
    }

    /// Returns true if a feed along the tool removes metal that has to stay; one that makes a hole does not.
    pub(super) fn is_spoilt_by_plunge(&self, line: &CuttingLine) -> bool {
        let Some(axis) = line.tool_axis.filter(|axis| 0.0 < axis.dot(&line.out)) else { return false };
        line.cutting_state.tool == self.setup.tool
            && line.unknown_axes.is_none()
            && self.spoilt(&[line.start, line.bottom()], &axis).is_some()
    }

    /// Returns true if all metal in which a line feeds is in a pocket.
    pub(super) fn is_pocketing(&self, line: &CuttingLine) -> bool {
        let axis = line.tool_axis.unwrap_or(line.out);
        let radius = self.machine.diameter_of(line.cutting_state.tool).unwrap_or(0.0) / 2.0;
        self.metal.is_in_pocket(&[line.start, line.bottom()], &axis, radius)
    }

    /// Reports a plunge that the side of the tool spoils.
    pub(super) fn report_plunge(&mut self, backtrace: &Backtrace, line: &CuttingLine) {
        let travel = [line.start, line.bottom()];
        let spoilt = line.tool_axis.and_then(|axis| self.spoilt(&travel, &axis));
        if let Some(spoilt) = spoilt {
            self.report_spoilt(backtrace, spoilt);
        }
    }

    fn report_spoilt(&mut self, backtrace: &Backtrace, Spoilt { at, is_side }: Spoilt) {
        let (depth, point) = (at.depth, format_point(&at.point));
        let level = self.metal.level_at(&at.point);
        let hole = self.metal.hole_at(&at.point).filter(|_| self.surface.is_none()).map(str::to_owned);
        self.findings.add(&FEED_BESIDE_HOLE, backtrace, 0, |kind| match hole {
            Some(id) => {
                let message =
                    format!("the feed cuts beside hole {id}, {depth:.3} mm below its nominal entry, at {point}");
                Diagnostic::new(kind, message)
                    .help("retract above the entry of the hole before a motion beside it")
            }
            None => {
                let what = if is_side { "the side of the tool cuts" } else { "the feed cuts" };
                let message =
                    format!("{what} the part beside its holes, {depth:.3} mm below {level} at {point}");
                Diagnostic::new(kind, message).help(
                    "keep the tool's radius away from what has to stay, or state in [[stock.pocket]] what the \
                     program mills besides the holes",
                )
            }
        });
    }
}

/// Returns true if a motion is along the tool.
fn is_along(axis: &Unit<Vector3<f64>>, along: &Vector3<f64>) -> bool {
    PLUNGE_COSINE * along.norm() <= along.dot(axis).abs()
}
