//! Threads of nominal holes that a tool cuts away: only a tap, and a mill that goes along its helix, may enter them, and no
//! rapid.
use nalgebra::{Point3, Unit, Vector3};

use super::rapids::format_point;
use super::swept_tool::ring;
use super::{DrilledHole, HoleExtractor};
use crate::findings::{FEED_BESIDE_HOLE, RAPID_INTO_PART};
use crate::machine::{PointShape, ToolKind, tool_name};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event};
use gcode_lang::units::Deg;
use gcode_part::{NOISE, NominalAxis, NominalThread, PointTree, exceeds};

/// Largest depth of a cut in the flanks of a thread, mm.
const MAX_FLANK_CUT: f64 = 0.05;

/// Least distance of a tool that stands beside the axis of a hole, mm.
const MIN_ASIDE: f64 = 0.1;

/// Largest sine of the angle between the tool and a motion along it.
const MAX_AXIAL_SINE: f64 = 0.1;

/// Number of points round a thread.
const FLANK_POINTS: u32 = 8;

/// Angle from which on an arc makes a whole turn, in turns.
const WHOLE_TURN: f64 = 0.99;

/// Shares of a way that is in a shape from end to end, and of one that is nowhere in it.
const EVERYWHERE: [f64; 2] = [0.0, 1.0];
const NOWHERE: [f64; 2] = [1.0, 0.0];

/// Least way across an axis that counts, mm and mm².
const MIN_ACROSS: f64 = 1e-9;

/// Largest part of the pitch by which the lead of a mill's helix is another one.
const MAX_LEAD_SHARE: f64 = 0.2;

/// Largest distance of a mill's helix from the axis of the thread that it cuts, mm.
const MAX_OFF_AXIS: f64 = 0.5;

/// Largest distance of the bottom of a helix from the entry of its thread, mm.
const MAX_THREAD_LENGTH: f64 = 1000.0;

/// Number of level feeds into threads that are kept.
const MAX_FLANK_CUTS: usize = 10_000;

/// Level feed of a mill into the flanks of a thread: a fault, unless the mill also goes along the thread.
#[derive(Debug)]
pub(super) struct FlankCut {
    tool: Option<u32>,
    entry: Point3<f64>,
    pitch: f64,
    backtrace: Backtrace,
    message: String,
}

/// Returns for each cut whether its tool goes along the thread in one of the holes.
fn lead_ins(cuts: &[FlankCut], holes: &[DrilledHole]) -> Vec<bool> {
    let entries = PointTree::new(cuts.iter().map(|cut| cut.entry));
    let mut are_lead_ins = vec![false; cuts.len()];
    for pass in holes.iter().flat_map(DrilledHole::passes) {
        let Some(helix) = pass.cut.helix() else { continue };
        let bottom = pass.cut.bottom;
        let top = bottom + pass.axis.into_inner() * MAX_THREAD_LENGTH;
        let margin = Vector3::repeat(MAX_OFF_AXIS);
        entries.in_box(&(bottom.inf(&top) - margin), &(bottom.sup(&top) + margin), &mut |index| {
            let cut = &cuts[index];
            let is_here = pass.axis.cross(&(cut.entry - bottom)).norm() <= MAX_OFF_AXIS;
            let follows =
                cut.pitch == 0.0 || (helix.lead.abs() - cut.pitch).abs() <= MAX_LEAD_SHARE * cut.pitch;
            are_lead_ins[index] |= pass.tool == cut.tool && is_here && follows;
        });
    }
    are_lead_ins
}

