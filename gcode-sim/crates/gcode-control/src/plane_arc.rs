//! Points and chords of an arc in a plane whose other axes move evenly.
use gcode_lang::motion::{PlanarArc, Position};
use gcode_lang::units::Deg;

/// Returns a point of an arc, as a fraction of its path; the axes outside its plane move evenly.
pub(super) fn point_of_arc(from: &Position, to: &Position, arc: &PlanarArc, fraction: f64) -> Position {
    if fraction == 1.0 {
        return *to;
    }
    let PlanarArc { plane, centre, sweep } = *arc;
    let mut point = Position(std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * fraction));
    let (x, y, turned) = (from[plane.0] - centre.0, from[plane.1] - centre.1, sweep * fraction);
    point[plane.0] = centre.0 + x * turned.cos() - y * turned.sin();
    point[plane.1] = centre.1 + x * turned.sin() + y * turned.cos();
    point
}

/// Returns the number of chords from which an arc deviates by at most `tolerance`: r·(1 − cos(half a chord's angle)).
pub(super) fn chord_count(radius: f64, sweep: Deg, tolerance: f64) -> u32 {
    let half = libm::acos((1.0 - tolerance / radius.max(tolerance)).clamp(0.0, 1.0));
    (sweep.0.abs().to_radians() / (2.0 * half)).ceil().clamp(1.0, 1e6) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_radius_50_has_125_chords_of_a_micron() {
        // Half a chord's angle is acos(1 − 0.001/50) = 0.006324566, so that 1.570796/0.012649 = 124.18 chords would do.
        assert_eq!(chord_count(50.0, Deg(90.0), 0.001), 125);
        assert_eq!(chord_count(0.0005, Deg(90.0), 0.001), 1);
    }
}
