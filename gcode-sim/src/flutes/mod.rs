//! Motion → flutes: follows a grinder's wheel on the burr and tells grinding from approach, retract and indexing.
//!
//! Feeds that turn A are grinding moves; whatever else moves lies between two passes.
mod dives;
mod trace;
mod turning;

use nalgebra::Point3;

use dives::{By, Dives, Moved};
pub use dives::{Dive, Kind, Plunge};
pub(crate) use trace::shorter;
pub use trace::{Sample, Trace, Window};
use turning::Turning;
pub use turning::{Begun, Idle};

use crate::diag::{Diagnostic, Severity};
use crate::holes::Unplaced;
use crate::holes::unplaced::Placing;
use crate::machine::path::Travel;
use crate::machine::{LinkMotion, Machine, Wheel};
use crate::motion::{Arc2, Axis, Event, EventKind, Place, Position, Sink};
use crate::part::flutes::Flutes;
use crate::units::{Deg, Rpm};

/// More moves than this aren't kept: no burr has so many, but a loop that never ends makes them.
const MOVES: usize = 500_000;
/// Points are kept of all passes together for so many goes over every wanted flute: no burr is ground in as many, …
const GOES: f64 = 40.0;
/// … but for so many at least, and never for more than this.
const KEPT: (f64, f64) = (20_000.0, 1_000_000.0);
/// So many times as many are computed in all, those between the passes included, and so many at least: turning and going
/// round between two passes takes more of them than a short flute has.
const COMPUTED: (usize, usize) = (4, 400_000);

/// How far apart the points of a pass are, and those between two passes, mm.
const APART: f64 = 0.05;
const APART_BETWEEN: f64 = 0.25;

/// What is left of the arithmetic's own rounding, mm.
pub const ARITHMETIC: f64 = 1e-6;

/// Why flutes can't be followed on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoGrinder {
    #[error(
        "the machine file has no [wheel], which grinds the burr: use the machine.toml next to the program"
    )]
    Wheel,
    #[error(
        "the machine file has no axis A that rotates the burr about its own axis (a [[table]] with turns = \"x\")"
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
    /// The first of its moves during which the wheel stood, and the first with M04 in force.
    pub idle: Option<Idle>,
    pub reversed: Option<Begun>,
    /// The speeds of the turning wheel, each from the move on that is the first with it.
    pub speeds: Vec<(Rpm, Begun)>,
}

