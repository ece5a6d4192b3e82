//! Metal that feeds have removed: volumes that the tool sweeps, and the parts of a travel that they cover.
mod slabs;
mod sweep_box;
#[cfg(test)]
mod tests;

use std::cell::RefCell;

use nalgebra::{Point3, Unit, Vector3};

use self::slabs::{Slab, Slabs};
use self::sweep_box::{StripReach, SweepBox, bounds_between};
use super::box_tree::{Bounds, BoxTree, group};
use super::left_stock::holds_box;
use super::profile::Profile;
use super::shares::Shares;
use super::strip::{Line, Strip};
use crate::machine::{TOUCH_DEPTH, ToolPart};
use gcode_part::{Surface, shares_between, shares_within};

/// Largest number of sweeps that are kept, for the memory.
const MAX_SWEEPS: usize = 1_000_000;

/// Largest height above the tip at which the metal is looked for, mm.
const MAX_HEIGHT: f64 = 1000.0;

/// Largest distance of points on one line, mm.
const ROUNDING: f64 = 1e-6;

/// Rounding of a height or of a share.
const NOISE: f64 = 1e-9;

/// Largest deviation of feeds that are one sweep from a line, mm.
const MAX_BEND: f64 = 0.003;

/// Straight motion of the tip with a tool.
#[derive(Clone, Copy, Debug)]
struct Sweep {
    from: Point3<f64>,
    to: Point3<f64>,
    /// Direction of the tool, out of the part.
    axis: Unit<Vector3<f64>>,
    profile: u32,
    /// It has cut a little of what has to stay.
    has_scratched: bool,
}

/// Volumes that the tool has swept in feeds.
#[derive(Debug)]
pub(super) struct RemovedMetal {
    sweeps: Vec<Sweep>,
    profiles: Vec<Profile>,
    /// What was empty before the first sweep.
    voids: Vec<Surface>,
    /// Boxes about groups of sweeps, and about each.
    boxes: BoxTree,
    sweep_boxes: Vec<SweepBox>,
    /// Passes side by side among all sweeps but the last.
    slabs: Slabs,
    /// The next feed may lengthen the last sweep.
    is_last_open: bool,
    /// Direction of its first feed.
    heading: Option<Unit<Vector3<f64>>>,
    /// Direction of the tool in all sweeps; `Some(None)` if they differ.
    common_axis: Option<Option<Unit<Vector3<f64>>>>,
    /// Corners of a box that holds all metal.
    bounds: [Point3<f64>; 2],
    /// True once sweeps are missing.
    pub is_full: bool,
    /// The last sweeps that have covered something: one motion after the other is in the same metal.
    recent: RefCell<Vec<usize>>,
}

impl RemovedMetal {
    /// Returns metal of which nothing but its voids is removed; `bounds` are corners of a box that holds all of it.
    pub(super) fn new(bounds: [Point3<f64>; 2], voids: Vec<Surface>) -> Self {
        Self {
            sweeps: Vec::new(),
            profiles: Vec::new(),
            voids,
            boxes: BoxTree::default(),
            sweep_boxes: Vec::new(),
            slabs: Slabs::default(),
            is_last_open: false,
            heading: None,
            common_axis: None,
            bounds,
            is_full: false,
            recent: RefCell::default(),
        }
    }

    /// Adds a straight feed; `has_scratched` if it has cut a little of what has to stay.
    pub(super) fn add(
        &mut self,
        [from, to]: Line,
        axis: Unit<Vector3<f64>>,
        profile: &Profile,
        has_scratched: bool,
    ) {
        let known = self.profiles.iter().rposition(|other| other == profile);
        let profile = known.unwrap_or_else(|| {
            self.profiles.push(profile.clone());
            self.profiles.len() - 1
        }) as u32;
        let last = self.sweeps.last_mut().filter(|_| self.is_last_open);
        let is_longer = last
            .filter(|last| (last.axis, last.profile, last.has_scratched) == (axis, profile, has_scratched))
            .is_some_and(|last| last.lengthen_along_axis(&from, &to) || last.go_on(&from, &to, self.heading));
        if !is_longer {
            if self.sweeps.len() == MAX_SWEEPS {
                self.is_full = true;
                return;
            }
            self.add_last_to_slabs();
            self.sweeps.push(Sweep { from, to, axis, profile, has_scratched });
            self.common_axis = Some(self.common_axis.unwrap_or(Some(axis)).filter(|common| *common == axis));
            self.is_last_open = true;
            self.heading = Unit::try_new(to - from, ROUNDING);
        }
        self.enclose_last();
    }

