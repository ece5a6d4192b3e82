//! Hand of a thread.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Hand of a thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// Right-hand: cut clockwise.
    #[default]
    Right,
    /// Left-hand: cut counterclockwise.
    Left,
}

impl Hand {
    pub(super) fn is_right(&self) -> bool {
        *self == Self::Right
    }
}
