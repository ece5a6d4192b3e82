//! Runs of straight chords: polygons whose corners lie on a circle.
use nalgebra::{Point3, Unit, Vector2, Vector3};

use super::arc_run::{ArcRun, PartArc, Ring};
use super::axis_box::directions_across;
use gcode_lang::motion::{Backtrace, Position};
use gcode_lang::units::Deg;
use gcode_part::Collar;

/// Largest angle of a chord about the axis: a circle has twelve or more.
const MAX_CHORD: Deg = Deg(30.05);

/// Largest angle between consecutive chords, besides rounding, degrees.
const MAX_CORNER: f64 = 35.0;

/// Rounding of the ends of two chords, mm.
const CORNER_ROUNDING: f64 = 0.003;

/// Angle between the first and the last chord of a closed polygon, degrees: a turn without one corner.
const CLOSED_TURN: f64 = 329.0;

/// Largest distance of a corner from the circle, mm.
const MAX_DEVIATION: f64 = 0.05;

/// Largest number of chords that lead off a circle without a corner.
const MAX_LEAD_OUT: usize = 2;

/// Largest number of corners; with more the tool mills something larger than a hole.
const MAX_CORNERS: usize = 50_000;

/// Consecutive straight feeds across the tool without a sharp corner.
#[derive(Clone, Debug)]
pub(super) struct ChordRun {
    out: Unit<Vector3<f64>>,
    corners: Vec<Point3<f64>>,
    /// Angle of the direction at each corner from the first one, about `out`, degrees.
    turned: Vec<f64>,
    /// Last chord across `out`.
    chord: Vector3<f64>,
    /// Block of the last chord and its end, once the run may be closed.
    place: Option<(Backtrace, Position)>,
}

impl ChordRun {
    pub(super) fn new(from: Point3<f64>, to: Point3<f64>, out: Unit<Vector3<f64>>) -> Self {
        let chord = across(&(to - from), &out);
        Self { out, corners: vec![from, to], turned: vec![0.0, 0.0], chord, place: None }
    }

    /// Adds a chord to `to` from the end of the run. Returns false if it doesn't continue the run.
    pub(super) fn extend(
        &mut self,
        to: Point3<f64>,
        out: &Unit<Vector3<f64>>,
        place: impl FnOnce() -> (Backtrace, Position),
    ) -> bool {
        let end = self.corners[self.corners.len() - 1];
        let chord = across(&(to - end), out);
        let turn = Deg::atan2(self.chord.cross(&chord).dot(out), self.chord.dot(&chord)).0;
        let rounding = Deg::atan2(CORNER_ROUNDING, chord.norm().min(self.chord.norm())).0;
        if *out != self.out || MAX_CORNER + rounding < turn.abs() || MAX_CORNERS <= self.corners.len() {
            return false;
        }
        let turned = self.turned[self.turned.len() - 1] + turn;
        self.corners.push(to);
        self.turned.push(turned);
        self.chord = chord;
        if CLOSED_TURN <= turned.abs() {
            self.place = Some(place());
        }
        true
    }

    /// Returns true if the run has closed and its last chord is one of a polygon about the axis of a hole.
    pub(super) fn circles_about(&self, collar: &Collar) -> bool {
        let [.., from, to] = &self.corners[..] else { return false };
        let off = collar.from_axis(from) - collar.from_axis(to);
        self.place.is_some() && off.abs() <= MAX_DEVIATION
    }

    /// Ends the run; `None` without a full turn whose corners lie on a circle.
    pub(super) fn finish(self) -> Option<Ring> {
        let place = self.place.clone()?;
        (0..=MAX_LEAD_OUT).find_map(|lead_out| self.ring(lead_out, &place))
    }

    /// Returns the circle that ends `lead_out` corners before the run.
    fn ring(&self, lead_out: usize, place: &(Backtrace, Position)) -> Option<Ring> {
        let end = self.corners.len().checked_sub(1 + lead_out)?;
        let total = self.turned[end];
        let sense = total.signum();
        let begin = (0..end).rev().find(|at| CLOSED_TURN <= (total - self.turned[*at]) * sense)?;
        let (centre, radius) = fit(&self.corners[begin..=end], &self.out)?;
        let spoke = |p: &Point3<f64>| across(&(p - centre), &self.out);
        let is_on = |p: &Point3<f64>| (spoke(p).norm() - radius).abs() <= MAX_DEVIATION;
        let first = (0..=end).rev().take_while(|at| is_on(&self.corners[*at])).last()?;
        let mut run: Option<ArcRun> = None;
        let mut from = self.corners[first];
        for to in &self.corners[first + 1..=end] {
            let (before, after) = (spoke(&from), spoke(to));
            let sweep = Deg::atan2(before.cross(&after).dot(&self.out), before.dot(&after));
            // Rounding may turn a very short chord round.
            if sweep.0 * sense <= 0.0 {
                continue;
            }
            if MAX_CHORD.0 < sweep.abs().0 {
                return None;
            }
            let centre = from - before;
            let chord = PartArc { centre, out: self.out, from, to: *to, sweep, is_chord: true };
            match &mut run {
                Some(run) => run.extend(chord, || place.clone()).ok()?,
                None => run = Some(ArcRun::new(chord, || place.clone())),
            }
            from = *to;
        }
        run?.finish()
    }
}

