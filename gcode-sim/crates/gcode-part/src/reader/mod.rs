//! Reads keys of a TOML file. Every error names the key, its line and the allowed values.
pub mod bounds;
mod keys;
mod slips;
mod wording;

use std::fmt::Display;
use std::ops::Range;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

pub use keys::{
    AxisSign, Bounded, FileKey, FixedArray, Items, OUT_OF_RANGE, Optional, Section, TableOf, Word, WordList,
};

/// Reason for which a file is unusable: one sentence with the key or the place, its line and the allowed
/// values.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", match line { Some(n) => format!("line {n}: "), None => String::new() })]
pub struct FileError {
    /// Line in the file, from 1; `None` if the error concerns the whole file.
    pub line: Option<usize>,
    /// The sentence, without the line.
    pub message: String,
}

impl FileError {
    /// Returns the key that the error names as unknown, unless it names the one that is meant.
    pub fn unknown_key(&self) -> Option<&str> {
        let quoted = |before: &str| self.message.strip_prefix(before)?.split_once('\'');
        let (key, rest) = quoted("key '").or_else(|| quoted("no setting '"))?;
        (rest.starts_with(" is unknown; ") || rest.starts_with(": see ")).then_some(key)
    }
}

/// A value with its location in the text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(with = "T", bound = "T: JsonSchema")]
pub struct Located<T>(toml::Spanned<T>);

impl<T> Located<T> {
    /// Returns the bytes of the value in the text.
    pub fn span(&self) -> Range<usize> {
        self.0.span()
    }
}

impl<T> AsRef<T> for Located<T> {
    fn as_ref(&self) -> &T {
        self.0.as_ref()
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

    /// Deserialises the text.
    ///
    /// # Errors
    /// A syntax error, or a key that is unknown, missing or out of range, with its line and the allowed
    /// values.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, FileError> {
        toml::from_str(self.text).map_err(|error| self.syntax(&error))
    }

    /// Returns the error of the TOML reader in the words of a job file, with its line.
    pub fn syntax(&self, error: &toml::de::Error) -> FileError {
        let line = error.span().map(|s| self.line(s.start));
        let is_syntax = DeTable::parse(self.text).is_err();
        if let Some((line, message)) =
            line.filter(|_| is_syntax).and_then(|line| slips::syntax_slip(self.text, line))
        {
            return FileError { line: Some(line), message };
        }
        let message = error.message().trim();
        let place = error.span().and_then(|span| wording::place_in_section(self.text, span.start, message));
        let line = place.as_ref().map(|place| self.line(place.start)).or(line);
        FileError { line, message: wording::reword(self.text, place.or(error.span()), message) }
    }

    /// Returns an error at the line of a value.
    pub fn error<T>(&self, at: &Located<T>, message: impl Into<String>) -> FileError {
        FileError { line: Some(self.line(at.span().start)), message: message.into() }
    }

    /// Returns an error at the value of a key: `hole.2.radius` is in the third `[[hole]]`. Without such a key
    /// the error concerns the whole file.
    pub fn error_at(&self, key: &str, message: impl Into<String>) -> FileError {
        FileError { line: self.find(key).map(|place| self.line(place)), message: message.into() }
    }

    /// Returns true if the file has the key.
    pub fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }

    /// Returns the first byte of the value of a key.
    fn find(&self, key: &str) -> Option<usize> {
        let table = DeTable::parse(self.text).ok()?;
        let mut names = key.split('.');
        let first = table.get_ref().get(names.next()?)?;
        let found = names.try_fold(first, |value, name| match value.get_ref() {
            DeValue::Table(table) => table.get(name),
            DeValue::Array(all) => all.get(name.parse::<usize>().ok()?),
            _ => None,
        });
        Some(found?.span().start)
    }

    /// Checks a value whose bounds another key sets.
    ///
    /// # Errors
    /// A value that is not allowed, with the key, which may have an index as in [`Self::error_at`], and
    /// `allowed`.
    pub fn check(
        &self,
        is_allowed: bool,
        key: &str,
        value: impl Display,
        allowed: impl Display,
    ) -> Result<(), FileError> {
        if is_allowed {
            return Ok(());
        }
        let named: Vec<_> = key.split('.').filter(|name| name.parse::<usize>().is_err()).collect();
        Err(self.error_at(key, format!("key '{}' is {value}: {allowed}", named.join("."))))
    }

    /// Returns a finite number for which `within` is true, for bounds that another key sets.
    ///
    /// # Errors
    /// Any other number, with the key and `allowed`.
    pub fn number(
        &self,
        key: &str,
        value: &Located<f64>,
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
        value: &Located<String>,
        all: &[(&str, T)],
    ) -> Result<T, FileError> {
        let found = all.iter().find(|(name, _)| name == value.as_ref());
        found.map(|(_, choice)| *choice).ok_or_else(|| {
            let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
            self.error(value, format!("key '{key}' is '{}': one of {}", value.as_ref(), names.join(", ")))
        })
    }
}
