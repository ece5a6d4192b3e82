//! All positions that a rapid can reach if any axis may arrive first: the box between its ends, or a line of it.
//!
//! A branch and bound finds the point of the tool that is deepest in convex metal. At the point p of the tool at a cell's
//! centre let d be the distance from a body and n its outward normal; because the body is convex, d(q) ≥ d + n·(q − p) at
//! every other point q. A parameter of the cell moves p by D, and rotations by T in all with a lever of L bend that by at
//! most L·T²/2, and the travel S of the others by S·T. So no point of the cell is nearer than d − Σ|n·D| − L·T²/2 − S·T.
//! The first parameters are those of the motion; with a cylinder of the tool, its height and two across it follow.
#[cfg(test)]
mod tests;
mod tool;

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::{Point3, Vector3};

pub(super) use self::tool::directions_across;
use crate::machine::{Machine, Pose, Setup, ToolPart};
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position};
use gcode_lang::units::Deg;
use gcode_part::NearestPoint;

/// Depth to which metal is found, mm.
const RESOLUTION: f64 = 0.002;

/// Share of the depth to which the deepest point is found.
const SHARE: f64 = 0.001;

/// Largest number of cells that are searched in one box for metal, and for a deeper point once there is one.
const MAX_CELLS: usize = 20_000;
const MAX_REFINEMENTS: usize = 1000;

/// Number of cells in all boxes of a run after which each has but [`FEW_CELLS`].
const ALL_CELLS: usize = 1_000_000;
const FEW_CELLS: usize = 200;

/// Largest number of parameters of a cell: the axes, and three of the tool.
const MAX_PARAMETERS: usize = MAX_AXES + 3;

/// Calls its last argument with the distance of a point from every convex body that may reach into the box about it with
/// these half sides. Returns false instead if they may be too many: a smaller box has fewer. A box in
/// a void is in no body.
pub(super) type Bodies<'b> = dyn Fn(&Point3<f64>, &Vector3<f64>, &mut dyn FnMut(NearestPoint)) -> bool + 'b;

/// Cells that the boxes of a run have taken.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SearchBudget {
    taken: usize,
    /// Metal is known to be met: any other point of it does.
    pub is_any_enough: bool,
}

impl SearchBudget {
    /// Returns the largest number of cells for metal, and for a deeper point.
    fn limits(self) -> (usize, usize) {
        match self.taken < ALL_CELLS {
            true => (MAX_CELLS, if self.is_any_enough { 0 } else { MAX_REFINEMENTS }),
            false => (FEW_CELLS, 0),
        }
    }
}

/// The positions between the ends of a rapid.
#[derive(Clone)]
pub(super) struct AxisBox<'m> {
    machine: &'m Machine,
    setup: &'m Setup,
    from: Position,
    to: Position,
    /// Axes that move together, in the order of the control.
    groups: Vec<Vec<AxisIndex>>,
    /// Part of the tool that is followed; `None` for its tip.
    tool: Option<ToolPart>,
}

/// A point of the tool in metal.
#[derive(Clone, Copy, Debug)]
pub(super) struct DeepPoint {
    /// The point on the part.
    pub point: Point3<f64>,
    /// Depth, mm.
    pub depth: f64,
    /// The axes that have arrived, as bits, axis 1 the lowest, if the position is a corner of the box.
    pub arrived: Option<u8>,
}

/// Result of a search.
#[derive(Clone, Copy, Debug)]
pub(super) enum Deepest {
    /// Every path stays outside.
    Clear,
    /// Some path leads into metal.
    Metal(DeepPoint),
    /// The search was given up.
    Unknown,
}

/// A part of the box: its middle, and half its size along each parameter. Those of the motion run from 0 to 1, those of
/// the tool are lengths.
#[derive(Clone, Copy)]
struct Cell {
    middle: [f64; MAX_PARAMETERS],
    half: [f64; MAX_PARAMETERS],
}

/// A cell with the depth that none of its points exceeds, and the parameter along which it is widest.
struct BoundedCell {
    bound: f64,
    cell: Cell,
    widest: usize,
}

