//! The control file: settings of the control by their names or parameter numbers, as TOML.
//!
//! ```toml
//! DIALECT = "fanuc-0i-f"
//! NAT = 1
//! 5115 = 0.5
//! ROA = "A"
//! "#1005" = 1
//! ```
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, json};
use toml::Value;

use super::FileError;
use crate::reader::{Located, Reader};
use gcode_lang::control::{
    ADDRESSES, CODE_RANGES, CodeCalls, DeclaredEffect, ROWS, SEQUENTIAL_CODES, SettingRow, SettingValues,
    Settings,
};

/// Applies the text of a control file to the settings, the dialect first and the rest in the order of the
/// file. Without `takes_dialect` that of the settings stays.
///
/// # Errors
/// An unknown key or a value outside the range of its setting, with its line and the allowed values.
pub fn apply(text: &str, settings: &mut Settings, takes_dialect: bool) -> Result<(), FileError> {
    for Entry { key, name, value } in read(text)? {
        if !takes_dialect && is_dialect(&name) {
            continue;
        }
        let reader = Reader { text };
        settings.set(&name, &value?).map_err(|error| reader.error(&key, error.to_string()))?;
    }
    Ok(())
}

/// Returns the settings that the text of a control file states, with their values as texts.
///
/// # Errors
/// A text that is no TOML, or a value that is neither a number nor a text.
pub fn entries(text: &str) -> Result<Vec<(String, String)>, FileError> {
    read(text)?.into_iter().map(|entry| Ok((entry.name, entry.value?))).collect()
}

/// Setting of a control file.
struct Entry {
    /// Key of the file: the setting, or the table that has it.
    key: Located<String>,
    name: String,
    /// Value as text; the error of one that is neither a number nor a text.
    value: Result<String, FileError>,
}

fn is_dialect(name: &str) -> bool {
    name.eq_ignore_ascii_case("DIALECT")
}

/// Reads the settings of a control file, the dialect first and the rest in the order of the file.
fn read(text: &str) -> Result<Vec<Entry>, FileError> {
    let reader = Reader { text };
    let keys: BTreeMap<Located<String>, Value> = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
    let mut keys: Vec<_> = keys.into_iter().collect();
    keys.sort_by_key(|(key, _)| (!is_dialect(key.as_ref()), key.span().start));
    let mut entries = Vec::new();
    for (key, value) in keys {
        let name = key.as_ref().clone();
        if let (CODES, Value::Table(codes)) = (name.as_str(), &value) {
            for (code, value) in codes {
                let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                entries.push(Entry { key: key.clone(), name: code.clone(), value: Ok(value) });
            }
            continue;
        }
        let value = match value {
            Value::String(text) => Ok(text),
            Value::Integer(number) => Ok(number.to_string()),
            Value::Float(number) => Ok(number.to_string()),
            Value::Boolean(on) if is_switch(&name) => Ok(u8::from(on).to_string()),
            Value::Boolean(_) | Value::Datetime(_) | Value::Array(_) | Value::Table(_) => {
                Err(reader.error(&key, format!("key '{name}': a number or a text in quotes is required")))
            }
        };
        entries.push(Entry { key, name, value });
    }
    Ok(entries)
}

/// Regular expression of a code.
const CODE: &str = "^[GM]-?[0-9]+([.][0-9])?$";

/// Table of the codes that call a program or have a declared effect.
const CODES: &str = "codes";

fn is_switch(key: &str) -> bool {
    key.starts_with('#') || ROWS.iter().any(|row| row.key.eq_ignore_ascii_case(key) && row.is_switch())
}

/// The control file as a schema: that of the settings.
pub struct ControlFile;

impl JsonSchema for ControlFile {
    fn schema_name() -> Cow<'static, str> {
        "Control".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let settings = ROWS.iter().map(|row| (row.key.to_owned(), setting(row)));
        let properties: Map<String, serde_json::Value> = settings.chain(calls()).collect();
        let described = |text: &str, mut schema: serde_json::Value| {
            schema["description"] = text.into();
            schema
        };
        let effects: Vec<&str> = DeclaredEffect::ALL.iter().map(|(name, _)| *name).collect();
        let program = json!({ "anyOf": [
            { "type": "integer", "minimum": 1, "maximum": 99_999_999 },
            { "type": "string", "pattern": "^O?[0-9]{1,8}$" },
            { "enum": effects },
            { "enum": ["P"] },
        ] });
        let code = described(
            "A code that calls this program, or its declared effect; G-201 is a modal call.",
            program,
        );
        let mut properties = properties;
        let codes = json!({ "type": "object", "patternProperties": { CODE: code.clone() }, "additionalProperties": false });
        properties.insert(
            CODES.to_owned(),
            described("Codes that call programs or have a declared effect.", codes),
        );
        json_schema!({
            "description": "Settings of the control by their names or parameter numbers.",
            "type": "object",
            "properties": properties,
            "patternProperties": {
                "^#10([0-2][0-9]|3[01])$": described("An input signal.", switch()),
                "^#(103[2-9]|10[4-9][0-9]|1[1-9][0-9]{2}|[2-9][0-9]{3}|[1-5][0-9]{4})([.][0-9]+)?$": described(
                    "A setting, parameter, input or tool table of the machine: its value, or the output that an input follows.",
                    json!({ "type": ["number", "string"] }),
                ),
                CODE: code,
            },
            "additionalProperties": false,
        })
    }
}

