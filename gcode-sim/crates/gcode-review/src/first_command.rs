//! The first command of each mode, axis and offset of a run, as a record keeps it.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The kind of command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum CommandKind {
    /// A modal code.
    Mode,
    /// An absolute position of an axis.
    Axis,
    /// A value of an offset.
    Offset,
}

/// The first command of a mode, an axis or an offset.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FirstCommand {
    pub what: CommandKind,
    /// Group of a mode, `03`; letter of an axis; name of an offset, `G10 L2 P1 X`.
    pub name: String,
    /// As written in programs.
    pub text: String,
    /// Number of moves before it.
    pub moves: usize,
    /// Its block, by its number in the record.
    #[serde(rename = "place")]
    pub block_number: usize,
}
