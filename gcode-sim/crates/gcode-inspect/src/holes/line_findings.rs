//! What is wrong with a line that was cut: no way back, a way out sideways, a feed beside the tool's axis.
use super::line::{CuttingLine, ToolExit};
use super::rapids::TOUCH_DEPTH;
use super::{DrillPass, HoleExtractor, spindle};
use crate::findings::{
    BACK_BORED, FEED_NOT_ALONG_TOOL, FEED_WITHOUT_RETRACT, HEAD_NOT_SET, LEAVES_HOLE_SIDEWAYS,
    SPINDLE_STOPPED,
};
use crate::machine::HeadKind;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::SpindleDirection;
use gcode_lang::units::Deg;

/// A feed may differ from the tool's direction by this much and by what rounding explains.
const MAX_FEED_TILT: Deg = Deg(0.05);

impl HoleExtractor<'_> {
    /// The tool has left a line, or the run is over: is it a hole?
    pub(super) fn report_line(&mut self, line: Box<CuttingLine>, exit: ToolExit, feeding: bool) {
        self.record_length_mismatch(&line);
        let tilt = line.tool_axis.map(|axis| Deg::acos(axis.dot(&line.out).clamp(-1.0, 1.0)));
        let came_back = match exit {
            ToolExit::OnLine | ToolExit::AlongLine => true,
            ToolExit::Sideways { back } => back > TOUCH_DEPTH,
        };
        // Asked of few lines, and not for nothing.
        let surface = self.surface;
        let inside = || surface.map(|s| s.depth(&s.deepest_between(&line.start, &line.bottom())));
        // A feed outwards, as of a tool that was left in its hole, makes none. Told where it begins: a hole on a steep flank may end outside the part again.
        let is_outward =
            self.surface.is_some_and(|s| s.gradient(&line.start).dot(&(line.bottom() - line.start)) >= 0.0);
        let backwards = tilt.is_some_and(|off| off.0 > 90.0);
        if is_outward || backwards && inside().is_none_or(|depth| depth <= TOUCH_DEPTH) {
            return;
        }
        if !came_back {
            let inside = inside();
            if inside.is_some_and(|depth| depth <= TOUCH_DEPTH) {
                return;
            }
            self.report_no_retract(&line, inside);
            if inside.is_none() || feeding {
                return;
            }
        } else if let (ToolExit::Sideways { back }, Some(surface)) = (exit, self.surface) {
            let left_at = line.bottom() + line.out.into_inner() * back;
            let depth = surface.depth(&left_at);
            if depth > TOUCH_DEPTH {
                self.findings.add(&LEAVES_HOLE_SIDEWAYS, line.backtrace(), 0, |kind| {
                    Diagnostic::new(
                        kind,
                        format!("the tool leaves the hole sideways, {depth:.3} mm below the surface"),
                    )
                    .help("retract along the hole until the tool is outside the part")
                });
            }
        }
        self.report_feed(&line, tilt);
        let (pass, again): (DrillPass, Option<DrillPass>) = line.finish();
        self.push_passes(std::iter::once(pass).chain(again));
    }

    /// A feed that the tool doesn't come back along: into the part, or nobody knows where.
    fn report_no_retract(&mut self, line: &CuttingLine, inside: Option<f64>) {
        let place = line.backtrace();
        match inside {
            Some(depth) => {
                self.findings.add(&FEED_WITHOUT_RETRACT, place, 0, |kind| {
                    Diagnostic::new(kind, format!(
                        "the feed ends {depth:.3} mm inside the part and the tool does not retract along it"
                    ))
                .help("retract along the hole before anything else moves")
                })
            }
            None => self.findings.add(&FEED_WITHOUT_RETRACT, place, 0, |kind| {
                let length = line.cut_depth();
                Diagnostic::new(
                    kind,
                    format!(
                        "the tool does not retract along a feed of {length:.3} mm: not counted as a hole"
                    ),
                )
                .with_severity(Severity::Warning)
                .help("retract along it before anything else moves, if it is a hole")
            }),
        }
    }

    /// A feed outwards that ends with a spindle that stands and a bar that is shifted: G87. The holes of a list are open
    /// where the tool comes from.
    pub(super) fn report_back_boring(&mut self, line: &CuttingLine) {
        let length = line.cut_depth();
        self.findings.add(&BACK_BORED, line.backtrace(), 0, |kind| {
            Diagnostic::new(kind, format!("the tool bores {length:.3} mm backwards, out of the part: not counted as a hole"))
            .help("check the bore's depth and position in the picture or on the review page: no check covers them")
        });
    }

    /// The spindle and the head during a feed, and its direction.
    fn report_feed(&mut self, line: &CuttingLine, tilt: Option<Deg>) {
        let place = line.backtrace();
        self.check_clamped(place, line.clamp_state);
        self.check_work_zero_known(place, line.unknown_work_zero_axes);
        if let Some(feeds) = line.cutting_feeds() {
            self.cut_conditions.add(place, &line.cutting_state, feeds, line.pecks());
        }
        self.check_spindle(place, line);
        if line.cutting_state.spindle_direction == SpindleDirection::Off {
            let builder = self.builder_code;
            self.findings.add(&SPINDLE_STOPPED, place, 0, |_| {
                spindle::spindle_stopped_finding(
                    "the tool feeds into the part with the spindle stopped",
                    builder,
                )
                .help("start the spindle with M03 S… before the feed")
            });
        }
        let Some(off) = tilt else {
            if matches!(self.machine.head.kind, HeadKind::Manual { .. }) {
                self.findings.add(&HEAD_NOT_SET, place, 0, |kind| {
                    Diagnostic::new(kind, "the tool feeds before the head is set: its angle is unknown")
                    .help(
                        "stop with #3006=1(SET HEAD TO #140) before the feed, or give head.angle in the machine file",
                    )
                });
            }
            return;
        };
        let rounding = Deg::atan2(2.0 * self.machine.increment.size(), line.cut_depth());
        if off.0 > (MAX_FEED_TILT + rounding).0 {
            self.findings.add(&FEED_NOT_ALONG_TOOL, place, 0, |kind| {
                let aside = off.sin() * line.cut_depth();
                Diagnostic::new(
                    kind,
                    format!(
                        "the feed direction is {:.3}° off the tool axis, limit {:.2}°: {aside:.3} mm \
                         sideways over {:.3} mm",
                        off.0,
                        MAX_FEED_TILT.0,
                        line.cut_depth()
                    ),
                )
                .help("set the head to the direction of the feed, or feed along the tool axis")
            });
        }
    }
}
