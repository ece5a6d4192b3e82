//! Arguments of requests.
use std::collections::BTreeMap;

use serde::de::Error;
use serde::{Deserialize, Deserializer};
use serde_json::Value;

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(crate) struct Initialize {
    pub(crate) lines_start_at_1: bool,
    pub(crate) columns_start_at_1: bool,
    pub(crate) path_format: Option<String>,
}

impl Default for Initialize {
    fn default() -> Self {
        Self { lines_start_at_1: true, columns_start_at_1: true, path_format: None }
    }
}

/// Arguments of `launch`, those of gcode-sim. Editors add keys of their own.
#[derive(Clone, Debug, Default, Deserialize)]
#[cfg_attr(test, derive(serde::Serialize))]
#[serde(rename_all = "camelCase")]
pub struct Launch {
    /// Path of the program.
    pub program: String,
    /// O number or name of the main program in a file with several.
    #[serde(default, deserialize_with = "program_name")]
    pub main_program: Option<String>,
    /// Path of the machine file.
    #[serde(default)]
    pub machine: Option<String>,
    /// Folders of called programs.
    #[serde(default)]
    pub library: Vec<String>,
    /// Settings of the control by key: numbers, texts, true and false.
    #[serde(default)]
    pub control: BTreeMap<String, Value>,
    /// Variables before the start: `"#100": 1`.
    #[serde(default)]
    pub variables: BTreeMap<String, Value>,
    /// Path of the reference.
    #[serde(default)]
    pub reference: Option<String>,
    /// The run stops in front of its first block.
    #[serde(default)]
    pub stop_on_entry: bool,
    /// The run goes through without a stop.
    #[serde(default)]
    pub no_debug: bool,
}

/// Reads the name of a program; 8101 is O8101.
fn program_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<String>, D::Error> {
    match Value::deserialize(deserializer)? {
        Value::String(name) => Ok(Some(name)),
        Value::Number(number) if number.is_u64() => Ok(Some(format!("O{number}"))),
        other => Err(D::Error::custom(format!("{other} is no O number and no name of a program"))),
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct Restart {
    #[serde(default)]
    pub(crate) arguments: Option<Value>,
}

#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Source {
    #[serde(default)]
    pub(crate) path: Option<String>,
    #[serde(default)]
    pub(crate) source_reference: Option<i64>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SourceBreakpoint {
    pub(crate) line: i64,
    #[serde(default)]
    pub(crate) column: Option<i64>,
    #[serde(flatten)]
    pub(crate) conditions: BreakpointConditions,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BreakpointConditions {
    #[serde(default)]
    pub(crate) condition: Option<String>,
    #[serde(default)]
    pub(crate) hit_condition: Option<String>,
    #[serde(default)]
    pub(crate) log_message: Option<String>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct SetBreakpoints {
    pub(crate) source: Source,
    #[serde(default)]
    pub(crate) breakpoints: Option<Vec<SourceBreakpoint>>,
    /// The form of old clients.
    #[serde(default)]
    pub(crate) lines: Vec<i64>,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct FunctionBreakpoint {
    pub(crate) name: String,
    #[serde(flatten)]
    pub(crate) conditions: BreakpointConditions,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct SetFunctionBreakpoints {
    pub(crate) breakpoints: Vec<FunctionBreakpoint>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct DataBreakpointInfo {
    pub(crate) name: String,
    #[serde(default)]
    pub(crate) variables_reference: Option<i64>,
    #[serde(default)]
    pub(crate) frame_id: Option<i64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct DataBreakpoint {
    pub(crate) data_id: String,
    #[serde(default)]
    pub(crate) access_type: Option<String>,
    #[serde(flatten)]
    pub(crate) conditions: BreakpointConditions,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct SetDataBreakpoints {
    pub(crate) breakpoints: Vec<DataBreakpoint>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SetExceptionBreakpoints {
    pub(crate) filters: Vec<String>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BreakpointLocations {
    pub(crate) source: Source,
    pub(crate) line: i64,
    #[serde(default)]
    pub(crate) end_line: Option<i64>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Thread {
    pub(crate) thread_id: i64,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct StackTrace {
    pub(crate) thread_id: i64,
    #[serde(default)]
    pub(crate) start_frame: Option<i64>,
    #[serde(default)]
    pub(crate) levels: Option<i64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Scopes {
    pub(crate) frame_id: i64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Variables {
    pub(crate) variables_reference: i64,
    #[serde(default)]
    pub(crate) filter: Option<String>,
    #[serde(default)]
    pub(crate) start: Option<i64>,
    #[serde(default)]
    pub(crate) count: Option<i64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SetVariable {
    pub(crate) variables_reference: i64,
    pub(crate) name: String,
    pub(crate) value: String,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SetExpression {
    pub(crate) expression: String,
    pub(crate) value: String,
    #[serde(default)]
    pub(crate) frame_id: Option<i64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Evaluate {
    pub(crate) expression: String,
    #[serde(default)]
    pub(crate) frame_id: Option<i64>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SourceText {
    #[serde(default)]
    pub(crate) source: Option<Source>,
    #[serde(default)]
    pub(crate) source_reference: i64,
}

#[derive(Clone, Debug, Deserialize)]
pub(crate) struct GotoTargets {
    pub(crate) source: Source,
    pub(crate) line: i64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Goto {
    pub(crate) thread_id: i64,
    pub(crate) target_id: i64,
}
