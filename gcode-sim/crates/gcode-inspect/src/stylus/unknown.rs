//! Readings and touches while the position of an axis is unknown.
use std::collections::BTreeMap;

use crate::holes::unknown_position_finding;
use crate::machine::Machine;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, UnknownAxes};

/// First finding for each combination of unknown axes.
#[derive(Debug, Default)]
pub(super) struct UnknownPositions(BTreeMap<UnknownAxes, Diagnostic>);

impl UnknownPositions {
    /// Reports a measurement with axes of unknown position; `measurement` is a clause, as in `the part is touched`.
    pub(super) fn report(
        &mut self,
        machine: &Machine,
        event: &Event<'_>,
        axes: UnknownAxes,
        measurement: &str,
    ) {
        if !axes.is_none() {
            self.0.entry(axes).or_insert_with(|| {
                unknown_position_finding(&machine.axes, axes, measurement).with_backtrace(event.backtrace())
            });
        }
    }

    pub(super) fn finish(self) -> impl Iterator<Item = Diagnostic> {
        self.0.into_values()
    }
}
