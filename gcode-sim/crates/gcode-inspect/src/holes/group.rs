//! Passes → holes: what several tools, or one tool in several goes, cut on one line is one hole.
use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use crate::machine::Machine;
use gcode_lang::motion::{Backtrace, Position};
use gcode_lang::units::Deg;
use gcode_part::Clusters;
use gcode_part::PointTree;

/// Passes belong to one hole when one's bottom lies this near the other's line, in mm, …
const MAX_LINE_OFFSET: f64 = 0.5;

/// … and their directions differ by no more than this: 5°.
const MIN_DIRECTION_COSINE: f64 = 0.996_194_698_091_745_5;

/// A tool was there before when it reaches less than this deeper, in mm.
const MIN_DEPTH_GAIN: f64 = 0.001;

/// A feed into the part along one line, in the part's frame.
#[derive(Clone, Debug)]
pub(super) struct DrillPass {
    pub start: Point3<f64>,
    pub bottom: Point3<f64>,
    /// The tool's direction out of the part, or the feed's where it isn't known.
    pub axis: Unit<Vector3<f64>>,
    /// The direction of the feed, out of the part.
    pub feed_direction: Unit<Vector3<f64>>,
    pub tool: Option<u32>,
    pub backtrace: Backtrace,
    pub axis_position: Position,
}

/// A hole the program makes, in the part's frame.
#[derive(Clone, Debug)]
pub struct DrilledHole {
    /// Where the cutting feed of the finishing tool begins, on the hole's axis.
    pub entry: Point3<f64>,
    /// Out of the part.
    pub axis: Unit<Vector3<f64>>,
    /// From the entry to the deepest point of any tool.
    pub depth: f64,
    /// Of the finishing tool, where the tool table has it.
    pub diameter: Option<f64>,
    pub tool: Option<u32>,
    /// The block that finished it.
    pub backtrace: Backtrace,
    /// Where the axes stood at the bottom.
    pub axis_position: Position,
    /// The angle between the finishing feed and the tool's axis.
    pub tool_axis_deviation: Deg,
    /// What was cut there besides the finishing pass.
    pub earlier_passes: Vec<EarlierPass>,
    /// The place in the list of the first hole on this line. A later one with the same is the same hole, drilled
    /// again by a tool that had been there.
    pub first_on_line: usize,
}

/// A pass of a hole that doesn't finish it.
#[derive(Clone, Debug)]
pub struct EarlierPass {
    pub bottom: Point3<f64>,
    /// Out of the part.
    pub axis: Unit<Vector3<f64>>,
    pub tool: Option<u32>,
    /// Of the tool, in mm, where the tool table has it.
    pub diameter: Option<f64>,
    pub backtrace: Backtrace,
    /// Where the axes stood at the bottom.
    pub axis_position: Position,
}

/// The holes in the order in which their first passes were made.
pub(super) fn group_holes(passes: &[DrillPass], machine: &Machine) -> Vec<DrilledHole> {
    let first = first_on_same_line(passes);
    let mut order: Vec<usize> = (0..passes.len()).collect();
    // On one line they keep their order.
    order.sort_by_key(|index| first[*index]);
    let mut found = Vec::with_capacity(passes.len());
    let mut sorted = PassesOnLine::default();
    for line in order.chunk_by(|one, other| first[*one] == first[*other]) {
        sorted.refill(line.iter().map(|index| &passes[*index]));
        push_holes(&sorted, passes[line[0]].axis, machine, &mut found);
    }
    found
}

/// For each pass the first one on its line.
fn first_on_same_line(passes: &[DrillPass]) -> Vec<usize> {
    let tree = PointTree::new(passes.iter().map(|pass| pass.bottom));
    let mut groups = Clusters::new(&tree);
    for (index, pass) in passes.iter().enumerate() {
        let margin = Vector3::repeat(MAX_LINE_OFFSET);
        let low = pass.start.inf(&pass.bottom) - margin;
        let high = pass.start.sup(&pass.bottom) + margin;
        groups.join(index, &low, &high, &|other| {
            let to = passes[other].bottom - pass.bottom;
            let aside = (to - pass.axis.into_inner() * to.dot(&pass.axis)).norm();
            aside <= MAX_LINE_OFFSET && pass.axis.dot(&passes[other].axis) >= MIN_DIRECTION_COSINE
        });
    }
    groups.representatives()
}

