//! The machine file's `[head]`: its kind, and the keys of each kind.
use nalgebra::{Point3, Unit, Vector3};
use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::json;

use super::link::FileLink;
use super::{ROTARY_LETTERS, letter};
use crate::machine::{Chain, Head, HeadKind};
use gcode_lang::motion::Axes;
use gcode_lang::units::Deg;
use gcode_part::reader::FileError;
use gcode_part::reader::bounds::{Angle, Bounded, PivotLength, Sign};
use gcode_part::reader::{FileKey, FixedArray, Items, Located, Optional, Reader, Section, names};

/// The head and the inclination of the tool.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = by_kind)]
pub(super) struct FileHead {
    /// free: unknown; fixed: constant; manual: set by hand; axis: by an axis of the control in the plane of X and Y; axes: by
    /// any axes of the control.
    #[schemars(extend("enum" = names(&KINDS)))]
    kind: Located<String>,
    /// From the head's pivot to the spindle's gauge line, mm [default: 0].
    pivot: Option<Bounded<PivotLength>>,
    /// From the tip to the spindle with all axes at 0, not all 0 [default for kind axes: along z].
    direction: Option<Located<FixedArray<f64, 3>>>,
    /// The axis, A, B or C.
    #[schemars(extend("enum" = ROTARY_LETTERS))]
    letter: Option<Located<String>>,
    /// 1, or -1 if the axis is reversed [default: 1].
    sign: Option<Sign>,
    /// The head's angle with the axis at 0, degrees [default: 0].
    zero: Option<Bounded<Angle>>,
    /// Its angle before the first stop, degrees.
    angle: Option<Bounded<Angle>>,
    /// Its axes, from the slides outwards.
    #[serde(default, with = "Optional::<Items<Section<FileLink>>>")]
    axis: Option<Vec<FileLink>>,
}

#[derive(Clone, Copy, PartialEq)]
enum FileHeadKind {
    Free,
    Fixed,
    Manual,
    Axis,
    Axes,
}

const KINDS: [(&str, FileHeadKind); 5] = [
    ("free", FileHeadKind::Free),
    ("fixed", FileHeadKind::Fixed),
    ("manual", FileHeadKind::Manual),
    ("axis", FileHeadKind::Axis),
    ("axes", FileHeadKind::Axes),
];

/// Kinds to which each key belongs, in the order of [`FileHead`].
const KEYS: [(&str, &[FileHeadKind]); 7] = [
    ("pivot", &[FileHeadKind::Fixed, FileHeadKind::Manual, FileHeadKind::Axis, FileHeadKind::Axes]),
    ("direction", &[FileHeadKind::Fixed, FileHeadKind::Axes]),
    ("letter", &[FileHeadKind::Axis]),
    ("sign", &[FileHeadKind::Axis]),
    ("zero", &[FileHeadKind::Axis]),
    ("angle", &[FileHeadKind::Manual]),
    ("axis", &[FileHeadKind::Axes]),
];

/// Returns the key that a kind requires.
fn required_key(kind: FileHeadKind) -> Option<&'static str> {
    match kind {
        FileHeadKind::Free | FileHeadKind::Manual => None,
        FileHeadKind::Fixed => Some("direction"),
        FileHeadKind::Axis => Some("letter"),
        FileHeadKind::Axes => Some("axis"),
    }
}

/// Adds for each kind its required keys, and excludes those without meaning for it.
fn by_kind(schema: &mut Schema) {
    let case = |(name, kind): &(&str, FileHeadKind)| {
        let others = KEYS.iter().filter(|(_, kinds)| !kinds.contains(kind));
        let others: Vec<_> = others.map(|(key, _)| json!({ "required": [key] })).collect();
        let needed: Vec<_> = std::iter::once("kind").chain(required_key(*kind)).collect();
        json!({ "properties": { "kind": { "enum": [name] } }, "required": needed, "not": { "anyOf": others } })
    };
    schema.insert("oneOf".to_owned(), KINDS.iter().map(case).collect());
}

