//! Feeds that cut less than counts: those that scratch what has to stay, and those that are as earlier ones.
use nalgebra::{Unit, Vector3};

use super::HoleExtractor;
use super::near_metal::{FeedPart, Judged};
use super::removed_metal::Covers;
use super::strip::Line;
use super::swept_tool::is_at_outline;

impl HoleExtractor<'_> {
    /// Returns true if a feed cuts any of what has to stay, be it less than counts.
    pub(super) fn scratches(&self, travel: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        if self.surface.is_some() && !self.has_left_start || self.pose.axis.is_none() {
            return false;
        }
        self.metal.judged_on(travel, Judged::Untouched(FeedPart::Tip)).is_some()
            || self.tool_body.iter().filter(|part| part.is_cutter).any(|part| {
                let side = FeedPart::Side { radius: part.radius(), slope: part.taper.slope };
                !self.metal.is_allowed(travel, axis, part, 0.0)
                    && is_at_outline(part, axis, travel, &self.metal, Judged::Untouched(side))
            })
    }

    /// Returns true if a feed is as one that the tool has made before.
    pub(super) fn has_repeated(&self, travel: &Line, axis: &Unit<Vector3<f64>>, covers: Covers) -> bool {
        let profile = self.profile.as_ref().filter(|_| self.tool_radius().is_some());
        profile.is_some_and(|profile| self.metal.removed.has_repeated(travel, axis, profile, covers))
    }
}
