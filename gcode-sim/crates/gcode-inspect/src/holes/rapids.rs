//! Motion that must not cut and motion that makes no hole: rapids through the part or beyond a cut, curved paths.
use nalgebra::Point3;

use super::line::{CuttingLine, ToolExit};
use super::metal::PointInMetal;
use super::{HoleExtractor, MotionKind};
use crate::findings::{FEED_NO_HOLE, RAPID_BEYOND_CUT, TOOL_LEFT_IN_HOLE};
use crate::machine::{AxisMotion, TOUCH_DEPTH};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::Event;
use gcode_part::Surface;

/// Cosine of the largest angle of a plunge to the tool's axis: 6°.
pub(super) const PLUNGE_COSINE: f64 = 0.995;

impl HoleExtractor<'_> {
    /// Reports a rapid that returns along the line deeper than it was cut.
    pub(super) fn report_rapid_beyond_cut(&mut self, event: &Event<'_>, line: &CuttingLine) {
        let is_known = self.metal.cuts(&line.start, &line.bottom()).is_some();
        self.findings.add(&RAPID_BEYOND_CUT, &event.backtrace(), 0, |kind| {
            let message = format!(
                "rapid along the hole beyond the drilled depth, to {:.3} mm from the start of the feed",
                line.cut_depth()
            );
            Diagnostic::new(kind, message)
                .with_severity(error_if(is_known))
                .help("end the rapid above the depth already drilled")
        });
    }

    /// Reports a rapid that continues a feed in its direction: out of the part, or deeper into it. With a known surface
    /// it is checked as any rapid, and above the entry of a nominal hole is no metal.
    pub(super) fn report_overrun(&mut self, event: &Event<'_>, line: &CuttingLine, to: &Point3<f64>) {
        let is_outward = line.tool_axis.is_some_and(|axis| axis.dot(&line.out) < 0.0);
        let is_free = self.metal.is_above_entry(to, &line.tool_axis.unwrap_or(line.out));
        if self.surface.is_some() || is_outward || is_free {
            return;
        }
        self.findings.add_in_program(&RAPID_BEYOND_CUT, &event.backtrace(), 1, 1, |kind| {
            let message = format!(
                "the rapid continues {:.3} mm in the direction of a feed of {:.3} mm: not counted as a hole",
                line.depth_of(to) - line.cut_depth(),
                line.cut_depth()
            );
            Diagnostic::new(kind, message)
                .with_severity(Severity::Warning)
                .help("check that the feed leads out of the part; otherwise the rapid enters it")
        });
    }

    /// Checks a rapid that is straight on the part and on no current line; returns true if it cuts.
    pub(super) fn check_rapid(&mut self, event: &Event<'_>, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let Some(surface) = self.surface else { return self.check_rapid_at_holes(event, from, to) };
        if !self.has_left_start {
            self.check_known_end(event, to);
            return false;
        }
        let deepest = surface.deepest_between(from, to);
        let depth = surface.depth(&deepest);
        if depth <= TOUCH_DEPTH {
            self.record_close_rapid(event, &surface, from, to);
            return false;
        }
        let Some(PointInMetal { point, depth }) = self.metal.uncut(&[*from, *to]) else {
            return false;
        };
        self.add_rapid_into_part(event, |kind| {
            let point = format_point(&point);
            let message = format!("rapid through the part, {depth:.3} mm below the surface at {point}");
            Diagnostic::new(kind, message)
                .help("move round the part at a safe height; only a feed may enter it")
        });
        true
    }

    /// Checks the known end of a rapid whose start is unknown.
    pub(super) fn check_known_end(&mut self, event: &Event<'_>, to: &Point3<f64>) {
        match self.surface {
            Some(_) if self.metal.uncut(&[*to, *to]).is_none() => self.check_body_at(event, to),
            Some(surface) => {
                let note = "the start of this rapid is unknown";
                self.check_rapid_end(event, &surface, to, Severity::Error, note);
            }
            None => {
                self.check_rapid_at_holes(event, to, to);
            }
        }
    }

    /// Checks the end of a first rapid along the tool while other axes are unknown: these are taken to be at machine zero.
    pub(super) fn check_first_rapid(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) {
        let along = to - from;
        if self.pose.axis.is_some_and(|axis| along.dot(&axis) <= -PLUNGE_COSINE * along.norm()) {
            // Without work offsets machine zero only stands for the work zero.
            let severity = error_if(!self.machine.offsets.is_empty());
            let note = "the start of this rapid is unknown; axes that have not moved yet are assumed to be at \
                        machine zero";
            self.check_rapid_end(event, surface, to, severity, note);
        }
    }

    /// Reports a rapid of unknown start that ends in the part.
    pub(super) fn check_rapid_end(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        to: &Point3<f64>,
        severity: Severity,
        note: &str,
    ) {
        let depth = surface.depth(to);
        if depth <= TOUCH_DEPTH {
            return;
        }
        self.add_rapid_into_part(event, |kind| {
            let message = format!("the rapid ends {depth:.3} mm below the surface, at {}", format_point(to));
            Diagnostic::new(kind, message)
                .with_severity(severity)
                .note(note)
                .help("end it at a safe height; check the sign of Z and the length offset")
        });
    }

    /// Reports a straight rapid through metal round a hole; returns true if there is any.
    fn check_rapid_at_holes(&mut self, event: &Event<'_>, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let Some(PointInMetal { point, depth }) = self.metal.uncut(&[*from, *to]) else {
            return false;
        };
        let id = self.metal.hole_at(&point).unwrap_or_default().to_owned();
        self.add_rapid_into_part(event, |kind| {
            let point = format_point(&point);
            let message = format!(
                "rapid into the metal at hole {id}, {depth:.3} mm below its nominal entry, at {point}"
            );
            Diagnostic::new(kind, message)
                .help("end the rapid above the entry of the hole; only a feed may enter the metal")
        });
        true
    }

    /// Checks a motion that is curved on the part: a rapid must stay outside, a feed makes no hole. Returns true if it is
    /// in the part.
    pub(super) fn check_curved(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
        kind: MotionKind,
    ) -> bool {
        let is_rapid = kind == MotionKind::Rapid;
        let Some(surface) = self.surface else {
            if !is_rapid {
                self.engagement.uncounted.add_curved(event.backtrace());
                return false;
            }
            let path = self.chords(travel, TOUCH_DEPTH);
            return self.metal.is_known()
                && (path.windows(2).any(|chord| self.check_rapid_at_holes(event, &chord[0], &chord[1]))
                    || self.check_turned_body(event, travel));
        };
        // Where the holes are known, an arc is judged by what it removes.
        let is_judged = travel.arc.is_some()
            && self.metal.holes.is_some()
            && (self.pose.axis.is_some() || surface.has_flat_faces())
            && self.is_stationary(travel);
        let (of_outline, depth) = match self.has_left_start && !is_judged {
            true => self.max_depth_along(&surface, travel),
            false => (f64::NEG_INFINITY, f64::NEG_INFINITY),
        };
        if depth <= 2.0 * TOUCH_DEPTH {
            let is_outside = of_outline <= 2.0 * TOUCH_DEPTH;
            if is_rapid && is_outside && self.has_left_start && !self.change_retract.is_checked() {
                self.record_close_turn(event, &surface, travel);
            }
            return false;
        }
        if is_rapid {
            self.add_rapid_into_part(event, |kind| {
                let message =
                    format!("rapid through the part while an axis rotates, {depth:.3} mm below the surface");
                let help = "retract until the tool is outside the part before the table or the head rotates";
                Diagnostic::new(kind, message).help(help)
            });
        } else {
            let note = self.turning_gouge(travel).and_then(|gouge| self.pocket_note(gouge));
            self.engagement.errors.add(&FEED_NO_HOLE, &event.backtrace(), 0, |kind| {
                let message = format!("a curved feed cuts {depth:.3} mm into the part: not a hole");
                let help = "drill along a straight line, or mill full circles, with the table stationary";
                note.into_iter().fold(Diagnostic::new(kind, message), Diagnostic::note).help(help)
            });
        }
        true
    }

    /// Returns true if neither table nor head rotates.
    fn is_stationary(&self, travel: &AxisMotion<'_>) -> bool {
        self.machine.is_straight(&AxisMotion { arc: None, ..*travel })
    }

    /// Returns points of a path on the part; it deviates from their chords by at most `tolerance`.
    pub(super) fn chords(&self, travel: &AxisMotion<'_>, tolerance: f64) -> Vec<Point3<f64>> {
        let mut tips = Vec::new();
        self.machine.for_each_pose(travel, &self.setup, tolerance, |pose| tips.push(pose.tip));
        tips
    }

    /// Reports a run that ends with the tool in the metal; the line on which it stands makes its hole.
    pub(super) fn end_in_metal(&mut self) {
        let tip = self.pose.tip;
        let is_known =
            self.positions.is_known(self.machine) && (self.has_left_start || self.surface.is_none());
        let is_free = self.tool_direction().is_some_and(|axis| self.metal.is_in_open_void(&tip, &axis));
        let depth = self.metal.depth(&tip).filter(|depth| is_known && !is_free && TOUCH_DEPTH < *depth);
        let Some((depth, backtrace)) = depth.zip(self.last_block.take()) else { return };
        let level = self.metal.level_at(&tip);
        self.findings.add(&TOOL_LEFT_IN_HOLE, &backtrace, 0, |kind| {
            let point = format_point(&tip);
            let message = format!("the run ends with the tool {depth:.3} mm below {level}, at {point}");
            Diagnostic::new(kind, message).help("retract above the surface before the end of the program")
        });
        if let Some(line) = self.current_line.take() {
            self.report_line(line, ToolExit::OnLine, None);
        }
    }

    /// Returns the largest depth of a curved path below the surface, mm, negative outside, and where no void is. Coarse chords come
    /// first: most paths are far away.
    fn max_depth_along(&self, surface: &Surface, travel: &AxisMotion<'_>) -> (f64, f64) {
        let for_each_chord = |tolerance: f64, each: &mut dyn FnMut(&Point3<f64>, &Point3<f64>)| {
            let mut last: Option<Point3<f64>> = None;
            self.machine.for_each_pose(travel, &self.setup, tolerance, |pose| {
                each(&last.replace(pose.tip).unwrap_or(pose.tip), &pose.tip);
            });
        };
        for tolerance in [40.0, 5.0, 0.5] {
            let mut is_clear = true;
            for_each_chord(tolerance, &mut |from, to| {
                is_clear = is_clear && surface.clearance(from, to) > tolerance;
            });
            if is_clear {
                return (f64::NEG_INFINITY, f64::NEG_INFINITY);
            }
        }
        let (mut of_outline, mut in_metal) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for_each_chord(TOUCH_DEPTH, &mut |from, to| {
            if surface.clearance(from, to) <= 0.0 {
                of_outline = of_outline.max(surface.depth(&surface.deepest_between(from, to)));
                in_metal =
                    self.metal.depth_in_stock(&[*from, *to]).map_or(in_metal, |depth| depth.max(in_metal));
            }
        });
        (of_outline, in_metal)
    }
}

/// Returns the severity of a fault that is certain, or only probable.
pub(super) fn error_if(is_certain: bool) -> Severity {
    if is_certain { Severity::Error } else { Severity::Warning }
}

/// Formats a point, rounded; −0 becomes 0.
pub(super) fn format_point(p: &Point3<f64>) -> String {
    let [x, y, z] = [p.x, p.y, p.z].map(|v| (v * 1000.0).round() / 1000.0 + 0.0);
    format!("x {x:.3} y {y:.3} z {z:.3} on the part")
}
