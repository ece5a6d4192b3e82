//! All positions that a rapid can reach if any axis may arrive first: the box between its ends, or a line of it.
//!
//! A branch and bound finds the point of the tool that is deepest in convex metal. At the point p of the tool at a cell's
//! centre let d be the distance from a body and n its outward normal; because the body is convex, d(q) ≥ d + n·(q − p) at
//! every other point q. A parameter of the cell moves p by D, and rotations by T in all with a lever of L bend that by at
//! most L·T²/2, and the travel S of the others by S·T. So no point of the cell is nearer than d − Σ|n·D| − L·T²/2 − S·T.
//! The first parameters are those of the motion; with a cylinder of the tool, its height and two across it follow.
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::{Point3, Vector3};

use crate::machine::{Machine, Pose, Setup, ToolCylinder};
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
/// these half sides. Returns false instead if they may be too many: a smaller box has fewer.
pub(super) type Bodies<'b> = dyn Fn(&Point3<f64>, &Vector3<f64>, &mut dyn FnMut(NearestPoint)) -> bool + 'b;

/// Cells that the boxes of a run have taken.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SearchBudget {
    taken: usize,
}

impl SearchBudget {
    /// Returns the largest number of cells for metal, and for a deeper point.
    fn limits(self) -> (usize, usize) {
        if self.taken < ALL_CELLS { (MAX_CELLS, MAX_REFINEMENTS) } else { (FEW_CELLS, 0) }
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
    tool: Option<ToolCylinder>,
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

    /// Returns the same positions with a part of the tool instead of its tip.
    pub(super) fn with_tool(&self, tool: ToolCylinder) -> Self {
        Self { tool: Some(tool), ..self.clone() }
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
        if let Some(ToolCylinder { from, to, radius }) = self.tool {
            root.middle[motion] = (from + to) / 2.0;
            root.half[motion..motion + 3].copy_from_slice(&[(to - from) / 2.0, radius, radius]);
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

    /// Returns the parameters of the tool: height and two across.
    fn of_tool(&self, parameters: &[f64; MAX_PARAMETERS]) -> [f64; 3] {
        let motion = self.groups.len();
        [parameters[motion], parameters[motion + 1], parameters[motion + 2]]
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

    /// Returns false for a cell beside the tool.
    fn is_in_tool(&self, cell: &Cell) -> bool {
        let Some(tool) = self.tool else { return true };
        let ([_, u, v], [_, half_u, half_v]) = (self.of_tool(&cell.middle), self.of_tool(&cell.half));
        libm::hypot((u.abs() - half_u).max(0.0), (v.abs() - half_v).max(0.0)) <= tool.radius
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
        let [_, u, v] = self.tool.map_or([0.0; 3], |_| self.of_tool(&cell.middle));
        let is_beside = self.tool.is_some_and(|tool| tool.radius < libm::hypot(u, v));
        let mut bound = f64::NEG_INFINITY;
        let are_all = bodies(&middle, &spread.reach(), &mut |nearest| {
            let depth = -nearest.distance;
            if !is_beside && best.map_or(least, |best| best.depth) < depth {
                *best = Some(DeepPoint { point: middle, depth, arrived: None });
            }
            bound = bound.max(depth + spread.towards(&nearest.normal));
        });
        if !are_all {
            bound = f64::INFINITY;
        }
        let found = best.map_or(least, |best| best.depth);
        if let (true, Some(at)) = (found + RESOLUTION < bound, self.deeper_side(&cell.middle, bodies)) {
            let point = self.point(&at);
            bodies(&point, &Vector3::zeros(), &mut |nearest| {
                let depth = -nearest.distance;
                if best.map_or(least, |best| best.depth) < depth {
                    *best = Some(DeepPoint { point, depth, arrived: None });
                }
            });
        }
        BoundedCell { bound, cell, widest: spread.widest }
    }

    /// Returns the parameters of the point on the tool's side that faces the nearest body at the same height; `None` for the
    /// tip.
    fn deeper_side(&self, at: &[f64; MAX_PARAMETERS], bodies: &Bodies<'_>) -> Option<[f64; MAX_PARAMETERS]> {
        let (tool, motion) = (self.tool?, self.groups.len());
        let mut on_axis = *at;
        on_axis[motion + 1..motion + 3].fill(0.0);
        let position = self.position(at);
        let frame = self.machine.part_frame(&position);
        let axis = self.machine.tool_pose(&position, self.setup).axis?;
        let mut nearest_body: Option<NearestPoint> = None;
        bodies(&self.point(&on_axis), &Vector3::zeros(), &mut |nearest| {
            if nearest_body.as_ref().is_none_or(|body| nearest.distance < body.distance) {
                nearest_body = Some(nearest);
            }
        });
        let normal = frame.rotation * nearest_body?.normal.into_inner();
        let [across, beside] = directions_across(&axis).map(|direction| normal.dot(&direction));
        let length = libm::hypot(across, beside);
        if length < 1e-9 {
            return None;
        }
        on_axis[motion + 1] = -tool.radius * across / length;
        on_axis[motion + 2] = -tool.radius * beside / length;
        Some(on_axis)
    }

    /// Returns true if a tangent plane at an end of the motion has every point of the tool on its outer side; false if that
    /// is not certain.
    pub(super) fn is_clear_by_planes(
        &self,
        parts: &[ToolCylinder],
        nearest: impl Fn(&Point3<f64>) -> NearestPoint,
    ) -> bool {
        let (Some(corners), Some(axis)) =
            (self.straight_corners(), self.machine.forward(&self.from, self.setup).axis)
        else {
            return false;
        };
        let is_outside = |p: &Point3<f64>| {
            let NearestPoint { distance, normal } = nearest(p);
            let (along, most) = (normal.dot(&axis), libm::sqrt((1.0 - normal.dot(&axis).powi(2)).max(0.0)));
            let travel = corners.iter().map(|corner| (corner - p).dot(&normal)).fold(0.0, f64::min);
            parts.iter().all(|part| {
                let end = (along * part.from).min(along * part.to);
                0.0 <= distance + travel + end - part.radius * most
            })
        };
        corners.first().into_iter().chain(corners.last()).any(is_outside)
    }

    /// Returns the longest lever of a rotation at a position; an axis of the table may move the centre of the next.
    fn lever(&self, at: &Position) -> f64 {
        let mut centres = self.machine.table.rotation_centres();
        let first = centres.next();
        let apart = centres.map(|centre| first.map_or(0.0, |first| (centre - first).norm())).sum::<f64>();
        let of_tool = self.tool.map_or(0.0, |tool| libm::hypot(tool.to, tool.radius));
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

/// Returns two directions across the tool, perpendicular to each other; they change continuously while a head inclines the
/// tool in the plane of x and y.
fn directions_across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if axis.z.abs() < 0.5 { Vector3::z() } else { Vector3::x() };
    let across = (other - axis * axis.dot(&other)).normalize();
    [across, axis.cross(&across)]
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::machine::{Chain, Head, HeadKind};
    use gcode_part::Surface;

    fn at([x, y, z, b]: [f64; 4]) -> Position {
        Position([x, y, z, 0.0, b, 0.0, 0.0, 0.0])
    }

    fn found(deepest: Deepest) -> Option<DeepPoint> {
        match deepest {
            Deepest::Clear => None,
            Deepest::Metal(point) => Some(point),
            Deepest::Unknown => panic!("given up"),
        }
    }

    fn deepest(surface: Surface, from: [f64; 4], to: [f64; 4]) -> Option<DeepPoint> {
        let (machine, setup) = (Machine::default(), Setup::default());
        let bodies = |p: &Point3<f64>, _: &Vector3<f64>, each: &mut dyn FnMut(NearestPoint)| {
            each(surface.nearest(p));
            true
        };
        found(AxisBox::new(&machine, &setup, &at(from), &at(to)).deepest(
            &bodies,
            0.01,
            &mut SearchBudget::default(),
        ))
    }

    #[test]
    fn corners_edges_and_the_inside_are_searched() {
        let body = Surface::Ellipsoid { a: 100.0, b: 80.0 };
        // X first: (92, 0), 8 mm below the surface.
        let corner = deepest(body, [102.0, 0.0, 0.0, 0.0], [92.0, 92.0, 0.0, 0.0]).unwrap();
        assert!((corner.depth - 8.0).abs() < 1e-9 && corner.arrived == Some(1), "{corner:?}");
        assert!(deepest(body, [102.0, 0.0, 0.0, 0.0], [100.02, 92.0, 0.0, 0.0]).is_none());
        // No corner is inside, but the edge from (−120, 70) to (120, 70) leads through the axis, 10 mm below the pole.
        let edge = deepest(body, [-120.0, 70.0, 0.0, 0.0], [120.0, 130.0, 0.0, 0.0]).unwrap();
        assert!((edge.depth - 10.0).abs() < 0.01 && edge.arrived.is_none(), "{edge:?}");
        // All twelve edges pass the sphere of 10, and its centre is the middle of the box.
        let sphere = Surface::Ellipsoid { a: 10.0, b: 10.0 };
        let inside = deepest(sphere, [-12.0, -12.0, -12.0, 0.0], [12.0, 12.0, 12.0, 0.0]).unwrap();
        assert!((inside.depth - 10.0).abs() < 0.01, "{inside:?}");
    }

    /// Half a turn of B while X goes from 150 to 110 past a box to x 100: with B first the tip stands at x −110 on the
    /// part, and outside. To x 90 and with B at 90° it is at z −90 … 90, and the box reaches to z 95.
    #[test]
    fn rotations_are_searched_with_the_slides() {
        let block =
            Surface::Block { min: Point3::new(-100.0, -5.0, -95.0), max: Point3::new(100.0, 5.0, 95.0) };
        assert!(deepest(block, [160.0, 0.0, 0.0, 0.0], [145.0, 0.0, 0.0, 180.0]).is_none());
        // The corner of the box is 137.9 mm from B's axis.
        let corner = deepest(block, [160.0, 0.0, 0.0, 0.0], [130.0, 0.0, 0.0, 180.0]).unwrap();
        assert!(corner.arrived.is_none() && 1.0 < corner.depth, "{corner:?}");
    }

    /// A tool of 10 and 40 long over a box of 200 × 10 × 190: at y 9.98 its side is 0.02 mm in the box, and at 10.2 it
    /// passes. Its upper end reaches 5 mm beyond the box if it comes from below.
    #[test]
    fn the_side_of_a_tool_is_searched() {
        let block =
            Surface::Block { min: Point3::new(-100.0, -5.0, -95.0), max: Point3::new(100.0, 5.0, 95.0) };
        let machine = Machine {
            head: Head::new(HeadKind::Fixed(Vector3::z_axis()), 0.0),
            table: Chain::default(),
            ..Machine::default()
        };
        let setup = Setup::default();
        let bodies = |p: &Point3<f64>, _: &Vector3<f64>, each: &mut dyn FnMut(NearestPoint)| {
            each(block.nearest(p));
            true
        };
        let side = |from: [f64; 4], to: [f64; 4]| {
            let line = AxisBox::line(&machine, &setup, &at(from), &at(to));
            let tool = ToolCylinder { from: 3.0, to: 40.0, radius: 5.0 };
            let is_clear = line.is_clear_by_planes(&[tool], |p| block.nearest(p));
            let deepest = line.with_tool(tool).deepest(&bodies, 0.01, &mut SearchBudget::default());
            (is_clear, found(deepest).map(|point| point.depth))
        };
        let (is_clear, depth) = side([-150.0, 9.98, 50.0, 0.0], [150.0, 9.98, 50.0, 0.0]);
        assert!(!is_clear && (depth.unwrap() - 0.02).abs() < 1e-9, "{depth:?}");
        assert_eq!(side([-150.0, 10.2, 50.0, 0.0], [150.0, 10.2, 50.0, 0.0]).1, None);
        assert_eq!(side([0.0, 20.0, 200.0, 0.0], [0.0, 20.0, -200.0, 0.0]), (true, None));
        let (_, depth) = side([0.0, 0.0, -150.0, 0.0], [0.0, 0.0, -130.0, 0.0]);
        assert!((depth.unwrap() - 5.0).abs() < 0.01, "{depth:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// If a sampled position of the box is in metal, metal is found.
        #[test]
        fn metal_in_the_box_is_found(
            ends in prop::array::uniform6(-120.0..120.0f64),
            turns in (-30.0..30.0f64, -30.0..30.0f64),
            samples in prop::collection::vec(prop::array::uniform4(0.0..1.0f64), 200),
        ) {
            let body = Surface::Block { min: Point3::new(-60.0, -40.0, -20.0), max: Point3::new(60.0, 40.0, 20.0) };
            let from = [ends[0], ends[1], ends[2], turns.0];
            let to = [ends[3], ends[4], ends[5], turns.1];
            let (machine, setup) = (Machine::default(), Setup::default());
            let bodies = |p: &Point3<f64>, _: &Vector3<f64>, each: &mut dyn FnMut(NearestPoint)| {
                each(body.nearest(p));
                true
            };
            let all = AxisBox::new(&machine, &setup, &at(from), &at(to));
            let mut best = None;
            let root = all.bounded(all.root(), &bodies, 0.01, &mut best);
            let found = found(all.deepest_inside(root, &bodies, 0.01, (best, &mut SearchBudget::default())));
            for t in samples {
                let position = at([0, 1, 2, 3].map(|i| from[i] + (to[i] - from[i]) * t[i]));
                let depth = -body.nearest(&machine.forward(&position, &setup).tip).distance;
                let is_found = found.is_some() || depth <= 0.01 + RESOLUTION + 1e-9;
                prop_assert!(is_found, "{} {:?}", depth, found);
            }
        }
    }
}