    /// Adds the last sweep, which is complete, to the slabs.
    fn add_last_to_slabs(&mut self) {
        let Some(Sweep { from, to, axis, profile, .. }) =
            self.sweeps.last().filter(|last| !last.has_scratched)
        else {
            return;
        };
        let tool = (&self.profiles[*profile as usize], *profile);
        if let Some(pass) = Slab::of_pass([*from, *to], axis, tool, self.sweeps.len() as u32) {
            let up = axis.into_inner();
            let height = [from, to].map(|p| self.height_of_round(p, &up, tool.0.radius));
            self.slabs.add(pass, height[0].max(height[1]));
        }
    }

    /// Widens the boxes about the last sweep.
    fn enclose_last(&mut self) {
        let Some(sweep) = self.sweeps.last() else { return };
        let profile = &self.profiles[sweep.profile as usize];
        let (mut low, mut high) = (sweep.from.inf(&sweep.to), sweep.from.sup(&sweep.to));
        let axis = sweep.axis.into_inner();
        let top = profile.parts.iter().map(|part| part.to).fold(0.0, f64::max);
        for p in [sweep.from, sweep.to] {
            let end = p + axis * top.min(self.height_of_round(&p, &axis, profile.radius));
            (low, high) = (low.inf(&end), high.sup(&end));
        }
        let margin = axis.map(|along| profile.radius * (1.0 - along * along).max(0.0).sqrt() + TOUCH_DEPTH);
        let number = self.sweeps.len() - 1;
        let sweep_box = SweepBox::new([&sweep.from, &sweep.to], &axis, top, &margin);
        match self.sweep_boxes.get_mut(number) {
            Some(known) => *known = sweep_box,
            None => self.sweep_boxes.push(sweep_box),
        }
        self.boxes.enclose(number, [low - margin, high + margin]);
    }

    /// Returns the height above a point beyond which there is no metal along a direction.
    pub(super) fn height_of_metal(&self, p: &Point3<f64>, out: &Vector3<f64>) -> f64 {
        self.height_of_round(p, out, 0.0)
    }

    /// Returns the height above a point beyond which there is no metal within a radius of a line through it.
    pub(super) fn height_of_round(&self, p: &Point3<f64>, out: &Vector3<f64>, radius: f64) -> f64 {
        let exit = |i: usize| {
            let margin = radius * (1.0 - out[i] * out[i]).max(0.0).sqrt();
            self.exit(p, out, i).map_or(f64::INFINITY, |exit| exit + margin / out[i].abs())
        };
        (0..3).map(exit).fold(MAX_HEIGHT, f64::min).max(0.0)
    }

    /// Returns the distance along a direction to the face of the bounds on an axis; `None` without one.
    fn exit(&self, p: &Point3<f64>, out: &Vector3<f64>, i: usize) -> Option<f64> {
        let face = self.bounds[usize::from(0.0 < out[i])][i];
        (1e-9 < out[i].abs() && face.is_finite()).then(|| (face - p[i]) / out[i])
    }

    /// Returns the shares of a line above which there may be metal along a direction, and the heights above their ends beyond
    /// which there is none.
    pub(super) fn above_line(&self, [from, to]: &Line, up: &Vector3<f64>) -> Option<([f64; 2], [f64; 2])> {
        let faces = (0..3).filter_map(|i| Some((self.exit(from, up, i)?, self.exit(to, up, i)?)));
        let all: Vec<(f64, f64)> = faces.map(|(start, end)| (start, end - start)).collect();
        let shares = all
            .iter()
            .try_fold([0.0, 1.0], |shares, exit| shares_between(shares, *exit, (0.0, f64::INFINITY)))?;
        let middle = f64::midpoint(shares[0], shares[1]);
        let at = |share: f64| move |(start, gain): &(f64, f64)| start + gain * share;
        let nearest = all.iter().min_by(|a, b| at(middle)(a).total_cmp(&at(middle)(b)));
        let height = |share: f64| nearest.map_or(f64::INFINITY, at(share)).min(MAX_HEIGHT);
        Some((shares, shares.map(height)))
    }

    /// Returns true if what is removed at a height above a tool of this direction is removed wherever it is above that.
    pub(super) fn is_open_along(&self, axis: &Unit<Vector3<f64>>) -> bool {
        let is_open = |profile: &Profile| profile.parts.first().is_some_and(|part| part.to == f64::INFINITY);
        let is_one_way = self.common_axis.is_none_or(|common| common == Some(*axis));
        self.voids.is_empty() && is_one_way && self.profiles.iter().all(is_open)
    }

    /// Takes away the shares of a strip that are in voids.
    pub(super) fn take_voids(&self, strip: &Strip, shares: &mut Shares) {
        for void in &self.voids {
            shares.take_away(strip.piece(|[from, to]| void.piece(from, to, -TOUCH_DEPTH)));
        }
    }

    /// Returns true if one void holds a box.
    pub(super) fn is_in_void(&self, bounds: &Bounds) -> bool {
        self.voids.iter().any(|void| holds_box(void, bounds))
    }

