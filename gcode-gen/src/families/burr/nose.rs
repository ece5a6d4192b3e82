//! The nose as the grinder follows it: arcs by the angle of C, and the positions of X and Y on them.
//!
//! At C the contact's normal is at 90° − C to the burr's axis. While C rotates through an arc, the arc's
//! centre must stay in place: (X, Y) = e − Rot(C)·e, with e from the C axis to the centre. This is the
//! meaning of equations (3) and (4), with the sign and the constant of the fourth corrected.
use gcode_lang::units::Deg;
use gcode_part::job::{Burr, BurrShape, Nose};

/// One arc of the meridian, followed by C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// C at its beginning and end, on the grid of the increment.
    pub(super) from: Deg,
    pub(super) to: Deg,
    pub(super) radius: f64,
    /// From the C axis to its centre at C = 0.
    pub(super) centre: [f64; 2],
    /// Distance of its centre beyond the burr's axis, seen from the contact.
    pub(super) beyond: f64,
    /// Distance of its centre from the end of the cylinder towards the tip.
    pub(super) along: f64,
}

/// Position of a flute on an arc at one C.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    /// Distance from the burr's axis.
    pub(super) radius: f64,
    /// Distance from the end of the cylinder towards the tip.
    pub(super) along: f64,
}

impl Arc {
    pub(super) fn station(&self, c: Deg) -> Station {
        Station { radius: self.radius * c.cos() - self.beyond, along: self.along + self.radius * c.sin() }
    }

    /// Returns Rot(C)·e: the arc's centre with X and Y at 0.
    pub(super) fn carried(&self, c: Deg) -> [f64; 2] {
        let [x, y] = self.centre;
        [x * c.cos() - y * c.sin(), x * c.sin() + y * c.cos()]
    }
}

/// Returns the length of the cylinder; less than half an increment counts as 0, because no axis can move by
/// it.
pub(super) fn cylinder(job: &Burr) -> f64 {
    let length = job.shape.length - tip(&job.shape);
    if length < job.control.increment.size() / 2.0 { 0.0 } else { length }
}

/// Returns the distance from the end of the cylinder to the pole.
pub(super) fn tip(shape: &BurrShape) -> f64 {
    match shape.nose {
        Nose::Ball => shape.radius,
        Nose::Arcs { large, small } => small_centre(shape.radius, large, small) + small,
    }
}

/// Returns the distance from the end of the cylinder to the centre of the small arc on the burr's axis: both
/// centres and the axis form a right triangle with hypotenuse large − small.
fn small_centre(radius: f64, large: f64, small: f64) -> f64 {
    ((radius - small) * (2.0 * large - small - radius)).sqrt()
}

/// Returns the arcs from the cylinder to the end of the flute.
pub(super) fn arcs(job: &Burr) -> Vec<Arc> {
    let shape = &job.shape;
    let radius = shape.radius;
    let [x, y] = job.grinder.c_offset;
    let grid = |c: f64| Deg(job.control.increment.round(c));
    let end = grid(90.0 - shape.tip_angle);
    match shape.nose {
        Nose::Ball => {
            vec![Arc { from: Deg(0.0), to: end, radius, centre: [x, y], beyond: 0.0, along: 0.0 }]
        }
        Nose::Arcs { large, small } => {
            let (beyond, along) = (large - radius, small_centre(radius, large, small));
            let turn = grid(Deg::atan2(along, beyond).0);
            let turn = if turn < end { turn } else { end };
            let first =
                Arc { from: Deg(0.0), to: turn, radius: large, centre: [x, y + beyond], beyond, along: 0.0 };
            let second =
                Arc { from: turn, to: end, radius: small, centre: [x - along, y], beyond: 0.0, along };
            [first, second].into_iter().filter(|arc| arc.from < arc.to).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Radii 14 and 4 on a cylinder of 6: the centres are 10 apart and the large one is 8 beyond the axis, so
    /// the small one is 6 along it, the nose is 10 long, and the arcs meet at sin C = 6/10.
    #[test]
    fn two_tangent_arcs_meet_where_worked_out() {
        let job = crate::families::burr::tests::job("profile = { large = 14.0, small = 4.0 }\n");
        assert!((tip(&job.shape) - 10.0).abs() < 1e-12);
        let actual = arcs(&job);
        let expected = [
            Arc {
                from: Deg(0.0),
                to: Deg(36.87),
                radius: 14.0,
                centre: [40.0, -7.0],
                beyond: 8.0,
                along: 0.0,
            },
            Arc {
                from: Deg(36.87),
                to: Deg(85.0),
                radius: 4.0,
                centre: [34.0, -15.0],
                beyond: 0.0,
                along: 6.0,
            },
        ];
        assert_eq!(actual, expected);
        // There, 14·0.8 − 8 = 3.2 from the axis and 14·0.6 = 8.4 along it, on either arc.
        for arc in actual {
            let station = arc.station(Deg(36.87));
            assert!((station.radius - 3.2).abs() < 1e-4 && (station.along - 8.4).abs() < 1e-4, "{station:?}");
        }
    }
}
