//! Runs of arcs round one axis on the part, and their deepest full turn.
use std::collections::VecDeque;

use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::cut_states::CutStates;
use super::drill_pass::Helix;
use super::slug::Turn;
use super::sweep::Sweep;
use crate::machine::{AxisMotion, HeadKind};
use gcode_lang::motion::{AxisIndex, Backtrace, Position};
use gcode_lang::units::Deg;
use gcode_part::exceeds;

/// Largest gap of a full turn, mm: rounded ends of arcs. The cutter closes it.
const MAX_GAP: f64 = 0.02;

/// Largest change of height over a level turn, mm.
const MAX_LEVEL_CHANGE: f64 = 0.01;

/// Rounding of the height of an arc, mm.
const LEAD_ROUNDING: f64 = 0.003;

/// Largest distance between whole turns of one thread, mm.
const SAME_TURN: f64 = 0.01;

/// Largest difference of two circles that are one, mm.
const SAME_CIRCLE: f64 = 1e-9;

/// Number of full turns whose circles are kept.
const MAX_CIRCLES: usize = 1000;

/// Number of kinds of slope that are kept.
const MAX_SLOPES: usize = 4;

/// Largest angle between two samples of an arc, degrees.
const MAX_SAMPLE: f64 = 5.0;

/// Arc on the part: a circular path, straight along the axis of the circle; or a chord of it.
#[derive(Clone, Debug)]
pub(super) struct PartArc {
    /// Centre, at the height of the start.
    pub centre: Point3<f64>,
    /// Axis of the circle, out of the part.
    pub out: Unit<Vector3<f64>>,
    pub from: Point3<f64>,
    pub to: Point3<f64>,
    /// Swept angle, right-handed about `out`.
    pub sweep: Deg,
    /// True for a straight path.
    pub is_chord: bool,
}

impl PartArc {
    fn radius(&self) -> f64 {
        (self.from - self.centre).norm()
    }

    /// Returns the height of the end above the start.
    fn rise(&self) -> f64 {
        (self.to - self.from).dot(&self.out)
    }

    /// Returns the point after the fraction `t` of the arc, 0 to 1.
    pub(super) fn point(&self, t: f64) -> Point3<f64> {
        if self.is_chord {
            return self.from + (self.to - self.from) * t;
        }
        let spoke = self.from - self.centre;
        let (cos, sin) = ((self.sweep * t).cos(), (self.sweep * t).sin());
        self.centre + spoke * cos + self.out.cross(&spoke) * sin + self.out.into_inner() * (self.rise() * t)
    }

    /// Returns the largest distance of the other arc's circle from this one, seen along the axis.
    fn circle_distance(&self, other: &Self) -> f64 {
        let aside = other.centre - self.centre;
        let aside = aside - self.out.into_inner() * aside.dot(&self.out);
        aside.norm() + (other.radius() - self.radius()).abs()
    }

    /// Returns true if the other arc is on the same circle, or above or below it, to rounding.
    fn is_on_same_circle(&self, other: &Self) -> bool {
        !self.is_chord && self.circle_distance(other) < SAME_CIRCLE
    }

    /// Returns true for a whole turn that rises.
    fn is_rising_turn(&self) -> bool {
        MAX_LEVEL_CHANGE < self.rise() && 360.0 - LEAD_ROUNDING < self.sweep.0.abs()
    }

    /// Returns true if the other arc goes round the same axis in the same sense, with the same radius. Centres given by R
    /// may be off by some hundredths of the radius; those of whole turns along a thread are given by I and J.
    fn continues(&self, other: &Self) -> bool {
        if self.is_rising_turn() && other.is_rising_turn() && SAME_TURN < self.circle_distance(other) {
            return false;
        }
        let slack = (0.03 * self.radius()).max(0.05);
        let aside = other.centre - self.centre;
        (aside - self.out.into_inner() * aside.dot(&self.out)).norm() <= slack
            && (other.radius() - self.radius()).abs() <= slack
            && self.out.dot(&other.out) > 0.999_999
            && (self.sweep.0 > 0.0) == (other.sweep.0 > 0.0)
    }
}

