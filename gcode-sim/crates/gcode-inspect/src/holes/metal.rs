//! Metal of the part: solid as far as known, without what feeds have removed, and with the room of holes and pockets.
use std::sync::Arc;

use nalgebra::{Point3, Unit, Vector3};

use super::axis_box::Bodies;
use super::removed_metal::RemovedMetal;
use super::shares::Shares;
use crate::machine::{TOUCH_DEPTH, ToolPart};
use gcode_part::{Collar, EntryPlanes, Frustum, Metal, NearestPoint, PARALLEL_COSINE, Step, Surface, Taper};

/// Largest distance of a feed from the axis of the hole that it cuts, mm, if the hole is narrower.
pub(super) const MAX_OFFSET: f64 = 0.5;

/// Rounding of a point on a hole's wall, mm.
const ROUNDING: f64 = 1e-6;

/// Excess of a tool's side over a nominal hole that other checks judge, mm.
pub(super) const SIDE_SLACK: f64 = 0.1;

/// Height above a hole up to which the metal goes with it, mm.
pub(super) const MAX_HEIGHT: f64 = 50.0;

/// Distance down to another hole on the axis of the first, mm.
const MAX_HEIGHT_ABOVE_HOLE: f64 = 1000.0;

/// Half diagonal up to which the holes in a box are few, mm.
const SMALL_BOX: f64 = 20.0;

/// Least length of a piece in metal, mm; a shorter one is rounding.
const MIN_PIECE: f64 = 1e-3;

/// Metal of the part.
#[derive(Debug)]
pub(super) struct KnownMetal {
    /// Stock or the part's surface; `None` if the metal is known only round the holes.
    body: Option<Surface>,
    /// Nominal holes with the metal round them; `None` without a reference.
    pub holes: Option<Arc<EntryPlanes>>,
    /// Pockets that feeds may mill.
    pub pockets: Vec<Surface>,
    pub removed: RemovedMetal,
}

/// A point in metal.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointInMetal {
    pub point: Point3<f64>,
    /// Depth below the surface, or else below the nominal entry of the hole, mm.
    pub depth: f64,
}

impl PointInMetal {
    /// Returns the deeper of two points.
    pub(super) fn deeper(self, other: Self) -> Self {
        if self.depth < other.depth { other } else { self }
    }
}

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

impl KnownMetal {
    pub(super) fn new(metal: Metal) -> Self {
        let bounds = match (&metal.body, &metal.entries) {
            (Some(body), _) => body.bounds(),
            (None, _) => [
                Point3::from(Vector3::repeat(f64::NEG_INFINITY)),
                Point3::from(Vector3::repeat(f64::INFINITY)),
            ],
        };
        let height = metal.entries.as_ref().filter(|_| metal.body.is_none()).map(|holes| 2.0 * holes.reach());
        Self {
            body: metal.body,
            holes: metal.entries,
            pockets: metal.pockets,
            removed: RemovedMetal::new(bounds, height.unwrap_or(f64::INFINITY)),
        }
    }

    /// Returns false if nothing is known.
    pub(super) fn is_known(&self) -> bool {
        self.body.is_some() || self.holes.is_some()
    }

    /// Returns the metal round the holes as convex bodies, cut or not.
    pub(super) fn bodies<'c>(&'c self, holes: &'c EntryPlanes) -> Box<Bodies<'c>> {
        Box::new(move |p, reach, each: &mut dyn FnMut(NearestPoint)| {
            let (low, high) = (p - reach, p + reach);
            if holes.is_above_all(&low, &high) || holes.nearest_metal(p) > reach.norm() {
                return true;
            }
            let is_small = reach.norm() <= SMALL_BOX;
            if is_small {
                holes.near(&low, &high, &mut |hole| each(holes.collar(hole).rod.nearest(p)));
            }
            is_small
        })
    }

    /// Returns true if a cylinder about the tool's axis may touch metal while its lower end moves between two points.
    pub(super) fn is_touched(
        &self,
        from: &Point3<f64>,
        to: &Point3<f64>,
        axis: &Unit<Vector3<f64>>,
        radius: f64,
    ) -> bool {
        if let Some(body) = &self.body {
            let (length, taper) = (self.removed.height_of_metal(from, axis), Taper::cylinder(radius));
            return body.touches(&Frustum { base: *from, axis: *axis, length, taper }, &(to - from));
        }
        let Some(holes) = &self.holes else { return false };
        let margin = Vector3::repeat(radius);
        let up = axis.into_inner() * self.removed.height_of_metal(from, axis);
        let (low, high) = (from.inf(to) - margin, from.sup(to) + margin);
        let mut is_touched = false;
        holes.near(&low.inf(&(low + up)), &high.sup(&(high + up)), &mut |_| is_touched = true);
        is_touched
    }

