//! Ranges of the numbers in files that users write.
//!
//! Each range is one row, and the type of a field names its row: the schema, the check and the message come
//! from it.
use std::borrow::Cow;
use std::fmt::Display;
use std::marker::PhantomData;
use std::ops::Deref;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer};
use serde_json::Value;

use super::Spanned;

/// A type of number in a file.
pub trait FileNumber: Copy + Display + PartialOrd + DeserializeOwned + Into<Value> {
    /// Type in a schema.
    const TYPE: &'static str;

    /// Returns false for infinity and NaN, and for fractions where only whole numbers are allowed.
    fn is_usable(self, is_whole: bool) -> bool;
}

impl FileNumber for f64 {
    const TYPE: &'static str = "number";

    fn is_usable(self, is_whole: bool) -> bool {
        self.is_finite() && (!is_whole || self.fract() == 0.0)
    }
}

impl FileNumber for i64 {
    const TYPE: &'static str = "integer";

    fn is_usable(self, _: bool) -> bool {
        true
    }
}

/// Check of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangeKind {
    /// Any number between the ends, the ends included.
    Any,
    /// Whole numbers, with or without a decimal point.
    Whole,
    /// The schema's range alone: another key narrows it, and the reader checks that narrower range.
    Outer,
}

/// A range for a key.
pub trait KeyRange {
    /// `f64`, or `i64` if the file must have a number without a decimal point.
    type Number: FileNumber;
    /// Check of the range.
    const KIND: RangeKind;
    /// Least value.
    const MIN: Self::Number;
    /// Greatest value.
    const MAX: Self::Number;
    /// The unit, and the reason for the range if the message gives one.
    const UNIT: &'static str;

    /// Returns the range as messages state it: `0.01 to 99999 mm`.
    fn allowed() -> String {
        let whole = if Self::KIND == RangeKind::Whole { "a whole number from " } else { "" };
        let gap = if Self::UNIT.is_empty() { "" } else { " " };
        format!("{whole}{} to {}{gap}{}", Self::MIN, Self::MAX, Self::UNIT)
    }
}

