//! Ranges of the numbers in files that users write.
//!
//! Each range is one row, and a field names its row: the schema, the check and the message come from it.
use std::borrow::Cow;
use std::fmt::Display;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Value, json};

pub use super::keys::Bounded;
use super::keys::{AxisSign, FileKey, OUT_OF_RANGE};

/// The direction of an axis with its location in the text.
pub type Sign = Bounded<AxisSign>;

/// A type of number in a file.
pub trait FileNumber: Copy + Display + PartialOrd + Into<Value> + 'static {
    /// Type that the TOML reader returns.
    type Written: Copy + Display + DeserializeOwned;
    /// Type in a schema.
    const TYPE: &'static str;

    /// Returns the number; `None` for fractions where only whole numbers are allowed, and for overflow.
    fn of(written: Self::Written, is_whole: bool) -> Option<Self>;
}

impl FileNumber for f64 {
    type Written = Self;
    const TYPE: &'static str = "number";

    fn of(written: Self, is_whole: bool) -> Option<Self> {
        (!is_whole || written.fract() == 0.0).then_some(written)
    }
}

impl FileNumber for i64 {
    type Written = Self;
    const TYPE: &'static str = "integer";

    fn of(written: Self, _: bool) -> Option<Self> {
        Some(written)
    }
}

impl FileNumber for u32 {
    type Written = i64;
    const TYPE: &'static str = "integer";

    fn of(written: i64, _: bool) -> Option<Self> {
        written.try_into().ok()
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
    /// `f64`, or an integer if the file must have a number without a decimal point.
    type Number: FileNumber;
    /// Check of the range.
    const KIND: RangeKind;
    /// Least value.
    const MIN: Self::Number;
    /// Greatest value.
    const MAX: Self::Number;
    /// The unit, and the reason for the range if the message gives one.
    const UNIT: &'static str;
    /// Ends of a second range.
    const SECOND: Option<[Self::Number; 2]> = None;
    /// Excluded numbers.
    const EXCEPT: &'static [Self::Number] = &[];

    /// Returns the range as messages state it: `0.01 to 99999 mm`.
    fn allowed() -> String {
        let whole = if Self::KIND == RangeKind::Whole { "a whole number from " } else { "" };
        let gap = if Self::UNIT.is_empty() { "" } else { " " };
        format!("{whole}{} to {}{gap}{}", Self::MIN, Self::MAX, Self::UNIT)
    }

    /// Returns true for a number in the range.
    fn contains(number: Self::Number) -> bool {
        let is_second = Self::SECOND.is_some_and(|[min, max]| (min..=max).contains(&number));
        let is_inside = is_second || (Self::MIN..=Self::MAX).contains(&number);
        is_inside && !Self::EXCEPT.contains(&number)
    }
}

impl<R: KeyRange> FileKey for R {
    type Value = R::Number;

    fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<R::Number, D::Error> {
        let written = <R::Number as FileNumber>::Written::deserialize(deserializer)?;
        let number = R::Number::of(written, R::KIND == RangeKind::Whole);
        number
            .filter(|number| R::KIND == RangeKind::Outer || R::contains(*number))
            .ok_or_else(|| D::Error::custom(format!("{OUT_OF_RANGE}{written}: {}", R::allowed())))
    }

