//! Feeds across the tool: the tool that mills, its spindle and its feed, where it cuts known metal.
use std::collections::BTreeMap;

use nalgebra::Point3;

use super::HoleExtractor;
use super::cutting::{CuttingState, PeckExtent};
use super::strokes::MIN_TOOL_COSINE;
use crate::findings::TOOL_KIND;
use crate::machine::tool_name;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Event, SpindleDirection};

/// Slowest and fastest rate at which tools have milled in each state of the cut with each selected tool. A rate is judged at
/// its block unless it lies between them.
#[derive(Debug, Default)]
pub(super) struct MillingRates(BTreeMap<([u64; 4], Option<u32>), [f64; 2]>);

impl HoleExtractor<'_> {
    /// Checks the tool, its spindle and its rate in a feed that cuts metal across the tool.
    pub(super) fn check_milling(&mut self, event: &Event<'_>, path: &[Point3<f64>]) {
        let Some(rate) = event.kind.rate().filter(|_| self.metal.holes.is_some()) else { return };
        let state = CuttingState { tool: self.setup.tool, ..self.cutting_state };
        let is_stopped = state.spindle_direction == SpindleDirection::Off;
        let key = (state.key(), state.selected_tool);
        let range = self.milling.0.get(&key).copied();
        let is_known = range.is_some_and(|[least, most]| least <= rate.0 && rate.0 <= most);
        let is_straight = path.len() == 2;
        let kind = self.machine.kind_of(state.tool);
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
            let [least, most] = range.unwrap_or([rate.0; 2]);
            self.milling.0.insert(key, [least.min(rate.0), most.max(rate.0)]);
            self.check_tool_changed(&backtrace, &state);
            let feeds = ([rate, rate], [(rate, state.speed); 2]);
            let origin = self.offset_origin.as_ref();
            self.cut_conditions.add(&backtrace, &state, false, feeds, PeckExtent::default(), origin);
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
