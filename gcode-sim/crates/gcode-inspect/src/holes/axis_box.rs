//! All positions that a rapid can reach if any axis may arrive first: the box between its ends.
//!
//! A branch and bound finds the point of the box at which the tip is deepest in convex metal. At the tip p of a cell's
//! centre let d be the distance from a body and n its outward normal; because the body is convex, d(q) ≥ d + n·(q − p) at
//! every other tip q. An axis moves the tip by D within the cell, and rotations by T in all with a lever of L bend that
//! by at most L·T²/2, and the travel S of the slides by S·T. So no tip of the cell is nearer than
//! d − Σ|n·D| − L·T²/2 − S·T.
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::{Point3, Vector3};

use crate::machine::{Machine, Setup};
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position};
use gcode_lang::units::Deg;
use gcode_part::NearestPoint;

/// Depth to which metal is found, mm.
const RESOLUTION: f64 = 0.002;

/// Share of the depth to which the deepest point is found.
const SHARE: f64 = 0.001;

/// Largest number of cells that are searched for metal, and for a deeper point once there is one.
const MAX_CELLS: usize = 20_000;
const MAX_REFINEMENTS: usize = 1000;

/// Calls its last argument with the distance of a point from every convex body that may be within a reach of it.
pub(super) type Bodies<'b> = dyn Fn(&Point3<f64>, f64, &mut dyn FnMut(NearestPoint)) + 'b;

/// The box between the ends of a rapid.
pub(super) struct AxisBox<'m> {
    machine: &'m Machine,
    setup: &'m Setup,
    from: Position,
    to: Position,
    /// Axes that move, in the order of the control.
    pub axes: Vec<AxisIndex>,
}

/// A position of the box at which the tip is in metal.
#[derive(Clone, Copy, Debug)]
pub(super) struct DeepPoint {
    /// Tip on the part.
    pub tip: Point3<f64>,
    /// Depth, mm.
    pub depth: f64,
    /// The axes that have arrived, as bits, axis 1 the lowest, if the point is a corner of the box.
    pub arrived: Option<u8>,
}

/// A part of the box: its middle, and half its size along each axis.
#[derive(Clone, Copy)]
struct Cell {
    middle: Position,
    half: Position,
}

/// A cell with the depth that none of its points exceeds, and the axis along which it is widest.
struct BoundedCell {
    bound: f64,
    cell: Cell,
    widest: AxisIndex,
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
        let moved = |least: f64| -> Vec<AxisIndex> {
            let axes = machine.axes.iter().map(|(axis, _)| axis);
            axes.filter(|axis| least < travel(*axis) && machine.is_axis_used(*axis)).collect()
        };
        let axes = moved(2.0 * machine.increment.size());
        Self { machine, setup, from: *from, to: *to, axes }
    }

    /// Returns the deepest point in the bodies, deeper than `least`; a corner between the ends is preferred to other
    /// points. `None` if every path stays outside.
    pub(super) fn deepest(&self, bodies: &Bodies<'_>, least: f64) -> Option<DeepPoint> {
        let mut best = None;
        let root = self.bounded(self.root(), bodies, least, &mut best);
        if root.bound <= least + RESOLUTION {
            return None;
        }
        self.deepest_corner(bodies, least).or_else(|| self.deepest_inside(root, bodies, least, best))
    }

    fn root(&self) -> Cell {
        let mut root = Cell { middle: self.from, half: Position::default() };
        for axis in &self.axes {
            root.middle[*axis] = (self.from[*axis] + self.to[*axis]) / 2.0;
            root.half[*axis] = (self.to[*axis] - self.from[*axis]).abs() / 2.0;
        }
        root
    }

    fn depth_at(&self, at: &Position, bodies: &Bodies<'_>) -> (f64, Point3<f64>) {
        let tip = self.machine.forward(at, self.setup).tip;
        let mut depth = f64::NEG_INFINITY;
        bodies(&tip, 0.0, &mut |nearest| depth = depth.max(-nearest.distance));
        (depth, tip)
    }

    /// Returns the deepest corner, without the ends of the rapid.
    fn deepest_corner(&self, bodies: &Bodies<'_>, least: f64) -> Option<DeepPoint> {
        let mut best: Option<DeepPoint> = None;
        for corner in 1..(1_u32 << self.axes.len()) - 1 {
            let (mut at, mut arrived) = (self.from, 0);
            for (bit, axis) in self.axes.iter().enumerate().filter(|(bit, _)| corner >> bit & 1 == 1) {
                at[*axis] = self.to[*axis];
                arrived |= 1 << self.axes[bit];
            }
            let (depth, tip) = self.depth_at(&at, bodies);
            if best.map_or(least, |best| best.depth) < depth {
                best = Some(DeepPoint { tip, depth, arrived: Some(arrived) });
            }
        }
        best
    }

    fn deepest_inside(
        &self,
        root: BoundedCell,
        bodies: &Bodies<'_>,
        least: f64,
        mut best: Option<DeepPoint>,
    ) -> Option<DeepPoint> {
        let mut pending = BinaryHeap::from([root]);
        for searched in 0..MAX_CELLS {
            let Some(BoundedCell { bound, cell, widest }) = pending.pop() else { break };
            let found = best.map_or(least, |best| best.depth);
            let is_exact = bound <= found + RESOLUTION.max(found * SHARE);
            if is_exact || best.is_some() && MAX_REFINEMENTS < searched {
                break;
            }
            for side in [-1.0, 1.0] {
                let mut half = cell;
                half.half[widest] /= 2.0;
                half.middle[widest] += side * half.half[widest];
                pending.push(self.bounded(half, bodies, least, &mut best));
            }
        }
        best
    }

    /// Returns a cell with the depth that none of its points exceeds; a middle deeper than `best` replaces it.
    fn bounded(
        &self,
        cell: Cell,
        bodies: &Bodies<'_>,
        least: f64,
        best: &mut Option<DeepPoint>,
    ) -> BoundedCell {
        let spread = self.spread(&cell);
        let tip = self.machine.forward(&cell.middle, self.setup).tip;
        let mut bound = f64::NEG_INFINITY;
        bodies(&tip, spread.reach, &mut |nearest| {
            let depth = -nearest.distance;
            if best.map_or(least, |best| best.depth) < depth {
                *best = Some(DeepPoint { tip, depth, arrived: None });
            }
            bound = bound.max(depth + spread.towards(&nearest.normal));
        });
        BoundedCell { bound, cell, widest: spread.widest }
    }

    /// Returns the extent of a cell's tips about that of its middle.
    fn spread(&self, cell: &Cell) -> Spread {
        let tip_at = |axis: AxisIndex, by: f64| {
            let mut at = cell.middle;
            at[axis] += by;
            self.machine.forward(&at, self.setup).tip
        };
        let mut by = [Vector3::zeros(); MAX_AXES];
        let (mut turn, mut slide) = (0.0, 0.0);
        for axis in &self.axes {
            let half = cell.half[*axis];
            by[*axis] = (tip_at(*axis, half) - tip_at(*axis, -half)) / 2.0;
            match self.machine.axes.is_rotary(*axis) {
                true => turn += Deg(half).to_rad(),
                false => slide += by[*axis].norm(),
            }
        }
        let lever = if turn == 0.0 { 0.0 } else { self.machine.max_lever(&cell.middle, self.setup) + slide };
        let size = |axis: &AxisIndex| match self.machine.axes.is_rotary(*axis) {
            true => lever * Deg(cell.half[*axis]).to_rad(),
            false => by[*axis].norm(),
        };
        let widest = self.axes.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or_default();
        // Beyond a radian the tangents say nothing.
        if turn > 1.0 {
            let all = 2.0 * lever + slide;
            return Spread { by: [Vector3::zeros(); MAX_AXES], bend: all, reach: all, widest };
        }
        let bend = lever * turn * turn / 2.0 + slide * turn;
        Spread { by, bend, reach: by.iter().map(Vector3::norm).sum::<f64>() + bend, widest }
    }
}