/// The passes of one line: those that cut, and those of tools that came back for nothing. One is filled again for
/// each line.
#[derive(Default)]
struct PassesOnLine<'p> {
    cutting: Vec<&'p DrillPass>,
    repeated: Vec<&'p DrillPass>,
    /// How low each tool has been.
    lowest_by_tool: BTreeMap<Option<u32>, f64>,
}

impl<'p> PassesOnLine<'p> {
    fn refill(&mut self, passes: impl Iterator<Item = &'p DrillPass>) {
        self.cutting.clear();
        self.repeated.clear();
        self.lowest_by_tool.clear();
        let mut out = None;
        for pass in passes {
            let bottom = pass.bottom.coords.dot(out.get_or_insert(pass.axis));
            let before = self.lowest_by_tool.entry(pass.tool).or_insert(f64::INFINITY);
            if bottom < *before - MIN_DEPTH_GAIN {
                *before = bottom;
                self.cutting.push(pass);
            } else {
                self.repeated.push(pass);
            }
        }
    }
}

/// One hole, and one more for every time a tool came back for nothing. Heights count along `out`, the first pass's
/// axis.
fn push_holes(
    passes: &PassesOnLine<'_>,
    out: Unit<Vector3<f64>>,
    machine: &Machine,
    drilled: &mut Vec<DrilledHole>,
) {
    let first = drilled.len();
    let height = |p: &Point3<f64>| p.coords.dot(&out);
    let PassesOnLine { cutting, repeated: again, .. } = passes;
    let lowest = cutting.iter().map(|pass| height(&pass.bottom)).fold(f64::INFINITY, f64::min);
    let finish = finishing_pass(cutting, lowest, height, machine);
    let diameter = |pass: &DrillPass| machine.diameter_of(pass.tool);
    let cut = |pass: &&DrillPass| EarlierPass {
        bottom: pass.bottom,
        axis: pass.axis,
        tool: pass.tool,
        diameter: diameter(pass),
        backtrace: pass.backtrace.clone(),
        axis_position: pass.axis_position,
    };
    let others = cutting.iter().filter(|pass| !std::ptr::eq(**pass, finish)).map(cut).collect();
    let one = |pass: &DrillPass, start: f64, bottom: f64, others: Vec<EarlierPass>| {
        let slope = pass.axis.dot(&out);
        let along =
            |level: f64| pass.bottom + pass.axis.into_inner() * ((level - height(&pass.bottom)) / slope);
        DrilledHole {
            entry: along(start),
            axis: pass.axis,
            depth: (along(start) - along(bottom)).norm(),
            diameter: diameter(pass),
            tool: pass.tool,
            backtrace: pass.backtrace.clone(),
            axis_position: pass.axis_position,
            tool_axis_deviation: Deg::acos(pass.axis.dot(&pass.feed_direction).clamp(-1.0, 1.0)),
            earlier_passes: others,
            first_on_line: first,
        }
    };
    let finishing = cutting.iter().filter(|pass| pass.tool == finish.tool);
    let start = finishing.map(|pass| height(&pass.start)).fold(f64::NEG_INFINITY, f64::max);
    drilled.push(one(finish, start, lowest, others));
    drilled.extend(again.iter().map(|pass| one(pass, height(&pass.start), height(&pass.bottom), Vec::new())));
}

/// The last pass of the largest tool that goes at least half as deep as the hole; where diameters aren't known, of
/// the last tool. A countersink is large and shallow and doesn't make the hole, nor does a spot drill, however deep:
/// a tool behind it goes deeper.
fn finishing_pass<'p>(
    cutting: &[&'p DrillPass],
    lowest: f64,
    height: impl Fn(&Point3<f64>) -> f64,
    machine: &Machine,
) -> &'p DrillPass {
    let longest = cutting.iter().map(|pass| height(&pass.start) - lowest).fold(0.0, f64::max);
    let diameter = |pass: &DrillPass| machine.diameter_of(pass.tool).unwrap_or(0.0);
    let deep = |p: &DrillPass| height(&p.bottom) <= lowest + longest / 2.0;
    let mut best = cutting[0];
    for pass in &cutting[1..] {
        let goes_on = deep(pass) && height(&pass.bottom) < height(&best.bottom) - MIN_DEPTH_GAIN;
        if goes_on || (deep(pass), diameter(pass)) >= (deep(best), diameter(best)) {
            best = pass;
        }
    }
    best
}
