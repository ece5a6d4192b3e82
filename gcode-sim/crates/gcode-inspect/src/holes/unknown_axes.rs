//! Axes whose position on the part is unknown: not commanded since the start, sent to machine coordinates without a known
//! work offset, or counted from a G92 at an unknown position.
use nalgebra::{Point3, Vector3};

use super::group::DrilledHole;
use super::line::{CuttingLine, ToolExit};
use super::{CONTACT_CLEARANCE, HoleExtractor, MotionKind};
use crate::findings::START_UNKNOWN;
use crate::machine::{AxisMotion, Machine, TOUCH_DEPTH};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Axes, AxisIndex, Backtrace, Event, Position, UnknownAxes};
use gcode_part::Surface;

/// Sine of the largest angle at which an axis moves along a hole.
pub(super) const MAX_SINE: f64 = 1e-3;

/// Detail of the finding about a rapid; above those of holes, which are axes as bits.
const RAPID_DETAIL: u32 = 1 << 8;

/// Detail of the finding about a rapid below the top of the part.
const LOW_RAPID_DETAIL: u32 = 1 << 9;

/// Step between the angles at which a part of unknown angle is compared, degrees.
const ANGLE_STEP: u32 = 5;

/// Largest displacement of a hole by an axis that has no effect on it, mm.
const MAX_DISPLACEMENT: f64 = 1e-6;

/// Rapids from or to positions that are unknown on the part.
#[derive(Clone, Debug)]
pub(crate) struct UnknownRapids {
    /// Block of the first rapid.
    pub backtrace: Backtrace,
    /// Letters of the axes of all of them, as in `X and Z`.
    pub letters: String,
    /// Number of rapids.
    pub count: u64,
}

/// Axes of unknown position now and after the next move.
#[derive(Clone, Debug, Default)]
pub(crate) struct PositionTracker {
    /// True after the first event, which states the axes at the start.
    has_started: bool,
    current: UnknownAxes,
    upcoming: UnknownAxes,
    /// Axes at known machine positions before and after the last move, as bits.
    at_machine: [u8; 2],
    /// First rapid, axes of all rapids, and their number.
    rapids: Option<(Backtrace, u8, u64)>,
}

impl PositionTracker {
    /// Applies the event before a move: the axes of unknown position at its end.
    pub(crate) fn apply_event(&mut self, machine: &Machine, axes: UnknownAxes) {
        let axes = axes.only(machine.used_axes());
        // A move without travel has no event of its own.
        self.current = if self.has_started { self.upcoming } else { axes };
        self.upcoming = axes;
        self.has_started = true;
    }

    /// Returns the axes of unknown position before and after a move. A rotary of the default machine counts as known while
    /// nothing commands it.
    pub(crate) fn advance(&mut self, machine: &Machine) -> (UnknownAxes, UnknownAxes) {
        let was = std::mem::replace(&mut self.current, self.upcoming);
        self.at_machine = [was, self.current].map(|axes| axes.at_known_machine_position);
        let counted = |axes| UnknownAxes { at_known_machine_position: 0, ..without_assumed(axes, machine) };
        (counted(was), counted(self.current))
    }

    /// Returns the axes at known machine positions before and after the last move, as bits.
    pub(super) fn at_machine(&self) -> [u8; 2] {
        self.at_machine
    }

    /// Counts a rapid from or to an unknown position; one whose axes are merely not commanded yet is not counted.
    pub(crate) fn note_rapid(&mut self, event: &Event<'_>, axes: UnknownAxes) {
        let axes = axes.at_machine_position | axes.shifted;
        if axes == 0 {
            return;
        }
        let (_, all, count) = self.rapids.get_or_insert_with(|| (event.backtrace(), 0, 0));
        *all |= axes;
        *count += 1;
    }

    pub(crate) fn finish(self, machine: &Machine) -> Option<UnknownRapids> {
        let (backtrace, axes, count) = self.rapids?;
        Some(UnknownRapids { backtrace, letters: machine.axes.names(axes), count })
    }

