//! What all flutes have alike, all along, in another way than is wanted: said once, and as what it is.
use super::cause::Cause;
use crate::flutes::{GrindingPass, ROUNDING_ERROR, Window};
use gcode_lang::units::Deg;
use gcode_part::Flutes;

/// What the helix angle is of instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CommonDeviation {
    /// The other law.
    OtherLaw,
    /// The wanted law with another helix angle on the cylinder; of the other sign it is the other hand.
    OtherHelix(Deg),
    /// The wanted one on the diameter that the flutes are ground to by so much too high, mm.
    GroundHigh,
}

/// In words which way flutes of a helix angle wind.
pub(super) fn helix_hand(helix: Deg) -> &'static str {
    if helix.0 < 0.0 { "left-hand" } else { "right-hand" }
}

/// How far above the tooth bottom all passes are alike, where that is more than is allowed, mm.
pub(super) fn common_height(wanted: &Flutes, passes: &[GrindingPass]) -> Option<f64> {
    let depths: Option<Vec<f64>> = passes
        .iter()
        .map(|pass| {
            let most = pass.trace.samples.iter().map(|sample| sample.deviation.abs()).fold(0.0, f64::max);
            match Cause::of(wanted, pass, most) {
                Cause::Depth(depth) => Some(depth),
                Cause::BetweenPoints | Cause::Offset(_) | Cause::Other => None,
            }
        })
        .collect();
    let depths = depths?;
    let mean = depths.iter().sum::<f64>() / depths.len() as f64;
    let alike = depths.iter().all(|depth| (depth - mean).abs() <= 0.1 * mean.abs());
    (alike && wanted.surface_tolerance + ROUNDING_ERROR < mean.abs()).then_some(mean)
}

impl CommonDeviation {
    pub(super) fn of(wanted: &Flutes, passes: &[GrindingPass]) -> Option<Self> {
        let allowed = wanted.helix_tolerance.0;
        let windows: Vec<Window<'_>> =
            passes.iter().flat_map(|pass| pass.trace.windows(wanted.gauge)).collect();
        let all = |fits: &dyn Fn(&Window<'_>) -> bool| !windows.is_empty() && windows.iter().all(fits);
        if all(&|window| (window.helix - window.nominal_helix).abs().0 <= allowed) {
            return None;
        }
        if all(&|window| (window.helix - window.other_law_helix).abs().0 < 2.0 * allowed) {
            return Some(Self::OtherLaw);
        }
        if let Some(depth) = common_height(wanted, passes) {
            // On the cylinder the way around grows with the radius, the way along doesn't; on a ball both do.
            let radius = wanted.profile.radius();
            let between = |window: &Window<'_>| {
                let tan = window.nominal_helix.tan();
                let other = Deg::atan2(tan * radius, radius + depth);
                let (low, high) = (window.nominal_helix.0.min(other.0), window.nominal_helix.0.max(other.0));
                (low - allowed..=high + allowed).contains(&window.helix.0)
            };
            if all(&between) {
                return Some(Self::GroundHigh);
            }
        }
        // By both laws the slope grows with the tangent of the angle on the cylinder.
        let slope = wanted.helix.tan();
        let mut factors: Vec<f64> =
            windows.iter().map(|window| window.helix.tan() / window.nominal_helix.tan()).collect();
        factors.sort_by(f64::total_cmp);
        let factor = factors.get(factors.len() / 2)?;
        let alike = |window: &Window<'_>| {
            (window.helix - Deg::atan2(factor * window.nominal_helix.tan(), 1.0)).abs().0 <= 2.0 * allowed
        };
        // One flute that is off makes no other angle of all.
        let helix = Deg::atan2(factor * slope, 1.0);
        (allowed < (helix - wanted.helix).abs().0 && all(&alike)).then_some(Self::OtherHelix(helix))
    }
}
