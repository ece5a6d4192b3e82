//! Feeds of a tool whose length differs from its length offset: the tip is off the programmed point.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::line::CuttingLine;
use gcode_lang::motion::{Backtrace, LengthCompensation};

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
    /// Tool length minus offset: distance of the tip beyond the programmed point, along the tool into the part, mm.
    pub length_excess: f64,
    /// End points of feeds, with the direction of the tool out of the part.
    pub feed_ends: Vec<(Point3<f64>, Unit<Vector3<f64>>)>,
}

impl HoleExtractor<'_> {
    /// Applies a change of the source of the length offset.
    pub(super) fn apply_compensation(&mut self, compensation: LengthCompensation) {
        self.cutting_state.compensation = compensation;
        if compensation.number().is_some() {
            self.offset_tools.insert(self.setup.tool);
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
        let kept = &mut self.length_mismatches;
        let index = kept.iter().position(is_same).unwrap_or(kept.len());
        if index == MAX_KEPT {
            return;
        }
        if index == kept.len() {
            let (backtrace, feed_ends) = (line.backtrace().clone(), Vec::new());
            kept.push(LengthMismatch { backtrace, tool, compensation, length_excess, feed_ends });
        }
        let ends = &mut kept[index].feed_ends;
        if ends.len() < MAX_KEPT {
            ends.push(end);
        }
    }
}
