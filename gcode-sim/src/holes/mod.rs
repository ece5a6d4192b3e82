//! Motion → holes: follows the tool on the part, sees feeds along one line as passes, and passes as holes.
mod clamping;
mod cutting;
mod findings;
mod group;
mod judge;
mod line;
mod linked;
mod machine_words;
pub mod near;
mod passing;
pub(crate) mod per_block;
mod probing;
mod rapids;
mod reaches;
#[cfg(test)]
pub(crate) mod script;
pub(crate) mod spindle;
#[cfg(test)]
mod tests;
pub(crate) mod unplaced;

use nalgebra::Point3;

pub use cutting::Cutting;
pub use group::Found;
use group::Pass;
use line::{After, Line};
pub(crate) use machine_words::unclear_head;
pub use passing::{CONTACT, Passing, ROUNDED, Way};
pub use reaches::Reach;
pub use unplaced::Unplaced;

use self::clamping::Hold;
use self::cutting::{Cuttings, InForce};
use self::findings::Findings;
use self::passing::Passings;
use self::rapids::{Curved, TOUCH};
use self::reaches::Reaches;
use self::unplaced::Placing;
use crate::diag::{Diagnostic, Severity};
use crate::machine::path::Travel;
use crate::machine::{Frame, Machine, Pose, Setup};
use crate::motion::{Arc2, Event, EventKind, Place, Position, Signal, Sink, SkipFeed, Spindle, StopKind};
use crate::part::conduct::Conduct;
use crate::part::hole::{Hole, HoleList, Origin, Unit};
use crate::part::surface::Surface;
use crate::source::Span;
use crate::units::Rpm;

/// More passes than this aren't kept: no part has so many holes, but a loop that never ends drills them, and must not
/// fill the memory.
const PASSES: usize = 200_000;

/// What a program does to the part.
#[derive(Clone, Debug, Default)]
pub struct Extracted {
    /// In the order in which they were begun.
    pub holes: Vec<Found>,
    pub findings: Vec<Diagnostic>,
    /// What passes near the part, where the part's surface is known.
    pub passings: Vec<Passing>,
    /// What was in force where the tool cut.
    pub cuttings: Vec<Cutting>,
    /// Feeds of tools whose lengths aren't those that the control reckons with.
    pub reaches: Vec<Reach>,
    /// Rapids whose way over the part isn't known.
    pub unplaced: Option<Unplaced>,
    /// What the motion was looked at for.
    pub conduct: Conduct,
}

/// Listens to a run and collects the holes it makes.
#[derive(Debug)]
pub struct Extractor<'m> {
    machine: &'m Machine,
    surface: Option<Surface>,
    at: Position,
    setup: Setup,
    force: InForce,
    /// The last M code since M03, M04 or M05 that went to the machine builder's logic, which may have started the spindle.
    builder: Option<u32>,
    conduct: Conduct,
    hold: Hold,
    /// The part's place while the table stands as it does in `at`.
    frame: Frame,
    /// The tool on the part.
    pose: Pose,
    /// The tool has been outside the part: what it does before that, nobody knows where it stood.
    outside: bool,
    line: Option<Box<Line>>,
    passes: Vec<Pass>,
    /// As many passes are kept.
    most: usize,
    /// The first of the passes that were too many.
    too_many: Option<Place>,
    placing: Placing,
    findings: Findings,
    passings: Passings,
    cuttings: Cuttings,
    reaches: Reaches,
    /// How many times a probe was sent to the part.
    touches: u64,
}

/// How a motion was asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pace {
    Rapid,
    Feed,
    /// Neither cuts nor hurries: a probe looks for its signal.
    Probe,
}

impl<'m> Extractor<'m> {
    /// Starts with every axis at machine zero.
    pub fn new(machine: &'m Machine) -> Self {
        let (at, setup) = (Position::default(), Setup::default());
        let frame = machine.part_frame(&at);
        let pose = machine.tool(&at, &setup).on(&frame);
        Self {
            machine,
            surface: None,
            at,
            setup,
            force: InForce::default(),
            builder: None,
            conduct: Conduct::default(),
            hold: Hold::default(),
            frame,
            pose,
            outside: false,
            line: None,
            passes: Vec::new(),
            most: PASSES,
            too_many: None,
            placing: Placing::default(),
            findings: Findings::default(),
            passings: Passings::default(),
            cuttings: Cuttings::default(),
            reaches: Reaches::default(),
            touches: 0,
        }
    }

    /// With the part's surface known, motion inside it is seen as well.
    #[must_use]
    pub fn with_surface(mut self, surface: Option<Surface>) -> Self {
        self.surface = surface;
        self
    }

