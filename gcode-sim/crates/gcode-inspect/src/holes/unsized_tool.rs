//! Tools of unknown diameter on the axis of a nominal hole: each is as wide as the feature that ends where its stroke does.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::feed_law::{FIT, ON_AXIS};
use super::line::CuttingLine;
use super::swept_tool::rim;
use crate::findings::RAPID_INTO_PART;
use gcode_lang::diag::Diagnostic;
use gcode_part::Collar;

/// Depth in a hole from which on the start of a feed is inside it, mm.
const MIN_START_DEPTH: f64 = 0.1;

impl HoleExtractor<'_> {
    /// Returns the largest radius that a tool of unknown diameter may have in a stroke on the axis of a nominal hole: that of the
    /// feature that ends there; `None` for a travel beside all holes.
    pub(super) fn radius_of_stroke(
        &self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
    ) -> Option<f64> {
        let mut widest: Option<f64> = None;
        self.metal.around(travel, &mut |collar: &Collar| {
            let aside = travel.iter().map(|p| collar.from_axis(p)).fold(0.0, f64::max);
            if collar.is_parallel(axis) && aside <= ON_AXIS {
                let depth = travel.iter().map(|p| collar.depth(p)).fold(0.0, f64::max);
                widest = Some(widest.unwrap_or(0.0).max(collar.radius_of_stroke(depth) - aside));
            }
        });
        widest
    }

    /// Returns the radius of a stroke if that of its tool is unknown, mm.
    pub(super) fn radius_of_unsized(
        &self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
    ) -> Option<f64> {
        if self.tool_radius().is_some() { None } else { self.radius_of_stroke(travel, axis) }
    }

    /// Reports a tool of unknown diameter that begins its feed inside a hole which it widens: it has come down through the metal
    /// that it is there to cut.
    pub(super) fn check_start_of_unsized(&mut self, line: &CuttingLine) {
        if !line.is_inward() || self.tool_radius().is_some() {
            return;
        }
        let axis = line.tool_axis.unwrap_or(line.out);
        let (start, tip) = (line.start, self.pose.tip);
        let mut begun = None;
        self.metal.around(&[start, tip], &mut |collar| {
            let (depth, radius) = (collar.depth(&start), collar.widened_at(collar.depth(&tip)));
            let is_on_axis = collar.is_parallel(&axis) && collar.from_axis(&tip) <= ON_AXIS;
            if let Some(radius) = radius.filter(|_| is_on_axis && MIN_START_DEPTH < depth) {
                begun = Some((depth, radius));
            }
        });
        let Some((depth, radius)) = begun else { return };
        let above = start + axis.into_inner() * depth;
        let rim = rim(&axis, &Vector3::zeros(), radius - FIT);
        if !rim.into_iter().any(|offset| self.metal.cuts(&(start + offset), &(above + offset)) == Some(true))
        {
            return;
        }
        self.findings.add(&RAPID_INTO_PART, line.backtrace(), 0, |kind| {
            let name = line.cutting_state.tool.map_or("the tool".to_owned(), |number| format!("T{number}"));
            let message = format!(
                "{name} begins its feed {depth:.3} mm deep in the hole that it widens to Φ{:.3}: it comes down in rapid through \
                 the metal that it cuts",
                2.0 * radius
            );
            Diagnostic::new(kind, message).help("begin the feed above the hole: check R or Z of the approach")
        });
    }
}
