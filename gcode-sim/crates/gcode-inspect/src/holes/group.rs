//! Passes → holes: all passes on one line, of one tool or several, make one hole.
use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use super::drill_pass::{DrillPass, PassCut};
use super::swallowed::swallowing_passes;
use crate::machine::{Machine, ToolKind};
use gcode_lang::motion::{Backtrace, Position, UnknownAxes};
use gcode_lang::source::Span;
use gcode_part::{Hole, NominalAxes, Origin, PARALLEL_COSINE, PointTree, clusters};

/// Largest distance between the lines of two passes of one hole, mm.
pub(crate) const MAX_LINE_OFFSET: f64 = 0.5;

/// Largest distance between the lines of two passes of one tool in one hole, mm: the rounding of a rotary axis to 0.01°, at
/// 1 m from its centre.
const MAX_REPEAT_OFFSET: f64 = 0.1;

/// Least additional depth at which a pass of the same tool cuts, mm.
const MIN_DEPTH_GAIN: f64 = 0.001;

/// A pass of a drilled hole.
#[derive(Clone, Copy, Debug)]
pub struct ToolPass<'a> {
    /// Tool; `None` before the first tool change.
    pub tool: Option<u32>,
    /// Diameter, mm; `None` if unknown.
    pub diameter: Option<f64>,
    /// Direction out of the part.
    pub axis: Unit<Vector3<f64>>,
    /// Extent, feed and spindle.
    pub cut: PassCut,
    /// Block of the pass.
    pub backtrace: &'a Backtrace,
}

/// A hole that the program drills, in the part's frame; lengths in mm.
#[derive(Clone, Debug)]
pub struct DrilledHole {
    /// Point of the axis at which the cutting feed of the finishing tool begins; of a milled hole, the highest feed of any
    /// tool.
    pub entry: Point3<f64>,
    /// Direction out of the part.
    pub axis: Unit<Vector3<f64>>,
    /// Distance from the entry to the deepest point of any tool.
    pub depth: f64,
    /// Diameter of the finishing tool; `None` if the tool table lacks it.
    pub diameter: Option<f64>,
    /// Finishing tool; `None` before the first tool change.
    pub tool: Option<u32>,
    /// Block of the finishing pass.
    pub backtrace: Backtrace,
    /// Position of the axes at the bottom.
    pub axis_position: Position,
    /// False if the axis is that of the finishing feed, since the direction of the tool is unknown.
    pub is_tool_axis_known: bool,
    /// Extent, feed and spindle of the finishing pass.
    pub finishing_cut: PassCut,
    /// Passes other than the finishing one, in the order of the program.
    pub earlier_passes: Vec<EarlierPass>,
    /// Number of these passes that the program makes before the finishing one.
    pub finishing_index: usize,
    /// Axes of unknown position on the part in any pass.
    pub unknown_axes: UnknownAxes,
    /// Point at which the first pass meets metal on the axis, or at the wall where the axis is empty; `None` without a known
    /// body there.
    pub surface: Option<Point3<f64>>,
    /// Index in the list of the first hole on this line. A later one with the same index is this hole drilled again by a
    /// tool that has cut it before.
    pub first_on_line: usize,
}

/// A pass of a hole besides the finishing one.
#[derive(Clone, Debug)]
pub struct EarlierPass {
    /// Extent, feed and spindle.
    pub cut: PassCut,
    /// Direction out of the part.
    pub axis: Unit<Vector3<f64>>,
    /// Tool; `None` before the first tool change.
    pub tool: Option<u32>,
    /// Diameter of the tool, mm; `None` if the tool table lacks it.
    pub diameter: Option<f64>,
    /// Block of the pass.
    pub backtrace: Backtrace,
    /// Position of the axes at the bottom.
    pub axis_position: Position,
}

impl EarlierPass {
    fn tool_pass(&self) -> ToolPass<'_> {
        let Self { cut, axis, tool, diameter, .. } = *self;
        ToolPass { tool, diameter, axis, cut, backtrace: &self.backtrace }
    }
}

