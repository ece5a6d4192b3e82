//! Motion that must not cut, and motion that is no hole: rapids through the part or beyond a cut, curved ways.
use nalgebra::Point3;

use super::HoleExtractor;
use super::line::CuttingLine;
use crate::findings::{FEED_NO_HOLE, RAPID_BEYOND_CUT, RAPID_INTO_PART};
use crate::machine::path::AxisMotion;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::Event;
use gcode_part::Surface;

/// Motion less than this below the surface, in mm, isn't told.
pub(super) const TOUCH_DEPTH: f64 = 0.01;

/// A straight way within some 6° of the tool's axis plunges.
const PLUNGE_COSINE: f64 = 0.995;

/// What a curved motion is.
#[derive(Clone, Copy)]
pub(super) enum CurvedMotion {
    Rapid,
    Feed,
}

impl HoleExtractor<'_> {
    /// After a way back, a rapid along the line ran deeper than the line was cut.
    pub(super) fn report_rapid_beyond_cut(&mut self, event: &Event<'_>, line: &CuttingLine) {
        let bottom = line.bottom();
        let inside = self.surface.map(|surface| surface.depth(&bottom));
        if inside.is_some_and(|depth| depth <= TOUCH_DEPTH) {
            return;
        }
        self.findings.add(&RAPID_BEYOND_CUT, &event.backtrace(), 0, |kind| {
            let message = format!(
                "rapid along the hole beyond the drilled depth, to {:.3} mm from the start of the feed",
                line.cut_depth()
            );
            let finding = match inside {
                Some(_) => Diagnostic::new(kind, message),
                None => Diagnostic::new(kind, message).with_severity(Severity::Warning),
            };
            finding.help("end the rapid above the depth already drilled")
        });
    }

    /// The feed ends and a rapid goes on in its direction: out of the part after a feed outwards, or deeper into it.
    pub(super) fn report_overrun(&mut self, event: &Event<'_>, line: &CuttingLine, to: &Point3<f64>) {
        // A rapid into the part is told where all rapids are.
        if self.surface.is_some() {
            return;
        }
        let outwards = line.tool_axis.is_some_and(|axis| axis.dot(&line.out) < 0.0);
        if outwards {
            return;
        }
        self.findings.add(&RAPID_BEYOND_CUT, &event.backtrace(), 0, |kind| {
            Diagnostic::new(kind, format!(
                    "the rapid continues {:.3} mm in the direction of a feed of {:.3} mm: not counted as a hole",
                    line.depth_of(to) - line.cut_depth(),
                    line.cut_depth()
                )).with_severity(Severity::Warning)
            .help("check that the feed leads out of the part; otherwise the rapid enters it")
        });
    }

    /// A rapid straight on the part, off every line that is being cut.
    pub(super) fn check_rapid(&mut self, event: &Event<'_>, from: &Point3<f64>, to: &Point3<f64>) {
        let Some(surface) = self.surface else { return };
        let deepest = surface.deepest_between(from, to);
        let depth = surface.depth(&deepest);
        if !self.has_been_outside {
            self.check_first_rapid(event, &surface, from, to);
            return;
        }
        if depth <= TOUCH_DEPTH {
            self.record_close_rapid(event, &surface, from, to);
        } else {
            self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
                Diagnostic::new(
                    kind,
                    format!(
                        "rapid through the part, {depth:.3} mm below the surface at {}",
                        format_point(&deepest)
                    ),
                )
                .help("move round the part at a safe height; only a feed may enter it")
            });
        }
    }

    /// Where a rapid begins before the tool has been outside the part, nobody knows; where it ends is known as far as the
    /// axes that haven't moved stand at machine zero. The height over the part is one that has moved.
    pub(super) fn check_first_rapid(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) {
        let (depth, way) = (surface.depth(to), to - from);
        let inwards = self.pose.axis.is_some_and(|axis| way.dot(&axis) <= -PLUNGE_COSINE * way.norm());
        if depth <= TOUCH_DEPTH || !inwards {
            return;
        }
        // Without work offsets machine zero is only taken for the work zero: nothing stands there.
        let known = !self.machine.offsets.is_empty();
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let message = format!("the rapid ends {depth:.3} mm below the surface, at {}", format_point(to));
            let finding = match known {
                true => Diagnostic::new(kind, message),
                false => Diagnostic::new(kind, message).with_severity(Severity::Warning),
            };
            finding
                .note(
                    "the start of this rapid is unknown; axes that have not moved yet are assumed to be at \
                     machine zero",
                )
                .help("end it at a safe height; check the sign of Z and the length offset")
        });
    }

    /// A motion that is curved on the part: a rapid must stay outside, a feed is no hole.
    pub(super) fn check_curved(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>, kind: CurvedMotion) {
        let deepest = match self.surface {
            Some(surface) if self.has_been_outside => self.max_depth_along(&surface, travel),
            _ => f64::NEG_INFINITY,
        };
        let in_part = deepest > 2.0 * TOUCH_DEPTH;
        match kind {
            CurvedMotion::Rapid if in_part => {
                self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
                    Diagnostic::new(
                        kind,
                        format!(
                            "rapid through the part while an axis rotates, {deepest:.3} mm below the surface"
                        ),
                    )
                    .help("retract until the tool is outside the part before the table or the head rotates")
                })
            }
            CurvedMotion::Feed if in_part => {
                self.findings.add(&FEED_NO_HOLE, &event.backtrace(), 0, |kind| {
                    Diagnostic::new(
                        kind,
                        format!("a curved feed cuts {deepest:.3} mm into the part: not a hole"),
                    )
                    .help("feed holes along a straight line, with the table stationary")
                })
            }
            CurvedMotion::Rapid | CurvedMotion::Feed if self.has_been_outside => {
                if let Some(surface) = self.surface {
                    self.record_close_turn(event, &surface, travel);
                }
            }
            CurvedMotion::Feed if self.surface.is_none() => {
                self.findings.add(&FEED_NO_HOLE, &event.backtrace(), 0, |kind| {
                    Diagnostic::new(kind, "a curved feed on the part: not counted as a hole")
                        .with_severity(Severity::Warning)
                        .help("feed holes along a straight line, with the table stationary")
                })
            }
            CurvedMotion::Rapid | CurvedMotion::Feed => {}
        }
    }

    /// How far below the surface a curved way goes; below 0 outside. Coarse chords first: most ways stay far away.
    fn max_depth_along(&self, surface: &Surface, travel: &AxisMotion<'_>) -> f64 {
        for tolerance in [40.0, 5.0, 0.5] {
            let mut last: Option<Point3<f64>> = None;
            let mut clear = true;
            self.machine.for_each_pose(travel, &self.setup, tolerance, |pose| {
                let from = last.replace(pose.tip).unwrap_or(pose.tip);
                clear = clear && surface.clearance(&from, &pose.tip) > tolerance;
            });
            if clear {
                return f64::NEG_INFINITY;
            }
        }
        let mut last: Option<Point3<f64>> = None;
        let mut deepest = f64::NEG_INFINITY;
        self.machine.for_each_pose(travel, &self.setup, TOUCH_DEPTH, |pose| {
            let from = last.replace(pose.tip).unwrap_or(pose.tip);
            if surface.clearance(&from, &pose.tip) <= 0.0 {
                deepest = deepest.max(surface.depth(&surface.deepest_between(&from, &pose.tip)));
            }
        });
        deepest
    }
}

/// Rounded; adding 0 to what is rounded turns −0 into 0.
pub(super) fn format_point(p: &Point3<f64>) -> String {
    let [x, y, z] = [p.x, p.y, p.z].map(|v| (v * 1000.0).round() / 1000.0 + 0.0);
    format!("x {x:.3} y {y:.3} z {z:.3} on the part")
}
