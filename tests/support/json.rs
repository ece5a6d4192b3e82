//! Compares the JSON of an answer with an expectation that names a part of it.
//!
//! Objects may have further keys; `null` also stands for a key that is missing. Lists have as many items as expected, or
//! further ones if the expectation begins with `"..."`. A text `~words` contains these words.
use serde_json::{Value, json};

/// Compares an answer with what is expected; an error is the path of the first difference.
pub(crate) fn compare(expected: &Value, found: &Value) -> Result<(), String> {
    match (expected, found) {
        (Value::String(expected), Value::String(found)) if expected.starts_with('~') => {
            let words = &expected[1..];
            if found.contains(words) { Ok(()) } else { Err(format!(" (without '{words}': '{found}')")) }
        }
        (Value::Object(expected), Value::Object(found)) => {
            for (key, value) in expected {
                let found = found.get(key).unwrap_or(&Value::Null);
                compare(value, found).map_err(|path| format!(".{key}{path}"))?;
            }
            Ok(())
        }
        // Among others.
        (Value::Array(expected), Value::Array(found)) if expected.first() == Some(&json!("...")) => {
            let is_there = |item: &&Value| found.iter().any(|found| compare(item, found).is_ok());
            match expected[1..].iter().find(|item| !is_there(item)) {
                Some(missing) => Err(format!(" (without {missing})")),
                None => Ok(()),
            }
        }
        (Value::Array(expected), Value::Array(found)) => {
            if expected.len() != found.len() {
                return Err(format!(" ({} items instead of {})", found.len(), expected.len()));
            }
            for (index, (expected, found)) in expected.iter().zip(found).enumerate() {
                compare(expected, found).map_err(|path| format!("[{index}]{path}"))?;
            }
            Ok(())
        }
        _ if expected == found => Ok(()),
        _ => Err(format!(" ({found} instead of {expected})")),
    }
}