impl DrilledHole {
    /// Returns all passes in the order of the program.
    pub fn passes(&self) -> impl Iterator<Item = ToolPass<'_>> {
        let finishing = ToolPass {
            tool: self.tool,
            diameter: self.diameter,
            axis: self.axis,
            cut: self.finishing_cut,
            backtrace: &self.backtrace,
        };
        let (before, after) =
            self.earlier_passes.split_at(self.finishing_index.min(self.earlier_passes.len()));
        before
            .iter()
            .map(EarlierPass::tool_pass)
            .chain([finishing])
            .chain(after.iter().map(EarlierPass::tool_pass))
    }

    /// Returns the deepest point of any tool, on the hole's axis.
    pub fn bottom(&self) -> Point3<f64> {
        self.entry - self.axis.into_inner() * self.depth
    }

    /// Returns the hole in the schema of references, without an id; `locate` names the program and line of a block.
    pub fn hole(&self, locate: impl Fn(Span) -> (String, u32)) -> Hole {
        let (program, line) = locate(self.backtrace.block);
        Hole {
            id: None,
            entry: self.entry.coords.into(),
            axis: self.axis.into_inner().into(),
            depth: self.depth,
            diameter: self.diameter,
            from: Some(Origin { program, line, tool: self.tool }),
            ..Hole::default()
        }
    }
}

/// Groups passes to holes, in the order of the first pass of each.
pub(super) fn group_holes(
    passes: &[DrillPass],
    machine: &Machine,
    nominal_axes: &NominalAxes,
) -> Vec<DrilledHole> {
    let tree = PointTree::new(passes.iter().map(|pass| pass.cut.bottom));
    let on_line = first_on_same_line(passes, &tree, machine, nominal_axes);
    // A narrower pass beside the line belongs to the hole that swallows it.
    let swallowing = swallowing_passes(passes, &tree, machine);
    let hole_of = |index: usize| {
        let wider = std::iter::successors(swallowing[index], |wide| swallowing[*wide]);
        wider.fold(on_line[index], |_, wide| on_line[wide])
    };
    let step_of = |index: usize| {
        let (pass, PassCut { start, bottom, .. }) = (&passes[index], &passes[index].cut);
        nominal_axes.step([start, bottom], &pass.axis, MAX_LINE_OFFSET, pass.diameter(machine))
    };
    let has_steps = nominal_axes.has_steps();
    let place = |index: usize| (hole_of(index), if has_steps { step_of(index) } else { 0 });
    let first: Vec<(usize, usize)> = (0..passes.len()).map(place).collect();
    let is_aside = |index: usize| first[index].0 != on_line[index];
    let mut order: Vec<usize> = (0..passes.len()).collect();
    // The sort is stable: passes of one line keep their order.
    order.sort_by_key(|index| first[*index]);
    let mut lines: Vec<&[usize]> = order.chunk_by(|one, other| first[*one] == first[*other]).collect();
    // A hole that is widened later is begun by its first pass.
    lines.sort_unstable_by_key(|line| line[0]);
    let mut holes = Vec::with_capacity(passes.len());
    for line in lines {
        let passes_of_hole = line.iter().map(|index| (&passes[*index], is_aside(*index)));
        push_holes(passes_of_hole, passes[line[0]].axis, machine, &mut holes);
    }
    holes
}

/// Returns for each pass the first one on its line.
fn first_on_same_line(
    passes: &[DrillPass],
    tree: &PointTree,
    machine: &Machine,
    nominal_axes: &NominalAxes,
) -> Vec<usize> {
    // Half way to the next nominal hole a pass belongs to that one.
    let half_way = |pass: &DrillPass| {
        let PassCut { start, bottom, .. } = &pass.cut;
        let nearest = nominal_axes.nearest([start, bottom], &pass.axis, MAX_LINE_OFFSET);
        nearest.map_or(MAX_LINE_OFFSET, |(axis, _)| MAX_LINE_OFFSET.min(axis.spacing / 2.0))
    };
    let limits: Option<Vec<f64>> = nominal_axes.has_close().then(|| passes.iter().map(half_way).collect());
    let limit_of = |index: usize| limits.as_ref().map_or(MAX_LINE_OFFSET, |limits| limits[index]);
    let box_about = |index: usize| {
        let (pass, limit) = (&passes[index], limit_of(index));
        let margin = Vector3::repeat(limit);
        // What begins in a nominal hole joins what is cut above it there.
        let entered = nominal_axes.entered([&pass.cut.start, &pass.cut.bottom], &pass.axis, limit);
        let top = entered.unwrap_or(pass.cut.start);
        let low = pass.cut.start.inf(&pass.cut.bottom).inf(&top) - margin;
        [low, pass.cut.start.sup(&pass.cut.bottom).sup(&top) + margin]
    };
    let belongs = |index: usize, other: usize| {
        let limit = limit_of(index).min(limit_of(other));
        let (pass, other) = (&passes[index], &passes[other]);
        pass.axis.dot(&other.axis) >= PARALLEL_COSINE
            && pass.offset_of(other) <= limit.min(max_offset(pass, other, machine))
    };
    clusters(tree, box_about, belongs)
}

