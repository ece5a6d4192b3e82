//! Tools far below the part, beside its holes: a table or a vise is there, and nothing says how far away.
use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::rapids::{error_if, format_point};
use crate::findings::BELOW_PART;
use crate::machine::{HeadKind, TOUCH_DEPTH, tool_name};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event};
use gcode_part::{MAX_BREAK_THROUGH, NOISE, Surface, exceeds};

/// Lowest place of each tool that comes too far below the part.
#[derive(Debug, Default)]
pub(super) struct LowPlaces(BTreeMap<Option<u32>, LowPlace>);

/// A place too far below the part.
#[derive(Clone, Debug)]
struct LowPlace {
    backtrace: Backtrace,
    at: Point3<f64>,
    /// Distance below the floor of a stated pocket, or else below the part, mm.
    depth: f64,
    is_below_floor: bool,
}

impl LowPlace {
    fn is_worse_than(&self, other: &Self) -> bool {
        match (self.is_below_floor, other.is_below_floor) {
            (true, false) => true,
            (false, true) => false,
            _ => other.depth < self.depth,
        }
    }
}

impl HoleExtractor<'_> {
    /// Follows the end of a motion below the part. The full diameter has the room of a through hole there, below the part or the
    /// floor that a pocket states.
    pub(super) fn follow_below_part(&mut self, event: &Event<'_>) {
        let is_placed = self.has_left_start || self.positions.is_known(self.machine);
        let body = self.surface.filter(|_| self.metal.holes.is_some() && is_placed);
        // Oblique to the part's axes the bounds of the body say nothing of what is below it.
        let axis = self.pose.axis.filter(|axis| 1.0 - NOISE <= axis.amax());
        let (Some(body), Some(axis)) = (body, axis) else { return };
        let (underside, height) = (lowest(&body, &axis), self.pose.tip.coords.dot(&axis));
        if !exceeds(underside - height, MAX_BREAK_THROUGH) || self.is_above_part(&body) {
            return;
        }
        let point = self.machine.tool_end(self.setup.tool).first().map_or(0.0, |full| full.from);
        let (at, height) = (self.pose.tip + axis.into_inner() * point, height + point);
        let below = underside - height;
        if !exceeds(below, MAX_BREAK_THROUGH) || self.metal.is_below_hole(&at, &axis, |_| true) {
            return;
        }
        let inside = at + axis.into_inner() * (below + 2.0 * TOUCH_DEPTH);
        let floor = self.metal.pockets_at(&inside).map(|pocket| lowest(pocket, &axis)).reduce(f64::min);
        let depth = floor.map(|floor| floor - height);
        // What a pocket states is meant.
        if depth.is_some_and(|depth| depth <= TOUCH_DEPTH) {
            return;
        }
        let below_floor = depth.filter(|depth| exceeds(*depth, MAX_BREAK_THROUGH));
        let place = LowPlace {
            backtrace: event.backtrace(),
            at,
            depth: below_floor.unwrap_or(below),
            is_below_floor: below_floor.is_some(),
        };
        let known = self.low_places.0.entry(self.setup.tool).or_insert_with(|| place.clone());
        if place.is_worse_than(known) {
            *known = place;
        }
    }

    /// Returns true if the tip of a tool that its head inclines is farther out than the part in the direction of the head at 0:
    /// there are no table and no vise.
    fn is_above_part(&self, body: &Surface) -> bool {
        let HeadKind::Axes { direction, .. } = &self.machine.head.kind else { return false };
        let frame = self.machine.part_frame(&self.axis_position);
        let up = frame.rotation.inverse_transform_unit_vector(direction);
        let top = -lowest(body, &-up);
        top < self.pose.tip.coords.dot(&up)
    }

    /// Reports the lowest place of each tool: an error where the floor of a pocket is stated.
    pub(super) fn report_low_places(&mut self) {
        for (tool, place) in std::mem::take(&mut self.low_places).0 {
            let LowPlace { backtrace, at, depth, is_below_floor } = place;
            self.findings.add_in_program(&BELOW_PART, &backtrace, tool.unwrap_or(0), 1, |kind| {
                let what = if is_below_floor { "the floor of its pocket" } else { "the part" };
                let message = format!(
                    "{} goes {depth:.3} mm below {what}, at {}: limit {MAX_BREAK_THROUGH}",
                    tool_name(tool),
                    format_point(&at)
                );
                Diagnostic::new(kind, message)
                    .with_severity(error_if(is_below_floor))
                    .note("below the part are the table, the vise and the parallels")
                    .help("check Z, the tool length and its offset, and the stock")
            });
        }
    }
}

/// Returns the height along a tool of the lowest point of a body's bounds.
pub(super) fn lowest(body: &Surface, axis: &Unit<Vector3<f64>>) -> f64 {
    let [low, high] = body.bounds();
    // A body that is endless along an axis square to the tool has no extent along the tool.
    (0..3)
        .map(|i| if axis[i] == 0.0 { 0.0 } else { axis[i] * if axis[i] < 0.0 { high[i] } else { low[i] } })
        .sum()
}