    /// Returns true if a travel leads through what was metal.
    pub(super) fn is_solid(&self, travel: &[Point3<f64>; 2]) -> bool {
        !self.solid(travel, |_| true).is_empty()
    }

    /// Returns the parts of a travel in solid metal, cut or not.
    fn solid(&self, [from, to]: &[Point3<f64>; 2], is_counted: impl Fn(usize) -> bool) -> Shares {
        let mut shares = Shares::default();
        match (&self.body, &self.holes) {
            (Some(body), _) => {
                if let Some(piece) = body.piece(from, to, TOUCH_DEPTH) {
                    shares.push(piece);
                }
            }
            (None, Some(holes)) => holes.near(&from.inf(to), &from.sup(to), &mut |hole| {
                if let Some(piece) =
                    holes.collar(hole).piece(from, to, TOUCH_DEPTH).filter(|_| is_counted(hole))
                {
                    shares.push(piece);
                }
            }),
            (None, None) => {}
        }
        shares
    }

    /// Returns the deepest point of a travel in metal that is not removed.
    pub(super) fn uncut(&self, travel: &[Point3<f64>; 2]) -> Option<PointInMetal> {
        self.uncut_above(travel, None)
    }

    /// Returns the deepest point of a travel in metal that is not removed, above the plane of a hole's entry if there is one.
    pub(super) fn uncut_above(
        &self,
        travel: &[Point3<f64>; 2],
        hole: Option<&Collar>,
    ) -> Option<PointInMetal> {
        let mut shares = self.solid(travel, |_| true);
        if let Some(below) = hole.and_then(|hole| hole.piece_below_entry(&travel[0], &travel[1])) {
            shares.take_away(below);
        }
        if !shares.is_empty() {
            self.removed.uncover(travel, false, &mut shares);
        }
        self.deepest(travel, &shares)
    }

    /// Returns true if a travel leads through metal that is known, false if all that is known there is removed, and `None`
    /// if nothing is known.
    pub(super) fn cuts(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<bool> {
        let travel = [*from, *to];
        let is_in_known = self.body.is_some() || !self.solid(&travel, |_| true).is_empty();
        is_in_known.then(|| self.uncut(&travel).is_some())
    }

    /// Returns the deepest point of a travel in metal that has to stay: neither in a nominal hole nor in a pocket, nor removed
    /// before.
    pub(super) fn gouge(&self, travel: &[Point3<f64>; 2], part: FeedPart) -> Option<PointInMetal> {
        let holes = self.holes.as_deref()?;
        // Without a diameter the wall of a hole is unknown.
        let mut shares = self.solid(travel, |hole| holes.collar(hole).has_diameter);
        let [from, to] = travel;
        for pocket in &self.pockets {
            if shares.is_empty() {
                return None;
            }
            if let Some(piece) = pocket.piece(from, to, -TOUCH_DEPTH) {
                shares.take_away(piece);
            }
        }
        if shares.is_empty() {
            return None;
        }
        let mut take_away = |collar: &Collar, room: &Step| {
            let pieces = collar.pieces_of_step(from, to, room).into_iter().flatten();
            pieces.for_each(|piece| shares.take_away(piece));
        };
        let mut allow = |collar: &Collar| {
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
                let room = Step { taper, max_depth: step.max_depth + TOUCH_DEPTH };
                take_away(collar, &room);
            }
        };
        let margin = match part {
            FeedPart::Tip => 0.0,
            FeedPart::Side { radius, .. } => 2.0 * radius,
        };
        let near = (margin, MAX_HEIGHT);
        holes.below(&from.inf(to), &from.sup(to), near, &mut |hole| allow(holes.collar(hole)));
        // Many feeds may have been here: they come last.
        if shares.is_empty() {
            return None;
        }
        self.removed.uncover(travel, true, &mut shares);
        self.deepest(travel, &shares)
    }