impl FileHead {
    pub(super) fn check(&self, reader: &Reader<'_>, axes: &Axes, table: &Chain) -> Result<Head, FileError> {
        let kind = reader.choice("head.kind", &self.kind, &KINDS)?;
        self.check_keys(reader, kind)?;
        let pivot = self.pivot.as_ref().map_or(0.0, Bounded::get);
        let needs = |key: &str| {
            reader.error(&self.kind, format!("kind = \"{}\" needs the key 'head.{key}'", self.kind.as_ref()))
        };
        let kind = match kind {
            FileHeadKind::Free => HeadKind::Free,
            FileHeadKind::Fixed => {
                let direction = self.direction(reader)?;
                HeadKind::Fixed(direction.ok_or_else(|| needs("direction"))?)
            }
            FileHeadKind::Axes => {
                let links = self.axis.as_ref().ok_or_else(|| needs("axis"))?;
                let mut chain = Chain::default();
                let mut carried = table.clone();
                for link in links {
                    let link = link.check(reader, axes, &carried, Point3::origin(), "head.axis")?;
                    carried.0.push(link.clone());
                    chain.0.push(link);
                }
                let direction = self.direction(reader)?.unwrap_or_else(Vector3::z_axis);
                HeadKind::Axes { chain, direction }
            }
            FileHeadKind::Manual => {
                HeadKind::Manual { start: self.angle.as_ref().map(|angle| Deg(angle.get())) }
            }
            FileHeadKind::Axis => {
                let value = self.letter.as_ref().ok_or_else(|| needs("letter"))?;
                let axis = letter(reader, "head.letter", value, axes)?;
                if !axes.is_rotary(axis) {
                    return Err(reader.error(value, "key 'head.letter': the head rotates by A, B or C"));
                }
                if table.has_axis(axis) {
                    let message =
                        format!("key 'head.letter' is {}, the letter of the table", axes.letter(axis));
                    return Err(reader.error(value, message));
                }
                HeadKind::Axis {
                    axis,
                    sign: self.sign.as_ref().map_or(1.0, |sign| f64::from(sign.get())),
                    zero: Deg(self.zero.as_ref().map_or(0.0, Bounded::get)),
                }
            }
        };
        Ok(Head::new(kind, pivot))
    }

    /// Returns the key `direction` with length 1.
    fn direction(&self, reader: &Reader<'_>) -> Result<Option<Unit<Vector3<f64>>>, FileError> {
        let Some(direction) = &self.direction else { return Ok(None) };
        let unit = Unit::try_new(Vector3::from(direction.as_ref().0), 1e-9).filter(|u| u.norm().is_finite());
        let [x, y, z] = direction.as_ref().0;
        let wrong = || {
            let required = "a vector from the tip to the spindle that is not all 0 is required";
            reader.error(direction, format!("key 'head.direction' is [{x}, {y}, {z}]: {required}"))
        };
        unit.map(Some).ok_or_else(wrong)
    }

    /// Returns true if an axis of the head has this letter.
    pub(super) fn turns_by(&self, letter: &str) -> bool {
        let letters = self.axis.iter().flatten().map(|link| &link.letter).chain(&self.letter);
        letters.into_iter().any(|own| own.as_ref() == letter)
    }

    /// Rejects a key that has no meaning for this kind of head.
    fn check_keys(&self, reader: &Reader<'_>, kind: FileHeadKind) -> Result<(), FileError> {
        let given = [
            self.pivot.as_ref().map(|pivot| start(pivot)),
            self.direction.as_ref().map(start),
            self.letter.as_ref().map(start),
            self.sign.as_ref().map(|sign| start(sign)),
            self.zero.as_ref().map(|zero| start(zero)),
            self.angle.as_ref().map(|angle| start(angle)),
            self.axis.as_ref().and_then(|links| links.first()).map(FileLink::start),
        ];
        for (place, (key, kinds)) in given.into_iter().zip(KEYS) {
            if let (Some(place), false) = (place, kinds.contains(&kind)) {
                let names: Vec<_> =
                    KINDS.iter().filter(|(_, k)| kinds.contains(k)).map(|(name, _)| *name).collect();
                let message = format!("key 'head.{key}' is for kind {} only", names.join(", "));
                return Err(FileError { line: Some(reader.line(place)), message });
            }
        }
        Ok(())
    }
}

fn start<T>(value: &Located<T>) -> usize {
    value.span().start
}