impl HoleExtractor<'_> {
    /// Reports the level feeds into threads by mills that go along none.
    pub(super) fn report_flank_cuts(&mut self, holes: &[DrilledHole]) {
        let cuts = std::mem::take(&mut self.flank_cuts);
        if cuts.is_empty() {
            return;
        }
        let are_lead_ins = lead_ins(&cuts, holes);
        for (cut, _) in cuts.into_iter().zip(are_lead_ins).filter(|(_, is_lead_in)| !is_lead_in) {
            self.findings.add(&FEED_BESIDE_HOLE, &cut.backtrace, 3, |finding| {
                Diagnostic::new(finding, cut.message)
                    .help("keep the mill's edge within the hole before the thread; only a feed along the helix enters it")
            });
        }
    }

    /// Records a level feed of a flat tool whose edge enters the flanks of a thread.
    fn record_flank_cut(
        &mut self,
        event: &Event<'_>,
        path: &[Point3<f64>],
        axis: &Unit<Vector3<f64>>,
        diameter: f64,
    ) {
        let tool = self.setup.tool;
        let is_flat =
            matches!(self.machine.kind_of(tool), None | Some(ToolKind::EndMill | ToolKind::Counterbore));
        let is_pointed = matches!(self.machine.point_of(tool), PointShape::Pointed(_));
        let [Some(from), Some(to)] = [path.first(), path.last()] else { return };
        if !is_flat || is_pointed {
            return;
        }
        let axes = self.strokes.nominal_axes();
        let found = [to, from].into_iter().find_map(|end| axes.threaded([end, end], axis));
        let Some((hole, thread, _)) = found else { return };
        let depth = (hole.entry - to).dot(&hole.out);
        let is_within =
            exceeds(depth - thread.span[0], MAX_FLANK_CUT) && !exceeds(depth - thread.span[1], MAX_FLANK_CUT);
        if !is_within {
            return;
        }
        let radius = diameter / 2.0;
        let mut aside = f64::NEG_INFINITY;
        for chord in path.windows(2) {
            for [begin, end] in in_flanks([&chord[0], &chord[1]], hole, thread, radius) {
                for share in [begin, end] {
                    aside = aside.max(split(&(chord[0] + (chord[1] - chord[0]) * share), hole).0.norm());
                }
            }
        }
        if !exceeds(aside + radius - thread.core, MAX_FLANK_CUT) {
            return;
        }
        let message = format!(
            "{} goes up to {aside:.3} mm beside the axis, {depth:.3} mm deep, and cuts {:.3} mm into the thread: the hole \
             before the thread is Φ{:.3}",
            tool_name(tool),
            aside + radius - thread.core,
            2.0 * thread.core,
        );
        let (entry, pitch, backtrace) = (hole.entry, thread.pitch, event.backtrace());
        if self.flank_cuts.len() < MAX_FLANK_CUTS {
            self.flank_cuts.push(FlankCut { tool, entry, pitch, backtrace, message });
        }
    }

    /// Reports a motion through points beside the axis of a threaded hole that furrows its flanks. It goes more than a turn farther
    /// along the axis than the thread on the same way round.
    pub(super) fn check_thread_wall(&mut self, event: &Event<'_>, path: &[Point3<f64>]) {
        if !self.strokes.nominal_axes().has_threads() {
            return;
        }
        let [Some(from), Some(to)] = [path.first(), path.last()] else { return };
        let (Some(axis), Some(diameter)) = (self.pose.axis, self.machine.diameter_of(self.setup.tool)) else {
            return;
        };
        let travel = to - from;
        let is_tap = self.machine.kind_of(self.setup.tool) == Some(ToolKind::Tap);
        let is_level = travel.dot(&axis).abs() <= MAX_FLANK_CUT;
        if is_tap || self.cutting_state.rigid_run != 0 {
            return;
        }
        if is_level {
            return self.record_flank_cut(event, path, &axis, diameter);
        }
        let is_along = path.len() == 2 && axis.cross(&travel).norm() <= MAX_AXIAL_SINE * travel.norm();
        let (upper, lower) = if travel.dot(&axis) < 0.0 { (from, to) } else { (to, from) };
        // The end of a slant that is nearer to the axis shows the hole.
        let ends = if is_along { vec![[upper, lower]] } else { vec![[to, to], [from, from]] };
        let axes = self.strokes.nominal_axes();
        let Some((hole, thread, _)) = ends.into_iter().find_map(|ends| axes.threaded(ends, &axis)) else {
            return;
        };
        let radius = diameter / 2.0;
        let Some(furrow) = Furrow::longest(path, hole, thread, radius) else { return };
        let (place, core) = (hole.entry - hole.out * furrow.bottom, 2.0 * thread.core);
        let (tool, aside, length) = (tool_name(self.setup.tool), furrow.aside, furrow.length);
        let verb = if is_along { "goes along the axis" } else { "goes down or up along the axis up to" };
        self.findings.add(&FEED_BESIDE_HOLE, &event.backtrace(), 2, |finding| {
            let message = format!(
                "{tool} {verb} {aside:.3} mm beside it and cuts {:.3} mm deep into the thread, {length:.3} mm long, down \
                 to {}: the hole before the thread is Φ{core:.3}",
                aside + radius - core / 2.0,
                format_point(&place),
            );
            Diagnostic::new(finding, message)
                .help("lead the mill to the axis of the hole before it goes down or up")
        });
    }

    /// Returns true if the metal of the flanks is solid half way down to a depth: nothing has cut the thread yet, and a rapid is
    /// compared with the metal.
    fn is_unthreaded(&self, hole: &NominalAxis, thread: &NominalThread, depth: f64) -> bool {
        let middle = hole.entry - hole.out * f64::midpoint(thread.span[0], depth);
        let out = Unit::new_normalize(hole.out);
        let offsets = ring(&out, &Vector3::zeros(), thread.major - MAX_FLANK_CUT, FLANK_POINTS);
        offsets.iter().map(|offset| middle + offset).all(|point| self.metal.uncut(&[point, point]).is_some())
    }

    /// Reports a rapid away from the axis of a threaded hole, or down along it, whose edge enters the flanks; returns true if it
    /// does.
    pub(super) fn check_rapid_into_thread(&mut self, event: &Event<'_>, from: &Point3<f64>) -> bool {
        if !self.strokes.nominal_axes().has_threads() {
            return false;
        }
        let to = self.pose.tip;
        let (Some(axis), Some(diameter)) = (self.pose.axis, self.machine.diameter_of(self.setup.tool)) else {
            return false;
        };
        let Some((hole, thread, aside)) = self.strokes.nominal_axes().threaded([&to, &to], &axis) else {
            return false;
        };
        let spoke = from - hole.entry;
        let before = (spoke - hole.out * spoke.dot(&hole.out)).norm();
        let depth = (hole.entry - to).dot(&hole.out).min(thread.span[1]);
        let point = self.machine.point_of(self.setup.tool).length(diameter).unwrap_or(diameter / 2.0);
        // A point is as wide as its height there, where the thread begins.
        let height = (depth - thread.span[0]).max(0.0);
        let width = if height < point { diameter * height / point } else { diameter };
        let goes_aside = exceeds(aside - before, MAX_FLANK_CUT);
        let goes_down =
            !self.metal.is_point_in_pocket(&to) && exceeds((from - to).dot(&hole.out), MAX_FLANK_CUT);
        let reach = aside + if goes_aside { diameter } else { width } / 2.0;
        if !(goes_aside || goes_down)
            || !exceeds(height, MAX_FLANK_CUT)
            || !exceeds(reach - thread.core, MAX_FLANK_CUT)
            || exceeds(reach - thread.major, MAX_FLANK_CUT)
            || self.is_unthreaded(hole, thread, depth)
        {
            return false;
        }
        let (tool, core) = (tool_name(self.setup.tool), 2.0 * thread.core);
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |finding| {
            let message = format!(
                "{tool} enters the thread {:.3} mm deep in a rapid, at {}: the hole before the thread is Φ{core:.3}",
                reach - core / 2.0,
                format_point(&to),
            );
            Diagnostic::new(finding, message).help("only a feed along the helix, or of a tap, may enter the thread")
        });
        true
    }
}

