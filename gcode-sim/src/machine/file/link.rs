//! `[[table]]`: the axes that carry the part, the outermost last.
use nalgebra::{Point3, Unit, Vector3};
use serde::Deserialize;
use toml::Spanned;

use super::{lengths, letter, sign};
use crate::job::JobError;
use crate::job::reader::Reader;
use crate::machine::{Chain, Link};
use crate::motion::Axes;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileLink {
    letter: Spanned<String>,
    turns: Option<Spanned<String>>,
    slides: Option<Spanned<String>>,
    sign: Spanned<i64>,
    centre: Option<[Spanned<f64>; 3]>,
}

const DIRECTIONS: [(&str, Vector3<f64>); 3] = [
    ("x", Vector3::new(1.0, 0.0, 0.0)),
    ("y", Vector3::new(0.0, 1.0, 0.0)),
    ("z", Vector3::new(0.0, 0.0, 1.0)),
];

impl FileLink {
    pub(super) fn check(
        &self,
        reader: &Reader<'_>,
        axes: &Axes,
        inner: &Chain,
        origin: Point3<f64>,
    ) -> Result<Link, JobError> {
        let axis = letter(reader, "table.letter", &self.letter, axes)?;
        if inner.has(axis) {
            let message = format!("key 'table.letter': {} is there twice", axes.letter(axis));
            return Err(reader.error(&self.letter, message));
        }
        let sign = sign(reader, "table.sign", &self.sign)?;
        let kinds = (&self.turns, &self.slides);
        let (key, direction) = match kinds {
            (Some(about), None) => ("turns", about),
            (None, Some(along)) => ("slides", along),
            _ => {
                let message = "a [[table]] has one of the keys 'turns' and 'slides': x, y or z";
                return Err(reader.error(&self.letter, message));
            }
        };
        if (key == "turns") != axes.is_rotary(axis) {
            let message =
                format!("key 'table.{key}' doesn't go with {}: A B C turn, others slide", axes.letter(axis));
            return Err(reader.error(direction, message));
        }
        let unit = Unit::new_unchecked(reader.choice(&format!("table.{key}"), direction, &DIRECTIONS)?);
        match (&self.centre, key) {
            (Some([x, ..]), "slides") => Err(reader.error(x, "key 'table.centre' goes with 'turns' only")),
            (_, "slides") => Ok(Link::slide(axis, unit, sign)),
            (Some(centre), _) => {
                Ok(Link::turn(axis, unit, Point3::from(lengths(reader, "table.centre", centre)?), sign))
            }
            (None, _) => Ok(Link::turn(axis, unit, origin, sign)),
        }
    }
}