    /// Returns the axes of unknown position now.
    pub(crate) fn unknown_axes(&self) -> UnknownAxes {
        self.current
    }

    /// Returns true if every position is known, that of an assumed rotary included.
    pub(crate) fn is_known(&self, machine: &Machine) -> bool {
        without_assumed(self.current, machine).is_none()
    }

    /// Returns the rotary axes of the default machine that no block of the run has commanded, as bits.
    pub(crate) fn untouched_rotary_axes(&self, machine: &Machine) -> u8 {
        self.upcoming.uncommanded & machine.assumed_rotary_axes()
    }
}

/// Returns the unknown axes without the uncommanded rotaries of the default machine.
pub(crate) fn without_assumed(axes: UnknownAxes, machine: &Machine) -> UnknownAxes {
    UnknownAxes { uncommanded: axes.uncommanded & !machine.assumed_rotary_axes(), ..axes }
}

impl UnknownRapids {
    /// Returns what is not checked, and the reason; `first` is the program and the line of the first rapid.
    pub(crate) fn describe(&self, first: (String, u32)) -> (String, &'static str) {
        let (program, line) = first;
        let moves = match self.count {
            1 => format!("1 move, {program} line {line}"),
            count => format!("{count} moves, first {program} line {line}"),
        };
        let what = format!(
            "the clearance of rapids from and to the positions where G28, G30 or G53 sends {} ({moves})",
            self.letters
        );
        let reason = "the machine file lacks the work offset in effect ([offsets]), so the position of machine zero on \
                      the part is unknown";
        (what, reason)
    }
}

