//! Metal that feeds have removed: volumes that the tool sweeps, and the parts of a travel that they cover.
use std::cell::RefCell;

use nalgebra::{Point3, Unit, Vector3};

use super::box_tree::{BoxTree, group};
use super::profile::Profile;
use super::shares::Shares;
use super::strip::{Line, Strip};
use crate::machine::{TOUCH_DEPTH, ToolPart};
use gcode_part::{shares_between, shares_within};

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
}

/// Volumes that the tool has swept in feeds.
#[derive(Debug)]
pub(super) struct RemovedMetal {
    sweeps: Vec<Sweep>,
    profiles: Vec<Profile>,
    /// Boxes about the sweeps.
    boxes: BoxTree,
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
    /// Returns no removed metal; `bounds` are corners of a box that holds all metal.
    pub(super) fn new(bounds: [Point3<f64>; 2]) -> Self {
        Self {
            sweeps: Vec::new(),
            profiles: Vec::new(),
            boxes: BoxTree::default(),
            is_last_open: false,
            heading: None,
            common_axis: None,
            bounds,
            is_full: false,
            recent: RefCell::default(),
        }
    }

    /// Adds a straight feed.
    pub(super) fn add(
        &mut self,
        from: Point3<f64>,
        to: Point3<f64>,
        axis: Unit<Vector3<f64>>,
        profile: &Profile,
    ) {
        let known = self.profiles.iter().rposition(|other| other == profile);
        let profile = known.unwrap_or_else(|| {
            self.profiles.push(profile.clone());
            self.profiles.len() - 1
        }) as u32;
        let last = self.sweeps.last_mut().filter(|_| self.is_last_open);
        let is_longer = last
            .filter(|last| last.axis == axis && last.profile == profile)
            .is_some_and(|last| last.lengthen_along_axis(&from, &to) || last.go_on(&from, &to, self.heading));
        if !is_longer {
            if self.sweeps.len() == MAX_SWEEPS {
                self.is_full = true;
                return;
            }
            self.sweeps.push(Sweep { from, to, axis, profile });
            self.common_axis = Some(self.common_axis.unwrap_or(Some(axis)).filter(|common| *common == axis));
            self.is_last_open = true;
            self.heading = Unit::try_new(to - from, ROUNDING);
        }
        self.enclose_last();
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
        let margin = Vector3::repeat(profile.radius + TOUCH_DEPTH);
        self.boxes.enclose(self.sweeps.len() - 1, [low - margin, high + margin]);
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
        self.common_axis.is_none_or(|common| common == Some(*axis)) && self.profiles.iter().all(is_open)
    }

    /// Keeps later feeds from lengthening the last sweep; returns the number of sweeps.
    pub(super) fn close(&mut self) -> u32 {
        self.is_last_open = false;
        self.sweeps.len() as u32
    }

    /// Returns the first sweeps, for the strips of one motion.
    pub(super) fn first(&self, count: u32) -> FirstSweeps<'_> {
        FirstSweeps { sweeps: &self.sweeps[..self.sweeps.len().min(count as usize)], removed: self }
    }
}

/// Number of the sweeps that are tried before all others.
const MAX_RECENT: usize = 8;

/// The first sweeps.
#[derive(Debug)]
pub(super) struct FirstSweeps<'r> {
    sweeps: &'r [Sweep],
    removed: &'r RemovedMetal,
}

