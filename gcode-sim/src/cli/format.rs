//! What results can be written as. Every command that answers something has `--format`, with one of these.
use clap::ValueEnum;

/// Of every result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TextFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
}

/// Of lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ListFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// A header and one line each
    Csv,
}

/// Of findings with places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FindingFormat {
    Text,
    /// One document, and nothing else on standard output
    Json,
    /// SARIF 2.1.0, for code reviews
    Sarif,
}

/// Of cases.
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
