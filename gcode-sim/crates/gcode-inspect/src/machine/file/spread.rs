//! Distribution of an error in a file: `{ normal = 0.01 }`.
use schemars::transform::Transform;
use schemars::{JsonSchema, Schema};
use serde::Deserialize;
use serde_json::Value;

use crate::machine::Distribution;
use gcode_part::reader::FileError;
use gcode_part::reader::{Reader, Spanned};

/// Distribution of an error: one of the three.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 1, "maxProperties" = 1))]
pub(super) struct FileSpread {
    /// A constant error.
    fixed: Option<Spanned<f64>>,
    /// Gaussian round 0 with this standard deviation.
    normal: Option<Spanned<f64>>,
    /// Uniform between minus and plus this value.
    uniform: Option<Spanned<f64>>,
}

/// By direction.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FileVector {
    /// Along or about x.
    pub(super) x: Option<Spanned<FileSpread>>,
    /// Along or about y.
    pub(super) y: Option<Spanned<FileSpread>>,
    /// Along or about z.
    pub(super) z: Option<Spanned<FileSpread>>,
}

/// Unit of an error and its largest plausible value.
#[derive(Clone, Copy)]
pub(super) struct QuantityLimits {
    allowed: &'static str,
    max: f64,
}

pub(super) const LENGTH: QuantityLimits = QuantityLimits { allowed: "mm, 100 at most", max: 100.0 };
pub(super) const ANGLE: QuantityLimits = QuantityLimits { allowed: "degrees, 45 at most", max: 45.0 };

impl QuantityLimits {
    /// Adds the bounds to the schema of a distribution, or of each distribution of a vector.
    pub(super) fn bounds(self) -> impl Transform {
        move |schema: &mut Schema| self.bound(schema)
    }

    fn bound(self, schema: &mut Schema) {
        let keys = schema.get_mut("properties").and_then(Value::as_object_mut);
        for (key, value) in keys.into_iter().flatten() {
            let Ok(inner) = <&mut Schema>::try_from(value) else { continue };
            if matches!(key.as_str(), "x" | "y" | "z") {
                self.bound(inner);
            } else {
                let least = if key == "fixed" { -self.max } else { 0.0 };
                inner.insert("minimum".to_owned(), least.into());
                inner.insert("maximum".to_owned(), self.max.into());
            }
        }
    }
}

impl FileSpread {
    pub(super) fn check(
        &self,
        reader: &Reader<'_>,
        key: &str,
        at: usize,
        kind: QuantityLimits,
    ) -> Result<Distribution, FileError> {
        let QuantityLimits { allowed, max: most } = kind;
        let number = |name: &str, value: &Spanned<f64>, least: f64| {
            reader.number(&format!("{key}.{name}"), value, allowed, |v| least <= v && v <= most)
        };
        match (&self.fixed, &self.normal, &self.uniform) {
            (Some(value), None, None) => Ok(Distribution::Fixed(number("fixed", value, -most)?)),
            (None, Some(deviation), None) => Ok(Distribution::Normal(number("normal", deviation, 0.0)?)),
            (None, None, Some(half)) => Ok(Distribution::Uniform(number("uniform", half, 0.0)?)),
            _ => {
                let message = format!(
                    "key '{key}' needs one of normal (standard deviation), uniform (plus and minus), fixed"
                );
                Err(FileError { line: Some(reader.line(at)), message })
            }
        }
    }
}
