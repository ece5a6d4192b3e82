//! Feeds in metal: they may remove the nominal holes and the stated pockets, and nothing else of the part.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::line::CuttingLine;
use super::metal::PointInMetal;
use super::near_metal::{Contact, FeedPart, Judged};
use super::profile::Profile;
use super::rapid_paths::{OnPath, Search};
use super::rapids::PLUNGE_COSINE;
use super::removed_metal::Covers;
use super::strip::Line;
use super::swept_tool::{TipPaths, contact, rim};
use crate::machine::{AxisMotion, TOUCH_DEPTH, ToolPart};
use gcode_lang::motion::Event;

/// Largest deviation of an arc from the chords by which it removes metal, mm.
pub(super) const CHORD_TOLERANCE: f64 = 0.005;

/// Deviation of the chords that show whether an arc is near the metal, mm.
pub(super) const COARSE_TOLERANCE: f64 = 5.0;

/// Distance from the axis of a hole up to which a stroke drills it, mm; farther off a mill makes it.
pub(super) const ON_AXIS: f64 = 0.5;

/// Number of chords of an arc beside which the shank and the holder are looked for in the metal first.
const FEW_CHORDS: usize = 16;

/// Number of feeds with a gouge after which no more are compared.
const MAX_GOUGES: u32 = 1000;

/// Number of feeds with a gouge whose deepest point is looked for; of later ones the first contact counts.
const MAX_MEASURED_GOUGES: u32 = 4;

/// Largest excess of a shank or a holder over the hole in which it goes, mm in radius: half the tolerance of the diameter.
pub(super) const FIT: f64 = 0.025;

/// Largest distance by which a plunge leads aside, mm.
const MAX_ASIDE: f64 = 0.2;

/// Deepest cut of a feed into metal that has to stay.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gouge {
    pub at: PointInMetal,
    pub part: ToolRegion,
}

/// Feeds along the tool, on one line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plunge {
    /// From the highest to the deepest tip.
    travel: Line,
    axis: Unit<Vector3<f64>>,
    /// Number of sweeps before it.
    before: u32,
}

/// Region of a tool that makes a gouge.
#[derive(Clone, Copy, Debug)]
pub(super) enum ToolRegion {
    Tip,
    Side,
    Shank,
    /// The tip, fed through this hole and beyond its far side.
    TipBeyond(usize),
}