macro_rules! ranges {
    ($($(#[$doc:meta])* $name:ident: $kind:ident $number:ident, $min:literal, $max:literal, $unit:literal;)+) => {$(
        #[doc = concat!(stringify!($min), " to ", stringify!($max), " ", $unit, ".")]
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub enum $name {}

        impl KeyRange for $name {
            type Number = $number;
            const KIND: RangeKind = RangeKind::$kind;
            const MIN: $number = $min;
            const MAX: $number = $max;
            const UNIT: &'static str = $unit;
        }
    )+};
}

ranges! {
    /// Nine digits state it to a tenth of the least increment.
    Length: Any f64, 0.01, 99_999.0, "mm";
    Depth: Any f64, 0.01, 9_999.0, "mm";
    ToolLength: Any f64, 0.0, 9_999.0, "mm";
    PositionTolerance: Any f64, 0.000_1, 1000.0, "mm";
    Azimuth: Any f64, -3600.0, 3600.0, "degrees";
    SpindleSpeed: Whole f64, 1.0, 99_999.0, "r/min";
    FeedRate: Any f64, 0.01, 240_000.0, "mm/min";
    ToolNumber: Any i64, 1, 9_999, "";
    /// At most the equatorial radius, or another diameter.
    Radius: Outer f64, 0.0, 99_999.0, "mm";
    /// At least the clearance.
    Retract: Outer f64, 0.01, 9_999.0, "mm";

    DrillNumber: Any i64, 1, 400, "";
    Divisions: Any i64, 2, 100_000, "";
    /// At least the diameter.
    OuterDiameter: Outer f64, 0.01, 99_999.0, "mm";

    BurrDiameter: Any f64, 0.5, 200.0, "mm";
    /// At least the nose.
    BurrLength: Outer f64, 0.0, 500.0, "mm";
    /// As many as have room at the tip.
    FluteCount: Outer i64, 1, 360, "";
    TipAngle: Any f64, 1.0, 85.0, "degrees: at the pole a flute has no width";
    /// At least the least increment.
    ChordError: Outer f64, 0.000_1, 1.0, "mm";
    /// At most the radius.
    ToothDepth: Outer f64, 0.0, 100.0, "mm";
    /// More than half the diameter.
    SideRadius: Outer f64, 0.25, 2000.0, "mm";
    /// Less than half the diameter.
    TipRadius: Outer f64, 0.05, 100.0, "mm";
    TableOffset: Any f64, -2000.0, 2000.0, "mm";
    WheelClearance: Any f64, 0.1, 500.0, "mm";
    ContactSpeed: Any f64, 1.0, 20_000.0, "mm/min";
    PlungeRate: Any f64, 0.1, 5_000.0, "mm/min";
    WheelSpeed: Any f64, 1.0, 99_999.0, "r/min";
    AngleTolerance: Any f64, 0.001, 10.0, "degrees";

    ProbeLength: Any f64, 0.01, 1000.0, "mm";
    ProbeFeed: Any f64, 0.01, 1000.0, "mm/min";
    SineTableLength: Any f64, 10.0, 2000.0, "mm";
    /// A sine bar loses its accuracy towards the upright.
    SineTableAngle: Any f64, 0.0, 45.0, "degrees";
    /// Each has three common variables of thirty.
    Candidates: Any i64, 1, 10, "";
    Uneven: Any f64, 0.001, 100.0, "mm";
    PartShift: Any f64, 0.01, 100.0, "mm";
    ShiftLimit: Any f64, 0.001, 10.0, "mm";
    TiltLimit: Any f64, 0.001, 1.0, "degrees";
    PathFeed: Any f64, 1.0, 10_000.0, "mm/min";

    DurationMinutes: Any f64, 0.0, 1_000_000.0, "minutes";
    HourlyRate: Any f64, 0.01, 1e9, "";

    MachinePoint: Any f64, -100_000.0, 100_000.0, "mm";
    Angle: Any f64, -360.0, 360.0, "degrees";
    OffsetNumber: Any i64, 1, 99_999_999, "";
    GaugeLength: Any f64, 0.0, 10_000.0, "mm";
    ToolDiameter: Any f64, 0.001, 10_000.0, "mm";
    StylusLength: Any f64, 0.0, 1000.0, "mm";
    ProbeDelay: Any f64, 0.0, 10.0, "seconds";
    Wavelength: Any f64, 1.0, 100_000.0, "mm";
}

/// Start of the message for a number out of range; the reader replaces it by the key.
pub(super) const OUT_OF_RANGE: &str = "out of range: ";

/// A number in the range `R`, with its location in the text.
pub struct Bounded<R: KeyRange>(Spanned<R::Number>, PhantomData<R>);

impl<R: KeyRange> Bounded<R> {
    /// Returns the number.
    pub fn get(&self) -> R::Number {
        *self.0.as_ref()
    }
}

impl<R: KeyRange> Deref for Bounded<R> {
    type Target = Spanned<R::Number>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<'de, R: KeyRange> Deserialize<'de> for Bounded<R> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Spanned::<R::Number>::deserialize(deserializer)?;
        let number = *value.as_ref();
        let is_inside = number.is_usable(R::KIND == RangeKind::Whole) && (R::MIN..=R::MAX).contains(&number);
        if R::KIND == RangeKind::Outer || is_inside {
            return Ok(Self(value, PhantomData));
        }
        Err(D::Error::custom(format!("{OUT_OF_RANGE}{number}: {}", R::allowed())))
    }
}

impl<R: KeyRange> JsonSchema for Bounded<R> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        R::allowed().into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let (min, max): (Value, Value) = (R::MIN.into(), R::MAX.into());
        let mut schema = json_schema!({ "type": R::Number::TYPE, "minimum": min, "maximum": max });
        if R::KIND == RangeKind::Whole {
            schema.insert("multipleOf".to_owned(), 1.into());
        }
        schema
    }
}

/// 1 or −1: the direction of an axis.
pub struct Sign(Spanned<i64>);

impl Sign {
    /// Returns 1 or −1.
    pub fn get(&self) -> i8 {
        if *self.0.as_ref() == 1 { 1 } else { -1 }
    }
}

impl Deref for Sign {
    type Target = Spanned<i64>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<'de> Deserialize<'de> for Sign {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Spanned::<i64>::deserialize(deserializer)?;
        match *value.as_ref() {
            1 | -1 => Ok(Self(value)),
            other => Err(D::Error::custom(format!("{OUT_OF_RANGE}{other}: 1 or -1"))),
        }
    }
}

impl JsonSchema for Sign {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Sign".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "enum": [1, -1] })
    }
}
