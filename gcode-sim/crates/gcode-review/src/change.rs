//! Entries of a comparison: what an edit does, with its code, its sentence and its blocks.
use std::borrow::Cow;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::block_location::BlockLocation;
use super::kinds;
use gcode_lang::diag::FindingKind;

/// Entry of one edit: its effects on part and control, the one with the highest precedence first.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Code of the first effect, see docs/changes.md.
    pub code: Cow<'static, str>,
    /// Difference with numbers and units.
    pub message: String,
    /// First block of the old revision that has the difference.
    pub old: Option<BlockLocation>,
    /// First block of the new revision.
    pub new: Option<BlockLocation>,
    /// For a removed block, the neighbouring block of the new revision.
    #[serde(rename = "near", default, skip_serializing_if = "Option::is_none")]
    pub anchor: Option<BlockLocation>,
    /// Other effects of the same edit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<Effect>,
}

impl Change {
    /// Iterates over code and message of all effects, the headline first.
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

/// An unexecuted changed block, old and new; only one of them if it is added or removed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct UnexecutedChange {
    /// The block of the old revision.
    pub old: Option<BlockLocation>,
    /// The block of the new revision.
    pub new: Option<BlockLocation>,
}

impl Change {
    /// Returns the entry of a case whose accepted result a reference judged, and that has none any more.
    pub fn lost_reference() -> Self {
        let message = "a reference judged the accepted result, and the case has none: it was deleted, or has another name";
        Effect { code: kinds::REFERENCE.code.into(), message: message.to_owned(), old: None, new: None }
            .into()
    }
}

impl From<UnexecutedChange> for Change {
    fn from(UnexecutedChange { old, new }: UnexecutedChange) -> Self {
        let message =
            "the run does not execute a changed block, or not as a whole: its effect is unknown".to_owned();
        Effect { code: kinds::UNEXECUTED.code.into(), message, old, new }.into()
    }
}

/// One effect of an edit.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// Code, see docs/changes.md.
    pub code: Cow<'static, str>,
    /// Difference with numbers and units, understandable alone.
    pub message: String,
    /// First block of the old revision that has the effect.
    pub old: Option<BlockLocation>,
    /// First block of the new revision.
    pub new: Option<BlockLocation>,
}

impl Effect {
    /// Creates an effect with its first block in the old and in the new revision.
    pub(super) fn new(
        kind: &'static FindingKind,
        message: impl Into<String>,
        blocks: [Option<Cow<'_, BlockLocation>>; 2],
    ) -> Self {
        let [old, new] = blocks.map(|block| block.map(Cow::into_owned));
        Self { code: kind.code.into(), message: message.into(), old, new }
    }
}

/// Puts items with equal keys together, in the order of the first of each.
pub(super) fn grouped<K: PartialEq, T>(items: impl IntoIterator<Item = (K, T)>) -> Vec<(K, Vec<T>)> {
    let mut groups: Vec<(K, Vec<T>)> = Vec::new();
    for (key, item) in items {
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, all)) => all.push(item),
            None => groups.push((key, vec![item])),
        }
    }
    groups
}

/// Formats a list as `1, 2, 5`; a long one ends with the number of further items.
pub(super) fn listed(names: &[String]) -> String {
    const SHOWN: usize = 6;
    if names.len() <= SHOWN {
        return names.join(", ");
    }
    format!("{} and {} more", names[..SHOWN].join(", "), names.len() - SHOWN)
}
