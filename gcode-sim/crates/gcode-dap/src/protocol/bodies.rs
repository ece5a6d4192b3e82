//! Bodies of responses and events.
use serde::Serialize;

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Capabilities {
    pub(crate) supports_configuration_done_request: bool,
    pub(crate) supports_function_breakpoints: bool,
    pub(crate) supports_conditional_breakpoints: bool,
    pub(crate) supports_hit_conditional_breakpoints: bool,
    pub(crate) supports_evaluate_for_hovers: bool,
    pub(crate) supports_step_back: bool,
    pub(crate) supports_set_variable: bool,
    pub(crate) supports_set_expression: bool,
    pub(crate) supports_restart_request: bool,
    pub(crate) supports_goto_targets_request: bool,
    pub(crate) supports_exception_info_request: bool,
    pub(crate) supports_delayed_stack_trace_loading: bool,
    pub(crate) supports_loaded_sources_request: bool,
    pub(crate) supports_log_points: bool,
    pub(crate) supports_terminate_request: bool,
    pub(crate) supports_data_breakpoints: bool,
    pub(crate) supports_breakpoint_locations_request: bool,
    pub(crate) exception_breakpoint_filters: Vec<ExceptionFilter>,
}

#[derive(Debug, Serialize)]
pub(crate) struct ExceptionFilter {
    pub(crate) filter: &'static str,
    pub(crate) label: &'static str,
    pub(crate) description: &'static str,
    pub(crate) default: bool,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Source {
    pub(crate) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) path: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) source_reference: Option<i64>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Breakpoint {
    pub(crate) id: i64,
    pub(crate) verified: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) message: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<Source>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) line: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) column: Option<i64>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Breakpoints {
    pub(crate) breakpoints: Vec<Breakpoint>,
}

#[derive(Debug, Serialize)]
pub(crate) struct FilterAnswers {
    pub(crate) breakpoints: Vec<FilterAnswer>,
}

#[derive(Debug, Serialize)]
pub(crate) struct FilterAnswer {
    pub(crate) verified: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) message: Option<String>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct DataBreakpointInfo {
    pub(crate) data_id: Option<String>,
    pub(crate) description: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) access_types: Vec<&'static str>,
    pub(crate) can_persist: bool,
}

#[derive(Debug, Serialize)]
pub(crate) struct BreakpointLocations {
    pub(crate) breakpoints: Vec<Location>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Location {
    pub(crate) line: i64,
    pub(crate) column: i64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Threads {
    pub(crate) threads: Vec<Thread>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Thread {
    pub(crate) id: i64,
    pub(crate) name: String,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Continue {
    pub(crate) all_threads_continued: bool,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct StackTrace {
    pub(crate) stack_frames: Vec<StackFrame>,
    pub(crate) total_frames: usize,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct StackFrame {
    pub(crate) id: i64,
    pub(crate) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<Source>,
    pub(crate) line: i64,
    pub(crate) column: i64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Scopes {
    pub(crate) scopes: Vec<Scope>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Scope {
    pub(crate) name: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) presentation_hint: Option<&'static str>,
    pub(crate) variables_reference: i64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) named_variables: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) indexed_variables: Option<usize>,
    pub(crate) expensive: bool,
}

#[derive(Debug, Serialize)]
pub(crate) struct Variables {
    pub(crate) variables: Vec<Variable>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) value: String,
    #[serde(rename = "type", skip_serializing_if = "Option::is_none")]
    pub(crate) kind: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) presentation_hint: Option<PresentationHint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) evaluate_name: Option<String>,
    pub(crate) variables_reference: i64,
}

#[derive(Debug, Serialize)]
pub(crate) struct PresentationHint {
    pub(crate) attributes: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SetVariable {
    pub(crate) value: String,
    #[serde(rename = "type")]
    pub(crate) kind: &'static str,
    pub(crate) variables_reference: i64,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Evaluate {
    pub(crate) result: String,
    #[serde(rename = "type")]
    pub(crate) kind: &'static str,
    pub(crate) variables_reference: i64,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ExceptionInfo {
    pub(crate) exception_id: String,
    pub(crate) description: String,
    pub(crate) break_mode: &'static str,
    pub(crate) details: ExceptionDetails,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ExceptionDetails {
    pub(crate) message: String,
    pub(crate) type_name: String,
    pub(crate) stack_trace: String,
}

#[derive(Debug, Serialize)]
pub(crate) struct SourceText {
    pub(crate) content: String,
}

#[derive(Debug, Serialize)]
pub(crate) struct LoadedSources {
    pub(crate) sources: Vec<Source>,
}

#[derive(Debug, Serialize)]
pub(crate) struct GotoTargets {
    pub(crate) targets: Vec<GotoTarget>,
}

#[derive(Debug, Serialize)]
pub(crate) struct GotoTarget {
    pub(crate) id: i64,
    pub(crate) label: String,
    pub(crate) line: i64,
    pub(crate) column: i64,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct StopEvent {
    pub(crate) reason: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) description: Option<String>,
    pub(crate) thread_id: i64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) text: Option<String>,
    pub(crate) all_threads_stopped: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) hit_breakpoint_ids: Vec<i64>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Output {
    pub(crate) category: &'static str,
    pub(crate) output: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) source: Option<Source>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) line: Option<i64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) column: Option<i64>,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct ExitEvent {
    pub(crate) exit_code: i64,
}

#[derive(Debug, Serialize)]
pub(crate) struct BreakpointChange {
    pub(crate) reason: &'static str,
    pub(crate) breakpoint: Breakpoint,
}

#[derive(Debug, Serialize)]
pub(crate) struct LoadedSource {
    pub(crate) reason: &'static str,
    pub(crate) source: Source,
}