impl Ord for BoundedCell {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for BoundedCell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for BoundedCell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for BoundedCell {}

impl<'m> AxisBox<'m> {
    /// Returns the box of the axes that move the tip or the part; travels within the rounding of a point are left out if
    /// another axis moves.
    pub(super) fn new(machine: &'m Machine, setup: &'m Setup, from: &Position, to: &Position) -> Self {
        let travel = |axis: AxisIndex| (to[axis] - from[axis]).abs();
        let least = 2.0 * machine.increment.size();
        let axes = machine.axes.iter().map(|(axis, _)| axis);
        let moved = axes.filter(|axis| least < travel(*axis) && machine.is_axis_used(*axis));
        let groups = moved.map(|axis| vec![axis]).collect();
        Self { machine, setup, from: *from, to: *to, groups, tool: None }
    }

    /// Returns the line along which all axes arrive together.
    pub(super) fn line(machine: &'m Machine, setup: &'m Setup, from: &Position, to: &Position) -> Self {
        let axes = (0..MAX_AXES).filter(|axis| from[*axis] != to[*axis]).collect();
        Self { machine, setup, from: *from, to: *to, groups: vec![axes], tool: None }
    }

    /// Returns the number of axes that may arrive one after another.
    pub(super) fn len(&self) -> usize {
        self.groups.len()
    }

    /// Returns the axes that move.
    pub(super) fn axes(&self) -> impl Iterator<Item = AxisIndex> + '_ {
        self.groups.iter().flatten().copied()
    }

    /// Leaves out an axis that has no effect on the depth.
    pub(super) fn leave_out(&mut self, axis: AxisIndex) {
        self.groups.iter_mut().for_each(|group| group.retain(|other| *other != axis));
        self.groups.retain(|group| !group.is_empty());
    }

    /// Returns the tips at the corners, ends of the rapid included; `None` if an axis rotates: the tips are then not those
    /// between the corners.
    pub(super) fn straight_corners(&self) -> Option<Vec<Point3<f64>>> {
        if self.axes().any(|axis| self.machine.axes.is_rotary(axis)) {
            return None;
        }
        let tip = |corner: u32| self.machine.forward(&self.corner(corner).0, self.setup).tip;
        Some((0..1_u32 << self.groups.len()).map(tip).collect())
    }

    /// Returns the tip at the start and the sides of the box; `None` if an axis rotates.
    pub(super) fn sides(&self) -> Option<(Point3<f64>, Vec<Vector3<f64>>)> {
        let corners = self.straight_corners()?;
        let first = *corners.first()?;
        Some((first, (0..self.groups.len()).map(|side| corners[1 << side] - first).collect()))
    }

    /// Returns a corner, and the axes that have arrived there, as bits; bit n of `corner` is the n-th group of axes.
    fn corner(&self, corner: u32) -> (Position, u8) {
        let (mut at, mut arrived) = (self.from, 0);
        for (_, group) in self.groups.iter().enumerate().filter(|(bit, _)| corner >> bit & 1 == 1) {
            for axis in group {
                at[*axis] = self.to[*axis];
                arrived |= 1 << axis;
            }
        }
        (at, arrived)
    }

    /// Returns the deepest point in the bodies, deeper than `least`; for the tip a corner between the ends is preferred to
    /// other points.
    pub(super) fn deepest(&self, bodies: &Bodies<'_>, least: f64, budget: &mut SearchBudget) -> Deepest {
        let mut best = None;
        let root = self.bounded(self.root(), bodies, least, &mut best);
        if root.bound <= least + RESOLUTION {
            return Deepest::Clear;
        }
        match self.deepest_corner(bodies, least) {
            Some(corner) => Deepest::Metal(corner),
            None => self.deepest_inside(root, bodies, least, (best, budget)),
        }
    }

    fn root(&self) -> Cell {
        let mut root = Cell { middle: [0.0; MAX_PARAMETERS], half: [0.0; MAX_PARAMETERS] };
        let motion = self.groups.len();
        root.middle[..motion].fill(0.5);
        root.half[..motion].fill(0.5);
        if let Some(part) = self.tool {
            let (half, radius) = ((part.to - part.from) / 2.0, part.radius());
            root.middle[motion] = part.from + half;
            root.half[motion..motion + 3].copy_from_slice(&[half, radius, radius]);
        }
        root
    }

