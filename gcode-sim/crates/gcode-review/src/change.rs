//! What a difference is called, what it says, and where it comes from.
use std::borrow::Cow;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::record::BlockLocation;

/// What a change can be called, in the order of their sections in docs/changes.md.
pub const CODES: [&str; 42] = [
    "outcome",
    "program",
    "start",
    "hole-moved",
    "hole-tilted",
    "hole-depth",
    "hole-diameter",
    "hole-tool",
    "hole-pass",
    "hole-order",
    "hole-lost",
    "hole-added",
    "move-shifted",
    "move-added",
    "move-lost",
    "move-kind",
    "move-arc",
    "move-order",
    "feed",
    "dwell",
    "tool",
    "tool-length",
    "cutter-side",
    "work-system",
    "cycle",
    "return-level",
    "path-mode",
    "spindle",
    "coolant",
    "m-code",
    "g-code",
    "block-skip",
    "switch",
    "stop",
    "output",
    "variable",
    "mode",
    "work-offset",
    "tool-offset",
    "parameter",
    "signal",
    "counter",
];

/// One entry: what an edit does to the part or the control, what matters most of it first.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Its code: docs/changes.md has a section for each.
    pub code: Cow<'static, str>,
    /// The difference with numbers and units, a complete sentence.
    pub message: String,
    /// The first block of the old revision that has it, if any.
    pub old: Option<BlockLocation>,
    /// … and of the new one.
    pub new: Option<BlockLocation>,
    /// For a removed block, the neighbouring block of the new revision.
    #[serde(rename = "near", default, skip_serializing_if = "Option::is_none")]
    pub anchor: Option<BlockLocation>,
    /// What else the same edit does.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<Effect>,
}

impl Change {
    /// The code and the message of the headline and of all that stands beside it.
    pub fn effects(&self) -> impl Iterator<Item = (&str, &str)> {
        let also = self.also.iter().map(|effect| (&*effect.code, effect.message.as_str()));
        std::iter::once((&*self.code, self.message.as_str())).chain(also)
    }
}

impl From<Effect> for Change {
    fn from(effect: Effect) -> Self {
        let Effect { code, message, old, new } = effect;
        Self { code, message, old, new, anchor: None, also: Vec::new() }
    }
}

/// One thing that is different.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// What it is called: docs/changes.md has a section for each.
    pub code: Cow<'static, str>,
    /// What is different, with numbers and units; makes sense alone.
    pub message: String,
    /// The first block of the old revision that does it, where there is one.
    pub old: Option<BlockLocation>,
    /// … and of the new one.
    pub new: Option<BlockLocation>,
}

impl Effect {
    pub(super) fn new(code: &'static str, message: impl Into<String>) -> Self {
        debug_assert!(CODES.contains(&code), "{code}");
        Self { code: code.into(), message: message.into(), old: None, new: None }
    }

    pub(super) fn with_old(self, place: Option<&BlockLocation>) -> Self {
        Self { old: place.cloned(), ..self }
    }

    pub(super) fn with_new(self, place: Option<&BlockLocation>) -> Self {
        Self { new: place.cloned(), ..self }
    }
}

/// `1, 2, 5`; long lists are cut.
pub(super) fn listed(names: &[String]) -> String {
    const SHOWN: usize = 6;
    if names.len() <= SHOWN {
        return names.join(", ");
    }
    format!("{} and {} more", names[..SHOWN].join(", "), names.len() - SHOWN)
}
