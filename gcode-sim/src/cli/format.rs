//! Output formats. Every command with a result has `--format` with one of these sets.
use clap::ValueEnum;

/// Formats of any result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TextFormat {
    #[expect(missing_docs, reason = "its comment would be a help text")]
    Text,
    /// One document, and nothing else on standard output
    Json,
}

/// Formats of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ListFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// A header and one line each
    Csv,
}

/// Formats of findings with locations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FindingFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// SARIF 2.1.0, for code reviews
    Sarif,
}

/// Formats of test cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TestFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// JUnit XML, for build servers
    Junit,
    /// SARIF 2.1.0, for code reviews
    Sarif,
}
