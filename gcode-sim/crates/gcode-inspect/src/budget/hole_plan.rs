//! Planned position of the axes for a hole, and the resulting hole on a machine with errors.
use nalgebra::{Point3, Unit, Vector3};

use super::BudgetError;
use crate::machine::{HeadKind, LinkMotion, Machine, Setup};
use crate::verify::Deviation;
use gcode_lang::motion::Position;
use gcode_lang::units::Deg;
use gcode_part::Hole;

/// Positions of the axes at the start and at the end of the feed, rounded to the increment as the control
/// does.
#[derive(Clone, Debug)]
pub(super) struct HolePlan<'h> {
    nominal: &'h Hole,
    start: Position,
    end: Position,
    setup: Setup,
}

impl<'h> HolePlan<'h> {
    pub(super) fn new(machine: &Machine, nominal: &'h Hole, clearance: f64) -> Result<Self, BudgetError> {
        let id = nominal.id.clone().unwrap_or_default();
        Self::find(machine, nominal, clearance).ok_or(BudgetError::OutOfReach { id })
    }

    fn find(machine: &Machine, nominal: &'h Hole, clearance: f64) -> Option<Self> {
        let (entry, out) = (Point3::from(nominal.entry), Unit::new_normalize(Vector3::from(nominal.axis)));
        let tool = machine.tools.last().map(|tool| tool.number);
        let mut setup = Setup { tool, ..Setup::default() };
        let reach =
            |height: f64, setup: &Setup| machine.inverse(entry + out.into_inner() * height, out, setup);
        // Of the two table positions the program uses the one on the side of +x.
        let ends = reach(-nominal.depth, &setup).into_iter();
        let end = ends.reduce(|best, other| if other[0] > best[0] { other } else { best })?;
        let direction = machine.part_frame(&end).rotation * out.into_inner();
        if machine.head.is_set_by_hand() {
            setup.head_angle = Some(Deg::atan2(direction.y, direction.x));
        }
        let start =
            reach(clearance, &setup).into_iter().find(|start| !machine.table.is_moved(start, &end))?;
        let [start, end] = [start, end].map(|at| round_position(machine, &setup, at));
        Some(Self { nominal, start, end, setup })
    }

    pub(super) fn id(&self) -> String {
        self.nominal.id.clone().unwrap_or_default()
    }

    /// Returns the deviation of the hole that this machine makes; `None` if its axis is across the nominal
    /// one.
    ///
    /// Its axis is that of the tool if known, else that of the feed, as in [`crate::holes`].
    pub(super) fn deviation(&self, machine: &Machine) -> Option<Deviation> {
        let frame = machine.part_frame(&self.end);
        let [start, end] =
            [&self.start, &self.end].map(|at| machine.tool_pose(at, &self.setup).relative_to(&frame));
        let axis = end.axis.or_else(|| Unit::try_new(start.tip - end.tip, 1e-9))?;
        Deviation::new(self.nominal, &end.tip, &axis)
    }

    pub(super) fn position_deviation(&self, machine: &Machine) -> f64 {
        self.deviation(machine).map_or(f64::INFINITY, |deviation| deviation.zone_diameter())
    }
}

/// Rounds a position as the control does. A head that is an axis is at its rounded angle before the program
/// computes the tip.
fn round_position(machine: &Machine, setup: &Setup, mut at: Position) -> Position {
    let increment = machine.increment.size();
    // Rounding errors of the arithmetic must not decide a half increment.
    let round = |value: f64| ((value / increment * 1e6).round() / 1e6).round() * increment;
    if let HeadKind::Axis { axis, .. } = machine.head.kind {
        let tip = machine.tool_pose(&at, setup).tip;
        at[axis] = round(at[axis]);
        let missing = tip - machine.tool_pose(&at, setup).tip;
        for link in &machine.slides.0 {
            if let LinkMotion::Linear { along } = &link.motion {
                at[link.axis] += link.sign * along.dot(&missing);
            }
        }
    }
    at.0.iter_mut().for_each(|value| *value = round(*value));
    at
}
