//! Reads keys of a TOML file: every error names the key, its line, and what is allowed.
pub mod bounds;
mod wording;

use std::borrow::Cow;
use std::ops::Range;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Why a job or machine file can't be used: one sentence with the key, its line, and what is allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", match line { Some(n) => format!("line {n}: "), None => String::new() })]
pub struct FileError {
    pub line: Option<usize>,
    pub message: String,
}

/// A value and where it stands in the text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(transparent)]
pub struct Spanned<T>(toml::Spanned<T>);

impl<T> Spanned<T> {
    /// The bytes that it takes up.
    pub fn span(&self) -> Range<usize> {
        self.0.span()
    }
}

impl<T> AsRef<T> for Spanned<T> {
    fn as_ref(&self) -> &T {
        self.0.as_ref()
    }
}

/// To a schema it is the value alone.
impl<T: JsonSchema> JsonSchema for Spanned<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}

/// So many values in brackets, and not one more: an array of serde's would leave the rest out in silence.
#[derive(Clone, Debug)]
pub struct FixedArray<T, const N: usize>(pub [T; N]);

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for FixedArray<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let values = Vec::deserialize(deserializer)?;
        let wrong = |values: Vec<T>| D::Error::invalid_length(values.len(), &format!("{N}").as_str());
        values.try_into().map(Self).map_err(wrong)
    }
}

impl<T: JsonSchema, const N: usize> JsonSchema for FixedArray<T, N> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("{N}_of_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let item = generator.subschema_for::<T>();
        json_schema!({ "type": "array", "items": item, "minItems": N, "maxItems": N })
    }
}

/// The words of a fixed list, which [`Reader::choice`] takes.
pub fn names<T>(all: &[(&'static str, T)]) -> Vec<&'static str> {
    all.iter().map(|(name, _)| *name).collect()
}

/// Turns places in the text into line numbers.
pub struct Reader<'t> {
    pub text: &'t str,
}

impl Reader<'_> {
    pub fn line(&self, offset: usize) -> usize {
        self.text.as_bytes()[..offset.min(self.text.len())].iter().filter(|b| **b == b'\n').count() + 1
    }

    pub fn syntax(&self, error: &toml::de::Error) -> FileError {
        let line = error.span().map(|s| self.line(s.start));
        FileError { line, message: wording::reword(self.text, error.span(), error.message().trim()) }
    }

    pub fn error<T>(&self, at: &Spanned<T>, message: impl Into<String>) -> FileError {
        FileError { line: Some(self.line(at.span().start)), message: message.into() }
    }

    /// A finite number within bounds that another key sets, or an error that names the key and what is allowed.
    pub fn number(
        &self,
        key: &str,
        value: &Spanned<f64>,
        allowed: &str,
        within: impl Fn(f64) -> bool,
    ) -> Result<f64, FileError> {
        let number = *value.as_ref();
        if number.is_finite() && within(number) {
            return Ok(number);
        }
        Err(self.error(value, format!("key '{key}' is {number}: {allowed}")))
    }

    /// One of a fixed list of words.
    pub fn choice<T: Copy>(
        &self,
        key: &str,
        value: &Spanned<String>,
        all: &[(&str, T)],
    ) -> Result<T, FileError> {
        let found = all.iter().find(|(name, _)| name == value.as_ref());
        found.map(|(_, choice)| *choice).ok_or_else(|| {
            let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
            self.error(value, format!("key '{key}' is '{}': one of {}", value.as_ref(), names.join(", ")))
        })
    }
}
