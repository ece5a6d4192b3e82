//! A feed while the spindle stands, of a drill and of a grinder's wheel alike.
use crate::diag::{Diagnostic, Severity};

/// The finding: nothing is cut so. It is a warning where an M code went to the machine builder's logic before, `builder`,
/// for that may be what starts the spindle.
pub(crate) fn stopped(message: &str, builder: Option<u32>) -> Diagnostic {
    let severity = if builder.is_some() { Severity::Warning } else { Severity::Error };
    let finding = Diagnostic::new(severity, "spindle-stopped", message);
    builder.into_iter().fold(finding, |finding, code| {
        finding.note(format!(
            "M{code:02} goes to the machine builder's logic, which may have started it: that isn't simulated"
        ))
    })
}
