//! Reads keys of a TOML file. Every error names the key, its line and the allowed values.
pub mod bounds;
mod wording;

use std::borrow::Cow;
use std::ops::Range;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Reason for which a job or machine file is unusable: one sentence with the key, its line and the allowed
/// values.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", match line { Some(n) => format!("line {n}: "), None => String::new() })]
pub struct FileError {
    /// Line in the file, from 1; `None` if the error concerns the whole file.
    pub line: Option<usize>,
    /// The sentence, without the line.
    pub message: String,
}

/// A value with its location in the text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(transparent)]
pub struct Spanned<T>(toml::Spanned<T>);

impl<T> Spanned<T> {
    /// Returns the bytes of the value in the text.
    pub fn span(&self) -> Range<usize> {
        self.0.span()
    }
}

impl<T> AsRef<T> for Spanned<T> {
    fn as_ref(&self) -> &T {
        self.0.as_ref()
    }
}

/// The schema is that of the value alone.
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

/// An array of exactly `N` values; serde's own arrays ignore extra ones silently.
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

/// Returns the words of a fixed list for [`Reader::choice`].
pub fn names<T>(all: &[(&'static str, T)]) -> Vec<&'static str> {
    all.iter().map(|(name, _)| *name).collect()
}

/// Converts locations in the text to line numbers.
pub struct Reader<'t> {
    /// Text of the file.
    pub text: &'t str,
}

impl Reader<'_> {
    /// Returns the line of a byte, from 1.
    pub fn line(&self, offset: usize) -> usize {
        self.text.as_bytes()[..offset.min(self.text.len())].iter().filter(|b| **b == b'\n').count() + 1
    }

    /// Returns the error of the TOML reader in the words of a job file, with its line.
    pub fn syntax(&self, error: &toml::de::Error) -> FileError {
        let line = error.span().map(|s| self.line(s.start));
        FileError { line, message: wording::reword(self.text, error.span(), error.message().trim()) }
    }

    /// Returns an error at the line of a value.
    pub fn error<T>(&self, at: &Spanned<T>, message: impl Into<String>) -> FileError {
        FileError { line: Some(self.line(at.span().start)), message: message.into() }
    }

    /// Returns a finite number for which `within` is true, for bounds that another key sets.
    ///
    /// # Errors
    /// Any other number, with the key and `allowed`.
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

    /// Returns the choice that the word names.
    ///
    /// # Errors
    /// A word that is not in the list, with the list.
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
