//! Milled holes: full circles that the tool mills from the inside between two retracts.
use nalgebra::{Point3, Unit, Vector3};

use super::arc_run::{ArcRun, PartArc, Ring};
use super::group::{DrillPass, MilledCircle};
use super::per_block::Findings;
use super::strokes::{CutKind, LEVEL_TOLERANCE};
use super::{HoleExtractor, spindle};
use crate::findings::SPINDLE_STOPPED;
use gcode_lang::motion::{Backtrace, Event, SpindleDirection};

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
    rings: Vec<Ring>,
    /// Feeds that make no hole, unless the engagement does.
    pub uncounted: Uncounted,
    /// Errors about them, where the surface is known.
    pub errors: Findings,
}

/// Feeds that make no hole.
#[derive(Clone, Debug, Default)]
pub(super) struct Uncounted {
    /// Feeds without retract: their number, the first and its length.
    pub unretracted: Option<(u64, Backtrace, f64)>,
    /// Curved feeds: their number and the first.
    pub curved: Option<(u64, Backtrace)>,
}

/// Path of a feed.
#[derive(Clone, Debug)]
pub(super) enum Path {
    Straight,
    /// An arc; `None` if the table or the head rotates.
    Curved(Option<PartArc>),
}

impl Uncounted {
    pub(super) fn add_unretracted(&mut self, place: &Backtrace, length: f64) {
        self.unretracted.get_or_insert_with(|| (0, place.clone(), length)).0 += 1;
    }

    pub(super) fn add_curved(&mut self, place: Backtrace) {
        self.curved.get_or_insert((0, place)).0 += 1;
    }
}

impl Engagement {
    fn clear(&mut self) {
        let mut points = std::mem::take(&mut self.points);
        points.clear();
        *self = Self { points, approach_level: self.approach_level, ..Self::default() };
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
        // A helix on the circle leaves a core unless the cutter reaches the axis.
        let reaches_axis = cutter.is_some_and(|cutter| radius <= cutter / 2.0 + slack);
        let is_helix = cutter.is_none() && self.rings.iter().any(Ring::is_helix);
        let mut kept: Vec<Ring> = Vec::new();
        let mut order: Vec<&Ring> = self.rings.iter().collect();
        order.sort_by(|a, b| a.level().total_cmp(&b.level()).then(b.radius.total_cmp(&a.radius)));
        for ring in order {
            if kept.iter().all(|deeper| deeper.radius < ring.radius - 0.01) {
                kept.push(ring.clone());
            }
        }
        Some(Circles { rings: kept, is_certain: is_inside || reaches_axis || is_helix })
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
        if is_across {
            let lowest = begin.min(end);
            // A feed that goes down and across by more than 30° to the tool is no drilling.
            let is_sloped = (end - begin).abs() > LEVEL_TOLERANCE && aside > 0.577 * (end - begin).abs();
            if arc.is_some() || is_sloped || lowest < top - LEVEL_TOLERANCE {
                self.strokes.note_milling(lowest);
            }
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
        match arc {
            Some(arc) => {
                for t in [0.25, 0.5, 0.75] {
                    engagement.push_point(arc.point(t));
                }
                let place = || (event.backtrace(), self.axis_position);
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
        if end > top + LEVEL_TOLERANCE || engagement.has_descended && end >= top - LEVEL_TOLERANCE {
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
        match circles {
            Some(circles) => self.push_circles(circles),
            None => {
                let uncounted = std::mem::take(&mut self.engagement.uncounted);
                let errors = std::mem::take(&mut self.engagement.errors);
                self.report_uncounted(uncounted);
                self.findings.append(errors);
            }
        }
        self.engagement.clear();
    }

    fn push_circles(&mut self, circles: Circles) {
        let start = self.engagement.start.unwrap_or(self.pose.tip);
        for ring in circles.rings {
            let out = ring.out;
            let begin = start.coords.dot(&out);
            // A tool that comes down in rapid begins its feed at the depth of the circle.
            let begin =
                if begin > ring.level() + LEVEL_TOLERANCE { begin } else { self.engagement.approach_level };
            let length = (begin - ring.level()).max(LEVEL_TOLERANCE);
            let place = ring.backtrace.clone();
            self.check_clamped(&place, self.clamp_state);
            if self.cutting_state.spindle_direction == SpindleDirection::Off {
                let builder_code = self.builder_code;
                self.findings.add(&SPINDLE_STOPPED, &place, 0, |_| {
                    spindle::spindle_stopped_finding(
                        "the tool feeds into the part with the spindle stopped",
                        builder_code,
                    )
                    .help("start the spindle with M03 S… before the feed")
                });
            }
            let pass = DrillPass {
                start: ring.centre + out.into_inner() * length,
                bottom: ring.centre,
                axis: out,
                feed_direction: out,
                tool: self.setup.tool,
                backtrace: place,
                axis_position: ring.axis_position,
                circle: Some(MilledCircle { radius: ring.radius, roundness: ring.roundness }),
            };
            self.strokes.push(pass, CutKind::Circle { is_certain: circles.is_certain });
        }
    }
}