fn across(chord: &Vector3<f64>, out: &Unit<Vector3<f64>>) -> Vector3<f64> {
    chord - out.into_inner() * chord.dot(out)
}

/// Returns a point of the axis and the radius of the least squares circle (Kåsa) of some points; `None` for points on a line.
fn fit(points: &[Point3<f64>], out: &Unit<Vector3<f64>>) -> Option<(Point3<f64>, f64)> {
    let count = points.len() as f64;
    let mean = Point3::from(points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / count);
    let [u, v] = directions_across(out);
    let (mut matrix, mut right, mut squares) = (nalgebra::Matrix2::zeros(), Vector2::zeros(), 0.0);
    for p in points {
        let to = p - mean;
        let flat = Vector2::new(to.dot(&u), to.dot(&v));
        matrix += flat * flat.transpose();
        right += flat * (flat.norm_squared() / 2.0);
        squares += flat.norm_squared();
    }
    let centre = matrix.try_inverse()? * right;
    let radius = (centre.norm_squared() + squares / count).sqrt();
    Some((mean + u * centre.x + v * centre.y, radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the circle of a path through points on a circle of 7 about (40, 30), with their angles in degrees.
    fn ring(angles: impl IntoIterator<Item = f64>, round: f64, further: &[Point3<f64>]) -> Option<Ring> {
        let round = |value: f64| if round > 0.0 { (value / round).round() * round } else { value };
        let point = |angle: f64| {
            Point3::new(round(40.0 + 7.0 * Deg(angle).cos()), round(30.0 + 7.0 * Deg(angle).sin()), -5.0)
        };
        let points: Vec<_> = angles.into_iter().map(point).chain(further.iter().copied()).collect();
        let place =
            || (Backtrace { block: gcode_lang::source::Span::default(), calls: None }, Position::default());
        let mut run = ChordRun::new(points[0], points[1], Vector3::z_axis());
        points[2..].iter().for_each(|to| assert!(run.extend(*to, &Vector3::z_axis(), place)));
        run.finish()
    }

    fn closed(count: u32) -> impl Iterator<Item = f64> {
        (0..=count).map(move |index| 360.0 * f64::from(index) / f64::from(count))
    }

    /// The middle of a chord of 30° is at 7·cos 15° = 6.761 481.
    #[test]
    fn twelve_chords_are_a_circle_and_eleven_are_none() {
        let twelve = ring(closed(12), 0.0, &[]).unwrap();
        assert!((twelve.centre - Point3::new(40.0, 30.0, -5.0)).norm() < 1e-9);
        assert!((twelve.roundness - 0.238_519).abs() < 1e-6, "{}", twelve.roundness);
        assert!(ring(closed(11), 0.0, &[]).is_none());
        assert!(ring(closed(36).take(36), 0.0, &[]).is_none(), "one chord is missing");
        assert!(ring(closed(36).map(|angle| -angle), 0.0, &[]).is_some(), "clockwise");
    }

    /// A thousand chords of 0.044 mm with corners rounded to 0.001 mm turn by up to 2° the wrong way.
    #[test]
    fn short_chords_with_rounded_corners_are_a_circle() {
        let fine = ring(closed(1000), 0.001, &[]).unwrap();
        assert!(
            (fine.radius - 7.0).abs() < 1e-4 && fine.roundness < 0.0015,
            "{} {}",
            fine.radius,
            fine.roundness
        );
    }

    /// The last chord leads along the circle's tangent at (47, 30), from there 10 mm on.
    #[test]
    fn a_tangent_off_the_circle_is_no_part_of_it() {
        let led_out = ring(closed(36), 0.0, &[Point3::new(47.0, 40.0, -5.0)]).unwrap();
        assert!((led_out.roundness - 7.0 * (1.0 - Deg(5.0).cos())).abs() < 1e-9);
        let ellipse = (0..=36)
            .map(|index| f64::from(index) * 10.0)
            .map(|angle| Point3::new(40.0 + 7.2 * Deg(angle).cos(), 30.0 + 7.0 * Deg(angle).sin(), -5.0));
        let points: Vec<_> = ellipse.collect();
        let mut run = ChordRun::new(points[0], points[1], Vector3::z_axis());
        let place =
            || (Backtrace { block: gcode_lang::source::Span::default(), calls: None }, Position::default());
        points[2..].iter().for_each(|to| assert!(run.extend(*to, &Vector3::z_axis(), place)));
        assert!(run.finish().is_none(), "0.1 off a circle of 7.1");
    }
}
