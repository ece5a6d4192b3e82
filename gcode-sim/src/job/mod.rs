//! Job files: what to make, on which machine and control. Read by both programs; neither's formulas live here.
//!
//! Unknown keys, missing keys and values out of range are errors that name the key, the line and what is allowed.
mod pin_holes;

use serde::Deserialize;
use toml::Spanned;

pub use pin_holes::{
    AxisDirection, Head, HeadKind, HoleWanted, MacroSettings, PinHoles, PinMachine, Surface, Tool,
};

use crate::control::{Dialect, Increment};

/// A job, by its family.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    PinHoles(PinHoles),
}

/// Why a job file can't be used: one sentence with the key, its line, and what is allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{line}: {message}", line = match line { Some(n) => format!("line {n}"), None => "job".into() })]
pub struct JobError {
    pub line: Option<usize>,
    pub message: String,
}

/// The control a job is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobControl {
    pub dialect: Dialect,
    pub increment: Increment,
}

/// A rotary table: its letter, and the sign in B = sign · azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rotary {
    pub letter: char,
    pub sign: i8,
}

#[derive(Deserialize)]
struct Family {
    family: Spanned<String>,
}

pub const FAMILIES: [&str; 1] = ["pin-holes"];

impl Job {
    /// Reads a job file's text.
    pub fn parse(text: &str) -> Result<Self, JobError> {
        let reader = Reader { text };
        let table: toml::Table = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
        if !table.contains_key("family") {
            return Err(JobError {
                line: None,
                message: format!("key 'family' is missing: one of {}", FAMILIES.join(", ")),
            });
        }
        let Family { family } = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
        match family.as_ref().as_str() {
            "pin-holes" => pin_holes::parse(&reader).map(Self::PinHoles),
            other => Err(reader
                .error(&family, format!("family '{other}' is not known: one of {}", FAMILIES.join(", ")))),
        }
    }

    pub fn control(&self) -> JobControl {
        match self {
            Self::PinHoles(job) => job.control,
        }
    }
}

/// Turns places in the text into line numbers.
struct Reader<'t> {
    text: &'t str,
}

impl Reader<'_> {
    fn line(&self, offset: usize) -> usize {
        self.text.as_bytes()[..offset.min(self.text.len())].iter().filter(|b| **b == b'\n').count() + 1
    }

    fn syntax(&self, error: &toml::de::Error) -> JobError {
        JobError {
            line: error.span().map(|s| self.line(s.start)),
            message: error.message().trim().to_owned(),
        }
    }

    fn error<T>(&self, at: &Spanned<T>, message: impl Into<String>) -> JobError {
        JobError { line: Some(self.line(at.span().start)), message: message.into() }
    }

    /// A finite number within bounds, or an error that names the key and what is allowed.
    fn number(
        &self,
        key: &str,
        value: &Spanned<f64>,
        allowed: &str,
        within: impl Fn(f64) -> bool,
    ) -> Result<f64, JobError> {
        let number = *value.as_ref();
        if number.is_finite() && within(number) {
            return Ok(number);
        }
        Err(self.error(value, format!("key '{key}' is {number}: {allowed}")))
    }

    /// One of a fixed list of words.
    fn choice<T: Copy>(&self, key: &str, value: &Spanned<String>, all: &[(&str, T)]) -> Result<T, JobError> {
        let found = all.iter().find(|(name, _)| name == value.as_ref());
        found.map(|(_, choice)| *choice).ok_or_else(|| {
            let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
            self.error(value, format!("key '{key}' is '{}': one of {}", value.as_ref(), names.join(", ")))
        })
    }
}
