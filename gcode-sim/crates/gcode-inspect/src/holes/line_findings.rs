//! Findings about a line that was cut: no retract, a sideways exit, a feed off the tool's axis.
use nalgebra::{Point3, Vector3};

use super::cutting::{CuttingState, PeckExtent, RecordedCut};
use super::extraction::BackBored;
use super::line::{CuttingLine, ToolExit};
use super::near_metal::FeedPart;
use super::rapids::format_point;
use super::strokes::{CutKind, MIN_TOOL_COSINE};
use super::swept_tool::rim;
use super::unknown_axes::{unknown_position_finding, without_assumed};
use super::{AirStroke, HoleExtractor, MotionKind};
use crate::findings::{
    BACK_BORED, CYCLE_IN_AIR, FEED_NOT_ALONG_TOOL, FEED_WITHOUT_RETRACT, HEAD_NOT_SET, LEAVES_HOLE_SIDEWAYS,
    RAPID_INTO_PART, START_UNKNOWN, TOOL_KIND, TOOL_NOT_CHANGED,
};
use crate::machine::{HeadKind, TOUCH_DEPTH, ToolKind, tool_name};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, LengthCompensation, Position};
use gcode_lang::units::Deg;
use gcode_part::{Frustum, Surface, Taper};

/// Largest angle between feed and tool, besides rounding.
const MAX_FEED_TILT: Deg = Deg(0.05);

/// Distance from the start of a feed outwards at which the metal is as before it, mm.
const BELOW_SHIFT: f64 = 0.05;

/// Number of feeds beside the part that are kept: the first ones explain a missing hole.
const MAX_FEEDS_IN_AIR: usize = 100;

/// Cosine of the largest angle between a surface's normal and a feed parallel to the surface, from rounding.
const MAX_PARALLEL_COSINE: f64 = 1e-9;

/// Largest number of strokes in the air that are drawn.
const MAX_AIR_STROKES: usize = 10_000;

