//! Motion that passes near the part without touching it: how near, which the verdict holds against the job's clearance.
use nalgebra::Point3;

use super::HoleExtractor;
use super::per_block::PerBlock;
use crate::machine::path::AxisMotion;
use crate::machine::{LinkMotion, Pose};
use gcode_lang::motion::{Backtrace, Event};
use gcode_lang::units::Deg;
use gcode_part::NearestPoint;
use gcode_part::Surface;

/// So near to the part nobody sets a tool, mm: a tool length or a part is easily off by as much.
pub const CONTACT_CLEARANCE: f64 = 0.1;

/// What rounding may take off a height that the reference says, mm.
pub const ROUNDING_ALLOWANCE: f64 = 0.01;

/// A straight way within 45° of the surface's normal leads to the part or away from it, not past it.
const STEEP_COSINE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A curved way is first cut into parts that stray from their chords by no more than this, mm, …
const CHORD_TOLERANCE: f64 = 5.0;

/// … and then into smaller ones until the nearest place is known to this, mm.
const DISTANCE_RESOLUTION: f64 = 1e-3;

/// What a block does near the part, where it comes nearest.
#[derive(Clone, Debug)]
pub struct CloseMotion {
    pub backtrace: Backtrace,
    pub kind: CloseMotionKind,
    /// From the tool's tip to the surface, mm; a little below 0 where it touches. Of [`CloseMotionKind::LowRetract`] along the tool.
    pub tip_clearance: f64,
    /// From the edge of the tool, were its end flat, where its direction and diameter are known, mm.
    pub edge_clearance: Option<f64>,
    /// How often the block came so near.
    pub count: u64,
}

/// How it passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CloseMotionKind {
    /// An axis turns the part or the head, by so much in all.
    RotaryTurn { letter: char, angle: Deg },
    /// An axis of the table turns while the tool has been retracted less far than the reference says.
    LowRetract { letter: char, angle: Deg },
    /// A rapid past the part.
    RapidPast,
    /// A rapid that ends there.
    RapidTowards,
}

/// One for each block and way, in the order in which they came up: the nearest.
#[derive(Debug, Default)]
pub(super) struct CloseMotions(PerBlock<u8, CloseMotion>);

impl CloseMotions {
    fn add(&mut self, event: &Event<'_>, way: CloseMotionKind, tip: f64, edge: Option<f64>) {
        let kind = match way {
            CloseMotionKind::RotaryTurn { .. } => 0,
            CloseMotionKind::RapidPast => 1,
            CloseMotionKind::RapidTowards => 2,
            CloseMotionKind::LowRetract { .. } => 3,
        };
        let passing = || CloseMotion {
            backtrace: event.backtrace(),
            kind: way,
            tip_clearance: tip,
            edge_clearance: edge,
            count: 0,
        };
        let (_, entry) = self.0.count(event.block, kind, passing);
        if tip < entry.value.tip_clearance {
            entry.value = passing();
        }
    }

    pub(super) fn finish(self) -> Vec<CloseMotion> {
        self.0.into_entries().map(|entry| CloseMotion { count: entry.count, ..entry.value }).collect()
    }
}

