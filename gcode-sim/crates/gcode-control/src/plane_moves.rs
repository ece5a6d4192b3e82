//! Arcs and machine planes under a tilted plane: an arc stays one where the plane is that of two machine axes.
use super::functions::ExecResult;
use super::kinematics::{cross, dot, remove_noise};
use super::linear_motion::Endpoint;
use super::lookahead::AskewPlane;
use super::plan::BlockPlan;
use super::plane_arc::{chord_count, point_of_arc};
use super::planner::Planner;
use super::state::State;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, EventKind, PlanarArc, Position};
use gcode_lang::units::Deg;

/// Directions with a smaller component square to a machine plane lie in it.
const IN_PLANE: f64 = 1e-9;

impl State {
    /// Returns the two machine axes in whose plane that of two programmed axes lies, in right-handed order, and −1 if it is
    /// seen there from behind; `None` if the plane of a tilted plane's axes is askew.
    pub(super) fn machine_plane(
        &self,
        plane: (AxisIndex, AxisIndex),
    ) -> Option<((AxisIndex, AxisIndex), f64)> {
        let Some(tilt) = &self.transform.tilt else { return Some((plane, 1.0)) };
        let first = self.transform.direction_in_plane(tilt, plane.0);
        let second = self.transform.direction_in_plane(tilt, plane.1);
        let normal = (0..3).find(|k| first[*k].abs() < IN_PLANE && second[*k].abs() < IN_PLANE)?;
        let axes = (tilt.axes[(normal + 1) % 3], tilt.axes[(normal + 2) % 3]);
        Some((axes, cross(first, second)[normal].signum()))
    }

    /// Returns the directions of a tilted plane; `None` if the plane of two programmed axes is that of two machine axes.
    pub(super) fn askew_plane(&self, plane: (AxisIndex, AxisIndex)) -> Option<AskewPlane> {
        let tilt = self.transform.tilt.as_ref().filter(|_| self.machine_plane(plane).is_none())?;
        let rotation = match &tilt.alignment {
            Some(alignment) => alignment.frame.rotation.after(&tilt.plane.matrix),
            None => tilt.plane.matrix,
        };
        Some(AskewPlane::new(tilt.axes, rotation))
    }
}

impl State {
    /// Returns a point at the height of another one along a programmed axis.
    pub(super) fn at_level_of(&self, axis: AxisIndex, mut point: Position, level: &Position) -> Position {
        let Some(tilt) = &self.transform.tilt else {
            point[axis] = level[axis];
            return point;
        };
        let direction = self.transform.direction_in_plane(tilt, axis);
        let height = dot(direction, tilt.axes.map(|axis| level[axis] - point[axis]));
        for (axis, part) in tilt.axes.into_iter().zip(direction) {
            point[axis] = remove_noise(point[axis] + part * height);
        }
        point
    }
}

impl Planner<'_> {
    /// Emits an arc of a tilted plane: an arc in a plane of two machine axes, otherwise chords; for the lookahead an arc in the
    /// plane's coordinates.
    pub(super) fn push_arc_in_plane(
        &self,
        plan: &mut BlockPlan,
        endpoint: &Endpoint,
        arc: PlanarArc,
        radius: f64,
    ) -> ExecResult<()> {
        let state = &plan.state;
        if state.transform.mirrored_axes != 0 || state.transform.scaling.is_some() {
            return Err(self.not_simulated("an arc in a tilted plane with mirror image or scaling"));
        }
        let start = state.programmed_position;
        let PlanarArc { plane, centre, sweep } = arc;
        if let Some((axes, side)) = state.machine_plane(plane) {
            let mut middle = start;
            (middle[plane.0], middle[plane.1]) = centre;
            let middle = self.data.to_machine_unrounded(state, &middle);
            let arc = PlanarArc {
                plane: axes,
                centre: (middle[axes.0], middle[axes.1]),
                sweep: Deg(sweep.0 * side),
            };
            return self.push_arc(plan, endpoint.machine, arc, radius);
        }
        let length = radius * sweep.0.abs().to_radians();
        let timed = self.data.path_time(state, length, self.words.has(b'F'));
        let (rate, seconds) = timed.map_err(|_| Alarm::ArcFeedZero.located_at(self.block))?;
        if let (Some(askew), true) = (state.askew_plane(plane), self.leads_through_lookahead(plan)?) {
            let mut middle = start;
            (middle[plane.0], middle[plane.1]) = centre;
            let middle = askew.in_plane(&self.data.to_machine_unrounded(state, &middle));
            let arc = PlanarArc { plane, centre: (middle[plane.0], middle[plane.1]), sweep };
            plan.push_move(EventKind::Arc { to: endpoint.machine, arc, rate }, seconds);
            return Ok(());
        }
        let chords = chord_count(radius, sweep, self.data.settings.chord_tolerance);
        for chord in 1..chords {
            let fraction = f64::from(chord) / f64::from(chords);
            let point = point_of_arc(&start, &endpoint.programmed, &arc, fraction);
            let to = self.data.to_machine_unrounded(&plan.state, &point);
            plan.push_move(EventKind::Feed { to, rate }, seconds / f64::from(chords));
        }
        plan.push_move(EventKind::Feed { to: endpoint.machine, rate }, seconds / f64::from(chords));
        Ok(())
    }
}
