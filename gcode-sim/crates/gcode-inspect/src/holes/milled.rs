//! Milled holes: full circles that the tool mills from the inside between two retracts.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::arc_run::{ArcRun, PartArc, Ring};
use super::chord_run::ChordRun;
use super::drill_pass::{DrillPass, MilledCut, PassCut};
use super::per_block::Findings;
use super::strokes::{CutKind, LEVEL_TOLERANCE, Uncounted};
use gcode_lang::motion::{Event, SpindleDirection, UnknownAxes};

/// Largest number of points of an engagement; with more the tool mills something larger than a hole.
const MAX_POINTS: usize = 50_000;

/// Cosine of the largest angle between a circle's axis and the tool: 0.05°.
const MIN_AXIS_COSINE: f64 = 0.999_999_6;

/// Motion of the tool from its first feed to its retract above the start of that feed, or above all feeds across.
#[derive(Debug, Default)]
pub(super) struct Engagement {
    /// Start of the first feed; `None` before it.
    start: Option<Point3<f64>>,
    /// Height along the tool at which the last rapid before it began.
    approach_level: f64,
    /// True once the tool is below the start.
    has_descended: bool,
    /// Highest feed across the tool, by its height along the tool.
    highest_side: f64,
    /// Points of the path.
    points: Vec<Point3<f64>>,
    run: Option<ArcRun>,
    chords: Option<ChordRun>,
    rings: Vec<Ring>,
    /// Axes of unknown position on the part during an arc.
    unknown_axes: UnknownAxes,
    /// Feeds that make no hole, unless the engagement does.
    pub uncounted: Uncounted,
    /// Errors about them, where the surface is known.
    pub errors: Findings,
}

/// Path of a feed.
#[derive(Clone, Debug)]
pub(super) enum Path {
    Straight,
    /// An arc; `None` if the table or the head rotates.
    Curved(Option<PartArc>),
}

impl Engagement {
    fn clear(&mut self) {
        let mut points = std::mem::take(&mut self.points);
        points.clear();
        *self = Self { points, approach_level: self.approach_level, ..Self::default() };
    }

    /// Adds axes of unknown position during an arc.
    pub(super) fn add_unknown_axes(&mut self, axes: UnknownAxes) {
        self.unknown_axes = self.unknown_axes.union(axes);
    }

    fn push_point(&mut self, p: Point3<f64>) {
        if self.points.len() < MAX_POINTS {
            self.points.push(p);
        }
    }

    /// Returns true if a point is not above all feeds across; the axis of a circle decides, without one the tool's.
    fn is_below(&self, p: &Point3<f64>, out: &Unit<Vector3<f64>>) -> bool {
        let axis = self.rings.first().map_or(out, |ring| &ring.out);
        let along = |p: &Point3<f64>| p.coords.dot(axis);
        let highest = match axis.dot(out) > MIN_AXIS_COSINE {
            true if self.points.is_empty() => f64::NEG_INFINITY,
            true => self.highest_side,
            false => self.points.iter().map(along).fold(f64::NEG_INFINITY, f64::max),
        };
        along(p) <= highest + LEVEL_TOLERANCE
    }

    fn end_run(&mut self) {
        self.rings.extend(self.run.take().and_then(ArcRun::finish));
        self.rings.extend(self.chords.take().and_then(ChordRun::finish));
    }

