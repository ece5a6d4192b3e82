//! Keys of a launch: a slip of the pen is refused, a key that nobody uses is told.
use serde_json::{Map, Value};

use gcode_lang::similar;

/// Keys that the debugger uses.
const KEYS: [&str; 9] = [
    "program",
    "mainProgram",
    "machine",
    "library",
    "control",
    "variables",
    "reference",
    "stopOnEntry",
    "noDebug",
];

/// Keys that editors put into any launch for themselves; those that begin with `__` are theirs too.
const OF_EDITORS: [&str; 19] = [
    "type",
    "request",
    "name",
    "preLaunchTask",
    "postDebugTask",
    "presentation",
    "internalConsoleOptions",
    "debugServer",
    "serverReadyAction",
    "suppressMultipleSessionWarning",
    "windows",
    "linux",
    "osx",
    "cwd",
    "args",
    "env",
    "envFile",
    "console",
    "trace",
];

/// Returns a sentence for each key that neither the debugger nor an editor is known to use.
///
/// # Errors
/// A key is a slip of one of the debugger's: without it the run would be another one.
pub(super) fn unused(arguments: &Map<String, Value>) -> Result<Vec<String>, String> {
    let is_known = |key: &str| KEYS.contains(&key) || OF_EDITORS.contains(&key) || key.starts_with("__");
    let unknown: Vec<&str> = arguments.keys().map(String::as_str).filter(|key| !is_known(key)).collect();
    if let Some((key, meant)) = unknown.iter().find_map(|key| Some((key, similar(key, KEYS)?))) {
        return Err(format!("launch: there is no key '{key}': did you mean '{meant}'?"));
    }
    let sentence = |key| format!("launch: the key '{key}' is not used; the keys are {}", KEYS.join(", "));
    Ok(unknown.into_iter().map(sentence).collect())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::protocol::arguments::Launch;

    fn of(arguments: &Value) -> Result<Vec<String>, String> {
        unused(arguments.as_object().unwrap())
    }

    #[test]
    fn the_keys_are_those_of_the_launch() {
        let mut keys: Vec<_> = KEYS.map(str::to_owned).to_vec();
        keys.sort();
        let launch = serde_json::to_value(Launch::default()).unwrap();
        assert_eq!(launch.as_object().unwrap().keys().cloned().collect::<Vec<_>>(), keys);
    }

    #[test]
    fn a_slip_is_refused_with_the_key_that_is_meant() {
        for (slip, meant) in [
            ("machne", "machine"),
            ("Machine", "machine"),
            ("refrence", "reference"),
            ("libary", "library"),
            ("controls", "control"),
            ("stopOnentry", "stopOnEntry"),
            ("mainprogram", "mainProgram"),
        ] {
            let refusal = of(&json!({ "program": "O1.nc", slip: "x" })).unwrap_err();
            assert_eq!(refusal, format!("launch: there is no key '{slip}': did you mean '{meant}'?"));
        }
    }

    #[test]
    fn keys_of_editors_are_no_matter_and_others_are_told() {
        let mut arguments: Map<String, Value> =
            KEYS.map(|key| (key.to_owned(), Value::Null)).into_iter().collect();
        arguments.extend(OF_EDITORS.map(|key| (key.to_owned(), Value::Null)));
        arguments.extend(["__sessionId", "__configurationTarget"].map(|key| (key.to_owned(), Value::Null)));
        assert_eq!(unused(&arguments), Ok(Vec::new()));
        let told = of(&json!({ "program": "O1.nc", "dialect": "haas-ngc" })).unwrap();
        assert_eq!(told.len(), 1);
        assert!(
            told[0].starts_with("launch: the key 'dialect' is not used; the keys are program, mainProgram, ")
        );
    }
}
