//! Mills of unknown diameter: the diameters that the circles of one mill cut differ as those of its paths do.
use std::collections::BTreeSet;

use super::Tolerances;
use super::hole_cuts::Cut;
use super::outline::Outline;
use crate::machine::PointShape;
use gcode_part::{Feature, FeatureKind, Hole, NOISE, exceeds};

/// How well a diameter of a mill explains a hole; the greatest explains it best.
type Fit = (usize, usize, f64);

/// Gives each mill of unknown diameter that makes features of a hole the diameter with which its circles make most of them. Without
/// a circle that ends where a feature does it stays unknown.
pub(super) fn size_mills(nominal: &Hole, cuts: &mut [Cut<'_>], tolerances: Tolerances) {
    let mills: BTreeSet<Option<u32>> =
        cuts.iter().filter(|cut| is_unsized_circle(cut)).map(|cut| cut.pass.tool).collect();
    let outline = Outline::of(nominal, tolerances.depth);
    let has_cone = nominal.features.iter().any(|feature| feature.kind == FeatureKind::Countersink);
    for tool in mills {
        let circles: Vec<Cut<'_>> =
            cuts.iter().filter(|cut| is_unsized_circle(cut) && cut.pass.tool == tool).copied().collect();
        let fit = |mill: f64| -> Fit {
            let sized: Vec<Cut<'_>> = circles.iter().map(|circle| circle.of_mill(mill)).collect();
            let makes = |feature: &&Feature, is_ended: bool| {
                let is_made = |cut: &Cut<'_>| {
                    cut.mismatch(feature, tolerances).is_some()
                        && (!is_ended || ends_at(nominal, feature, cut, tolerances))
                };
                sized.iter().any(is_made)
            };
            let made = |is_ended| nominal.features.iter().filter(|feature| makes(feature, is_ended)).count();
            let margins = sized.iter().filter_map(|cut| Some(outline.as_ref()?.margin(&cut.shape()?)));
            (made(true), made(false), margins.fold(0.0, f64::min))
        };
        let mut best: Option<(Fit, f64)> = None;
        for (feature, circle) in nominal.features.iter().flat_map(|one| circles.iter().map(move |c| (one, c)))
        {
            let mill = feature.diameter - 2.0 * circle.path_radius();
            if feature.kind == FeatureKind::Countersink || mill <= NOISE {
                continue;
            }
            let own = fit(mill);
            if best.is_none_or(|(fit, _)| fit < own) {
                best = Some((own, mill));
            }
        }
        // A tool that may be a chamfer mill is an end mill if it makes two cylinders.
        let may_be_cone = has_cone && circles.iter().any(|circle| circle.may_be_cone);
        let least = if may_be_cone { 2 } else { 1 };
        let Some((_, mill)) = best.filter(|((made, ..), _)| least <= *made) else { continue };
        for cut in cuts.iter_mut().filter(|cut| is_unsized_circle(cut) && cut.pass.tool == tool) {
            *cut = cut.of_mill(mill);
        }
    }
}

/// Returns true for a circle, of no thread, by a flat mill of unknown diameter.
fn is_unsized_circle(cut: &Cut<'_>) -> bool {
    let is_circle = cut.is_circle() && cut.thread.is_none();
    is_circle && cut.pass.diameter.is_none() && cut.point == PointShape::Flat
}

/// Returns true if a cut ends where a feature does, or goes through with it.
fn ends_at(nominal: &Hole, feature: &Feature, cut: &Cut<'_>, tolerances: Tolerances) -> bool {
    let beyond = cut.tip - feature.bottom();
    let is_through = nominal.through && !exceeds(nominal.depth, feature.bottom());
    !exceeds(-beyond, tolerances.depth) && (is_through || !exceeds(beyond, tolerances.depth))
}
