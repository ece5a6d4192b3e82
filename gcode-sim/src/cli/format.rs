//! Output formats. Every command with a result has `--format` with one of these sets.
use clap::ValueEnum;

/// Formats of any result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TextFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
}

/// Formats of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ListFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// A header and one line each
    Csv,
}

/// Formats of findings with locations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FindingFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// SARIF 2.1.0, for code reviews
    Sarif,
}

/// Formats of test cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TestFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// JUnit XML, for build servers
    Junit,
    /// SARIF 2.1.0, for code reviews
    Sarif,
}