    /// Returns the tip that is fed through a nominal hole and deeper than any tool has to break through, with its depth
    /// below the entry. In a pocket, and in or above another hole, it may be there.
    pub(super) fn beyond_hole(
        &self,
        tip: &Point3<f64>,
        axis: &Unit<Vector3<f64>>,
    ) -> Option<(usize, PointInMetal)> {
        let holes = self.holes.as_deref()?;
        if self.pockets.iter().any(|pocket| -TOUCH_DEPTH < pocket.depth(tip)) {
            return None;
        }
        let up = tip + axis.into_inner() * self.removed.height_of_metal(tip, axis);
        let down = tip - axis.into_inner() * MAX_HEIGHT_ABOVE_HOLE;
        let mut beyond: Option<(usize, PointInMetal)> = None;
        let mut is_in_other = false;
        holes.around(&up.inf(&down), &up.sup(&down), &mut |hole| {
            let collar = holes.collar(hole);
            let depth = collar.depth(tip);
            let is_same_way = PARALLEL_COSINE <= axis.dot(&collar.rod.axis);
            if is_same_way && collar.from_axis(tip) <= collar.hole_radius {
                match collar.max_depth() + TOUCH_DEPTH < depth {
                    true if collar.is_through => beyond = Some((hole, PointInMetal { point: *tip, depth })),
                    true => {}
                    false => is_in_other = true,
                }
            }
        });
        beyond.filter(|_| !is_in_other)
    }

    /// Returns the upper end of a part of the tool; where its length is unknown, that of the metal.
    pub(super) fn top_of(&self, part: &ToolPart, tip: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> f64 {
        match part.is_cutter && part.to <= part.from {
            true => part.from + self.removed.height_of_metal(tip, axis),
            false => part.to,
        }
    }

    /// Returns heights above the tip, within some, at which a cylinder crosses metal whose lower end is above its own: one for
    /// the body, or enough for each hole near a travel.
    pub(super) fn heights(
        &self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        radius: f64,
        within: [f64; 2],
    ) -> Vec<f64> {
        let mut common: Vec<[f64; 2]> = Vec::new();
        self.for_each_range(travel, axis, radius, within, &mut |[low, high]| {
            if low <= within[0] {
                return;
            }
            match common.iter_mut().find(|range| low < range[1] && range[0] < high) {
                Some(range) => *range = [range[0].max(low), range[1].min(high)],
                None => common.push([low, high]),
            }
        });
        common.iter().map(|[low, high]| f64::midpoint(*low, *high)).collect()
    }

    /// Returns the heights above the tip, within some, at which metal or a pocket near a travel begins or ends, upwards.
    pub(super) fn levels(
        &self,
        travel: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        radius: f64,
        within: [f64; 2],
    ) -> Vec<f64> {
        let mut levels = Vec::new();
        self.for_each_range(travel, axis, radius, within, &mut |range| levels.extend(range));
        let Some((low, high)) =
            levels.iter().copied().reduce(f64::min).zip(levels.iter().copied().reduce(f64::max))
        else {
            return levels;
        };
        let of_pockets = self.pockets.iter().flat_map(|pocket| heights_of(pocket, &travel[0], axis));
        levels.extend(of_pockets.filter(|height| low < *height && *height < high));
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|a, b| (*a - *b).abs() < MIN_PIECE);
        levels
    }