/// Consecutive arcs round one axis.
#[derive(Clone, Debug)]
pub(super) struct ArcRun {
    /// Arcs of the last full turn, with the angle swept before each, degrees.
    arcs: VecDeque<(f64, PartArc)>,
    /// Swept angle of the whole run, degrees.
    swept: f64,
    /// Height of the start along the axis.
    top: f64,
    /// Heights of the ends of these arcs.
    heights: HeightRange,
    turn: Option<FullTurn>,
    sweep: Sweep,
    /// All turns of a helix that makes no hole: its lowest point.
    helix_turn: Option<FullTurn>,
    /// Kinds of slope among the arcs, in the order of the run.
    slopes: Vec<Slope>,
    /// Centres and radii of the first full turns.
    circles: Vec<(Point3<f64>, f64)>,
    /// Diameter of the slug that a turn has cut loose; `None` without any.
    pub slug: Option<f64>,
    /// True until the slug of the deepest turn is looked for.
    has_new_turn: bool,
}

/// Arcs of a run that rise alike.
#[derive(Clone, Debug)]
struct Slope {
    /// Height that they gain, mm per degree.
    rise: f64,
    /// Angle that they sweep, degrees.
    swept: f64,
    /// Block of the first.
    backtrace: Backtrace,
}

/// Extremes of the last heights of a path, each with the angle swept before it: of the upper ones each is above all later
/// ones, of the lower ones below.
#[derive(Clone, Debug, Default)]
struct HeightRange {
    upper: VecDeque<(f64, f64)>,
    lower: VecDeque<(f64, f64)>,
}

impl HeightRange {
    fn push(&mut self, swept: f64, height: f64) {
        while self.upper.back().is_some_and(|(_, last)| *last <= height) {
            self.upper.pop_back();
        }
        while self.lower.back().is_some_and(|(_, last)| height <= *last) {
            self.lower.pop_back();
        }
        self.upper.push_back((swept, height));
        self.lower.push_back((swept, height));
    }

    /// Drops the heights before a swept angle and returns the highest and the lowest of the others and of the one there.
    fn since(&mut self, swept: f64, there: f64) -> [f64; 2] {
        for heights in [&mut self.upper, &mut self.lower] {
            while heights.front().is_some_and(|(at, _)| *at < swept) {
                heights.pop_front();
            }
        }
        let extreme = |heights: &VecDeque<(f64, f64)>| heights.front().map_or(there, |(_, height)| *height);
        [extreme(&self.upper).max(there), extreme(&self.lower).min(there)]
    }
}

/// Deepest full turn of a run.
#[derive(Clone, Debug)]
struct FullTurn {
    /// Height of its highest point along the axis.
    level: f64,
    /// Last arc.
    backtrace: Backtrace,
    axis_position: Position,
}

/// Circle that the tool's axis describes on the part.
#[derive(Clone, Debug)]
pub(super) struct Ring {
    /// Centre, at the height of the deepest full turn.
    pub centre: Point3<f64>,
    pub out: Unit<Vector3<f64>>,
    pub radius: f64,
    /// Largest minus least distance of the path from the axis, mm.
    pub roundness: f64,
    /// Height of the start of the run along `out`.
    pub top: f64,
    /// Its full turns.
    pub sweep: Sweep,
    /// Height above the deepest full turn up to which the edges cut the whole wall, mm; infinite without a length of the flutes.
    pub wall: f64,
    pub helix: Option<Helix>,
    /// Block of the first arc whose lead is not that of the helix.
    pub uneven_turn: Option<Backtrace>,
    /// Diameter of the slug of a through hole that the circle cuts loose; `None` without any.
    pub slug: Option<f64>,
    /// Modal states in which it is cut.
    pub cuts: CutStates,
    /// Block of the last arc.
    pub backtrace: Backtrace,
    pub axis_position: Position,
}

impl Ring {
    /// Returns the height of the deepest full turn along the axis.
    pub(super) fn level(&self) -> f64 {
        self.centre.coords.dot(&self.out)
    }

    /// Returns the height of the whole run above the deepest full turn.
    pub(super) fn height(&self) -> f64 {
        let helix = self.helix.map_or(0.0, |helix| helix.height);
        helix.max(self.top - self.level())
    }

