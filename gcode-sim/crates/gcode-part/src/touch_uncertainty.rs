//! Uncertainty of a run-out: the covariance of the least squares that determine shift and tilt.
use nalgebra::{Point3, SMatrix, SVector, Vector3};

use super::surface::{Surface, bisect};
use gcode_lang::units::Deg;

/// Ratio of a result's deviation to a touch's noise above which the fit counts as degenerate.
const MAX_FACTOR: f64 = 300.0;

/// Touches of a part along x with a stylus ball, in the plane z = 0; lengths in mm.
#[derive(Clone, Debug)]
pub struct TouchPlan {
    /// Surface of the part.
    pub surface: Surface,
    /// Radius of the ball.
    pub radius: f64,
    /// y of the ball at each height.
    pub heights: Vec<f64>,
    /// Azimuths of the part touched at each height.
    pub azimuths: Vec<Deg>,
}

/// Standard deviations of the results for touches with a standard deviation of 1 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitUncertainty {
    /// Shift in x, y and z, mm.
    pub shift: [f64; 3],
    /// Tilt about x and about z, degrees.
    pub tilt: [f64; 2],
}

/// Reason for which a fit is impossible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitError {
    /// The ball passes the part.
    NoContact {
        /// Height of the reading, mm.
        height: f64,
    },
    /// One of the five unknowns has the same readings as others, or nearly: its deviation would exceed 300
    /// times the noise.
    Degenerate,
}

impl TouchPlan {
    /// Returns the uncertainty of a fit of shift in x, y, z and tilt about x and z.
    ///
    /// # Errors
    /// A ball that touches nothing, and touches that do not separate the five unknowns.
    pub fn uncertainty(&self) -> Result<FitUncertainty, FitError> {
        // A tilt is scaled by its displacement at this lever, so that all five unknowns are lengths.
        let lever = self.lever();
        let (mut normal, mut spread) = (SMatrix::<f64, 5, 5>::zeros(), SMatrix::<f64, 5, 5>::zeros());
        for (height, azimuth) in
            self.heights.iter().flat_map(|height| self.azimuths.iter().map(move |azimuth| (height, azimuth)))
        {
            let (out, along, up) = self.contact(*height).ok_or(FitError::NoContact { height: *height })?;
            let turned = |r: f64, y: f64| Vector3::new(r * azimuth.cos(), y, r * azimuth.sin());
            let (ball, n) = (turned(out, *height), turned(along, up));
            let moment = ball.cross(&n) / lever;
            let row = SVector::<f64, 5>::new(n.x, n.y, n.z, moment.x, moment.z);
            let square = row * row.transpose();
            normal += square;
            // Noise along x moves the ball from the surface by its component along the normal.
            spread += square * (along * along);
        }
        let inverse = normal.try_inverse().ok_or(FitError::Degenerate)?;
        let found = (inverse * spread * inverse).diagonal().map(f64::sqrt);
        let is_determined = found.iter().all(|deviation| *deviation < MAX_FACTOR);
        let angle = |index: usize| found[index] / lever * 180.0 / std::f64::consts::PI;
        let uncertainty =
            FitUncertainty { shift: [found[0], found[1], found[2]], tilt: [angle(3), angle(4)] };
        is_determined.then_some(uncertainty).ok_or(FitError::Degenerate)
    }

    fn lever(&self) -> f64 {
        match self.surface {
            Surface::Ellipsoid { b, .. } => b,
            Surface::Cylinder { radius } => radius,
            Surface::Block { min, max } => (max - min).norm() / 2.0,
            Surface::Rod(rod) => rod.length / 2.0,
        }
    }

