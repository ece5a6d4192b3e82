//! Layouts of a pattern: the numbers by which a drawing places its holes.
use schemars::JsonSchema;
use serde::Deserialize;

use super::PatternStep;
use crate::job::{FileError, Reader};
use crate::reader::bounds::{Azimuth, HoleCount, Length, MachinePoint, SignedPitch, SkippedHole};
use crate::reader::{FileKey, FixedArray, Items, Optional, Section};

/// Most holes that a call leaves out: four in each of two letters.
const MOST_SKIPPED: usize = 8;

/// A pattern of holes. Exactly one of `circle`, `arc`, `grid`, `line` and `points` places them.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    { "required": ["circle"] }, { "required": ["arc"] }, { "required": ["grid"] }, { "required": ["line"] },
    { "required": ["points"] },
]))]
pub struct PatternSpec {
    /// Its name, unique; its holes are `A-1`, `A-2` and so on.
    pub id: String,
    /// x of the centre of a circle or arc, or of the first hole of a grid or line, mm; it moves a list.
    #[serde(default = "zero", with = "MachinePoint")]
    pub x: f64,
    /// The same in y; on a cylinder an angle, degrees.
    #[serde(default = "zero", with = "MachinePoint")]
    pub y: f64,
    /// Holes all round a circle.
    #[serde(default, with = "Optional::<Section<HoleCircle>>")]
    circle: Option<HoleCircle>,
    /// Holes on an arc.
    #[serde(default, with = "Optional::<Section<HoleArc>>")]
    arc: Option<HoleArc>,
    /// Rows and columns.
    #[serde(default, with = "Optional::<Section<HoleGrid>>")]
    grid: Option<HoleGrid>,
    /// Holes on a straight line.
    #[serde(default, with = "Optional::<Section<HoleLine>>")]
    line: Option<HoleLine>,
    /// A list of points.
    #[serde(default, with = "Optional::<Items<FixedArray<MachinePoint, 2>>>")]
    #[schemars(length(min = 1))]
    points: Option<Vec<[f64; 2]>>,
    /// Numbers of the holes that are left out, from 1 [default: none].
    #[serde(default, with = "Items::<SkippedHole>")]
    pub skip: Vec<u32>,
    /// The operations on every hole.
    #[serde(rename = "make", with = "Items::<Section<PatternStep>>")]
    #[schemars(length(min = 1))]
    pub steps: Vec<PatternStep>,
}

fn zero() -> f64 {
    0.0
}

/// Holes evenly round a circle.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleCircle {
    /// Diameter of the circle, mm.
    #[serde(with = "Length")]
    pub diameter: f64,
    /// Number of holes.
    #[serde(with = "HoleCount")]
    pub holes: u32,
    /// Angle of hole 1 from x towards y, degrees [default: 0].
    #[serde(default = "zero", with = "Azimuth")]
    pub angle: f64,
    /// True if the holes are numbered clockwise.
    #[serde(default)]
    pub clockwise: bool,
}

/// Holes on an arc.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleArc {
    /// Diameter of the arc's circle, mm.
    #[serde(with = "Length")]
    pub diameter: f64,
    /// Number of holes.
    #[serde(with = "HoleCount")]
    pub holes: u32,
    /// Angle of hole 1 from x towards y, degrees.
    #[serde(with = "Azimuth")]
    pub angle: f64,
    /// From hole to hole, degrees; negative clockwise.
    #[serde(with = "SignedPitch")]
    pub step: f64,
}

/// Holes in rows and columns, numbered row by row, each from its first column.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleGrid {
    /// Holes in a row.
    #[serde(with = "HoleCount")]
    pub columns: u32,
    /// Number of rows.
    #[serde(with = "HoleCount")]
    pub rows: u32,
    /// From column to column and from row to row, mm; on a cylinder the second one in degrees.
    #[serde(with = "FixedArray::<SignedPitch, 2>")]
    pub pitch: [f64; 2],
    /// Rotation of the grid about its first hole, degrees; 0 on a cylinder [default: 0].
    #[serde(default = "zero", with = "Azimuth")]
    pub angle: f64,
}

/// Holes on a straight line.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HoleLine {
    /// Number of holes.
    #[serde(with = "HoleCount")]
    pub holes: u32,
    /// From hole to hole, mm; on a cylinder in degrees at angle 90.
    #[serde(with = "SignedPitch")]
    pub pitch: f64,
    /// Direction from x towards y, degrees; on a cylinder 0 or 90 [default: 0].
    #[serde(default = "zero", with = "Azimuth")]
    pub angle: f64,
}

/// The layout of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoleLayout<'p> {
    /// All round a circle.
    Circle(HoleCircle),
    /// On an arc.
    Arc(HoleArc),
    /// Rows and columns.
    Grid(HoleGrid),
    /// A straight line.
    Line(HoleLine),
    /// A list.
    Points(&'p [[f64; 2]]),
}

