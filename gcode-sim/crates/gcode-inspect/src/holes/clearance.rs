//! Motion near the part without contact: its clearance, for comparison with the job's.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::per_block::PerBlock;
use super::strip::Line;
use super::swept_tool::ring;
use super::tool_change::{RING_POINTS, WALL_DISTANCE};
use crate::machine::{AxisMotion, LinkMotion, Pose, TOUCH_DEPTH, ToolPart};
use gcode_lang::motion::{AxisIndex, Backtrace, Event};
use gcode_lang::units::Deg;
use gcode_part::{NearestPoint, Surface};

/// Clearance below which a small error of tool length or part position makes contact, mm.
pub(crate) const CONTACT_CLEARANCE: f64 = 0.1;

/// Effect of rounding on a specified height, mm.
pub(crate) const ROUNDING_ALLOWANCE: f64 = 0.01;

/// Cosine to the surface normal above which a straight path leads to the part or away from it, not past it: 45°.
const STEEP_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Largest deviation of a curved path from its first chords, mm.
const FIRST_CHORD_TOLERANCE: f64 = 5.0;

/// Resolution of the least distance of a curved path, mm.
const DISTANCE_RESOLUTION: f64 = 1e-3;

/// Closest approach of one block to the part without cutting.
#[derive(Clone, Debug)]
pub(crate) struct CloseMotion {
    /// Block, and the calls that led to it.
    pub backtrace: Backtrace,
    /// Kind of the motion.
    pub kind: CloseMotionKind,
    /// Distance from tool tip to surface, mm; slightly negative on contact. For [`CloseMotionKind::LowRetract`], along
    /// the tool axis.
    pub tip_clearance: f64,
    /// Distance from the edge of a flat-ended tool to the surface, mm; `None` if direction or diameter is unknown.
    pub edge_clearance: Option<f64>,
    /// Number of executions of the block that come this close.
    pub count: u64,
}

/// Kind of a motion near the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CloseMotionKind {
    /// Rotation of the part or the head by `angle` in all.
    RotaryTurn { letter: char, angle: Deg },
    /// Rotation of the table with the tool retracted less than the reference specifies.
    LowRetract { letter: char, angle: Deg },
    /// Rapid past the part.
    RapidPast,
    /// Rapid that ends near the part.
    RapidTowards,
}

/// The closest approach of each block and kind, in order of first occurrence.
#[derive(Debug, Default)]
pub(super) struct CloseMotions(PerBlock<u8, CloseMotion>);

impl CloseMotions {
    fn add(&mut self, event: &Event<'_>, kind: CloseMotionKind, tip_clearance: f64, edge: Option<f64>) {
        let key = match kind {
            CloseMotionKind::RotaryTurn { .. } => 0,
            CloseMotionKind::RapidPast => 1,
            CloseMotionKind::RapidTowards => 2,
            CloseMotionKind::LowRetract { .. } => 3,
        };
        let motion = || CloseMotion {
            backtrace: event.backtrace(),
            kind,
            tip_clearance,
            edge_clearance: edge,
            count: 0,
        };
        let (_, entry) = self.0.count(event.block, key, motion);
        if tip_clearance < entry.value.tip_clearance {
            entry.value = motion();
        }
    }

    pub(super) fn finish(self) -> Vec<CloseMotion> {
        self.0.into_entries().map(|entry| CloseMotion { count: entry.count, ..entry.value }).collect()
    }
}