/// Returns the largest distance between the axes of two passes of one hole, mm: a tool that drills beside its own hole makes
/// another one, and so does a tool that drills beside the hole of the larger of two tools.
fn max_offset(one: &DrillPass, other: &DrillPass, machine: &Machine) -> f64 {
    let by_tool = if one.tool == other.tool { MAX_REPEAT_OFFSET } else { MAX_LINE_OFFSET };
    match (one.diameter(machine), other.diameter(machine)) {
        (Some(one), Some(other)) => by_tool.min(one.max(other) / 2.0),
        _ => by_tool,
    }
}

impl DrillPass {
    /// Returns the distance of another pass from the line of this one, at its bottom or at the lower of both starts, whichever
    /// is farther.
    pub(super) fn offset_of(&self, other: &Self) -> f64 {
        let height = |point: &Point3<f64>| point.coords.dot(&self.axis);
        let start = height(&self.cut.start).min(height(&other.cut.start));
        let slope = other.axis.dot(&self.axis);
        let bottom = other.cut.bottom;
        let top = bottom + other.axis.into_inner() * ((start - height(&bottom)) / slope);
        let aside = |point: Point3<f64>| {
            let to = point - self.cut.bottom;
            (to - self.axis.into_inner() * to.dot(&self.axis)).norm()
        };
        aside(bottom).max(aside(top))
    }
}

/// Appends the hole of one line, and one more for each pass of a tool that cuts no deeper than before. A true flag marks a pass
/// whose axis lies aside, in a wider one of the hole. Heights count along `out`, the axis of the first pass.
fn push_holes<'p>(
    passes: impl ExactSizeIterator<Item = (&'p DrillPass, bool)>,
    out: Unit<Vector3<f64>>,
    machine: &Machine,
    holes: &mut Vec<DrilledHole>,
) {
    let first_on_line = holes.len();
    let height = |p: &Point3<f64>| p.coords.dot(&out);
    // A mill cuts the same depth with each radius.
    let micrometres =
        |pass: &DrillPass| pass.cut.milled.map(|circle| (circle.radius * 1000.0).round() as u64);
    // A pass along a thread may cut its upper part.
    let is_thread = |pass: &DrillPass| pass.cut.thread().is_some();
    let mut lowest_by_tool: BTreeMap<(Option<u32>, Option<u64>), f64> = BTreeMap::new();
    let is_single = passes.len() == 1;
    let (mut cutting, mut repeated) = (Vec::new(), Vec::new());
    for (pass, is_aside) in passes {
        if is_aside || is_single || is_thread(pass) {
            cutting.push(pass);
            continue;
        }
        let lowest = lowest_by_tool.entry((pass.tool, micrometres(pass))).or_insert(f64::INFINITY);
        let cuts = height(&pass.cut.bottom) < *lowest - MIN_DEPTH_GAIN;
        if cuts {
            *lowest = height(&pass.cut.bottom);
        }
        // Every turn cuts the flanks of a thread, and short edges cut the wall in steps.
        let is_helix =
            pass.cut.milled.is_some_and(|circle| circle.helix.is_some() || circle.wall.is_finite());
        if cuts || is_helix { cutting.push(pass) } else { repeated.push(pass) }
    }
    let lowest = cutting.iter().map(|pass| height(&pass.cut.bottom)).fold(f64::INFINITY, f64::min);
    let finish = finishing_pass(&cutting, lowest, height, machine);
    let finishing_index = cutting.iter().take_while(|pass| !std::ptr::eq(**pass, finish)).count();
    let earlier = cutting.iter().filter(|pass| !std::ptr::eq(**pass, finish)).map(|pass| EarlierPass {
        cut: pass.cut,
        axis: pass.axis,
        tool: pass.tool,
        diameter: pass.diameter(machine),
        backtrace: pass.backtrace.clone(),
        axis_position: pass.axis_position,
    });
    let hole = |pass: &DrillPass, start: f64, bottom: f64, earlier_passes: Vec<EarlierPass>| {
        let slope = pass.axis.dot(&out);
        let base = pass.cut.bottom;
        let along = |level: f64| base + pass.axis.into_inner() * ((level - height(&base)) / slope);
        DrilledHole {
            entry: along(start),
            axis: pass.axis,
            depth: (along(start) - along(bottom)).norm(),
            diameter: pass.diameter(machine),
            tool: pass.tool,
            backtrace: pass.backtrace.clone(),
            axis_position: pass.axis_position,
            is_tool_axis_known: pass.is_tool_axis_known,
            finishing_cut: pass.cut,
            finishing_index,
            unknown_axes: pass.unknown_axes,
            earlier_passes,
            surface: None,
            first_on_line,
        }
    };
    // A mill comes down in rapid to the bottom of a thread: the hole begins where another tool does.
    let has_other = is_thread(finish) && cutting.iter().any(|pass| !is_thread(pass));
    let starting = cutting.iter().filter(|pass| match has_other {
        true => !is_thread(pass),
        false => finish.cut.milled.is_some() || pass.tool == finish.tool,
    });
    let start = starting.map(|pass| height(&pass.cut.start)).fold(f64::NEG_INFINITY, f64::max);
    let mut finished = hole(finish, start, lowest, earlier.collect());
    finished.unknown_axes =
        cutting.iter().fold(UnknownAxes::default(), |axes, pass| axes.union(pass.unknown_axes));
    holes.push(finished);
    let again = |pass: &&DrillPass| hole(pass, height(&pass.cut.start), height(&pass.cut.bottom), Vec::new());
    // A mill goes round more than once to finish.
    holes.extend(repeated.iter().filter(|pass| pass.cut.milled.is_none()).map(again));
}