    /// Returns the circle with the height of the wall that edges of a length cut all round.
    pub(super) fn with_edges(&self, edges: f64) -> Self {
        let above = if self.sweep.step <= edges { (self.sweep.top - self.level()).max(0.0) } else { 0.0 };
        Self { wall: above + edges, ..self.clone() }
    }

    /// Adds the wall of a higher circle as wide, unless metal is left between both.
    pub(super) fn extend_wall(&mut self, above: &Self) {
        let begin = above.level() - self.level();
        if begin <= self.wall + MAX_LEVEL_CHANGE {
            self.wall = self.wall.max(begin + above.wall);
        }
    }

    /// Returns true if the tool comes down along the circle.
    pub(super) fn is_helix(&self) -> bool {
        self.top - self.level() > MAX_LEVEL_CHANGE
    }
}

impl ArcRun {
    pub(super) fn new(arc: PartArc, place: impl Fn() -> (Backtrace, Position)) -> Self {
        let top = arc.from.coords.dot(&arc.out);
        let (arcs, heights, slopes, circles) =
            (VecDeque::new(), HeightRange::default(), Vec::new(), Vec::new());
        let (turn, helix_turn, slug, has_new_turn) = (None, None, None, false);
        let (swept, sweep) = (0.0, Sweep::NONE);
        let mut run =
            Self { arcs, swept, top, heights, turn, sweep, helix_turn, slopes, circles, slug, has_new_turn };
        run.push(arc, place);
        run
    }

    /// Adds an arc; returns it if it doesn't continue the run.
    pub(super) fn extend(
        &mut self,
        arc: PartArc,
        place: impl Fn() -> (Backtrace, Position),
    ) -> Result<(), PartArc> {
        if !self.arcs.back().is_some_and(|(_, last)| last.continues(&arc)) {
            return Err(arc);
        }
        self.push(arc, place);
        Ok(())
    }

    fn push(&mut self, arc: PartArc, place: impl Fn() -> (Backtrace, Position)) {
        let end = arc.to.coords.dot(&arc.out);
        let before = self.swept;
        self.add_slope(arc.rise(), arc.sweep.0.abs(), || place().0);
        self.swept += arc.sweep.0.abs();
        self.heights.push(before, arc.from.coords.dot(&arc.out));
        self.heights.push(self.swept, end);
        self.arcs.push_back((before, arc));
        if self.swept < self.full_turn() {
            return;
        }
        let begin = (self.swept - 360.0).max(0.0);
        while self.arcs.get(1).is_some_and(|(before, _)| *before <= begin) {
            self.arcs.pop_front();
        }
        self.note_circle();
        let start = self.height_at(begin);
        let [level, lowest] = self.heights.since(begin, start);
        self.sweep.add(lowest, (start - end).abs());
        // A turn that rises follows a thread. A single turn that falls does so too, or begins a helix.
        let is_level = level - lowest <= MAX_LEVEL_CHANGE;
        let is_helix = end < start && self.swept >= self.full_turn() + 360.0;
        if (is_level || is_helix) && self.turn.as_ref().is_none_or(|turn| level < turn.level - 1e-9) {
            let (backtrace, axis_position) = place();
            self.turn = Some(FullTurn { level, backtrace, axis_position });
            self.has_new_turn = true;
        } else if self.turn.is_none() && self.is_steady() {
            let (backtrace, axis_position) = place();
            let (first, last) = (self.top, end);
            self.helix_turn = Some(FullTurn { level: first.min(last), backtrace, axis_position });
        }
    }

    /// Records the circle of a full turn that is complete.
    fn note_circle(&mut self) {
        let turns = self.circles.len() as f64;
        if self.circles.len() < MAX_CIRCLES && 360.0 * turns + self.full_turn() <= self.swept {
            let (centre, radius, _) = self.fit();
            self.circles.push((centre, radius));
        }
    }

    /// Returns the largest distance of the turns' circles from this one, in radius.
    fn wander(&self, centre: &Point3<f64>, radius: f64, out: &Unit<Vector3<f64>>) -> f64 {
        let distance = |(other, own): &(Point3<f64>, f64)| {
            let aside = other - centre;
            (aside - out.into_inner() * aside.dot(out)).norm() + (own - radius).abs()
        };
        self.circles.iter().map(distance).fold(0.0, f64::max)
    }

