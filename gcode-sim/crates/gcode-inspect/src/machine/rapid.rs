//! Path of a rapid of several axes.
use gcode_lang::motion::{MAX_AXES, Position};

/// Path of the axes in a rapid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RapidPath {
    /// Unknown: each axis moves at a rate of its own, and any of them may arrive first.
    #[default]
    Any,
    /// All axes arrive together, on a straight line (LRP, parameter 1401#1).
    Straight,
    /// Each axis moves at its rate until it arrives, mm/min or degrees/min; `None` for an axis of unknown rate.
    Rates([Option<f64>; MAX_AXES]),
}

/// Returns the positions at which an axis arrives, in order of time, if each moves at its own rate; `None` if the rate of
/// an axis that moves is unknown.
pub(crate) fn arrivals(
    rates: &[Option<f64>; MAX_AXES],
    from: &Position,
    to: &Position,
) -> Option<Vec<Position>> {
    let mut minutes = [0.0; MAX_AXES];
    for (axis, rate) in rates.iter().enumerate() {
        let travel = (to[axis] - from[axis]).abs();
        minutes[axis] = if travel == 0.0 { 0.0 } else { travel / (*rate)? };
    }
    let mut times = minutes.to_vec();
    times.retain(|time| 0.0 < *time);
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier <= 1e-9 * *later);
    let at = |time: f64| {
        let mut position = *to;
        for axis in 0..MAX_AXES {
            if time < minutes[axis] {
                position[axis] = from[axis] + (to[axis] - from[axis]) * (time / minutes[axis]);
            }
        }
        position
    };
    let mut path: Vec<Position> = times.into_iter().map(at).collect();
    if let Some(last) = path.last_mut() {
        *last = *to;
    }
    Some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faster_axis_arrives_first_and_stops() {
        let mut rates = [None; MAX_AXES];
        (rates[0], rates[1]) = (Some(10_000.0), Some(5_000.0));
        let to = Position([20.0, 30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let path = arrivals(&rates, &Position::default(), &to).unwrap();
        assert_eq!(path, [Position([20.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), to]);
        let together = Position([20.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(arrivals(&rates, &Position::default(), &together).unwrap(), [together]);
        let up = Position([0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(arrivals(&rates, &Position::default(), &up), None, "Z has no rate");
    }
}
