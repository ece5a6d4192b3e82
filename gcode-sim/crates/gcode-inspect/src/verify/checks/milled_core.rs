//! Core of each milled hole: a circle along the wall leaves one if the mill doesn't reach the axis, and one through the far side
//! cuts it loose while the mill still goes round it.
use super::*;
use crate::findings::HOLE_CORE;
use crate::holes::ToolPass;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, _, drilled) in comparison.matched() {
        let core = |pass: ToolPass<'_>| Some((pass.cut.milled?.core?, pass.backtrace.clone()));
        let cores = drilled.passes().filter_map(core);
        let Some((core, backtrace)) = cores.max_by(|(a, _), (b, _)| a.total_cmp(b)) else { continue };
        let message = format!(
            "hole {}: the mill goes round a core of Φ{core:.3} and leaves it or cuts it loose",
            comparison.id(pair.nominal)
        );
        let finding = Diagnostic::new(&HOLE_CORE, message)
            .with_backtrace(backtrace)
            .help("drill the core first, or mill from the axis outwards");
        findings.add(Subject::Nominal(pair.nominal), finding);
    }
}
