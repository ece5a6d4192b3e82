//! Cause of a contact off the tooth bottom: between the programmed points only, or a common error of these.
use crate::flutes::{GrindingPass, Sample};
use gcode_part::Flutes;

/// Cause of the contact's distance from the tooth bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cause {
    /// The programmed points are on the tooth bottom; the contact leaves it between them.
    BetweenPoints,
    /// Constant height above the tooth bottom, mm.
    Depth(f64),
    /// Offset of the burr's end from the C axis: programmed − actual, x and y, mm.
    Offset([f64; 2]),
    /// None of these.
    Other,
}

/// Share of the largest distance up to which a programmed point is on the tooth bottom.
const ON_SURFACE_SHARE: f64 = 0.5;

/// Share of the largest distance that a cause may leave unexplained.
const RESIDUAL_SHARE: f64 = 0.2;

impl Cause {
    /// `largest_deviation`: largest distance of the pass from the tooth bottom, mm.
    pub(super) fn of(nominal: &Flutes, pass: &GrindingPass, largest_deviation: f64) -> Self {
        let points: Vec<&Sample> = pass.trace.programmed_points().collect();
        let largest = points.iter().map(|point| point.deviation.abs()).fold(0.0, f64::max);
        if largest <= (ON_SURFACE_SHARE * largest_deviation).max(nominal.surface_tolerance) {
            return Self::BetweenPoints;
        }
        // At C the arc's centre is off by d − Rot(C)·d, where d is the error of the offset; in Y that is
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
        // One direction alone first: two numbers fit more.
        let alone = [[x / xx, 0.0], [0.0, y / yy]];
        let both = [(x * yy - y * xy) / square, (y * xx - x * xy) / square];
        let fits = |d: &[f64; 2]| is_explained(&|p| d[0] * of_x(p) + d[1] * of_y(p));
        let by = alone.into_iter().find(fits).or(Some(both).filter(|both| 5 <= points.len() && fits(both)));
        // The formula holds for offsets that are small compared with the radius.
        match by.filter(|by| libm::hypot(by[0], by[1]) <= nominal.profile.radius()) {
            Some(by) => Self::Offset(by),
            None => Self::Other,
        }
    }
}