fn setting(row: &SettingRow) -> serde_json::Value {
    let mut schema = match row.values {
        SettingValues::Switch => switch(),
        SettingValues::Words(words) => json!({ "type": "string", "enum": words() }),
        SettingValues::Whole(least, most) => json!({ "type": "integer", "minimum": least, "maximum": most }),
        SettingValues::Number(least, most, _) => {
            json!({ "type": "number", "minimum": least, "maximum": most })
        }
        SettingValues::Text(pattern, _) | SettingValues::Ranges(pattern) => {
            json!({ "type": "string", "pattern": pattern })
        }
    };
    schema["description"] = format!("{} [{}]", row.meaning, row.values).into();
    schema
}

fn switch() -> serde_json::Value {
    json!({ "enum": [0, 1, false, true] })
}

/// Returns the schemas of the parameters and addresses that make calls, by number and letter.
fn calls() -> impl Iterator<Item = (String, serde_json::Value)> {
    let whole = |values: RangeInclusive<i64>, what: String| json!({ "description": what, "type": "integer", "minimum": values.start(), "maximum": values.end() });
    let codes = SEQUENTIAL_CODES.iter().flat_map(move |family| {
        let (letter, taken) = (char::from(family.letter), CodeCalls::reserved_codes(family.letter));
        // A parameter of 0 assigns no code.
        let taken: Vec<i64> =
            taken.map(i64::from).filter(|code| *code != 0).flat_map(|code| [code, -code]).collect();
        (family.first..=family.last).zip(family.program..).map(move |(number, program)| {
            let what = format!("The {letter} code that calls O{program}, 0 for none.");
            let mut schema = whole(family.codes(), what);
            schema["not"] = json!({ "enum": taken });
            (number.to_string(), schema)
        })
    });
    let ranges = CODE_RANGES.iter().flat_map(move |range| {
        let (letter, all) = (char::from(range.letter), 0..=99_999_999);
        let first = if range.letter == b'G' { -9999..=99_999_999 } else { all.clone() };
        let of = [(first, "the first code"), (all.clone(), "the first program"), (all, "how many")];
        (range.first..).zip(of).map(move |(number, (values, what))| {
            (number.to_string(), whole(values, format!("A range of {letter} codes that call: {what}.")))
        })
    });
    let letters: Vec<u8> = std::iter::once(0).chain(ADDRESSES.iter().copied()).collect();
    let by_number = [6090, 6091].map(|number| {
        let what = "The character code of the address that calls, 0 for none.";
        (number.to_string(), json!({ "description": what, "type": "integer", "enum": letters }))
    });
    let by_letter = ADDRESSES.iter().map(|letter| {
        let programs: Vec<u32> = CodeCalls::address_programs(*letter).collect();
        let what = "The program that the address calls, whatever its number.";
        (char::from(*letter).to_string(), json!({ "description": what, "type": "integer", "enum": programs }))
    });
    codes.chain(ranges).chain(by_number).chain(by_letter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::control::Dialect;

    #[test]
    fn settings_come_by_name_and_by_number_and_the_family_first() {
        let mut settings = Settings::default();
        let text = "NAT = true\n5115 = 0.25\nMACRO-LEVELS = 4\nDIALECT = \"haas-ngc\"\n\"#1005\" = 1\n";
        apply(text, &mut settings, true).unwrap();
        assert_eq!(settings.dialect, Dialect::HaasNgc);
        assert!(settings.returns_signed_angles);
        assert_eq!(settings.macro_levels, 4, "the family would have set 9");
        let mut expected = Settings::default();
        for (key, value) in
            [("DIALECT", "haas-ngc"), ("NAT", "1"), ("5115", "0.25"), ("MACRO-LEVELS", "4"), ("#1005", "1")]
        {
            expected.set(key, value).unwrap();
        }
        assert_eq!(settings, expected);
    }

    #[test]
    fn a_refused_key_is_named_with_its_line() {
        for (text, message) in [
            (
                "NAT = 1\nNATT = 1\n",
                "line 2: no setting 'NATT' (did you mean 'NAT'?): see `gcode-sim settings`",
            ),
            ("NAT = 2\n", "line 1: setting NAT is '2': 0 or 1"),
            ("\nNAT = [1]\n", "line 2: key 'NAT': a number or a text in quotes is required"),
        ] {
            let error = apply(text, &mut Settings::default(), true).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
    }
}