    /// Returns the x of the ball in contact at this height, and the x and y of the surface's normal there.
    fn contact(&self, height: f64) -> Option<(f64, f64, f64)> {
        let far = |x: f64| self.surface.nearest(&Point3::new(x, height, 0.0));
        let mut outside = self.radius + 1.0;
        while far(outside).distance < self.radius {
            outside *= 2.0;
        }
        if far(0.0).distance > self.radius {
            return None;
        }
        let touching = bisect(0.0, outside, |x| self.radius <= far(x).distance);
        let normal = far(touching).normal;
        Some((touching, normal.x, normal.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touches(a: f64, b: f64, heights: [f64; 2], azimuths: impl Iterator<Item = f64>) -> TouchPlan {
        let surface = Surface::Ellipsoid { a, b };
        TouchPlan { surface, radius: 0.001, heights: heights.into(), azimuths: azimuths.map(Deg).collect() }
    }

    fn near(found: f64, expected: f64, part: f64) {
        assert!((found / expected - 1.0).abs() < part, "{found} is not {expected}");
    }

    /// By hand, a = 1000, b = 500, y = ±300 four times per revolution: there r = 800 and the normal is
    /// (0.0008, 0.0012) by its length. All sums of products of two different unknowns vanish. A shift in x
    /// reads n_r·cos φ, which squared and summed is 4·n_r²: σ = 1/√4. A tilt reads (r·n_y − y·n_r)·cos φ: σ =
    /// n_r/(r·n_y − y·n_r)/√4 = 0.0008/0.72/2 rad. A shift in y reads n_y in all eight: σ = n_r/n_y/√8.
    #[test]
    fn of_a_full_turn_the_deviations_are_those_worked_out_by_hand() {
        let found = touches(1000.0, 500.0, [300.0, -300.0], (0..4).map(|n| 90.0 * f64::from(n)));
        let found = found.uncertainty().unwrap();
        near(found.shift[0], 0.5, 1e-5);
        near(found.shift[2], 0.5, 1e-5);
        near(found.shift[1], 0.235_702, 1e-5);
        near(found.tilt[0], (1.0_f64 / 1800.0).to_degrees(), 1e-5);
        near(found.tilt[1], (1.0_f64 / 1800.0).to_degrees(), 1e-5);
    }

    /// The petal of docs/methods/alignment.md, whose deviations come from many simulated runs with noise of
    /// 0.001.
    #[test]
    fn of_a_petal_they_are_those_that_noisy_runs_show() {
        for (to, [x, z, about_x, about_z]) in [
            (25.0, [0.0010, 0.0018, 0.000_22, 0.000_87]),
            (15.0, [0.0024, 0.0030, 0.000_35, 0.002_4]),
            (40.0, [0.0006, 0.0012, 0.000_14, 0.000_35]),
        ] {
            let angles = (0..11).map(|n| -to + to / 5.0 * f64::from(n));
            let found = touches(1158.8, 724.3, [150.0, 420.0], angles).uncertainty().unwrap();
            for (found, page) in
                [(found.shift[0], x), (found.shift[2], z), (found.tilt[0], about_x), (found.tilt[1], about_z)]
            {
                near(found * 0.001, page, 0.15);
            }
        }
    }

    #[test]
    fn unknowns_with_the_same_readings_are_degenerate() {
        let alike = Err(FitError::Degenerate);
        let petal = || (0..11).map(|n| -25.0 + 5.0 * f64::from(n));
        assert_eq!(
            touches(1158.8, 1158.8, [150.0, 420.0], petal()).uncertainty(),
            alike,
            "a sphere has no tilt"
        );
        assert_eq!(touches(1158.8, 724.3, [150.0, 151.0], petal()).uncertainty(), alike);
        let narrow = (0..11).map(|n| -1.0 + 0.2 * f64::from(n));
        assert_eq!(touches(1158.8, 724.3, [150.0, 420.0], narrow).uncertainty(), alike);
        let above_the_pole = touches(1158.8, 724.3, [150.0, 730.0], petal()).uncertainty();
        assert_eq!(above_the_pole, Err(FitError::NoContact { height: 730.0 }));
    }
}