impl HoleExtractor<'_> {
    /// A straight rapid that stays out of the part: does it go past it, or end at it, nearer than anybody sets a tool?
    pub(super) fn record_close_rapid(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) {
        let limit = self
            .process_limits
            .approach
            .map_or(CONTACT_CLEARANCE, |approach| approach.max(CONTACT_CLEARANCE));
        if limit <= surface.clearance(from, to) {
            return;
        }
        let along = to - from;
        let part = surface.nearest_between(from, to);
        let nearest = surface.nearest(&(from + along * part));
        let steepness = nearest.normal.dot(&along) / along.norm();
        let way = match () {
            () if STEEP_COSINE < steepness => return,
            () if steepness < -STEEP_COSINE => CloseMotionKind::RapidTowards,
            () => CloseMotionKind::RapidPast,
        };
        if nearest.distance < CONTACT_CLEARANCE {
            self.close_motions.add(event, way, nearest.distance, None);
        } else if let (CloseMotionKind::RapidTowards, Some(approach)) = (way, self.process_limits.approach) {
            let above = height_above_surface(surface, &self.pose).unwrap_or(nearest.distance);
            if above < approach - ROUNDING_ALLOWANCE {
                self.close_motions.add(event, way, above, None);
            }
        }
    }

    /// A motion during which the table or the head turns, and which stays out of the part.
    pub(super) fn record_close_turn(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        travel: &AxisMotion<'_>,
    ) {
        let turned = self.machine.axes.iter().find(|(axis, _)| {
            travel.from[*axis] != travel.to[*axis]
                && self.machine.axes.is_rotary(*axis)
                && self.machine.is_axis_used(*axis)
        });
        let Some((axis, letter)) = turned else { return };
        let by = Deg(travel.to[axis] - travel.from[axis]).abs();
        let reach = self.machine.diameter_of(self.setup.tool).unwrap_or(0.0) / 2.0;
        let (clearance, retract) = (self.process_limits.clearance, self.process_limits.retract);
        let required_clearance = clearance.map_or(CONTACT_CLEARANCE, |clearance| {
            (clearance + ROUNDING_ALLOWANCE + reach).max(CONTACT_CLEARANCE)
        });
        let retract = retract.filter(|_| self.machine.table.has_axis(axis));
        let limit = retract.map_or(required_clearance, |retract| retract.max(required_clearance));
        let Some((tip, pose)) = self.closest_approach(surface, travel, limit) else { return };
        let edge = self.edge_distance(surface, &pose);
        let near = edge.map_or(tip, |edge| edge.min(tip));
        if tip < CONTACT_CLEARANCE
            || clearance.is_some_and(|clearance| near <= clearance + ROUNDING_ALLOWANCE)
        {
            self.close_motions.add(event, CloseMotionKind::RotaryTurn { letter, angle: by }, tip, edge);
            return;
        }
        // Beside the part the tool may be as low as it likes.
        let above = height_above_surface(surface, &pose);
        if let Some((above, retract)) = above.zip(retract)
            && 0.0 <= above
            && above < retract - ROUNDING_ALLOWANCE
        {
            self.close_motions.add(event, CloseMotionKind::LowRetract { letter, angle: by }, above, None);
        }
    }

    /// Where a curved way comes nearest to the surface, if that is nearer than `limit`.
    ///
    /// Along a chord the distance from a convex body is a convex function, so nowhere below both tangents at its ends, and
    /// the way is no nearer than its chord less what it strays from it. Parts that can't be nearer than what is known are
    /// left; halving the others quarters what they stray.
    fn closest_approach(
        &self,
        surface: &Surface,
        travel: &AxisMotion<'_>,
        limit: f64,
    ) -> Option<(f64, Pose)> {
        let end = |t: f64| {
            let pose = self.machine.forward(&travel.position(t), &self.setup);
            CurvePoint { t, pose, nearest: surface.nearest(&pose.tip) }
        };
        let mut best = end(0.0);
        if self.is_turn_about_part_axis(surface, travel) {
            return (best.nearest.distance < limit).then_some((best.nearest.distance, best.pose));
        }
        let steps = self.machine.chord_count(travel, &self.setup, CHORD_TOLERANCE);
        let ends: Vec<CurvePoint> = (0..=steps).map(|step| end(f64::from(step) / f64::from(steps))).collect();
        for one in &ends {
            best = best.nearer_of(*one);
        }
        let mut pending_chords: Vec<(CurvePoint, CurvePoint, f64)> =
            ends.windows(2).map(|pair| (pair[0], pair[1], CHORD_TOLERANCE)).collect();
        while let Some((from, to, stray)) = pending_chords.pop() {
            let least = from.chord_distance_bound(&to) - stray;
            let middle = (from.t + to.t) / 2.0;
            if limit <= least
                || best.nearest.distance - DISTANCE_RESOLUTION <= least
                || middle <= from.t
                || to.t <= middle
            {
                continue;
            }
            let middle = end(middle);
            best = best.nearer_of(middle);
            pending_chords.push((middle, to, stray / 4.0));
            pending_chords.push((from, middle, stray / 4.0));
        }
        (best.nearest.distance < limit).then_some((best.nearest.distance, best.pose))
    }

    /// Whether a motion turns the part about the axis of its own surface and does nothing else: the tool stays as far from
    /// it as it is.
    fn is_turn_about_part_axis(&self, surface: &Surface, travel: &AxisMotion<'_>) -> bool {
        let [link] = self.machine.table.0.as_slice() else { return false };
        let LinkMotion::Rotary { about, centre } = &link.motion else { return false };
        let moved = (0..travel.to.0.len()).filter(|axis| travel.from[*axis] != travel.to[*axis]);
        let part = self.machine.part.frame();
        let (about, centre) =
            (part.rotation.inverse_transform_unit_vector(about), part.inverse_transform_point(centre));
        travel.arc.is_none() && moved.eq([link.axis]) && surface.is_round(&centre, &about)
    }

    /// How far the edge of a flat end would be from the surface, on the side that leans towards it.
    fn edge_distance(&self, surface: &Surface, pose: &Pose) -> Option<f64> {
        let axis = pose.axis?;
        let diameter = self.machine.diameter_of(self.setup.tool)?;
        let normal = surface.nearest(&pose.tip).normal;
        let across = normal.into_inner() - axis.into_inner() * normal.dot(&axis);
        let towards = across.try_normalize(1e-9)? * (diameter / -2.0);
        Some(surface.nearest(&(pose.tip + towards)).distance)
    }
}

/// How high over the part the tip is along the tool; `None` where the tool's direction isn't known, or beside the part.
fn height_above_surface(surface: &Surface, pose: &Pose) -> Option<f64> {
    let axis = pose.axis?;
    let top = surface.exit(&pose.tip, &axis)?;
    Some((pose.tip - top).dot(&axis))
}

