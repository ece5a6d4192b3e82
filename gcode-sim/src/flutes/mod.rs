//! Motion → flutes: follows a grinder's wheel on the burr and tells grinding from approach, retract and indexing.
//!
//! Feeds that turn A are grinding moves; whatever else moves lies between two passes.
mod trace;

use nalgebra::Point3;

pub use trace::{Sample, Trace, Window, gauge};

use crate::diag::{Diagnostic, Severity};
use crate::machine::path::Travel;
use crate::machine::{LinkMotion, Machine, Wheel};
use crate::motion::{Arc2, Axis, Event, EventKind, Place, Position, Sink};
use crate::part::flutes::Flutes;
use crate::part::profile::Profile;
use crate::units::Deg;

/// More moves than this aren't kept: no burr has so many, but a loop that never ends makes them.
const MOVES: usize = 500_000;

/// What is left of the arithmetic's own rounding, mm.
pub const ARITHMETIC: f64 = 1e-6;

/// Why flutes can't be followed on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoGrinder {
    #[error(
        "the machine file has no [wheel], which a burr is ground by: use the machine.toml that stands beside the program"
    )]
    Wheel,
    #[error(
        "the machine file has no axis A that turns the burr about its own axis (a [[table]] with turns = \"x\")"
    )]
    Burr,
}

/// One pass of the wheel, in contact from end to end.
#[derive(Clone, Debug)]
pub struct Pass {
    pub trace: Trace,
    /// Where it begins.
    pub place: Place,
    pub moves: usize,
    /// The least and the greatest angle of the swivelled wheel during the pass, where an axis swivels it.
    pub head: Option<(Deg, Deg)>,
}

/// Where the wheel came too near between two passes: in rapid motion to the blank, else below the tooth bottom.
#[derive(Clone, Debug)]
pub struct Dive {
    pub place: Place,
    /// Where it was nearest: below the blank's surface, or below the tooth bottom, mm.
    pub depth: f64,
    pub rapid: bool,
}

/// What a program does to a burr.
#[derive(Clone, Debug, Default)]
pub struct Ground {
    pub passes: Vec<Pass>,
    /// The deepest of each block.
    pub dives: Vec<Dive>,
    pub findings: Vec<Diagnostic>,
}

/// Listens to a run and follows the contact on the burr.
#[derive(Debug)]
pub struct Follower<'m> {
    machine: &'m Machine,
    wheel: Wheel,
    /// The axis that turns the burr about itself.
    burr: Axis,
    flutes: Flutes,
    at: Position,
    open: Option<Pass>,
    ground: Ground,
    moves: usize,
    /// The wheel has been off the blank: what moves before that, nobody knows where it stood.
    outside: bool,
}

impl<'m> Follower<'m> {
    /// Starts with every axis at machine zero.
    ///
    /// # Errors
    /// A machine without a wheel, or without an A that turns the burr.
    pub fn new(machine: &'m Machine, flutes: Flutes) -> Result<Self, NoGrinder> {
        let wheel = machine.wheel.ok_or(NoGrinder::Wheel)?;
        let turns = machine.axes.find(b'A').filter(|axis| {
            let of_axis = |link: &&crate::machine::Link| link.axis == *axis;
            machine.table.0.iter().find(of_axis).is_some_and(|l| matches!(l.motion, LinkMotion::Turn { .. }))
        });
        Ok(Self {
            machine,
            wheel,
            burr: turns.ok_or(NoGrinder::Burr)?,
            flutes,
            at: Position::default(),
            open: None,
            ground: Ground::default(),
            moves: 0,
            outside: false,
        })
    }

    pub fn finish(mut self) -> Ground {
        self.close();
        self.ground
    }

    fn close(&mut self) {
        self.ground.passes.extend(self.open.take());
    }

