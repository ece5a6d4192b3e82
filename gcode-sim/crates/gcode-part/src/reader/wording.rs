//! Errors of the TOML reader in the words of a job file: the full name of the key, and the allowed values.
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::keys::OUT_OF_RANGE;
use gcode_lang::similar;

/// Names of tools in catalogues, with their kinds in a machine file.
const OTHER_NAMES: [(&str, &str); 8] = [
    ("face-mill", "end-mill"),
    ("shell-mill", "end-mill"),
    ("ball-mill", "end-mill"),
    ("thread-mill", "end-mill"),
    ("chamfer-mill", "countersink"),
    ("center-drill", "spot-drill"),
    ("centre-drill", "spot-drill"),
    ("spotdrill", "spot-drill"),
];

/// Rewords `message` about the bytes `span` of `text`.
pub(super) fn reword(text: &str, span: Option<Range<usize>>, message: &str) -> String {
    // A key missing from the root is reported with an empty span.
    let start = span.filter(|span| !span.is_empty()).map(|span| span.start);
    let place = start.and_then(|start| path_at(text, start)).unwrap_or_default();
    if let Some(field) = quoted(message, "missing field ") {
        let name: Vec<_> = place.iter().map(String::as_str).chain([field]).collect();
        // The one list of tables that a job requires.
        return match name.as_slice() {
            ["hole"] => "no table [[hole]]: one for each hole".to_owned(),
            name => format!("key '{}' is missing", name.join(".")),
        };
    }
    let name = place.join(".");
    if message.starts_with("unknown field ") {
        let allowed = message.split_once("expected ").map_or("no keys", |(_, rest)| rest);
        let allowed = allowed.trim_start_matches("one of ").replace('`', "").replace(" or ", ", ");
        let own = place.last().map_or("", String::as_str);
        if let [tables @ .., code, number] = place.as_slice()
            && number.starts_with(|c: char| c.is_ascii_digit())
        {
            let header: String = tables.iter().map(|table| format!("{table}.")).collect();
            let code = quoted_code(code, number);
            return format!("[{name}]: a name with a point has quotes; write [{header}{code}]");
        }
        return match similar(own, allowed.split(", ")) {
            Some(meant) => format!("key '{name}' is unknown (did you mean '{meant}'?); allowed: {allowed}"),
            None => format!("key '{name}' is unknown; allowed: {allowed}"),
        };
    }
    if let Some((found, required)) =
        message.strip_prefix("invalid length ").and_then(|rest| rest.split_once(", expected "))
    {
        let counts = (found.parse::<usize>().unwrap_or(0), required.parse::<usize>().unwrap_or(0));
        let advice = match counts {
            (found, required) if found == 2 * required => "; a number has a point, not a comma",
            _ => "",
        };
        return format!("key '{name}' has {found} values: {required} are required{advice}");
    }
    if let Some((found, allowed)) =
        message.strip_prefix("unknown variant ").and_then(|rest| rest.split_once(", expected "))
    {
        // Of a section whose key `kind` decides which others it has, the reader of TOML knows no more than the section.
        let is_section = start.is_some_and(|start| !text[start..].starts_with(['"', '\'']));
        let name = if is_section { format!("{name}.kind") } else { name };
        let (found, allowed) =
            (found.replace('`', ""), allowed.trim_start_matches("one of ").replace('`', ""));
        let allowed = allowed.replace(" or ", ", ");
        let other_name =
            OTHER_NAMES.iter().find(|(name, _)| *name == found.to_lowercase().replace([' ', '_'], "-"));
        let other_name =
            other_name.map(|(_, meant)| *meant).filter(|meant| allowed.split(", ").any(|one| one == *meant));
        let meant = other_name.or_else(|| similar(&found, allowed.split(", ")));
        let meant = meant.map(|meant| format!(" (did you mean '{meant}'?)"));
        return format!("key '{name}' is '{found}'{}; allowed: {allowed}", meant.unwrap_or_default());
    }
    if let Some(wrong) = message.strip_prefix(OUT_OF_RANGE) {
        return format!("key '{name}' is {wrong}");
    }
    let Some(mismatch) = message.strip_prefix("invalid type: ") else { return message.to_owned() };
    let Some((found, expected)) = mismatch.split_once(", expected ") else { return message.to_owned() };
    let expected = match expected {
        "f64" => "a number",
        "i64" | "u32" => "a whole number",
        "a string" => "text in quotes",
        "a sequence" => "a list in brackets",
        "a table" | "a map" => "a table, { key = value },",
        other => other,
    };
    // A number that is written as text.
    let text = found.strip_prefix("string \"").and_then(|rest| rest.strip_suffix('"'));
    let number = text.map(|text| text.replacen(',', ".", 1)).filter(|number| number.parse::<f64>().is_ok());
    let without_point = found.strip_prefix("floating point `").and_then(|rest| rest.strip_suffix(".0`"));
    let advice = match number.filter(|_| expected.contains("number")) {
        Some(number) => format!("; write {number} without quotes"),
        None if expected == "a whole number" && without_point.is_some() => {
            format!("; write {}", without_point.unwrap_or_default())
        }
        None if found == "map" && expected.starts_with("a list") => format!("; write [[{name}]]"),
        None => String::new(),
    };
    let found = match found {
        "sequence" => "a list".to_owned(),
        "map" => "a table".to_owned(),
        _ => found.replace('`', ""),
    };
    format!("key '{name}' is {found}: {expected} is required{advice}")
}