    /// Returns the circle of each radius and the start of the feed, without those that others cover; `None` if the tool
    /// mills something else than one hole.
    fn circles(&self, tool_axis: Option<&Unit<Vector3<f64>>>, cutter: Option<f64>) -> Option<Circles> {
        let widest =
            self.rings.iter().reduce(|best, ring| if best.radius < ring.radius { ring } else { best })?;
        let (centre, out, radius) = (widest.centre, widest.out, widest.radius);
        let slack = 0.02 + widest.roundness;
        let aside = |p: &Point3<f64>| {
            let spoke = p - centre;
            (spoke - out.into_inner() * spoke.dot(&out)).norm()
        };
        let is_one_axis = self.rings.iter().all(|ring| {
            aside(&ring.centre) <= slack + ring.roundness && ring.out.dot(&out) > MIN_AXIS_COSINE
        });
        let is_along_tool = tool_axis.is_none_or(|axis| axis.dot(&out) >= MIN_AXIS_COSINE);
        if !is_one_axis || !is_along_tool || self.points.len() == MAX_POINTS {
            return None;
        }
        let top = self.rings.iter().map(|ring| ring.top).fold(f64::NEG_INFINITY, f64::max) + LEVEL_TOLERANCE;
        let mut nearest = radius;
        for p in self.points.iter().filter(|p| p.coords.dot(&out) <= top) {
            let distance = aside(p);
            if distance > radius + slack {
                return None;
            }
            nearest = nearest.min(distance);
        }
        let is_inside = nearest <= radius / 2.0;
        // A circle that leaves a core may be a groove.
        let reaches_axis = cutter.is_some_and(|cutter| radius <= cutter / 2.0 + slack);
        let is_helix = cutter.is_none() && self.rings.iter().any(Ring::is_helix);
        let is_certain = is_inside || reaches_axis || is_helix;
        let mut kept: Vec<Ring> = Vec::new();
        let mut order: Vec<&Ring> = self.rings.iter().collect();
        order.sort_by(|a, b| a.level().total_cmp(&b.level()).then(b.radius.total_cmp(&a.radius)));
        for ring in order {
            if kept.iter().all(|deeper| deeper.radius < ring.radius - 0.01) {
                kept.push(ring.clone());
            }
        }
        Some(Circles { rings: kept, is_certain })
    }
}

/// Circles of one hole.
struct Circles {
    rings: Vec<Ring>,
    /// False for a circle that may as well be a groove in a face.
    is_certain: bool,
}

