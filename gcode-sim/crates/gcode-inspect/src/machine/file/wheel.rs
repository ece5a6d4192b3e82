//! The machine file's `[wheel]`: the contact point of a grinder's wheel, and the axis that swivels it.
use nalgebra::Point3;
use schemars::JsonSchema;
use serde::Deserialize;

use super::{ROTARY_LETTERS, letter, vector};
use crate::machine::{Chain, Head, HeadKind, Wheel};
use gcode_lang::motion::Axes;
use gcode_part::reader::FileError;
use gcode_part::reader::bounds::{Bounded, MachinePoint, Sign};
use gcode_part::reader::{FixedArray, Located, Reader};

/// A grinder's wheel, stationary while the table moves the part.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("anyOf" = [{ "required": ["letter"] }, { "not": { "required": ["sign"] } }]))]
pub(super) struct FileWheel {
    /// Its contact point, machine coordinates, mm.
    contact: FixedArray<Bounded<MachinePoint>, 3>,
    /// The axis that swivels it about that point, A, B or C [default: none].
    #[schemars(extend("enum" = ROTARY_LETTERS))]
    letter: Option<Located<String>>,
    /// 1, or -1 if the axis is reversed [default: 1].
    sign: Option<Sign>,
}

impl FileWheel {
    pub(super) fn check(
        &self,
        reader: &Reader<'_>,
        axes: &Axes,
        table: &Chain,
        head: &Head,
    ) -> Result<Wheel, FileError> {
        let contact = Point3::from(vector(&self.contact));
        let swivels = match (&self.letter, &self.sign) {
            (None, None) => None,
            (None, Some(given)) => {
                return Err(reader.error(given, "key 'wheel.sign' is for 'wheel.letter' only"));
            }
            (Some(name), given) => {
                let axis = letter(reader, "wheel.letter", name, axes)?;
                if !axes.is_rotary(axis) {
                    return Err(reader.error(name, "key 'wheel.letter': the wheel swivels by A, B or C"));
                }
                let of_head = matches!(head.kind, HeadKind::Axis { axis: other, .. } if other == axis);
                if table.has_axis(axis) || of_head {
                    let message = format!(
                        "key 'wheel.letter' is {}, the letter of the table or the head",
                        axes.letter(axis)
                    );
                    return Err(reader.error(name, message));
                }
                Some((axis, given.as_ref().map_or(1.0, |sign| f64::from(sign.get()))))
            }
        };
        Ok(Wheel { contact, swivel_axis: swivels })
    }
}