impl FirstSweeps<'_> {
    /// Takes away the shares between which the sweeps cover a strip, [`TOUCH_DEPTH`] beyond them included. `is_certain` leaves
    /// out tools of unknown diameter.
    pub(super) fn uncover(&self, strip: &Strip, is_certain: bool, shares: &mut Shares) {
        let mut recent = self.removed.recent.borrow_mut();
        let cover = |index: usize, shares: &mut Shares| {
            let Some(sweep) = self.sweeps.get(index) else { return false };
            let profile = &self.removed.profiles[sweep.profile as usize];
            let mut has_covered = false;
            for part in profile.parts.iter().filter(|_| profile.is_certain || !is_certain) {
                has_covered |= shares.take_away(strip.piece(|line| sweep.covered(part, line)));
            }
            has_covered
        };
        for place in (0..recent.len()).rev() {
            if shares.is_empty() {
                return;
            }
            cover(recent[place], shares);
        }
        if shares.is_empty() {
            return;
        }
        self.removed.boxes.near(&strip.bounds(), &mut |place| {
            for index in group(place).rev() {
                if shares.is_empty() {
                    return false;
                }
                if cover(index, shares) {
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use gcode_part::Taper;

    fn p(x: f64, y: f64, z: f64) -> Point3<f64> {
        Point3::new(x, y, z)
    }

    fn rest_of(removed: &RemovedMetal, from: Point3<f64>, to: Point3<f64>) -> Vec<[f64; 2]> {
        let mut shares = Shares::default();
        shares.extend([[0.0, 1.0]]);
        removed.first(u32::MAX).uncover(&Strip::line([from, to]), true, &mut shares);
        let mut pieces: Vec<_> =
            shares.pieces().iter().map(|piece| piece.map(|share| (share * 1e6).round() / 1e6)).collect();
        pieces.sort_by(|a, b| a[0].total_cmp(&b[0]));
        pieces
    }

    /// A mill of 10 feeds from x 0 to x 40 at z −5. A travel of 100 along x at y 0 is covered from −5.01 to 45.01; at y 3
    /// from −SQRT[5.01² − 9] = −4.0125; at z −5.02 it is below.
    #[test]
    fn a_slot_covers_its_width_and_all_above_it() {
        let mut removed = RemovedMetal::new([p(-100.0, -100.0, -20.0), p(100.0, 100.0, 0.0)]);
        removed.add(p(0.0, 0.0, -5.0), p(40.0, 0.0, -5.0), Vector3::z_axis(), &Profile::flat(5.0, true));
        for is_closed in [false, true] {
            if is_closed {
                removed.close();
            }
            let along = |y, z| rest_of(&removed, p(-50.0, y, z), p(50.0, y, z));
            assert_eq!(along(0.0, -5.0), [[0.0, 0.4499], [0.9501, 1.0]]);
            assert_eq!(along(0.0, -0.1), [[0.0, 0.4499], [0.9501, 1.0]]);
            assert_eq!(along(3.0, -5.0), [[0.0, 0.459875], [0.940125, 1.0]]);
            assert_eq!(along(0.0, -5.02), [[0.0, 1.0]]);
            assert_eq!(rest_of(&removed, p(40.0, 4.0, 0.0), p(40.0, 4.0, -10.0)), [[0.501, 1.0]]);
        }
    }

    /// Pecks along one line are one sweep, and a feed back adds none.
    #[test]
    fn pecks_are_one_sweep() {
        let mut removed = RemovedMetal::new([p(-9.0, -9.0, -50.0), p(9.0, 9.0, 0.0)]);
        for depth in 1..=1000 {
            let bottom = f64::from(depth) / -50.0;
            let profile = Profile::flat(3.0, true);
            removed.add(p(1.0, 0.0, bottom + 0.1), p(1.0, 0.0, bottom), Vector3::z_axis(), &profile);
            removed.add(p(1.0, 0.0, bottom), p(1.0, 0.0, 0.0), Vector3::z_axis(), &profile);
        }
        assert_eq!(removed.sweeps.len(), 1);
        assert_eq!(rest_of(&removed, p(3.0, 0.0, 0.0), p(3.0, 0.0, -40.0)), [[0.50025, 1.0]]);
    }

    /// A thousand steps of 0.05 along a line are one sweep; on a circle of 10 no sweep leaves it by more than 0.01.
    #[test]
    fn small_steps_along_a_line_are_one_sweep() {
        let profile = Profile::flat(3.0, true);
        let bounds = [p(-99.0, -99.0, -50.0), p(99.0, 99.0, 0.0)];
        let (mut line, mut circle) = (RemovedMetal::new(bounds), RemovedMetal::new(bounds));
        for step in 0..1000 {
            let at = |step: i32| p(f64::from(step) * 0.05, 0.0, -5.0);
            line.add(at(step), at(step + 1), Vector3::z_axis(), &profile);
            let on = |step: i32| {
                let angle = gcode_lang::units::Deg(f64::from(step) * 0.36);
                p(10.0 * angle.cos(), 10.0 * angle.sin(), -5.0)
            };
            circle.add(on(step), on(step + 1), Vector3::z_axis(), &profile);
        }
        assert_eq!(line.sweeps.len(), 1);
        assert_eq!(rest_of(&line, p(-10.0, 0.0, -1.0), p(90.0, 0.0, -1.0)), [[0.0, 0.0699], [0.6301, 1.0]]);
        let inner = |sweep: &Sweep| nalgebra::center(&sweep.from, &sweep.to).coords.xy().norm();
        let least = circle.sweeps.iter().map(inner).fold(f64::INFINITY, f64::min);
        assert!(
            (9.99..10.0).contains(&least) && circle.sweeps.len() < 500,
            "{least} {}",
            circle.sweeps.len()
        );
    }

    proptest! {
        /// A point is covered if and only if some position of the tool holds it.
        #[test]
        fn the_rest_is_what_no_position_of_the_tool_holds(
            ends in prop::array::uniform6(-10.0..10.0f64),
            travel in prop::array::uniform6(-15.0..15.0f64),
            direction in prop::array::uniform3(-1.0..1.0f64),
            (radius, low, length) in (0.5..5.0f64, 0.0..3.0f64, 0.5..8.0f64),
            slope in prop::sample::select(vec![0.0, 0.0, 0.6, 1.0, 2.7]),
        ) {
            let axis = Unit::try_new(Vector3::from(direction), 0.1);
            prop_assume!(axis.is_some());
            let axis = axis.unwrap();
            let (from, to) = (p(ends[0], ends[1], ends[2]), p(ends[3], ends[4], ends[5]));
            // A cone has its tip at the lower end and a cylinder on it.
            let cylinder = ToolPart::flutes(low + length, low + 2.0 * length, slope * length);
            let cone = ToolPart {
                taper: Taper { radius: -slope * low, slope },
                ..ToolPart::flutes(low, low + length, 0.0)
            };
            let parts = if slope == 0.0 { vec![ToolPart::flutes(low, low + length, radius)] } else { vec![cone, cylinder] };
            let sweep = Sweep { from, to, axis, profile: 0 };
            let (a, b) = (p(travel[0], travel[1], travel[2]), p(travel[3], travel[4], travel[5]));
            let covered: Vec<_> = parts.iter().filter_map(|part| sweep.covered(part, &[a, b])).collect();
            for s in 0..=50 {
                let s = f64::from(s) / 50.0;
                let q = a + (b - a) * s;
                let excess = |t: f64| {
                    let to_q = q - (from + (to - from) * t);
                    let height = to_q.dot(&axis);
                    let aside = (to_q - axis.into_inner() * height).norm();
                    let of_part = |part: &ToolPart| {
                        let beside = (aside - part.taper.at(height)) / libm::hypot(1.0, part.taper.slope);
                        beside.max(aside - part.radius()).max(part.from - height).max(height - part.to)
                    };
                    parts.iter().map(of_part).fold(f64::INFINITY, f64::min)
                };
                let least = (0..=1000).map(|t| excess(f64::from(t) / 1000.0)).fold(f64::INFINITY, f64::min);
                let is_covered = covered.iter().any(|[first, last]| *first <= s && s <= *last);
                prop_assert!(!is_covered || least < TOUCH_DEPTH + 0.02, "{} {}", s, least);
                prop_assert!(is_covered || least > TOUCH_DEPTH - 1e-6, "{} {}", s, least);
            }
        }
    }
}
