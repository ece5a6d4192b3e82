//! Faces of boxes and cylinders as families of straight lines.
use std::f64::consts::PI;

use nalgebra::{Point3, Unit, Vector3};

use crate::solid::Rod;
use crate::surface::Surface;

/// Half the length of a line on a cylinder without ends, mm.
const ENDLESS: f64 = 1e5;

/// Number of lines that are spread evenly over a face.
const EVEN_LINES: u32 = 48;

/// Number of lines on each side of the foot, each nearer to it by a factor.
const NEAR_LINES: i32 = 40;
const NEARER: f64 = 0.65;

/// A face as a family of lines, each with a parameter.
pub(super) struct Face {
    shape: FaceShape,
    range: [f64; 2],
    /// Parameter of the line that is nearest to the point for which the face is searched.
    foot: f64,
}

enum FaceShape {
    /// A rectangle; the parameter is the distance along its first side.
    Flat { corner: Point3<f64>, across: Unit<Vector3<f64>>, along: Vector3<f64> },
    /// A mantle; the parameter is the angle from the direction of the point.
    Mantle { base: Point3<f64>, out: Vector3<f64>, beside: Vector3<f64>, along: Vector3<f64> },
    /// An end face, by chords; the parameter is their distance from the centre.
    Disc { centre: Point3<f64>, out: Vector3<f64>, beside: Vector3<f64>, radius: f64 },
}

/// Part of a straight line, between two fractions of the way from `from` along `along`.
#[derive(Clone, Copy)]
pub(super) struct FaceLine {
    from: Point3<f64>,
    along: Vector3<f64>,
    shares: [f64; 2],
}

impl Face {
    /// Returns the faces of a box or a cylinder that is larger by `growth` on all sides, for the search from `p`.
    pub(super) fn all(body: &Surface, growth: f64, p: &Point3<f64>) -> Vec<Self> {
        match *body {
            Surface::Block { min, max } => {
                let by = Vector3::repeat(growth);
                Self::of_block(&(min - by), &(max + by), p)
            }
            Surface::Rod(rod) => {
                let axis = rod.axis.into_inner();
                let grown = Rod {
                    base: rod.base - axis * growth,
                    length: rod.length + 2.0 * growth,
                    radius: rod.radius + growth,
                    ..rod
                };
                let mantle = Self::mantle(&grown, p);
                let ends = [grown.base, grown.base + axis * grown.length];
                ends.into_iter().map(|end| Self::disc(&grown, end, p)).chain([mantle]).collect()
            }
            Surface::Cylinder { radius } => {
                let base = Point3::new(p.x - ENDLESS, 0.0, 0.0);
                let (axis, length) = (Vector3::x_axis(), 2.0 * ENDLESS);
                vec![Self::mantle(&Rod { base, axis, length, radius: radius + growth }, p)]
            }
            Surface::Ellipsoid { .. } => Vec::new(),
        }
    }

    fn of_block(min: &Point3<f64>, max: &Point3<f64>, p: &Point3<f64>) -> Vec<Self> {
        let unit = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let sides = (0..3).flat_map(|i| [(i, min[i]), (i, max[i])]);
        let face = |(i, at): (usize, f64)| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let mut corner = *min;
            corner[i] = at;
            let range = [0.0, max[j] - min[j]];
            let along = unit[k].into_inner() * (max[k] - min[k]);
            let shape = FaceShape::Flat { corner, across: unit[j], along };
            Self { shape, range, foot: (p[j] - min[j]).clamp(range[0], range[1].max(range[0])) }
        };
        sides.map(face).collect()
    }

    fn mantle(rod: &Rod, p: &Point3<f64>) -> Self {
        let (_, out, _) = rod.cylindrical(p);
        let axis = rod.axis.into_inner();
        let (base, beside) = (rod.base, axis.cross(&out) * rod.radius);
        let shape = FaceShape::Mantle { base, out: out * rod.radius, beside, along: axis * rod.length };
        Self { shape, range: [-PI, PI], foot: 0.0 }
    }

    fn disc(rod: &Rod, centre: Point3<f64>, p: &Point3<f64>) -> Self {
        let (_, out, distance) = rod.cylindrical(p);
        let (beside, radius) = (rod.axis.cross(&out), rod.radius);
        let shape = FaceShape::Disc { centre, out, beside, radius };
        Self { shape, range: [-radius, radius], foot: distance.min(radius) }
    }

    /// Returns the parameter of the line that is nearest to the point of the search.
    pub(super) fn foot(&self) -> f64 {
        self.foot
    }

    /// Returns the line with a parameter.
    pub(super) fn line(&self, u: f64) -> FaceLine {
        let (from, along) = match self.shape {
            FaceShape::Flat { corner, across, along } => (corner + across.into_inner() * u, along),
            FaceShape::Mantle { base, out, beside, along } => {
                (base + out * libm::cos(u) + beside * libm::sin(u), along)
            }
            FaceShape::Disc { centre, out, beside, radius } => {
                let half = beside * (radius * radius - u * u).max(0.0).sqrt();
                (centre + out * u - half, half * 2.0)
            }
        };
        FaceLine { from, along, shares: [0.0, 1.0] }
    }

    /// Returns the parameter of the line that passes a point, or passes it nearest.
    fn parameter(&self, p: &Point3<f64>) -> f64 {
        match self.shape {
            FaceShape::Flat { corner, across, .. } => (p - corner).dot(&across),
            FaceShape::Mantle { base, out, beside, .. } => {
                libm::atan2((p - base).dot(&beside), (p - base).dot(&out))
            }
            FaceShape::Disc { centre, out, .. } => (p - centre).dot(&out),
        }
    }

    /// Returns the parameter at which a distance is least, and the distance. Lines are compared that are spread over the face,
    /// that close in on the foot, and those at the ends of voids; each least one is refined between its neighbours.
    pub(super) fn search(&self, voids: &[Surface], distance: impl Fn(f64) -> f64) -> (f64, f64) {
        let [low, high] = self.range;
        let at_foot = distance(self.foot);
        let even = (0..=EVEN_LINES).map(|n| low + (high - low) * f64::from(n) / f64::from(EVEN_LINES));
        let steps = (0..NEAR_LINES).map(|k| (high - low) * libm::pow(NEARER, f64::from(k)));
        let near = steps.flat_map(|step| [self.foot - step, self.foot + step]);
        let ends = voids.iter().flat_map(|void| corners(void.bounds())).map(|corner| self.parameter(&corner));
        let mut lines: Vec<f64> = even.chain(near).chain(ends).chain([self.foot]).collect();
        lines.retain(|u| low <= *u && *u <= high);
        lines.sort_by(f64::total_cmp);
        lines.dedup();
        let values: Vec<f64> = lines.iter().map(|u| distance(*u)).collect();
        let neighbour =
            |i: usize, step: isize| i.checked_add_signed(step).filter(|i| *i < lines.len()).unwrap_or(i);
        let minima = (0..lines.len()).filter(|i| {
            values[*i].is_finite()
                && values[*i] <= values[neighbour(*i, -1)]
                && values[*i] <= values[neighbour(*i, 1)]
        });
        let refined =
            minima.map(|i| least([lines[neighbour(i, -1)], lines[i], lines[neighbour(i, 1)]], &distance));
        refined.fold((self.foot, at_foot), |one, other| if other.1 < one.1 { other } else { one })
    }
}

