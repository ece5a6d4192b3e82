//! Feeds of a tool whose length differs from its length offset: the tip is off the programmed point.
use nalgebra::{Point3, Unit, Vector3};

use super::line::CuttingLine;
use super::offset_origin::OffsetOrigin;
use super::unknown_axes::{MAX_SINE, place_below_top};
use super::{CONTACT_CLEARANCE, HoleExtractor};
use crate::findings::RAPID_INTO_PART;
use crate::machine::tool_name;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{AxisIndex, Backtrace, Event, LengthCompensation, Position};

/// Smallest reported difference, mm.
const MIN_EXCESS: f64 = 0.001;

/// Largest number of mismatches, and of feeds of each: one wrong offset has the same effect on all.
const MAX_KEPT: usize = 64;

/// Feeds of one tool with one length offset.
#[derive(Clone, Debug)]
pub(crate) struct LengthMismatch {
    /// Block of the first feed.
    pub backtrace: Backtrace,
    pub tool: u32,
    pub compensation: LengthCompensation,
    /// Block that puts the offset in force; `None` without an offset.
    pub offset_origin: Option<OffsetOrigin>,
    /// Tool length minus offset: distance of the tip beyond the programmed point, along the tool into the part, mm.
    pub length_excess: f64,
    /// End points of feeds, with the direction of the tool out of the part.
    pub feed_ends: Vec<(Point3<f64>, Unit<Vector3<f64>>)>,
}

impl HoleExtractor<'_> {
    /// Applies a change of the source of the length offset, or its repetition.
    pub(super) fn apply_compensation(&mut self, event: &Event<'_>, compensation: LengthCompensation) {
        self.cutting_state.compensation = compensation;
        self.length_change = Some(event.block);
        let is_on = compensation.number().is_some();
        let origin = || OffsetOrigin { backtrace: event.backtrace(), compensation, is_own: true };
        self.offset_origin = is_on.then(origin);
        if is_on {
            self.offset_tools.insert(self.setup.tool);
        }
    }

    /// Applies a tool change: an offset in force is left from the tool before.
    pub(super) fn leave_offset(&mut self) {
        if let Some(origin) = &mut self.offset_origin {
            origin.is_own = false;
        }
    }

    /// Returns the tool length minus the offset; `None` if the length is unknown, the offset is not along the tool, or
    /// they agree.
    pub(super) fn length_excess(&self) -> Option<f64> {
        let length = self.machine.length_of(self.setup.tool)?;
        let axis = self.machine.head.direction(&self.axis_position, &self.setup)?;
        let offset = self.machine.slides.displacement(&self.setup.offset);
        let along = offset.dot(&axis);
        let excess = length - along;
        let is_along_tool = (offset - axis.into_inner() * along).norm() < MIN_EXCESS;
        (is_along_tool && MIN_EXCESS <= excess.abs()).then_some(excess)
    }

    /// Reports a rapid to the top of the part, or below it, by a tool of unknown length that has lost its offset, as by G49: every
    /// tool reaches the part there.
    pub(super) fn check_lost_offset(&mut self, event: &Event<'_>) {
        let tool = self.setup.tool;
        let is_lost = self.cutting_state.compensation.number().is_none() && self.offset_tools.contains(&tool);
        if !is_lost || self.machine.has_tip(tool) {
            return;
        }
        let depth = match self.surface {
            Some(surface) => self.depth_below_top(&surface, &self.axis_position, 0),
            None => self.depth_at_entries(&self.pose.tip),
        };
        let Some(depth) = depth.filter(|depth| -CONTACT_CLEARANCE < *depth) else { return };
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let place = place_below_top(depth);
            let message = format!(
                "a rapid without a length offset ends {place}: {} goes into it by its length",
                tool_name(tool)
            );
            Diagnostic::new(kind, message).help("retract with G53 or G28 before G49, or keep G43 in force")
        });
    }

    /// Returns true if a rapid leads from or to a place where the tip is unknown: a tool without a known length and without an
    /// offset stands at machine coordinates, where length 0 would put it on the part. Tools touched off there have their
    /// length in H alone.
    pub(super) fn has_unknown_tip(&self, (from, before): (&Position, &Point3<f64>), to: &Position) -> bool {
        let [was, is] = self.positions.at_machine();
        if was | is == 0
            || self.cutting_state.compensation.number().is_some()
            || self.machine.has_tip(self.setup.tool)
        {
            return false;
        }
        let is_on_part = |axes: u8, at: &Position, tip: &Point3<f64>| {
            let depth = match self.surface {
                Some(surface) => self.depth_below_top(&surface, at, self.positions.unknown_axes().all()),
                None => self.depth_at_entries(tip),
            };
            axes & self.axes_along_tool(at) != 0 && depth.is_some_and(|depth| -CONTACT_CLEARANCE < depth)
        };
        is_on_part(was, from, before) || is_on_part(is, to, &self.pose.tip)
    }

    /// Returns the linear axes that move the tool along itself on the part, as bits.
    fn axes_along_tool(&self, at: &Position) -> u8 {
        let pose = self.machine.forward(at, &self.setup);
        let Some(out) = pose.axis else { return 0 };
        let is_along = |axis: &AxisIndex| {
            let by = self.displacement_by(*axis, at, &pose.tip);
            !self.machine.axes.is_rotary(*axis) && MAX_SINE < by.dot(&out).abs()
        };
        (0..self.machine.axes.len()).filter(is_along).fold(0, |axes, axis| axes | 1 << axis)
    }

    /// Returns the greatest depth of a tip below the entries of the holes at it, negative above them; `None` beside all holes.
    fn depth_at_entries(&self, tip: &Point3<f64>) -> Option<f64> {
        let holes = self.metal.holes.as_ref()?;
        let mut depth: Option<f64> = None;
        let margin = Vector3::repeat(CONTACT_CLEARANCE);
        holes.around(&(*tip - margin), &(*tip + margin), &mut |hole| {
            let collar = holes.collar(hole);
            if collar.from_axis(tip) <= collar.rod.radius {
                depth = Some(depth.map_or(collar.depth(tip), |most| most.max(collar.depth(tip))));
            }
        });
        depth
    }

    /// Records the feed of a line whose tool length differs; one entry per tool and offset, in order of occurrence.
    pub(super) fn record_length_mismatch(&mut self, line: &CuttingLine) {
        let (Some(length_excess), Some(axis), Some(tool)) =
            (line.length_excess, line.tool_axis, line.cutting_state.tool)
        else {
            return;
        };
        let (compensation, end) = (line.cutting_state.compensation, (line.bottom(), axis));
        let is_same = |known: &LengthMismatch| {
            (known.tool, known.compensation) == (tool, compensation)
                && (known.length_excess - length_excess).abs() < MIN_EXCESS
        };
        let offset_origin = self.offset_origin.as_ref().filter(|origin| origin.is_of(compensation)).cloned();
        let kept = &mut self.length_mismatches;
        let index = kept.iter().position(is_same).unwrap_or(kept.len());
        if index == MAX_KEPT {
            return;
        }
        if index == kept.len() {
            let (backtrace, feed_ends) = (line.backtrace().clone(), Vec::new());
            kept.push(LengthMismatch {
                backtrace,
                tool,
                compensation,
                offset_origin,
                length_excess,
                feed_ends,
            });
        }
        let ends = &mut kept[index].feed_ends;
        if ends.len() < MAX_KEPT {
            ends.push(end);
        }
    }
}
