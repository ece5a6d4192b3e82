//! Feeds of a tool whose length isn't the one that the control reckons with: how far its tip is beyond the programmed point.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::line::CuttingLine;
use gcode_lang::motion::{Backtrace, LengthCompensation};

/// Less than this isn't told, mm.
const MIN_EXCESS: f64 = 0.001;

/// So many feeds of each are kept, and so many kinds: one wrong offset does the same to all.
const MAX_KEPT: usize = 64;

/// Feeds with one length offset.
#[derive(Clone, Debug)]
pub struct LengthMismatch {
    /// Of the first feed.
    pub backtrace: Backtrace,
    pub tool: u32,
    pub compensation: LengthCompensation,
    /// How far the tip is beyond the programmed point, along the tool into the part, mm: the tool's length less the offset.
    pub length_excess: f64,
    /// Where feeds end, with the tool's direction out of the part.
    pub feed_ends: Vec<(Point3<f64>, Unit<Vector3<f64>>)>,
}

/// One for each tool and offset, in the order in which they came up.
#[derive(Debug, Default)]
pub(super) struct LengthMismatches(Vec<LengthMismatch>);

impl LengthMismatches {
    fn add(&mut self, mismatch: LengthMismatch) {
        let is_same = |known: &LengthMismatch| {
            (known.tool, known.compensation) == (mismatch.tool, mismatch.compensation)
                && (known.length_excess - mismatch.length_excess).abs() < MIN_EXCESS
        };
        match self.0.iter().position(is_same) {
            Some(known) => {
                let ends = &mut self.0[known].feed_ends;
                let room = MAX_KEPT - ends.len();
                ends.extend(mismatch.feed_ends.into_iter().take(room));
            }
            None if self.0.len() < MAX_KEPT => self.0.push(mismatch),
            None => {}
        }
    }

    pub(super) fn finish(self) -> Vec<LengthMismatch> {
        self.0
    }
}

impl HoleExtractor<'_> {
    /// The length of the tool less the offset that stands for it, where both are along the tool.
    pub(super) fn length_excess(&self) -> Option<f64> {
        let length = self.machine.length_of(self.setup.tool)?;
        let axis = self.machine.head.direction(&self.axis_position, &self.setup)?;
        let offset = self.machine.slides.displacement(&self.setup.offset);
        let along = offset.dot(&axis);
        let beyond = length - along;
        ((offset - axis.into_inner() * along).norm() < MIN_EXCESS && MIN_EXCESS <= beyond.abs())
            .then_some(beyond)
    }

    pub(super) fn record_length_mismatch(&mut self, line: &CuttingLine) {
        let (Some(beyond), Some(axis), Some(tool)) =
            (line.length_excess, line.tool_axis, line.cutting_state.tool)
        else {
            return;
        };
        let ends = vec![(line.bottom(), axis)];
        self.length_mismatches.add(LengthMismatch {
            backtrace: line.backtrace().clone(),
            tool,
            compensation: line.cutting_state.compensation,
            length_excess: beyond,
            feed_ends: ends,
        });
    }
}
