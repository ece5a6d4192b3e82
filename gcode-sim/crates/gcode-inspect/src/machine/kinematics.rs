//! The numbers of a five-axis machine that its control has as parameters.
use nalgebra::{Point3, Unit, Vector3};

use super::{AxisLink, Chain, HeadKind, LinkMotion, Machine};
use gcode_lang::control::{Kinematics, RotaryAxis};
use gcode_lang::motion::AxisIndex;

impl Machine {
    /// Returns the rotary axes for the control; `None` if nothing describes them, if the operator sets the head, or if a slide
    /// isn't along its own direction or lies on a rotary axis. A head of unknown direction counts as a spindle along Z.
    pub fn kinematics(&self) -> Option<Kinematics> {
        if self.has_default_table && !matches!(self.head.kind, HeadKind::Axis { .. } | HeadKind::Axes { .. })
        {
            return None;
        }
        let (head, direction) = match &self.head.kind {
            HeadKind::Free => (Vec::new(), Vector3::z_axis()),
            HeadKind::Fixed(direction) => (Vec::new(), *direction),
            HeadKind::Manual { .. } => return None,
            HeadKind::Axis { axis, sign, zero } => {
                let link = AxisLink::rotary(*axis, Vector3::z_axis(), Point3::origin(), *sign);
                let direction = Unit::new_unchecked(Vector3::new(zero.cos(), zero.sin(), 0.0));
                (rotary_axes(&Chain(vec![link]), self)?, direction)
            }
            HeadKind::Axes { chain, direction } => (rotary_axes(chain, self)?, *direction),
        };
        let table = match self.has_default_table {
            true => Vec::new(),
            false => rotary_axes(&self.table, self)?,
        };
        let has_rotary_axis = !table.is_empty() || !head.is_empty();
        has_rotary_axis.then(|| Kinematics {
            table,
            head,
            direction: direction.into_inner().into(),
            pivot: self.head.pivot,
        })
    }
}

/// Returns the rotary axes of a chain; `None` if a slide lies on one of them, or isn't along its own direction. A table that
/// slides moves against the tool.
fn rotary_axes(chain: &Chain, machine: &Machine) -> Option<Vec<RotaryAxis>> {
    let mut rotary = Vec::new();
    for link in &chain.0 {
        match &link.motion {
            LinkMotion::Rotary { about, centre } => rotary.push(RotaryAxis {
                axis: link.axis,
                direction: about.into_inner().into(),
                point: centre.coords.into(),
                sign: link.sign,
            }),
            LinkMotion::Linear { along } => {
                let own = own_direction(machine, link.axis)?;
                if !rotary.is_empty() || (along.into_inner() * link.sign + own).norm() > 1e-9 {
                    return None;
                }
            }
        }
    }
    Some(rotary)
}

fn own_direction(machine: &Machine, axis: AxisIndex) -> Option<Vector3<f64>> {
    match machine.axes.letter(axis) {
        'X' => Some(Vector3::x()),
        'Y' => Some(Vector3::y()),
        'Z' => Some(Vector3::z()),
        _ => None,
    }
}
