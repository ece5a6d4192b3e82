//! Core of each milled hole: a circle along the wall leaves one if the mill doesn't reach the axis.
use super::*;
use crate::findings::HOLE_CORE;

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    for (pair, _, drilled) in comparison.matched() {
        let Some(core) = drilled.core else { continue };
        let id = comparison.id(pair.nominal);
        let message =
            format!("hole {id} keeps a core of Φ{core:.3}: the mill goes round it and nothing removes it");
        let finding = Diagnostic::new(&HOLE_CORE, message)
            .help("drill the core first, or mill from the axis outwards")
            .with_backtrace(drilled.backtrace.clone());
        findings.add(Subject::Nominal(pair.nominal), finding);
    }
}