/// Returns the code that a point without quotes divides, G54 and 1P1, as a key: "G54.1 P1".
fn quoted_code(code: &str, number: &str) -> String {
    let (fraction, letter) =
        number.split_at(number.find(|c: char| !c.is_ascii_digit()).unwrap_or(number.len()));
    format!("\"{}\"", format!("{code}.{fraction} {}", letter.trim()).trim_end())
}

/// Returns the place of the key or the list that a message is about within a section: of a section whose key `kind` decides which
/// others it has, the reader of TOML knows no more than the section. `None` for another message or place.
pub(super) fn place_in_section(text: &str, start: usize, message: &str) -> Option<Range<usize>> {
    let whole = DeTable::parse(text).ok()?;
    let section = section_at(whole.get_ref(), start)?;
    let mut found = Vec::new();
    if let Some((length, _)) =
        message.strip_prefix("invalid length ").and_then(|rest| rest.split_once(", expected "))
    {
        let length: usize = length.parse().ok()?;
        each_value(section, &mut |value| match value.get_ref() {
            DeValue::Array(all) if all.len() == length && all.iter().all(is_number) => {
                found.push(value.span())
            }
            _ => {}
        });
    } else if let Some(field) = quoted(message, "unknown field ") {
        let allowed = message.split_once("expected ").map_or("", |(_, rest)| rest);
        let is_allowed = |key: &str| key == "kind" || key == field || allowed.contains(&format!("`{key}`"));
        let mut all = Vec::new();
        let mut in_table = |table: &DeTable<'_>| {
            let is_of_message = table.iter().all(|(key, _)| is_allowed(key.get_ref()));
            let own = table.iter().find(|(key, _)| key.get_ref() == field);
            all.extend(own.map(|(key, _)| (is_of_message, key.span())));
        };
        section.as_table().into_iter().for_each(&mut in_table);
        each_value(section, &mut |value| value.get_ref().as_table().into_iter().for_each(&mut in_table));
        let is_only = all.len() == 1;
        let of_message = all.into_iter().filter(|(is_of_message, _)| is_only || *is_of_message);
        found.extend(of_message.map(|(_, span)| span));
    } else if message.starts_with("invalid type: map, expected a sequence") {
        let table = section.as_table().filter(|table| table.contains_key("kind"))?;
        found.extend(table.iter().filter(|(_, value)| value.get_ref().is_table()).map(|(key, _)| key.span()));
    }
    found.pop().filter(|_| found.is_empty())
}

fn is_number(value: &toml::Spanned<DeValue<'_>>) -> bool {
    matches!(value.get_ref(), DeValue::Integer(_) | DeValue::Float(_))
}

/// Returns the table that begins at a byte, or whose key does; of a list its item.
fn section_at<'t, 'd>(table: &'t DeTable<'d>, start: usize) -> Option<&'t DeValue<'d>> {
    table.iter().find_map(|(key, value)| {
        let items = match value.get_ref() {
            DeValue::Array(all) => all.iter().collect(),
            _ => vec![value],
        };
        items.into_iter().find_map(|item| {
            let inner = item.get_ref().as_table()?;
            let is_own = [key.span().start, item.span().start].contains(&start);
            if is_own { Some(item.get_ref()) } else { section_at(inner, start) }
        })
    })
}

/// Calls `each` with all values below one.
fn each_value(value: &DeValue<'_>, each: &mut impl FnMut(&toml::Spanned<DeValue<'_>>)) {
    let below: Vec<&toml::Spanned<DeValue<'_>>> = match value {
        DeValue::Table(inner) => inner.values().collect(),
        DeValue::Array(all) => all.iter().collect(),
        _ => Vec::new(),
    };
    for value in below {
        each(value);
        each_value(value.get_ref(), each);
    }
}

