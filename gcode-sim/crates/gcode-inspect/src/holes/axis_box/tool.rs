//! Parts of the tool in a box of axes: their parameters, and the side that faces a body.
use nalgebra::{Point3, Vector3};

use super::{AxisBox, Bodies, Cell, MAX_PARAMETERS};
use crate::machine::ToolPart;
use gcode_part::NearestPoint;

impl AxisBox<'_> {
    /// Returns the same positions with a part of the tool instead of its tip.
    pub(in crate::holes) fn with_tool(&self, tool: ToolPart) -> Self {
        Self { tool: Some(tool), ..self.clone() }
    }

    /// Returns the parameters of the tool: height and two across.
    pub(super) fn of_tool(&self, parameters: &[f64; MAX_PARAMETERS]) -> [f64; 3] {
        let motion = self.groups.len();
        [parameters[motion], parameters[motion + 1], parameters[motion + 2]]
    }

    /// Returns false for a cell beside the tool.
    pub(super) fn is_in_tool(&self, cell: &Cell) -> bool {
        let Some(tool) = self.tool else { return true };
        let ([height, u, v], [half, half_u, half_v]) = (self.of_tool(&cell.middle), self.of_tool(&cell.half));
        let radius = tool.taper.at(height - half).max(tool.taper.at(height + half));
        libm::hypot((u.abs() - half_u).max(0.0), (v.abs() - half_v).max(0.0)) <= radius
    }

    /// Returns the parameters of the points on the tool's side that face the nearest body, at the same height and at the
    /// ends of the part; none for the tip.
    pub(super) fn deeper_sides(
        &self,
        at: &[f64; MAX_PARAMETERS],
        bodies: &Bodies<'_>,
    ) -> Vec<[f64; MAX_PARAMETERS]> {
        let (Some(tool), motion) = (self.tool, self.groups.len()) else { return Vec::new() };
        let mut side = *at;
        side[motion + 1..motion + 3].fill(0.0);
        let position = self.position(at);
        let frame = self.machine.part_frame(&position);
        let mut nearest_body: Option<NearestPoint> = None;
        bodies(&self.point(&side), &Vector3::zeros(), &mut |nearest| {
            if nearest_body.as_ref().is_none_or(|body| nearest.distance < body.distance) {
                nearest_body = Some(nearest);
            }
        });
        let (Some(axis), Some(body)) = (self.machine.tool_pose(&position, self.setup).axis, nearest_body)
        else {
            return Vec::new();
        };
        let normal = frame.rotation * body.normal.into_inner();
        let [across, beside] = directions_across(&axis).map(|direction| normal.dot(&direction));
        let length = libm::hypot(across, beside);
        let side_at = |height: f64| {
            side[motion] = height;
            if 1e-9 < length {
                side[motion + 1] = -tool.taper.at(height) * across / length;
                side[motion + 2] = -tool.taper.at(height) * beside / length;
            }
            side
        };
        [at[motion], tool.from, tool.to].map(side_at).into()
    }

    /// Returns true if a tangent plane at an end of the motion has every point of the tool on its outer side; false if that
    /// is not certain.
    pub(in crate::holes) fn is_clear_by_planes(
        &self,
        parts: &[ToolPart],
        nearest: impl Fn(&Point3<f64>) -> NearestPoint,
    ) -> bool {
        let (Some(corners), Some(axis)) =
            (self.straight_corners(), self.machine.forward(&self.from, self.setup).axis)
        else {
            return false;
        };
        let is_outside = |p: &Point3<f64>| {
            let NearestPoint { distance, normal } = nearest(p);
            let along = normal.dot(&axis);
            let most = libm::sqrt((1.0 - along * along).max(0.0));
            let travel = corners.iter().map(|corner| (corner - p).dot(&normal)).fold(0.0, f64::min);
            parts.iter().all(|part| {
                let end = |height: f64| along * height - part.taper.at(height) * most;
                // A tool of unknown length reaches as high as the metal.
                let is_endless = part.is_cutter && part.to <= part.from;
                (!is_endless || 0.0 <= along) && 0.0 <= distance + travel + end(part.from).min(end(part.to))
            })
        };
        corners.first().into_iter().chain(corners.last()).any(is_outside)
    }
}

/// Returns two directions across the tool, perpendicular to each other; they change continuously while a head inclines the
/// tool in the plane of x and y.
pub(crate) fn directions_across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if axis.z.abs() < 0.5 { Vector3::z() } else { Vector3::x() };
    let across = (other - axis * axis.dot(&other)).normalize();
    [across, axis.cross(&across)]
}