    /// Returns true if a point is in a void that is open to a side of the metal, seen along a tool.
    pub(super) fn is_open_beside(&self, p: &Point3<f64>, axis: &Unit<Vector3<f64>>) -> bool {
        let is_open = |void: &Surface| {
            let ([low, high], [least, greatest]) = (void.bounds(), self.bounds);
            (0..3).any(|i| axis[i].abs() < 1.0 - NOISE && (low[i] < least[i] || greatest[i] < high[i]))
        };
        self.voids.iter().any(|void| holds_box(void, &[*p, *p]) && is_open(void))
    }

    /// Returns the number of sweeps so far.
    pub(super) fn count(&self) -> u32 {
        self.sweeps.len() as u32
    }

    /// Keeps later feeds from lengthening the last sweep; returns the number of sweeps.
    pub(super) fn close(&mut self) -> u32 {
        self.is_last_open = false;
        self.count()
    }

    /// Returns the first sweeps, for the strips of one motion.
    pub(super) fn first(&self, count: u32) -> FirstSweeps<'_> {
        FirstSweeps { sweeps: &self.sweeps[..self.sweeps.len().min(count as usize)], removed: self }
    }
}

/// Sweeps that count, and how far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Covers {
    All,
    /// Those of tools of known diameter.
    Certain,
    /// Those of tools of known diameter that have not scratched what has to stay: the next feed there is compared with the whole of it.
    Kept,
}

impl RemovedMetal {
    /// Returns true if a feed is as one that the same tool has made before, no more than [`TOUCH_DEPTH`] beside it.
    pub(super) fn has_repeated(
        &self,
        travel: &Line,
        axis: &Unit<Vector3<f64>>,
        profile: &Profile,
        covers: Covers,
    ) -> bool {
        let is_near = |p: &Point3<f64>, sweep: &Sweep| {
            let along = sweep.to - sweep.from;
            let share = (p - sweep.from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
            (p - sweep.from - along * share.clamp(0.0, 1.0)).norm() <= TOUCH_DEPTH
        };
        let has_made = |sweep: &Sweep| {
            sweep.axis == *axis
                && !(covers == Covers::Kept && sweep.has_scratched)
                && travel.iter().all(|p| is_near(p, sweep))
                && self.profiles[sweep.profile as usize] == *profile
        };
        let mut is_found = false;
        self.boxes.near(&Strip::line(*travel).bounds(), &mut |place| {
            is_found = group(place).filter_map(|index| self.sweeps.get(index)).any(has_made);
            !is_found
        });
        is_found
    }
}

/// Number of the sweeps that are tried before all others.
const MAX_RECENT: usize = 8;

/// The first sweeps, and the voids.
#[derive(Debug)]
pub(super) struct FirstSweeps<'r> {
    sweeps: &'r [Sweep],
    removed: &'r RemovedMetal,
}

impl FirstSweeps<'_> {
    /// Takes away the shares between which the sweeps cover a strip, [`TOUCH_DEPTH`] beyond them included.
    pub(super) fn uncover(&self, strip: &Strip, covers: Covers, shares: &mut Shares) {
        self.removed.take_voids(strip, shares);
        let profiles = &self.removed.profiles;
        let is_counted = |profile: u32| profiles[profile as usize].is_certain || covers == Covers::All;
        self.removed.slabs.uncover(strip, self.sweeps.len(), is_counted, shares);
        let mut recent = self.removed.recent.borrow_mut();
        let sweep_at = |index: usize| {
            let leaves_out = |sweep: &Sweep| covers == Covers::Kept && sweep.has_scratched;
            self.sweeps.get(index).filter(|sweep| is_counted(sweep.profile) && !leaves_out(sweep))
        };
        let cover = |sweep: &Sweep, shares: &mut Shares| {
            let mut has_covered = false;
            for part in &profiles[sweep.profile as usize].parts {
                has_covered |= shares.take_away(strip.piece(|line| sweep.covered(part, line)));
            }
            has_covered
        };
        for place in (0..recent.len()).rev() {
            if shares.is_empty() {
                return;
            }
            if let Some(sweep) = sweep_at(recent[place]) {
                cover(sweep, shares);
            }
        }
        let Some(extent) = shares.extent() else { return };
        let reach = StripReach::of(strip);
        let is_near = |index: usize, shares: &Shares| {
            let sweep_box = self.removed.sweep_boxes.get(index);
            sweep_box.and_then(|near| reach.shares_in(near)).is_some_and(|range| shares.meets(range))
        };
        self.removed.boxes.near(&bounds_between(strip, extent), &mut |place| {
            for index in group(place).rev() {
                if shares.is_empty() {
                    return false;
                }
                let Some(sweep) = sweep_at(index) else { continue };
                if is_near(index, shares) && cover(sweep, shares) {
                    recent.retain(|other| *other != index);
                    if recent.len() == MAX_RECENT {
                        recent.remove(0);
                    }
                    recent.push(index);
                }
            }
            !shares.is_empty()
        });
    }
}

