//! Why the contact is off the tooth bottom: between the programmed points alone, or at these too, and by what they are off.
use crate::flutes::{GrindingPass, Sample};
use gcode_part::Flutes;

/// What explains where the contact of a pass is, at its programmed points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cause {
    /// They are on the tooth bottom: it is off between them.
    BetweenPoints,
    /// It is above the tooth bottom by so much all along, mm.
    Depth(f64),
    /// The burr is turned about another place than the C axis: the program has the burr's end farther from it by that much,
    /// x and y, mm.
    Offset([f64; 2]),
    /// None of these.
    Other,
}

/// Programmed points that are off by no more than this part of the most are on the tooth bottom.
const ON_SURFACE_SHARE: f64 = 0.5;

/// What explains them leaves this part of the most at most.
const RESIDUAL_SHARE: f64 = 0.2;

impl Cause {
    /// `most`: the largest distance of the pass from the tooth bottom, mm.
    pub(super) fn of(wanted: &Flutes, pass: &GrindingPass, largest_deviation: f64) -> Self {
        let points: Vec<&Sample> = pass.trace.programmed_points().collect();
        let largest = points.iter().map(|point| point.deviation.abs()).fold(0.0, f64::max);
        if largest <= (ON_SURFACE_SHARE * largest_deviation).max(wanted.surface_tolerance) {
            return Self::BetweenPoints;
        }
        // At C the arc's centre is d − Rot(C)·d away, d what the offset is off by: of that Y leaves the surface,
        // dy·(1 − cos C) − dx·sin C. The polar angle of the contact is 90° − C.
        let of_x = |point: &Sample| -point.polar.cos();
        let of_y = |point: &Sample| 1.0 - point.polar.sin();
        let is_explained = |by: &dyn Fn(&Sample) -> f64| {
            points.iter().all(|point| (point.deviation - by(point)).abs() <= RESIDUAL_SHARE * largest)
        };
        let sum = |f: &dyn Fn(&Sample) -> f64| points.iter().map(|point| f(point)).sum::<f64>();
        let depth = sum(&|p| p.deviation) / points.len() as f64;
        if is_explained(&|_| depth) {
            return Self::Depth(depth);
        }
        let (xx, xy, yy) =
            (sum(&|p| of_x(p) * of_x(p)), sum(&|p| of_x(p) * of_y(p)), sum(&|p| of_y(p) * of_y(p)));
        let (x, y) = (sum(&|p| of_x(p) * p.deviation), sum(&|p| of_y(p) * p.deviation));
        let square = xx * yy - xy * xy;
        // One direction alone, then both: more numbers fit more.
        let alone = [[x / xx, 0.0], [0.0, y / yy]];
        let both = [(x * yy - y * xy) / square, (y * xx - x * xy) / square];
        let fits = |d: &[f64; 2]| is_explained(&|p| d[0] * of_x(p) + d[1] * of_y(p));
        let by = alone.into_iter().find(fits).or(Some(both).filter(|both| 5 <= points.len() && fits(both)));
        // What is off by more is another mistake, and the formula above is for what is small against the radius.
        match by.filter(|by| libm::hypot(by[0], by[1]) <= wanted.profile.radius()) {
            Some(by) => Self::Offset(by),
            None => Self::Other,
        }
    }
}
