//! Chains of axes: each axis rotates or slides what it carries.
use nalgebra::{Point3, Rotation3, Translation3, Unit, Vector3};

use super::Frame;
use super::error::PeriodicError;
use gcode_lang::motion::{Axes, AxisIndex, Position};
use gcode_lang::units::Deg;

/// Axes that carry each other, from the bed outwards.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain(pub Vec<AxisLink>);

/// One axis of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisLink {
    /// Axis of the control.
    pub axis: AxisIndex,
    /// Rotation or translation.
    pub motion: LinkMotion,
    /// Direction of a positive command, 1 or −1.
    pub sign: f64,
    /// Actual minus commanded position of the axis, in the sense of its commands.
    pub error: PeriodicError,
}

/// Motion of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkMotion {
    /// Right-handed rotation, in degrees.
    Rotary {
        /// Direction of the axis.
        about: Unit<Vector3<f64>>,
        /// Point on the axis.
        centre: Point3<f64>,
    },
    /// Translation, in mm.
    Linear {
        /// Direction of the axis.
        along: Unit<Vector3<f64>>,
    },
}

/// Returns a right-handed rotation.
pub(super) fn rotation_about(axis: &Unit<Vector3<f64>>, angle: Deg) -> Rotation3<f64> {
    Rotation3::from_axis_angle(axis, angle.to_rad())
}

impl AxisLink {
    /// Returns a rotary axis without errors.
    pub fn rotary(axis: AxisIndex, about: Unit<Vector3<f64>>, centre: Point3<f64>, sign: f64) -> Self {
        Self { axis, motion: LinkMotion::Rotary { about, centre }, sign, error: PeriodicError::default() }
    }

    /// Returns a linear axis without errors.
    pub fn linear(axis: AxisIndex, along: Unit<Vector3<f64>>, sign: f64) -> Self {
        Self { axis, motion: LinkMotion::Linear { along }, sign, error: PeriodicError::default() }
    }

    /// Returns the actual position of the axis, in the sense of its direction.
    fn value(&self, at: &Position) -> f64 {
        self.sign * (at[self.axis] + self.error.value_at(at[self.axis]))
    }

    /// Returns the frame of what the link carries, for a link whose base is at `frame`.
    fn frame_on(&self, frame: &Frame, at: &Position) -> Frame {
        let value = self.value(at);
        match &self.motion {
            LinkMotion::Rotary { about, centre } => {
                let rotation = rotation_about(about, Deg(value));
                let back = centre.coords - rotation * centre.coords;
                frame * Frame::from_parts(Translation3::from(back), rotation)
            }
            LinkMotion::Linear { along } => frame * Translation3::from(along.into_inner() * value),
        }
    }
}

impl Chain {
    /// Returns the sign of a rotary axis; `None` if the chain has no such axis.
    pub fn rotary_sign(&self, axis: AxisIndex) -> Option<f64> {
        let turns = |link: &&AxisLink| link.axis == axis && matches!(link.motion, LinkMotion::Rotary { .. });
        self.0.iter().find(turns).map(|link| link.sign)
    }

    /// Returns the table of the paper's machine: B, if the control has it, rotates the part about y through
    /// `origin`.
    pub(crate) fn default_table(axes: &Axes, origin: Point3<f64>) -> Self {
        let b = axes.find(b'B').map(|axis| AxisLink::rotary(axis, Vector3::y_axis(), origin, 1.0));
        Self(b.into_iter().collect())
    }

    /// Returns X, Y and Z along their own directions, without those that carry the part.
    pub(crate) fn default_slides(axes: &Axes, table: &Chain) -> Self {
        let letters = [(b'X', Vector3::x_axis()), (b'Y', Vector3::y_axis()), (b'Z', Vector3::z_axis())];
        let slide = |(letter, along)| {
            let axis = axes.find(letter).filter(|axis| !table.has_axis(*axis))?;
            Some(AxisLink::linear(axis, along, 1.0))
        };
        Self(letters.into_iter().filter_map(slide).collect())
    }