    fn position(&self, parameters: &[f64; MAX_PARAMETERS]) -> Position {
        let mut at = self.from;
        for (group, t) in self.groups.iter().zip(parameters) {
            for axis in group {
                at[*axis] += (self.to[*axis] - self.from[*axis]) * t;
            }
        }
        at
    }

    /// Returns the point of the tool at some parameters, on the part.
    fn point(&self, parameters: &[f64; MAX_PARAMETERS]) -> Point3<f64> {
        let at = self.position(parameters);
        let frame = self.machine.part_frame(&at);
        let Pose { tip, axis } = self.machine.tool_pose(&at, self.setup);
        let point = match (self.tool, axis) {
            (Some(_), Some(axis)) => {
                let [height, u, v] = self.of_tool(parameters);
                let [across, beside] = directions_across(&axis);
                tip + axis.into_inner() * height + across * u + beside * v
            }
            _ => tip,
        };
        frame.inverse_transform_point(&point)
    }

    /// Returns the deepest corner of the tip, without the ends of the rapid.
    fn deepest_corner(&self, bodies: &Bodies<'_>, least: f64) -> Option<DeepPoint> {
        let mut best: Option<DeepPoint> = None;
        if self.tool.is_some() {
            return None;
        }
        for corner in 1..(1_u32 << self.groups.len()) - 1 {
            let (at, arrived) = self.corner(corner);
            let point = self.machine.forward(&at, self.setup).tip;
            let mut depth = f64::NEG_INFINITY;
            bodies(&point, &Vector3::zeros(), &mut |nearest| depth = depth.max(-nearest.distance));
            if best.map_or(least, |best| best.depth) < depth {
                best = Some(DeepPoint { point, depth, arrived: Some(arrived) });
            }
        }
        best
    }

    fn deepest_inside(
        &self,
        root: BoundedCell,
        bodies: &Bodies<'_>,
        least: f64,
        (mut best, budget): (Option<DeepPoint>, &mut SearchBudget),
    ) -> Deepest {
        let (most, refinements) = budget.limits();
        let mut pending = BinaryHeap::from([root]);
        for searched in 0.. {
            let Some(BoundedCell { bound, cell, widest }) = pending.pop() else { break };
            let found = best.map_or(least, |best| best.depth);
            let is_exact = bound <= found + RESOLUTION.max(found * SHARE);
            if is_exact || best.is_some() && refinements < searched {
                break;
            }
            if most < searched {
                return Deepest::Unknown;
            }
            budget.taken += 1;
            for side in [-1.0, 1.0] {
                let mut half = cell;
                half.half[widest] /= 2.0;
                half.middle[widest] += side * half.half[widest];
                if self.is_in_tool(&half) {
                    pending.push(self.bounded(half, bodies, least, &mut best));
                }
            }
        }
        best.map_or(Deepest::Clear, Deepest::Metal)
    }

    /// Returns a cell with the depth that none of its points exceeds; a point deeper than `best` replaces it.
    fn bounded(
        &self,
        cell: Cell,
        bodies: &Bodies<'_>,
        least: f64,
        best: &mut Option<DeepPoint>,
    ) -> BoundedCell {
        let (spread, middle) = (self.spread(&cell), self.point(&cell.middle));
        let [height, u, v] = self.tool.map_or([0.0; 3], |_| self.of_tool(&cell.middle));
        let is_beside = self.tool.is_some_and(|tool| tool.taper.at(height) < libm::hypot(u, v));
        let (mut bound, mut is_deeper) = (f64::NEG_INFINITY, false);
        let are_all = bodies(&middle, &spread.reach(), &mut |nearest| {
            let depth = -nearest.distance;
            is_deeper |= !is_beside && best.map_or(least, |best| best.depth) < depth;
            bound = bound.max(depth + spread.towards(&nearest.normal));
        });
        if !are_all {
            bound = f64::INFINITY;
        }
        // The middle may be empty where a body reaches into the cell.
        self.keep_deeper(is_deeper.then_some(middle), bodies, least, best);
        let found = best.map_or(least, |best| best.depth);
        if found + RESOLUTION < bound {
            let sides = self.deeper_sides(&cell.middle, bodies);
            self.keep_deeper(sides.iter().map(|side| self.point(side)), bodies, least, best);
        }
        BoundedCell { bound, cell, widest: spread.widest }
    }