    fn add_slope(&mut self, rise: f64, swept: f64, place: impl FnOnce() -> Backtrace) {
        let is_alike = |slope: &Slope| !exceeds((rise - slope.rise * swept).abs(), LEAD_ROUNDING);
        if let Some(index) = self.slopes.iter().position(is_alike) {
            self.slopes[index].swept += swept;
        } else if self.slopes.len() < MAX_SLOPES {
            self.slopes.push(Slope { rise: rise / swept, swept, backtrace: place() });
        }
    }

    /// Returns the deepest full turn once, if no turn has cut a slug loose.
    pub(super) fn next_turn(&mut self) -> Option<Turn> {
        if !std::mem::take(&mut self.has_new_turn) || self.slug.is_some() {
            return None;
        }
        let (_, last) = self.arcs.back()?;
        let out = last.out;
        let rise = self.turn.as_ref()?.level - last.centre.coords.dot(&out);
        Some(Turn { centre: last.centre + out.into_inner() * rise, out, radius: last.radius() })
    }

    /// Returns true if all arcs rise, or all fall.
    fn is_steady(&self) -> bool {
        let way = self.slopes.first().map_or(0.0, |slope| slope.rise.signum());
        self.slopes.iter().all(|slope| MAX_LEVEL_CHANGE < 360.0 * slope.rise * way)
    }

    /// Returns the angle of a full turn of this radius, less the largest gap, degrees.
    fn full_turn(&self) -> f64 {
        let radius = self.arcs.back().map_or(f64::INFINITY, |(_, arc)| arc.radius());
        360.0 - (MAX_GAP / radius).to_degrees().max(0.01)
    }

    /// Returns the height at a swept angle within the last full turn.
    fn height_at(&self, swept: f64) -> f64 {
        let (before, arc) = &self.arcs[0];
        arc.point(((swept - before) / arc.sweep.0.abs()).clamp(0.0, 1.0)).coords.dot(&arc.out)
    }

    /// Ends the run; `None` without a full turn.
    pub(super) fn finish(self) -> Option<Ring> {
        let (_, last) = self.arcs.back()?;
        let (out, end) = (last.out, last.to.coords.dot(&last.out));
        let (mut helix, uneven_turn) = self.helix(end - self.top, last.sweep.0.signum()).unzip();
        if self.turn.is_none() && helix.is_none() {
            return None;
        }
        let (centre, radius, roundness) = self.fit();
        if let Some(helix) = &mut helix {
            helix.phase = Helix::phase_of(helix.lead, &(last.to - centre), &out, end);
            helix.wander = self.wander(&centre, radius, &out);
        }
        let FullTurn { level, backtrace, axis_position } = self.turn.or(self.helix_turn)?;
        let centre = centre + out.into_inner() * (level - centre.coords.dot(&out));
        let (top, sweep, slug, uneven_turn) = (self.top, self.sweep, self.slug, uneven_turn.flatten());
        let wall = f64::INFINITY;
        let cuts = CutStates::default();
        Some(Ring {
            centre,
            out,
            radius,
            roundness,
            top,
            sweep,
            wall,
            helix,
            uneven_turn,
            slug,
            cuts,
            backtrace,
            axis_position,
        })
    }

    /// Returns the helix, without its phase, of a run that rises in all, or falls, with the block of the first arc whose lead is
    /// another one; `None` if it is level anywhere, or less than a full turn.
    fn helix(&self, rise: f64, sense: f64) -> Option<(Helix, Option<Backtrace>)> {
        if !self.is_steady() || self.swept < self.full_turn() {
            return None;
        }
        let main =
            self.slopes.iter().reduce(|best, slope| if best.swept < slope.swept { slope } else { best })?;
        let uneven = self.slopes.iter().find(|slope| !std::ptr::eq(*slope, main));
        // The whole run gives the lead of even turns to the last digit.
        let lead = if uneven.is_some() { main.rise } else { rise / self.swept } * sense * 360.0;
        let uneven_lead = uneven.map(|slope| slope.rise * sense * 360.0);
        let (phase, wander, is_thread) = (0.0, 0.0, self.turn.is_none());
        let helix = Helix { lead, uneven_lead, phase, height: rise.abs(), wander, is_thread };
        Some((helix, uneven.map(|slope| slope.backtrace.clone())))
    }

