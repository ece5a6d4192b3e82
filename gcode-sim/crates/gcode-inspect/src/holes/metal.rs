//! Metal of the part: solid as far as known, without what feeds have removed, and with the room of holes and pockets.

use nalgebra::{Point3, Unit, Vector3};

use super::axis_box::Bodies;
use super::left_stock::LeftStock;
use super::open_regions::OpenRegions;
use super::removed_metal::RemovedMetal;
use super::shares::Shares;
use super::strip::{Line, Strip};
use crate::machine::{TOUCH_DEPTH, ToolPart};
use gcode_part::{Collar, EntrySearch, Frustum, Metal, NOISE, NearestPoint, Surface, Taper};

/// Least length of a piece in metal, mm; a shorter one is rounding.
const MIN_PIECE: f64 = 1e-3;

/// Largest distance of a feed from the axis of the hole that it cuts, mm, if the hole is narrower.
pub(super) const MAX_OFFSET: f64 = 0.5;

/// Rounding of a point on a hole's wall, mm.
pub(super) const ROUNDING: f64 = 1e-6;

/// Excess of a tool's side over a nominal hole that other checks judge, mm.
pub(super) const SIDE_SLACK: f64 = 0.1;

/// Distance down to another hole on the axis of the first, mm.
const MAX_HEIGHT_ABOVE_HOLE: f64 = 1000.0;

/// Half diagonal up to which the holes in a box are few, mm.
const SMALL_BOX: f64 = 20.0;

/// Metal of the part.
#[derive(Debug)]
pub(super) struct KnownMetal {
    /// Stock or the part's surface; `None` if the metal is known only round the holes.
    pub body: Option<Surface>,
    /// Nominal holes with the metal round them; `None` without a reference.
    pub holes: Option<EntrySearch>,
    /// Pockets that feeds may mill, and what joins them; those that end at a face of the body go on beyond it.
    pub pockets: Vec<Surface>,
    /// Pockets as they are stated.
    pub stated_pockets: Vec<Surface>,
    pub removed: RemovedMetal,
    /// Body without its voids.
    left: LeftStock,
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

impl KnownMetal {
    pub(super) fn new(metal: Metal) -> Self {
        let bounds = match (&metal.body, &metal.entries) {
            (Some(body), _) => body.bounds(),
            (None, Some(holes)) => holes.bounds(),
            (None, None) => [
                Point3::from(Vector3::repeat(f64::NEG_INFINITY)),
                Point3::from(Vector3::repeat(f64::INFINITY)),
            ],
        };
        let stated_pockets = metal.pockets.clone();
        let OpenRegions { pockets, voids } =
            OpenRegions::new(metal.body.as_ref(), metal.pockets, metal.voids);
        let left = metal.body.map(|body| LeftStock::new(&body, &voids)).unwrap_or_default();
        Self {
            body: metal.body,
            holes: metal.entries.map(EntrySearch::from),
            pockets,
            stated_pockets,
            removed: RemovedMetal::new(bounds, voids),
            left,
        }
    }

    /// Returns false if nothing is known.
    pub(super) fn is_known(&self) -> bool {
        self.body.is_some() || self.holes.is_some()
    }

    /// Returns the metal round the holes as convex bodies, cut or not.
    pub(super) fn bodies<'c>(&'c self, holes: &'c EntrySearch) -> Box<Bodies<'c>> {
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

    /// Returns the body without its voids, cut or not, as convex bodies.
    pub(super) fn left_stock(&self) -> Box<Bodies<'_>> {
        Box::new(|p, reach, each: &mut dyn FnMut(NearestPoint)| {
            self.left.for_each(p, reach, &self.removed, each);
            true
        })
    }

    /// Returns the largest depth of a travel in the body without its voids, cut or not, mm; `None` outside.
    pub(super) fn depth_in_stock(&self, travel: &Line) -> Option<f64> {
        let body = self.body?;
        let line = Strip::line(*travel);
        let mut shares = Shares::default();
        shares.extend(body.piece(&travel[0], &travel[1], 0.0));
        self.removed.take_voids(&line, &mut shares);
        Some(self.deepest(travel, &shares)?.depth)
    }

    /// Returns true if a point is in a void that is open to a side and to the spindle, seen along a tool.
    pub(super) fn is_in_open_void(&self, p: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> bool {
        let out = p + axis.into_inner() * self.removed.height_of_metal(p, axis);
        self.removed.is_open_beside(p, axis) && self.depth_in_stock(&[*p, out]).is_none()
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
            let length = self.removed.height_of_round(from, axis, radius);
            let taper = Taper::cylinder(radius);
            return body.touches(&Frustum { base: *from, axis: *axis, length, taper }, &(to - from));
        }
        let Some(holes) = &self.holes else { return false };
        let margin = axis.map(|along| radius * (1.0 - along * along).max(0.0).sqrt());
        let up = axis.into_inner() * self.removed.height_of_metal(from, axis);
        let (low, high) = (from.inf(to) - margin, from.sup(to) + margin);
        let mut is_touched = false;
        holes.near(&low.inf(&(low + up)), &high.sup(&(high + up)), &mut |_| is_touched = true);
        is_touched
    }

