//! The machine file's `[head]`: what kind it is, and which keys go with that.
use nalgebra::{Unit, Vector3};
use serde::Deserialize;
use toml::Spanned;

use super::{letter, sign};
use crate::job::JobError;
use crate::job::reader::Reader;
use crate::machine::{Chain, Head, HeadKind};
use crate::motion::Axes;
use crate::units::Deg;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileHead {
    kind: Spanned<String>,
    pivot: Option<Spanned<f64>>,
    direction: Option<Spanned<[f64; 3]>>,
    letter: Option<Spanned<String>>,
    sign: Option<Spanned<i64>>,
    zero: Option<Spanned<f64>>,
    angle: Option<Spanned<f64>>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Free,
    Fixed,
    Manual,
    Axis,
}

const KINDS: [(&str, Kind); 4] =
    [("free", Kind::Free), ("fixed", Kind::Fixed), ("manual", Kind::Manual), ("axis", Kind::Axis)];

impl FileHead {
    pub(super) fn check(&self, reader: &Reader<'_>, axes: &Axes, table: &Chain) -> Result<Head, JobError> {
        let kind = reader.choice("head.kind", &self.kind, &KINDS)?;
        self.only_for(reader, kind)?;
        let pivot = match &self.pivot {
            Some(pivot) => reader.number("head.pivot", pivot, "mm, 0 or more", |v| v >= 0.0)?,
            None => 0.0,
        };
        let angle = |key: &str, value: &Spanned<f64>| {
            reader.number(key, value, "degrees from -360 to 360", |v| v.abs() <= 360.0).map(Deg)
        };
        let needs = |key: &str| {
            reader.error(&self.kind, format!("kind = \"{}\" needs the key 'head.{key}'", self.kind.as_ref()))
        };
        let kind = match kind {
            Kind::Free => HeadKind::Free,
            Kind::Fixed => {
                let direction = self.direction.as_ref().ok_or_else(|| needs("direction"))?;
                let unit =
                    Unit::try_new(Vector3::from(*direction.as_ref()), 1e-9).filter(|u| u.norm().is_finite());
                let allowed = "key 'head.direction' is [x, y, z] from the tip to the spindle, not all 0";
                HeadKind::Fixed(unit.ok_or_else(|| reader.error(direction, allowed))?)
            }
            Kind::Manual => {
                HeadKind::Manual { start: self.angle.as_ref().map(|a| angle("head.angle", a)).transpose()? }
            }
            Kind::Axis => {
                let value = self.letter.as_ref().ok_or_else(|| needs("letter"))?;
                let axis = letter(reader, "head.letter", value, axes)?;
                if !axes.is_rotary(axis) {
                    return Err(reader.error(value, "key 'head.letter': the head turns by A, B or C"));
                }
                if table.has(axis) {
                    let message = format!("key 'head.letter' is {}, which is the table's", axes.letter(axis));
                    return Err(reader.error(value, message));
                }
                HeadKind::Axis {
                    axis,
                    sign: self.sign.as_ref().map_or(Ok(1.0), |s| sign(reader, "head.sign", s))?,
                    zero: self.zero.as_ref().map_or(Ok(Deg::ZERO), |z| angle("head.zero", z))?,
                }
            }
        };
        Ok(Head::new(kind, pivot))
    }

    /// A key that means nothing for this kind of head is a mistake, not an extra.
    fn only_for(&self, reader: &Reader<'_>, kind: Kind) -> Result<(), JobError> {
        let given: [(&str, Option<usize>, &[Kind]); 6] = [
            ("pivot", self.pivot.as_ref().map(start), &[Kind::Fixed, Kind::Manual, Kind::Axis]),
            ("direction", self.direction.as_ref().map(start), &[Kind::Fixed]),
            ("letter", self.letter.as_ref().map(start), &[Kind::Axis]),
            ("sign", self.sign.as_ref().map(start), &[Kind::Axis]),
            ("zero", self.zero.as_ref().map(start), &[Kind::Axis]),
            ("angle", self.angle.as_ref().map(start), &[Kind::Manual]),
        ];
        for (key, place, kinds) in given {
            if let (Some(place), false) = (place, kinds.contains(&kind)) {
                let names: Vec<_> =
                    KINDS.iter().filter(|(_, k)| kinds.contains(k)).map(|(name, _)| *name).collect();
                let message = format!("key 'head.{key}' goes with kind {} only", names.join(", "));
                return Err(JobError { line: Some(reader.line(place)), message });
            }
        }
        Ok(())
    }
}

fn start<T>(value: &Spanned<T>) -> usize {
    value.span().start
}