/// Stretch of a path on which the edge of a tool is in the flanks of a thread, mm.
#[derive(Clone, Copy, Debug, Default)]
struct Furrow {
    /// Height along the axis, positive downwards while the path is followed.
    height: f64,
    /// Angle about the axis, in turns.
    turns: f64,
    /// Largest distance of the tool from the axis.
    aside: f64,
    /// Largest depth.
    bottom: f64,
    /// Height besides that of the thread.
    length: f64,
}

impl Furrow {
    /// Returns the longest furrow of a path that is longer than a turn of the thread; `None` without one. A whole turn is judged by
    /// its lead.
    fn longest(
        path: &[Point3<f64>],
        hole: &NominalAxis,
        thread: &NominalThread,
        radius: f64,
    ) -> Option<Self> {
        let turn = thread.pitch.max(MAX_FLANK_CUT);
        let mut longest: Option<Self> = None;
        let mut current = Self::default();
        let mut end_furrow = |furrow: Self| {
            let length = furrow.height.abs() - thread.pitch * furrow.turns.abs();
            let is_long = turn < length && furrow.turns.abs() < WHOLE_TURN;
            if is_long && longest.is_none_or(|longest| longest.length < length) {
                longest = Some(Self { length, ..furrow });
            }
        };
        for chord in path.windows(2) {
            let mut last = 0.0;
            for [begin, end] in in_flanks([&chord[0], &chord[1]], hole, thread, radius) {
                if last < begin {
                    end_furrow(std::mem::take(&mut current));
                }
                current.add([begin, end].map(|share| chord[0] + (chord[1] - chord[0]) * share), hole);
                last = end;
            }
            if last < 1.0 {
                end_furrow(std::mem::take(&mut current));
            }
        }
        end_furrow(current);
        longest
    }

