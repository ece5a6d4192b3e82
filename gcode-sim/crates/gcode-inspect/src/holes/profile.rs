//! Profile of a tool in a feed: the cylinders that cut.
use crate::machine::ToolCylinder;

/// The tool in a feed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Profile {
    /// Cylinders that cut; the uppermost of a tool of unknown length has no end.
    pub parts: Vec<ToolCylinder>,
    /// Largest radius.
    pub radius: f64,
    /// False if the radius is the largest that the tool may have.
    pub is_certain: bool,
}

impl Profile {
    /// Returns the cutting parts of a tool.
    pub(super) fn of_tool(body: &[ToolCylinder]) -> Self {
        let mut parts: Vec<ToolCylinder> = body.iter().copied().filter(|part| part.is_cutter).collect();
        let is_shanked = body.len() > parts.len();
        if let Some(flutes) = parts.first_mut().filter(|_| !is_shanked) {
            flutes.to = f64::INFINITY;
        }
        // The point leaves a line below its lowest step.
        let lowest = parts.iter().map(|part| part.from).fold(f64::INFINITY, f64::min);
        if 0.0 < lowest {
            parts.push(ToolCylinder { from: 0.0, to: lowest, radius: 0.0, is_cutter: true });
        }
        let radius = parts.iter().map(|part| part.radius).fold(0.0, f64::max);
        Self { parts, radius, is_certain: true }
    }

    /// Returns a flat tool.
    pub(super) fn flat(radius: f64, is_certain: bool) -> Self {
        let part = ToolCylinder { from: 0.0, to: f64::INFINITY, radius, is_cutter: true };
        Self { parts: vec![part], radius, is_certain }
    }
}
