//! Arcs by the modal codes: centre or radius, sweep, and the helix beside them.
use super::functions::{ExecResult, locate};
use super::linear_motion::Endpoint;
use super::plan::BlockPlan;
use super::planner::Planner;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, PlanarArc, Position};
use gcode_lang::program::code_facts::Letters;
use gcode_lang::program::modes::{CutterSide, Motion, Plane};
use gcode_lang::units::Deg;

impl Planner<'_> {
    /// Plans an arc to an end point.
    pub(super) fn plan_arc(&self, plan: &mut BlockPlan, endpoint: &Endpoint) -> ExecResult<()> {
        let state = &plan.state;
        let plane = self.locate(self.data.active_plane(state))?;
        let [first, second, stray] = centre_letters(state.modal.plane);
        let start = (state.programmed_position[plane.0], state.programmed_position[plane.1]);
        let end = (endpoint.programmed[plane.0], endpoint.programmed[plane.1]);
        let clockwise = state.modal.motion == Motion::Clockwise;
        if !self.data.settings.alarms_without_centre && !self.words.has_any(b"IJKR") {
            if state.modal.cutter != CutterSide::Off {
                return Err(self.not_simulated("an arc without R and I J K in cutter compensation"));
            }
            return self.locate(self.push_feed(plan, &endpoint.machine));
        }
        let centre = if let Some(radius) = self.dimension(b'R', state)? {
            // R overrides I J K.
            self.words.mark_read(Letters::of(b"IJK"));
            if start == end {
                // An arc by R that ends at its start has no length.
                if endpoint.programmed != state.programmed_position {
                    return Err(
                        self.not_simulated("an arc by R that ends at its start while another axis moves")
                    );
                }
                return Ok(());
            }
            locate(self.centre_by_radius(start, end, radius, clockwise), self.words.span(b'R'))?
        } else {
            if self.dimension(stray, state)?.unwrap_or(0.0) != 0.0 {
                return Err(Alarm::PlaneSelect.located_at(self.words.span(stray)));
            }
            let i = self.dimension(first, state)?;
            let j = self.dimension(second, state)?;
            if i.is_none() && j.is_none() {
                return Err(Alarm::NoRadiusOrCentre.located_at(self.block));
            }
            let (i, j) = (i.unwrap_or(0.0), j.unwrap_or(0.0));
            if i == 0.0 && j == 0.0 {
                return Err(Alarm::NoRadiusOrCentre.located_at(self.block));
            }
            (start.0 + i, start.1 + j)
        };
        let (radius, sweep) = self.radius_and_sweep(start, end, centre, clockwise)?;
        self.push_programmed_arc(plan, endpoint, PlanarArc { plane, centre, sweep }, radius)
    }

    /// Returns the mean radius and the sweep of an arc; an alarm if its end is too far from the circle of its start.
    fn radius_and_sweep(
        &self,
        start: (f64, f64),
        end: (f64, f64),
        centre: (f64, f64),
        clockwise: bool,
    ) -> ExecResult<(f64, Deg)> {
        let radius = |p: (f64, f64)| libm::hypot(p.0 - centre.0, p.1 - centre.1);
        let (from, to) = (radius(start), radius(end));
        if (from - to).abs() > self.data.settings.arc_tolerance + 1e-9 {
            let tolerance = self.data.settings.arc_tolerance;
            return Err(Alarm::RadiusTolerance { start: from, end: to, tolerance }.located_at(self.block));
        }
        Ok(((from + to) / 2.0, Deg(sweep(start, end, centre, clockwise))))
    }

    /// Emits an arc of the programmed path on the machine, with its mirror image and scaling.
    pub(super) fn push_programmed_arc(
        &self,
        plan: &mut BlockPlan,
        endpoint: &Endpoint,
        PlanarArc { plane, centre, sweep }: PlanarArc,
        radius: f64,
    ) -> ExecResult<()> {
        let state = &plan.state;
        let (is_mirrored, is_round) = state.transform.arc_effect(plane);
        if state.controls_tip() {
            return self.push_tip_path(plan, endpoint, Some((PlanarArc { plane, centre, sweep }, radius)));
        }
        if state.transform.tilt.is_some() {
            let arc = PlanarArc { plane, centre, sweep };
            return self.push_arc_in_plane(plan, endpoint, arc, radius);
        }
        let mut centre_point = state.programmed_position;
        (centre_point[plane.0], centre_point[plane.1]) = centre;
        let middle = self.data.to_machine_unrounded(state, &centre_point);
        let centre = (middle[plane.0], middle[plane.1]);
        let (radius, sweep) = if is_round {
            let factor = state.transform.scaling.as_ref().map_or(1.0, |s| s.factor[plane.0].abs());
            (radius * factor, if is_mirrored { -sweep } else { sweep })
        } else {
            if self.words.has(b'R') {
                return Err(self.not_simulated("an arc by R under unequal scaling"));
            }
            let (start, end) = (&state.machine_position, &endpoint.machine);
            let (start, end) = ((start[plane.0], start[plane.1]), (end[plane.0], end[plane.1]));
            self.radius_and_sweep(start, end, centre, (sweep.0 < 0.0) != is_mirrored)?
        };
        self.push_arc(plan, endpoint.machine, PlanarArc { plane, centre, sweep }, radius)
    }

    /// Emits an arc; F is along the arc, and all other axes follow (1403#5 HTG = 0).
    pub(super) fn push_arc(
        &self,
        plan: &mut BlockPlan,
        to: Position,
        arc: PlanarArc,
        radius: f64,
    ) -> ExecResult<()> {
        let length = radius * arc.sweep.0.abs().to_radians();
        let timed = self.data.path_time(&plan.state, length, self.words.has(b'F'));
        let (rate, seconds) = self.locate(timed.map_err(|alarm| match alarm {
            Alarm::FeedZero | Alarm::NoSpeedForFeed => Alarm::ArcFeedZero,
            other => other,
        }))?;
        plan.push_move(EventKind::Arc { to, arc, rate }, seconds);
        Ok(())
    }

    /// Returns the centre of an arc by R: below 180° for a positive R, above for a negative one.
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
        // The centre of a short counterclockwise arc lies to the left of the chord.
        let left = if clockwise == (radius < 0.0) { height } else { -height };
        let middle = (start.0 + dx / 2.0, start.1 + dy / 2.0);
        Ok((middle.0 - left * dy / chord, middle.1 + left * dx / chord))
    }
}