    fn motion(&mut self, event: &Event<'_>, rapid: bool, to: &Position, arc: Option<&Arc2>) {
        let from = self.at;
        self.at = *to;
        self.moves += 1;
        if self.moves > MOVES {
            if self.moves == MOVES + 1 {
                let message = format!("more than {MOVES} moves: those from here on aren't looked at");
                let finding = Diagnostic::new(Severity::Alarm, "limit", message).at(event.place());
                self.ground.findings.push(finding.help("does a loop never end? else split the program"));
            }
            return;
        }
        let travel = Travel { from: &from, to, arc };
        if rapid || from[self.burr] == to[self.burr] {
            self.close();
            self.look_for_dives(event, rapid, &travel);
            return;
        }
        let path = self.path(&travel, 0.05);
        let head = self.wheel.angle(&from).zip(self.wheel.angle(to));
        let pass = self.open.get_or_insert_with(|| Pass {
            trace: Trace::default(),
            place: event.place(),
            moves: 0,
            head: None,
        });
        pass.moves += 1;
        pass.trace.follow(&self.flutes, &path, || event.place());
        if let Some((one, other)) = head {
            let (low, high) = if one < other { (one, other) } else { (other, one) };
            let (least, most) = pass.head.unwrap_or((low, high));
            pass.head = Some((if low < least { low } else { least }, if most < high { high } else { most }));
        }
    }

    /// The contact on the burr along a motion, no two points farther apart than about `apart` mm.
    fn path(&self, travel: &Travel<'_>, apart: f64) -> Vec<Point3<f64>> {
        let at = |n: usize, of: usize| {
            let position = travel.position(n as f64 / of as f64);
            self.machine.contact(&self.wheel, &position)
        };
        let coarse: Vec<_> = (0..=16).map(|n| at(n, 16)).collect();
        let length: f64 = coarse.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let steps = ((length / apart).ceil() as usize).clamp(4, 8192).next_multiple_of(2);
        (0..=steps).map(|n| at(n, steps)).collect()
    }

    /// Rapid motion keeps off the blank, everything that is no grinding off the tooth bottom.
    fn look_for_dives(&mut self, event: &Event<'_>, rapid: bool, travel: &Travel<'_>) {
        let profile: &Profile = &self.flutes.profile;
        let path = self.path(travel, 0.25);
        let known = self.outside;
        self.outside |= path.last().is_some_and(|p| self.flutes.tooth_depth < profile.distance(p));
        if !known {
            return;
        }
        let distance = |p: &Point3<f64>| profile.distance(p);
        let nearest = path.iter().map(distance).fold(f64::INFINITY, f64::min);
        if !rapid {
            if nearest < -self.flutes.surface_tolerance - ARITHMETIC {
                self.ground.dives.push(Dive { place: event.place(), depth: -nearest, rapid });
            }
            return;
        }
        // A rapid that goes straight out of the cut begins on the tooth bottom.
        let leaves = path.windows(2).all(|pair| distance(&pair[0]) < distance(&pair[1]));
        let starts = path.first().map_or(0.0, distance);
        if leaves && -self.flutes.surface_tolerance - ARITHMETIC < starts {
            return;
        }
        let depth = self.flutes.tooth_depth - nearest;
        if -ARITHMETIC < depth {
            self.ground.dives.push(Dive { place: event.place(), depth: depth.max(0.0), rapid });
        }
    }
}

impl Sink for Follower<'_> {
    fn event(&mut self, event: &Event<'_>) {
        match &event.kind {
            EventKind::Rapid { to } => self.motion(event, true, to, None),
            EventKind::Feed { to, .. } | EventKind::Skip { to, .. } => self.motion(event, false, to, None),
            EventKind::Arc { to, arc, .. } => self.motion(event, false, to, Some(arc)),
            EventKind::Dwell { .. }
            | EventKind::Tool { .. }
            | EventKind::ToolLength { .. }
            | EventKind::Spindle { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. }
            | EventKind::Stop { .. } => {}
        }
    }
}
