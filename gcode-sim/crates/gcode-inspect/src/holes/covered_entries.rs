//! Metal over the entries of nominal holes at the end of a run: the pocket at whose floor they begin is not milled.
use super::HoleExtractor;
use super::swept_tool::ring;
use nalgebra::Vector3;

/// Least depth of an entry in the body and least height of the metal over it, mm: coordinates in a list are rounded.
const MIN_COVER: f64 = 0.1;

/// Distance from the wall of the hole at which the metal over the entry counts, mm.
const BESIDE_WALL: f64 = 0.5;

/// Number of points round a hole.
const POINTS: u32 = 8;

impl HoleExtractor<'_> {
    /// Returns the indices of the nominal holes whose entries are under metal all round that no feed has removed.
    pub(super) fn covered_entries(&self) -> Vec<usize> {
        let (Some(body), Some(holes)) = (self.surface, &self.metal.holes) else { return Vec::new() };
        let is_covered = |index: &usize| {
            let collar = holes.collar(*index);
            let axis = collar.rod.axis;
            let out = axis.into_inner();
            let entry = collar.rod.base + out * collar.rod.length;
            if body.depth(&entry) <= MIN_COVER {
                return false;
            }
            let offsets = ring(&axis, &Vector3::zeros(), collar.hole_radius + BESIDE_WALL, POINTS);
            offsets.into_iter().all(|offset| {
                let above = entry + out * MIN_COVER + offset;
                self.metal.uncut(&[above, above]).is_some()
            })
        };
        (0..holes.len()).filter(is_covered).collect()
    }
}
