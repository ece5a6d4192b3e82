//! How an error is distributed, as a file writes it: `{ normal = 0.01 }`.
use serde::Deserialize;
use toml::Spanned;

use crate::job::JobError;
use crate::job::reader::Reader;
use crate::machine::error::Spread;

/// One of the three.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileSpread {
    fixed: Option<Spanned<f64>>,
    normal: Option<Spanned<f64>>,
    uniform: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileVector {
    pub(super) x: Option<Spanned<FileSpread>>,
    pub(super) y: Option<Spanned<FileSpread>>,
    pub(super) z: Option<Spanned<FileSpread>>,
}

/// What an error is measured in, and the most that can be meant.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    allowed: &'static str,
    most: f64,
}

pub(super) const LENGTH: Kind = Kind { allowed: "mm, 100 at most", most: 100.0 };
pub(super) const ANGLE: Kind = Kind { allowed: "degrees, 45 at most", most: 45.0 };

impl FileSpread {
    pub(super) fn check(
        &self,
        reader: &Reader<'_>,
        key: &str,
        at: usize,
        kind: Kind,
    ) -> Result<Spread, JobError> {
        let Kind { allowed, most } = kind;
        let number = |name: &str, value: &Spanned<f64>, least: f64| {
            reader.number(&format!("{key}.{name}"), value, allowed, |v| least <= v && v <= most)
        };
        match (&self.fixed, &self.normal, &self.uniform) {
            (Some(value), None, None) => Ok(Spread::Fixed(number("fixed", value, -most)?)),
            (None, Some(deviation), None) => Ok(Spread::Normal(number("normal", deviation, 0.0)?)),
            (None, None, Some(half)) => Ok(Spread::Uniform(number("uniform", half, 0.0)?)),
            _ => {
                let message = format!(
                    "key '{key}' has one of normal (standard deviation), uniform (plus and minus), fixed"
                );
                Err(JobError { line: Some(reader.line(at)), message })
            }
        }
    }
}
