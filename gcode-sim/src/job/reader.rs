//! Reads keys of a TOML file: every error names the key, its line, and what is allowed.
use toml::Spanned;

/// Why a job or machine file can't be used: one sentence with the key, its line, and what is allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{message}", match line { Some(n) => format!("line {n}: "), None => String::new() })]
pub struct JobError {
    pub line: Option<usize>,
    pub message: String,
}

/// Turns places in the text into line numbers.
pub(crate) struct Reader<'t> {
    pub(crate) text: &'t str,
}

impl Reader<'_> {
    pub(crate) fn line(&self, offset: usize) -> usize {
        self.text.as_bytes()[..offset.min(self.text.len())].iter().filter(|b| **b == b'\n').count() + 1
    }

    pub(crate) fn syntax(&self, error: &toml::de::Error) -> JobError {
        let line = error.span().map(|s| self.line(s.start));
        JobError { line, message: super::wording::reword(self.text, error.span(), error.message().trim()) }
    }

    pub(crate) fn error<T>(&self, at: &Spanned<T>, message: impl Into<String>) -> JobError {
        JobError { line: Some(self.line(at.span().start)), message: message.into() }
    }

    /// A finite number within bounds, or an error that names the key and what is allowed.
    pub(crate) fn number(
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
    pub(crate) fn choice<T: Copy>(
        &self,
        key: &str,
        value: &Spanned<String>,
        all: &[(&str, T)],
    ) -> Result<T, JobError> {
        let found = all.iter().find(|(name, _)| name == value.as_ref());
        found.map(|(_, choice)| *choice).ok_or_else(|| {
            let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
            self.error(value, format!("key '{key}' is '{}': one of {}", value.as_ref(), names.join(", ")))
        })
    }
}