impl HoleExtractor<'_> {
    /// Applies a change of the tool or its length.
    pub(super) fn update_tool_body(&mut self) {
        self.tool_body = self.machine.tool_body(&self.setup, self.assumed_cone().map(|cone| cone.angle));
        self.profile = (!self.tool_body.is_empty()).then(|| Profile::of_tool(&self.tool_body));
    }

    /// Returns the tool with a flat end.
    fn flat_tool(&self) -> ToolPart {
        ToolPart::flutes(0.0, f64::INFINITY, self.tool_radius().unwrap_or(0.0))
    }

    /// Returns true if the tool cuts metal that is known between two points, false if all that is known there is removed,
    /// and `None` if nothing is known.
    pub(super) fn cuts_known_metal(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<bool> {
        let cuts = self.metal.cuts(from, to)?;
        let (axis, along) = (self.axis_in_motion(from, to), to - from);
        if axis.is_some_and(|axis| self.has_repeated(&[*from, *to], &axis, Covers::All)) {
            return Some(false);
        }
        let is_cut = |offset: Vector3<f64>| {
            let (from, to) = (from + offset, to + offset);
            self.metal.cuts(&from, &to) == Some(true)
                || axis.is_some_and(|axis| self.metal.cuts_open_wall(&[from, to], &axis, offset.norm()))
        };
        let cuts_at_rim = |axis: Unit<Vector3<f64>>| {
            // The full diameter is above the point; a tool that moves sideways cuts with the whole point.
            self.machine.tool_end(self.setup.tool).first().is_some_and(|full| {
                let height = if is_along(&axis, &along) { full.from } else { 0.0 };
                let above = axis.into_inner() * height;
                rim(&axis, &along, full.radius()).into_iter().any(|offset| is_cut(offset + above))
            })
        };
        let cuts_as_wide_as_its_feature = |axis: Unit<Vector3<f64>>| {
            let radius = self.radius_of_unsized(&[*from, *to], &axis);
            radius.is_some_and(|radius| rim(&axis, &along, radius - FIT).into_iter().any(is_cut))
        };
        let cuts_mouth = |axis: Unit<Vector3<f64>>| {
            self.widest_in_open_hole(to, &axis).is_some_and(|(height, radius)| {
                let above = axis.into_inner() * height;
                rim(&axis, &along, radius).into_iter().any(|offset| is_cut(offset + above))
            })
        };
        Some(
            cuts || axis.is_some_and(|axis| {
                cuts_at_rim(axis)
                    || cuts_mouth(axis)
                    || self.cuts_with_side(&[*from, *to], &axis)
                    || cuts_as_wide_as_its_feature(axis)
            }),
        )
    }

    /// Returns true if the side of the tool cuts metal that is known, deeper than it fits in a hole of its diameter: a countersink in
    /// a hole, or a mill whose end is below the part.
    fn cuts_with_side(&self, travel: &Line, axis: &Unit<Vector3<f64>>) -> bool {
        if self.pose.axis.is_none() || self.tool_radius().is_none() {
            return false;
        }
        let cutters = self.tool_body.iter().filter(|part| part.is_cutter);
        let narrower = cutters.map(|part| ToolPart { taper: part.taper.grown(-FIT), ..*part });
        narrower.filter(|part| self.may_cut(part, travel, axis)).any(|part| {
            let found = contact(&part, axis, &TipPaths::line(travel), &self.metal, Judged::Uncut(None));
            matches!(found, Contact::Metal(_))
        })
    }

    /// Removes the metal that a feed through points sweeps, and reports a gouge where the positions of the axes are known.
    pub(super) fn remove_by_feed(&mut self, event: &Event<'_>, path: &[Point3<f64>], is_known: bool) {
        if !self.metal.is_known() {
            return;
        }
        let radius = self.tool_radius().unwrap_or(0.0);
        let is_judged = is_known && self.metal.holes.is_some();
        let chords: Vec<(Line, Unit<Vector3<f64>>)> = path
            .windows(2)
            .filter_map(|pair| Some(([pair[0], pair[1]], self.axis_in_motion(&pair[0], &pair[1])?)))
            .collect();
        if is_judged && (self.surface.is_none() || self.has_left_start) {
            let mills = |own: &Self| chords.iter().any(|(chord, axis)| own.mills(chord, axis));
            if let Some(rate) = event.kind.rate() {
                self.check_milling(event, rate, path, mills);
            }
            self.note_milled_block(event, &chords);
        }
        let is_judged = is_judged && self.gouge_count < MAX_GOUGES;
        let mut worst: Option<Gouge> = None;
        let is_deepest_wanted = self.gouge_count < MAX_MEASURED_GOUGES;
        for (chord, axis) in chords {
            let [from, to] = chord;
            if !self.metal.is_touched(&from, &to, &axis, radius) {
                continue;
            }
            let is_plunge = is_along(&axis, &(to - from));
            // The direction of the tool is unknown, and the body is one that is drilled all round.
            let is_unclear =
                self.pose.axis.is_none() && self.surface.is_some_and(|body| !body.has_flat_faces());
            let mut has_scratched = false;
            // A plunge may drill a hole: the motion after it shows that.
            match is_judged && !is_unclear {
                true if is_plunge => self.record_plunge(&chord, &axis),
                true if worst.is_some() && !is_deepest_wanted => {}
                true => {
                    let gouge = self.gouge(&chord, &axis, u32::MAX);
                    let gouge = gouge.filter(|gouge| !self.becomes_cone(&chord, &axis, gouge));
                    has_scratched = gouge.is_none() && self.scratches(&chord, &axis);
                    worst = Gouge::worse(worst, gouge);
                }
                false => {}
            }
            self.remove(&chord, &axis, has_scratched);
            if is_plunge {
                self.record_hole_stroke(&chord, &axis);
            }
        }
        if is_judged && worst.is_none() {
            worst = self.shank_contact(path);
        }
        self.count_unsearched_feed(event, OnPath::Straight);
        if let Some(gouge) = worst {
            self.gouge_count += 1;
            self.milling.record_cut(&self.tool_state());
            self.report_gouge(&event.backtrace(), path, gouge);
        }
    }

    /// Counts a feed if a search for what it cuts has been given up.
    pub(super) fn count_unsearched_feed(&mut self, event: &Event<'_>, path: OnPath) {
        if self.is_feed_unsearched.take() {
            self.count_unsearched(event, Search::Feed(path));
        }
    }

    /// Follows a feed on an arc in chords.
    pub(super) fn remove_by_arc(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>, is_known: bool) {
        // Coarse chords come first: most paths are far away.
        let reach = self.tool_radius().unwrap_or(0.0) + COARSE_TOLERANCE;
        let is_near = self.chords(travel, COARSE_TOLERANCE).windows(2).any(|chord| {
            let Some(axis) = self.axis_in_motion(&chord[0], &chord[1]) else { return false };
            let [from, to] = [chord[0], chord[1]].map(|p| p - axis.into_inner() * COARSE_TOLERANCE);
            self.metal.is_touched(&from, &to, &axis, reach)
        });
        if is_near {
            let path = self.chords(travel, CHORD_TOLERANCE);
            self.check_thread_wall(event, &path);
            self.remove_by_feed(event, &path, is_known);
        }
    }

    /// Returns the direction of the tool; if it is unknown, that of a nominal hole to which the motion is parallel, or Z.
    pub(super) fn axis_in_motion(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<Unit<Vector3<f64>>> {
        if self.pose.axis.is_some() {
            return self.pose.axis;
        }
        let (mut parallel, mut any) = (None, None);
        if let Some(holes) = &self.metal.holes {
            holes.near(&from.inf(to), &from.sup(to), &mut |hole| {
                let collar = holes.collar(hole);
                any = Some(collar.rod.axis);
                if collar.is_parallel(&(to - from)) {
                    parallel = any;
                }
            });
        }
        parallel.or_else(|| self.tool_direction()).or(any)
    }

    /// Adds what a straight feed removes; `has_scratched` if it has cut a little of what has to stay.
    pub(super) fn remove(
        &mut self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        has_scratched: bool,
    ) {
        if let Some(profile) = &self.profile {
            // A stopped bar is shifted off the wall and cuts nothing.
            if self.tool_radius().is_some() {
                self.metal.removed.add(*travel, *axis, profile, has_scratched);
            }
            return;
        }
        self.remove_unsized(travel, axis);
    }

    /// Returns the gouge that a feed makes in what is left of the metal by the first sweeps.
    pub(super) fn gouge(&self, travel: &Line, axis: &Unit<Vector3<f64>>, sweeps: u32) -> Option<Gouge> {
        if self.surface.is_some() && !self.has_left_start {
            return None;
        }
        match self.metal.judged_on(travel, Judged::Kept(FeedPart::Tip, sweeps)) {
            Some(at) => Some(Gouge { at, part: ToolRegion::Tip }),
            None => self
                .side_gouge(&self.tool_body, travel, axis, sweeps)
                .or_else(|| self.middle_gouge(travel, axis, sweeps))
                .or_else(|| self.gouge_beyond(travel)),
        }
    }

    /// Returns the gouge that the middle of a tool of unknown diameter makes above its tip in a feed across it.
    fn middle_gouge(&self, travel: &Line, axis: &Unit<Vector3<f64>>, sweeps: u32) -> Option<Gouge> {
        let is_unsized = self.tool_body.is_empty() && self.pose.axis.is_some();
        if self.surface.is_none() || !is_unsized || is_along(axis, &(travel[1] - travel[0])) {
            return None;
        }
        let middle = ToolPart::flutes(0.0, f64::INFINITY, 0.0);
        let at = self.contact_in_feed(&middle, axis, travel, Judged::Kept(FeedPart::Tip, sweeps))?;
        Some(Gouge { at, part: ToolRegion::Tip })
    }

    /// Returns the gouge of a tool that is fed beyond the far side of a hole.
    fn gouge_beyond(&self, travel: &[Point3<f64>; 2]) -> Option<Gouge> {
        let axis = self.pose.axis.filter(|_| self.surface.is_some())?;
        let beyond = |tip| self.metal.beyond_hole(tip, &axis);
        let (hole, at) =
            travel.iter().filter_map(beyond).reduce(|a, b| if a.1.depth < b.1.depth { b } else { a })?;
        Some(Gouge { at, part: ToolRegion::TipBeyond(hole) })
    }

    /// Returns the gouge that the cutting parts of a tool make beside the path of its tip.
    pub(super) fn side_gouge(
        &self,
        body: &[ToolPart],
        travel: &Line,
        axis: &Unit<Vector3<f64>>,
        sweeps: u32,
    ) -> Option<Gouge> {
        self.pose.axis?;
        if sweeps == u32::MAX && self.has_repeated(travel, axis, Covers::Kept) {
            return None;
        }
        body.iter().filter(|part| part.is_cutter).find_map(|part| {
            if !self.may_cut(part, travel, axis) || self.metal.is_allowed(travel, axis, part, TOUCH_DEPTH) {
                return None;
            }
            let side = FeedPart::Side { radius: part.radius(), slope: part.taper.slope };
            let at = self.contact_in_feed(part, axis, travel, Judged::Kept(side, sweeps))?;
            Some(Gouge { at, part: ToolRegion::Side })
        })
    }

    /// Returns the deepest metal that a part of the tool meets in a feed; a search that is given up is counted with the feed.
    pub(super) fn contact_in_feed(
        &self,
        part: &ToolPart,
        axis: &Unit<Vector3<f64>>,
        travel: &Line,
        judged: Judged<'_>,
    ) -> Option<PointInMetal> {
        match contact(part, axis, &TipPaths::line(travel), &self.metal, judged) {
            Contact::Clear => None,
            Contact::Metal(at) => Some(at),
            Contact::Unknown => {
                self.is_feed_unsearched.set(true);
                None
            }
        }
    }

    /// Returns the contact of the shank or the holder with the metal that is left along a path; none if the tool has neither.
    fn shank_contact(&self, path: &[Point3<f64>]) -> Option<Gouge> {
        let axis = self.pose.axis.filter(|_| self.surface.is_none() || self.has_left_start)?;
        let last = path.len().checked_sub(1)?;
        let step = last.div_ceil(FEW_CHORDS).max(1);
        let coarse = (0..last).step_by(step).filter_map(|index| path.get(index..=(index + step).min(last)));
        let at = self.tool_body.iter().filter(|part| !part.is_cutter).find_map(|part| {
            // Beside a coarse chord the path is inside a part that is wider by its sagitta.
            coarse.clone().find_map(|piece| {
                let chord = [*piece.first()?, *piece.last()?];
                let wider = ToolPart { taper: part.taper.grown(sagitta(piece)), ..*part };
                match piece {
                    [_, _] => self.shank_on_line(part, &axis, &chord),
                    _ => {
                        self.shank_on_line(&wider, &axis, &chord)?;
                        let fine = piece.windows(2).map(|fine| [fine[0], fine[1]]);
                        fine.filter_map(|fine| self.shank_on_line(part, &axis, &fine))
                            .reduce(PointInMetal::deeper)
                    }
                }
            })
        })?;
        Some(Gouge { at, part: ToolRegion::Shank })
    }

    /// Returns the contact of a part that doesn't cut on a straight feed.
    fn shank_on_line(
        &self,
        part: &ToolPart,
        axis: &Unit<Vector3<f64>>,
        travel: &Line,
    ) -> Option<PointInMetal> {
        if !self.may_cut(part, travel, axis) {
            return None;
        }
        // Below the entry of a nominal hole its outline decides on strokes in it: a part that it excludes has its own finding.
        let is_stroke = is_along(axis, &(travel[1] - travel[0]));
        let hole = if is_stroke { self.metal.hole_of_stroke(travel, axis) } else { None };
        // The entry of the hole decides on the spindle.
        if hole.is_some() && self.machine.tool_length(&self.setup) <= part.from {
            return None;
        }
        self.contact_in_feed(part, axis, travel, Judged::Uncut(hole)).or_else(|| {
            hole.filter(|_| self.metal.is_allowed(travel, axis, part, TOUCH_DEPTH))?;
            // A cut that gives the outline its width may come later in the program.
            let part = ToolPart { taper: part.taper.grown(-FIT), ..*part };
            self.contact_in_feed(&part, axis, travel, Judged::Uncut(None))
        })
    }

    /// Returns false if a part of the tool stays outside the metal that is known.
    pub(super) fn may_cut(
        &self,
        part: &ToolPart,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
    ) -> bool {
        let Some(body) = self.surface else {
            let [from, to] = travel.map(|tip| tip + axis.into_inner() * part.from);
            return self.metal.is_touched(&from, &to, axis, part.radius());
        };
        let height = self.metal.removed.height_of_round(&travel[0], axis, part.radius());
        let to = if self.metal.is_endless(part) { part.from + height } else { part.to };
        let part = ToolPart { to, ..*part };
        part.cuts(&body, (&travel[0], axis), &(travel[1] - travel[0]))
    }

    /// Starts a line along the tool.
    pub(super) fn begin_plunge(&mut self) {
        self.plunge = None;
    }

    /// Records a feed along the tool. Round the holes of a list it is judged as a hole.
    fn record_plunge(&mut self, travel: &Line, axis: &Unit<Vector3<f64>>) {
        if self.surface.is_none() || !self.has_left_start {
            return;
        }
        let [from, to] = *travel;
        match &mut self.plunge {
            Some(plunge) => {
                let height = |p: &Point3<f64>| p.coords.dot(&plunge.axis);
                let [mut top, mut bottom] = plunge.travel;
                for p in [from, to] {
                    (top, bottom) = (
                        if height(&top) < height(&p) { p } else { top },
                        if height(&p) < height(&bottom) { p } else { bottom },
                    );
                }
                plunge.travel = [top, bottom];
            }
            None => {
                let before = self.metal.removed.close();
                self.plunge = Some(Plunge { travel: *travel, axis: *axis, before });
            }
        }
    }

    /// Returns the gouge of the current line, in the metal before it.
    pub(super) fn plunge_gouge(&self, line: &CuttingLine) -> Option<Gouge> {
        let Plunge { travel, axis, before } =
            self.plunge.filter(|_| line.cutting_state.tool == self.setup.tool)?;
        let is_allowed = self.metal.is_allowed(&travel, &axis, &self.flat_tool(), TOUCH_DEPTH);
        let gouge = if is_allowed { None } else { self.gouge(&travel, &axis, before) };
        gouge.filter(|gouge| self.cone_without_gouge(&travel, &axis, gouge, before).is_none())
    }

    /// Returns true if the current line makes a gouge.
    pub(super) fn has_gouged(&self, line: &CuttingLine) -> bool {
        self.plunge_gouge(line).is_some()
    }

    /// Reports a feed out along a tool that lifts the metal above its undercut. Back boring has its own finding.
    pub(super) fn check_lift(&mut self, line: &CuttingLine) {
        if !line.is_inward() && self.cuts_undercut() {
            self.report_plunge(line);
        }
    }

    /// Returns true if all metal in which a line feeds is in a pocket.
    pub(super) fn is_pocketing(&self, line: &CuttingLine) -> bool {
        let axis = line.tool_axis.unwrap_or(line.out);
        let radius = self.machine.diameter_of(line.cutting_state.tool).unwrap_or(0.0) / 2.0;
        self.is_round_in_pocket(&[line.start, line.bottom()], &axis, radius)
    }

    /// Returns true if all metal within a radius of a line is in a pocket.
    pub(super) fn is_round_in_pocket(
        &self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        radius: f64,
    ) -> bool {
        let offsets = rim(axis, &(travel[1] - travel[0]), radius);
        let mut lines = offsets.iter().map(|offset| travel.map(|tip| tip + offset)).chain([*travel]);
        lines.all(|line| self.metal.is_in_pocket(&line))
    }

    /// Reports the gouge of the current line.
    pub(super) fn report_plunge(&mut self, line: &CuttingLine) {
        if let Some(gouge) = self.plunge_gouge(line) {
            self.plunge = None;
            self.report_gouge(line.backtrace(), &[line.start, line.bottom()], gouge);
        }
    }
}

impl Gouge {
    fn deeper(self, other: Self) -> Self {
        if self.at.depth < other.at.depth { other } else { self }
    }

    /// Returns the deeper of two.
    fn worse(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        match (one, other) {
            (Some(one), Some(other)) => Some(one.deeper(other)),
            (one, other) => one.or(other),
        }
    }
}

/// Returns the largest distance of the points of a path from its chord, mm.
fn sagitta(path: &[Point3<f64>]) -> f64 {
    let (Some(from), Some(to)) = (path.first(), path.last()) else { return 0.0 };
    let along = (to - from).try_normalize(0.0).unwrap_or_default();
    let aside = path.iter().map(|p| (p - from) - along * (p - from).dot(&along));
    aside.map(|aside| aside.norm()).fold(0.0, f64::max)
}

/// Returns true if a motion is along the tool.
pub(super) fn is_along(axis: &Unit<Vector3<f64>>, along: &Vector3<f64>) -> bool {
    let height = along.dot(axis);
    PLUNGE_COSINE * along.norm() <= height.abs() && (along - axis.into_inner() * height).norm() <= MAX_ASIDE
}