/// What a program does to a burr.
#[derive(Clone, Debug, Default)]
pub struct Ground {
    pub passes: Vec<Pass>,
    /// The deepest of each block.
    pub dives: Vec<Dive>,
    /// The feeds into the blank behind which a pass begins.
    pub plunges: Vec<Plunge>,
    /// Rapids before the wheel first stood off the blank: where they began nobody knows, and nothing is said of them.
    pub unseen: usize,
    /// Rapids whose way isn't known because axes are sent to machine coordinates.
    pub unplaced: Option<Unplaced>,
    /// From the C axis to the end of the burr's cylinder, x and y, as the machine file has it; `None` without a C that turns
    /// about z.
    pub offset: Option<[f64; 2]>,
    /// Which way the axes run, by their letters: 1 or −1.
    pub signs: Vec<(char, f64)>,
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
    moved: Moved,
    open: Option<Pass>,
    ground: Ground,
    dives: Dives,
    turning: Turning,
    placing: Placing,
    moves: usize,
    /// Points kept of passes, and computed at all, and the most that may be.
    kept: usize,
    most_kept: usize,
    computed: usize,
    most_computed: usize,
    /// No more is looked at, and that is told.
    full: bool,
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
        let most_kept = (GOES * flutes.length() / APART).clamp(KEPT.0, KEPT.1) as usize;
        Ok(Self {
            machine,
            wheel,
            burr: turns.ok_or(NoGrinder::Burr)?,
            flutes,
            at: Position::default(),
            moved: Moved::default(),
            open: None,
            ground: Ground { offset: offset(machine), signs: signs(machine), ..Ground::default() },
            dives: Dives::default(),
            turning: Turning::default(),
            placing: Placing::default(),
            moves: 0,
            kept: 0,
            most_kept,
            computed: 0,
            most_computed: (COMPUTED.0 * most_kept).max(COMPUTED.1),
            full: false,
        })
    }

    pub fn finish(mut self) -> Ground {
        self.close();
        self.ground.unseen = self.dives.unseen;
        self.ground.plunges = std::mem::take(&mut self.dives.plunges);
        self.ground.dives = self.dives.finish();
        self.ground.unplaced = self.placing.finish(self.machine);
        self.ground
    }

    fn close(&mut self) {
        self.ground.passes.extend(self.open.take());
    }

    /// Tells once that nothing is looked at from here on.
    fn stop(&mut self, event: &Event<'_>, what: String) {
        self.full = true;
        let finding =
            Diagnostic::new(Severity::Alarm, "limit", format!("{what}: nothing after this is checked"));
        let finding = finding.help(
            "check for a loop that never ends or rotates the burr continuously; otherwise split the program",
        );
        self.ground.findings.push(finding.at(event.place()));
    }

    fn motion(&mut self, event: &Event<'_>, rapid: bool, to: &Position, arc: Option<&Arc2>) {
        let from = self.at;
        self.at = *to;
        if self.full || (from == *to && arc.is_none()) {
            return;
        }
        let (was, is) = self.placing.go();
        let before = self.moved;
        self.note_moved(&from, to);
        self.moves += 1;
        if self.moves > MOVES {
            return self.stop(event, format!("more than {MOVES} moves"));
        }
        if rapid && was | is != 0 {
            return self.jump(event, (was, is), to);
        }
        let travel = Travel { from: &from, to, arc };
        let grinds = !rapid && from[self.burr] != to[self.burr];
        let apart = if grinds { APART } else { APART_BETWEEN };
        let Some(steps) = self.steps(&travel, apart) else {
            return self.stop(event, format!("more than {} points of the wheel's path", self.most_computed));
        };
        if grinds && (self.most_kept - self.kept) as f64 <= steps {
            let what = format!("more than {} points of passes, one every {APART} mm", self.most_kept);
            return self.stop(event, what);
        }
        let Some(path) = self.points(&travel, steps) else {
            return self.stop(event, format!("more than {} points of the wheel's path", self.most_computed));
        };
        if !grinds {
            self.close();
            let turns = (from[self.burr] != to[self.burr]).then_some(self.ground.passes.len());
            let by = match rapid {
                true => By::Rapid { turns },
                false => By::Feed { seconds: event.seconds.0 },
            };
            self.dives.look(&self.flutes, event.place(), by, self.moved, &path);
            return;
        }
        self.kept = self.most_kept.min(self.kept + path.len());
        self.dives.ground(before);
        let head = self.wheel.angle(&from).zip(self.wheel.angle(to));
        let pass = self.open.get_or_insert_with(|| Pass {
            trace: Trace::default(),
            place: event.place(),
            moves: 0,
            head: None,
            idle: None,
            reversed: None,
            speeds: Vec::new(),
        });
        pass.moves += 1;
        pass.trace.follow(&self.flutes, &path, event.seconds.0, event.place());
        self.turning.note(pass, || Begun { place: event.place(), at: path[0] });
        if let Some((one, other)) = head {
            let (low, high) = if one < other { (one, other) } else { (other, one) };
            let (least, most) = pass.head.unwrap_or((low, high));
            pass.head = Some((if low < least { low } else { least }, if most < high { high } else { most }));
        }
    }

    /// A rapid from or to where nobody knows: only an end that is known is looked at.
    fn jump(&mut self, event: &Event<'_>, (was, is): (u8, u8), to: &Position) {
        self.close();
        self.placing.note_rapid(event, was | is);
        if is == 0 {
            let end = self.machine.contact(&self.wheel, to);
            self.dives.look(&self.flutes, event.place(), By::Rapid { turns: None }, self.moved, &[end, end]);
        }
    }

    /// Notes which axes move; how far the burr is turned about itself, no depth depends on.
    fn note_moved(&mut self, from: &Position, to: &Position) {
        let axes = self.machine.table.0.iter().map(|link| link.axis).filter(|axis| *axis != self.burr);
        let moved = axes.filter(|axis| from[*axis] != to[*axis]);
        self.moved.0 = moved.fold(self.moved.0, |mask, axis| mask | 1 << axis);
    }

    /// In how many steps a motion is looked at, so that no two points are farther apart than about `apart` mm; `None`
    /// where telling that takes too many of them.
    fn steps(&mut self, travel: &Travel<'_>, apart: f64) -> Option<f64> {
        // The length is measured first: by points a twelfth of a turn apart, for after whole turns all are in one place.
        let sweep = travel.arc.map_or(Deg::ZERO, |arc| arc.sweep.abs());
        let turn = self.machine.table.turned(travel.from, travel.to) + sweep;
        let first = self.points(travel, (turn.0 / 30.0).ceil().max(16.0))?;
        let length: f64 = first.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        Some((length / apart).ceil().max(4.0))
    }

    /// The contact on the burr in so many steps along a motion, one more if that is odd; `None` where that makes too
    /// many of them in all.
    fn points(&mut self, travel: &Travel<'_>, steps: f64) -> Option<Vec<Point3<f64>>> {
        if (self.most_computed.saturating_sub(self.computed)) as f64 <= steps + 2.0 {
            return None;
        }
        let steps = (steps as usize).next_multiple_of(2);
        self.computed += steps + 1;
        let at = |n: usize| travel.position(n as f64 / steps as f64);
        Some((0..=steps).map(|n| self.machine.contact(&self.wheel, &at(n))).collect())
    }
}

