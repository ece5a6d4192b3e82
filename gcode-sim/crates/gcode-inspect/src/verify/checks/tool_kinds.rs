//! Cuts that a kind of tool can't make: a reamer, a boring bar or a tap in solid metal, a circle by a tool that cuts with its end.
use super::features::{Judgement, ShapeGap, drilled_depths};
use super::through::rim_thickness;
use super::*;
use crate::findings::TOOL_KIND;
use crate::holes::PassCut;
use crate::machine::{PointShape, Tool, ToolKind};
use crate::verify::hole_cuts::Cut;

/// Largest share of its diameter that a reamer takes off, and the bounds of that amount, mm: more than reamers are made for.
const MAX_REAMING_SHARE: f64 = 0.1;
const MAX_REAMING: [f64; 2] = [0.5, 1.0];

/// Largest share of its diameter that a boring bar takes off: the bar itself goes into the hole before it.
const MAX_BORING_SHARE: f64 = 1.0 / 3.0;

/// Returns true for a tool of a kind that only widens or threads a hole.
fn needs_hole(kind: Option<ToolKind>) -> bool {
    kind.is_some_and(ToolKind::needs_hole)
}

/// Returns true for a cut that needs a hole that another one has made: of a reamer, a boring bar or a tap.
pub(super) fn needs_earlier_cut(cut: &Cut<'_>) -> bool {
    needs_hole(cut.kind) || cut.is_thread()
}

/// Returns true if a hole of one diameter and one pass is drilled, or milled by a flat end.
pub(super) fn is_usual(drilled: &DrilledHole, machine: &Machine) -> bool {
    let tool = || drilled.tool.and_then(|number| machine.find_tool(number));
    let is_flat = |tool: &Tool| {
        !tool.kind.is_some_and(ToolKind::cuts_with_end) && !matches!(tool.point(), PointShape::Pointed(_))
    };
    match drilled.finishing_cut {
        PassCut { is_tapping: true, .. } => false,
        PassCut { milled: Some(circle), .. } => circle.wall.is_infinite() && tool().is_none_or(is_flat),
        _ => tool().is_none_or(|tool| !needs_hole(tool.kind) && !makes_cone(tool.kind, tool.point())),
    }
}

/// Returns true for a tool with a cone that is no drill: the hole of its diameter ends where the cone begins.
fn makes_cone(kind: Option<ToolKind>, point: PointShape) -> bool {
    matches!(kind, Some(ToolKind::SpotDrill | ToolKind::Countersink | ToolKind::EndMill))
        && matches!(point, PointShape::Pointed(_))
}

/// Reports a hole of one diameter that only tools with a cone cut, and not to its depth.
fn cone(judged: &Judgement<'_>) -> Option<Diagnostic> {
    let nominal = judged.nominal;
    let diameter = nominal.diameter.filter(|_| nominal.features.is_empty())?;
    let cuts = || judged.near.iter().chain(&judged.far);
    if !cuts().all(|cut| !cut.is_circle() && !cut.is_thread() && makes_cone(cut.kind, cut.point)) {
        return None;
    }
    let depth = |cut: &Cut<'_>| cut.full_depth(diameter).unwrap_or(cut.tip);
    let deepest = cuts().max_by(|one, other| depth(one).total_cmp(&depth(other)))?;
    let full = depth(deepest).max(0.0);
    let limit = judged.comparison.tolerances.depth;
    // A tip that isn't as deep either has its own finding.
    let is_as_deep = cuts().any(|cut| !exceeds(nominal.depth - cut.tip, limit));
    if !is_as_deep || !exceeds(nominal.depth - full, limit) {
        return None;
    }
    let message = format!(
        "hole {}: {} has a cone: below {full:.3} mm the hole is narrower than Φ{diameter}, and it is {} mm deep",
        judged.id,
        deepest.name(),
        nominal.depth
    );
    let finding = Diagnostic::new(&TOOL_KIND, message).with_backtrace(deepest.pass.backtrace.clone());
    Some(finding.help("drill the hole, or enter a countersink as the feature of the hole in the reference"))
}