impl HoleExtractor<'_> {
    /// Follows a rapid from or to an unknown position, and checks its end if that is known. `from` is the computed start;
    /// `was` and `is` are the unknown axes before and after.
    pub(super) fn report_unknown_rapid(
        &mut self,
        event: &Event<'_>,
        kind: MotionKind,
        travel: &AxisMotion<'_>,
        from: &Point3<f64>,
        (was, is): (UnknownAxes, UnknownAxes),
    ) {
        // With the same axes unknown the motion itself is known.
        if was == is && self.machine.is_straight(travel) {
            if (self.pose.tip - from).norm() >= 1e-9 {
                self.update_line(event, kind, *from);
            }
        } else if let Some(line) = self.current_line.take() {
            let is_out = self.is_out_along(&line, is.all() & !was.all());
            let exit = if is_out { ToolExit::AlongLine } else { line.curved_exit() };
            self.report_line(line, exit, Some(kind));
        }
        self.positions.note_rapid(event, was.union(is));
        let to = self.pose.tip;
        // The angle about the axis of a round part does not matter.
        let round = self.axis_about_part().map_or(0, |axis| 1 << axis);
        if kind == MotionKind::Rapid && is.without(round).is_none() {
            self.check_known_end(event, &to);
        } else if let Some(surface) = self.surface
            && is.at_machine_position | is.shifted == 0
            && !self.has_left_start
        {
            self.check_first_rapid(event, &surface, from, &to);
        }
        if kind == MotionKind::Rapid {
            self.report_rapid_at_unknown_level(event, travel, (was, is));
            self.report_rapid_below_top(event, is);
            self.report_rapid_to_surface(event, (was, is));
        }
        self.update_start();
    }

    /// Reports a rapid across an axis that was known in a cut and is where the start of the run left it, as after G98.
    fn report_rapid_at_unknown_level(
        &mut self,
        event: &Event<'_>,
        travel: &AxisMotion<'_>,
        (was, is): (UnknownAxes, UnknownAxes),
    ) {
        // G28, G30 and G53 lead away from the part.
        let axes = was.uncommanded & self.cut_axes & !is.at_machine_position;
        let is_across = |axis: AxisIndex| {
            let mut to = *travel.to;
            to[axis] = travel.from[axis];
            let rest = self.machine.forward(&to, &self.setup).tip
                - self.machine.forward(travel.from, &self.setup).tip;
            MAX_DISPLACEMENT < rest.norm()
        };
        let crossed = self.machine.axes.iter().map(|(axis, _)| axis);
        let crossed = crossed.filter(|axis| axes >> axis & 1 == 1 && !self.machine.axes.is_rotary(*axis));
        let crossed = crossed.filter(|axis| is_across(*axis)).fold(0, |mask, axis| mask | 1_u8 << axis);
        if crossed == 0 {
            return;
        }
        let letters = self.machine.axes.names(crossed);
        self.findings.add_in_program(&START_UNKNOWN, &event.backtrace(), RAPID_DETAIL, 1, |kind| {
            let message = format!(
                "a rapid leads across after a hole with {letters} at an unknown position: no earlier block commands \
                 {letters} in G90"
            );
            Diagnostic::new(kind, message)
                .note("G98 returns to the level at which the cycle began")
                .help(format!("command {letters} in G90 before the first hole"))
        });
    }

    /// Reports a rapid that ends below the top of the body while nothing has commanded the axes across the tool: it may be in
    /// the part.
    fn report_rapid_below_top(&mut self, event: &Event<'_>, is: UnknownAxes) {
        let axes = without_assumed(is, self.machine);
        let Some(surface) = self.surface else { return };
        if axes.uncommanded == 0 || axes.at_machine_position | axes.shifted != 0 {
            return;
        }
        let positions = self.angles_of(axes.uncommanded);
        let mut depths = positions.map(|at| self.depth_below_top(&surface, &at, axes.uncommanded));
        let is_placed = (0..self.machine.axes.len())
            .all(|axis| axes.uncommanded >> axis & 1 == 0 || self.machine.axes.is_rotary(axis));
        let below = match is_placed {
            // It is in the part at every angle: the first that is clear decides.
            true => depths.try_fold(f64::INFINITY, |least, depth| {
                depth.filter(|depth| -CONTACT_CLEARANCE < *depth).map(|depth| least.min(depth))
            }),
            // It may be anywhere over the part, at any angle.
            false => depths.flatten().reduce(f64::max),
        };
        let Some(below) = below.filter(|below| -CONTACT_CLEARANCE < *below) else { return };
        let letters = self.machine.axes.names(axes.uncommanded);
        self.findings.add_in_program(&START_UNKNOWN, &event.backtrace(), LOW_RAPID_DETAIL, 1, |kind| {
            let place = place_below_top(below);
            let message = format!(
                "a rapid ends {place} with {letters} at an unknown position: it may be over the part"
            );
            Diagnostic::new(kind, message)
                .help(format!("command {letters} in G90 before it, or end it above the part"))
        });
    }

    /// Returns the position of the axes, with rotaries of unknown position that carry the part at each of their angles.
    fn angles_of(&self, unknown: u8) -> impl Iterator<Item = Position> + use<> {
        let is_unknown = |axis: &AxisIndex| {
            let is_rotary = self.machine.axes.is_rotary(*axis) && self.machine.table.has_axis(*axis);
            unknown >> axis & 1 == 1 && is_rotary
        };
        let axes: Vec<AxisIndex> = (0..self.machine.axes.len()).filter(is_unknown).collect();
        let (at, steps) = (self.axis_position, (360 / ANGLE_STEP) as usize);
        (0..steps.pow(axes.len() as u32)).map(move |mut place| {
            let mut beside = at;
            for axis in &axes {
                beside[*axis] = ((place % steps) as u32 * ANGLE_STEP).into();
                place /= steps;
            }
            beside
        })
    }

    /// Returns the displacement of the tip on the part by 1 mm or 1 degree of an axis, mm; with the axes at `at` the tip is at `tip`.
    pub(super) fn displacement_by(&self, axis: AxisIndex, at: &Position, tip: &Point3<f64>) -> Vector3<f64> {
        let mut beside = *at;
        beside[axis] += 1.0;
        self.machine.forward(&beside, &self.setup).tip - tip
    }

    /// Returns the distance of the tip below the top of the body, seen along the tool, with the axes at a position; `None` if it is
    /// beside the body, or if its height is unknown. Linear axes in `unknown` may be anywhere; without any it is the depth.
    pub(super) fn depth_below_top(&self, surface: &Surface, at: &Position, unknown: u8) -> Option<f64> {
        let pose = self.machine.forward(at, &self.setup);
        let (tip, out) = (pose.tip, pose.axis.or_else(|| self.tool_direction())?);
        let mut open = Vec::new();
        for (axis, _) in self.machine.axes.iter().filter(|(axis, _)| unknown >> axis & 1 == 1) {
            if self.machine.axes.is_rotary(axis) {
                continue;
            }
            let by = self.displacement_by(axis, at, &tip);
            if MAX_SINE < by.dot(&out).abs() {
                return None;
            }
            open.push(by);
        }
        if open.is_empty() {
            return Some(surface.depth(&tip));
        }
        let reach = self.body_radius();
        let [low, high] = surface.bounds();
        let is_over = (0..3).all(|i| {
            let is_open = open.iter().any(|by| MAX_SINE < by[i].abs());
            let margin = reach * (1.0 - out[i] * out[i]).max(0.0).sqrt();
            let is_along = 1.0 - MAX_SINE < out[i].abs();
            is_open || is_along || (low[i] - margin..=high[i] + margin).contains(&tip[i])
        });
        let top: f64 = (0..3).map(|i| (out[i] * low[i]).max(out[i] * high[i])).sum();
        is_over.then(|| top - tip.coords.dot(&out))
    }

    /// Reports a rapid to the surface of the body, or into an opening below its top, from a place across the tool that nothing has
    /// commanded: it may lead through the body.
    fn report_rapid_to_surface(&mut self, event: &Event<'_>, (was, is): (UnknownAxes, UnknownAxes)) {
        let Some((surface, out)) = self.surface.zip(self.tool_direction()) else { return };
        let tip = self.pose.tip;
        let depth = surface.depth(&tip);
        let is_inside = TOUCH_DEPTH < depth;
        // In the metal it has a finding of its own.
        if !is.is_none()
            || depth <= -CONTACT_CLEARANCE
            || is_inside && self.metal.uncut(&[tip, tip]).is_some()
        {
            return;
        }
        // Along the tool the way from any place is the one that is checked.
        let is_across = |axis: &AxisIndex| {
            let by = self.displacement_by(*axis, &self.axis_position, &tip);
            !self.machine.axes.is_rotary(*axis) && MAX_SINE < by.cross(&out).norm()
        };
        let opened = (0..self.machine.axes.len()).filter(|axis| was.uncommanded >> axis & 1 == 1);
        let axes = opened.filter(is_across).fold(0, |axes, axis| axes | 1 << axis);
        if axes == 0 {
            return;
        }
        let letters = self.machine.axes.names(axes);
        self.findings.add_in_program(&START_UNKNOWN, &event.backtrace(), LOW_RAPID_DETAIL, 1, |kind| {
            let place = if is_inside { "below the top" } else { "to the surface" };
            let message = format!(
                "a rapid leads {place} of the part from an unknown position of {letters}: the part may be in its way"
            );
            Diagnostic::new(kind, message).help(format!("command {letters} in G90 above the part before it"))
        });
    }

    /// Applies a known start, or a known end of a motion.
    pub(super) fn update_start(&mut self) {
        self.has_left_start |= self.positions.is_known(self.machine);
    }

    /// Applies a known position outside the part before the first motion.
    pub(super) fn update_outside(&mut self) {
        let is_outside = self.surface.is_some_and(|surface| surface.value(&self.pose.tip) > 0.0);
        self.has_left_start |= is_outside && self.positions.is_known(self.machine);
    }

    /// Returns true if all these axes move the tool along the line: out of the hole, since machine zero is outside the
    /// part.
    fn is_out_along(&self, line: &CuttingLine, axes: u8) -> bool {
        let is_along = |axis: AxisIndex| {
            let by = self.displacement_by(axis, &self.axis_position, &self.pose.tip);
            by.cross(&line.out).norm() <= MAX_SINE * by.norm()
        };
        self.machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1).all(|(axis, _)| is_along(axis))
    }
}

