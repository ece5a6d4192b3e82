//! Probing moves: the signal of a probe, and moves that go on through metal.
use nalgebra::{Point3, Unit};

use super::feed_law::{Gouge, ToolRegion};
use super::metal::PointInMetal;

use super::near_metal::{FeedPart, Judged};
use super::rapid_paths::OnPath;
use super::rapids::format_point;
use super::{HoleExtractor, MotionKind};
use crate::findings::{FEED_BESIDE_HOLE, PROBE_TURNS, RAPID_INTO_PART};
use crate::machine::{TOUCH_DEPTH, ToolKind, tool_name};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Event, EventKind, Position, SkipMove, SkipSignal, SpindleDirection};
use gcode_part::PartSolid;

/// Depth of the ball in the wall that a touch leaves until the axes stop, mm.
const DEEPEST_TOUCH: f64 = 0.2;

impl HoleExtractor<'_> {
    /// Sets the part that a touch probe touches, if it is not the metal.
    #[must_use]
    pub fn with_probed(mut self, part: Option<PartSolid>) -> Self {
        self.probed = part.or(self.probed);
        self
    }

    /// Returns the number of probing moves of a probe with a part that it could touch.
    pub fn probe_count(&self) -> u64 {
        self.probe_count
    }

    /// Returns the probe's signal; `None` without a probe, or without a part that it could touch.
    pub(super) fn signal_of_probe(&mut self, feed: &SkipMove<'_>) -> Option<SkipSignal> {
        let (probe, part) = (self.machine.probe.as_ref()?, self.probed.as_ref()?);
        let signal = self.machine.probe(probe, feed, &self.setup, part, self.probe_count);
        self.probe_count += 1;
        Some(signal)
    }

    /// Follows a probing move. A touch probe must not turn in it.
    pub(super) fn probe(&mut self, event: &Event<'_>, to: &Position) {
        let state = self.tool_state();
        if state.tool.is_none() {
            self.unjudged.probes_of_start_tool.count(|| event.backtrace());
        }
        if state.selected_tool != state.tool {
            self.check_tool_changed(&event.backtrace(), &state, "probes");
        }
        if self.is_probe() && state.spindle_direction != SpindleDirection::Off {
            let tool = self.setup.tool;
            self.findings.add_in_program(&PROBE_TURNS, &event.backtrace(), tool.unwrap_or(0), 1, |kind| {
                let message = format!("{} is a probe and turns in a probing move", tool_name(tool));
                let finding = Diagnostic::new(kind, message).help("stop the spindle with M05 or M19 before G31");
                let Some(code) = state.builder_code else { return finding };
                finding.with_severity(Severity::Warning).note(format!(
                    "M{code:02} is left to the machine builder's logic, which may have stopped it: this is not simulated"
                ))
            });
        }
        self.motion(event, MotionKind::Probe, to, None);
    }

    /// Returns the kind of a probing move: a feed if a tool of some kind goes through metal, since tools of all kinds cut. Other ones
    /// through metal are counted.
    pub(super) fn kind_of_probing(&mut self, event: &Event<'_>, from: &Point3<f64>) -> MotionKind {
        let is_cutter = self.machine.kind_of(self.setup.tool).is_some() && !self.is_probe();
        self.check_probe_body(event, from);
        match self.metal.uncut(&[*from, self.pose.tip]) {
            Some(_) if is_cutter => MotionKind::Feed,
            Some(_) => {
                self.is_probe_in_metal = matches!(event.kind, EventKind::Skip { has_signal: false, .. });
                let probes = match self.is_probe_in_metal {
                    true => &mut self.unjudged.probes_without_signal,
                    false => &mut self.unjudged.probes_in_metal,
                };
                probes.count(|| event.backtrace());
                MotionKind::Probe
            }
            None => MotionKind::Probe,
        }
    }

    /// Reports the shank or the holder of a touch probe that a feed or a probing move leads into what has to stay.
    fn check_probe_body(&mut self, event: &Event<'_>, from: &Point3<f64>) {
        let Some(axis) = self.pose.axis.filter(|_| self.is_probe() && self.has_left_start) else { return };
        let travel = [*from, self.pose.tip];
        let at = self.tool_body.iter().filter(|part| !part.is_cutter).find_map(|part| {
            let side = FeedPart::Side { radius: part.radius(), slope: part.taper.slope };
            self.contact_in_feed(part, &axis, &travel, Judged::Kept(side, u32::MAX))
        });
        if let Some(at) = at {
            self.report_gouge(&event.backtrace(), &travel, Gouge { at, part: ToolRegion::Shank });
        }
        self.count_unsearched_feed(event, OnPath::Straight);
    }

    /// Returns true for a tool that the machine file gives as a touch probe: it cuts nothing, and its feeds only position it.
    pub(super) fn is_probe(&self) -> bool {
        self.machine.kind_of(self.setup.tool) == Some(ToolKind::Probe)
    }

    /// Returns the kind of a feed or a rapid of a touch probe: neither, where it is fed or moves in a pocket. A feed through metal
    /// that has to stay is reported; in a pocket that nothing has milled the blank may be open.
    pub(super) fn kind_of_probe_motion(
        &mut self,
        event: &Event<'_>,
        kind: MotionKind,
        from: &Point3<f64>,
    ) -> MotionKind {
        let travel = [*from, self.pose.tip];
        if kind == MotionKind::Feed {
            self.check_probe_body(event, from);
        }
        let kept = self.metal.gouge(&travel, FeedPart::Tip);
        match kept.filter(|_| kind == MotionKind::Feed) {
            Some(PointInMetal { point, depth }) => {
                let probe = tool_name(self.setup.tool);
                self.findings.add(&FEED_BESIDE_HOLE, &event.backtrace(), 3, |kind| {
                    let point = format_point(&point);
                    let message =
                        format!("{probe} is a probe and is fed {depth:.3} mm into the metal at {point}");
                    Diagnostic::new(kind, message)
                        .help("G31 stops at the surface; lead other feeds of a probe through the air")
                });
            }
            None if kept.is_none() && self.metal.uncut(&travel).is_some() => {
                self.unjudged.probes_in_metal.count(|| event.backtrace());
                return MotionKind::Probe;
            }
            None => {}
        }
        if kept.is_none() {
            self.check_ball(event, kind, from);
        }
        if kind == MotionKind::Feed { MotionKind::Probe } else { kind }
    }

    /// Reports a motion at whose end the ball of the probe is in metal that has to stay: its lowest point, or the one ahead. The tip
    /// is the ball's centre.
    fn check_ball(&mut self, event: &Event<'_>, kind: MotionKind, from: &Point3<f64>) {
        let reach = self.machine.probe.as_ref().map_or(0.0, |probe| probe.radius - DEEPEST_TOUCH);
        let Some(axis) = self.pose.axis.filter(|_| 0.0 < reach && self.has_left_start) else { return };
        let (tip, travel) = (self.pose.tip, self.pose.tip - from);
        let ahead = Unit::try_new(travel - axis.into_inner() * travel.dot(&axis), TOUCH_DEPTH);
        let points = [Some(-axis), ahead].into_iter().flatten().map(|to| tip + to.into_inner() * reach);
        let Some(found) = points.filter_map(|point| self.metal.gouge(&[point; 2], FeedPart::Tip)).next()
        else {
            return;
        };
        let of_motion = if kind == MotionKind::Feed { &FEED_BESIDE_HOLE } else { &RAPID_INTO_PART };
        let (probe, point) = (tool_name(self.setup.tool), format_point(&found.point));
        self.findings.add(of_motion, &event.backtrace(), 4, |kind| {
            Diagnostic::new(kind, format!("the ball of {probe} ends in the metal at {point}"))
                .help("stop above the part by more than the radius of the ball, and approach with G31")
        });
    }

    /// Returns true if the tool comes from where a probing move without a signal has left it in the metal: a real probe stands
    /// elsewhere until it is outside.
    pub(super) fn follow_unstopped_probe(&mut self) -> bool {
        let was_inside = self.is_probe_in_metal;
        self.is_probe_in_metal = was_inside && self.metal.uncut(&[self.pose.tip; 2]).is_some();
        was_inside
    }
}
