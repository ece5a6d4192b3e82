//! Deviations that all flutes share, all along: one finding that names them.
use super::cause::Cause;
use crate::flutes::{GrindingPass, ROUNDING_ERROR, Window};
use gcode_lang::units::Deg;
use gcode_part::Flutes;

/// Helix angle of all flutes instead of the nominal one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CommonDeviation {
    /// That of the other law.
    OtherLaw,
    /// That of the nominal law with this helix angle on the cylinder; the opposite sign is the other hand.
    OtherHelix(Deg),
    /// The nominal one on a ground diameter that is too large.
    GroundHigh,
}

/// Returns the hand of flutes with this helix angle.
pub(super) fn helix_hand(helix: Deg) -> &'static str {
    if helix.0 < 0.0 { "left-hand" } else { "right-hand" }
}

/// Returns the height of all passes above the tooth bottom, mm; `None` if it differs or is within the tolerance.
pub(super) fn common_height(nominal: &Flutes, passes: &[GrindingPass]) -> Option<f64> {
    let height = |pass: &GrindingPass| {
        let most = pass.trace.samples.iter().map(|sample| sample.deviation.abs()).fold(0.0, f64::max);
        match Cause::of(nominal, pass, most) {
            Cause::Depth(depth) => Some(depth),
            Cause::BetweenPoints | Cause::Offset(_) | Cause::Other => None,
        }
    };
    let heights: Vec<f64> = passes.iter().map(height).collect::<Option<_>>()?;
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let is_common = heights.iter().all(|height| (height - mean).abs() <= 0.1 * mean.abs());
    (is_common && nominal.surface_tolerance + ROUNDING_ERROR < mean.abs()).then_some(mean)
}

impl CommonDeviation {
    pub(super) fn of(nominal: &Flutes, passes: &[GrindingPass]) -> Option<Self> {
        let allowed = nominal.helix_tolerance.0;
        let windows: Vec<Window<'_>> =
            passes.iter().flat_map(|pass| pass.trace.windows(nominal.gauge)).collect();
        let all = |fits: &dyn Fn(&Window<'_>) -> bool| !windows.is_empty() && windows.iter().all(fits);
        if all(&|window| (window.helix - window.nominal_helix).abs().0 <= allowed) {
            return None;
        }
        if all(&|window| (window.helix - window.other_law_helix).abs().0 < 2.0 * allowed) {
            return Some(Self::OtherLaw);
        }
        if let Some(height) = common_height(nominal, passes) {
            // On the cylinder the path around grows with the radius, the path along does not; on a ball both do.
            let radius = nominal.profile.radius();
            let is_between = |window: &Window<'_>| {
                let on_ball = window.nominal_helix;
                let on_cylinder = Deg::atan2(on_ball.tan() * radius, radius + height);
                let (low, high) = (on_ball.0.min(on_cylinder.0), on_ball.0.max(on_cylinder.0));
                (low - allowed..=high + allowed).contains(&window.helix.0)
            };
            if all(&is_between) {
                return Some(Self::GroundHigh);
            }
        }
        // By both laws the slope is proportional to the tangent of the angle on the cylinder.
        let ratio = |window: &Window<'_>| window.helix.tan() / window.nominal_helix.tan();
        let mut factors: Vec<f64> = windows.iter().map(ratio).collect();
        factors.sort_by(f64::total_cmp);
        let factor = factors.get(factors.len() / 2)?;
        let helix = Deg::atan2(factor * nominal.helix.tan(), 1.0);
        let fits = |window: &Window<'_>| {
            (window.helix - Deg::atan2(factor * window.nominal_helix.tan(), 1.0)).abs().0 <= 2.0 * allowed
        };
        // A single wrong flute changes the median by less than the tolerance.
        (allowed < (helix - nominal.helix).abs().0 && all(&fits)).then_some(Self::OtherHelix(helix))
    }
}