impl HoleExtractor<'_> {
    /// Records a straight rapid outside the part that passes it or ends at it too close.
    pub(super) fn record_close_rapid(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) {
        let approach = self.process_limits.approach;
        let is_near = surface.clearance(from, to) < approach.unwrap_or(0.0).max(CONTACT_CLEARANCE);
        if !is_near || self.change_retract.is_checked() {
            return;
        }
        let along = to - from;
        let nearest = surface.nearest(&(from + along * surface.nearest_between(from, to)));
        let steepness = nearest.normal.dot(&along) / along.norm();
        if STEEP_COSINE < steepness {
            return;
        }
        let is_towards = steepness < -STEEP_COSINE;
        if nearest.distance < CONTACT_CLEARANCE {
            let depth = nearest.distance + CONTACT_CLEARANCE + TOUCH_DEPTH;
            if self.is_milled_away(&[*from, *to], &nearest.normal, depth) {
                return;
            }
            let kind = if is_towards { CloseMotionKind::RapidTowards } else { CloseMotionKind::RapidPast };
            self.close_motions.add(event, kind, nearest.distance, None);
        } else if let (true, Some(approach)) = (is_towards, approach) {
            let above = height_above_surface(surface, &self.pose).unwrap_or(nearest.distance);
            if above < approach - ROUNDING_ALLOWANCE {
                self.close_motions.add(event, CloseMotionKind::RapidTowards, above, None);
            }
        }
    }

    /// Returns true if the blank has lost its metal at a depth below a travel, and round it as far as the tool reaches; false for a
    /// tool of unknown diameter.
    fn is_milled_away(&self, travel: &Line, normal: &Unit<Vector3<f64>>, depth: f64) -> bool {
        let shifted = |by: Vector3<f64>| travel.map(|point| point - normal.into_inner() * depth + by);
        let below = shifted(Vector3::zeros());
        let Some(own) = self.tool_radius() else { return false };
        // What is higher on the tool is above the surface.
        let rise = self.pose.axis.map_or(0.0, |axis| axis.dot(normal).max(0.0));
        let low = self.tool_body.iter().filter(|part| part.from * rise <= CONTACT_CLEARANCE);
        let radius = low.map(ToolPart::radius).fold(own, f64::max) + WALL_DISTANCE;
        let round = || ring(normal, &Vector3::zeros(), radius, RING_POINTS).into_iter().map(shifted);
        self.metal.is_solid(&below)
            && self.metal.uncut(&below).is_none()
            && round().all(|line| self.metal.uncut(&line).is_none())
    }

    /// Records a motion outside the part during which the table or the head rotates too close to it.
    pub(super) fn record_close_turn(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        travel: &AxisMotion<'_>,
    ) {
        let rotates = self.machine.axes.iter().find(|(axis, _)| {
            travel.from[*axis] != travel.to[*axis]
                && self.machine.axes.is_rotary(*axis)
                && self.machine.is_axis_used(*axis)
        });
        let Some((axis, letter)) = rotates else { return };
        let angle = Deg(travel.to[axis] - travel.from[axis]).abs();
        let reach = self.machine.diameter_of(self.setup.tool).unwrap_or(0.0) / 2.0;
        let clearance = self.process_limits.clearance.map(|clearance| clearance + ROUNDING_ALLOWANCE);
        let retract = self.process_limits.retract.filter(|_| self.machine.table.has_axis(axis));
        let limit = clearance.map_or(0.0, |clearance| clearance + reach).max(CONTACT_CLEARANCE);
        let limit = retract.map_or(limit, |retract| retract.max(limit));
        let Some((tip, pose)) = self.closest_approach(surface, travel, limit) else { return };
        let edge = self.edge_distance(surface, &pose);
        let near = edge.map_or(tip, |edge| edge.min(tip));
        if tip < CONTACT_CLEARANCE || clearance.is_some_and(|clearance| near <= clearance) {
            self.close_motions.add(event, CloseMotionKind::RotaryTurn { letter, angle }, tip, edge);
            return;
        }
        // Beside the part any height is safe.
        let above = height_above_surface(surface, &pose).filter(|above| 0.0 <= *above);
        if let Some((above, retract)) = above.zip(retract)
            && above < retract - ROUNDING_ALLOWANCE
        {
            self.close_motions.add(event, CloseMotionKind::LowRetract { letter, angle }, above, None);
        }
    }

    /// Returns the least distance of a path from the surface and the pose there, if it is below `limit`.
    ///
    /// Along a chord the distance from a convex body is a convex function: it is nowhere below both tangents at the ends
    /// of the chord, and the path is no nearer than its chord minus their deviation. Chords that cannot be nearer than
    /// the best distance are skipped; halving the others quarters the deviation.
    fn closest_approach(
        &self,
        surface: &Surface,
        travel: &AxisMotion<'_>,
        limit: f64,
    ) -> Option<(f64, Pose)> {
        let point = |t: f64| {
            let pose = self.machine.forward(&travel.position(t), &self.setup);
            CurvePoint { t, pose, nearest: surface.nearest(&pose.tip) }
        };
        // A rotation about the surface's own axis keeps the distance.
        let steps = match self.is_turn_about_part_axis(travel) {
            true => 0,
            false => self.machine.chord_count(travel, &self.setup, FIRST_CHORD_TOLERANCE),
        };
        let ends: Vec<CurvePoint> =
            (0..=steps).map(|step| point(f64::from(step) / f64::from(steps.max(1)))).collect();
        let mut best = ends.iter().copied().reduce(CurvePoint::nearer_of)?;
        let mut pending_chords: Vec<(CurvePoint, CurvePoint, f64)> =
            ends.windows(2).map(|pair| (pair[0], pair[1], FIRST_CHORD_TOLERANCE)).collect();
        while let Some((from, to, deviation)) = pending_chords.pop() {
            let bound = from.chord_distance_bound(&to) - deviation;
            let middle = (from.t + to.t) / 2.0;
            if limit <= bound
                || best.nearest.distance - DISTANCE_RESOLUTION <= bound
                || middle <= from.t
                || to.t <= middle
            {
                continue;
            }
            let middle = point(middle);
            best = best.nearer_of(middle);
            pending_chords.push((middle, to, deviation / 4.0));
            pending_chords.push((from, middle, deviation / 4.0));
        }
        (best.nearest.distance < limit).then_some((best.nearest.distance, best.pose))
    }

    /// Returns true if a motion only rotates the part about the axis of its own surface.
    fn is_turn_about_part_axis(&self, travel: &AxisMotion<'_>) -> bool {
        let mut moved = (0..travel.to.0.len()).filter(|axis| travel.from[*axis] != travel.to[*axis]);
        travel.arc.is_none() && moved.next() == self.axis_about_part() && moved.next().is_none()
    }

    /// Returns the only axis of the table if it rotates the part about the axis of its own surface.
    pub(super) fn axis_about_part(&self) -> Option<AxisIndex> {
        let surface = self.surface?;
        let [link] = self.machine.table.0.as_slice() else { return None };
        let LinkMotion::Rotary { about, centre } = &link.motion else { return None };
        let part = self.machine.part.frame();
        let (about, centre) =
            (part.rotation.inverse_transform_unit_vector(about), part.inverse_transform_point(centre));
        surface.is_round(&centre, &about).then_some(link.axis)
    }

    /// Returns the distance from the edge of a flat end to the surface, on the side that is inclined towards it; `None`
    /// if direction or diameter is unknown.
    fn edge_distance(&self, surface: &Surface, pose: &Pose) -> Option<f64> {
        let axis = pose.axis?;
        let diameter = self.machine.diameter_of(self.setup.tool)?;
        let normal = surface.nearest(&pose.tip).normal;
        let across = normal.into_inner() - axis.into_inner() * normal.dot(&axis);
        let towards = across.try_normalize(1e-9)? * (diameter / -2.0);
        Some(surface.nearest(&(pose.tip + towards)).distance)
    }
}