    /// Returns the least squares circle of the last full turn: centre, radius, and largest minus least distance.
    fn fit(&self) -> (Point3<f64>, f64, f64) {
        let (_, first) = &self.arcs[0];
        let out = first.out;
        if self.arcs.iter().all(|(_, arc)| first.is_on_same_circle(arc)) {
            return (first.centre, first.radius(), 0.0);
        }
        let distance = |centre: &Point3<f64>, p: &Point3<f64>| {
            let spoke = p - centre;
            (spoke - out.into_inner() * spoke.dot(&out)).norm()
        };
        let begin = self.swept - 360.0;
        let mut samples = Vec::new();
        for (before, arc) in &self.arcs {
            let from = ((begin - before) / arc.sweep.0.abs()).clamp(0.0, 1.0);
            // The middle of a chord is nearest to the axis.
            // Equal chords have as many samples each, besides noise.
            let steps = arc.sweep.0.abs() * (1.0 - from) / MAX_SAMPLE - 1e-6;
            let steps = steps.ceil().max(1.0) as u32;
            let steps = if arc.is_chord { steps.next_multiple_of(2) } else { steps };
            let at = |step: u32| from + (1.0 - from) * f64::from(step) / f64::from(steps);
            samples.extend((0..=steps).map(|step| arc.point(at(step))));
        }
        // Gauss-Newton from the first centre; the points are all round it.
        let mut centre = first.centre;
        let mut radius = first.radius();
        for _ in 0..4 {
            let (mut shift, mut sum) = (Vector3::zeros(), 0.0);
            for p in &samples {
                let spoke = p - centre;
                let spoke = spoke - out.into_inner() * spoke.dot(&out);
                shift += spoke / spoke.norm() * (spoke.norm() - radius);
                sum += spoke.norm();
            }
            let count = samples.len() as f64;
            centre += shift * (2.0 / count);
            radius = sum / count;
        }
        let (mut least, mut largest) = (f64::INFINITY, 0.0f64);
        for p in &samples {
            let d = distance(&centre, p);
            (least, largest) = (least.min(d), largest.max(d));
        }
        (centre, radius, largest - least)
    }
}

impl HoleExtractor<'_> {
    /// Returns an arc on the part; `None` if the table or the head rotates, or if the axes of the arc aren't square.
    pub(super) fn part_arc(&self, travel: &AxisMotion<'_>, from: &Point3<f64>) -> Option<PartArc> {
        let arc = travel.arc?;
        if !self.machine.is_straight(&AxisMotion { arc: None, ..*travel }) {
            return None;
        }
        let (first, second) = (self.axis_direction(arc.plane.0), self.axis_direction(arc.plane.1));
        let is_square = first.dot(&second).abs() < 1e-6
            && (first.norm() - 1.0).abs() < 1e-6
            && (second.norm() - 1.0).abs() < 1e-6;
        let normal = is_square.then(|| Unit::new_normalize(first.cross(&second)))?;
        let centre = from
            + first * (arc.centre.0 - travel.from[arc.plane.0])
            + second * (arc.centre.1 - travel.from[arc.plane.1]);
        let is_out = self.tool_direction().is_none_or(|out| out.dot(&normal) > -0.5);
        let (out, sweep) = if is_out { (normal, arc.sweep) } else { (-normal, -arc.sweep) };
        Some(PartArc { centre, out, from: *from, to: self.pose.tip, sweep, is_chord: false })
    }

    /// Returns the motion of the tool on the part for a command of an axis, per mm.
    fn axis_direction(&self, axis: AxisIndex) -> Vector3<f64> {
        let mut by = Position::default();
        by[axis] = 1.0;
        let motion = self.machine.slides.displacement(&by) - self.machine.table.displacement(&by);
        self.frame.rotation.inverse_transform_vector(&motion)
    }

    /// Returns the direction of the tool on the part, out of it. Without a known head that of Z: a mill stands upright.
    pub(super) fn tool_direction(&self) -> Option<Unit<Vector3<f64>>> {
        self.pose.axis.or_else(|| {
            let z = self.machine.axes.find(b'Z').filter(|_| self.machine.head.kind == HeadKind::Free)?;
            Unit::try_new(self.axis_direction(z), 1e-9)
        })
    }
}
