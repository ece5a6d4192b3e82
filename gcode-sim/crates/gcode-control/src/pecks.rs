//! The pecks of G73 and G83: all of Q, or becoming shorter by I, J and K.
use super::state::{CycleState, PeckSchedule};

/// A block with more pecks than this alarms: nobody drills so, and a run must end.
const MAX_PECKS: f64 = 1e6;

/// From R peck by peck until Z; the last peck is what is left.
pub(super) fn for_each_peck((r, z): (f64, f64), data: &CycleState, mut emit: impl FnMut(f64, f64, bool)) {
    let pecks = peck_count(r, z, data);
    let mut last = r;
    let mut count = 1.0;
    while count <= pecks {
        let is_last = count == pecks;
        let next = if is_last { z } else { r + peck_depth(data, count).copysign(z - r) };
        emit(last, next, is_last);
        last = next;
        count += 1.0;
    }
}

/// How deep below R so many pecks lead.
fn peck_depth(data: &CycleState, count: f64) -> f64 {
    let Some(PeckSchedule { first, decrement: less, minimum: least }) = data.pecks else {
        return count * data.q.unwrap_or(0.0).abs();
    };
    // As many pecks as are longer than the shortest, then all as short as that.
    let longer_count = if less > 0.0 { ((first - least) / less + 1e-9).floor() + 1.0 } else { count };
    let shrinking = count.min(longer_count);
    shrinking * first - less * shrinking * (shrinking - 1.0) / 2.0 + (count - shrinking) * least
}

/// How many pecks a hole from R to Z takes.
fn peck_count(r: f64, z: f64, data: &CycleState) -> f64 {
    let total_depth = (z - r).abs();
    if data.pecks.is_none() {
        return match data.q {
            Some(q) if q != 0.0 => (total_depth / q.abs() - 1e-9).ceil().max(1.0),
            _ => 1.0,
        };
    }
    let mut count = 1.0;
    while peck_depth(data, count) < total_depth - 1e-9 && count <= MAX_PECKS {
        count += 1.0;
    }
    count
}

/// Whether a block with so many holes has more pecks than anybody drills.
pub(super) fn has_too_many_pecks(data: &CycleState, holes: u32) -> bool {
    peck_count(data.r_level(), data.z_level(), data) * f64::from(holes.max(1)) > MAX_PECKS
}
