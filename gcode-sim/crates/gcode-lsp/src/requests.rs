//! Requests by method: the handler of each, and whether it answers at once or in the background.
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use gcode_control::Progress;
use lsp_types::request::{
    CallHierarchyIncomingCalls, CallHierarchyOutgoingCalls, CallHierarchyPrepare, CodeActionRequest,
    CodeLensRequest, Completion, DocumentHighlightRequest, DocumentLinkRequest, DocumentSymbolRequest,
    ExecuteCommand, FoldingRangeRequest, Formatting, GotoDefinition, HoverRequest, InlayHintRequest,
    PrepareRenameRequest, RangeFormatting, References, Rename, Request, SemanticTokensFullRequest,
    SemanticTokensRangeRequest, SignatureHelpRequest, WorkspaceSymbolRequest,
};
use serde_json::Value;

use crate::commands::{self, CommandResult};
use crate::failure::Failure;
use crate::snapshot::Snapshot;
use crate::{code_actions, edits, hints, navigation, semantic_tokens, text_help};

/// Handler of a method.
#[derive(Clone, Copy)]
pub(crate) enum Handler {
    /// Answers at once.
    Now(fn(&Snapshot, Value) -> Result<Value, Failure>),
    /// Answers for a whole text, which may be long, in the background.
    Aside(fn(&Snapshot, Value) -> Result<Value, Failure>),
    /// Runs a program, and so answers in the background.
    Later(fn(&Snapshot, Value, &Arc<Progress>) -> Result<Value, Failure>),
    /// Executes a command in the background.
    Command(fn(&Snapshot, Value, &Arc<Progress>) -> Result<CommandResult, Failure>),
}

/// Methods whose answer needs all files of the workspace.
pub(crate) const OF_WORKSPACE: [&str; 5] = [
    References::METHOD,
    Rename::METHOD,
    WorkspaceSymbolRequest::METHOD,
    CallHierarchyIncomingCalls::METHOD,
    CallHierarchyOutgoingCalls::METHOD,
];

/// Returns the handler of a method.
pub(crate) fn handler(method: &str) -> Option<Handler> {
    macro_rules! now {
        ($request:ty, $handler:path) => {
            Handler::Now(|snapshot, params| {
                encode::<$request>($handler(snapshot, decode::<$request>(params)?)?)
            })
        };
    }
    macro_rules! aside {
        ($request:ty, $handler:path) => {
            Handler::Aside(|snapshot, params| {
                encode::<$request>($handler(snapshot, decode::<$request>(params)?)?)
            })
        };
    }
    macro_rules! later {
        ($request:ty, $handler:path) => {
            Handler::Later(|snapshot, params, progress| {
                encode::<$request>($handler(snapshot, decode::<$request>(params)?, progress)?)
            })
        };
    }
    Some(match method {
        GotoDefinition::METHOD => now!(GotoDefinition, navigation::definition),
        References::METHOD => now!(References, navigation::references),
        DocumentHighlightRequest::METHOD => now!(DocumentHighlightRequest, navigation::highlights),
        DocumentSymbolRequest::METHOD => aside!(DocumentSymbolRequest, navigation::document_symbols),
        WorkspaceSymbolRequest::METHOD => now!(WorkspaceSymbolRequest, navigation::workspace_symbols),
        CallHierarchyPrepare::METHOD => now!(CallHierarchyPrepare, navigation::prepare_call_hierarchy),
        CallHierarchyIncomingCalls::METHOD => now!(CallHierarchyIncomingCalls, navigation::incoming_calls),
        CallHierarchyOutgoingCalls::METHOD => now!(CallHierarchyOutgoingCalls, navigation::outgoing_calls),
        DocumentLinkRequest::METHOD => aside!(DocumentLinkRequest, navigation::document_links),
        FoldingRangeRequest::METHOD => aside!(FoldingRangeRequest, navigation::folding_ranges),
        Completion::METHOD => now!(Completion, text_help::completion),
        SignatureHelpRequest::METHOD => now!(SignatureHelpRequest, text_help::signature_help),
        SemanticTokensFullRequest::METHOD => aside!(SemanticTokensFullRequest, semantic_tokens::full),
        SemanticTokensRangeRequest::METHOD => now!(SemanticTokensRangeRequest, semantic_tokens::range),
        CodeLensRequest::METHOD => aside!(CodeLensRequest, commands::code_lenses),
        PrepareRenameRequest::METHOD => now!(PrepareRenameRequest, edits::prepare_rename),
        HoverRequest::METHOD => later!(HoverRequest, text_help::hover),
        InlayHintRequest::METHOD => later!(InlayHintRequest, hints::inlay_hints),
        Rename::METHOD => later!(Rename, edits::rename),
        Formatting::METHOD => later!(Formatting, edits::format),
        RangeFormatting::METHOD => later!(RangeFormatting, edits::format_range),
        CodeActionRequest::METHOD => later!(CodeActionRequest, code_actions::code_actions),
        ExecuteCommand::METHOD => Handler::Command(|snapshot, params, progress| {
            commands::execute(snapshot, decode::<ExecuteCommand>(params)?, progress)
        }),
        _ => return None,
    })
}

fn decode<R: Request>(params: Value) -> Result<R::Params, Failure> {
    serde_json::from_value(params).map_err(|error| Failure::params(format!("{}: {error}", R::METHOD)))
}

fn encode<R: Request>(result: R::Result) -> Result<Value, Failure> {
    serde_json::to_value(result).map_err(|error| Failure::internal(error.to_string()))
}

/// Calls a handler; a panic in it becomes an error of its request.
pub(crate) fn guarded<T>(method: &str, handler: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(handler)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
        Err(Failure::internal(format!("{method} failed inside the server: {text}")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_of_its_request() {
        let result: Result<(), Failure> = guarded("textDocument/hover", || panic!("index out of bounds"));
        let message = "textDocument/hover failed inside the server: index out of bounds";
        assert_eq!(result, Err(Failure::internal(message)));
        assert_eq!(guarded("textDocument/hover", || Ok(1)), Ok(1));
    }
}
