//! Metal near a motion that is judged: shares of lines and strips in it, and an exact search of strips for it.
use std::cell::OnceCell;

use nalgebra::{Point3, Unit, Vector3};

use super::metal::{KnownMetal, MAX_OFFSET, PointInMetal, ROUNDING, SIDE_SLACK, is_rounding};
use super::removed_metal::{Covers, FirstSweeps};
use super::shares::Shares;
use super::strip::{Line, Strip};
use crate::machine::TOUCH_DEPTH;
use gcode_part::{Collar, NOISE, Step, Taper};

/// Margin above a hole within which its room is looked for, mm.
pub(super) const MAX_HEIGHT: f64 = 50.0;

/// Largest number of strips that are halved in one search.
const MAX_HALVED: usize = 4000;

/// Number of steps to the deepest point once there is one.
const DEPTH_STEPS: u32 = 12;

/// Part of the tool whose feed is judged.
#[derive(Clone, Copy, Debug)]
pub(super) enum FeedPart {
    Tip,
    /// The side of a part of this radius, a cone if it has a slope.
    Side {
        radius: f64,
        slope: f64,
    },
}

/// Metal that a part of the tool must not meet.
#[derive(Clone, Copy, Debug)]
pub(super) enum Judged<'c> {
    /// All that no feed has removed, above the plane of a hole's entry if there is one.
    Uncut(Option<&'c Collar>),
    /// What has to stay: neither in a nominal hole nor in a pocket, nor removed by this many first sweeps.
    Kept(FeedPart, u32),
    /// All that no feed has removed, outside the nominal holes.
    Milled(FeedPart),
    /// What has to stay, removed or not, to its very surface.
    Untouched(FeedPart),
}

impl Judged<'_> {
    /// Returns the thickness that counts as no metal, mm.
    fn skin(self) -> f64 {
        match self {
            Self::Untouched(_) => ROUNDING,
            Self::Uncut(_) | Self::Kept(..) | Self::Milled(_) => TOUCH_DEPTH,
        }
    }
}

/// Result of a search.
#[derive(Clone, Copy, Debug)]
pub(super) enum Contact {
    Clear,
    Metal(PointInMetal),
    /// The search was given up.
    Unknown,
}

impl KnownMetal {
    /// Returns the deepest point of a travel in metal that is not removed.
    pub(super) fn uncut(&self, travel: &Line) -> Option<PointInMetal> {
        self.judged_on(travel, Judged::Uncut(None))
    }

    /// Returns the length of a travel in metal that is not removed, mm.
    pub(super) fn uncut_length(&self, travel: &Line) -> f64 {
        let line = Strip::line(*travel);
        let shares = NearMetal::new(self, line.bounds(), Judged::Uncut(None)).shares(&line, None);
        let all: f64 = shares.pieces().iter().map(|[first, last]| last - first).sum();
        all * (travel[1] - travel[0]).norm()
    }

    /// Returns the deepest point of a travel in metal that has to stay.
    pub(super) fn gouge(&self, travel: &Line, part: FeedPart) -> Option<PointInMetal> {
        self.judged_on(travel, Judged::Kept(part, u32::MAX))
    }

    /// Returns the deepest point of a travel in metal that is judged.
    pub(super) fn judged_on(&self, travel: &Line, judged: Judged<'_>) -> Option<PointInMetal> {
        let line = Strip::line(*travel);
        NearMetal::new(self, line.bounds(), judged).on_line(travel)
    }

