//! Errors of the TOML reader in the words of a job file: the full name of the key, and the allowed values.
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::keys::OUT_OF_RANGE;

/// Rewords `message` about the bytes `span` of `text`.
pub(super) fn reword(text: &str, span: Option<Range<usize>>, message: &str) -> String {
    // A key missing from the root is reported with an empty span.
    let place =
        span.clone().filter(|s| !s.is_empty()).map(|s| KeyPath::of(text, s.start)).unwrap_or_default();
    if let Some(field) = quoted(message, "missing field ") {
        let name = place.child_name(field);
        // The one list of tables that a job requires.
        return if name == "hole" {
            "no table [[hole]]: one for each hole".to_owned()
        } else {
            format!("key '{name}' is missing")
        };
    }
    if let Some(field) = quoted(message, "unknown field ") {
        let allowed = message.split_once("expected ").map_or("no keys", |(_, rest)| rest);
        let allowed = allowed.trim_start_matches("one of ").replace('`', "").replace(" or ", ", ");
        return format!("key '{}' is unknown; allowed: {allowed}", place.sibling_name(field));
    }
    if let Some((found, wanted)) =
        message.strip_prefix("invalid length ").and_then(|rest| rest.split_once(", expected "))
    {
        return format!("key '{}' has {found} values: {wanted} are required", place.name());
    }
    if let Some(wrong) = message.strip_prefix(OUT_OF_RANGE) {
        return format!("key '{}' is {wrong}", key_of_value(text, span.map_or(0, |s| s.start)));
    }
    let Some(mismatch) = message.strip_prefix("invalid type: ") else { return message.to_owned() };
    let Some((found, expected)) = mismatch.split_once(", expected ") else { return message.to_owned() };
    let expected = match expected {
        "f64" => "a number",
        "i64" | "u32" => "a whole number",
        "a string" => "text in quotes",
        "a sequence" => "a list in brackets",
        other if other.starts_with("struct") => "a table",
        other => other,
    };
    format!("key '{}' is {}: {expected} is required", place.name(), found.replace('`', ""))
}

/// Returns the full name of the key whose value begins at this byte.
fn key_of_value(text: &str, start: usize) -> String {
    fn find<'t>(table: &'t DeTable<'_>, start: usize) -> Option<Vec<&'t str>> {
        table.iter().find_map(|(key, value)| {
            let tables: Vec<&DeTable<'_>> = match value.get_ref() {
                DeValue::Table(inner) => vec![inner],
                DeValue::Array(all) => all.iter().filter_map(|item| item.get_ref().as_table()).collect(),
                _ => Vec::new(),
            };
            let below = tables.into_iter().find_map(|table| find(table, start));
            let mut path = below.or_else(|| (value.span().start == start).then(Vec::new))?;
            path.insert(0, key.get_ref().as_ref());
            Some(path)
        })
    }
    let table = DeTable::parse(text);
    table.ok().and_then(|table| Some(find(table.get_ref(), start)?.join("."))).unwrap_or_default()
}

/// Returns the first word in backquotes after `before`.
fn quoted<'m>(message: &'m str, before: &str) -> Option<&'m str> {
    message.strip_prefix(before)?.strip_prefix('`')?.split_once('`').map(|(field, _)| field)
}

/// Table and key of a line.
#[derive(Default)]
struct KeyPath {
    /// `surface` in `[surface]`, `hole` in `[[hole]]`; empty before the first header.
    table: String,
    /// The key that the line sets; `None` for a header.
    key: Option<String>,
}

impl KeyPath {
    fn of(text: &str, offset: usize) -> Self {
        let mut place = Self::default();
        let mut end = 0;
        for line in text.split_inclusive('\n') {
            end += line.len();
            let content = line.trim();
            if let Some(header) = content.strip_prefix('[') {
                let name = header.trim_start_matches('[').split(']').next().unwrap_or("");
                place = Self { table: name.trim().to_owned(), key: None };
            } else if let Some((key, _)) = content.split_once('=') {
                place.key = Some(key.trim().trim_matches('"').to_owned());
            }
            if end > offset {
                break;
            }
        }
        place
    }

    fn name(&self) -> String {
        join(&[&self.table, self.key.as_deref().unwrap_or("")])
    }

    /// Returns the name of a key in the table that the line opens, by a header or by an inline table as the
    /// key's value.
    fn child_name(&self, field: &str) -> String {
        match &self.key {
            Some(key) if !self.table.is_empty() => join(&[&self.table, key, field]),
            _ => join(&[&self.table, field]),
        }
    }

    /// Returns the name of a key that the line or its header sets, dotted or not, or that an inline table on
    /// it contains.
    fn sibling_name(&self, field: &str) -> String {
        let path = self.name();
        let names: Vec<_> = path.split('.').map(str::trim).collect();
        match names.iter().rposition(|name| *name == field) {
            Some(last) => names[..=last].join("."),
            None => join(&[&path, field]),
        }
    }
}

fn join(parts: &[&str]) -> String {
    let parts: Vec<_> = parts.iter().copied().filter(|part| !part.is_empty()).collect();
    parts.join(".")
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOB: &str = "family = \"x\"\n[machine]\nrotary = { letter = \"B\" }\n[[hole]]\nradius = 1.0\n";

    #[test]
    fn a_key_is_named_with_its_table() {
        let told = |line: usize, message| {
            let start = JOB.split_inclusive('\n').take(line - 1).map(str::len).sum();
            reword(JOB, Some(start..start + 1), message)
        };
        assert_eq!(reword(JOB, Some(0..0), "missing field `control`"), "key 'control' is missing");
        assert_eq!(told(2, "missing field `head`"), "key 'machine.head' is missing");
        assert_eq!(told(3, "missing field `sign`"), "key 'machine.rotary.sign' is missing");
        assert_eq!(told(4, "missing field `id`"), "key 'hole.id' is missing");
        assert_eq!(
            told(5, "unknown field `radius`, expected `a` or `b`"),
            "key 'hole.radius' is unknown; allowed: a, b"
        );
        assert_eq!(
            told(3, "unknown field `sgn`, expected one of `letter`, `sign`"),
            "key 'machine.rotary.sgn' is unknown; allowed: letter, sign"
        );
        assert_eq!(
            told(4, "unknown field `hole`, expected one of `tool`, `drill`"),
            "key 'hole' is unknown; allowed: tool, drill"
        );
        assert_eq!(
            told(5, "invalid type: string \"x\", expected f64"),
            "key 'hole.radius' is string \"x\": a number is required"
        );
        assert_eq!(told(5, "duplicate key"), "duplicate key");
        let nested = "[errors.part]\nx = 1\n";
        assert_eq!(
            reword(nested, Some(8..12), "unknown field `part`, expected `linear` or `head`"),
            "key 'errors.part' is unknown; allowed: linear, head"
        );
        for dotted in [
            "[part]\nshif.x = { fixed = 1 }\n",
            "[part.shif]\nx = { fixed = 1 }\n",
            "part.shif.x = { fixed = 1 }\n",
        ] {
            let at = dotted.find("shif").unwrap();
            assert_eq!(
                reword(dotted, Some(at..at + 4), "unknown field `shif`, expected `shift` or `tilt`"),
                "key 'part.shif' is unknown; allowed: shift, tilt",
                "{dotted}"
            );
        }
    }
}
