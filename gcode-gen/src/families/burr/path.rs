//! The points of one flute as axis positions: along the cylinder, then arc by arc to the tip.
use gcode_lang::units::Deg;
use gcode_part::job::Burr;

use super::law::Flute;
use super::nose::{arcs, cylinder};

/// Axis positions at the end of a move, with the signs of the formulas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
    /// A from the flute's start.
    pub(super) a: Deg,
    pub(super) c: Deg,
    /// Length of the contact's path from the previous point, on the burr.
    pub(super) path_length: f64,
}

/// Returns the part of a chord error left after rounding: Y is rounded by up to half an increment, while C is
/// on its grid before X, Y and A are computed.
fn usable_chord_error(chord_error: f64, job: &Burr) -> f64 {
    chord_error - job.control.increment.size() / 2.0
}

/// Returns the points of the longest moves within a chord error. The first is where the wheel plunges; A
/// counts from it.
pub(super) fn points(job: &Burr, chord_error: f64) -> Vec<Point> {
    let shape = &job.shape;
    let [offset_x, offset_y] = job.grinder.c_offset;
    let helix = Deg(job.helix);
    let long = cylinder(job);
    let mut points = vec![Point { x: -long, y: 0.0, a: Deg(0.0), c: Deg(0.0), path_length: 0.0 }];
    let turned = Deg::from_rad(long * helix.tan() / shape.radius);
    if 0.0 < long {
        points.push(Point { x: 0.0, y: 0.0, a: turned, c: Deg(0.0), path_length: long / helix.cos() });
    }
    let mut start_angle = turned;
    for arc in arcs(job) {
        let flute = Flute { law: job.law, helix, arc };
        let (mut c, mut a) = (arc.from, start_angle);
        while c < arc.to {
            let step = flute.step(c, usable_chord_error(chord_error, job));
            // A step below the grid would not move C.
            let next = Deg(job.control.increment.round(c.0 + step.0).max(c.0 + job.control.increment.size()));
            let turn = start_angle + flute.turn(next);
            let middle = arc.station(Deg((c.0 + next.0) / 2.0)).radius;
            let along = arc.radius * (next - c).to_rad();
            let around = middle * (turn - a).to_rad();
            let [x, y] = arc.carried(next);
            points.push(Point {
                x: offset_x - x,
                y: offset_y - shape.radius + arc.radius - y,
                a: turn,
                c: next,
                path_length: (along * along + around * around).sqrt(),
            });
            (c, a) = (next, turn);
        }
        start_angle = a;
    }
    points
}

/// Returns the Y at which no point of the burr is lower than the clearance and the blank's depth above the
/// wheel's contact, at any C up to the end of the flute.
///
/// The burr's lowest point is where its normal points down, which is its contact while it is ground; so Y is
/// the largest value along the flute. A nose of arcs lies within a ball of the cylinder's radius with the
/// same pole.
pub(super) fn clearance_y(job: &Burr) -> f64 {
    let shape = &job.shape;
    let [offset_x, y] = job.grinder.c_offset;
    let x = offset_x - (super::nose::tip(shape) - shape.radius);
    let end = Deg(job.control.increment.round(90.0 - shape.tip_angle));
    let at_end = y - y * end.cos() - x * end.sin();
    let highest = Deg::atan2(-x, -y);
    let between = (x != 0.0 || y != 0.0) && 0.0 < highest.0 && highest < end;
    let top = if between { y + (x * x + y * y).sqrt() } else { at_end.max(0.0) };
    top + stand_off(job)
}

/// Returns the distance from the tooth bottom at which rapid changes to feed.
pub(super) fn stand_off(job: &Burr) -> f64 {
    job.grinder.clearance() + job.shape.tooth_depth
}
