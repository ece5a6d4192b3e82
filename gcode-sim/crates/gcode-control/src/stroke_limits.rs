//! Stored stroke check 1: no move of a block may lead an axis beyond its limits (parameters 1320 and 1321).
use super::checked::{ExecResult, locate};
use super::data::ControlData;
use super::lookahead::Lookahead;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::StrokeLimits;
use gcode_lang::motion::{EventKind, PlanarArc, Position};
use gcode_lang::units::Deg;

impl ControlData {
    /// What no longer waits: each with its own block.
    pub(super) fn check_ready_moves(&self, lookahead: &Lookahead) -> ExecResult<()> {
        lookahead.ready_events().try_for_each(|(kind, place)| locate(self.check_move(kind), place.block))
    }

    /// Whether a move stays within the stroke, if the control has limits.
    pub(super) fn check_move(&self, kind: &EventKind) -> Result<(), Alarm> {
        self.settings.stroke_limits.as_ref().map_or(Ok(()), |stroke| self.check_event(stroke, kind))
    }

    pub(super) fn check_event(&self, stroke: &StrokeLimits, kind: &EventKind) -> Result<(), Alarm> {
        let Some(to) = kind.end() else { return Ok(()) };
        self.check_point(stroke, to)?;
        if let EventKind::Arc { arc, .. } = kind {
            extremes(arc, to).iter().flatten().try_for_each(|point| self.check_point(stroke, point))?;
        }
        Ok(())
    }

    fn check_point(&self, stroke: &StrokeLimits, point: &Position) -> Result<(), Alarm> {
        for (axis, letter) in self.settings.axes.iter() {
            // An axis that rolls over has no end.
            if self.settings.rolls_over[axis] {
                continue;
            }
            let value = point[axis];
            if let Some(limit) = stroke.max[axis].filter(|limit| value > *limit) {
                return Err(Alarm::Overtravel { letter, is_plus: true, value, limit });
            }
            if let Some(limit) = stroke.min[axis].filter(|limit| value < *limit) {
                return Err(Alarm::Overtravel { letter, is_plus: false, value, limit });
            }
        }
        Ok(())
    }
}

/// Where an arc has its largest and smallest coordinates, of the four places of its circle those it passes; the other
/// axes as at its end.
fn extremes(arc: &PlanarArc, to: &Position) -> [Option<Position>; 4] {
    let (x, y) = (to[arc.plane.0] - arc.centre.0, to[arc.plane.1] - arc.centre.1);
    let radius = libm::hypot(x, y);
    let end = Deg::atan2(y, x).0;
    [(0.0, (1.0, 0.0)), (90.0, (0.0, 1.0)), (180.0, (-1.0, 0.0)), (270.0, (0.0, -1.0))].map(
        |(angle, (cosine, sine))| {
            // Back from the end by less than the sweep.
            let back = (end - angle).rem_euclid(360.0);
            let passed = if arc.sweep.0 > 0.0 { back } else { (360.0 - back).rem_euclid(360.0) };
            (passed < arc.sweep.0.abs()).then(|| {
                let mut point = *to;
                point[arc.plane.0] = arc.centre.0 + radius * cosine;
                point[arc.plane.1] = arc.centre.1 + radius * sine;
                point
            })
        },
    )
}
