//! Body of a tool: cylinders about its axis, from the cutting edges to the holder.
use nalgebra::{Point3, Unit, Vector3};

use super::{Machine, PointShape, Setup, Tool, ToolKind};
use gcode_part::{Rod, Surface};

/// Largest depth below the surface that is not reported, mm.
pub(crate) const TOUCH_DEPTH: f64 = 0.01;

/// Number of steps in the cone of a point, that of the full diameter included.
const POINT_STEPS: u8 = 4;

/// A cylinder about the tool's axis; heights from the tip, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ToolCylinder {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Radius, mm.
    pub radius: f64,
    /// True for the point and the flutes, false for the shank and the holder.
    pub is_cutter: bool,
}

impl ToolCylinder {
    /// Returns true if this part cuts the body while the tip moves from `tip` by `along`. Cuts of up to
    /// [`TOUCH_DEPTH`] don't count.
    pub(crate) fn cuts(
        &self,
        body: &Surface,
        (tip, axis): (&Point3<f64>, &Unit<Vector3<f64>>),
        along: &Vector3<f64>,
    ) -> bool {
        let length = (self.to - self.from - TOUCH_DEPTH).max(0.0);
        let base = tip + axis.into_inner() * (self.from + TOUCH_DEPTH);
        let radius = self.radius - TOUCH_DEPTH;
        0.0 < radius && body.touches(&Rod { base, axis: *axis, length, radius }, along)
    }
}

impl Machine {
    /// Returns the cylinders of the tool in the spindle; empty if the tool table lacks it or its diameter.
    ///
    /// The length is that of the tool table, or else that of the length offset. If neither is known, the full diameter
    /// counts at the upper end of the point alone.
    pub(crate) fn tool_body(&self, setup: &Setup) -> Vec<ToolCylinder> {
        let Some(tool) = setup.tool.and_then(|number| self.find_tool(number)) else { return Vec::new() };
        let Some(diameter) = tool.diameter else { return Vec::new() };
        let length = self.tool_length(setup);
        let point = tool.point_length(diameter);
        let cylinder = |from: f64, to: f64, diameter: f64| ToolCylinder {
            from,
            to,
            radius: diameter / 2.0,
            is_cutter: false,
        };
        // Where the length is unknown or shorter, shank and holder are nowhere.
        let shank = tool.shank_diameter.zip(tool.flute_length).filter(|(_, flutes)| *flutes < length);
        let end_of_flutes = shank.map_or(length, |(_, flutes)| flutes).max(point);
        // The full diameter comes first: it is the part that cuts most.
        let mut body = vec![ToolCylinder { is_cutter: true, ..cylinder(point, end_of_flutes, diameter) }];
        body.extend(steps_of_point(point, diameter));
        body.extend(shank.map(|(shank, _)| cylinder(end_of_flutes, length, shank)));
        let holder = holder(tool).filter(|(_, height)| *height <= length);
        body.extend(holder.map(|(holder, height)| cylinder(length - height, length, holder)));
        body.retain(|part| part.from <= part.to);
        body
    }

    /// Returns the cylinders of a tool's end: its point, and the full diameter at the upper end of it. Empty if the tool
    /// table lacks the tool or its diameter.
    pub(crate) fn tool_end(&self, tool: Option<u32>) -> Vec<ToolCylinder> {
        let Some(tool) = tool.and_then(|number| self.find_tool(number)) else { return Vec::new() };
        let Some(diameter) = tool.diameter else { return Vec::new() };
        let point = tool.point_length(diameter);
        let full = ToolCylinder { from: point, to: point, radius: diameter / 2.0, is_cutter: true };
        std::iter::once(full).chain(steps_of_point(point, diameter)).collect()
    }
}

impl Tool {
    /// Returns the length of the point below the full diameter, mm. A drill without an angle has 118°, a tool of unknown
    /// kind a flat end.
    fn point_length(&self, diameter: f64) -> f64 {
        let point = match (self.point(), self.kind) {
            (PointShape::Unknown, Some(ToolKind::Drill)) => PointShape::DRILL,
            (point, _) => point,
        };
        point.length(diameter).unwrap_or(0.0)
    }
}

/// Returns cylinders that lie inside the cone of a point: each has the radius of the cone at its lower end.
fn steps_of_point(length: f64, diameter: f64) -> impl Iterator<Item = ToolCylinder> {
    let steps = if 0.0 < length { POINT_STEPS } else { 0 };
    let share = |step: u8| f64::from(step) / f64::from(POINT_STEPS);
    (1..steps).rev().map(move |step| ToolCylinder {
        from: length * share(step),
        to: length * share(step + 1),
        radius: diameter / 2.0 * share(step),
        is_cutter: true,
    })
}

/// Returns diameter and length of the holder.
fn holder(tool: &Tool) -> Option<(f64, f64)> {
    tool.holder_diameter.zip(tool.holder_length)
}