    fn serialize<S: Serializer>(number: &R::Number, serializer: S) -> Result<S::Ok, S::Error> {
        let value: Value = (*number).into();
        value.serialize(serializer)
    }
}

/// Returns the schema of a range.
fn range_schema<R: KeyRange>() -> Schema {
    let ends = |min: R::Number, max: R::Number| -> [Value; 2] { [min.into(), max.into()] };
    let [min, max] = ends(R::MIN, R::MAX);
    let mut schema = json_schema!({ "type": R::Number::TYPE });
    let first = json!({ "minimum": min, "maximum": max });
    match R::SECOND.map(|[min, max]| ends(min, max)) {
        Some([min, max]) => {
            let second = json!({ "minimum": min, "maximum": max });
            schema.insert("anyOf".to_owned(), json!([first, second]));
        }
        None => {
            schema.insert("minimum".to_owned(), min);
            schema.insert("maximum".to_owned(), max);
        }
    }
    if R::KIND == RangeKind::Whole {
        schema.insert("multipleOf".to_owned(), 1.into());
    }
    if !R::EXCEPT.is_empty() {
        let except: Vec<Value> = R::EXCEPT.iter().map(|number| (*number).into()).collect();
        schema.insert("not".to_owned(), json!({ "enum": except }));
    }
    schema
}

macro_rules! ranges {
    ($($(#[$doc:meta])* $name:ident: $kind:ident $number:ident, $min:literal, $max:literal, $unit:literal
        $(, default $default:literal)? $({ $($more:tt)* })?;)+) => {$(
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
            $($($more)*)?
        }

        $(impl $name {
            /// Returns the value of a key that is left out.
            pub(crate) fn default() -> $number {
                $default
            }
        })?

        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                range_schema::<Self>()
            }
        }
    )+};
}