/// Returns the finishing pass: the last pass of the largest tool that reaches half the depth of the hole, without
/// diameters of the last tool. A countersink is too shallow; a spot drill, however deep, is followed by a deeper tool.
/// The depth counts from the highest feed of a stroke. A circle begins at any height from which its mill came down in rapid: without a
/// stroke the lowest of these counts.
fn finishing_pass<'p>(
    cutting: &[&'p DrillPass],
    lowest: f64,
    height: impl Fn(&Point3<f64>) -> f64,
    machine: &Machine,
) -> &'p DrillPass {
    let starts = |is_milled| {
        let passes = cutting.iter().filter(move |pass| pass.cut.milled.is_some() == is_milled);
        passes.map(|pass| height(&pass.cut.start))
    };
    let start = starts(false).reduce(f64::max).or_else(|| starts(true).reduce(f64::min));
    let longest = start.map_or(0.0, |start| start - lowest);
    let deep = |p: &DrillPass| height(&p.cut.bottom) <= lowest + longest / 2.0;
    // A cone makes no hole that another tool makes deeper, however low its feed begins, as on the floor of a pocket.
    let is_cone = |p: &DrillPass| {
        let tool = p.tool.and_then(|number| machine.find_tool(number));
        tool.is_some_and(|tool| matches!(tool.kind, Some(ToolKind::SpotDrill | ToolKind::Countersink)))
    };
    let others = cutting.iter().filter(|pass| !is_cone(pass)).map(|pass| height(&pass.cut.bottom));
    let lowest_other = others.fold(f64::INFINITY, f64::min);
    let is_above_another =
        |p: &DrillPass| lowest_other < height(&p.cut.bottom) - MIN_DEPTH_GAIN && is_cone(p);
    let mut candidates = cutting.iter().copied().filter(|pass| !is_above_another(pass));
    let mut best = candidates.next().unwrap_or(cutting[0]);
    for pass in candidates {
        let goes_on = deep(pass) && height(&pass.cut.bottom) < height(&best.cut.bottom) - MIN_DEPTH_GAIN;
        let is_wider =
            deep(pass) && !deep(best) || deep(pass) == deep(best) && pass.is_as_wide(best, machine);
        if goes_on || is_wider {
            best = pass;
        }
    }
    best
}
