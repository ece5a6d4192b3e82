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
    Turn { about: Unit<Vector3<f64>>, centre: Point3<f64> },
    /// In mm.
    Slide { along: Unit<Vector3<f64>> },
}

/// A right-handed rotation.
pub(super) fn turn(about: &Unit<Vector3<f64>>, angle: Deg) -> Rotation3<f64> {
    Rotation3::from_axis_angle(about, angle.to_rad())
}

impl AxisLink {
    pub fn turn(axis: AxisIndex, about: Unit<Vector3<f64>>, centre: Point3<f64>, sign: f64) -> Self {
        Self { axis, motion: LinkMotion::Turn { about, centre }, sign, error: PeriodicError::default() }
    }

    pub fn slide(axis: AxisIndex, along: Unit<Vector3<f64>>, sign: f64) -> Self {
        Self { axis, motion: LinkMotion::Slide { along }, sign, error: PeriodicError::default() }
    }

    /// Where what stands on the link is, on a link that stands at `frame`.
    fn on(&self, frame: &Frame, at: &Position) -> Frame {
        let value = self.sign * (at[self.axis] + self.error.at(at[self.axis]));
        match &self.motion {
            LinkMotion::Turn { about, centre } => {
                let rotation = turn(about, Deg(value));
                let back = centre.coords - rotation * centre.coords;
                frame * Frame::from_parts(Translation3::from(back), rotation)
            }
            LinkMotion::Slide { along } => frame * Translation3::from(along.into_inner() * value),
        }
    }
}

impl Chain {
    /// The sign of an axis that turns; `None` where the chain has no such axis.
    pub fn turns(&self, axis: AxisIndex) -> Option<f64> {
        let turns = |link: &&AxisLink| link.axis == axis && matches!(link.motion, LinkMotion::Turn { .. });
        self.0.iter().find(turns).map(|link| link.sign)
    }

    /// The table of the paper's machine: B turns the part about y through its origin, if the control has a B.
    pub fn of_the_paper(axes: &Axes, origin: Point3<f64>) -> Self {
        let b = axes.find(b'B').map(|axis| AxisLink::turn(axis, Vector3::y_axis(), origin, 1.0));
        Self(b.into_iter().collect())
    }

    /// X Y Z along their own directions, without those that carry the part.
    pub fn slides(axes: &Axes, table: &Chain) -> Self {
        let letters = [(b'X', Vector3::x_axis()), (b'Y', Vector3::y_axis()), (b'Z', Vector3::z_axis())];
        let found = letters.into_iter().filter_map(|(letter, along)| Some((axes.find(letter)?, along)));
        Self(
            found
                .filter(|(axis, _)| !table.has(*axis))
                .map(|(axis, along)| AxisLink::slide(axis, along, 1.0))
                .collect(),
        )
    }

    /// From what stands on the chain to what the chain stands on.
    pub fn frame(&self, at: &Position) -> Frame {
        self.0.iter().fold(Frame::identity(), |frame, link| link.on(&frame, at))
    }

    /// How far the slides of the chain go for a difference of positions; what turns is left out.
    pub fn displacement(&self, by: &Position) -> Vector3<f64> {
        self.0.iter().fold(Vector3::zeros(), |sum, link| match &link.motion {
            LinkMotion::Slide { along } => sum + along.into_inner() * (link.sign * by[link.axis]),
            LinkMotion::Turn { .. } => sum,
        })
    }

    pub fn has(&self, axis: AxisIndex) -> bool {
        self.0.iter().any(|link| link.axis == axis)
    }

    /// Whether any axis of the chain stands differently in `b` than in `a`.
    pub fn differs(&self, a: &Position, b: &Position) -> bool {
        self.0.iter().any(|link| a[link.axis] != b[link.axis])
    }

    /// A point of each axis about which it turns.
    pub fn centres(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.0.iter().filter_map(|link| match &link.motion {
            LinkMotion::Turn { centre, .. } => Some(centre),
            LinkMotion::Slide { .. } => None,
        })
    }

    /// The axes that turn what stands on the chain.
    pub fn turning(&self) -> impl Iterator<Item = AxisIndex> + '_ {
        let turns = self.0.iter().filter(|link| matches!(link.motion, LinkMotion::Turn { .. }));
        turns.map(|link| link.axis)
    }

    /// The sum of the angles its rotary axes turn by between two positions.
    pub fn turned(&self, a: &Position, b: &Position) -> Deg {
        let turns = self.0.iter().filter(|link| matches!(link.motion, LinkMotion::Turn { .. }));
        turns.fold(Deg::ZERO, |sum, link| sum + Deg(b[link.axis] - a[link.axis]).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_turns_about_its_own_centre() {
        let chain = Chain(vec![AxisLink::turn(0, Vector3::z_axis(), Point3::new(10.0, 0.0, 0.0), 1.0)]);
        let mut at = Position::default();
        at[0] = 90.0;
        let there = chain.frame(&at) * Point3::new(12.0, 0.0, 5.0);
        assert!((there - Point3::new(10.0, 2.0, 5.0)).norm() < 1e-12, "{there}");
    }

    /// A grinder's table: the slide carries the table, the table carries the part.
    #[test]
    fn what_stands_on_a_slide_moves_with_it() {
        let chain = Chain(vec![
            AxisLink::slide(0, Vector3::x_axis(), 1.0),
            AxisLink::turn(1, Vector3::z_axis(), Point3::origin(), -1.0),
        ]);
        let mut at = Position::default();
        at[0] = 7.0;
        at[1] = 90.0;
        let there = chain.frame(&at) * Point3::new(1.0, 0.0, 0.0);
        assert!((there - Point3::new(7.0, -1.0, 0.0)).norm() < 1e-12, "{there}");
    }
}