    /// Calls `each` with the heights above the tip, within some, between which there may be metal: of the body, or of each hole
    /// near a travel.
    fn for_each_range(
        &self,
        [from, to]: &[Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        radius: f64,
        within: [f64; 2],
        each: &mut impl FnMut([f64; 2]),
    ) {
        let mut clip = |[low, high]: [f64; 2]| {
            let range = [low.max(within[0]), high.min(within[1])];
            if range[0] < range[1] {
                each(range);
            }
        };
        if let Some(body) = &self.body {
            clip(heights_of(body, from, axis));
            return;
        }
        let Some(holes) = &self.holes else { return };
        let margin = Vector3::repeat(radius);
        let up = axis.into_inner() * within[1].min(self.removed.height_of_metal(from, axis));
        let (low, high) = (from.inf(to) - margin, from.sup(to) + margin);
        holes.near(&low.inf(&(low + up)), &high.sup(&(high + up)), &mut |hole| {
            let rod = holes.collar(hole).rod;
            let ends =
                [rod.base, rod.base + rod.axis.into_inner() * rod.length].map(|p| (p - from).dot(axis));
            clip([ends[0].min(ends[1]), ends[0].max(ends[1])]);
        });
    }

    /// Returns true if all metal on a line is in one pocket.
    pub(super) fn is_in_pocket(&self, line: &[Point3<f64>; 2]) -> bool {
        self.pockets.iter().any(|pocket| {
            let mut shares = self.solid(line, |_| true);
            if let Some(piece) = pocket.piece(&line[0], &line[1], -TOUCH_DEPTH) {
                shares.take_away(piece);
            }
            shares.is_empty()
        })
    }

    /// Returns the distance of a point from the nearest pocket, mm; `None` without pockets.
    pub(super) fn distance_from_pocket(&self, p: &Point3<f64>) -> Option<f64> {
        self.pockets.iter().map(|pocket| pocket.nearest(p).distance).reduce(f64::min)
    }

    /// Calls `each` with the nominal holes whose metal may be near a travel.
    pub(super) fn around<'m>(&'m self, [from, to]: &[Point3<f64>; 2], each: &mut impl FnMut(&'m Collar)) {
        let Some(holes) = self.holes.as_deref() else { return };
        holes.around(&from.inf(to), &from.sup(to), &mut |hole| each(holes.collar(hole)));
    }

    /// Returns the deepest point of some shares of a travel.
    fn deepest(&self, [from, to]: &[Point3<f64>; 2], shares: &Shares) -> Option<PointInMetal> {
        let along = to - from;
        let length = along.norm();
        let mut best: Option<PointInMetal> = None;
        for [first, last] in shares.pieces() {
            if length * (last - first) < MIN_PIECE && MIN_PIECE < length {
                continue;
            }
            let (first, last) = (from + along * *first, from + along * *last);
            let innermost = self.body.map(|body| body.deepest_between(&first, &last));
            for point in [first, last, nalgebra::center(&first, &last)].into_iter().chain(innermost) {
                let depth = self.depth(&point).unwrap_or(0.0);
                if best.is_none_or(|best| best.depth < depth) {
                    best = Some(PointInMetal { point, depth });
                }
            }
        }
        best
    }

    /// Returns the depth of a point below the surface or, without one, below the entry of the hole it is at, mm; `None` if
    /// neither is known there.
    pub(super) fn depth(&self, p: &Point3<f64>) -> Option<f64> {
        match &self.body {
            Some(body) => Some(body.depth(p)),
            None => Some(self.deepest_hole_at(p)?.1),
        }
    }

    /// Returns the level from which [`Self::depth`] counts: `the surface`, or `the nominal entry of hole 1`.
    pub(super) fn level_at(&self, p: &Point3<f64>) -> String {
        match (&self.body, &self.holes, self.deepest_hole_at(p)) {
            (None, Some(holes), Some((hole, _))) => format!("the nominal entry of hole {}", holes.id(hole)),
            _ => "the surface".to_owned(),
        }
    }

    /// Returns the id of the hole at a point.
    pub(super) fn hole_at(&self, p: &Point3<f64>) -> Option<&str> {
        Some(self.holes.as_deref()?.id(self.deepest_hole_at(p)?.0))
    }

    /// Returns the hole in whose metal a point is deepest, and the depth.
    fn deepest_hole_at(&self, p: &Point3<f64>) -> Option<(usize, f64)> {
        let holes = self.holes.as_deref()?;
        let mut best: Option<(usize, f64)> = None;
        let margin = Vector3::repeat(ROUNDING);
        holes.near(&(p - margin), &(p + margin), &mut |hole| {
            let collar = holes.collar(hole);
            let depth = collar.depth(p);
            let is_inside = TOUCH_DEPTH - ROUNDING < depth
                && depth <= collar.rod.length + collar.floor() + ROUNDING
                && collar.from_axis(p) <= collar.rod.radius + ROUNDING;
            if is_inside && best.is_none_or(|(_, most)| most < depth) {
                best = Some((hole, depth));
            }
        });
        best
    }
}

/// Returns the heights above the tip between which a body may have metal.
fn heights_of(body: &Surface, tip: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> [f64; 2] {
    let [low, high] = body.bounds();
    let along = |corner: &Vector3<f64>, other: &Vector3<f64>| {
        (0..3).filter(|i| axis[*i] != 0.0).map(|i| (axis[i] * corner[i]).min(axis[i] * other[i])).sum::<f64>()
    };
    let (low, high) = (low - tip, high - tip);
    [along(&low, &high), -along(&-low, &-high)]
}