ranges! {
    /// Nine digits state it to a tenth of the least increment.
    Length: Any f64, 0.01, 99_999.0, "mm";
    Depth: Any f64, 0.01, 9_999.0, "mm";
    ToolLength: Any f64, 0.0, 9_999.0, "mm", default 0.0;
    PositionTolerance: Any f64, 0.000_1, 1000.0, "mm";
    DepthTolerance: Any f64, 0.000_1, 1000.0, "mm", default 0.1;
    Azimuth: Any f64, -3600.0, 3600.0, "degrees";
    SpindleSpeed: Whole f64, 1.0, 99_999.0, "r/min";
    FeedRate: Any f64, 0.01, 240_000.0, "mm/min";
    ToolNumber: Any u32, 1, 9_999, "";
    /// At most the equatorial radius, or another diameter.
    Radius: Outer f64, 0.0, 99_999.0, "mm";
    /// At least the clearance.
    Retract: Outer f64, 0.01, 9_999.0, "mm";

    /// The second one is for the variable that follows.
    CommonVariable: Any u32, 100, 198, "", default 140 {
        const SECOND: Option<[u32; 2]> = Some([500, 998]);

        fn allowed() -> String {
            let [low, high] = Self::SECOND.unwrap_or_default();
            format!("{} to {} or {low} to {high}, because it and the next are used", Self::MIN, Self::MAX)
        }
    };
    /// Without the codes that end a program, call one or select rigid tapping.
    ClampCode: Any u32, 10, 999, "" {
        const EXCEPT: &'static [u32] = &[19, 29, 30, 98, 99];

        fn allowed() -> String {
            let except: Vec<_> = Self::EXCEPT.iter().map(u32::to_string).collect();
            let (min, max, except) = (Self::MIN, Self::MAX, except.join(", "));
            format!("an M code of the machine's own, {min} to {max} without {except}")
        }
    };

    DrillNumber: Any u32, 1, 400, "";
    Divisions: Any u32, 2, 100_000, "";
    /// At least the diameter.
    OuterDiameter: Outer f64, 0.01, 99_999.0, "mm";

    BurrDiameter: Any f64, 0.5, 200.0, "mm";
    /// At least the nose.
    BurrLength: Outer f64, 0.0, 500.0, "mm";
    /// The room at the tip narrows it.
    FluteCount: Outer i64, 1, 360, "";
    HelixAngle: Any f64, 1.0, 60.0, "degrees" {
        const SECOND: Option<[f64; 2]> = Some([-60.0, -1.0]);

        fn allowed() -> String {
            let [low, high] = Self::SECOND.unwrap_or_default();
            format!(
                "{} to {} {}, or {low} to {high} for a left-hand burr (a straight flute has no move that \
                 rotates A, which distinguishes grinding from approach)",
                Self::MIN, Self::MAX, Self::UNIT
            )
        }
    };
    TipAngle: Any f64, 1.0, 85.0, "degrees: at the pole a flute has no width";
    /// At least the least increment.
    ChordError: Outer f64, 0.000_1, 1.0, "mm";
    /// At most the radius.
    ToothDepth: Outer f64, 0.0, 100.0, "mm", default 0.0;
    /// More than half the diameter.
    SideRadius: Outer f64, 0.25, 2000.0, "mm";
    /// Less than half the diameter.
    TipRadius: Outer f64, 0.05, 100.0, "mm";
    TableOffset: Any f64, -2000.0, 2000.0, "mm";
    WheelClearance: Any f64, 0.1, 500.0, "mm";
    ContactSpeed: Any f64, 1.0, 20_000.0, "mm/min";
    PlungeRate: Any f64, 0.1, 5_000.0, "mm/min";
    WheelSpeed: Any f64, 1.0, 99_999.0, "r/min";
    HelixTolerance: Any f64, 0.001, 10.0, "degrees", default 0.3;
    IndexTolerance: Any f64, 0.001, 10.0, "degrees", default 0.05;

    ProbeLength: Any f64, 0.01, 1000.0, "mm";
    ProbeSearch: Any f64, 0.01, 1000.0, "mm", default 10.0;
    ProbeFeed: Any f64, 0.01, 1000.0, "mm/min", default 100.0;
    SineTableLength: Any f64, 10.0, 2000.0, "mm";
    /// A sine bar loses its accuracy towards the upright.
    SineTableAngle: Any f64, 0.0, 45.0, "degrees";
    /// Each has three common variables of thirty.
    Candidates: Any u32, 1, 10, "";
    Uneven: Any f64, 0.001, 100.0, "mm";
    PartHeight: Outer f64, -99_999.0, 99_999.0, "mm";
    /// First two of the angles of a run-out; the third is a count.
    ReadingAngle: Outer f64, -360.0, 360.0, "degrees";
    ReadingCount: Any f64, 3.0, 100.0, "" {
        fn allowed() -> String {
            format!("a whole number, {} to {}", Self::MIN, Self::MAX)
        }
    };
    PartShift: Any f64, 0.01, 100.0, "mm", default 0.4;
    ShiftLimit: Any f64, 0.001, 10.0, "mm";
    TiltLimit: Any f64, 0.001, 1.0, "degrees";
    PathFeed: Any f64, 1.0, 10_000.0, "mm/min";

    HoleCount: Any u32, 1, 9_999, "";
    /// Two digits of a letter state it.
    SkippedHole: Any u32, 1, 99, "";
    SignedPitch: Any f64, -9_999.0, 9_999.0, "without 0" {
        const EXCEPT: &'static [f64] = &[0.0];
    };

    DurationMinutes: Any f64, 0.0, 1_000_000.0, "minutes";
    HourlyRate: Any f64, 0.01, 1e9, "";
    ProofSeconds: Any f64, 0.001, 86_400.0, "seconds";

    MachinePoint: Any f64, -100_000.0, 100_000.0, "mm";
    Angle: Any f64, -360.0, 360.0, "degrees";
    OffsetNumber: Any i64, 1, 99_999_999, "";
    GaugeLength: Any f64, 0.0, 10_000.0, "mm";
    TipLength: Any f64, 0.0, 10_000.0,
        "mm from the gauge line to the tip; of a tool touched off at the part write length_offset, its H";
    LengthOffset: Any f64, -10_000.0, 10_000.0, "mm";
    RadiusOffset: Any f64, -10_000.0, 10_000.0, "mm";
    ToolDiameter: Any f64, 0.001, 10_000.0, "mm";
    PointAngle: Any f64, 10.0, 180.0, "degrees";
    StylusLength: Any f64, 0.0, 1000.0, "mm";
    ProbeDelay: Any f64, 0.0, 10.0, "seconds";
    PivotLength: Any f64, 0.0, 100_000.0, "mm";
    RapidRate: Any f64, 0.01, 1_000_000.0, "(mm/min and degrees/min)";
    WorkOffsetValue: Any f64, -100_000.0, 100_000.0, "(mm and degrees)";
    LengthError: Any f64, -100.0, 100.0, "mm";
    LengthSpread: Any f64, 0.0, 100.0, "mm";
    AngleError: Any f64, -45.0, 45.0, "degrees";
    AngleSpread: Any f64, 0.0, 45.0, "degrees";
    Wavelength: Any f64, 1.0, 100_000.0, "mm";
}