/// Returns the place of a tip at a depth below the top of the part, in words.
pub(super) fn place_below_top(depth: f64) -> String {
    match depth {
        _ if TOUCH_DEPTH < depth => format!("{depth:.3} mm below the top of the part"),
        _ => "on the top of the part".to_owned(),
    }
}

/// Removes the axes that don't matter from the unknown ones of each hole: a rotary on whose axis the hole lies, and
/// those in `assumed`.
pub(super) fn keep_effective(holes: &mut [DrilledHole], machine: &Machine, assumed: u8) {
    for hole in holes.iter_mut().filter(|hole| !hole.unknown_axes.is_none()) {
        let axes = hole.unknown_axes.all();
        let effective = machine.axes.iter().filter(|(axis, _)| axes >> axis & 1 == 1);
        let effective =
            effective.filter(|(axis, _)| assumed >> axis & 1 == 0 && has_effect(machine, hole, *axis));
        hole.unknown_axes = hole.unknown_axes.only(effective.fold(0, |mask, (axis, _)| mask | 1 << axis));
    }
}

/// Returns true if an axis displaces the hole on the part.
fn has_effect(machine: &Machine, hole: &DrilledHole, axis: AxisIndex) -> bool {
    if !machine.table.has_axis(axis) {
        return true;
    }
    let mut beside = hole.axis_position;
    beside[axis] += 90.0;
    let by = machine.part_frame(&beside).inverse() * machine.part_frame(&hole.axis_position);
    [hole.entry, hole.bottom()].iter().any(|point| (by * point - point).norm() > MAX_DISPLACEMENT)
}