impl Sweep {
    /// Lengthens the sweep by a feed of the same tool along its axis; a feed out of the part adds nothing. Returns false
    /// for other feeds.
    fn lengthen_along_axis(&mut self, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let axis = self.axis;
        let is_along = |v: Vector3<f64>| (v - axis.into_inner() * v.dot(&axis)).norm() < ROUNDING;
        let is_on_line = [self.to, *from, *to].into_iter().all(|p| is_along(p - self.from));
        let height = |p: &Point3<f64>| (p - self.from).dot(&axis);
        let (reached, begin, end) = (height(&self.to), height(from), height(to));
        if !is_on_line || reached > 0.0 || begin > ROUNDING || begin < reached - ROUNDING || end > ROUNDING {
            return false;
        }
        if end < reached {
            self.to = *to;
        }
        true
    }

    /// Lengthens the sweep by a feed of the same tool that goes on from its end in the direction in which it began,
    /// `heading`. Returns false for other feeds.
    fn go_on(&mut self, from: &Point3<f64>, to: &Point3<f64>, heading: Option<Unit<Vector3<f64>>>) -> bool {
        let Some(heading) = heading else { return false };
        let way = to - self.from;
        let length = way.dot(&heading);
        let is_straight = (from - self.to).norm() < ROUNDING
            && (self.to - self.from).dot(&heading) <= length
            && (way - heading.into_inner() * length).norm() <= MAX_BEND;
        if is_straight {
            self.to = *to;
        }
        is_straight
    }

    /// Returns the shares of a travel between which it is in the volume that a part of the tool sweeps.
    ///
    /// At the share s of the travel and t of the sweep the travel's point is at the height h = h₀ + s·h₁ − t·h₂ above the tip
    /// and in the part if |q + s·u − t·d| ≤ r + k·h across the axis, and h lies between the ends of the part. For a given s
    /// the t that fulfil this are an interval; if it is not empty, it holds 0 or 1, the t at which an end of the part passes
    /// the point, or the t at which |q + s·u − t·d|² − (r + k·h)² is least. So the shares are those that fulfil it on one of
    /// five lines t = a + b·s. A sweep steeper than the side of a cone has no such least value.
    fn covered(&self, part: &ToolPart, travel: &[Point3<f64>; 2]) -> Option<[f64; 2]> {
        let taper = part.taper.grown(TOUCH_DEPTH);
        let axis = self.axis.into_inner();
        let split = |v: Vector3<f64>| {
            let height = v.dot(&axis);
            (v - axis * height, height)
        };
        let ((q, from), (u, rise), (d, climb)) =
            (split(travel[0] - self.from), split(travel[1] - travel[0]), split(self.to - self.from));
        let low = part.from - TOUCH_DEPTH;
        // A cone is nowhere wider than its upper end.
        let high = match 0.0 < taper.slope {
            true => (part.radius() + TOUCH_DEPTH - taper.radius) / taper.slope,
            false => part.to + TOUCH_DEPTH,
        };
        let reach = taper.at(low).max(taper.at(high)) + d.norm() + u.norm();
        if reach * reach < q.norm_squared() {
            return None;
        }
        let on_line = |a: f64, b: f64| {
            let shares = shares_between([0.0, 1.0], (a, b), (-NOISE, 1.0 + NOISE))?;
            let heights = (from - climb * a, rise - climb * b);
            let shares = shares_between(shares, heights, (low - NOISE, high + NOISE))?;
            let radius = (taper.at(heights.0), taper.slope * heights.1);
            shares_within(shares, q - d * a, u - d * b, radius)
        };
        let mut all: Option<[f64; 2]> = None;
        let mut add = |shares: Option<[f64; 2]>| {
            let Some([first, last]) = shares else { return };
            all = Some(all.map_or([first, last], |[a, b]| [a.min(first), b.max(last)]));
        };
        add(on_line(0.0, 0.0));
        add(on_line(1.0, 0.0));
        let narrowing = taper.slope * climb;
        let curvature = d.norm_squared() - narrowing * narrowing;
        if 1e-18 < curvature {
            let least = |q: f64, radius: f64| (q - narrowing * radius) / curvature;
            add(on_line(least(q.dot(&d), taper.at(from)), least(u.dot(&d), taper.slope * rise)));
        }
        if 1e-9 < climb.abs() {
            for end in [low, high].into_iter().filter(|end| end.is_finite()) {
                add(on_line((from - end) / climb, rise / climb));
            }
        }
        all
    }
}
