//! Motion that passes near the part without touching it: how near, which the verdict holds against the job's clearance.
use std::collections::BTreeMap;

use nalgebra::Point3;

use super::Extractor;
use super::rapids::TOUCH;
use crate::machine::Pose;
use crate::machine::path::Travel;
use crate::motion::{Event, Place};
use crate::part::surface::Surface;
use crate::units::Deg;

/// Turns are kept where the tool comes this near to the part, in mm, …
const TURNS: f64 = 5.0;

/// … and straight rapids where it does this, in mm: a tool length or a part is easily off by as much.
pub const CONTACT: f64 = 0.1;

/// A straight way within 45° of the surface's normal leads to the part or away from it, not past it.
const STEEP: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// So many make a part of a way as small as an increment.
const THIRDS: u32 = 30;

/// What a block does near the part, where it comes nearest.
#[derive(Clone, Debug)]
pub struct Passing {
    pub place: Place,
    pub way: Way,
    /// From the tool's tip to the surface, mm; a little below 0 where it touches.
    pub tip: f64,
    /// From the edge of the tool, were its end flat, where its direction and diameter are known, mm.
    pub edge: Option<f64>,
    /// How often the block came so near.
    pub times: u64,
}

/// How it passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// An axis turns the part or the head, by so much in all.
    Turning { letter: char, by: Deg },
    /// A rapid past the part.
    Past,
    /// A rapid that ends there.
    Towards,
}

/// One for each block and way, in the order in which they came up.
#[derive(Debug, Default)]
pub(super) struct Passings {
    list: Vec<Passing>,
    /// By the block, and how it passes.
    seen: BTreeMap<(u32, u32, u8), usize>,
}

impl Passings {
    fn add(&mut self, event: &Event<'_>, way: Way, tip: f64, edge: Option<f64>) {
        let kind = match way {
            Way::Turning { .. } => 0,
            Way::Past => 1,
            Way::Towards => 2,
        };
        let key = (event.block.source.0, event.block.start, kind);
        match self.seen.get(&key).map(|index| &mut self.list[*index]) {
            Some(known) => {
                known.times += 1;
                if tip < known.tip {
                    (known.place, known.way, known.tip, known.edge) = (event.place(), way, tip, edge);
                }
            }
            None => {
                self.seen.insert(key, self.list.len());
                self.list.push(Passing { place: event.place(), way, tip, edge, times: 1 });
            }
        }
    }

    pub(super) fn finish(self) -> Vec<Passing> {
        self.list
    }
}

impl Extractor<'_> {
    /// A straight rapid that stays out of the part: does it go past it, or end at it, nearer than anybody sets a tool?
    pub(super) fn note_straight(
        &mut self,
        event: &Event<'_>,
        surface: &Surface,
        from: &Point3<f64>,
        to: &Point3<f64>,
    ) {
        if CONTACT <= surface.clearance(from, to) {
            return;
        }
        let along = to - from;
        let part = surface.nearest_between(from, to);
        let nearest = surface.nearest(&(from + along * part));
        let steepness = nearest.normal.dot(&along) / along.norm();
        let way = match () {
            () if CONTACT <= nearest.distance => return,
            () if STEEP < steepness => return,
            () if steepness < -STEEP => Way::Towards,
            () => Way::Past,
        };
        self.passings.add(event, way, nearest.distance, None);
    }

    /// A motion during which the table or the head turns, and which stays out of the part.
    pub(super) fn note_turn(&mut self, event: &Event<'_>, surface: &Surface, travel: &Travel<'_>) {
        let turned = self.machine.axes.iter().find(|(axis, _)| {
            travel.from[*axis] != travel.to[*axis]
                && self.machine.axes.is_rotary(*axis)
                && self.machine.carries(*axis)
        });
        let Some((axis, letter)) = turned else { return };
        let Some((tip, pose)) = self.nearest_on(surface, travel) else { return };
        let by = Deg(travel.to[axis] - travel.from[axis]).abs();
        let edge = self.edge(surface, &pose);
        self.passings.add(event, Way::Turning { letter, by }, tip, edge);
    }

    /// Where a curved way comes nearest to the surface, if that is near.
    fn nearest_on(&self, surface: &Surface, travel: &Travel<'_>) -> Option<(f64, Pose)> {
        // Coarse chords first: most ways stay far away.
        let mut nearest = (0u32, 0u32);
        for tolerance in [40.0, 5.0, 0.5, TOUCH] {
            let mut last: Option<Pose> = None;
            let mut least = f64::INFINITY;
            let mut steps = 0;
            self.machine.follow(travel, &self.setup, tolerance, |pose| {
                if let Some(from) = last.replace(pose) {
                    steps += 1;
                    let bound = surface.clearance(&from.tip, &pose.tip);
                    if bound < least {
                        least = bound;
                        nearest.0 = steps;
                    }
                }
            });
            nearest.1 = steps;
            if TURNS + tolerance < least {
                return None;
            }
        }
        // On the nearest chord's part of the way the distance falls and rises again: thirds close in on the least.
        let pose = |t: f64| self.machine.forward(&travel.position(t), &self.setup);
        let distance = |t: f64| surface.nearest(&pose(t).tip).distance;
        let share = |step: u32| f64::from(step) / f64::from(nearest.1);
        let (mut low, mut high) = (share(nearest.0.saturating_sub(1)), share(nearest.0));
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            match distance(low + third) <= distance(high - third) {
                true => high -= third,
                false => low += third,
            }
        }
        let least = distance(low);
        (least < TURNS).then(|| (least, pose(low)))
    }

    /// How far the edge of a flat end would be from the surface, on the side that leans towards it.
    fn edge(&self, surface: &Surface, pose: &Pose) -> Option<f64> {
        let axis = pose.axis?;
        let diameter = self.machine.find_tool(self.setup.tool?)?.diameter?;
        let normal = surface.nearest(&pose.tip).normal;
        let across = normal.into_inner() - axis.into_inner() * normal.dot(&axis);
        let towards = across.try_normalize(1e-9)? * (diameter / -2.0);
        Some(surface.nearest(&(pose.tip + towards)).distance)
    }
}