impl HoleLayout<'_> {
    /// Returns the number of holes, those that are left out included.
    pub fn count(&self) -> usize {
        match *self {
            Self::Circle(circle) => circle.holes as usize,
            Self::Arc(arc) => arc.holes as usize,
            Self::Grid(grid) => grid.columns as usize * grid.rows as usize,
            Self::Line(line) => line.holes as usize,
            Self::Points(points) => points.len(),
        }
    }
}

impl PatternSpec {
    /// Returns the layout: of several keys the first, which the check refuses.
    pub fn layout(&self) -> HoleLayout<'_> {
        let circle = self.circle.map(HoleLayout::Circle).or(self.arc.map(HoleLayout::Arc));
        let grid = self.grid.map(HoleLayout::Grid).or(self.line.map(HoleLayout::Line));
        circle.or(grid).unwrap_or(HoleLayout::Points(self.points.as_deref().unwrap_or_default()))
    }

    pub(super) fn check(&self, reader: &Reader<'_>, key: &str, is_cylinder: bool) -> Result<(), FileError> {
        let layouts = [
            ("circle", self.circle.is_some()),
            ("arc", self.arc.is_some()),
            ("grid", self.grid.is_some()),
            ("line", self.line.is_some()),
            ("points", self.points.is_some()),
        ];
        let given: Vec<_> = layouts.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect();
        let id_key = format!("{key}.id");
        match given.as_slice() {
            [_] => {}
            [] => {
                let message = format!(
                    "pattern '{}' has no holes: give it one of the keys circle, arc, grid, line, points",
                    self.id
                );
                return Err(reader.error_at(&id_key, message));
            }
            [first, second, ..] => {
                let message =
                    format!("key 'pattern.{second}' excludes '{first}': write a [[pattern]] for each");
                return Err(reader.error_at(&format!("{key}.{second}"), message));
            }
        }
        if self.steps.is_empty() {
            let message = "key 'pattern.make' is empty: name a tool and a depth";
            return Err(reader.error_at(&format!("{key}.make"), message));
        }
        self.check_layout(reader, key, is_cylinder)?;
        self.check_skip(reader, key)
    }

    fn check_layout(&self, reader: &Reader<'_>, key: &str, is_cylinder: bool) -> Result<(), FileError> {
        let allowed_angles: &[f64] = match self.layout() {
            HoleLayout::Points([]) => {
                let message = "key 'pattern.points' is empty: give a point, as [x, y]";
                return Err(reader.error_at(&format!("{key}.points"), message));
            }
            HoleLayout::Grid(_) => &[0.0],
            HoleLayout::Line(_) => &[0.0, 90.0],
            HoleLayout::Arc(arc) => {
                let span = arc.step.abs() * f64::from(arc.holes - 1);
                let allowed = format_args!(
                    "{} holes span {span} degrees: below 360, or the last ones meet the first",
                    arc.holes
                );
                return reader.check(span < 360.0, &format!("{key}.arc.step"), arc.step, allowed);
            }
            HoleLayout::Circle(_) | HoleLayout::Points(_) => return Ok(()),
        };
        let (name, angle) = match self.layout() {
            HoleLayout::Line(line) => ("line", line.angle),
            HoleLayout::Grid(grid) => ("grid", grid.angle),
            _ => return Ok(()),
        };
        let is_allowed = !is_cylinder || allowed_angles.contains(&angle);
        let words: Vec<_> = allowed_angles.iter().map(f64::to_string).collect();
        let allowed = format_args!("{} on a cylinder, where y is an angle", words.join(" or "));
        reader.check(is_allowed, &format!("{key}.{name}.angle"), angle, allowed)
    }

    fn check_skip(&self, reader: &Reader<'_>, key: &str) -> Result<(), FileError> {
        let count = self.layout().count();
        for (index, hole) in self.skip.iter().enumerate() {
            let allowed = format_args!("one of the holes 1 to {count}");
            reader.check(*hole as usize <= count, &format!("{key}.skip.{index}"), hole, allowed)?;
            let is_first = !self.skip[..index].contains(hole);
            reader.check(is_first, &format!("{key}.skip.{index}"), hole, "it is named twice")?;
        }
        let skipped = self.skip.len();
        let allowed = format_args!("left out of {count}: no hole remains");
        reader.check(skipped < count, &format!("{key}.skip"), skipped, allowed)?;
        let allowed = format_args!("holes: at most {MOST_SKIPPED}; split the pattern, or list its points");
        let is_list = self.points.is_some();
        reader.check(is_list || skipped <= MOST_SKIPPED, &format!("{key}.skip"), skipped, allowed)
    }
}