    /// Returns the transformation from the frame that the chain carries to the frame of its base.
    pub fn frame(&self, at: &Position) -> Frame {
        self.0.iter().fold(Frame::identity(), |frame, link| link.frame_on(&frame, at))
    }

    /// Returns the origin of the frame that the chain carries, in the frame of its base.
    pub(crate) fn carried_origin(&self, at: &Position) -> Point3<f64> {
        let is_linear = |link: &AxisLink| matches!(link.motion, LinkMotion::Linear { .. });
        if !self.0.iter().all(is_linear) {
            return self.frame(at) * Point3::origin();
        }
        let slide = |point: Point3<f64>, link: &AxisLink| match &link.motion {
            LinkMotion::Linear { along } => point + along.into_inner() * link.value(at),
            LinkMotion::Rotary { .. } => point,
        };
        self.0.iter().fold(Point3::origin(), slide)
    }

    /// Returns the displacement of the slides for a difference of positions; rotary axes are ignored.
    pub fn displacement(&self, by: &Position) -> Vector3<f64> {
        self.0.iter().fold(Vector3::zeros(), |sum, link| match &link.motion {
            LinkMotion::Linear { along } => sum + along.into_inner() * (link.sign * by[link.axis]),
            LinkMotion::Rotary { .. } => sum,
        })
    }

    /// Returns true if the chain contains the axis.
    pub(crate) fn has_axis(&self, axis: AxisIndex) -> bool {
        self.0.iter().any(|link| link.axis == axis)
    }

    /// Returns true if any axis of the chain differs between `a` and `b`.
    pub fn is_moved(&self, a: &Position, b: &Position) -> bool {
        self.0.iter().any(|link| a[link.axis] != b[link.axis])
    }

    /// Returns a point on the line of each rotary axis.
    pub(crate) fn rotation_centres(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.0.iter().filter_map(|link| match &link.motion {
            LinkMotion::Rotary { centre, .. } => Some(centre),
            LinkMotion::Linear { .. } => None,
        })
    }

    /// Returns the rotary axes of the chain.
    pub(crate) fn rotary_axes(&self) -> impl Iterator<Item = AxisIndex> + '_ {
        let turns = self.0.iter().filter(|link| matches!(link.motion, LinkMotion::Rotary { .. }));
        turns.map(|link| link.axis)
    }

    /// Returns the sum of the rotations of all rotary axes between two positions.
    pub(crate) fn total_rotation(&self, a: &Position, b: &Position) -> Deg {
        self.rotary_axes().fold(Deg::ZERO, |sum, axis| sum + Deg(b[axis] - a[axis]).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_rotates_about_its_own_centre() {
        let chain = Chain(vec![AxisLink::rotary(0, Vector3::z_axis(), Point3::new(10.0, 0.0, 0.0), 1.0)]);
        let mut at = Position::default();
        at[0] = 90.0;
        let there = chain.frame(&at) * Point3::new(12.0, 0.0, 5.0);
        assert!((there - Point3::new(10.0, 2.0, 5.0)).norm() < 1e-12, "{there}");
    }

    /// A grinder's table: the slide carries the table, the table carries the part.
    #[test]
    fn a_table_on_a_slide_moves_with_it() {
        let chain = Chain(vec![
            AxisLink::linear(0, Vector3::x_axis(), 1.0),
            AxisLink::rotary(1, Vector3::z_axis(), Point3::origin(), -1.0),
        ]);
        let mut at = Position::default();
        at[0] = 7.0;
        at[1] = 90.0;
        let there = chain.frame(&at) * Point3::new(1.0, 0.0, 0.0);
        assert!((there - Point3::new(7.0, -1.0, 0.0)).norm() < 1e-12, "{there}");
    }
}
