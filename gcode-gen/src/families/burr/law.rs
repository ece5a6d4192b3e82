//! Rotation of a flute as a function of C by its law, and its curvature, which limits the length of straight
//! moves.
use gcode_lang::units::{Deg, ln};
use gcode_part::job::FluteLaw;

use super::nose::Arc;

/// Allowed variation of the contact's speed along the flute within a move, as a fraction.
const MAX_SPEED_SWING: f64 = 0.25;

/// A flute on one arc of the nose.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flute {
    pub(super) law: FluteLaw,
    pub(super) helix: Deg,
    pub(super) arc: Arc,
}

/// Slope of a flute at a point, and the curvature of A there.
struct SlopeChange {
    /// Tangent of the helix angle: around over along.
    slope: f64,
    /// radius·A'', with A as a function of C in rad: mm.
    around: f64,
}

impl Flute {
    /// Returns the rotation of A from the beginning of the arc to C.
    pub(super) fn turn(&self, c: Deg) -> Deg {
        Deg(self.angle(c).0 - self.angle(self.arc.from).0)
    }

    /// Returns A with an arbitrary zero.
    fn angle(&self, c: Deg) -> Deg {
        let tan = self.helix.tan();
        let arc = &self.arc;
        match self.law {
            // The integral of tan(helix)·ρ·dC/(ρ·cos C − d); on a ball (d = 0) it is ln tan(45° + C/2).
            FluteLaw::ConstantHelix => {
                let k = arc.beyond / arc.radius;
                let t = Deg(c.0 / 2.0).tan() * ((1.0 + k) / (1.0 - k)).sqrt();
                Deg::from_rad(tan * ln((1.0 + t) / (1.0 - t)) / ((1.0 - k) * (1.0 + k)).sqrt())
            }
            // Equations (5) to (8).
            FluteLaw::Published => {
                let station = arc.station(c);
                Deg::from_rad(tan * station.along / station.radius)
            }
        }
    }

    /// Returns the tangent of the helix angle at C.
    pub(super) fn slope(&self, c: Deg) -> f64 {
        self.slope_change(c).slope
    }

    fn slope_change(&self, c: Deg) -> SlopeChange {
        let (arc, tan) = (&self.arc, self.helix.tan());
        let r = arc.station(c).radius;
        match self.law {
            FluteLaw::ConstantHelix => {
                SlopeChange { slope: tan, around: tan * arc.radius * arc.radius * c.sin() / r }
            }
            FluteLaw::Published => {
                let along = arc.station(c).along;
                // Numerators of the first derivative and of the remaining second derivative of the quotient
                // along/radius.
                let first = arc.radius * (c.cos() * r + c.sin() * along);
                let second = arc.radius * (arc.beyond * c.sin() + arc.along * c.cos());
                SlopeChange {
                    slope: tan * first / (r * arc.radius),
                    around: tan * (second / r + 2.0 * arc.radius * c.sin() * first / (r * r)),
                }
            }
        }
    }

    /// Returns the curvature of the contact's path away from the flute, per square of C in rad: mm.
    ///
    /// A straight move from C to C + c deviates from the true X, Y and A by at most c²/8 of their second
    /// derivatives; X'' and Y'' are Rot(C)·e. Y goes into the surface, X along the meridian, A around the
    /// axis; of the last two only the component across the flute counts.
    fn path_curvature(&self, c: Deg) -> f64 {
        let [meridian, normal] = self.arc.carried(c);
        let SlopeChange { slope, around } = self.slope_change(c);
        let across = (meridian * slope - around) / (1.0 + slope * slope).sqrt();
        (normal * normal + across * across).sqrt()
    }

    /// Returns the longest move from C in which the contact's speed along the flute varies by at most
    /// [`SWING`].
    ///
    /// A deviation along the flute leaves the contact on it, but over a move the contact slows down or speeds
    /// up by half the move times the curvature, and could even reverse.
    fn max_steady_step(&self, c: Deg) -> Deg {
        let [meridian, _] = self.arc.carried(c);
        let SlopeChange { slope, around } = self.slope_change(c);
        let along = (meridian + around * slope).abs();
        Deg::from_rad(2.0 * MAX_SPEED_SWING * self.arc.radius * (1.0 + slope * slope) / along)
    }

    /// Returns the longest move from C that stays within `error` mm of the flute at a steady speed, shortened
    /// so that equal moves fill the rest of the arc. The stricter limit of the move's two ends applies; no
    /// move exceeds 10°.
    pub(super) fn step(&self, c: Deg, error: f64) -> Deg {
        let by = |c: Deg| {
            let straight = Deg::from_rad((8.0 * error / self.path_curvature(c)).sqrt());
            straight.0.min(self.max_steady_step(c).0).min(10.0)
        };
        let (rest, step) = (self.arc.to - c, by(c));
        let step = step.min(by(Deg(c.0 + step.min(rest.0))));
        Deg(rest.0 / (rest.0 / step).ceil())
    }
}
