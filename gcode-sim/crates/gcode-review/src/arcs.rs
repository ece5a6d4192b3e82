//! Differences of arcs in their direction, radius and centre.
use super::steps::{ROUNDED, Step};
use gcode_lang::motion::PlanarArc;
use gcode_lang::units::Deg;

/// The longest arc whose centre follows from its ends and its radius, degrees: the ends of a longer one are too near.
const LONGEST_BY_RADIUS: f64 = 350.0;

/// Describes the difference of two arcs, unless it follows from a shift of their ends: I, J and K count from the
/// start, R is the distance of the centre, and parallel arcs have one centre. R fixes the centre of no circle.
pub(super) fn reshaped(
    (old, a): (&Step<'_>, &PlanarArc),
    (new, b): (&Step<'_>, &PlanarArc),
    is_moved: bool,
    tolerance: f64,
) -> Option<String> {
    let tolerance = if is_moved { tolerance.max(ROUNDED) } else { tolerance };
    let near = |a: f64, b: f64| (a - b).abs() <= tolerance;
    let (ends, ends_now) = (seen_from_centre(old, a), seen_from_centre(new, b));
    let alike = |end: usize| near(ends[end].0, ends_now[end].0) && near(ends[end].1, ends_now[end].1);
    let radius = |ends: [(f64, f64); 2]| libm::hypot(ends[1].0, ends[1].1);
    let is_long = |arc: &PlanarArc| arc.sweep.0.abs() > 180.0;
    let same_sweep = (a.sweep.0 - b.sweep.0).abs() <= 1e-3;
    let same_centre = near(a.centre.0, b.centre.0) && near(a.centre.1, b.centre.1);
    let same_way = a.plane == b.plane && (a.sweep.0 > 0.0) == (b.sweep.0 > 0.0);
    let same_turn = (a.sweep.0 - b.sweep.0).abs() < 180.0;
    let has_chord = [a, b].iter().all(|arc| arc.sweep.0.abs() <= LONGEST_BY_RADIUS);
    let goes_along = alike(0)
        || near(radius(ends), radius(ends_now)) && is_long(a) == is_long(b) && has_chord
        || same_centre && same_sweep && is_moved;
    if same_way && same_turn && goes_along {
        return None;
    }
    Some(format!(
        "an arc of radius {:.4} sweeps {:+.3}° about {:.4} {:.4} instead of one of {:.4} {:+.3}° about {:.4} {:.4} (machine, mm)",
        radius(ends_now),
        b.sweep.0,
        b.centre.0,
        b.centre.1,
        radius(ends),
        a.sweep.0,
        a.centre.0,
        a.centre.1
    ))
}

/// Returns start and end of an arc relative to its centre.
fn seen_from_centre(step: &Step<'_>, arc: &PlanarArc) -> [(f64, f64); 2] {
    let (x, y) = (step.at[arc.plane.0] - arc.centre.0, step.at[arc.plane.1] - arc.centre.1);
    let back = Deg(-arc.sweep.0);
    [(x * back.cos() - y * back.sin(), x * back.sin() + y * back.cos()), (x, y)]
}

#[cfg(test)]
mod tests {
    use super::super::steps::StepKind;
    use super::*;
    use gcode_lang::motion::Position;

    /// An arc from (10, 0) about (0, 0) to (0, 10), shifted by `x` and changed by `other`.
    fn arc(x: f64, other: impl Fn(&mut PlanarArc)) -> (Step<'static>, PlanarArc) {
        let mut arc = PlanarArc { plane: (0, 1), centre: (x, 0.0), sweep: Deg(90.0) };
        other(&mut arc);
        let point = |x: f64, y: f64| Position([x, y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let (from, to) = (point(10.0 + x, 0.0), point(x, 10.0));
        (Step { kind: &StepKind::Rapid, from, to, at: to, block_number: 0, set_by: None, condition: 0 }, arc)
    }

    fn differs(x: f64, other: impl Fn(&mut PlanarArc)) -> bool {
        let (was, is) = (arc(0.0, |_| ()), arc(x, other));
        reshaped((&was.0, &was.1), (&is.0, &is.1), x != 0.0, 0.001).is_some()
    }

    #[test]
    fn an_arc_that_is_moved_as_a_whole_is_the_same() {
        assert!(!differs(0.0, |_| ()) && !differs(0.01, |_| ()) && !differs(300.0, |_| ()));
    }

    #[test]
    fn sense_side_and_centre_differ_at_any_shift() {
        for x in [0.0, 0.01, 300.0] {
            // About (10, 10) from (10, 0) to (0, 10): G02, and by R-10 the long way about (0, 0).
            assert!(
                differs(x, |arc| *arc = PlanarArc { centre: (10.0 + x, 10.0), sweep: Deg(-90.0), ..*arc }),
                "{x}"
            );
            assert!(differs(x, |arc| arc.sweep = Deg(-270.0)), "{x}");
            assert!(
                differs(x, |arc| *arc = PlanarArc { centre: (10.0 + x, 10.0), sweep: Deg(270.0), ..*arc }),
                "{x}"
            );
            // R12: its centre is on the line between the ends' middle and the old one, √(144 − 50) from the middle.
            let centre = 5.0 - (94.0_f64 / 2.0).sqrt();
            let sweep = Deg(2.0 * Deg::asin(50.0_f64.sqrt() / 12.0).0);
            assert!(
                differs(x, |arc| *arc = PlanarArc { centre: (centre + x, centre), sweep, ..*arc }),
                "{x}"
            );
        }
    }

    /// A circle from (10, 0) ends where it starts, about any centre.
    #[test]
    fn a_full_circle_about_another_centre_differs() {
        let circle = |start: f64, centre: (f64, f64), sweep: f64| {
            let from = Position([start, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let arc = PlanarArc { plane: (0, 1), centre, sweep: Deg(sweep) };
            let step = Step {
                kind: &StepKind::Rapid,
                from,
                to: from,
                at: from,
                block_number: 0,
                set_by: None,
                condition: 0,
            };
            (step, arc)
        };
        let was = circle(10.0, (0.0, 0.0), 360.0);
        let differs = |start: f64, centre: (f64, f64), sweep: f64| {
            let is = circle(start, centre, sweep);
            reshaped((&was.0, &was.1), (&is.0, &is.1), start != 10.0, 0.001).is_some()
        };
        assert!(!differs(10.0, (0.0, 0.0), 360.0) && !differs(12.0, (2.0, 0.0), 360.0));
        assert!(differs(10.0, (20.0, 0.0), 360.0) && differs(10.0, (10.0, 10.0), 360.0));
        assert!(differs(12.0, (22.0, 0.0), 360.0));
        // A further turn, and an end beside the start so that almost nothing of the circle is left.
        assert!(differs(10.0, (0.0, 0.0), 720.0) && differs(10.0, (0.0, 0.0), 0.01));
    }
}
