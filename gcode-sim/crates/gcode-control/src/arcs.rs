//! G02 and G03: centre and sweep from I J K or from R, in all planes, with any other axes along.
use super::checked::{ExecResult, locate};
use super::linear_motion::Endpoint;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, PlanarArc};
use gcode_lang::program::modes::{Motion, Plane};
use gcode_lang::source::Span;
use gcode_lang::units::Deg;

impl Planner<'_> {
    /// Tells an arc to `goal`.
    pub(super) fn plan_arc(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        endpoint: &Endpoint,
        span: Span,
    ) -> ExecResult<()> {
        let state = &plan.state;
        let plane = locate(self.data.plane_axes(state.modal.plane), span)?;
        let (first, second, stray) = match state.modal.plane {
            Plane::Xy => (b'I', b'J', b'K'),
            Plane::Zx => (b'K', b'I', b'J'),
            Plane::Yz => (b'J', b'K', b'I'),
        };
        let start = (state.programmed[plane.0], state.programmed[plane.1]);
        let end = (endpoint.programmed[plane.0], endpoint.programmed[plane.1]);
        let clockwise = state.modal.motion == Motion::Clockwise;
        let centre = if let Some(radius) = self.data.dimension(block_words, b'R', state)? {
            // R goes before I J K.
            block_words.mark_read(b"IJK");
            if start == end {
                // The start is the end: with R there is nothing to go round.
                if endpoint.programmed != state.programmed {
                    let what = "an arc by R that ends at its start while another axis moves".into();
                    return Err(Alarm::NotSimulated { what }.located_at(span));
                }
                return Ok(());
            }
            locate(self.centre_by_radius(start, end, radius, clockwise), block_words.span(b'R'))?
        } else {
            if self.data.dimension(block_words, stray, state)?.unwrap_or(0.0) != 0.0 {
                return Err(Alarm::PlaneSelect.located_at(block_words.span(stray)));
            }
            let i = self.data.dimension(block_words, first, state)?;
            let j = self.data.dimension(block_words, second, state)?;
            if i.is_none() && j.is_none() {
                return Err(Alarm::NoRadiusOrCentre.located_at(span));
            }
            let (i, j) = (i.unwrap_or(0.0), j.unwrap_or(0.0));
            if i == 0.0 && j == 0.0 {
                return Err(Alarm::NoRadiusOrCentre.located_at(span));
            }
            (start.0 + i, start.1 + j)
        };
        let (radius, sweep) = self.radius_and_sweep(start, end, centre, clockwise, span)?;
        self.push_programmed_arc(plan, block_words, endpoint, plane, centre, sweep, radius, span)
    }

    /// The mean radius and the sweep of an arc, if its end is near enough to the circle of its start.
    fn radius_and_sweep(
        &self,
        start: (f64, f64),
        end: (f64, f64),
        centre: (f64, f64),
        clockwise: bool,
        span: Span,
    ) -> ExecResult<(f64, f64)> {
        let radius = |p: (f64, f64)| libm::hypot(p.0 - centre.0, p.1 - centre.1);
        let (from, to) = (radius(start), radius(end));
        if (from - to).abs() > self.data.settings.arc_tolerance + 1e-9 {
            let alarm =
                Alarm::RadiusTolerance { start: from, end: to, tolerance: self.data.settings.arc_tolerance };
            return Err(alarm.located_at(span));
        }
        Ok(((from + to) / 2.0, sweep(start, end, centre, clockwise)))
    }

    #[expect(clippy::too_many_arguments, reason = "an arc is all of this")]
    fn push_programmed_arc(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        endpoint: &Endpoint,
        plane: (usize, usize),
        centre: (f64, f64),
        sweep: f64,
        radius: f64,
        span: Span,
    ) -> ExecResult<()> {
        let state = &plan.state;
        let (mirrored, round) = state.transform.arc_effect(plane);
        if state.transform.tilt.is_some() {
            return Err(Alarm::NotSimulated { what: "an arc in a tilted plane".into() }.located_at(span));
        }
        let mut centre_point = state.programmed;
        (centre_point[plane.0], centre_point[plane.1]) = centre;
        let middle = self.data.to_machine(state, &centre_point);
        let centre = (middle[plane.0], middle[plane.1]);
        let (radius, sweep) = if round {
            let factor = state.transform.scaling.as_ref().map_or(1.0, |s| s.factor[plane.0].abs());
            (radius * factor, if mirrored { -sweep } else { sweep })
        } else {
            if block_words.has(b'R') {
                return Err(
                    Alarm::NotSimulated { what: "an arc by R under unequal scaling".into() }.located_at(span)
                );
            }
            let (start, end) = (&state.machine, &endpoint.machine);
            let (start, end) = ((start[plane.0], start[plane.1]), (end[plane.0], end[plane.1]));
            self.radius_and_sweep(start, end, centre, (sweep < 0.0) != mirrored, span)?
        };
        let length = radius * sweep.abs().to_radians();
        // F is along the arc; all other axes follow (1403#5 HTG = 0).
        let timed = self.data.path_time(state, length, block_words.has(b'F'));
        let (rate, seconds) = timed.map_err(|alarm| match alarm {
            Alarm::FeedZero | Alarm::NoSpeedForFeed => Alarm::ArcFeedZero.located_at(span),
            other => other.located_at(span),
        })?;
        let arc = PlanarArc { plane, centre, sweep: Deg(sweep) };
        plan.events.push((EventKind::Arc { to: endpoint.machine, arc, rate }, seconds));
        plan.state.machine = endpoint.machine;
        Ok(())
    }

    /// R positive: the arc below 180°; negative: the one above.
    fn centre_by_radius(
        &self,
        start: (f64, f64),
        end: (f64, f64),
        radius: f64,
        clockwise: bool,
    ) -> Result<(f64, f64), Alarm> {
        let (dx, dy) = (end.0 - start.0, end.1 - start.1);
        let chord = libm::hypot(dx, dy);
        let short = chord / 2.0 - radius.abs();
        if radius == 0.0
            || (short > self.data.settings.arc_tolerance
                && self.data.settings.undocumented.small_radius_alarms)
        {
            return Err(Alarm::RadiusTooSmall { radius: radius.abs(), half_chord: chord / 2.0 });
        }
        let height = (radius * radius - chord * chord / 4.0).max(0.0).sqrt();
        // The centre of a short counterclockwise arc lies to the left of the way from start to end.
        let left = if clockwise == (radius < 0.0) { height } else { -height };
        let middle = (start.0 + dx / 2.0, start.1 + dy / 2.0);
        Ok((middle.0 - left * dy / chord, middle.1 + left * dx / chord))
    }
}

/// Degrees from start to end round the centre, counterclockwise positive; a full turn where they coincide.
pub(super) fn sweep(start: (f64, f64), end: (f64, f64), centre: (f64, f64), clockwise: bool) -> f64 {
    if start == end {
        return if clockwise { -360.0 } else { 360.0 };
    }
    let angle = |p: (f64, f64)| Deg::atan2(p.1 - centre.1, p.0 - centre.0).0;
    let rotation = (angle(end) - angle(start)).rem_euclid(360.0);
    match (clockwise, rotation) {
        (true, 0.0) => -360.0,
        (false, 0.0) => 360.0,
        (true, turn) => turn - 360.0,
        (false, turn) => turn,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_counterclockwise_and_three_quarters_clockwise() {
        let (start, end, centre) = ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0));
        assert!((sweep(start, end, centre, false) - 90.0).abs() < 1e-12);
        assert!((sweep(start, end, centre, true) + 270.0).abs() < 1e-12);
        assert_eq!(sweep(start, start, centre, true), -360.0);
    }
}
