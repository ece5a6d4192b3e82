//! Body of a tool: cylinders about its axis, from the cutting edges to the holder.
use super::{Machine, Setup, Tool};
use gcode_lang::units::Deg;

/// Full angle of the point of a drill.
const POINT_ANGLE: Deg = Deg(118.0);

/// A cylinder about the tool's axis; heights from the tip, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ToolCylinder {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Radius, mm.
    pub radius: f64,
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
        let point = point_length(diameter);
        let cylinder = |from: f64, to: f64, diameter: f64| ToolCylinder { from, to, radius: diameter / 2.0 };
        let shank = tool.shank_diameter.zip(tool.flute_length);
        let end_of_flutes = shank.map_or(length, |(_, flutes)| flutes.min(length)).max(point);
        let mut body = vec![cylinder(point, end_of_flutes, diameter)];
        body.extend(shank.map(|(shank, _)| cylinder(end_of_flutes, length, shank)));
        body.extend(holder(tool).map(|(holder, height)| cylinder(length - height, length, holder)));
        body.retain(|part| part.from <= part.to);
        body
    }
}

/// Returns the length of a drill's point below the full diameter.
fn point_length(diameter: f64) -> f64 {
    diameter / 2.0 / Deg(POINT_ANGLE.0 / 2.0).tan()
}

/// Returns diameter and length of the holder.
fn holder(tool: &Tool) -> Option<(f64, f64)> {
    tool.holder_diameter.zip(tool.holder_length)
}