/// Extent of the tips of a cell about that of its middle.
struct Spread {
    /// Half the travel due to each axis.
    by: [Vector3<f64>; MAX_AXES],
    /// Largest deviation from the sum of these, mm.
    bend: f64,
    /// Largest distance from the middle, mm.
    reach: f64,
    /// Axis along which the cell is widest.
    widest: AxisIndex,
}

impl Spread {
    /// Returns the largest travel against a normal.
    fn towards(&self, normal: &Vector3<f64>) -> f64 {
        self.by.iter().map(|by| by.dot(normal).abs()).sum::<f64>() + self.bend
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use gcode_part::Surface;

    fn at([x, y, z, b]: [f64; 4]) -> Position {
        Position([x, y, z, 0.0, b, 0.0, 0.0, 0.0])
    }

    fn deepest(surface: Surface, from: [f64; 4], to: [f64; 4]) -> Option<DeepPoint> {
        let (machine, setup) = (Machine::default(), Setup::default());
        let bodies =
            |p: &Point3<f64>, _: f64, each: &mut dyn FnMut(NearestPoint)| each(surface.nearest(p));
        AxisBox::new(&machine, &setup, &at(from), &at(to)).deepest(&bodies, 0.01)
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
        let block = Surface::Block { min: Point3::new(-100.0, -5.0, -95.0), max: Point3::new(100.0, 5.0, 95.0) };
        assert!(deepest(block, [160.0, 0.0, 0.0, 0.0], [145.0, 0.0, 0.0, 180.0]).is_none());
        // The corner of the box is 137.9 mm from B's axis.
        let corner = deepest(block, [160.0, 0.0, 0.0, 0.0], [130.0, 0.0, 0.0, 180.0]).unwrap();
        assert!(corner.arrived.is_none() && 1.0 < corner.depth, "{corner:?}");
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
            let bodies = |p: &Point3<f64>, _: f64, each: &mut dyn FnMut(NearestPoint)| each(body.nearest(p));
            let all = AxisBox::new(&machine, &setup, &at(from), &at(to));
            let mut best = None;
            let root = all.bounded(all.root(), &bodies, 0.01, &mut best);
            let found = all.deepest_inside(root, &bodies, 0.01, best);
            for t in samples {
                let position = at([0, 1, 2, 3].map(|i| from[i] + (to[i] - from[i]) * t[i]));
                let depth = -body.nearest(&machine.forward(&position, &setup).tip).distance;
                let is_found = found.is_some() || depth <= 0.01 + RESOLUTION + 1e-9;
                prop_assert!(is_found, "{} {:?}", depth, found);
            }
        }
    }
}
