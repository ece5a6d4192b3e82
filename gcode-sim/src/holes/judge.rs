//! What is wrong with a motion: feeds beside the tool, rapids in the material, axes that carry nothing.
use nalgebra::Point3;

use super::line::{After, Line};
use super::{Extractor, Pass};
use crate::diag::Diagnostic;
use crate::machine::HeadKind;
use crate::machine::path::Travel;
use crate::motion::{Event, Position};
use crate::part::surface::Surface;
use crate::units::Deg;

/// A feed may differ from the tool's direction by this much and by what rounding explains.
const ALONG: Deg = Deg(0.05);

/// Motion less than this below the surface, in mm, isn't told.
const TOUCH: f64 = 0.01;

#[derive(Clone, Copy)]
pub(super) enum Curved {
    Rapid,
    Feed,
}

impl Extractor<'_> {
    /// The tool has left a line, or the run is over: is it a hole?
    pub(super) fn judge_line(&mut self, line: Line, after: After, feeding: bool) {
        let place = line.place().clone();
        let off = line.tool_axis.map(|axis| Deg::acos(axis.dot(&line.out).clamp(-1.0, 1.0)));
        let came_back = match after {
            After::On | After::Out => true,
            After::Aside { back } => back > TOUCH,
        };
        let inside = self.surface.map(|s| s.depth(&s.deepest_between(&line.start, &line.bottom())));
        // A feed outwards, as of a tool that was left in its hole, makes none.
        // Told where it begins: a hole on a steep flank may end outside the part again.
        let rises =
            self.surface.is_some_and(|s| s.gradient(&line.start).dot(&(line.bottom() - line.start)) >= 0.0);
        let backwards = off.is_some_and(|off| off.0 > 90.0);
        if rises || backwards && inside.is_none_or(|depth| depth <= TOUCH) {
            return;
        }
        if !came_back {
            match inside {
                Some(depth) if depth <= TOUCH => return,
                Some(depth) => self.findings.add("feed-without-retract", &place, 0, || {
                    Diagnostic::error(
                        "feed-without-retract",
                        format!("the feed ends {depth:.3} mm inside the part and the tool doesn't come back along it"),
                    )
                    .help("retract along the hole before anything else moves")
                }),
                None => self.findings.add("feed-without-retract", &place, 0, || {
                    let length = line.cut();
                    Diagnostic::warning(
                        "feed-without-retract",
                        format!("the tool doesn't come back along a feed of {length:.3} mm: not taken for a hole"),
                    )
                    .help("if it is a hole, retract along it before anything else moves")
                }),
            }
            if inside.is_none() || feeding {
                return;
            }
        } else if let (After::Aside { back }, Some(surface)) = (after, self.surface) {
            let left_at = line.bottom() + line.out.into_inner() * back;
            let depth = surface.depth(&left_at);
            if depth > TOUCH {
                self.findings.add("leaves-hole-sideways", &place, 0, || {
                    Diagnostic::error(
                        "leaves-hole-sideways",
                        format!("the tool leaves the hole sideways, {depth:.3} mm below the surface"),
                    )
                    .help("retract along the hole until the tool is outside the part")
                });
            }
        }
        self.judge_feed(&line, off);
        let (pass, again): (Pass, Option<Pass>) = line.finish();
        self.keep(std::iter::once(pass).chain(again));
    }

    fn judge_feed(&mut self, line: &Line, off: Option<Deg>) {
        let place = line.place();
        if line.spindle_off {
            self.findings.add("spindle-stopped", place, 0, || {
                Diagnostic::warning(
                    "spindle-stopped",
                    "the tool feeds into the part while the spindle stands",
                )
                .help("start the spindle with M03 S… before the feed")
            });
        }
        let Some(off) = off else {
            if matches!(self.machine.head.kind, HeadKind::Manual { .. }) {
                self.findings.add("head-not-set", place, 0, || {
                    Diagnostic::error(
                        "head-not-set",
                        "the tool feeds before the head has been set: its angle isn't known",
                    )
                    .help(
                        "stop with #3006=1(SET HEAD TO #140) before, or give head.angle in the machine file",
                    )
                });
            }
            return;
        };
        let rounding = Deg::atan2(2.0 * self.machine.increment.size(), line.cut());
        if off.0 > (ALONG + rounding).0 {
            self.findings.add("feed-not-along-tool", place, 0, || {
                let aside = off.sin() * line.cut();
                Diagnostic::error(
                    "feed-not-along-tool",
                    format!(
                        "the feed runs {:.3}° off the tool's axis ({:.2}° allowed): {aside:.3} mm aside over {:.3} mm",
                        off.0,
                        ALONG.0,
                        line.cut()
                    ),
                )
                .help("set the head to the direction of the feed, or feed along the tool")
            });
        }
    }

    /// After a way back, a rapid along the line ran deeper than the line was cut.
    pub(super) fn rapid_into_uncut(&mut self, event: &Event<'_>, line: &Line) {
        let bottom = line.bottom();
        let inside = self.surface.map(|surface| surface.depth(&bottom));
        if inside.is_some_and(|depth| depth <= TOUCH) {
            return;
        }
        self.findings.add("rapid-beyond-cut", &event.place(), 0, || {
            let message = format!(
                "rapid along the hole beyond what was cut, to {:.3} mm from where the feed began",
                line.cut()
            );
            let finding = match inside {
                Some(_) => Diagnostic::error("rapid-beyond-cut", message),
                None => Diagnostic::warning("rapid-beyond-cut", message),
            };
            finding.help("end the rapid above the depth already drilled")
        });
    }

    /// The feed ends and a rapid goes on in its direction: out of the part after a feed outwards, or deeper into it.
    pub(super) fn judge_overrun(&mut self, event: &Event<'_>, line: &Line, to: &Point3<f64>) {
        // A rapid into the part is told where all rapids are.
        if self.surface.is_some() {
            return;
        }
        let outwards = line.tool_axis.is_some_and(|axis| axis.dot(&line.out) < 0.0);
        if outwards {
            return;
        }
        self.findings.add("rapid-beyond-cut", &event.place(), 0, || {
            Diagnostic::warning(
                "rapid-beyond-cut",
                format!(
                    "the rapid goes {:.3} mm on in the direction of a feed of {:.3} mm: not taken for a hole",
                    line.depth_of(to) - line.cut(),
                    line.cut()
                ),
            )
            .help("right if the feed led out of the part; else the rapid runs into it")
        });
    }

    /// A rapid straight on the part, off every line that is being cut.
    pub(super) fn check_rapid(&mut self, event: &Event<'_>, from: &Point3<f64>, to: &Point3<f64>) {
        let Some(surface) = self.surface else { return };
        let deepest = surface.deepest_between(from, to);
        let depth = surface.depth(&deepest);
        if depth > TOUCH && self.outside {
            self.findings.add("rapid-into-part", &event.place(), 0, || {
                Diagnostic::error(
                    "rapid-into-part",
                    format!("rapid through the part, {depth:.3} mm below the surface at {}", shown(&deepest)),
                )
                .help("go round at a safe height; only a feed may enter the part")
            });
        }
    }

    /// A motion that is curved on the part: a rapid must stay outside, a feed is no hole.
    pub(super) fn check_curved(&mut self, event: &Event<'_>, travel: &Travel<'_>, kind: Curved) {
        let deepest = match self.surface {
            Some(surface) if self.outside => self.deepest_on(&surface, travel),
            _ => f64::NEG_INFINITY,
        };
        let in_part = deepest > 2.0 * TOUCH;
        match kind {
            Curved::Rapid if in_part => self.findings.add("rapid-into-part", &event.place(), 0, || {
                Diagnostic::error(
                    "rapid-into-part",
                    format!("rapid through the part while an axis turns, {deepest:.3} mm below the surface"),
                )
                .help("retract until the tool is outside the part before the table or the head turns")
            }),
            Curved::Feed if in_part => self.findings.add("feed-no-hole", &event.place(), 0, || {
                Diagnostic::error(
                    "feed-no-hole",
                    format!("a curved feed cuts {deepest:.3} mm into the part: no hole"),
                )
                .help("holes are fed along a straight line while the table stands")
            }),
            Curved::Feed if self.surface.is_none() => {
                self.findings.add("feed-no-hole", &event.place(), 0, || {
                    Diagnostic::warning("feed-no-hole", "a curved feed on the part: not taken for a hole")
                        .help("holes are fed along a straight line while the table stands")
                })
            }
            Curved::Rapid | Curved::Feed => {}
        }
    }

    /// How far below the surface a curved way goes; below 0 outside. Coarse chords first: most ways stay far away.
    fn deepest_on(&self, surface: &Surface, travel: &Travel<'_>) -> f64 {
        for tolerance in [40.0, 5.0, 0.5] {
            let mut last: Option<Point3<f64>> = None;
            let mut clear = true;
            self.machine.follow(travel, &self.setup, tolerance, |pose| {
                let from = last.replace(pose.tip).unwrap_or(pose.tip);
                clear = clear && surface.clearance(&from, &pose.tip) > tolerance;
            });
            if clear {
                return f64::NEG_INFINITY;
            }
        }
        let mut last: Option<Point3<f64>> = None;
        let mut deepest = f64::NEG_INFINITY;
        self.machine.follow(travel, &self.setup, TOUCH, |pose| {
            let from = last.replace(pose.tip).unwrap_or(pose.tip);
            if surface.clearance(&from, &pose.tip) <= 0.0 {
                deepest = deepest.max(surface.depth(&surface.deepest_between(&from, &pose.tip)));
            }
        });
        deepest
    }

    /// An axis that the control has and the machine doesn't use was told to move.
    pub(super) fn idle_axes(&mut self, event: &Event<'_>, from: &Position, to: &Position) {
        for (axis, letter) in self.machine.axes.iter() {
            if from[axis] != to[axis] && !self.machine.carries(axis) {
                self.findings.add("axis-carries-nothing", &event.place(), axis as u32, || {
                    Diagnostic::warning(
                        "axis-carries-nothing",
                        format!("{letter} moves to {}, but nothing is on that axis of the machine", to[axis]),
                    )
                    .help(format!(
                        "say in the machine file what {letter} carries, or leave it out of the program"
                    ))
                });
            }
        }
    }

    pub(super) fn known_tool(&mut self, event: &Event<'_>, number: u32) {
        if number != 0 && !self.machine.tools.is_empty() && self.machine.find_tool(number).is_none() {
            self.findings.add("tool-unknown", &event.place(), number, || {
                Diagnostic::warning(
                    "tool-unknown",
                    format!("T{number} isn't in the machine file's tool table: its length is taken from the length offset, its diameter isn't known"),
                )
                .help(format!("add a [[tool]] with number = {number}"))
            });
        }
    }

    /// The operator does what `#3006=1(SET HEAD TO #140)` says: the angle, where the message gives one.
    pub(super) fn head_message(
        &mut self,
        event: &Event<'_>,
        text: &str,
        named: &[(u32, f64)],
    ) -> Option<Deg> {
        let mut words = text.split(|c: char| !c.is_ascii_alphanumeric());
        if !words.any(|word| word.eq_ignore_ascii_case("HEAD")) {
            return None;
        }
        if !self.machine.head.is_set_by_hand() {
            self.findings.add("head-not-manual", &event.place(), 0, || {
                Diagnostic::warning(
                    "head-not-manual",
                    format!(
                        "the message ({text}) asks for a head set by hand, but the machine's head isn't one"
                    ),
                )
                .help("give kind = \"manual\" under [head] in the machine file, or leave the message out")
            });
            return None;
        }
        match named {
            [(_, angle)] if angle.is_finite() => Some(Deg(*angle)),
            _ => {
                self.findings.add("head-message-unclear", &event.place(), 0, || {
                    Diagnostic::warning(
                        "head-message-unclear",
                        format!("the message ({text}) doesn't name one variable with a value: the head stays as it is"),
                    )
                    .help("name the variable that holds the angle, as in #3006=1(SET HEAD TO #140)")
                });
                None
            }
        }
    }
}

/// Rounded; adding 0 to what is rounded turns −0 into 0.
fn shown(p: &Point3<f64>) -> String {
    let [x, y, z] = [p.x, p.y, p.z].map(|v| (v * 1000.0).round() / 1000.0 + 0.0);
    format!("x {x:.3} y {y:.3} z {z:.3} on the part")
}
