//! Tools that cut nothing in any of their holes: other tools have removed all of it before, as in the wrong order.
use super::*;
use crate::findings::TOOL_CUTS_NOTHING;
use crate::machine::ToolKind;
use crate::verify::hole_cuts::Cut;
use gcode_lang::motion::Backtrace;

/// What is known of a tool so far.
enum Work<'a> {
    Cuts,
    /// It has cut nothing, first here, in this many holes.
    Nothing {
        first: &'a Backtrace,
        id: &'a str,
        holes: usize,
    },
}

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, .. } = inspection;
    let mut tools: BTreeMap<u32, Work<'_>> = BTreeMap::new();
    for (pair, nominal, drilled) in comparison.matched() {
        let is_open = |tool: Option<u32>| tool.is_some_and(|t| !matches!(tools.get(&t), Some(Work::Cuts)));
        if !drilled.passes().any(|pass| is_open(pass.tool)) {
            continue;
        }
        let cuts = Cut::all(nominal, drilled, machine);
        let floor = if nominal.through { nominal.depth } else { f64::INFINITY };
        let mut judged = BTreeSet::new();
        for (index, cut) in cuts.iter().enumerate() {
            let Some(number) = cut.pass.tool else { continue };
            if is_idle(cut, &cuts[..index], floor) {
                if !judged.insert(number) {
                    continue;
                }
                let first =
                    Work::Nothing { first: cut.pass.backtrace, id: comparison.id(pair.nominal), holes: 0 };
                if let Work::Nothing { holes, .. } = tools.entry(number).or_insert(first) {
                    *holes += 1;
                }
            } else {
                tools.insert(number, Work::Cuts);
            }
        }
    }
    for (number, work) in tools {
        let Work::Nothing { first, id, holes } = work else { continue };
        let place = if holes == 1 { format!("hole {id}") } else { format!("{holes} holes, first in {id}") };
        let message =
            format!("T{number} cuts nothing in {place}: all that it would cut is removed before it comes");
        let finding = Diagnostic::new(&TOOL_CUTS_NOTHING, message)
            .with_backtrace(first.clone())
            .help("check the order of the tools, and their diameters in the machine file");
        findings.add(Subject::Motion, finding);
    }
}

/// Returns true if other tools have removed all that a stroke would cut above `floor`. Offsets in the control may leave a mill
/// metal that the program doesn't show.
fn is_idle(cut: &Cut<'_>, before: &[Cut<'_>], floor: f64) -> bool {
    if cut.is_circle() || cut.is_thread() || cut.kind.is_none_or(|kind| kind == ToolKind::EndMill) {
        return false;
    }
    let Some(own) = cut.shape() else { return false };
    let others = before.iter().filter(|other| other.pass.tool != cut.pass.tool && !other.is_thread());
    let mut shapes = others.filter_map(Cut::shape);
    shapes.any(|other| other.covers(&own, floor))
}