/// Returns the letters of an arc's centre along both axes of a plane, and the one of the third axis.
pub(super) fn centre_letters(plane: Plane) -> [u8; 3] {
    match plane {
        Plane::Xy => *b"IJK",
        Plane::Zx => *b"KIJ",
        Plane::Yz => *b"JKI",
    }
}

/// Returns the degrees from start to end round the centre, counterclockwise positive; 360 if they coincide.
fn sweep(start: (f64, f64), end: (f64, f64), centre: (f64, f64), clockwise: bool) -> f64 {
    if start == end {
        return if clockwise { -360.0 } else { 360.0 };
    }
    let angle = |p: (f64, f64)| Deg::atan2(p.1 - centre.1, p.0 - centre.0).0;
    let rotation = (angle(end) - angle(start)).rem_euclid(360.0);
    match (clockwise, rotation) {
        (true, 0.0) => -360.0,
        (false, 0.0) => 360.0,
        (true, rotation) => rotation - 360.0,
        (false, rotation) => rotation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sweep_of_a_quarter_is_90_or_minus_270_degrees() {
        let (start, end, centre) = ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0));
        assert!((sweep(start, end, centre, false) - 90.0).abs() < 1e-12);
        assert!((sweep(start, end, centre, true) + 270.0).abs() < 1e-12);
        assert_eq!(sweep(start, start, centre, true), -360.0);
    }
}