    /// Returns true if a travel leads through metal that is known, false if all that is known there is removed, and `None`
    /// if nothing is known.
    pub(super) fn cuts(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<bool> {
        let travel = [*from, *to];
        let line = Strip::line(travel);
        let mut shares = self.solid(&line, TOUCH_DEPTH, |_| true);
        if shares.is_empty() {
            return self.body.map(|_| false);
        }
        NearMetal::new(self, line.bounds(), Judged::Uncut(None)).uncover(&line, Covers::All, &mut shares);
        Some(!is_clear(&line, &shares))
    }

    /// Returns true if a travel within a radius of the axis of a nominal hole without a diameter, below its entry, leads through what
    /// no feed has removed: how wide the metal round such a hole is removed, only the feeds show.
    pub(super) fn cuts_open_wall(&self, travel: &Line, axis: &Unit<Vector3<f64>>, radius: f64) -> bool {
        let open = self.holes.as_ref().filter(|holes| self.body.is_none() && holes.has_open());
        let Some(holes) = open else { return false };
        let line = Strip::line(*travel);
        let mut shares = Shares::default();
        let margin = Vector3::repeat(radius);
        let [low, high] = line.bounds();
        holes.around(&(low - margin), &(high + margin), &mut |hole| {
            let collar = holes.collar(hole);
            let is_near = |p: &Point3<f64>| collar.from_axis(p) <= radius + MAX_OFFSET;
            if !collar.has_diameter && collar.is_parallel(axis) && travel.iter().all(is_near) {
                shares.extend(collar.piece_below_entry(&travel[0], &travel[1]));
            }
        });
        NearMetal::new(self, line.bounds(), Judged::Uncut(None)).uncover(&line, Covers::All, &mut shares);
        !is_clear(&line, &shares)
    }
}

/// A strip on which there may be metal, and its shares outside which there is none.
struct OpenStrip {
    strip: Strip,
    shares: Shares,
}

/// Returns true if these shares of a strip are due to rounding alone.
fn is_clear(strip: &Strip, shares: &Shares) -> bool {
    let length = strip.length();
    shares.pieces().iter().all(|piece| is_rounding(length, *piece))
}

/// Metal that is judged near one motion.
pub(super) struct NearMetal<'m> {
    metal: &'m KnownMetal,
    judged: Judged<'m>,
    bounds: [Point3<f64>; 2],
    /// Sweeps and nominal holes near the motion, found when they are needed.
    sweeps: OnceCell<FirstSweeps<'m>>,
    rooms: OnceCell<Vec<&'m Collar>>,
}

impl<'m> NearMetal<'m> {
    /// Returns the metal in a box.
    pub(super) fn new(metal: &'m KnownMetal, bounds: [Point3<f64>; 2], judged: Judged<'m>) -> Self {
        Self { metal, judged, bounds, sweeps: OnceCell::new(), rooms: OnceCell::new() }
    }

