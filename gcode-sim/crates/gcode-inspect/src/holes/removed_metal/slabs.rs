//! Parallel sweeps of one tool side by side: all that they remove between them is one convex slab.
use nalgebra::{Point3, Unit, Vector3};

use crate::holes::box_tree::{BoxTree, group};
use crate::holes::profile::Profile;
use crate::holes::shares::Shares;
use crate::holes::strip::{Line, Strip};
use crate::machine::TOUCH_DEPTH;
use gcode_part::shares_between;

/// Number of directions in which passes are followed at once.
const MAX_OPEN: usize = 4;

/// Least length of a pass, as a multiple of the tool's radius.
const MIN_LENGTH: f64 = 4.0;

/// Least part of a slab's length, and of a pass, that they have in common.
const MIN_COMMON: f64 = 0.7;

/// Largest deviation of parallel passes of one height, mm. The sweeps themselves reach farther than a slab by
/// [`TOUCH_DEPTH`].
const ROUNDING: f64 = 1e-6;

/// All points above a rectangle, up to the end of the flutes.
#[derive(Clone, Debug)]
pub(super) struct Slab {
    origin: Point3<f64>,
    /// Directions of the passes, across them, and of the tool.
    directions: [Vector3<f64>; 3],
    profile: u32,
    radius: f64,
    /// Length of the flutes.
    height: f64,
    /// Extent of all passes along them, and of their middles across them.
    along: [f64; 2],
    across: [f64; 2],
    /// Number of sweeps up to its last pass.
    end: u32,
    /// Number of the slab; `None` for a single pass.
    number: Option<usize>,
}

impl Slab {
    /// Returns the slab of one pass; `None` if it is too short or not square to the tool, or if the tool has no cylinder.
    pub(super) fn of_pass(
        [from, to]: [Point3<f64>; 2],
        axis: &Unit<Vector3<f64>>,
        (profile, number): (&Profile, u32),
        end: u32,
    ) -> Option<Self> {
        let flute = profile.parts.iter().find(|part| part.taper.slope == 0.0 && part.from < part.to)?;
        let radius = flute.radius();
        let way = to - from;
        if way.dot(axis).abs() > ROUNDING || way.norm() < MIN_LENGTH * radius {
            return None;
        }
        let along = way.normalize();
        let directions = [along, axis.cross(&along), axis.into_inner()];
        let origin = from + axis.into_inner() * flute.from;
        let extent = [0.0, way.norm()];
        Some(Self {
            origin,
            directions,
            profile: number,
            radius,
            height: flute.to - flute.from,
            along: extent,
            across: [0.0; 2],
            end,
            number: None,
        })
    }

    fn length(&self) -> f64 {
        self.along[1] - self.along[0]
    }

    /// Returns a coordinate of a point: along, across, or above.
    fn coordinate(&self, p: &Point3<f64>, direction: usize) -> f64 {
        (p - self.origin).dot(&self.directions[direction])
    }

    /// Adds a pass beside the slab; returns false if it is not beside it.
    fn extend(&mut self, pass: &Self) -> bool {
        let ends = pass.along.map(|along| pass.origin + pass.directions[0] * along);
        let [one, other] = ends.map(|p| [0, 1, 2].map(|direction| self.coordinate(&p, direction)));
        let is_level = |p: &[f64; 3]| p[2].abs() <= ROUNDING;
        let is_alike = (pass.profile, pass.radius) == (self.profile, self.radius)
            && (pass.height, pass.directions[2]) == (self.height, self.directions[2]);
        if !is_alike || !is_level(&one) || !is_level(&other) || (one[1] - other[1]).abs() > ROUNDING {
            return false;
        }
        let along = [self.along[0].max(one[0].min(other[0])), self.along[1].min(one[0].max(other[0]))];
        let middle = one[1];
        let reach = 2.0 * self.radius;
        let is_beside = self.across[0] - reach <= middle && middle <= self.across[1] + reach;
        if !is_beside || along[1] - along[0] < MIN_COMMON * self.length().max(pass.length()) {
            return false;
        }
        self.along = along;
        self.across = [self.across[0].min(middle), self.across[1].max(middle)];
        self.end = pass.end;
        true
    }

    /// Returns the shares of a line between which it is in the slab.
    fn covered(&self, [from, to]: &Line) -> Option<[f64; 2]> {
        let across = [self.across[0] - self.radius, self.across[1] + self.radius];
        let sides = [self.along, across, [-TOUCH_DEPTH / 2.0, self.height]];
        sides.iter().enumerate().try_fold([0.0, 1.0], |shares, (direction, [low, high])| {
            let start = self.coordinate(from, direction);
            let gain = self.coordinate(to, direction) - start;
            shares_between(shares, (start, gain), (*low, *high))
        })
    }

    /// Returns the corners of a box about the slab up to a height.
    fn bounds(&self, height: f64) -> [Point3<f64>; 2] {
        let corner = |along: f64, across: f64, up: f64| {
            let [a, b, c] = &self.directions;
            self.origin + a * along + b * across + c * up
        };
        let across = [self.across[0] - self.radius, self.across[1] + self.radius];
        let corners = self.along.into_iter().flat_map(|along| {
            across.into_iter().flat_map(move |across| [-TOUCH_DEPTH, height].map(|up| (along, across, up)))
        });
        let mut bounds = [Point3::from(Vector3::repeat(f64::INFINITY)); 2];
        bounds[1] = -bounds[0];
        for (along, across, up) in corners {
            let p = corner(along, across, up);
            bounds = [bounds[0].inf(&p), bounds[1].sup(&p)];
        }
        bounds
    }
}

/// Slabs of successive passes.
#[derive(Debug, Default)]
pub(super) struct Slabs {
    all: Vec<Slab>,
    boxes: BoxTree,
    /// Slabs that the next pass may extend, the last one last.
    open: Vec<Slab>,
}

impl Slabs {
    /// Adds a pass; `height` is that of the metal above it.
    pub(super) fn add(&mut self, pass: Slab, height: f64) {
        let Some(place) = self.open.iter_mut().position(|slab| slab.extend(&pass)) else {
            if self.open.len() == MAX_OPEN {
                self.open.remove(0);
            }
            self.open.push(pass);
            return;
        };
        let mut slab = self.open.remove(place);
        let number = *slab.number.get_or_insert(self.all.len());
        self.boxes.enclose(number, slab.bounds(height));
        match self.all.get_mut(number) {
            Some(known) => known.clone_from(&slab),
            None => self.all.push(slab.clone()),
        }
        self.open.push(slab);
    }

    /// Takes away the shares of a strip that are in slabs of the first `count` sweeps. `is_counted` states by a number whether
    /// the tool of this profile counts.
    pub(super) fn uncover(
        &self,
        strip: &Strip,
        count: usize,
        is_counted: impl Fn(u32) -> bool,
        shares: &mut Shares,
    ) {
        if self.all.is_empty() {
            return;
        }
        self.boxes.near(&strip.bounds(), &mut |place| {
            for slab in group(place).rev().filter_map(|index| self.all.get(index)) {
                if slab.end as usize <= count && is_counted(slab.profile) {
                    shares.take_away(strip.piece(|line| slab.covered(line)));
                }
            }
            !shares.is_empty()
        });
    }
}
