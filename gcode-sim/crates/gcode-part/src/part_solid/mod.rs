//! The part as a stylus touches it: a convex body less the voids in it.
mod faces;
#[cfg(test)]
mod tests;

use nalgebra::{Point3, Unit, Vector3};

use self::faces::{Face, FaceLine};
use super::solid::NearestPoint;
use super::surface::{Surface, bisect};

/// Growth of a void, mm: where it ends at a face of the body or at another void, no skin remains between them.
const GROWTH: f64 = 1e-8;

/// Distance from a face to where its metal is looked for, mm: beyond the growth of a void.
const SKIN: f64 = 2.0 * GROWTH;

/// Least step of a ball along the surface, mm. A ball with a radius of 1 mm enters an edge by 1e-7 mm between two of them.
const MIN_STEP: f64 = 1e-3;

/// Largest number of steps to the nearest place of a travel.
const MAX_SAMPLES: f64 = 1000.0;

/// A convex body less convex voids, which may reach out of it and into each other; lengths in mm, in the part's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PartSolid {
    body: Surface,
    voids: Vec<Surface>,
}

impl From<Surface> for PartSolid {
    fn from(body: Surface) -> Self {
        Self { body, voids: Vec::new() }
    }
}

impl PartSolid {
    /// Builds a body with voids; `None` if one of them is an ellipsoid, whose surface contains no straight lines.
    pub fn new(body: Surface, voids: Vec<Surface>) -> Option<Self> {
        let is_ruled = |body: &Surface| !matches!(body, Surface::Ellipsoid { .. });
        (voids.is_empty() || is_ruled(&body) && voids.iter().all(is_ruled)).then_some(Self { body, voids })
    }

    /// Returns the body without its voids.
    pub fn body(&self) -> Surface {
        self.body
    }

    /// Returns the voids in the body.
    pub fn voids(&self) -> &[Surface] {
        &self.voids
    }

    /// Returns the distance of `p` from the surface of the metal, negative in the metal, and the direction out of it at the
    /// nearest point.
    ///
    /// In the metal the surface is that of the nearest void, or of the body. Outside it the nearest point of the body, or of
    /// the void that `p` is in, is the nearest metal if there is metal. Otherwise the faces are searched.
    pub fn nearest(&self, p: &Point3<f64>) -> NearestPoint {
        let outer = self.body.nearest(p);
        let by_distance = |one: &NearestPoint, other: &NearestPoint| one.distance.total_cmp(&other.distance);
        let Some(inner) = self.voids.iter().map(|void| void.nearest(p)).min_by(by_distance) else {
            return outer;
        };
        let of_void = NearestPoint { distance: -inner.distance, normal: -inner.normal };
        let bound = if of_void.distance < outer.distance { outer } else { of_void };
        if bound.distance < -GROWTH {
            return bound;
        }
        let bound = if outer.distance > 0.0 { outer } else { bound };
        // Just behind the foot.
        let behind = p - bound.normal.into_inner() * (bound.distance + SKIN);
        if self.is_metal(&behind) { bound } else { self.nearest_on_faces(p).unwrap_or(outer) }
    }

    fn is_metal(&self, p: &Point3<f64>) -> bool {
        self.body.nearest(p).distance <= 0.0
            && self.voids.iter().all(|void| GROWTH <= void.nearest(p).distance)
    }

    /// Returns the nearest point of the metal for a point outside it; `None` if no metal is left.
    fn nearest_on_faces(&self, p: &Point3<f64>) -> Option<NearestPoint> {
        let of_voids = self
            .voids
            .iter()
            .flat_map(|void| Face::all(void, SKIN, p).into_iter().map(move |face| (face, Some(self.body))));
        let of_body = Face::all(&self.body, -SKIN, p).into_iter().map(|face| (face, None));
        let mut faces: Vec<_> = of_body
            .chain(of_voids)
            .map(|(face, within)| {
                let line = face.line(face.foot());
                (line.nearest(p).map_or(f64::INFINITY, |foot| (p - foot).norm()), face, within)
            })
            .collect();
        faces.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut best: Option<(f64, Point3<f64>)> = None;
        for (bound, face, within) in faces {
            let least = best.map_or(f64::INFINITY, |(distance, _)| distance);
            if least <= bound {
                break;
            }
            // A void that is farther holds no nearer point.
            let voids: Vec<&Surface> =
                self.voids.iter().filter(|void| void.nearest(p).distance < least).collect();
            let foot = |u: f64| {
                let line: FaceLine = face.line(u);
                let line = match within {
                    Some(body) => line.within(&body)?,
                    None => line,
                };
                line.nearest_outside(p, &voids, GROWTH)
            };
            let distance = |u: f64| foot(u).map_or(f64::INFINITY, |foot| (p - foot).norm());
            let (u, distance) = face.search(&self.voids, distance);
            if let Some(foot) = foot(u).filter(|_| distance < least) {
                best = Some((distance, foot));
            }
        }
        let (_, foot) = best?;
        let (normal, distance) = Unit::try_new_and_get(p - foot, f64::MIN_POSITIVE)?;
        Some(NearestPoint { distance, normal })
    }

