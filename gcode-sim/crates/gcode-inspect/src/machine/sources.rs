//! Error sources: the quantities of a machine and a set-up that can be in error, and their effect on a
//! machine.
use nalgebra::{Unit, Vector3};

use super::error::{Distribution, PeriodicError};
use super::random::RandomStream;
use super::{LinkMotion, Machine, chain};
use gcode_lang::motion::AxisIndex;
use gcode_lang::units::Deg;

/// A quantity that can be in error; directions are counted 0 to 2 for x, y, z of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Actual minus nominal position of the part, with the table at 0.
    Shift(usize),
    /// Tilt of the part from its nominal orientation, about a line through its origin.
    Tilt(usize),
    /// Run-out: the part's centre is off the axis by half of it, in an unknown direction.
    RunOut,
    /// Actual minus commanded position of a linear axis.
    Linear(AxisIndex),
    /// Actual minus commanded angle of the rotary axis.
    Index,
    /// Actual minus nominal position of the rotary axis.
    Centre(usize),
    /// Tilt of the rotary axis from its nominal direction, about a line through its centre.
    AxisTilt(usize),
    /// Actual minus nominal angle of the head.
    Head,
}

/// A quantity and the distribution of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSource {
    /// The quantity.
    pub quantity: Quantity,
    /// Its error, mm or degrees.
    pub distribution: Distribution,
}

/// Parameters from which a group of sources is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SampleParameters {
    pub(super) seed: u64,
    /// Wavelength of the error along a linear axis, mm.
    pub(super) wave: f64,
}

impl Quantity {
    /// Returns the key that names the quantity in a file, such as `part.shift.x`.
    pub fn name(self, machine: &Machine) -> String {
        let letter = |direction: usize| ['x', 'y', 'z'][direction];
        match self {
            Self::Shift(direction) => format!("part.shift.{}", letter(direction)),
            Self::Tilt(direction) => format!("part.tilt.{}", letter(direction)),
            Self::RunOut => "part.runout".to_owned(),
            Self::Linear(axis) => format!("linear.{}", machine.axes.letter(axis).to_ascii_lowercase()),
            Self::Index => "rotary.index".to_owned(),
            Self::Centre(direction) => format!("rotary.centre.{}", letter(direction)),
            Self::AxisTilt(direction) => format!("rotary.tilt.{}", letter(direction)),
            Self::Head => "head.angle".to_owned(),
        }
    }

    /// Returns true for errors of the set-up or of the machine's geometry; the others are drawn anew for each
    /// hole.
    pub(crate) fn is_per_part(self) -> bool {
        !matches!(self, Self::Linear(_) | Self::Index | Self::Head)
    }

    /// Returns the index of the quantity's random numbers in the tree of a seed.
    fn stream_index(self) -> u64 {
        match self {
            Self::Shift(direction) => direction as u64,
            Self::Tilt(direction) => 10 + direction as u64,
            Self::RunOut => 20,
            Self::Linear(axis) => 30 + axis as u64,
            Self::Index => 40,
            Self::Centre(direction) => 50 + direction as u64,
            Self::AxisTilt(direction) => 60 + direction as u64,
            Self::Head => 70,
        }
    }
}

impl ErrorSource {
    /// Draws an error that is the same at every position of the axes, and adds it to the machine.
    pub(crate) fn draw_into(&self, machine: &mut Machine, draw: RandomStream) {
        let draw = draw.branch(self.quantity.stream_index());
        let direction = if self.quantity == Quantity::RunOut { draw.branch(2).angle() } else { Deg::ZERO };
        machine.add_error(self.quantity, self.distribution.sample(draw), direction);
    }

    /// Adds the error of one machine, which for an axis is a function of its position.
    pub(super) fn apply_by_position(&self, machine: &mut Machine, drawn: SampleParameters) {
        let root = RandomStream::new(drawn.seed);
        if self.quantity.is_per_part() {
            return self.draw_into(machine, root);
        }
        let length = if matches!(self.quantity, Quantity::Linear(_)) { drawn.wave } else { 360.0 };
        let draw = root.branch(self.quantity.stream_index());
        machine.set_axis_error(self.quantity, PeriodicError::sample(self.distribution, length, draw));
    }
}

impl Machine {
    /// Returns the one axis that rotates the part; `None` if there are none or several.
    pub(crate) fn rotary_axis(&self) -> Option<AxisIndex> {
        let mut axes = self.table.rotary_axes();
        axes.next().filter(|_| axes.next().is_none())
    }

    /// Resets the errors to those of `nominal`, a machine of the same arrangement, without allocation.
    pub fn reset(&mut self, nominal: &Self) {
        self.part = nominal.part;
        self.head.error = nominal.head.error;
        self.table.0.clone_from_slice(&nominal.table.0);
        self.slides.0.clone_from_slice(&nominal.slides.0);
    }

    /// Returns true if no axis has an error and the part is in its nominal position.
    pub fn is_exact(&self) -> bool {
        let exact = |error: &PeriodicError| error.level == 0.0 && error.amplitude == 0.0;
        let part = self.part.shift == Vector3::zeros() && self.part.tilt == [Deg::ZERO; 3];
        part && exact(&self.head.error)
            && self.table.0.iter().chain(&self.slides.0).all(|link| exact(&link.error))
    }