/// Adds the findings on the kinds of the tools that cut a hole, and the tools whose hole the program doesn't drill.
/// The part is solid where its stock or surface is known. `on_axis` are the cuts of other holes of the list on the same axis that are
/// made before: a stepped hole may be several holes.
pub(super) fn judge<'c>(judged: &mut Judgement<'c>, on_axis: &[Cut<'c>]) {
    let (mut findings, mut gaps) = (Vec::new(), Vec::new());
    let (near, far) = (judged.nominal, &judged.nominal.from_far_side());
    for (side, cuts, others) in [(near, &judged.near, &judged.far), (far, &judged.far, &judged.near)] {
        for (index, cut) in cuts.iter().enumerate() {
            findings.extend(sideways(judged.id, cut));
            if !needs_earlier_cut(cut) || cut.is_circle() {
                continue;
            }
            let makes_hole = |other: &Cut<'_>| !needs_earlier_cut(other);
            let before = [on_axis, &judged.voids_before(side, cut), &cuts[..index]].concat();
            if !cuts.iter().chain(others).chain(&before).any(makes_hole) {
                // A tool of unknown kind may as well be a drill.
                match cut.kind.filter(|_| judged.blank.body.is_some()) {
                    Some(kind) => findings.push(undrilled(judged.id, cut, kind)),
                    None => gaps.push(ShapeGap::Undrilled(cut.pass.tool)),
                }
            } else if cut.kind.is_some_and(|kind| kind != ToolKind::Tap) {
                let finding = too_narrow(judged, cut, &before, others);
                findings.extend(finding.or_else(|| in_solid(judged, cut, &before, others)));
            }
            findings.extend(torn(judged, cut));
        }
    }
    findings.extend(cone(judged));
    gaps.dedup();
    judged.findings.extend(findings);
    judged.gaps.extend(gaps);
}

/// Reports a tool in a hole that nothing drills.
fn undrilled(id: &str, cut: &Cut<'_>, kind: ToolKind) -> Diagnostic {
    let kind = kind.name();
    let message =
        format!("hole {id}: {} is a {kind} and goes {:.3} mm into the solid part", cut.name(), cut.tip);
    Diagnostic::new(&TOOL_KIND, message)
        .with_backtrace(cut.pass.backtrace.clone())
        .help("drill the hole before it; if another program drills it, state it as a [[stock.void]]")
}

/// Reports a circle by a tool without cutting edges on its side.
fn sideways(id: &str, cut: &Cut<'_>) -> Option<Diagnostic> {
    let kind = cut.kind.filter(|_| cut.is_circle())?;
    let message = format!("hole {id}: {} mills a circle and is a {}", cut.name(), kind.name());
    let finding = Diagnostic::new(&TOOL_KIND, message).with_backtrace(cut.pass.backtrace.clone());
    cut.kind
        .is_some_and(ToolKind::cuts_with_end)
        .then(|| finding.help("use an end mill, or correct the kind of the tool in the machine file"))
}

/// Returns the largest amount that a reamer or a boring bar takes off the diameter, mm; `None` for other tools.
fn allowance(kind: ToolKind, own: f64) -> Option<f64> {
    match kind {
        ToolKind::Reamer => Some((MAX_REAMING_SHARE * own).clamp(MAX_REAMING[0], MAX_REAMING[1])),
        ToolKind::BoringBar => Some(MAX_BORING_SHARE * own),
        _ => None,
    }
}