/// Returns the path of the key that begins at this byte, or whose value or an item of it does.
fn path_at(text: &str, start: usize) -> Option<Vec<String>> {
    fn in_table(table: &DeTable<'_>, start: usize) -> Option<Vec<String>> {
        table.iter().find_map(|(key, value)| {
            let below = in_value(value, start);
            let mut path = below.or_else(|| (key.span().start == start).then(Vec::new))?;
            path.insert(0, key.get_ref().to_string());
            Some(path)
        })
    }
    fn in_value(value: &toml::Spanned<DeValue<'_>>, start: usize) -> Option<Vec<String>> {
        let below = match value.get_ref() {
            DeValue::Table(inner) => in_table(inner, start),
            DeValue::Array(all) => all.iter().find_map(|item| in_value(item, start)),
            _ => None,
        };
        below.or_else(|| (value.span().start == start).then(Vec::new))
    }
    in_table(DeTable::parse(text).ok()?.get_ref(), start)
}

/// Returns the first word in backquotes after `before`.
fn quoted<'m>(message: &'m str, before: &str) -> Option<&'m str> {
    message.strip_prefix(before)?.strip_prefix('`')?.split_once('`').map(|(field, _)| field)
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOB: &str =
        "family = \"x\"\n[machine]\nrotary = { letter = \"B\", sgn = 1 }\n[[hole]]\nradius = 1.0\n";

    #[test]
    fn a_key_is_named_with_its_table() {
        let unknown_shif = "unknown field `shif`, expected `shift` or `tilt`";
        let is_unknown = "key 'part.shif' is unknown (did you mean 'shift'?); allowed: shift, tilt";
        for (text, place, message, expected) in [
            (JOB, "[machine]", "missing field `head`", "key 'machine.head' is missing"),
            (JOB, "{ letter", "missing field `sign`", "key 'machine.rotary.sign' is missing"),
            (JOB, "[[hole]]", "missing field `id`", "key 'hole.id' is missing"),
            (
                JOB,
                "radius",
                "unknown field `radius`, expected `a` or `b`",
                "key 'hole.radius' is unknown; allowed: a, b",
            ),
            (
                "[offsets.G54.1P12]\n",
                "1P12",
                "unknown field `1P12`, expected one of `X`, `Y`",
                "[offsets.G54.1P12]: a name with a point has quotes; write [offsets.\"G54.1 P12\"]",
            ),
            (
                JOB,
                "sgn",
                "unknown field `sgn`, expected one of `letter`, `sign`",
                "key 'machine.rotary.sgn' is unknown (did you mean 'sign'?); allowed: letter, sign",
            ),
            (
                JOB,
                "hole",
                "unknown field `hole`, expected one of `tool`, `drill`",
                "key 'hole' is unknown; allowed: tool, drill",
            ),
            (
                JOB,
                "1.0",
                "invalid type: string \"x\", expected f64",
                "key 'hole.radius' is string \"x\": a number is required",
            ),
            (
                JOB,
                "1.0",
                "invalid type: floating point `1.0`, expected u32",
                "key 'hole.radius' is floating point 1.0: a whole number is required; write 1",
            ),
            (
                "[[tool]]\nkind = \"Face mill\"\n",
                "\"Face",
                "unknown variant `Face mill`, expected one of `drill`, `end-mill`",
                "key 'tool.kind' is 'Face mill' (did you mean 'end-mill'?); allowed: drill, end-mill",
            ),
            (JOB, "radius", "duplicate key", "duplicate key"),
            (
                "[errors.part]\nx = 1\n",
                "part",
                "unknown field `part`, expected `linear` or `head`",
                "key 'errors.part' is unknown; allowed: linear, head",
            ),
            ("[part]\nshif.x = { fixed = 1 }\n", "shif", unknown_shif, is_unknown),
            ("[part.shif]\nx = { fixed = 1 }\n", "shif", unknown_shif, is_unknown),
            ("part.shif.x = { fixed = 1 }\n", "shif", unknown_shif, is_unknown),
        ] {
            let start = text.find(place).unwrap();
            assert_eq!(reword(text, Some(start..start + 1), message), expected, "{text}");
        }
        assert_eq!(reword(JOB, Some(0..0), "missing field `control`"), "key 'control' is missing");
    }
}