    /// Adds an error to the machine; `direction` is that of a run-out, about the rotary axis.
    pub(crate) fn add_error(&mut self, quantity: Quantity, value: f64, direction: Deg) {
        match quantity {
            Quantity::Shift(along) => self.part.shift[along] += value,
            Quantity::Tilt(about) => self.part.tilt[about] = self.part.tilt[about] + Deg(value),
            Quantity::RunOut => {
                let Some((about, _)) = self.rotary_axis_mut() else { return };
                let across = perpendicular(about);
                let aside = chain::rotation_about(about, direction) * across;
                self.part.shift += aside * (value / 2.0);
            }
            Quantity::Linear(_) | Quantity::Index | Quantity::Head => {
                self.set_axis_error(quantity, PeriodicError::constant(value));
            }
            Quantity::Centre(along) => {
                if let Some((_, centre)) = self.rotary_axis_mut() {
                    centre[along] += value;
                }
            }
            Quantity::AxisTilt(axis) => {
                let line = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][axis];
                if let Some((about, _)) = self.rotary_axis_mut() {
                    *about = chain::rotation_about(&line, Deg(value)) * *about;
                }
            }
        }
    }

    fn rotary_axis_mut(&mut self) -> Option<(&mut Unit<Vector3<f64>>, &mut nalgebra::Point3<f64>)> {
        let axis = self.rotary_axis()?;
        let link = self.table.0.iter_mut().find(|link| link.axis == axis)?;
        match &mut link.motion {
            LinkMotion::Rotary { about, centre } => Some((about, centre)),
            LinkMotion::Linear { .. } => None,
        }
    }

    /// Sets the error of an axis or of the head; other quantities have none.
    fn set_axis_error(&mut self, quantity: Quantity, error: PeriodicError) {
        let axis = match quantity {
            Quantity::Linear(axis) => Some(axis),
            Quantity::Index => self.rotary_axis(),
            Quantity::Head => {
                self.head.error = error;
                None
            }
            Quantity::Shift(_)
            | Quantity::Tilt(_)
            | Quantity::RunOut
            | Quantity::Centre(_)
            | Quantity::AxisTilt(_) => None,
        };
        let links = self.table.0.iter_mut().chain(&mut self.slides.0);
        links.filter(|link| Some(link.axis) == axis).for_each(|link| link.error = error);
    }
}

/// Returns a unit vector perpendicular to `about`.
fn perpendicular(about: &Unit<Vector3<f64>>) -> Vector3<f64> {
    let other = if about.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    (other - about.into_inner() * about.dot(&other)).normalize()
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::machine::Setup;
    use gcode_lang::motion::Position;

    fn with(quantity: Quantity, value: f64) -> Machine {
        let mut machine = Machine::default();
        machine.add_error(quantity, value, Deg::ZERO);
        machine
    }

    fn tip(machine: &Machine, x: f64, b: f64) -> Point3<f64> {
        let mut at = Position::default();
        at[0] = x;
        at[4] = b;
        machine.forward(&at, &Setup::default()).tip
    }

    fn near(found: Point3<f64>, expected: [f64; 3]) {
        assert!((found - Point3::from(expected)).norm() < 1e-9, "{found} is not {expected:?}");
    }

    /// The tool is at machine x = 100 each time; the expected values are part coordinates, by hand.
    #[test]
    fn each_source_moves_the_tool_on_the_part_as_computed_by_hand() {
        // The part is 0.05 farther in x, so the tool is 0.05 less far on it: at B = 0 in x …
        near(tip(&with(Quantity::Shift(0), 0.05), 100.0, 0.0), [99.95, 0.0, 0.0]);
        // … and at B = 180, where the part's +x points to machine −x, at −100 − 0.05.
        near(tip(&with(Quantity::Shift(0), 0.05), 100.0, 180.0), [-100.05, 0.0, 0.0]);
        near(tip(&with(Quantity::Shift(0), -0.05), 100.0, 180.0), [-99.95, 0.0, 0.0]);
        // X is 0.02 too far.
        near(tip(&with(Quantity::Linear(0), 0.02), 100.0, 0.0), [100.02, 0.0, 0.0]);
        // B is at 90 instead of 89.
        near(tip(&with(Quantity::Index, 1.0), 100.0, 89.0), [0.0, 0.0, 100.0]);
        // B's axis lies at x = 0.3: at 0 that moves nothing, at 180 the part's origin is at x = 0.6.
        near(tip(&with(Quantity::Centre(0), 0.3), 100.0, 0.0), [100.0, 0.0, 0.0]);
        near(tip(&with(Quantity::Centre(0), 0.3), 100.0, 180.0), [-99.4, 0.0, 0.0]);
        // B's axis is tilted by 1° about z, its top towards −x: half a revolution about it tilts the part's
        // own axis by 2°.
        near(tip(&with(Quantity::AxisTilt(2), 1.0), 100.0, 0.0), [100.0, 0.0, 0.0]);
        let (c, s) = (Deg(2.0).cos(), Deg(2.0).sin());
        near(tip(&with(Quantity::AxisTilt(2), 1.0), 100.0, 180.0), [-100.0 * c, -100.0 * s, 0.0]);
        // The part is rotated by 90° about z: machine x is its −y.
        near(tip(&with(Quantity::Tilt(2), 90.0), 100.0, 0.0), [0.0, -100.0, 0.0]);
        // A run-out of 0.4 in the direction 0: the centre is 0.2 off in x.
        near(tip(&with(Quantity::RunOut, 0.4), 100.0, 0.0), [99.8, 0.0, 0.0]);
    }

    #[test]
    fn an_error_of_the_head_angle_moves_the_tip_on_the_pivots_lever() {
        let mut machine = with(Quantity::Head, 0.1);
        machine.head.pivot = 200.0;
        let setup = Setup { head_angle: Some(Deg(90.0)), ..Setup::default() };
        let tip = machine.tool_pose(&Position::default(), &setup).tip;
        // The tool points along 90.1°: its tip is 200 mm below, 200·sin 0.1° to +x.
        near(tip, [200.0 * Deg(0.1).sin(), -200.0 * Deg(0.1).cos(), 0.0]);
    }
}