    /// Replaces `best` by the deepest of some points, if one is deeper.
    fn keep_deeper(
        &self,
        points: impl IntoIterator<Item = Point3<f64>>,
        bodies: &Bodies<'_>,
        least: f64,
        best: &mut Option<DeepPoint>,
    ) {
        for point in points {
            bodies(&point, &Vector3::zeros(), &mut |nearest| {
                let depth = -nearest.distance;
                if best.map_or(least, |best| best.depth) < depth {
                    *best = Some(DeepPoint { point, depth, arrived: None });
                }
            });
        }
    }

    /// Returns the longest lever of a rotation at a position; an axis of the table may move the centre of the next.
    fn lever(&self, at: &Position) -> f64 {
        let mut centres = self.machine.table.rotation_centres();
        let first = centres.next();
        let apart = centres.map(|centre| first.map_or(0.0, |first| (centre - first).norm())).sum::<f64>();
        let of_tool = self.tool.map_or(0.0, |tool| libm::hypot(tool.to, tool.radius()));
        self.machine.max_lever(at, self.setup) + 2.0 * apart + of_tool
    }

    /// Returns the extent of a cell's points about that of its middle.
    fn spread(&self, cell: &Cell) -> Spread {
        let point_at = |parameter: usize, by: f64| {
            let mut at = cell.middle;
            at[parameter] += by;
            self.point(&at)
        };
        let mut by = [Vector3::zeros(); MAX_PARAMETERS];
        let mut turns = [0.0; MAX_PARAMETERS];
        let (mut turn, mut slide) = (0.0, 0.0);
        let motion = self.groups.len();
        for parameter in 0..motion + self.tool.map_or(0, |_| 3) {
            let half = cell.half[parameter];
            if half == 0.0 {
                continue;
            }
            by[parameter] = (point_at(parameter, half) - point_at(parameter, -half)) / 2.0;
            let mut linear = motion <= parameter;
            for axis in self.groups.get(parameter).into_iter().flatten() {
                match self.machine.axes.is_rotary(*axis) {
                    true => {
                        turns[parameter] += Deg((self.to[*axis] - self.from[*axis]).abs() * half).to_rad()
                    }
                    false => linear = true,
                }
            }
            turn += turns[parameter];
            if linear {
                slide += self.slide(parameter, half).unwrap_or(by[parameter].norm());
            }
        }
        let lever = if turn == 0.0 { 0.0 } else { self.lever(&self.position(&cell.middle)) + slide };
        let size = |parameter: usize| by[parameter].norm().max(lever * turns[parameter]);
        let widest = (0..MAX_PARAMETERS).max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or_default();
        // Beyond a radian the tangents say nothing.
        if turn > 1.0 {
            let all = 2.0 * lever + slide;
            return Spread { by: [Vector3::zeros(); MAX_PARAMETERS], bend: all, widest };
        }
        Spread { by, bend: lever * turn * turn / 2.0 + slide * turn, widest }
    }

    /// Returns the travel of the slides of a group for a part of its way; `None` for a parameter of the tool.
    fn slide(&self, parameter: usize, part: f64) -> Option<f64> {
        let linear = self.groups.get(parameter)?.iter().filter(|axis| !self.machine.axes.is_rotary(**axis));
        Some(linear.map(|axis| (self.to[*axis] - self.from[*axis]).abs() * part).sum())
    }
}

/// Extent of the points of a cell about that of its middle.
struct Spread {
    /// Half the travel due to each parameter.
    by: [Vector3<f64>; MAX_PARAMETERS],
    /// Largest deviation from the sum of these, mm.
    bend: f64,
    /// Parameter along which the cell is widest.
    widest: usize,
}

impl Spread {
    /// Returns half the sides of a box about the middle that holds all points.
    fn reach(&self) -> Vector3<f64> {
        self.by.iter().map(Vector3::abs).sum::<Vector3<f64>>() + Vector3::repeat(self.bend)
    }

    /// Returns the largest travel against a normal.
    fn towards(&self, normal: &Vector3<f64>) -> f64 {
        self.by.iter().map(|by| by.dot(normal).abs()).sum::<f64>() + self.bend
    }
}