    /// Returns the fraction of a straight travel, 0 to 1, at which a ball touches the metal; `None` if it does not. A ball that
    /// touches at the start and moves away leaves freely.
    pub fn contact_between(&self, from: &Point3<f64>, to: &Point3<f64>, radius: f64) -> Option<f64> {
        let along = to - from;
        let nearest = |t: f64| self.nearest(&(from + along * t));
        let (start, end) = (nearest(0.0), nearest(1.0));
        // The gap closes by at most the travel.
        if start.distance + end.distance > 2.0 * radius + along.norm() {
            return None;
        }
        if self.voids.is_empty() {
            return self.convex_contact((from, to), radius);
        }
        let (direction, length) = Unit::try_new_and_get(along, f64::MIN_POSITIVE)?;
        let gap = |s: f64| nearest(s / length).distance - radius;
        if gap(0.0) <= 0.0 && start.normal.dot(&direction) < -GROWTH {
            return Some(0.0);
        }
        let (mut at, mut was_open) = (0.0, 0.0 < gap(0.0));
        while at < length {
            let step = self.free_travel(&(from + direction.into_inner() * at), &direction, radius)?;
            let next = (at + step.max(MIN_STEP)).min(length);
            let found = nearest(next / length);
            let is_open = radius < found.distance;
            if was_open && !is_open {
                return Some(bisect(at, next, |s| gap(s) <= 0.0) / length);
            }
            if !is_open && found.normal.dot(&direction) < -GROWTH {
                return Some(next / length);
            }
            (at, was_open) = (next, is_open);
        }
        None
    }

    /// Returns a length that a ball travels without a contact; `None` if it is endless.
    ///
    /// The metal is farther than its distance, and below the plane that touches the body.
    fn free_travel(&self, p: &Point3<f64>, direction: &Unit<Vector3<f64>>, radius: f64) -> Option<f64> {
        let gap = self.nearest(p).distance - radius;
        let outer = self.body.nearest(p);
        let falls = -outer.normal.dot(direction);
        match outer.distance - radius {
            above if above <= 0.0 => Some(gap),
            _ if falls <= 0.0 => None,
            above => Some(gap.max(above / falls)),
        }
    }

    /// Along a line the distance from a convex body is a convex function, so its minimum can be found, and the contact before
    /// it: no contact is missed, however shallow.
    fn convex_contact(&self, (from, to): (&Point3<f64>, &Point3<f64>), radius: f64) -> Option<f64> {
        let along = to - from;
        let nearest = |t: f64| self.body.nearest(&(from + along * t));
        let open = |t: f64| nearest(t).distance > radius;
        if nearest(0.0).normal.dot(&along) >= 0.0 {
            return None;
        }
        let innermost = self.body.nearest_between(from, to);
        match (open(0.0), open(innermost)) {
            (false, _) => Some(0.0),
            (true, true) => None,
            (true, false) => Some(bisect(0.0, innermost, |t| !open(t))),
        }
    }

    /// Returns the fraction, 0 to 1, of a straight travel at which the metal is nearest.
    ///
    /// With voids the steps are those on which the metal can't come nearer than where it is nearest so far, and at least a
    /// thousandth of the travel; the nearest place is then refined between its neighbours.
    pub fn nearest_between(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        if self.voids.is_empty() {
            return self.body.nearest_between(from, to);
        }
        let along = to - from;
        let length = along.norm();
        if length == 0.0 {
            return 0.0;
        }
        let distance = |t: f64| self.nearest(&(from + along * t)).distance;
        let (first, last) = ((distance(0.0), 0.0), (distance(1.0), 1.0));
        let mut best = if last.0 < first.0 { last } else { first };
        let (mut at, mut value) = (0.0, first.0);
        while at < 1.0 {
            at += ((value - best.0) / length).max(1.0 / MAX_SAMPLES);
            value = distance(at.min(1.0));
            if value < best.0 {
                best = (value, at.min(1.0));
            }
        }
        let step = 1.0 / MAX_SAMPLES;
        faces::least([(best.1 - step).max(0.0), best.1, (best.1 + step).min(1.0)], distance).0
    }
}
