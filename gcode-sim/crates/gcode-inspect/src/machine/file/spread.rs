//! Distribution of an error in a file: `{ normal = 0.01 }`.
use std::borrow::Cow;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::machine::Distribution;
use gcode_part::reader::bounds::{AngleError, AngleSpread, Bounded, KeyRange, LengthError, LengthSpread};
use gcode_part::reader::{FileKey, OUT_OF_RANGE, Section};

/// Ranges of an error.
pub(super) trait ErrorRanges {
    /// Range of a constant error.
    type Fixed: KeyRange<Number = f64> + JsonSchema;
    /// Range of a standard deviation and of a half width.
    type Spread: KeyRange<Number = f64> + JsonSchema;
}

/// An error in mm.
pub(super) enum Length {}

impl ErrorRanges for Length {
    type Fixed = LengthError;
    type Spread = LengthSpread;
}

/// An error in degrees.
pub(super) enum Angle {}

impl ErrorRanges for Angle {
    type Fixed = AngleError;
    type Spread = AngleSpread;
}

/// Distribution of an error: one of the three.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, bound = "")]
#[schemars(extend("minProperties" = 1, "maxProperties" = 1), bound = "")]
struct FileSpread<R: ErrorRanges> {
    /// A constant error.
    fixed: Option<Bounded<R::Fixed>>,
    /// Gaussian round 0 with this standard deviation.
    normal: Option<Bounded<R::Spread>>,
    /// Uniform between minus and plus this value.
    uniform: Option<Bounded<R::Spread>>,
}

/// The distribution of an error with the ranges `R`.
pub(super) struct ErrorSpread<R>(PhantomData<R>);

impl<R: ErrorRanges> FileKey for ErrorSpread<R> {
    type Value = Distribution;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Distribution, D::Error> {
        match Section::<FileSpread<R>>::deserialize(deserializer)? {
            FileSpread { fixed: Some(value), normal: None, uniform: None } => {
                Ok(Distribution::Fixed(value.get()))
            }
            FileSpread { fixed: None, normal: Some(value), uniform: None } => {
                Ok(Distribution::Normal(value.get()))
            }
            FileSpread { fixed: None, normal: None, uniform: Some(value) } => {
                Ok(Distribution::Uniform(value.get()))
            }
            _ => Err(D::Error::custom(format!(
                "{OUT_OF_RANGE}not one distribution: one of normal (standard deviation), uniform (plus and \
                 minus), fixed"
            ))),
        }
    }
}

impl<R: ErrorRanges> JsonSchema for ErrorSpread<R> {
    fn schema_name() -> Cow<'static, str> {
        FileSpread::<R>::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        FileSpread::<R>::json_schema(generator)
    }
}

/// By direction.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, bound = "")]
#[schemars(bound = "")]
pub(super) struct FileVector<R: ErrorRanges> {
    /// Along or about x.
    pub(super) x: Option<Bounded<ErrorSpread<R>>>,
    /// Along or about y.
    pub(super) y: Option<Bounded<ErrorSpread<R>>>,
    /// Along or about z.
    pub(super) z: Option<Bounded<ErrorSpread<R>>>,
}