fn corners([low, high]: [Point3<f64>; 2]) -> impl Iterator<Item = Point3<f64>> {
    let pick = move |n: usize, i: usize| if n >> i & 1 == 0 { low[i] } else { high[i] };
    (0..8).map(move |n| Point3::new(pick(n, 0), pick(n, 1), pick(n, 2)))
}

/// Returns where a function is least between two numbers, and its value there, by golden sections that keep the least value
/// found between two larger ones; it begins with a number between them.
pub(super) fn least([mut low, mut at, mut high]: [f64; 3], value: impl Fn(f64) -> f64) -> (f64, f64) {
    const SECTION: f64 = 0.381_966_011_250_105_1;
    let mut best = value(at);
    for _ in 0..120 {
        let is_above = at - low < high - at;
        let next = if is_above { at + (high - at) * SECTION } else { at - (at - low) * SECTION };
        if next == at || high - low < 1e-13 * (1.0 + at.abs()) {
            break;
        }
        let found = value(next);
        let next_is_better = found < best;
        let (old, better) = if next_is_better { (at, next) } else { (next, at) };
        if old < better {
            low = old;
        } else {
            high = old;
        }
        (at, best) = (better, found.min(best));
    }
    (at, best)
}

impl FaceLine {
    /// Returns the part of the line in a convex body; `None` without one.
    pub(super) fn within(self, body: &Surface) -> Option<Self> {
        let shares = body.piece(&self.from, &(self.from + self.along), 0.0)?;
        Some(Self { shares, ..self })
    }

    /// Returns the point of the line that is nearest to `p`.
    pub(super) fn nearest(&self, p: &Point3<f64>) -> Option<Point3<f64>> {
        self.nearest_outside(p, &[], 0.0)
    }

    /// Returns the point of the line that is nearest to `p` and in none of the voids, which are larger by `growth`.
    pub(super) fn nearest_outside(
        &self,
        p: &Point3<f64>,
        voids: &[&Surface],
        growth: f64,
    ) -> Option<Point3<f64>> {
        let square = self.along.norm_squared();
        if square < f64::MIN_POSITIVE {
            let is_free = voids.iter().all(|void| growth <= void.nearest(&self.from).distance);
            return is_free.then_some(self.from);
        }
        let [first, last] = self.shares;
        let end = self.from + self.along;
        let open = |void: &&Surface| {
            let [first, last] = void.piece(&self.from, &end, -growth)?;
            // Beyond the ends of the line the void may go on.
            let first = if first <= 0.0 { f64::NEG_INFINITY } else { first };
            Some([first, if 1.0 <= last { f64::INFINITY } else { last }])
        };
        let open: Vec<[f64; 2]> = voids.iter().filter_map(open).collect();
        let foot = ((p - self.from).dot(&self.along) / square).clamp(first, last);
        let end_of = |mut t: f64, end: usize| {
            while let Some(piece) = open.iter().find(|[low, high]| *low < t && t < *high) {
                t = piece[end];
            }
            (first <= t && t <= last).then_some(t)
        };
        let nearer = |one: f64, other: f64| if foot - one <= other - foot { one } else { other };
        let t = match (end_of(foot, 0), end_of(foot, 1)) {
            (Some(one), Some(other)) => nearer(one, other),
            (one, other) => one.or(other)?,
        };
        Some(self.from + self.along * t)
    }
}

#[cfg(test)]
impl Face {
    /// Returns the points of the face on a grid of its lines.
    pub(super) fn grid(&self, count: u32) -> Vec<Point3<f64>> {
        let [low, high] = self.range;
        let share = move |n: u32| f64::from(n) / f64::from(count);
        let lines = (0..=count).map(|n| self.line(low + (high - low) * share(n)));
        lines.flat_map(|line| (0..=count).map(move |n| line.from + line.along * share(n))).collect()
    }
}
