//! The control file: settings of the control by their names or parameter numbers, as TOML.
//!
//! ```toml
//! DIALECT = "fanuc-0i-f"
//! NAT = 1
//! 5115 = 0.5
//! ROA = "A"
//! "#1005" = 1
//! ```
use std::collections::BTreeMap;

use toml::{Spanned, Value};

use super::JobError;
use super::reader::Reader;
use crate::control::Settings;

/// Sets what the text of a control file says, the family of controls first and the rest in the order of the file.
///
/// # Errors
/// An unknown key or a value that a setting doesn't take, with its line and what is allowed.
pub fn apply(text: &str, settings: &mut Settings) -> Result<(), JobError> {
    let reader = Reader { text };
    let entries: BTreeMap<Spanned<String>, Value> = toml::from_str(text).map_err(|e| reader.syntax(&e))?;
    let mut entries: Vec<_> = entries.into_iter().collect();
    entries.sort_by_key(|(key, _)| (!key.as_ref().eq_ignore_ascii_case("DIALECT"), key.span().start));
    for (key, value) in entries {
        let name = key.as_ref();
        let value = match value {
            Value::String(text) => text,
            Value::Integer(number) => number.to_string(),
            Value::Float(number) => number.to_string(),
            Value::Boolean(on) => u8::from(on).to_string(),
            Value::Datetime(_) | Value::Array(_) | Value::Table(_) => {
                return Err(reader.error(&key, format!("key '{name}': a number or a text in quotes")));
            }
        };
        settings.set(name, &value).map_err(|error| reader.error(&key, error.to_string()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Dialect;

    #[test]
    fn settings_come_by_name_and_by_number_and_the_family_first() {
        let mut settings = Settings::default();
        let text = "NAT = true\n5115 = 0.25\nMACRO-LEVELS = 4\nDIALECT = \"haas-ngc\"\n\"#1005\" = 1\n";
        apply(text, &mut settings).unwrap();
        assert_eq!(settings.dialect, Dialect::HaasNgc);
        assert!(settings.signed_angles);
        assert_eq!(settings.macro_levels, 4, "the family would have set 9");
        let mut wanted = Settings::default();
        for (key, value) in
            [("DIALECT", "haas-ngc"), ("NAT", "1"), ("5115", "0.25"), ("MACRO-LEVELS", "4"), ("#1005", "1")]
        {
            wanted.set(key, value).unwrap();
        }
        assert_eq!(settings, wanted);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, message) in [
            ("NAT = 1\nNATT = 1\n", "line 2: no setting 'NATT': `gcode-sim settings` lists them"),
            ("NAT = 2\n", "line 1: setting NAT can't be '2': 0 or 1"),
            ("\nNAT = [1]\n", "line 2: key 'NAT': a number or a text in quotes"),
        ] {
            let error = apply(text, &mut Settings::default()).unwrap_err();
            assert_eq!(error.to_string(), message);
        }
    }
}
