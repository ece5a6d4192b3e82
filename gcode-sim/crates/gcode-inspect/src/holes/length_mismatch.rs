//! Feeds of a tool whose length isn't the one that the control reckons with: how far its tip is beyond the programmed point.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::line::CuttingLine;
use gcode_lang::motion::{Backtrace, LengthCompensation};

/// Less than this isn't told, mm.
const LEAST: f64 = 0.001;

/// So many feeds of each are kept, and so many kinds: one wrong offset does the same to all.
const KEPT: usize = 64;

/// Feeds with one length offset.
#[derive(Clone, Debug)]
pub struct LengthMismatch {
    /// Of the first feed.
    pub place: Backtrace,
    pub tool: u32,
    pub by: LengthCompensation,
    /// How far the tip is beyond the programmed point, along the tool into the part, mm: the tool's length less the offset.
    pub beyond: f64,
    /// Where feeds end, with the tool's direction out of the part.
    pub ends: Vec<(Point3<f64>, Unit<Vector3<f64>>)>,
}

/// One for each tool and offset, in the order in which they came up.
#[derive(Debug, Default)]
pub(super) struct LengthMismatches(Vec<LengthMismatch>);

impl LengthMismatches {
    fn add(&mut self, reach: LengthMismatch) {
        let is_same = |known: &LengthMismatch| {
            (known.tool, known.by) == (reach.tool, reach.by) && (known.beyond - reach.beyond).abs() < LEAST
        };
        match self.0.iter().position(is_same) {
            Some(known) => {
                let ends = &mut self.0[known].ends;
                let room = KEPT - ends.len();
                ends.extend(reach.ends.into_iter().take(room));
            }
            None if self.0.len() < KEPT => self.0.push(reach),
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
        let axis = self.machine.head.direction(&self.at, &self.setup)?;
        let offset = self.machine.slides.displacement(&self.setup.offset);
        let along = offset.dot(&axis);
        let beyond = length - along;
        ((offset - axis.into_inner() * along).norm() < LEAST && LEAST <= beyond.abs()).then_some(beyond)
    }

    pub(super) fn note_reach(&mut self, line: &CuttingLine) {
        let (Some(beyond), Some(axis), Some(tool)) = (line.length_excess, line.tool_axis, line.force.tool)
        else {
            return;
        };
        let ends = vec![(line.bottom(), axis)];
        self.reaches.add(LengthMismatch {
            place: line.place().clone(),
            tool,
            by: line.force.by,
            beyond,
            ends,
        });
    }
}
