//! Feeds across the tool: the tool that mills, its spindle and its feed, where it cuts known metal.
use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::cutting::{CuttingState, PeckExtent, RecordedCut};
use super::strokes::MIN_TOOL_COSINE;
use crate::findings::{TOOL_CUTS_NOTHING, TOOL_KIND};
use crate::machine::{TOUCH_DEPTH, tool_name};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event, SpindleDirection};

/// State of a cut, and the selected tool.
type MillingKey = ([u64; 4], Option<u32>);

/// Feeds of mills so far.
#[derive(Debug, Default)]
pub(super) struct Milling {
    /// Slowest and fastest rate at which tools have milled in each state of the cut with each selected tool. A rate is judged at
    /// its block unless it lies between them.
    rates: BTreeMap<MillingKey, [f64; 2]>,
    /// Path of the last feed across that was searched and met no metal, with its state.
    clear: Option<(MillingKey, Vec<Point3<f64>>)>,
    /// First feed across of each tool that has met no metal so far; `None` once it has cut.
    idle: BTreeMap<Option<u32>, Option<Backtrace>>,
}

impl Milling {
    /// Records that a tool cuts.
    pub(super) fn record_cut(&mut self, tool: Option<u32>) {
        self.idle.insert(tool, None);
    }

    /// Returns true if a path is beside one that met no metal by no more than a thickness that counts as none.
    fn is_known_clear(&self, key: &MillingKey, path: &[Point3<f64>]) -> bool {
        self.clear.as_ref().is_some_and(|(state, known)| {
            let is_near = |(one, other): (&Point3<f64>, &Point3<f64>)| (one - other).norm() <= TOUCH_DEPTH;
            state == key && known.len() == path.len() && known.iter().zip(path).all(is_near)
        })
    }
}

impl HoleExtractor<'_> {
    /// Checks the tool, its spindle and its rate in a feed that cuts metal across the tool.
    pub(super) fn check_milling(&mut self, event: &Event<'_>, path: &[Point3<f64>]) {
        let Some(rate) = event.kind.rate().filter(|_| self.metal.holes.is_some()) else { return };
        let state = CuttingState { tool: self.setup.tool, ..self.cutting_state };
        let is_stopped = state.spindle_direction == SpindleDirection::Off;
        let key = (state.key(), state.selected_tool);
        let range = self.milling.rates.get(&key).copied();
        let is_known = range.is_some_and(|[least, most]| least <= rate.0 && rate.0 <= most);
        let is_straight = path.len() == 2;
        let kind = self.machine.kind_of(state.tool);
        let wrong_kind = kind.filter(|kind| is_straight && kind.cuts_with_end());
        let is_done = is_known && !is_stopped && wrong_kind.is_none();
        if is_done {
            return;
        }
        if self.milling.is_known_clear(&key, path) {
            return;
        }
        if !path.windows(2).any(|chord| self.mills(&chord[0], &chord[1])) {
            self.milling.clear = (2 < path.len()).then(|| (key, path.to_vec()));
            self.record_idle_feed(event, path, &state);
            return;
        }
        self.milling.record_cut(state.tool);
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
            self.milling.rates.insert(key, [least.min(rate.0), most.max(rate.0)]);
            self.check_tool_changed(&backtrace, &state);
            self.cut_conditions.add(RecordedCut {
                backtrace: &backtrace,
                state: &state,
                is_tapping: false,
                feeds: ([rate, rate], [(rate, state.speed); 2]),
                pecks: PeckExtent::default(),
                offset_origin: self.offset_origin.as_ref(),
            });
        }
    }

    /// Records a straight feed across a turning tool of known diameter that meets no metal of a known body.
    fn record_idle_feed(&mut self, event: &Event<'_>, path: &[Point3<f64>], state: &CuttingState) {
        let [from, to] = path else { return };
        let is_across = self.pose.axis.is_some_and(|axis| is_across(&axis, &(to - from)));
        let is_known = self.surface.is_some() && self.tool_radius().is_some();
        if is_across && is_known && state.spindle_direction != SpindleDirection::Off {
            self.milling.idle.entry(state.tool).or_insert_with(|| Some(event.backtrace()));
        }
    }

    /// Reports the tools whose feeds all miss the metal.
    pub(super) fn report_idle_mills(&mut self) {
        let idle = std::mem::take(&mut self.milling.idle).into_iter();
        for (tool, backtrace) in idle.filter_map(|(tool, first)| Some((tool, first?))) {
            self.findings.add_in_program(&TOOL_CUTS_NOTHING, &backtrace, tool.unwrap_or(0), 1, |kind| {
                let name = tool_name(tool);
                Diagnostic::new(
                    kind,
                    format!("{name} cuts nothing: all its feeds miss the metal of the part"),
                )
                .help("check T and M06 before it, its H, the sign of Z and the stock")
            });
        }
    }

    /// Returns true if a feed across the tool cuts metal that is known.
    fn mills(&self, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let Some(axis) = self.axis_in_motion(from, to) else { return false };
        is_across(&axis, &(to - from))
            && self.metal.is_touched(from, to, &axis, self.tool_radius().unwrap_or(0.0))
            && self.cuts_known_metal(from, to) == Some(true)
    }
}

/// Returns true if a feed leads across the tool, not along it.
fn is_across(axis: &Unit<Vector3<f64>>, along: &Vector3<f64>) -> bool {
    axis.dot(along).abs() < MIN_TOOL_COSINE * along.norm()
}