    /// Returns the metal near some strips.
    pub(super) fn of_strips<'s>(
        metal: &'m KnownMetal,
        strips: impl IntoIterator<Item = &'s Strip>,
        judged: Judged<'m>,
    ) -> Self {
        let all = strips.into_iter().map(Strip::bounds);
        let bounds = all.reduce(|[low, high], [p, q]| [low.inf(&p), high.sup(&q)]);
        Self::new(metal, bounds.unwrap_or([Point3::origin(); 2]), judged)
    }

    /// Returns the deepest point of a line in the metal.
    pub(super) fn on_line(&self, line: &Line) -> Option<PointInMetal> {
        let mut shares = self.shares(&Strip::line(*line), None);
        // Of points of one depth the first on the line counts, whatever order the search has.
        shares.sort();
        self.metal.deepest(line, &shares)
    }

    /// Finds metal on some strips: its deepest point on an edge, or else between two edges.
    pub(super) fn contact(&self, strips: &[Strip]) -> Contact {
        let mut pending: Vec<OpenStrip> =
            strips.iter().filter_map(|strip| self.open_strip(strip, None)).collect();
        let edges = pending.iter().flat_map(|open| &open.strip.edges);
        if let Some(found) = edges.filter_map(|line| self.on_line(line)).reduce(PointInMetal::deeper) {
            return Contact::Metal(found);
        }
        let mut halved = 0;
        while !pending.is_empty() {
            pending.retain(|open| TOUCH_DEPTH < open.strip.width());
            halved += pending.len();
            if MAX_HALVED < halved {
                return Contact::Unknown;
            }
            let found = pending.iter().filter_map(|open| Some((self.on_middle(open)?, &open.strip)));
            if let Some((found, strip)) = found.reduce(|a, b| if a.0.depth < b.0.depth { b } else { a }) {
                return Contact::Metal(self.deepest_about(strip, found));
            }
            let halves = |open: &OpenStrip| {
                let halves = open.strip.halves().into_iter();
                halves.filter_map(|half| self.open_strip(&half, Some(&open.shares))).collect::<Vec<_>>()
            };
            pending = pending.iter().flat_map(halves).collect();
        }
        Contact::Clear
    }

    /// Returns a strip on which there may be metal at some shares; `None` if there is none.
    fn open_strip(&self, strip: &Strip, within: Option<&Shares>) -> Option<OpenStrip> {
        let mut shares = self.shares(strip, within);
        if is_clear(strip, &shares) {
            return None;
        }
        shares.join();
        Some(OpenStrip { strip: *strip, shares })
    }

    /// Returns the deepest point in the metal half way between the edges.
    fn on_middle(&self, open: &OpenStrip) -> Option<PointInMetal> {
        let middle = open.strip.middle();
        let line = Strip::line(middle);
        if is_clear(&line, &self.shares(&line, Some(&open.shares))) { None } else { self.on_line(&middle) }
    }

    /// Returns the deepest point of a strip about the one that is found on its middle.
    fn deepest_about(&self, strip: &Strip, mut found: PointInMetal) -> PointInMetal {
        let ([mut low, mut high], mut middle) = (strip.edges, strip.middle());
        for _ in 0..DEPTH_STEPS {
            let sides = [low, high].map(|edge| Strip::between(edge, middle).middle());
            let depths = sides.map(|line| self.on_line(&line));
            let [one, other] = depths.map(|at| at.map_or(f64::NEG_INFINITY, |at| at.depth));
            (low, middle, high) = match () {
                () if found.depth < one && other <= one => (low, sides[0], middle),
                () if found.depth < other => (middle, sides[1], high),
                () => (sides[0], middle, sides[1]),
            };
            found = depths.into_iter().flatten().fold(found, PointInMetal::deeper);
        }
        found
    }

    /// Returns shares of a strip outside which it is in no metal that is judged; those of a line are exact. `within` are those of
    /// a strip that holds this one: all bodies that remove shares are convex.
    fn shares(&self, strip: &Strip, within: Option<&Shares>) -> Shares {
        match self.judged {
            Judged::Uncut(hole) => self.uncut(strip, hole, within),
            Judged::Kept(part, _) | Judged::Untouched(part) => self.outside_holes(strip, part, true, within),
            Judged::Milled(part) => self.outside_holes(strip, part, false, within),
        }
    }

    /// Returns shares of a strip outside which it is in no metal, cut or not, or which its first edge decides.
    fn solid(&self, strip: &Strip, is_counted: impl Fn(usize) -> bool, within: Option<&Shares>) -> Shares {
        let mut shares = self.metal.solid(strip, self.judged.skin(), is_counted);
        if let Some(within) = within {
            shares.keep_common(within);
        }
        if strip.is_on_first {
            let [from, to] = &strip.edges[0];
            shares.take_away(self.metal.body.and_then(|body| body.piece(from, to, TOUCH_DEPTH)));
        }
        shares
    }

    fn uncut(&self, strip: &Strip, hole: Option<&Collar>, within: Option<&Shares>) -> Shares {
        let mut shares = self.solid(strip, |_| true, within);
        if let Some(hole) = hole {
            shares.take_away(strip.piece(|[from, to]| hole.piece_below_entry(from, to)));
        }
        self.uncover(strip, Covers::All, &mut shares);
        shares
    }

    /// Returns shares of a strip outside which it is in no metal outside the nominal holes, and outside the pockets if these may go.
    fn outside_holes(
        &self,
        strip: &Strip,
        part: FeedPart,
        may_pockets_go: bool,
        within: Option<&Shares>,
    ) -> Shares {
        let Some(holes) = self.metal.holes.as_ref() else { return Shares::default() };
        // Without a diameter the wall of a hole is unknown.
        let mut shares = self.solid(strip, |hole| holes.collar(hole).has_diameter, within);
        for pocket in self.metal.pockets_near(&strip.bounds()).filter(|_| may_pockets_go) {
            if shares.is_empty() {
                return shares;
            }
            shares.take_away(strip.piece(|[from, to]| pocket.piece(from, to, -self.judged.skin())));
        }
        if shares.is_empty() {
            return shares;
        }
        let mut take_away = |collar: &Collar, room: &Step| {
            for index in 0..if room.taper.slope == 0.0 { 1 } else { 2 } {
                shares.take_away(strip.piece(|[from, to]| collar.pieces_of_step(from, to, room)[index]));
            }
        };
        for collar in self.rooms(part) {
            if let FeedPart::Side { slope, .. } = part {
                collar.edge_break(slope).iter().for_each(|edge| take_away(collar, edge));
            }
            for step in &collar.steps {
                let Taper { radius, slope } = step.taper;
                let taper = match part {
                    FeedPart::Tip if slope == 0.0 => Taper::cylinder(radius.max(MAX_OFFSET) + ROUNDING),
                    FeedPart::Tip => Taper { radius: radius + MAX_OFFSET, slope },
                    FeedPart::Side { .. } if collar.has_diameter => {
                        Taper { radius: radius + SIDE_SLACK, slope }
                    }
                    FeedPart::Side { radius, .. } => Taper::cylinder(2.0 * radius),
                };
                take_away(collar, &Step { taper, max_depth: step.max_depth + TOUCH_DEPTH });
            }
        }
        // Many feeds may have been here: they come last.
        match self.judged {
            Judged::Untouched(_) => self.metal.removed.take_voids(strip, &mut shares),
            Judged::Kept(..) => self.uncover(strip, Covers::Kept, &mut shares),
            Judged::Uncut(_) | Judged::Milled(_) => self.uncover(strip, Covers::Certain, &mut shares),
        }
        shares
    }

    /// Returns true if metal that is left in the body stands on metal that is left below it, seen along a tool.
    pub(super) fn is_open_along(&self, axis: &Unit<Vector3<f64>>) -> bool {
        let has_room = match self.judged {
            Judged::Uncut(_) => true,
            Judged::Kept(part, _) | Judged::Milled(part) | Judged::Untouched(part) => {
                let is_along = |hole: &&Collar| 1.0 - NOISE <= hole.rod.axis.dot(axis);
                self.metal.are_pockets_open(axis) && self.rooms(part).iter().all(is_along)
            }
        };
        has_room && self.metal.removed.is_open_along(axis)
    }

    /// Returns the nominal holes in or above whose room the motion may be.
    fn rooms(&self, part: FeedPart) -> &[&'m Collar] {
        self.rooms.get_or_init(|| {
            let margin = match part {
                FeedPart::Tip => 0.0,
                FeedPart::Side { radius, .. } => 2.0 * radius,
            };
            let mut rooms = Vec::new();
            if let Some(holes) = self.metal.holes.as_ref() {
                let [low, high] = &self.bounds;
                holes.below(low, high, (margin, MAX_HEIGHT), &mut |hole| rooms.push(holes.collar(hole)));
            }
            rooms
        })
    }

    fn uncover(&self, strip: &Strip, covers: Covers, shares: &mut Shares) {
        if !shares.is_empty() {
            let count = if let Judged::Kept(_, sweeps) = self.judged { sweeps } else { u32::MAX };
            let sweeps = self.sweeps.get_or_init(|| self.metal.removed.first(count));
            sweeps.uncover(strip, covers, shares);
        }
    }
}
