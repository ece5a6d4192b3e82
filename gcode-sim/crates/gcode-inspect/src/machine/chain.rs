//! A chain of axes as data: each turns or slides what stands on it.
use nalgebra::{Point3, Rotation3, Translation3, Unit, Vector3};

use super::Frame;
use super::error::PeriodicError;
use gcode_lang::motion::{Axes, AxisIndex, Position};
use gcode_lang::units::Deg;

/// Axes that stand on one another, from the bed outwards.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain(pub Vec<AxisLink>);

/// One axis of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisLink {
    pub axis: AxisIndex,
    pub motion: LinkMotion,
    /// 1 or −1: which way a positive command goes.
    pub sign: f64,
    /// How far beyond its commanded place the axis stands, counted as commands are.
    pub error: PeriodicError,
}

#[derive(Clone, Debug, PartialEq)]
pub enum LinkMotion {
    /// Right-handed about a line through `centre`, in degrees.
    Rotary { about: Unit<Vector3<f64>>, centre: Point3<f64> },
    /// In mm.
    Linear { along: Unit<Vector3<f64>> },
}

/// A right-handed rotation.
pub(super) fn rotation_about(axis: &Unit<Vector3<f64>>, angle: Deg) -> Rotation3<f64> {
    Rotation3::from_axis_angle(axis, angle.to_rad())
}

impl AxisLink {
    pub fn rotary(axis: AxisIndex, about: Unit<Vector3<f64>>, centre: Point3<f64>, sign: f64) -> Self {
        Self { axis, motion: LinkMotion::Rotary { about, centre }, sign, error: PeriodicError::default() }
    }

    pub fn linear(axis: AxisIndex, along: Unit<Vector3<f64>>, sign: f64) -> Self {
        Self { axis, motion: LinkMotion::Linear { along }, sign, error: PeriodicError::default() }
    }

    /// Where what stands on the link is, on a link that stands at `frame`.
    fn frame_on(&self, frame: &Frame, at: &Position) -> Frame {
        let value = self.sign * (at[self.axis] + self.error.value_at(at[self.axis]));
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
    /// The sign of an axis that turns; `None` where the chain has no such axis.
    pub fn rotary_sign(&self, axis: AxisIndex) -> Option<f64> {
        let turns = |link: &&AxisLink| link.axis == axis && matches!(link.motion, LinkMotion::Rotary { .. });
        self.0.iter().find(turns).map(|link| link.sign)
    }

    /// The table of the paper's machine: B turns the part about y through its origin, if the control has a B.
    pub fn default_table(axes: &Axes, origin: Point3<f64>) -> Self {
        let b = axes.find(b'B').map(|axis| AxisLink::rotary(axis, Vector3::y_axis(), origin, 1.0));
        Self(b.into_iter().collect())
    }

    /// X Y Z along their own directions, without those that carry the part.
    pub fn default_slides(axes: &Axes, table: &Chain) -> Self {
        let letters = [(b'X', Vector3::x_axis()), (b'Y', Vector3::y_axis()), (b'Z', Vector3::z_axis())];
        let found = letters.into_iter().filter_map(|(letter, along)| Some((axes.find(letter)?, along)));
        Self(
            found
                .filter(|(axis, _)| !table.has_axis(*axis))
                .map(|(axis, along)| AxisLink::linear(axis, along, 1.0))
                .collect(),
        )
    }

    /// From what stands on the chain to what the chain stands on.
    pub fn frame(&self, at: &Position) -> Frame {
        self.0.iter().fold(Frame::identity(), |frame, link| link.frame_on(&frame, at))
    }

    /// How far the slides of the chain go for a difference of positions; what turns is left out.
    pub fn displacement(&self, by: &Position) -> Vector3<f64> {
        self.0.iter().fold(Vector3::zeros(), |sum, link| match &link.motion {
            LinkMotion::Linear { along } => sum + along.into_inner() * (link.sign * by[link.axis]),
            LinkMotion::Rotary { .. } => sum,
        })
    }

    pub fn has_axis(&self, axis: AxisIndex) -> bool {
        self.0.iter().any(|link| link.axis == axis)
    }

    /// Whether any axis of the chain stands differently in `b` than in `a`.
    pub fn is_moved(&self, a: &Position, b: &Position) -> bool {
        self.0.iter().any(|link| a[link.axis] != b[link.axis])
    }

    /// A point of each axis about which it turns.
    pub fn rotation_centres(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.0.iter().filter_map(|link| match &link.motion {
            LinkMotion::Rotary { centre, .. } => Some(centre),
            LinkMotion::Linear { .. } => None,
        })
    }

    /// The axes that turn what stands on the chain.
    pub fn rotary_axes(&self) -> impl Iterator<Item = AxisIndex> + '_ {
        let turns = self.0.iter().filter(|link| matches!(link.motion, LinkMotion::Rotary { .. }));
        turns.map(|link| link.axis)
    }

    /// The sum of the angles its rotary axes turn by between two positions.
    pub fn total_rotation(&self, a: &Position, b: &Position) -> Deg {
        let turns = self.0.iter().filter(|link| matches!(link.motion, LinkMotion::Rotary { .. }));
        turns.fold(Deg::ZERO, |sum, link| sum + Deg(b[link.axis] - a[link.axis]).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_turns_about_its_own_centre() {
        let chain = Chain(vec![AxisLink::rotary(0, Vector3::z_axis(), Point3::new(10.0, 0.0, 0.0), 1.0)]);
        let mut at = Position::default();
        at[0] = 90.0;
        let there = chain.frame(&at) * Point3::new(12.0, 0.0, 5.0);
        assert!((there - Point3::new(10.0, 2.0, 5.0)).norm() < 1e-12, "{there}");
    }

    /// A grinder's table: the slide carries the table, the table carries the part.
    #[test]
    fn what_stands_on_a_slide_moves_with_it() {
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