/// Reports a reamer or a boring bar that widens a hole by more than its edges can cut.
fn too_narrow(
    judged: &Judgement<'_>,
    cut: &Cut<'_>,
    before: &[Cut<'_>],
    others: &[Cut<'_>],
) -> Option<Diagnostic> {
    let (kind, own) = cut.kind.zip(cut.pass.diameter)?;
    let limit = allowance(kind, own)?;
    let mut widest = 0.0f64;
    for other in before.iter().chain(others).filter(|other| !other.is_thread()) {
        // A cone is as wide as the tool only above its point.
        let is_cone = matches!(other.kind, Some(ToolKind::SpotDrill | ToolKind::Countersink));
        if !is_cone && is_as_deep(judged, cut, other) {
            widest = widest.max(other.pass.diameter?);
        }
    }
    // Where nothing is as deep, its depth is the fault.
    if widest == 0.0 || !exceeds(own - widest, limit) {
        return None;
    }
    let (id, name, kind) = (judged.id, cut.name(), kind.name());
    let message = format!(
        "hole {id}: {name} is a {kind} and takes {:.3} mm off the diameter, where the hole is Φ{widest}: limit {limit:.3}",
        own - widest
    );
    let finding = Diagnostic::new(&TOOL_KIND, message).with_backtrace(cut.pass.backtrace.clone());
    Some(finding.help("drill or bore the hole nearly to its diameter before it"))
}

/// Returns true if another cut is as deep as that of a reamer or a boring bar, or ends by no more than its point above it.
fn is_as_deep(judged: &Judgement<'_>, cut: &Cut<'_>, other: &Cut<'_>) -> bool {
    let point = other.pass.diameter.map_or(0.0, |own| other.point.length(own).unwrap_or(0.0));
    let reached = other.tip + point + judged.comparison.tolerances.depth;
    let depth = if judged.nominal.through { cut.tip.min(judged.nominal.depth) } else { cut.tip };
    !exceeds(depth, reached)
}

/// Reports a reamer or a boring bar that goes deeper than the hole before it is as wide as its end: a reamer than its full
/// diameter, a bar than half its own, because its edge cuts the cone of the drill at the wall.
fn in_solid(
    judged: &Judgement<'_>,
    cut: &Cut<'_>,
    before: &[Cut<'_>],
    others: &[Cut<'_>],
) -> Option<Diagnostic> {
    let end =
        cut.pass.diameter.filter(|_| cut.kind == Some(ToolKind::BoringBar)).map(|diameter| diameter / 2.0);
    let depth = |drill: &Cut<'_>| {
        let full = drill.full_depth(judged.nominal.diameter.unwrap_or(0.0)).unwrap_or(drill.tip);
        let wide_enough = |end: f64| Some(drill.tip - drill.point.length(end)?);
        end.and_then(wide_enough).map_or(full, |depth| depth.max(full))
    };
    // A narrower pilot leaves it metal to cut.
    let is_wide = |other: &&Cut<'_>| {
        let (own, limit) = (cut.pass.diameter, cut.kind.and_then(|kind| allowance(kind, cut.pass.diameter?)));
        let missing = own.zip(other.pass.diameter).map(|(own, other)| own - other);
        missing.zip(limit).is_none_or(|(missing, limit)| !exceeds(missing, limit))
    };
    let deepest = |cuts: &[Cut<'_>]| {
        let makes_hole = cuts.iter().filter(|other| !other.is_thread() && cut.follows(other)).filter(is_wide);
        makes_hole.map(depth).fold(0.0, f64::max)
    };
    let (drilled, slack) = (deepest(before), judged.comparison.tolerances.depth);
    let from_other_side = deepest(others);
    // Below the far side of the part there is nothing to drill.
    let radius = cut.pass.diameter.map_or(0.0, |own| own / 2.0);
    let thickness = judged.blank.body.map(|body| rim_thickness(&body, judged.nominal, radius));
    let is_out = thickness.is_some_and(|thickness| 0.0 < thickness && !exceeds(thickness, drilled));
    if is_out || judged.is_drilled_through(drilled, from_other_side) || !exceeds(cut.tip - drilled, slack) {
        return None;
    }
    let kind = cut.kind.map_or("tool", ToolKind::name);
    let message = format!(
        "hole {}: {} is a {kind} and goes {:.3} mm deep where {} are drilled before it",
        judged.id,
        cut.name(),
        cut.tip,
        drilled_depths(drilled, from_other_side)
    );
    let finding = Diagnostic::new(&TOOL_KIND, message).with_backtrace(cut.pass.backtrace.clone());
    Some(finding.help("drill before it, and deeper by the point of the drill"))
}

/// Reports a tap whose spindle doesn't reverse in a hole without features, or where another tap makes the thread; else the thread is
/// missing.
fn torn(judged: &Judgement<'_>, cut: &Cut<'_>) -> Option<Diagnostic> {
    let is_other_sound = || judged.near.iter().any(|other| other.is_thread() && !other.is_stuck_tap());
    let is_torn = cut.kind == Some(ToolKind::Tap)
        && !cut.pass.cut.is_tapping
        && (judged.nominal.features.is_empty() || is_other_sound());
    let message =
        format!("hole {}: {} is a tap, and the spindle does not reverse in the hole", judged.id, cut.name());
    let finding = Diagnostic::new(&TOOL_KIND, message).with_backtrace(cut.pass.backtrace.clone());
    is_torn.then(|| finding.help("tap with G84, or correct the kind of the tool in the machine file"))
}