/// From the C axis to the part's origin while all axes stand at 0.
fn offset(machine: &Machine) -> Option<[f64; 2]> {
    let axis = machine.axes.find(b'C')?;
    let link = machine.table.0.iter().find(|link| link.axis == axis)?;
    match &link.motion {
        LinkMotion::Turn { about, centre } if about.z.abs() == 1.0 => {
            let from = machine.part.origin - centre;
            Some([from.x, from.y])
        }
        LinkMotion::Turn { .. } | LinkMotion::Slide { .. } => None,
    }
}

/// Of the axes that carry the burr, and of the one that swivels the wheel.
fn signs(machine: &Machine) -> Vec<(char, f64)> {
    let carry = machine.table.0.iter().map(|link| {
        let (LinkMotion::Turn { about: along, .. } | LinkMotion::Slide { along }) = &link.motion;
        (machine.axes.letter(link.axis), link.sign * along.sum().signum())
    });
    let swivels = machine.wheel.and_then(|wheel| wheel.swivels);
    carry.chain(swivels.map(|(axis, sign)| (machine.axes.letter(axis), sign))).collect()
}

impl Sink for Follower<'_> {
    fn event(&mut self, event: &Event<'_>) {
        match event.kind {
            EventKind::Rapid { to } => self.motion(event, true, to, None),
            EventKind::Feed { to, .. } | EventKind::Skip { to, .. } => self.motion(event, false, to, None),
            EventKind::Arc { to, arc, .. } => self.motion(event, false, to, Some(arc)),
            // How far the burr is turned about itself, no depth depends on.
            EventKind::Unplaced { axes } => self.placing.hear(self.machine, axes & !(1 << self.burr)),
            EventKind::Spindle { .. } | EventKind::Auxiliary { .. } => self.turning.hear(event.kind),
            EventKind::Dwell { .. }
            | EventKind::Tool { .. }
            | EventKind::ToolLength { .. }
            | EventKind::Coolant { .. }
            | EventKind::Stop { .. } => {}
        }
    }
}