impl HoleExtractor<'_> {
    /// Ends the current line where the tool leaves it along a curve, or is replaced.
    pub(super) fn end_line(&mut self, next: Option<MotionKind>) {
        if let Some(line) = self.current_line.take() {
            let exit = line.curved_exit();
            self.report_line(line, exit, next);
        }
    }

    /// Reports a line that the tool has left, and keeps its passes if it makes a hole.
    ///
    /// `next` is the motion by which the tool has left it; `None` if the tool stands there and is changed, or the run ends.
    pub(super) fn report_line(
        &mut self,
        mut line: Box<CuttingLine>,
        exit: ToolExit,
        next: Option<MotionKind>,
    ) {
        let is_feeding = next == Some(MotionKind::Feed);
        self.record_length_mismatch(&line);
        self.note_cycle_in_air(&line);
        let goes_on_across = is_feeding && matches!(exit, ToolExit::Sideways { .. });
        if !goes_on_across {
            self.report_start_inside(&line);
        }
        let tilt = line.tool_axis.map(|axis| Deg::acos(axis.dot(&line.out).clamp(-1.0, 1.0)));
        self.check_lift(&line);
        // Depth in the part, computed only where it decides.
        // A feed at an unknown position may be in the part.
        let is_known = without_assumed(line.unknown_axes, self.machine).is_none();
        let surface = self.surface.filter(|_| is_known);
        let inside = || surface.map(|s| s.depth(&s.deepest_between(&line.start, &line.bottom())));
        // A feed outwards, as of a tool left in its hole, makes no hole. Its start decides: a hole in a steep flank may end
        // outside the part.
        // Parallel to the surface beside it the side of the tool decides; without its diameter the verdict does.
        let is_backward = tilt.is_some_and(|tilt| tilt.0 > 90.0);
        let is_forward = line.tool_axis.is_some_and(|axis| MIN_TOOL_COSINE <= axis.dot(&line.out));
        let may_cut =
            || self.machine.diameter_of(line.cutting_state.tool).is_none() || self.has_gouged(&line);
        let is_outward = surface.is_some_and(|s| {
            let (gradient, along) = (s.gradient(&line.start), line.bottom() - line.start);
            let slope = gradient.dot(&along);
            let is_parallel = slope <= MAX_PARALLEL_COSINE * gradient.norm() * along.norm();
            // Inside the body, as at the floor of a pocket, no face is known to be the one where the feed begins.
            let is_fed_inside = is_forward && TOUCH_DEPTH < s.depth(&line.start);
            0.0 <= slope && !is_fed_inside && !(is_parallel && may_cut())
        });
        if is_outward || is_backward && inside().is_none_or(|depth| depth <= TOUCH_DEPTH) {
            if line.is_inward() && self.feeds_in_air.len() < MAX_FEEDS_IN_AIR {
                self.feeds_in_air.push((line.bottom(), line.backtrace().clone()));
            }
            return;
        }
        match exit {
            ToolExit::Sideways { back } if back <= TOUCH_DEPTH => {
                let inside = inside();
                if inside.is_some_and(|depth| depth <= TOUCH_DEPTH) {
                    self.report_plunge(&line);
                    return;
                }
                let is_in_body = inside.is_some();
                if is_in_body || !self.makes_nominal(&line) {
                    self.report_no_retract(&line, inside, next.is_some());
                }
                if !is_in_body || is_feeding {
                    if is_in_body {
                        self.report_conditions(&line);
                    }
                    self.keep_unretracted(&mut line);
                    return;
                }
            }
            ToolExit::Sideways { back } => {
                let left_at = line.bottom() + line.out.into_inner() * back;
                let depth = surface.map(|s| s.depth(&left_at)).filter(|depth| *depth > TOUCH_DEPTH);
                if let Some(depth) = depth.filter(|_| self.is_cut_sideways(&left_at, is_feeding)) {
                    self.findings.add(&LEAVES_HOLE_SIDEWAYS, line.backtrace(), 0, |kind| {
                        let message =
                            format!("the tool leaves the hole sideways, {depth:.3} mm below the surface");
                        Diagnostic::new(kind, message)
                            .help("retract along the hole until the tool is outside the part")
                    });
                }
            }
            ToolExit::OnLine | ToolExit::AlongLine => {}
        }
        if self.is_milled(&line) {
            if !line.is_across_tool() {
                self.report_conditions(&line);
                self.report_solid(&line);
                self.note_unsized_mill(line.cutting_state.tool);
            }
            return;
        }
        let kind = self.cut_kind(&line, is_feeding);
        if !matches!(kind, CutKind::Oblique | CutKind::Side) || self.strokes.nominal_of_line(&line).is_some()
        {
            self.report_feed(&line, tilt);
        }
        // A stroke in a hole that was cut before, as of a mill that goes on sideways, has no retract either.
        let has_retract = !matches!(exit, ToolExit::Sideways { .. });
        self.cut_axes |= !line.unknown_axes.all();
        let order = line.order;
        let (pass, repeated) = line.finish();
        self.strokes.push(order, pass, kind);
        for repeated in repeated.filter(|_| has_retract) {
            let order = self.strokes.begin_pass();
            self.strokes.push(order, repeated, kind);
        }
    }

    /// Records a drilling cycle that cuts nothing of a known body.
    pub(super) fn note_cycle_in_air(&mut self, line: &CuttingLine) {
        let unknown = without_assumed(line.unknown_axes, self.machine);
        let bottom = line.bottom();
        let is_in_body = |surface: Surface| surface.is_deeper(&bottom, TOUCH_DEPTH);
        if !line.is_cycle || unknown.is_none() && self.surface.is_none_or(is_in_body) {
            return;
        }
        let place = match unknown.is_none() {
            true if self.is_cut_by_cycle(line) => return,
            true => format!("the part has no metal at {}", format_point(&bottom)),
            false => {
                let Some(height) = self.height_above_part(line, unknown.all()) else { return };
                let names = self.machine.axes.names(unknown.all());
                format!("it stays {height:.3} mm above the part, at any position of {names}")
            }
        };
        self.strokes_in_air += 1;
        if unknown.is_none() && self.air_strokes.len() < MAX_AIR_STROKES {
            let (start, out, tool) = (line.start, line.out, line.cutting_state.tool);
            self.air_strokes.push(AirStroke {
                start,
                bottom,
                out: out.into_inner(),
                tool,
                block: line.backtrace().block,
            });
        }
        self.cycles_in_air.add(&CYCLE_IN_AIR, line.backtrace(), 0, |kind| {
            Diagnostic::new(kind, format!("a drilling cycle cuts nothing: {place}"))
                .help(
                    "check X, Y and Z of the cycle; if it drills another part, state all parts in one list and one [stock] over \
                     all, or verify each with its own [part]; remove it if it is not meant to cut",
                )
        });
    }

    /// Returns true if the tool of a cycle may cut a known body: its point and its flutes, or a cylinder as wide where the tool
    /// or its direction is unknown.
    fn is_cut_by_cycle(&self, line: &CuttingLine) -> bool {
        let (start, bottom, tool) = (line.start, line.bottom(), line.cutting_state.tool);
        let axis = line.tool_axis.unwrap_or(line.out);
        let radius = self.machine.diameter_of(tool).unwrap_or(0.0) / 2.0;
        if !self.metal.is_touched(&start, &bottom, &axis, radius) {
            return false;
        }
        let is_known = self.setup.tool == tool && line.tool_axis.is_some() && !self.tool_body.is_empty();
        let Some(body) = self.surface.filter(|_| is_known) else { return true };
        let mut cutters = self.tool_body.iter().filter(|part| part.is_cutter);
        cutters.any(|part| {
            let (from, length) = (part.from, (part.to - part.from).max(0.0));
            let taper = Taper { radius: part.taper.at(from), ..part.taper };
            let base = start + axis.into_inner() * from;
            body.touches(&Frustum { base, axis, length, taper }, &(bottom - start))
        })
    }

    /// Returns how far above a known body a cycle stays, seen along the tool, while some axes are unknown; `None` if they move the
    /// tool along itself, or if it comes lower.
    fn height_above_part(&self, line: &CuttingLine, unknown: u8) -> Option<f64> {
        let (body, axis) = self.surface.zip(line.tool_axis)?;
        let pose =
            |at: &Position| self.machine.tool_pose(at, &self.setup).relative_to(&self.machine.part_frame(at));
        let here = pose(&self.axis_position);
        let moves_across = |index: usize| {
            let mut at = self.axis_position;
            at.0[index] += 1.0;
            let there = pose(&at);
            let is_parallel =
                there.axis.is_some_and(|there| (there.into_inner() - axis.into_inner()).norm() < 1e-9);
            !self.machine.axes.is_rotary(index)
                && is_parallel
                && (there.tip - here.tip).dot(&axis).abs() < 1e-9
        };
        if !(0..self.machine.axes.len()).filter(|index| unknown & 1 << index != 0).all(moves_across) {
            return None;
        }
        let [low, high] = body.bounds();
        let farthest =
            |i: usize| if axis[i] == 0.0 { 0.0 } else { (low[i] * axis[i]).max(high[i] * axis[i]) };
        let top: f64 = (0..3).map(farthest).sum();
        let lowest = line.start.coords.dot(&axis).min(line.bottom().coords.dot(&axis));
        (top + TOUCH_DEPTH < lowest).then_some(lowest - top)
    }

    /// Records a tool of unknown diameter that mills the part: it may cut more than its path shows.
    pub(super) fn note_unsized_mill(&mut self, tool: Option<u32>) {
        if self.machine.diameter_of(tool).is_none() && !self.milling.unsized_tools.contains(&tool) {
            self.milling.unsized_tools.push(tool);
        }
    }

    /// Reports a tap, a reamer or a boring bar that is fed into the solid metal of a pocket.
    fn report_solid(&mut self, line: &CuttingLine) {
        let tool = line.cutting_state.tool;
        let Some(kind) = self.machine.kind_of(tool).filter(|_| line.enters_solid) else { return };
        self.findings.add(&TOOL_KIND, line.backtrace(), 0, |finding| {
            let message = format!("{} is a {} and is fed into solid metal", tool_name(tool), kind.name());
            Diagnostic::new(finding, message).help("drill the hole before it, or correct the position")
        });
    }

    /// Returns true if what a line removes is judged as milling: in a known body a feed across the tool or in a pocket. Without
    /// a list of holes only a feed square to the tool: another one is a hole with a head that is set wrong.
    /// At an unknown position nothing says what it removes.
    pub(super) fn is_milled(&self, line: &CuttingLine) -> bool {
        self.surface.is_some()
            && without_assumed(line.unknown_axes, self.machine).is_none()
            && match self.metal.holes {
                Some(_) => line.is_across_tool() || self.is_pocketing(line) && !self.is_nominal_cycle(line),
                None => line.is_square_to_tool(),
            }
    }

    /// Returns true if a cycle drills at a nominal hole: it makes the hole, also where a pocket removes it later.
    fn is_nominal_cycle(&self, line: &CuttingLine) -> bool {
        line.is_cycle && self.strokes.nominal_of_line(line).is_some()
    }

    /// Records a feed without retract, unless it belongs to a milled hole: an error `inside` the part, by its depth, or at an
    /// unknown position, a warning if the surface is unknown.
    fn report_no_retract(&mut self, line: &CuttingLine, inside: Option<f64>, moves_on: bool) {
        let unknown = without_assumed(line.unknown_axes, self.machine);
        if self.surface.is_some() && self.metal.holes.is_some() && !unknown.is_none() {
            self.findings.add(&START_UNKNOWN, line.backtrace(), u32::from(unknown.all()), |_| {
                unknown_position_finding(&self.machine.axes, unknown, "a feed ends")
            });
            return;
        }
        let Some(depth) = inside else {
            if !self.may_drill(line) {
                return;
            }
            self.engagement.uncounted.add_unretracted(line.backtrace(), line.cut_depth());
            return;
        };
        // Without a list of holes a stated pocket says what its feeds are.
        if self.metal.holes.is_none() && self.metal.is_in_pocket(&[line.start, line.bottom()]) {
            return;
        }
        let is_judged = self.metal.holes.is_some() && line.tool_axis.is_some();
        // A tool that is fed out of the part has left it.
        let has_left = || {
            let is_outside = |body: Surface| body.depth(&line.bottom()) <= TOUCH_DEPTH;
            !line.is_inward() && self.surface.is_some_and(is_outside)
        };
        // Where the tool goes next is judged, unless that is unknown, or it is changed in the hole.
        let is_followed = (moves_on || has_left()) && self.positions.is_known(self.machine);
        if is_judged && is_followed && !self.has_gouged(line) {
            return;
        }
        let note = self.plunge_gouge(line).filter(|_| is_judged).and_then(|gouge| self.pocket_note(gouge));
        self.gouge_count += u32::from(is_judged);
        let findings = if is_judged { &mut self.findings } else { &mut self.engagement.errors };
        findings.add(&FEED_WITHOUT_RETRACT, line.backtrace(), 0, |kind| {
            let message =
                format!("the feed ends {depth:.3} mm inside the part and the tool does not retract along it");
            let finding = note.into_iter().fold(Diagnostic::new(kind, message), Diagnostic::note);
            finding.help(match line.tool_axis {
                None => {
                    "if it mills, give [head] in the machine file: without the direction of the tool each feed into the \
                     part counts as a hole; else retract along the hole before anything else moves"
                }
                Some(_) if is_judged => {
                    "retract along the hole before anything else moves, or state in [[stock.pocket]] what the program \
                     mills besides the holes"
                }
                Some(_) => "retract along the hole before anything else moves",
            })
        });
    }

    /// Returns true if a feed of an unknown body may be meant as a hole: along the tool, or along an upright one if the direction of
    /// this one is unknown, and not by an end mill.
    fn may_drill(&self, line: &CuttingLine) -> bool {
        let is_mill = self.machine.kind_of(line.cutting_state.tool) == Some(ToolKind::EndMill);
        !is_mill && !line.is_across_tool() && !line.is_across_upright()
    }

    /// Returns true if a line is a stroke of known diameter that cuts a nominal hole.
    fn makes_nominal(&self, line: &CuttingLine) -> bool {
        let is_sized = self.machine.diameter_of(line.cutting_state.tool).is_some();
        is_sized && self.strokes.nominal_of_line(line).is_some()
    }

    /// Keeps the stroke of a line at a nominal hole until it is known whether anything else makes the hole.
    fn keep_unretracted(&mut self, line: &mut CuttingLine) {
        if self.makes_nominal(line) {
            let order = line.order;
            let (pass, _) = line.finish();
            self.cut_axes |= !pass.unknown_axes.all();
            self.engagement.unretracted.push((order, pass));
        }
    }

    /// Returns true if the tool cuts on its way from a point to where it is now.
    fn is_cut_sideways(&self, from: &Point3<f64>, is_feeding: bool) -> bool {
        let travel = [*from, self.pose.tip];
        let cut = match is_feeding && self.metal.holes.is_some() {
            true => self.metal.gouge(&travel, FeedPart::Tip),
            false => self.metal.uncut(&travel),
        };
        cut.is_some()
    }

    /// Reports back boring, a feed outwards that ends with the bar shifted and the spindle stopped (G87): the holes of a
    /// list are open where the tool comes from.
    pub(super) fn report_back_boring(&mut self, line: &CuttingLine) {
        let length = line.cut_depth();
        self.report_shift_into_wall(line);
        let (end, out, backtrace) = (line.bottom(), line.out.into_inner(), line.backtrace().clone());
        self.back_bored.push(BackBored { end, out, backtrace });
        self.findings.add(&BACK_BORED, line.backtrace(), 0, |kind| {
            let message =
                format!("the tool bores {length:.3} mm backwards, out of the part: not counted as a hole");
            Diagnostic::new(kind, message).help(
                "check the bore's depth and position in the picture or on the review page: no check covers them",
            )
        });
    }

    /// Reports a bar that is shifted back for its feed outwards inside the part. It is wider than the hole that it comes
    /// through, if its diameter is unknown.
    fn report_shift_into_wall(&mut self, line: &CuttingLine) {
        let Some(body) = self.surface.filter(|body| TOUCH_DEPTH < body.depth(&line.start)) else { return };
        let below = line.start + line.out.into_inner() * BELOW_SHIFT;
        let radius = self.machine.diameter_of(line.cutting_state.tool).map(|diameter| diameter / 2.0);
        let is_met = radius.is_none_or(|radius| {
            let rim = rim(&line.out, &Vector3::zeros(), radius);
            rim.into_iter().any(|offset| self.metal.uncut(&[below + offset, below + offset]).is_some())
        });
        let Some(far) = body.exit(&line.start, &line.out).filter(|_| is_met) else { return };
        self.findings.add(&RAPID_INTO_PART, line.backtrace(), 0, |kind| {
            let (height, point) = ((far - line.start).norm(), format_point(&line.start));
            let message = format!(
                "the boring bar is shifted into the wall {height:.3} mm above the far side, at {point}"
            );
            Diagnostic::new(kind, message)
                .help("begin the feed outwards beyond the far side: R of G87 lies below the part")
        });
    }

    /// Reports a feed while the tool that the program has selected is not changed; returns true if it does. `verb` is what the
    /// tool in the spindle does.
    ///
    /// A tool that is prepared for the next change has another offset than the one in effect.
    pub(super) fn check_tool_changed(
        &mut self,
        backtrace: &Backtrace,
        state: &CuttingState,
        verb: &str,
    ) -> bool {
        let CuttingState { tool, selected_tool, compensation, .. } = *state;
        if tool == Some(0) {
            self.findings.add_in_program(&TOOL_NOT_CHANGED, backtrace, 0, 1, |kind| {
                Diagnostic::new(kind, format!("T0 is in the spindle and {verb}: no T comes before M06"))
                    .help("command the tool with T before M06")
            });
        }
        let Some(selected) = selected_tool.filter(|number| *number != 0 && tool != Some(*number)) else {
            return false;
        };
        let is_meant = match compensation {
            LengthCompensation::Plus(h) | LengthCompensation::Minus(h) if h != 0 => h == selected,
            _ => tool.is_none(),
        };
        if is_meant {
            let spindle = tool.map_or("the tool of the last job".to_owned(), |number| format!("T{number}"));
            self.findings.add_in_program(&TOOL_NOT_CHANGED, backtrace, selected, 1, |kind| {
                let message = format!("T{selected} is selected, but {spindle} is in the spindle and {verb}");
                Diagnostic::new(kind, message).help(format!("command T{selected} M06 before the cut"))
            });
        }
        is_meant
    }

    /// Reports the clamp, the tool and its spindle in a feed along it, and records the cutting conditions.
    fn report_conditions(&mut self, line: &CuttingLine) {
        let backtrace = line.backtrace();
        if line.cuts.is_empty() {
            self.check_clamped(backtrace, line.cutting_state.clamp);
            self.check_tool_changed(backtrace, &line.cutting_state, "cuts");
        }
        for (cut, is_last) in line.cuts.iter() {
            // The deepest feed shows the place of most.
            let place = if is_last { backtrace } else { &cut.backtrace };
            if let Some(extremes) = cut.extremes {
                self.milling.record_cut(&cut.state);
                self.cut_conditions.add(RecordedCut {
                    backtrace: place,
                    state: &cut.state,
                    is_tapping: line.is_tapping,
                    feeds: (cut.feed_range, extremes),
                    pecks: if is_last { line.pecks() } else { PeckExtent::default() },
                    offset_origin: cut.offset_origin.as_ref(),
                });
            }
            self.check_clamped(place, cut.state.clamp);
            self.check_tool_changed(place, &cut.state, "cuts");
            if cut.is_stopped() {
                self.report_spindle_stopped(place, &cut.state);
            }
        }
        self.check_spindle(backtrace, line);
    }

    /// Reports the conditions, the head and the direction of a feed.
    fn report_feed(&mut self, line: &CuttingLine, tilt: Option<Deg>) {
        self.report_conditions(line);
        let backtrace = line.backtrace();
        let Some(tilt) = tilt else {
            if matches!(self.machine.head.kind, HeadKind::Manual { .. }) {
                self.findings.add(&HEAD_NOT_SET, backtrace, 0, |kind| {
                    Diagnostic::new(kind, "the tool feeds before the head is set: its angle is unknown").help(
                        "stop with #3006=1(SET HEAD TO #140) before the feed, or give head.angle in the machine file",
                    )
                });
            }
            return;
        };
        let length = line.cut_depth();
        let rounding = Deg::atan2(2.0 * self.machine.increment.size(), length);
        if tilt.0 > (MAX_FEED_TILT + rounding).0 {
            self.findings.add(&FEED_NOT_ALONG_TOOL, backtrace, 0, |kind| {
                let message = format!(
                    "the feed direction is {:.3}° off the tool axis, limit {:.2}°: {:.3} mm \
                     sideways over {length:.3} mm",
                    tilt.0,
                    MAX_FEED_TILT.0,
                    tilt.sin() * length
                );
                Diagnostic::new(kind, message)
                    .help("set the head to the direction of the feed, or feed along the tool axis")
            });
        }
    }
}