impl HoleExtractor<'_> {
    /// Follows a straight feed or an arc. Feeds across the tool below the start of the engagement are milling.
    pub(super) fn engage(&mut self, event: &Event<'_>, from: &Point3<f64>, path: Path) {
        let Some(out) = self.tool_direction() else { return };
        let to = self.pose.tip;
        let level = |p: &Point3<f64>| p.coords.dot(&out);
        let arc = match path {
            Path::Straight => None,
            Path::Curved(Some(arc)) => Some(arc),
            Path::Curved(None) => {
                self.strokes.note_milling(level(&to));
                return;
            }
        };
        let (begin, end) = (level(from), level(&to));
        let start = *self.engagement.start.get_or_insert(*from);
        let top = level(&start);
        let aside = (to - from - out.into_inner() * (end - begin)).norm();
        let is_across = arc.is_some() || aside > LEVEL_TOLERANCE;
        let rise = (end - begin).abs();
        // A feed that goes down and across by more than 30° to the tool is no drilling.
        let is_sloped = rise > LEVEL_TOLERANCE && aside > 0.577 * rise;
        let lowest = begin.min(end);
        if arc.is_some() || is_sloped {
            // A stroke from its lowest point is milling too.
            self.strokes.note_milling(lowest - 2.0 * LEVEL_TOLERANCE);
        } else if is_across && rise <= LEVEL_TOLERANCE && lowest < top - LEVEL_TOLERANCE {
            self.strokes.note_milling(lowest);
        }
        let engagement = &mut self.engagement;
        if is_across {
            let highest = begin.max(end);
            engagement.highest_side =
                if engagement.points.is_empty() { highest } else { engagement.highest_side.max(highest) };
            if engagement.points.is_empty() {
                engagement.push_point(*from);
            }
        }
        let place = || (event.backtrace(), self.axis_position);
        match arc {
            None if is_across => {
                engagement.rings.extend(engagement.run.take().and_then(ArcRun::finish));
                if !engagement.chords.as_mut().is_some_and(|chords| chords.extend(to, &out, place)) {
                    engagement.end_run();
                    engagement.chords = Some(ChordRun::new(*from, to, out));
                }
            }
            Some(arc) => {
                engagement.rings.extend(engagement.chords.take().and_then(ChordRun::finish));
                for t in [0.25, 0.5, 0.75] {
                    engagement.push_point(arc.point(t));
                }
                let next = match engagement.run.as_mut() {
                    Some(run) => run.extend(arc, place).err(),
                    None => Some(arc),
                };
                if let Some(arc) = next {
                    engagement.end_run();
                    engagement.run = Some(ArcRun::new(arc, place));
                }
            }
            None => engagement.end_run(),
        }
        if is_across {
            engagement.push_point(to);
        }
        engagement.has_descended |= end < top - LEVEL_TOLERANCE;
        let is_out = end > top + LEVEL_TOLERANCE || engagement.has_descended && end >= top - LEVEL_TOLERANCE;
        // A feed out of a circle ends it as a rapid does.
        let is_retract = !is_across && begin < end && !engagement.rings.is_empty();
        if is_out || is_retract && !engagement.is_below(&to, &out) {
            self.end_engagement();
        }
    }

    /// Follows a rapid: it ends the engagement if it ends above all feeds across.
    pub(super) fn disengage(&mut self, from: &Point3<f64>) {
        let Some(out) = self.tool_direction() else { return };
        let level = |p: &Point3<f64>| p.coords.dot(&out);
        self.engagement.end_run();
        if self.engagement.start.is_some() {
            let to = self.pose.tip;
            if self.engagement.is_below(&to, &out) {
                self.engagement.push_point(to);
            } else {
                self.end_engagement();
            }
        }
        if self.engagement.start.is_none() {
            self.engagement.approach_level = level(from);
        }
    }

    /// Ends the engagement: its circles are passes of a hole, or its feeds make none.
    pub(super) fn end_engagement(&mut self) {
        self.engagement.end_run();
        let cutter = self.machine.diameter_of(self.setup.tool);
        let circles = match self.engagement.rings.is_empty() {
            true => None,
            false => self.engagement.circles(self.pose.axis.as_ref(), cutter),
        };
        let is_hole = circles.is_some_and(|circles| self.push_circles(circles));
        let uncounted = std::mem::take(&mut self.engagement.uncounted);
        let errors = std::mem::take(&mut self.engagement.errors);
        if !is_hole {
            self.report_uncounted(uncounted);
            self.findings.append(errors);
        }
        self.engagement.clear();
    }

    /// Adds the passes of a hole. Returns false for circles that may be a groove, unless a nominal hole is there.
    fn push_circles(&mut self, circles: Circles) -> bool {
        let start = self.engagement.start.unwrap_or(self.pose.tip);
        let Engagement { approach_level, unknown_axes, .. } = self.engagement;
        let tool = self.setup.tool;
        let pass = |ring: Ring| {
            let out = ring.out;
            let begin = start.coords.dot(&out);
            // A tool that comes down in rapid begins its feed at the depth of the circle.
            let begin = if begin > ring.level() + LEVEL_TOLERANCE { begin } else { approach_level };
            let length = (begin - ring.level()).max(LEVEL_TOLERANCE);
            let milled = MilledCut { radius: ring.radius, roundness: ring.roundness, core: None };
            let cut = PassCut::new(ring.centre + out.into_inner() * length, ring.centre);
            DrillPass {
                cut: PassCut { milled: Some(milled), ..cut },
                axis: out,
                feed_direction: out,
                tool,
                backtrace: ring.backtrace,
                axis_position: ring.axis_position,
                unknown_axes,
            }
        };
        let passes: Vec<DrillPass> = circles.rings.into_iter().map(pass).collect();
        if !circles.is_certain && !passes.iter().any(|pass| self.strokes.is_nominal(pass)) {
            return false;
        }
        for pass in passes {
            let PassCut { start, bottom, milled, .. } = &pass.cut;
            let radius = milled.map_or(0.0, |circle| circle.radius) + self.tool_radius().unwrap_or(0.0);
            let is_pocketing = self.is_round_in_pocket(&[*start, *bottom], &pass.axis, radius);
            self.check_clamped(&pass.backtrace, self.clamp_state);
            if self.cutting_state.spindle_direction == SpindleDirection::Off {
                self.report_spindle_stopped(&pass.backtrace);
            }
            // In a pocket a circle is judged by what it removes, unless a nominal hole is there.
            if !is_pocketing || self.strokes.is_nominal(&pass) {
                let order = self.strokes.begin_pass();
                self.strokes.push(order, pass, CutKind::Drilled);
            }
        }
        true
    }
}