/// Returns the height of the tip above the part along the tool; `None` beside the part, and if the direction of the tool
/// is unknown.
fn height_above_surface(surface: &Surface, pose: &Pose) -> Option<f64> {
    let axis = pose.axis?;
    let top = surface.exit(&pose.tip, &axis)?;
    Some((pose.tip - top).dot(&axis))
}

/// Point of a path.
#[derive(Clone, Copy)]
struct CurvePoint {
    /// Fraction of the path, 0 to 1.
    t: f64,
    pose: Pose,
    nearest: NearestPoint,
}

impl CurvePoint {
    fn nearer_of(self, other: Self) -> Self {
        if other.nearest.distance < self.nearest.distance { other } else { self }
    }

    /// Returns a lower bound of the distance from the chord to another point.
    fn chord_distance_bound(&self, to: &Self) -> f64 {
        let along = to.pose.tip - self.pose.tip;
        let (low, high) = (self.nearest.distance, to.nearest.distance);
        let (falling, rising) = (self.nearest.normal.dot(&along), to.nearest.normal.dot(&along));
        if falling >= 0.0 || rising <= 0.0 {
            return low.min(high);
        }
        // Intersection of the tangents low + falling·t and high − rising·(1 − t).
        low + falling * ((high - low - rising) / (falling - rising))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;
    use crate::machine::{AxisLink, Chain, Head, HeadKind, Machine, Setup};
    use gcode_lang::motion::Position;

    fn machine_for(surface: Surface) -> Machine {
        let about = match surface {
            Surface::Ellipsoid { .. } => Vector3::y_axis(),
            _ => Vector3::x_axis(),
        };
        Machine {
            head: Head::new(HeadKind::Fixed(Vector3::z_axis()), 0.0),
            table: Chain(vec![AxisLink::rotary(4, about, Point3::origin(), 1.0)]),
            ..Machine::default()
        }
    }

    fn at([x, y, z, b]: [f64; 4]) -> Position {
        Position([x, y, z, 0.0, b, 0.0, 0.0, 0.0])
    }

    fn nearest(machine: &Machine, surface: &Surface, from: &Position, to: &Position) -> f64 {
        let extractor = HoleExtractor::new(machine).with_surface(Some(*surface));
        let travel = AxisMotion { from, to, arc: None };
        extractor.closest_approach(surface, &travel, f64::INFINITY).unwrap().0
    }

    /// A tool at x 60, z 0 next to a sphere of 50 about the axis is 10 mm off for any rotation of B. If it moves to x −60
    /// meanwhile, it passes the centre half way.
    #[test]
    fn least_distances_are_those_computed_by_hand() {
        let sphere = Surface::Ellipsoid { a: 50.0, b: 50.0 };
        let machine = machine_for(sphere);
        let from = at([60.0, 0.0, 0.0, 0.0]);
        assert!((nearest(&machine, &sphere, &from, &at([60.0, 0.0, 0.0, 725.0])) - 10.0).abs() < 1e-9);
        assert!((nearest(&machine, &sphere, &from, &at([-60.0, 0.0, 0.0, 180.0])) + 50.0).abs() < 2e-3);
        assert!((nearest(&machine, &sphere, &from, &from) - 10.0).abs() < 1e-9, "no motion");
        // The tip is on the axis, above the pole: a rotation does not move it.
        let above = at([0.0, 53.0, 0.0, 0.0]);
        assert!((nearest(&machine, &sphere, &above, &at([0.0, 53.0, 0.0, 90.0])) - 3.0).abs() < 1e-9);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// No point of the path is nearer than the result, and the result is the distance of a point of the path.
        #[test]
        fn the_least_distance_is_that_of_the_nearest_point(
            (a, b, cylinder) in (5.0..80.0, 5.0..80.0f64, any::<bool>()),
            ends in prop::array::uniform6(-120.0..120.0f64),
            turns in (-400.0..400.0f64, -400.0..400.0f64),
            aside in prop::array::uniform3(-20.0..20.0f64),
        ) {
            let (a, b): (f64, f64) = (a, b);
            let surface = if cylinder { Surface::Cylinder { radius: a } } else { Surface::Ellipsoid { a, b } };
            let mut machine = machine_for(surface);
            machine.part.shift = Vector3::new(aside[0], aside[1], aside[2]);
            machine.part.tilt = [Deg(aside[2]), Deg(aside[0]), Deg(aside[1])];
            let from = at([ends[0], ends[1], ends[2], turns.0]);
            let to = at([ends[3], ends[4], ends[5], turns.1]);
            let found = nearest(&machine, &surface, &from, &to);
            let travel = AxisMotion { from: &from, to: &to, arc: None };
            let mut least = f64::INFINITY;
            for step in 0..=1000 {
                let tip = machine.forward(&travel.position(f64::from(step) / 1000.0), &Setup::default()).tip;
                least = least.min(surface.nearest(&tip).distance);
            }
            prop_assert!(found <= least + DISTANCE_RESOLUTION, "{} {}", found, least);
            // Between two of the points the path may be a little nearer.
            prop_assert!(least <= found + 2.0, "{} {}", found, least);
        }
    }
}
