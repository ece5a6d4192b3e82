//! Body of a tool: cylinders and cones about its axis, from the cutting edges to the holder.
use nalgebra::{Point3, Unit, Vector3};

use super::{Machine, PointShape, Setup, Tool, ToolKind};
use gcode_lang::units::Deg;
use gcode_part::{Frustum, Surface, Taper};

/// Cosine of 30°, beyond which a direction is another one.
pub(crate) const COS_30: f64 = 0.866_025_403_784_438_6;

/// Largest depth below the surface that is not reported, mm.
pub(crate) const TOUCH_DEPTH: f64 = 0.01;

/// A cylinder or a cone about the tool's axis; heights from the tip, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ToolPart {
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
    /// Radius by the height.
    pub taper: Taper,
    /// True for the point and the flutes, false for the shank and the holder.
    pub is_cutter: bool,
}

/// Least diameter of a spindle's nose, and the length of it that counts, mm.
const MIN_SPINDLE: f64 = 20.0;
const SPINDLE_LENGTH: f64 = 50.0;

impl ToolPart {
    /// Returns a cylinder that cuts.
    pub(crate) fn flutes(from: f64, to: f64, radius: f64) -> Self {
        Self { from, to, taper: Taper::cylinder(radius), is_cutter: true }
    }

    /// Returns the largest radius, mm.
    pub(crate) fn radius(&self) -> f64 {
        self.taper.at(self.from).max(self.taper.at(self.to))
    }

    /// Returns true if this part cuts the body while the tip moves from `tip` by `along`. Cuts of up to
    /// [`TOUCH_DEPTH`] don't count.
    pub(crate) fn cuts(
        &self,
        body: &Surface,
        (tip, axis): (&Point3<f64>, &Unit<Vector3<f64>>),
        along: &Vector3<f64>,
    ) -> bool {
        let inner = self.taper.grown(-TOUCH_DEPTH);
        // The tip of a cone is deeper inside.
        let apex = if inner.slope > 0.0 { -inner.radius / inner.slope } else { f64::NEG_INFINITY };
        let from = apex.max(self.from + TOUCH_DEPTH);
        let length = (self.to - from).max(0.0);
        let taper = Taper { radius: inner.at(from), ..inner };
        let base = tip + axis.into_inner() * from;
        0.0 < taper.at(length) && body.touches(&Frustum { base, axis: *axis, length, taper }, along)
    }
}

impl Machine {
    /// Returns the parts of the tool in the spindle; empty if the tool table lacks it or its diameter.
    ///
    /// The length is that of the tool table, or else that of the length offset. If neither is known, the full diameter
    /// counts at the upper end of the point alone. An unknown end is a cone of this full angle, if there is one.
    pub(crate) fn tool_body(&self, setup: &Setup, unknown_end: Option<Deg>) -> Vec<ToolPart> {
        let Some(tool) = setup.tool.and_then(|number| self.find_tool(number)) else { return Vec::new() };
        let Some(diameter) = tool.diameter else { return Vec::new() };
        let length = self.tool_length(setup);
        let assumed = unknown_end.map(PointShape::Pointed).filter(|_| tool.point() == PointShape::Unknown);
        let assumed = assumed.and_then(|point| point.length(diameter));
        let point = assumed.unwrap_or_else(|| tool.point_length(diameter));
        let behind = |from: f64, to: f64, diameter: f64| ToolPart {
            is_cutter: false,
            ..ToolPart::flutes(from, to, diameter / 2.0)
        };
        // Where the length is unknown or shorter, shank and holder are nowhere.
        let shank = tool.shank_diameter.zip(tool.flute_length).filter(|(_, flutes)| *flutes < length);
        let end_of_flutes = shank.map_or(length, |(_, flutes)| flutes).max(point);
        // The full diameter comes first: it is the part that cuts most.
        let mut body = vec![ToolPart::flutes(point, end_of_flutes, diameter / 2.0)];
        body.extend(cone(point, diameter));
        body.extend(shank.map(|(shank, _)| behind(end_of_flutes, length, shank)));
        let holder = holder(tool).filter(|(_, height)| *height <= length);
        body.extend(holder.map(|(holder, height)| behind(length - height, length, holder)));
        // A length of 0 means that the tip is programmed.
        let spindle = tool.length.filter(|length| 0.0 < *length).map(|length| {
            let widest = [Some(MIN_SPINDLE), Some(diameter), tool.holder_diameter].into_iter().flatten();
            behind(length, length + SPINDLE_LENGTH, widest.fold(0.0, f64::max))
        });
        body.extend(spindle);
        body.retain(|part| part.from <= part.to);
        body
    }

    /// Returns the parts of a tool's end: the full diameter at the upper end of its point, and the point. Empty if the tool
    /// table lacks the tool or its diameter.
    pub(crate) fn tool_end(&self, tool: Option<u32>) -> Vec<ToolPart> {
        let Some(tool) = tool.and_then(|number| self.find_tool(number)) else { return Vec::new() };
        let Some(diameter) = tool.diameter else { return Vec::new() };
        let point = tool.point_length(diameter);
        let full = ToolPart::flutes(point, point, diameter / 2.0);
        std::iter::once(full).chain(cone(point, diameter)).collect()
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

/// Returns the cone of a point; `None` of a flat end.
fn cone(length: f64, diameter: f64) -> Option<ToolPart> {
    let taper = Taper { radius: 0.0, slope: diameter / 2.0 / length };
    (0.0 < length).then_some(ToolPart { from: 0.0, to: length, taper, is_cutter: true })
}

/// Returns diameter and length of the holder.
fn holder(tool: &Tool) -> Option<(f64, f64)> {
    tool.holder_diameter.zip(tool.holder_length)
}
