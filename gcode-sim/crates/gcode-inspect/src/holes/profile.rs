//! Profile of a tool in a feed: the parts that cut.
use crate::machine::ToolPart;

/// The tool in a feed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Profile {
    /// Parts that cut; the uppermost of a tool of unknown length has no end.
    pub parts: Vec<ToolPart>,
    /// Largest radius.
    pub radius: f64,
    /// False if the radius is the largest that the tool may have.
    pub is_certain: bool,
}

impl Profile {
    /// Returns the cutting parts of a tool.
    pub(super) fn of_tool(body: &[ToolPart]) -> Self {
        let mut parts: Vec<ToolPart> = body.iter().copied().filter(|part| part.is_cutter).collect();
        let is_shanked = body.len() > parts.len();
        if let Some(flutes) = parts.first_mut().filter(|_| !is_shanked) {
            flutes.to = f64::INFINITY;
        }
        let radius = parts.iter().map(ToolPart::radius).fold(0.0, f64::max);
        Self { parts, radius, is_certain: true }
    }

    /// Returns a flat tool.
    pub(super) fn flat(radius: f64, is_certain: bool) -> Self {
        Self { parts: vec![ToolPart::flutes(0.0, f64::INFINITY, radius)], radius, is_certain }
    }
}
