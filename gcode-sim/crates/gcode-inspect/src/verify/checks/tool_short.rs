//! Tools that cut deeper than they are long, as the machine file gives their length.
use super::*;
use crate::findings::TOOL_SHORT;
use gcode_lang::motion::Backtrace;

/// A cut deeper than its tool is long.
struct DeepCut<'a> {
    nominal: usize,
    depth: f64,
    backtrace: &'a Backtrace,
}

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let HoleInspection { comparison, machine, .. } = inspection;
    // A length of 0 means that the tip is programmed.
    let length = |tool: Option<u32>| machine.length_of(tool).filter(|length| 0.0 < *length);
    let mut deep_cuts: BTreeMap<u32, Vec<DeepCut<'_>>> = BTreeMap::new();
    for (pair, nominal, drilled) in comparison.matched() {
        let last = (drilled.tool, drilled.bottom(), &drilled.backtrace);
        let passes = drilled.earlier_passes.iter().map(|pass| (pass.tool, pass.cut.bottom, &pass.backtrace));
        for (tool, bottom, backtrace) in passes.chain([last]) {
            let depth = (Point3::from(nominal.entry) - bottom).dot(&Vector3::from(nominal.axis));
            if let (Some(number), Some(_)) = (tool, length(tool).filter(|length| *length < depth)) {
                let cut = DeepCut { nominal: pair.nominal, depth, backtrace };
                deep_cuts.entry(number).or_default().push(cut);
            }
        }
    }
    for (tool, cuts) in deep_cuts {
        let holes = cuts.chunk_by(|one, other| one.nominal == other.nominal).count();
        let deepest = cuts.iter().reduce(|best, cut| if best.depth < cut.depth { cut } else { best });
        let (Some(deepest), Some(length)) = (deepest, length(Some(tool))) else { continue };
        let more = if holes > 1 { format!(" (and in {} more holes)", holes - 1) } else { String::new() };
        let message = format!(
            "T{tool} is {length} mm long and goes {:.1} mm deep in hole {}{more}: the spindle would \
             enter the part",
            deepest.depth,
            comparison.id(deepest.nominal)
        );
        let finding = Diagnostic::new(&TOOL_SHORT, message)
            .help(
                "check that the length in the machine file runs from the spindle gauge line to the tip; \
                 otherwise use a longer tool",
            )
            .with_backtrace(deepest.backtrace.clone());
        findings.add(Subject::Nominal(deepest.nominal), finding);
    }
}