impl HoleExtractor<'_> {
    /// Reports holes that are cut with axes of unknown position, by their blocks.
    pub(super) fn report_unknown_positions(&mut self, holes: &[DrilledHole]) {
        for hole in holes.iter().filter(|hole| !hole.unknown_axes.is_none()) {
            let axes = hole.unknown_axes;
            self.findings.add(&START_UNKNOWN, &hole.backtrace, u32::from(axes.all()), |_| {
                unknown_position_finding(&self.machine.axes, axes, "a hole is cut")
            });
        }
    }
}

/// Returns the finding about a cut with axes of unknown position; `cut` is its subject and verb, as in `hole 1 is cut`.
pub(crate) fn unknown_position_finding(names: &Axes, axes: UnknownAxes, cut: &str) -> Diagnostic {
    let letters = |axes| names.names(axes);
    let UnknownAxes { uncommanded, at_machine_position, shifted, .. } = axes;
    if uncommanded != 0 {
        let letters = letters(uncommanded);
        let starts: Vec<_> = names
            .iter()
            .filter(|(axis, _)| uncommanded >> axis & 1 == 1)
            .map(|(_, letter)| format!("--start {letter}=…"))
            .collect();
        let message = format!(
            "{cut} with {letters} at an unknown position: no earlier block commands {letters} in G90"
        );
        return Diagnostic::new(&START_UNKNOWN, message).help(format!(
            "command {letters} in G90 in this block or before it, or state where the run starts: {}, or [start] \
             in the machine file",
            starts.join(" ")
        ));
    }
    if at_machine_position != 0 {
        let letters = letters(at_machine_position);
        let message = format!(
            "{cut} with {letters} where G28, G30 or G53 sent it: this position on the part is unknown"
        );
        return Diagnostic::new(&START_UNKNOWN, message)
            .note("the machine file lacks the work offset in effect; machine zero is taken as the work zero")
            .help(format!(
                "command {letters} in G90 before this block, or give the offset under [offsets] in the machine file"
            ));
    }
    let letters = letters(shifted);
    let message =
        format!("{cut} with {letters} counted from a zero that was set at an unknown position of {letters}");
    Diagnostic::new(&START_UNKNOWN, message)
        .note("G92 gives the current position new coordinates; G68 and G51 without a centre take it as their centre; G53.1 and G43.4 \
               depend on rotary axes that the machine file may lack")
        .help("command the axis in G90 before that block, or state where the run starts: --start, or [start] in the \
               machine file")
}
