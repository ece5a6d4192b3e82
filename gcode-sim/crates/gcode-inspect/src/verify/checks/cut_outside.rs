//! Passes of a hole besides the finishing one lie inside its nominal outline: no later pass restores material.
use super::*;
use crate::findings::HOLE_CUT_ASIDE;
use crate::machine::ToolKind;
use crate::verify::hole_cuts::{Cut, side};
use crate::verify::outline::Outline;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, .. } = inspection;
    let sides = comparison.matched().flat_map(|(pair, nominal, drilled)| {
        let far = pair.from_far_side.map(|index| &comparison.actual[index]);
        [Some(drilled), far].into_iter().flatten().map(move |drilled| (pair, nominal, drilled))
    });
    for (pair, nominal, drilled) in sides {
        if drilled.earlier_passes.is_empty() {
            continue;
        }
        let outline = match drilled.axis.dot(&Vector3::from(nominal.axis)) < 0.0 {
            true => Outline::of_far_side(nominal),
            false => Outline::of(nominal, comparison.tolerances.depth),
        };
        // A drill down to the bottom of a thread leaves the metal of the thread.
        let threads = threads::stated_threads(nominal);
        let thread_bottom = threads.iter().map(|(.., bottom)| *bottom).reduce(f64::max);
        let core = Outline::of_core(nominal, &threads, comparison.tolerances.depth);
        let cuts = Cut::all(nominal, drilled, machine);
        let reamed = reamed_cut(&cuts, drilled.finishing_index);
        for (index, cut) in cuts.iter().enumerate() {
            if index == drilled.finishing_index {
                continue;
            }
            let Some(offset) = offset(nominal, cut) else { continue };
            // A later pass removes the deviation of a cut that is narrower than the outline.
            let is_threaded = thread_bottom.is_some_and(|bottom| {
                !cut.is_thread() && !exceeds(bottom - cut.tip, comparison.tolerances.depth)
            });
            let outline = if is_threaded { &core } else { &outline };
            let margin = outline.as_ref().zip(cut.shape()).map(|(outline, shape)| outline.margin(&shape));
            let is_reamed = reamed == Some(index);
            let spare = margin.filter(|margin| margin.is_finite() && !is_reamed);
            let spare = spare.map_or(0.0, |margin| margin.max(0.0));
            let allowed = spare + comparison.tolerances.position / 2.0;
            if !exceeds(offset, allowed) {
                continue;
            }
            let tool = cut.pass.tool.map_or(String::new(), |tool| format!(" by T{tool}"));
            let message = format!(
                "hole {}: an earlier pass{tool} is out of position by {offset:.4} mm, limit {allowed:.4}",
                comparison.id(pair.nominal)
            );
            let help = match cut.pass.diameter {
                _ if is_reamed => "correct the point of that pass: a reamer follows the hole that it finds",
                None => {
                    "correct the point of that pass, or give the tool diameters in the machine file: a smaller tool may \
                     lie inside the finished hole"
                }
                Some(_) => "correct the point of that pass: material cut outside the hole cannot be restored",
            };
            let finding =
                Diagnostic::new(&HOLE_CUT_ASIDE, message).with_backtrace(cut.pass.backtrace.clone());
            findings.add(Subject::Nominal(pair.nominal), finding.help(help));
        }
    }
}

/// Returns the pass that makes the hole for a reamer that finishes it: the last one before that goes half as deep.
fn reamed_cut(cuts: &[Cut<'_>], finishing_index: usize) -> Option<usize> {
    let reamer = cuts.get(finishing_index).filter(|cut| cut.kind == Some(ToolKind::Reamer))?;
    let is_spot = |cut: &Cut<'_>| matches!(cut.kind, Some(ToolKind::SpotDrill | ToolKind::Countersink));
    (0..finishing_index).rfind(|index| reamer.tip / 2.0 <= cuts[*index].tip && !is_spot(&cuts[*index]))
}

/// Returns the largest distance of a pass from the nominal axis over its own depth, mm; `None` for a pass across it.
fn offset(nominal: &Hole, cut: &Cut<'_>) -> Option<f64> {
    let depth = cut.tip.clamp(f64::MIN_POSITIVE, nominal.depth);
    let (entry, out) = side(nominal, &cut.pass.axis);
    let own = Hole { entry: entry.into(), axis: out.into(), depth, ..Hole::default() };
    let deviation = Deviation::new(&own, &cut.pass.cut.bottom, &cut.pass.axis)?;
    Some(deviation.zone_diameter() / 2.0)
}
