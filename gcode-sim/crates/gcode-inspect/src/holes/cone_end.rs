//! Mills whose ends the machine file doesn't describe: at a countersink of the list they may be its cone.
use nalgebra::{Unit, Vector3};

use super::HoleExtractor;
use super::feed_law::{Gouge, ToolRegion};
use super::strip::Line;
use crate::machine::PointShape;
use gcode_lang::units::Deg;
use gcode_part::NOISE;

/// End that a tool of known diameter, without kind and point angle, is assumed to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AssumedCone {
    /// Index of the nominal hole whose countersink it mills.
    pub hole: usize,
    /// Full angle, that of the countersink.
    pub angle: Deg,
}

impl HoleExtractor<'_> {
    /// Returns the cone that the tool in the spindle is assumed to have.
    pub(super) fn assumed_cone(&self) -> Option<AssumedCone> {
        self.milling.cones.get(&self.setup.tool?).copied()
    }

    /// Returns true if a feed that makes a gouge with a flat end makes none with the cone of the countersink in whose mouth it
    /// leads. From here on the tool then counts as that cone.
    pub(super) fn becomes_cone(&mut self, travel: &Line, axis: &Unit<Vector3<f64>>, gouge: &Gouge) -> bool {
        let cone = self.cone_without_gouge(travel, axis, gouge, u32::MAX);
        let Some((tool, cone)) = self.setup.tool.zip(cone) else { return false };
        self.milling.cones.insert(tool, cone);
        self.update_tool_body();
        true
    }

    /// Returns the cone of the countersink in whose mouth a feed leads, if the end of the tool is unknown and the gouge is that of
    /// a flat one alone; the metal is what the first sweeps leave.
    pub(super) fn cone_without_gouge(
        &self,
        travel: &Line,
        axis: &Unit<Vector3<f64>>,
        gouge: &Gouge,
        sweeps: u32,
    ) -> Option<AssumedCone> {
        let tool = self.setup.tool.and_then(|number| self.machine.find_tool(number))?;
        let is_open = tool.kind.is_none() && tool.point() == PointShape::Unknown;
        if !is_open || !matches!(gouge.part, ToolRegion::Side) || self.assumed_cone().is_some() {
            return None;
        }
        let cone = self.countersink_round(travel, axis)?;
        let body = self.machine.tool_body(&self.setup, Some(cone.angle));
        self.side_gouge(&body, travel, axis, sweeps).is_none().then_some(cone)
    }

    /// Returns the countersink of the list in whose mouth the tip stays on a feed.
    fn countersink_round(&self, travel: &Line, axis: &Unit<Vector3<f64>>) -> Option<AssumedCone> {
        let holes = self.metal.holes.as_ref()?;
        let mut found = None;
        holes.around(&travel[0].inf(&travel[1]), &travel[0].sup(&travel[1]), &mut |hole| {
            let collar = holes.collar(hole);
            let Some(cone) = collar.steps.iter().find(|step| step.taper.slope < 0.0) else { return };
            let is_in_mouth = |tip| collar.from_axis(tip) <= cone.radius(collar.depth(tip)) + NOISE;
            if collar.is_parallel(axis) && 0.0 < axis.dot(&collar.rod.axis) && travel.iter().all(is_in_mouth)
            {
                let angle = Deg(2.0 * Deg::atan2(-cone.taper.slope, 1.0).0);
                found = Some(AssumedCone { hole, angle });
            }
        });
        found
    }
}
