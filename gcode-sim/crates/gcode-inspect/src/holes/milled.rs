//! Milled holes: full circles that the tool mills from the inside between two retracts.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::arc_run::{ArcRun, PartArc, Ring};
use super::chord_run::ChordRun;
use super::cut_states::{CutStates, StateCut};
use super::drill_pass::{DrillPass, MilledCut, PassCut};
use super::feed_law::ON_AXIS;
use super::gouge_report::OpenFeed;
use super::hole_circles::HoleCircles;
use super::per_block::Findings;
use super::slug::Turn;
use super::strokes::{CutKind, LEVEL_TOLERANCE, Uncounted};
use gcode_lang::motion::{Backtrace, Event, UnknownAxes};
use gcode_part::Collar;

/// Largest number of points of an engagement; with more the tool mills something larger than a hole.
const MAX_POINTS: usize = 50_000;

/// Largest rise of a chord along a thread, by its length across the tool.
const MAX_SLOPE: f64 = 0.5;

/// Cosine of the largest angle between a circle's axis and the tool: 0.05°.
pub(super) const MIN_AXIS_COSINE: f64 = 0.999_999_6;

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
    pub points: Vec<Point3<f64>>,
    /// Arcs of the path.
    pub arcs: Vec<PartArc>,
    run: Option<ArcRun>,
    chords: Option<ChordRun>,
    /// Modal states of the current run's feeds.
    run_cuts: CutStates,
    pub rings: Vec<Ring>,
    /// Strokes at nominal holes along which the tool doesn't retract.
    pub unretracted: Vec<(u32, DrillPass)>,
    /// Length of the mill's edges, mm; infinite if it is unknown. Set where the engagement ends.
    pub edges: f64,
    /// Number of feeds before it that removed what has to stay.
    spoilt_before: u32,
    /// Number of sweeps that had removed metal before it.
    sweeps_before: u32,
    /// Axes of unknown position on the part during an arc.
    unknown_axes: UnknownAxes,
    /// Feeds that make no hole, unless the engagement does.
    pub uncounted: Uncounted,
    /// Errors about them, where the surface is known.
    pub errors: Findings,
    /// Feeds beside holes without a diameter, which its circles may mill.
    pub open_feeds: Vec<OpenFeed>,
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
        let (mut points, mut arcs) = (std::mem::take(&mut self.points), std::mem::take(&mut self.arcs));
        points.clear();
        arcs.clear();
        *self = Self { points, arcs, approach_level: self.approach_level, ..Self::default() };
    }

    /// Returns true if the path has more points than a hole needs.
    pub(super) fn is_full(&self) -> bool {
        self.points.len() == MAX_POINTS
    }

    /// Returns true if a feed has removed what has to stay, by the number of all such feeds.
    pub(super) fn is_spoilt(&self, gouge_count: u32) -> bool {
        self.spoilt_before < gouge_count
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

    /// Returns true if the tool has gone round the axis of a hole, along arcs or chords.
    pub(super) fn circles_about(&self, collar: &Collar) -> bool {
        let arcs = self.arcs.iter().map(|arc| &arc.centre);
        let mut centres = arcs.chain(self.rings.iter().map(|ring| &ring.centre));
        centres.any(|centre| collar.from_axis(centre) <= ON_AXIS)
            || self.chords.as_ref().is_some_and(|chords| chords.circles_about(collar))
    }

    /// Returns a turn of the current run of arcs whose slug is to be looked for.
    pub(super) fn next_turn(&mut self) -> Option<Turn> {
        self.run.as_mut()?.next_turn()
    }

    pub(super) fn set_slug(&mut self, slug: f64) {
        if let Some(run) = &mut self.run {
            run.slug = Some(slug);
        }
    }

    /// Ends the current run, of arcs or of chords.
    fn end_run(&mut self) {
        if self.run.is_none() && self.chords.is_none() {
            return;
        }
        let cuts = std::mem::take(&mut self.run_cuts);
        let arcs = self.run.take().and_then(ArcRun::finish);
        let ring = arcs.or(self.chords.take().and_then(ChordRun::finish));
        self.rings.extend(ring.map(|ring| Ring { cuts, ..ring }));
    }
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
        if is_across {
            self.remove_start_holes(from, arc.as_ref());
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
        // An arc that rises leads out above the approach, and so do chords: the feed may begin at the bottom of a thread.
        let is_flat = is_across && rise <= MAX_SLOPE * aside;
        let exit = if arc.is_some() || is_flat { top.max(engagement.approach_level) } else { top };
        let place = || (event.backtrace(), self.axis_position);
        match arc {
            None if is_across => {
                if engagement.run.is_some() {
                    engagement.end_run();
                }
                if !engagement.chords.as_mut().is_some_and(|chords| chords.extend(to, &out, place)) {
                    engagement.end_run();
                    engagement.chords = Some(ChordRun::new(*from, to, out));
                }
            }
            Some(arc) => {
                if engagement.chords.is_some() {
                    engagement.end_run();
                }
                for t in [0.25, 0.5, 0.75] {
                    engagement.push_point(arc.point(t));
                }
                if !engagement.is_full() {
                    engagement.arcs.push(arc.clone());
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
            self.note_run_cut(event);
        }
        self.note_slug();
        let engagement = &mut self.engagement;
        engagement.has_descended |= end < top - LEVEL_TOLERANCE;
        let is_out =
            end > exit + LEVEL_TOLERANCE || engagement.has_descended && end >= exit - LEVEL_TOLERANCE;
        // A feed out of a circle ends it as a rapid does.
        let is_retract = !is_across && begin < end && !engagement.rings.is_empty();
        if is_out || is_retract && !engagement.is_below(&to, &out) {
            self.end_engagement();
        }
    }

    /// Records the modal state of a feed of the current run.
    fn note_run_cut(&mut self, event: &Event<'_>) {
        let Some(rate) = event.kind.rate() else { return };
        let state = self.tool_state();
        let origin = self.offset_origin.as_ref();
        let first = || StateCut::new(state, rate, true, event.backtrace(), origin);
        self.engagement.run_cuts.record(&state, rate, true, first);
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

    /// Ends the engagement: its circles are passes of holes, or its feeds make none.
    pub(super) fn end_engagement(&mut self) {
        self.engagement.end_run();
        let tool = self.setup.tool.and_then(|number| self.machine.find_tool(number));
        self.engagement.edges = tool.and_then(|tool| tool.flute_length).unwrap_or(f64::INFINITY);
        let (holes, has_pocket) = self.hole_circles();
        for circles in &holes {
            self.push_circles(circles);
        }
        let unretracted = std::mem::take(&mut self.engagement.unretracted);
        let uncounted = std::mem::take(&mut self.engagement.uncounted);
        let errors = std::mem::take(&mut self.engagement.errors);
        let open_feeds = std::mem::take(&mut self.engagement.open_feeds);
        self.report_open_feeds(open_feeds, &holes);
        if holes.is_empty() {
            for (order, pass) in unretracted {
                self.push_unretracted(order, pass, has_pocket);
            }
            self.report_uncounted(uncounted);
            self.findings.append(errors);
        }
        self.engagement.clear();
        self.engagement.spoilt_before = self.gouge_count;
        self.engagement.sweeps_before = self.metal.removed.count();
    }

    /// Adds a stroke at a nominal hole without a retract: it makes the hole if nothing else does.
    /// In a pocket no wall of the hole ends the path.
    fn push_unretracted(&mut self, order: u32, pass: DrillPass, is_in_pocket: bool) {
        let (out, bottom) = (pass.axis, pass.cut.bottom);
        let top = pass.cut.start.coords.dot(&out);
        let excess = self.engagement.excess(&bottom, &out, 0.0, top).filter(|_| !is_in_pocket);
        if let Some(excess) = excess {
            self.report_wall_cut(&excess, &out, &pass.backtrace);
        }
        self.strokes.push_unretracted(order, pass);
    }

    /// Adds the passes of a hole.
    fn push_circles(&mut self, circles: &HoleCircles) {
        let start = self.engagement.start.unwrap_or(self.pose.tip);
        let Engagement { approach_level, unknown_axes, sweeps_before, .. } = self.engagement;
        let tool = self.setup.tool;
        if let Some(excess) = &circles.excess {
            let Ring { out, backtrace, .. } = &circles.widest;
            self.report_wall_cut(excess, out, backtrace);
        }
        for ring in &circles.rings {
            let out = ring.out;
            let begin = start.coords.dot(&out);
            // A tool that comes down in rapid begins its feed at the depth of the circle.
            let begin = if begin > ring.level() + LEVEL_TOLERANCE { begin } else { approach_level };
            let length = (begin - ring.level()).max(LEVEL_TOLERANCE);
            let Ring { radius, roundness, wall, helix, .. } = *ring;
            let milled = MilledCut { radius, roundness, wall, core: ring.slug, helix };
            let cut = PassCut::new(ring.centre + out.into_inner() * length, ring.centre);
            let pass = DrillPass {
                cut: PassCut { milled: Some(milled), sweeps_before, ..cut },
                axis: out,
                is_tool_axis_known: self.pose.axis.is_some(),
                feed_direction: out,
                tool,
                backtrace: self.place_of(ring).clone(),
                axis_position: ring.axis_position,
                unknown_axes,
            };
            let is_even = ring.cuts.iter().len() == 1;
            for (cut, _) in ring.cuts.iter() {
                let place = if is_even { &pass.backtrace } else { &cut.backtrace };
                self.check_clamped(place, cut.state.clamp);
                if cut.is_stopped() {
                    self.report_spindle_stopped(place, &cut.state);
                }
            }
            let order = self.strokes.begin_pass();
            self.strokes.push(order, pass, CutKind::Drilled);
        }
    }

    /// Returns the block of a circle; at a thread, that of its first uneven turn.
    fn place_of<'r>(&self, ring: &'r Ring) -> &'r Backtrace {
        let is_thread = || self.strokes.nominal_of_ring(ring, true).is_some_and(|axis| axis.thread.is_some());
        ring.uneven_turn.as_ref().filter(|_| is_thread()).unwrap_or(&ring.backtrace)
    }
}