    /// With what the reference says of how the part is to be worked, the motion is held against that as well.
    #[must_use]
    pub fn with_conduct(mut self, conduct: &Conduct) -> Self {
        self.conduct = conduct.clone();
        self
    }

    pub fn finish(mut self) -> Extracted {
        if let Some(line) = self.line.take() {
            let after = line.aside();
            self.judge_line(line, after, false);
        }
        let mut findings = self.findings.finish();
        findings.extend(self.too_many.map(|place| {
            let message = format!("more than {PASSES} feeds into the part: nothing after this is checked");
            let finding = Diagnostic::new(Severity::Alarm, "limit", message).at(place);
            finding.help("check for a loop that never ends; otherwise split the program")
        }));
        let holes = group::holes(&self.passes, self.machine);
        Extracted {
            holes,
            findings,
            passings: self.passings.finish(),
            cuttings: self.cuttings.finish(),
            reaches: self.reaches.finish(),
            unplaced: self.placing.finish(self.machine),
            conduct: self.conduct,
        }
    }

    fn keep(&mut self, passes: impl IntoIterator<Item = Pass>) {
        for pass in passes {
            if self.passes.len() < self.most {
                self.passes.push(pass);
            } else if self.too_many.is_none() {
                self.too_many = Some(pass.place);
            }
        }
    }

    fn motion(&mut self, event: &Event<'_>, pace: Pace, to: &Position, arc: Option<&Arc2>) {
        let from = self.at;
        self.idle_axes(event, &from, to);
        self.check_turn(event, &from, to);
        let before = self.pose;
        if self.machine.table.differs(&from, to) {
            self.frame = self.machine.part_frame(to);
        }
        self.at = *to;
        self.pose = self.machine.tool(to, &self.setup).on(&self.frame);
        let (was, is) = self.placing.go();
        if was | is != 0 && pace != Pace::Feed {
            self.jump(event, &before.tip, (was, is));
            return;
        }
        let travel = Travel { from: &from, to, arc };
        if !self.machine.is_straight(&travel) {
            self.leave_curved(event, pace, &travel);
            return;
        }
        if (self.pose.tip - before.tip).norm() < 1e-9 {
            return;
        }
        let free_from = self.stay_or_leave(event, pace, before.tip);
        match (pace, free_from) {
            (Pace::Rapid, Some(start)) => self.check_rapid(event, &start, &self.pose.tip.clone()),
            (Pace::Feed, Some(start)) => self.begin_line(event, start),
            _ => {}
        }
        self.look_outside();
    }

    /// Follows a straight motion from `from` on the current line. Where it has left the line, or there is none:
    /// the point from which it moved freely.
    fn stay_or_leave(&mut self, event: &Event<'_>, pace: Pace, from: Point3<f64>) -> Option<Point3<f64>> {
        let Some(mut line) = self.line.take() else { return Some(from) };
        let tip = self.pose.tip;
        if pace == Pace::Rapid && line.is_overrun(&tip) {
            if line.is_shifted() {
                self.bored_from_the_back(&line);
            } else {
                self.judge_overrun(event, &line, &tip);
            }
            return Some(from);
        }
        let stands = pace == Pace::Rapid && self.force.turning == Spindle::Off;
        if stands && line.leads_in() && line.shift(&tip) {
            self.line = Some(line);
            return None;
        }
        match line.after(&from, &tip) {
            After::On => {
                let again = match pace {
                    Pace::Feed => {
                        if line.depth_of(&from) < line.depth_of(&tip) {
                            self.note_feed(event, &mut line);
                        }
                        line.feed(&tip, event.place(), &self.at)
                    }
                    Pace::Rapid | Pace::Probe => {
                        let (again, uncut) = line.rapid(&tip);
                        if uncut {
                            self.rapid_into_uncut(event, &line);
                        }
                        again
                    }
                };
                self.keep(again);
                self.line = Some(line);
                None
            }
            after @ (After::Out | After::Aside { .. }) => {
                if stands && !line.leads_in() && after != After::Out {
                    self.bored_from_the_back(&line);
                }
                let free = if after == After::Out { line.top_between(&from, &tip) } else { from };
                self.judge_line(line, after, pace == Pace::Feed);
                Some(free)
            }
        }
    }

