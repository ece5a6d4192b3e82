//! The nose as the grinder goes along it: arcs by the angle of C, and where X and Y stand on them.
//!
//! At C the contact's normal stands 90° − C from the burr's axis. While C turns through an arc, that arc's centre has
//! to stay where it is: (X, Y) = e − Rot(C)·e with e from the C axis to the centre. This is what equations (3) and (4)
//! mean, the fourth with its sign and its constant put right.
use gcode_lang::units::Deg;
use gcode_part::job::{Burr, BurrShape, Nose};

/// One arc of the meridian, gone along with C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// C where it begins and ends, on the increment's grid.
    pub(super) from: Deg,
    pub(super) to: Deg,
    pub(super) radius: f64,
    /// From the C axis to its centre at C = 0.
    pub(super) centre: [f64; 2],
    /// Its centre lies this far beyond the burr's axis, seen from the contact.
    pub(super) beyond: f64,
    /// Its centre lies this far from the end of the cylinder towards the tip.
    pub(super) along: f64,
}

/// What a flute is on an arc at one C.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station {
    /// From the burr's axis.
    pub(super) radius: f64,
    /// From the end of the cylinder towards the tip.
    pub(super) along: f64,
}

impl Arc {
    pub(super) fn station(&self, c: Deg) -> Station {
        Station { radius: self.radius * c.cos() - self.beyond, along: self.along + self.radius * c.sin() }
    }

    /// Rot(C)·e: where the arc's centre would be with X and Y at 0.
    pub(super) fn carried(&self, c: Deg) -> [f64; 2] {
        let [x, y] = self.centre;
        [x * c.cos() - y * c.sin(), x * c.sin() + y * c.cos()]
    }
}

/// The length of the cylinder; what is less than half an increment is none, for no axis moves by it.
pub(super) fn cylinder(job: &Burr) -> f64 {
    let length = job.shape.length - tip(&job.shape);
    if length < job.control.increment.size() / 2.0 { 0.0 } else { length }
}

/// From the end of the cylinder to the pole.
pub(super) fn tip(shape: &BurrShape) -> f64 {
    match shape.nose {
        Nose::Ball => shape.radius,
        Nose::Arcs { large, small } => small_centre(shape.radius, large, small) + small,
    }
}

/// From the end of the cylinder to the centre of the small arc, on the burr's axis: both centres and the axis make a
/// right triangle with the hypotenuse large − small.
fn small_centre(radius: f64, large: f64, small: f64) -> f64 {
    ((radius - small) * (2.0 * large - small - radius)).sqrt()
}

/// The arcs from the cylinder to the end of the flute.
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

    /// Radii 14 and 4 on a cylinder of 6: the centres are 10 apart and the large one's is 8 beyond the axis, so the
    /// small one's is 6 along it, the nose is 10 long, and the arcs meet at sin C = 6/10.
    #[test]
    fn two_arcs_worked_by_hand() {
        let job = crate::families::burr::tests::job("profile = { large = 14.0, small = 4.0 }\n");
        assert!((tip(&job.shape) - 10.0).abs() < 1e-12);
        let found = arcs(&job);
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
        assert_eq!(found, expected);
        // There 14·0.8 − 8 = 3.2 from the axis and 14·0.6 = 8.4 along it, by either arc.
        for arc in found {
            let station = arc.station(Deg(36.87));
            assert!((station.radius - 3.2).abs() < 1e-4 && (station.along - 8.4).abs() < 1e-4, "{station:?}");
        }
    }
}