    /// Returns true if a travel leads through what was metal.
    pub(super) fn is_solid(&self, travel: &[Point3<f64>; 2]) -> bool {
        !self.solid(&Strip::line(*travel), TOUCH_DEPTH, |_| true).is_empty()
    }

    /// Returns shares of a strip outside which it is in no metal, cut or not, deeper than `skin`; those of a line are exact.
    pub(super) fn solid(&self, strip: &Strip, skin: f64, is_counted: impl Fn(usize) -> bool) -> Shares {
        let [one, other] = &strip.edges;
        let mut shares = Shares::default();
        match (&self.body, &self.holes) {
            (Some(body), _) if one == other => shares.extend(body.piece(&one[0], &one[1], skin)),
            (Some(body), _) => shares.extend(body.span([one, other], skin)),
            (None, Some(holes)) => {
                let [low, high] = strip.bounds();
                holes.near(&low, &high, &mut |hole| {
                    if is_counted(hole) {
                        shares.extend(holes.collar(hole).span([one, other], skin));
                    }
                });
            }
            (None, None) => {}
        }
        shares
    }

    /// Returns the tip that is fed through a nominal hole and deeper than any tool has to break through, with its depth
    /// below the entry. In a pocket, and in or above another hole, it may be there.
    pub(super) fn beyond_hole(
        &self,
        tip: &Point3<f64>,
        axis: &Unit<Vector3<f64>>,
    ) -> Option<(usize, PointInMetal)> {
        let holes = self.holes.as_ref()?;
        if self.is_point_in_pocket(tip) {
            return None;
        }
        let up = tip + axis.into_inner() * self.removed.height_of_metal(tip, axis);
        let down = tip - axis.into_inner() * MAX_HEIGHT_ABOVE_HOLE;
        let mut beyond: Option<(usize, PointInMetal)> = None;
        let mut is_in_other = false;
        holes.around(&up.inf(&down), &up.sup(&down), &mut |hole| {
            let collar = holes.collar(hole);
            if !collar.is_parallel(axis) || collar.hole_radius < collar.from_axis(tip) {
                return;
            }
            let (depth, deepest) = (collar.depth(tip), collar.max_depth() + TOUCH_DEPTH);
            // A hole that is listed from its far side has its room above it and below its entry.
            let is_from_far_side = axis.dot(&collar.rod.axis) < 0.0;
            is_in_other |= match is_from_far_side {
                true => collar.rod.length - deepest <= depth && (collar.is_through || depth <= deepest),
                false => depth <= deepest,
            };
            if !is_from_far_side && deepest < depth && collar.is_through {
                beyond = Some((hole, PointInMetal { point: *tip, depth }));
            }
        });
        beyond.filter(|_| !is_in_other)
    }