    /// Adds a straight stretch.
    fn add(&mut self, ends: [Point3<f64>; 2], hole: &NominalAxis) {
        let [(one, from), (other, to)] = ends.map(|end| split(&end, hole));
        let angle = Deg::atan2(hole.out.dot(&one.cross(&other)), one.dot(&other));
        *self = Self {
            height: self.height + (to - from),
            turns: self.turns + angle.0 / 360.0,
            aside: self.aside.max(one.norm()).max(other.norm()),
            bottom: self.bottom.max(from).max(to),
            length: 0.0,
        };
    }
}

/// Returns where a point is beside the axis of a hole, and its depth.
fn split(p: &Point3<f64>, hole: &NominalAxis) -> (Vector3<f64>, f64) {
    let spoke = p - hole.entry;
    let height = spoke.dot(&hole.out);
    (spoke - hole.out * height, -height)
}

/// Returns the shares of a straight way on which the edge of a tool is in the flanks of a thread, in their order: at most two.
fn in_flanks(
    [from, to]: [&Point3<f64>; 2],
    hole: &NominalAxis,
    thread: &NominalThread,
    radius: f64,
) -> impl Iterator<Item = [f64; 2]> {
    let ((start, top), (end, bottom)) = (split(from, hole), split(to, hole));
    let across = end - start;
    // The way is inside a circle between the roots of a² t² + 2 b t + c.
    let within = |radius: f64| {
        let (a, b, c) = (across.norm_squared(), start.dot(&across), start.norm_squared() - radius * radius);
        let square = b * b - a * c;
        if radius < 0.0 || square < 0.0 || a <= MIN_ACROSS && 0.0 < c {
            return NOWHERE;
        }
        if a <= MIN_ACROSS {
            EVERYWHERE
        } else {
            [-libm::sqrt(square), libm::sqrt(square)].map(|root| (root - b) / a)
        }
    };
    let by = bottom - top;
    let [mut low, mut high] = match by.abs() <= MIN_ACROSS {
        true if thread.span[0] <= top && top <= thread.span[1] => EVERYWHERE,
        true => NOWHERE,
        false => {
            let shares = thread.span.map(|depth| (depth - top) / by);
            [shares[0].min(shares[1]), shares[0].max(shares[1])]
        }
    };
    let outer = within(thread.major - radius + MAX_FLANK_CUT + NOISE);
    let inner = within((thread.core - radius + MAX_FLANK_CUT + NOISE).max(MIN_ASIDE));
    (low, high) = (low.max(outer[0]).max(0.0), high.min(outer[1]).min(1.0));
    let pieces = match inner[0] < inner[1] {
        true => [[low, high.min(inner[0])], [low.max(inner[1]), high]],
        false => [[low, high], NOWHERE],
    };
    pieces.into_iter().filter(|[begin, end]| begin < end)
}