/// A place of a curved way.
#[derive(Clone, Copy)]
struct CurvePoint {
    /// The part of the way, 0 to 1.
    t: f64,
    pose: Pose,
    nearest: NearestPoint,
}

impl CurvePoint {
    fn nearer_of(self, other: Self) -> Self {
        if other.nearest.distance < self.nearest.distance { other } else { self }
    }

    /// No point of the chord to another end is nearer than this.
    fn chord_distance_bound(&self, to: &Self) -> f64 {
        let along = to.pose.tip - self.pose.tip;
        let (low, high) = (self.nearest.distance, to.nearest.distance);
        let (falling, rising) = (self.nearest.normal.dot(&along), to.nearest.normal.dot(&along));
        if falling >= 0.0 || rising <= 0.0 {
            return low.min(high);
        }
        // Where the tangents low + falling·t and high − rising·(1 − t) meet.
        low + falling * ((high - low - rising) / (falling - rising))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::machine::{Head, HeadKind, Machine};
    use gcode_lang::motion::Position;
    use gcode_lang::units::Deg;

    fn turning(surface: Surface) -> Machine {
        let link = match surface {
            Surface::Ellipsoid { .. } => nalgebra::Vector3::y_axis(),
            Surface::Cylinder { .. } => nalgebra::Vector3::x_axis(),
        };
        let mut machine = Machine {
            head: Head::new(HeadKind::Fixed(nalgebra::Vector3::z_axis()), 0.0),
            ..Machine::default()
        };
        if let LinkMotion::Rotary { about, .. } = &mut machine.table.0[0].motion {
            *about = link;
        }
        machine
    }

    fn at(values: [f64; 4]) -> Position {
        let mut at = Position::default();
        (at[0], at[1], at[2], at[4]) = (values[0], values[1], values[2], values[3]);
        at
    }

    fn nearest(machine: &Machine, surface: &Surface, from: &Position, to: &Position) -> f64 {
        let extractor = HoleExtractor::new(machine).with_surface(Some(*surface));
        let travel = AxisMotion { from, to, arc: None };
        extractor.closest_approach(surface, &travel, f64::INFINITY).unwrap().0
    }

    /// A tool at x 60, z 0 beside a sphere of 50 about the axis: 10 mm off however far B turns. Sent to x −60 meanwhile it
    /// stands at the centre half way.
    #[test]
    fn turns_worked_by_hand() {
        let sphere = Surface::Ellipsoid { a: 50.0, b: 50.0 };
        let machine = turning(sphere);
        let from = at([60.0, 0.0, 0.0, 0.0]);
        assert!((nearest(&machine, &sphere, &from, &at([60.0, 0.0, 0.0, 725.0])) - 10.0).abs() < 1e-9);
        assert!((nearest(&machine, &sphere, &from, &at([-60.0, 0.0, 0.0, 180.0])) + 50.0).abs() < 2e-3);
        assert!((nearest(&machine, &sphere, &from, &from) - 10.0).abs() < 1e-9, "no way at all");
        // The tip stands on the axis, above the pole: turning doesn't move it.
        let above = at([0.0, 53.0, 0.0, 0.0]);
        assert!((nearest(&machine, &sphere, &above, &at([0.0, 53.0, 0.0, 90.0])) - 3.0).abs() < 1e-9);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// No place of the way is nearer than what is found, and what is found is a place of the way.
        #[test]
        fn the_nearest_place_is_found(
            (a, b, cylinder) in (5.0..80.0, 5.0..80.0f64, any::<bool>()),
            ends in prop::array::uniform6(-120.0..120.0f64),
            turns in (-400.0..400.0f64, -400.0..400.0f64),
            aside in prop::array::uniform3(-20.0..20.0f64),
        ) {
            let (a, b): (f64, f64) = (a, b);
            let surface = if cylinder { Surface::Cylinder { radius: a } } else { Surface::Ellipsoid { a, b } };
            let mut machine = turning(surface);
            machine.part.shift = nalgebra::Vector3::new(aside[0], aside[1], aside[2]);
            machine.part.tilt = [Deg(aside[2]), Deg(aside[0]), Deg(aside[1])];
            let from = at([ends[0], ends[1], ends[2], turns.0]);
            let to = at([ends[3], ends[4], ends[5], turns.1]);
            let found = nearest(&machine, &surface, &from, &to);
            let travel = AxisMotion { from: &from, to: &to, arc: None };
            let mut least = f64::INFINITY;
            for step in 0..=1000 {
                let tip = machine.forward(&travel.position(f64::from(step) / 1000.0), &crate::machine::Setup::default()).tip;
                least = least.min(surface.nearest(&tip).distance);
            }
            prop_assert!(found <= least + DISTANCE_RESOLUTION, "{} {}", found, least);
            // Between two of so many places it may be a little nearer.
            prop_assert!(least <= found + 2.0, "{} {}", found, least);
        }
    }
}
