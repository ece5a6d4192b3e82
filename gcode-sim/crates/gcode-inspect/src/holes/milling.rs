//! Feeds across the tool: the tool that mills, its spindle and its feed, where it cuts known metal.
use std::collections::BTreeSet;

use nalgebra::Point3;

use super::HoleExtractor;
use super::cutting::{CuttingState, PeckExtent};
use super::strokes::MIN_TOOL_COSINE;
use crate::findings::TOOL_KIND;
use crate::machine::tool_name;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, SpindleDirection};

/// Largest number of conditions under which a program mills; further ones are rates that change from block to block.
const MAX_CONDITIONS: usize = 10_000;

/// Conditions under which tools have milled: each is judged at its first block.
#[derive(Debug, Default)]
pub(super) struct MillingConditions(BTreeSet<MillingKey>);

/// State of the cut, selected tool and rate.
type MillingKey = ([u64; 4], Option<u32>, u64);

impl HoleExtractor<'_> {
    /// Checks the tool, its spindle and its rate in a feed that cuts metal across the tool.
    pub(super) fn check_milling(&mut self, event: &Event<'_>, path: &[Point3<f64>]) {
        let Some(rate) = event.kind.rate().filter(|_| self.metal.holes.is_some()) else { return };
        let state = CuttingState { tool: self.setup.tool, ..self.cutting_state };
        let is_stopped = state.spindle_direction == SpindleDirection::Off;
        let key = (state.key(), state.selected_tool, rate.0.to_bits());
        let is_known = MAX_CONDITIONS <= self.milling.0.len() || self.milling.0.contains(&key);
        let is_straight = path.len() == 2;
        let kind = state.tool.and_then(|number| self.machine.find_tool(number)?.kind);
        let wrong_kind = kind.filter(|kind| is_straight && kind.cuts_with_end());
        let is_done = is_known && !is_stopped && wrong_kind.is_none();
        if is_done || !path.windows(2).any(|chord| self.mills(&chord[0], &chord[1])) {
            return;
        }
        let backtrace = event.backtrace();
        // A full circle has its own finding.
        if is_stopped && is_straight {
            self.report_spindle_stopped(&backtrace, &state);
        }
        if let Some(kind) = wrong_kind {
            let name = tool_name(state.tool);
            self.findings.add_in_program(&TOOL_KIND, &backtrace, state.tool.unwrap_or(0), 1, |finding| {
                Diagnostic::new(finding, format!("{name} cuts sideways and is a {}", kind.name()))
                    .help("use an end mill, or correct the kind of the tool in the machine file")
            });
        }
        if !is_known {
            self.milling.0.insert(key);
            self.check_tool_changed(&backtrace, &state);
            self.cut_conditions.add(&backtrace, &state, false, [rate, rate], PeckExtent::default());
        }
    }

    /// Returns true if a feed across the tool cuts metal that is known.
    fn mills(&self, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let along = from - to;
        let Some(axis) = self.axis_in_motion(from, to) else { return false };
        axis.dot(&along).abs() < MIN_TOOL_COSINE * along.norm()
            && self.metal.is_touched(from, to, &axis, self.tool_radius().unwrap_or(0.0))
            && self.cuts_known_metal(from, to) == Some(true)
    }
}