    /// Returns true for a point above the entry of a nominal hole, within the metal that is known round it.
    pub(super) fn is_above_entry(&self, p: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> bool {
        let Some(holes) = self.holes.as_ref() else { return false };
        let down = p - axis.into_inner() * MAX_HEIGHT_ABOVE_HOLE;
        let (mut is_above, mut is_below) = (false, false);
        holes.around(&p.inf(&down), &p.sup(&down), &mut |hole| {
            let collar = holes.collar(hole);
            let is_on_side = 0.0 < axis.dot(&collar.rod.axis);
            if is_on_side && collar.is_parallel(axis) && collar.from_axis(p) <= collar.rod.radius {
                let is_over = collar.depth(p) <= 0.0;
                is_above |= is_over;
                is_below |= !is_over;
            }
        });
        is_above && !is_below
    }

    /// Returns true for a point in the column of one of the nominal holes that count.
    pub(super) fn is_below_hole(
        &self,
        p: &Point3<f64>,
        axis: &Unit<Vector3<f64>>,
        is_counted: impl Fn(&Collar) -> bool,
    ) -> bool {
        let Some(holes) = self.holes.as_ref() else { return false };
        let up = p + axis.into_inner() * self.removed.height_of_metal(p, axis);
        let mut is_below = false;
        holes.around(&up.inf(p), &up.sup(p), &mut |hole| {
            let collar = holes.collar(hole);
            let is_in = collar.is_parallel(axis) && collar.from_axis(p) <= collar.hole_radius + TOUCH_DEPTH;
            is_below |= is_in && is_counted(collar);
        });
        is_below
    }

    /// Returns true for a part of unknown length: it reaches as high as the metal.
    pub(super) fn is_endless(&self, part: &ToolPart) -> bool {
        part.is_cutter && part.to <= part.from
    }

    /// Returns true if nothing of the body is above a pocket, seen along a tool, that is not in another pocket.
    pub(super) fn are_pockets_open(&self, axis: &Unit<Vector3<f64>>) -> bool {
        let Some(body) = &self.body else { return false };
        let up = axis.iamax();
        if axis[up].abs() < 1.0 - NOISE {
            return self.pockets.is_empty();
        }
        let side = usize::from(0.0 < axis[up]);
        let height = |corners: &[Point3<f64>; 2], side: usize| corners[side][up] * axis[up].signum();
        let [min, max] = body.bounds();
        let of_body = |pocket: &Surface| {
            let [low, high] = pocket.bounds();
            (matches!(pocket, Surface::Block { .. }), [low.sup(&min), high.inf(&max)])
        };
        let mut pockets: Vec<(bool, [Point3<f64>; 2])> = self.pockets.iter().map(of_body).collect();
        pockets.sort_by(|a, b| height(&b.1, side).total_cmp(&height(&a.1, side)));
        let face = height(&[min, max], side);
        let is_open = |index: usize| {
            let (_, pocket) = &pockets[index];
            let top = height(pocket, side) + TOUCH_DEPTH;
            let is_over = |(is_block, other): &(bool, [Point3<f64>; 2])| {
                let holds = |i: usize| i == up || other[0][i] <= pocket[0][i] && pocket[1][i] <= other[1][i];
                *is_block && height(other, 1 - side) <= top && (0..3).all(holds)
            };
            face <= top || pockets[..index].iter().any(is_over)
        };
        (0..pockets.len()).all(is_open)
    }

    /// Iterates over the pockets that may be nearer to a box than [`TOUCH_DEPTH`].
    pub(super) fn pockets_near<'m>(
        &'m self,
        [low, high]: &[Point3<f64>; 2],
    ) -> impl Iterator<Item = &'m Surface> + use<'m> {
        let margin = Vector3::repeat(2.0 * TOUCH_DEPTH);
        let (low, high) = (low - margin, high + margin);
        self.pockets.iter().filter(move |pocket| {
            let [least, greatest] = pocket.bounds();
            (0..3).all(|i| low[i] <= greatest[i] && least[i] <= high[i])
        })
    }

    /// Returns the stated pockets that a point is in, or on whose wall.
    pub(super) fn pockets_at(&self, p: &Point3<f64>) -> impl Iterator<Item = &Surface> {
        let p = *p;
        self.stated_pockets.iter().filter(move |pocket| -TOUCH_DEPTH < pocket.depth(&p))
    }

    /// Returns true if a point is in a stated pocket, or on its wall.
    pub(super) fn is_point_in_pocket(&self, p: &Point3<f64>) -> bool {
        self.pockets_at(p).next().is_some()
    }

    /// Returns true if all metal on a line is in one pocket.
    pub(super) fn is_in_pocket(&self, line: &[Point3<f64>; 2]) -> bool {
        let strip = Strip::line(*line);
        let solid = self.solid(&strip, TOUCH_DEPTH, |_| true);
        if solid.is_empty() {
            return !self.pockets.is_empty();
        }
        self.pockets_near(&strip.bounds()).any(|pocket| {
            let mut shares = solid.clone();
            shares.take_away(pocket.piece(&line[0], &line[1], -TOUCH_DEPTH));
            shares.is_empty()
        })
    }

    /// Returns the distance of a point from the nearest pocket, mm; `None` without pockets.
    pub(super) fn distance_from_pocket(&self, p: &Point3<f64>) -> Option<f64> {
        self.pockets.iter().map(|pocket| pocket.nearest(p).distance).reduce(f64::min)
    }

    /// Calls `each` with the nominal holes whose metal may be near a travel.
    pub(super) fn around<'m>(&'m self, [from, to]: &[Point3<f64>; 2], each: &mut impl FnMut(&'m Collar)) {
        let Some(holes) = self.holes.as_ref() else { return };
        holes.around(&from.inf(to), &from.sup(to), &mut |hole| each(holes.collar(hole)));
    }

    /// Returns the deepest point of some shares of a travel.
    pub(super) fn deepest(&self, [from, to]: &Line, shares: &Shares) -> Option<PointInMetal> {
        let along = to - from;
        let length = along.norm();
        let mut best: Option<PointInMetal> = None;
        for [first, last] in shares.pieces() {
            if is_rounding(length, [*first, *last]) {
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
        Some(self.holes.as_ref()?.id(self.deepest_hole_at(p)?.0))
    }

    /// Returns the hole in whose metal a point is deepest, and the depth.
    fn deepest_hole_at(&self, p: &Point3<f64>) -> Option<(usize, f64)> {
        let holes = self.holes.as_ref()?;
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

/// Returns true if a piece of a line of this length is due to rounding.
pub(super) fn is_rounding(length: f64, [first, last]: [f64; 2]) -> bool {
    length * (last - first) < MIN_PIECE && MIN_PIECE < length
}