    fn begin_line(&mut self, event: &Event<'_>, start: Point3<f64>) {
        let rounding = self.machine.increment.size() / 2.0;
        let line = Line::begin(start, self.pose.tip, event.place(), self.at, rounding);
        self.line = line.map(|line| {
            let mut line = Box::new(line);
            line.tool_axis = self.pose.axis;
            line.force = InForce { tool: self.setup.tool, ..self.force };
            line.hold = self.hold;
            line.unplaced = self.placing.now();
            line.beyond = self.beyond();
            line.top =
                self.surface.and_then(|s| s.exit(&line.bottom(), &line.out)).map(|p| line.depth_of(&p));
            self.note_feed(event, &mut line);
            line
        });
    }

    /// How fast a feed inwards is, where it cuts: the way to the part may be fed faster.
    fn note_feed(&self, event: &Event<'_>, line: &mut Line) {
        let cuts = self.surface.is_none_or(|surface| surface.is_deeper(&self.pose.tip, TOUCH));
        if let EventKind::Feed { rate, .. } = event.kind
            && cuts
        {
            line.note_feed(*rate);
        }
    }

    /// The table or the head turns, or an arc: the tool's way on the part is curved.
    fn leave_curved(&mut self, event: &Event<'_>, pace: Pace, travel: &Travel<'_>) {
        if let Some(line) = self.line.take() {
            let after = line.aside();
            self.judge_line(line, after, pace == Pace::Feed);
        }
        match pace {
            Pace::Rapid => self.check_curved(event, travel, Curved::Rapid),
            Pace::Feed => self.check_curved(event, travel, Curved::Feed),
            Pace::Probe => {}
        }
        self.look_outside();
    }

    fn look_outside(&mut self) {
        if let (false, true, Some(surface)) = (self.outside, self.placing.now() == 0, &self.surface) {
            self.outside = surface.value(&self.pose.tip) > 0.0;
        }
    }

    /// Something other than an axis changes where the tool is, or which tool it is.
    fn set_up(&mut self, change: impl FnOnce(&mut Setup)) {
        let before = self.setup;
        change(&mut self.setup);
        if self.setup == before {
            return;
        }
        if let Some(line) = self.line.take() {
            let after = line.aside();
            self.judge_line(line, after, false);
        }
        self.pose = self.machine.tool(&self.at, &self.setup).on(&self.frame);
    }
}

impl Sink for Extractor<'_> {
    fn signal(&mut self, feed: &SkipFeed<'_>) -> Option<Signal> {
        self.probe(feed)
    }

    fn event(&mut self, event: &Event<'_>) {
        match event.kind {
            EventKind::Rapid { to } => self.motion(event, Pace::Rapid, to, None),
            EventKind::Feed { to, .. } => self.motion(event, Pace::Feed, to, None),
            EventKind::Arc { to, arc, .. } => self.motion(event, Pace::Feed, to, Some(arc)),
            EventKind::Skip { to, .. } => self.motion(event, Pace::Probe, to, None),
            EventKind::Tool { number } => {
                self.known_tool(event, *number);
                self.set_up(|setup| setup.tool = Some(*number));
            }
            EventKind::ToolLength { offset, by } => {
                self.set_up(|setup| setup.offset = *offset);
                self.force.by = *by;
            }
            EventKind::Unplaced { axes } => self.placing.hear(self.machine, *axes),
            EventKind::Spindle { turning, speed } => {
                // At S0 it stands.
                let before = self.force.turning;
                self.force.turning = if *speed == Rpm(0.0) { Spindle::Off } else { *turning };
                self.force.speed = *speed;
                self.spindle_in_hole(before);
                self.builder = None;
            }
            EventKind::Stop { kind: StopKind::Message, text, named } => {
                if let Some(angle) = self.head_message(event, text, named) {
                    self.set_up(|setup| setup.head_angle = Some(angle));
                }
            }
            EventKind::Auxiliary { code } => {
                if !self.hold(*code) {
                    self.builder = Some(*code);
                }
            }
            EventKind::Stop { .. } | EventKind::Dwell { .. } | EventKind::Coolant { .. } => {}
        }
    }
}

impl Extracted {
    /// The document that `holes` writes; `locate` names the program and the line of a block.
    pub fn list(&self, locate: impl Fn(Span) -> (String, u32)) -> HoleList {
        let holes = self.holes.iter().map(|found| found.hole(&locate)).collect();
        HoleList { unit: Unit::Mm, holes }
    }
}

impl Found {
    /// In the schema that references have too; the program alone gives no id.
    pub fn hole(&self, locate: impl Fn(Span) -> (String, u32)) -> Hole {
        let (program, line) = locate(self.place.block);
        Hole {
            id: None,
            entry: self.entry.coords.into(),
            axis: self.axis.into_inner().into(),
            depth: self.depth,
            diameter: self.diameter,
            from: Some(Origin { program, line, tool: self.tool }),
        }
    }
}
