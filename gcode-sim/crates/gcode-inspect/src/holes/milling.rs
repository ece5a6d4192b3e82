//! Feeds across the tool: the tool that mills, its spindle and its feed, where it cuts known metal.
use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::below_part::lowest;
use super::cone_end::AssumedCone;
use super::cutting::{CuttingState, PeckExtent, RecordedCut};
use super::feed_law::is_along;
use super::strip::Line;
use super::strokes::MIN_TOOL_COSINE;
use crate::findings::{TOOL_CUTS_NOTHING, TOOL_KIND};
use crate::machine::{TOUCH_DEPTH, ToolKind, tool_name};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event, LengthCompensation, SpindleDirection};
use gcode_lang::units::MmPerMin;

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
    /// First feed across of each tool that has met no metal so far with a length offset; `None` once it has cut with it.
    idle: BTreeMap<(u32, LengthCompensation), Option<Backtrace>>,
    /// First feed across of each tool that cuts with its end, beside the metal and below its top.
    fed_aside: BTreeMap<u32, Backtrace>,
    /// Tools of unknown diameter that mill the part.
    pub(super) unsized_tools: Vec<Option<u32>>,
    /// Tools of unknown end that count as cones.
    pub(super) cones: BTreeMap<u32, AssumedCone>,
}

impl Milling {
    /// Records that a tool cuts.
    pub(super) fn record_cut(&mut self, state: &CuttingState) {
        self.idle.extend(state.tool.map(|tool| ((tool, state.compensation), None)));
    }

    /// Records that a feed of a tool meets no metal.
    pub(super) fn record_idle(&mut self, event: &Event<'_>, state: &CuttingState) {
        if let Some(tool) = state.tool {
            self.idle.entry((tool, state.compensation)).or_insert_with(|| Some(event.backtrace()));
        }
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
    /// Returns the state in which the tool in the spindle would cut.
    pub(super) fn tool_state(&self) -> CuttingState {
        CuttingState { tool: self.setup.tool, ..self.cutting_state }
    }

    /// Checks the tool, its spindle and its rate in a feed that cuts metal across the tool. `path` are its points, none while an
    /// axis rotates; `mills` tells whether it cuts metal.
    pub(super) fn check_milling(
        &mut self,
        event: &Event<'_>,
        rate: MmPerMin,
        path: &[Point3<f64>],
        mills: impl FnOnce(&Self) -> bool,
    ) {
        if self.metal.holes.is_none() {
            return;
        }
        let state = self.tool_state();
        let is_stopped = state.spindle_direction == SpindleDirection::Off;
        let key = (state.key(), state.selected_tool);
        let range = self.milling.rates.get(&key).copied();
        let is_known = range.is_some_and(|[least, most]| least <= rate.0 && rate.0 <= most);
        let wrong_kind = self.machine.kind_of(state.tool).filter(|kind| kind.cuts_with_end());
        let is_done = is_known && !is_stopped && wrong_kind.is_none();
        if is_done {
            return;
        }
        if self.milling.is_known_clear(&key, path) {
            return;
        }
        if !mills(self) {
            self.milling.clear = (2 < path.len()).then(|| (key, path.to_vec()));
            if let Ok(line) = <&Line>::try_from(path) {
                self.record_idle_feed(event, line, &state);
            }
            return;
        }
        self.milling.record_cut(&state);
        let backtrace = event.backtrace();
        if is_stopped {
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
            self.check_tool_changed(&backtrace, &state, "cuts");
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

    /// Records a straight feed across a turning tool that meets no metal of a known body.
    fn record_idle_feed(&mut self, event: &Event<'_>, [from, to]: &Line, state: &CuttingState) {
        let Some(axis) = self.pose.axis.filter(|axis| is_across(axis, &(to - from))) else { return };
        let Some(body) = self.surface.filter(|_| state.spindle_direction != SpindleDirection::Off) else {
            return;
        };
        let is_other = state.selected_tool != state.tool;
        if is_other && self.check_tool_changed(&event.backtrace(), state, "is fed across") {
            return;
        }
        let Some(tool) = state.tool.filter(|_| self.tool_radius().is_some()) else { return };
        let kind = self.machine.kind_of(state.tool);
        if kind.is_some_and(ToolKind::cuts_with_end)
            && to.coords.dot(&axis) + TOUCH_DEPTH < -lowest(&body, &-axis)
        {
            self.milling.fed_aside.entry(tool).or_insert_with(|| event.backtrace());
        }
        self.milling.record_idle(event, state);
    }

    /// Reports the tools whose feeds all miss the metal, and those that follow a mill's path beside it.
    pub(super) fn report_idle_mills(&mut self) {
        let feeds = std::mem::take(&mut self.milling.idle);
        let cuts = |tool: u32| feeds.iter().any(|((one, _), idle)| *one == tool && idle.is_none());
        // A second pass with the same offset may have nothing left to cut.
        let idle: Vec<_> = feeds
            .iter()
            .filter_map(|((tool, offset), idle)| Some((*tool, cuts(*tool).then_some(*offset), idle.clone()?)))
            .collect();
        let mut fed_aside = std::mem::take(&mut self.milling.fed_aside);
        fed_aside.retain(|tool, _| idle.iter().all(|(one, ..)| one != tool));
        for (tool, backtrace) in fed_aside {
            self.findings.add_in_program(&TOOL_CUTS_NOTHING, &backtrace, tool, 1, |kind| {
                let own = self.machine.kind_of(Some(tool)).map_or("tool", |kind| kind.name());
                let name = tool_name(Some(tool));
                let message =
                    format!("{name} is a {own} and is fed across beside the part, where it cuts nothing");
                Diagnostic::new(kind, message).help("check T and M06 before it, its H and its kind")
            });
        }
        for (tool, offset, backtrace) in idle {
            self.findings.add_in_program(&TOOL_CUTS_NOTHING, &backtrace, tool, 1, |kind| {
                let with = match offset {
                    Some(LengthCompensation::Off) => " without a length offset".to_owned(),
                    Some(LengthCompensation::Plus(h)) => format!(" with H{h}"),
                    Some(LengthCompensation::Minus(h)) => format!(" with G44 H{h}"),
                    None => String::new(),
                };
                let name = tool_name(Some(tool));
                let message = format!("{name}{with} cuts nothing: all its feeds miss the metal of the part");
                Diagnostic::new(kind, message)
                    .help("check T and M06 before it, its H, the sign of Z and the stock")
            });
        }
    }

    /// Returns true if a feed across the tool, or one that rises beside it, cuts metal that is known. One that falls beside it is a
    /// stroke.
    pub(super) fn mills(&self, [from, to]: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        let along = to - from;
        let rises_aside = 0.0 < axis.dot(&along) && !is_along(axis, &along);
        (rises_aside || is_across(axis, &along))
            && self.metal.is_touched(from, to, axis, self.tool_radius().unwrap_or(0.0))
            && self.cuts_known_metal(from, to) == Some(true)
    }
}

/// Returns true if a feed leads across the tool, not along it.
fn is_across(axis: &Unit<Vector3<f64>>, along: &Vector3<f64>) -> bool {
    axis.dot(along).abs() < MIN_TOOL_COSINE * along.norm()
}
