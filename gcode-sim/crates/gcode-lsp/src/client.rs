//! What the client can do, as far as an answer depends on it.
use lsp_types::{ClientCapabilities, CodeActionClientCapabilities, InitializeParams, MarkupKind};

use crate::text_document::PositionEncoding;

/// Capabilities of the client.
#[derive(Clone, Debug, Default)]
pub(crate) struct Client {
    pub encoding: PositionEncoding,
    /// Edits can carry the versions of their documents.
    pub has_document_changes: bool,
    pub has_hierarchical_symbols: bool,
    pub has_disabled_actions: bool,
    /// Code actions may carry their edits; otherwise they are commands.
    pub has_action_literals: bool,
    pub has_prepared_rename: bool,
    pub has_related_information: bool,
    pub has_diagnostic_tags: bool,
    /// A diagnostic may link the page of its code.
    pub has_code_description: bool,
    pub has_markdown_hover: bool,
    pub has_markdown_signatures: bool,
    pub has_label_offsets: bool,
    pub has_show_document: bool,
    pub has_configuration: bool,
    pub can_register_watchers: bool,
    pub has_line_folding_only: bool,
    pub has_apply_edit: bool,
    /// The client asks again for inlay hints when it is told to.
    pub can_refresh_hints: bool,
    pub can_refresh_tokens: bool,
}

impl Client {
    pub(crate) fn new(params: &InitializeParams) -> Self {
        let ClientCapabilities { workspace, text_document, window, general, .. } = &params.capabilities;
        let (workspace, text, window) = (workspace.as_ref(), text_document.as_ref(), window.as_ref());
        let encodings = general.as_ref().and_then(|general| general.position_encodings.as_deref());
        let edit = workspace.and_then(|workspace| workspace.workspace_edit.as_ref());
        let actions = text.and_then(|text| text.code_action.as_ref());
        let diagnostics = text.and_then(|text| text.publish_diagnostics.as_ref());
        let signature = text.and_then(|text| text.signature_help.as_ref()?.signature_information.as_ref());
        let has_markdown = |kinds: Option<&Vec<MarkupKind>>| {
            kinds.is_some_and(|kinds| kinds.contains(&MarkupKind::Markdown))
        };
        let symbols =
            text.and_then(|text| text.document_symbol.as_ref()?.hierarchical_document_symbol_support);
        let hover = text.and_then(|text| text.hover.as_ref()?.content_format.as_ref());
        let watchers = workspace.and_then(|workspace| workspace.did_change_watched_files.as_ref());
        Self {
            encoding: PositionEncoding::negotiate(encodings),
            has_document_changes: is(edit.and_then(|edit| edit.document_changes)),
            has_hierarchical_symbols: is(symbols),
            has_disabled_actions: is(
                actions.and_then(|actions: &CodeActionClientCapabilities| actions.disabled_support)
            ),
            has_action_literals: actions.is_some_and(|actions| actions.code_action_literal_support.is_some()),
            has_prepared_rename: is(text.and_then(|text| text.rename.as_ref()?.prepare_support)),
            has_related_information: is(diagnostics.and_then(|diagnostics| diagnostics.related_information)),
            has_diagnostic_tags: diagnostics.is_some_and(|diagnostics| diagnostics.tag_support.is_some()),
            has_code_description: is(diagnostics.and_then(|diagnostics| diagnostics.code_description_support)),
            has_markdown_hover: has_markdown(hover),
            has_markdown_signatures: has_markdown(
                signature.and_then(|signature| signature.documentation_format.as_ref()),
            ),
            has_label_offsets: is(signature
                .and_then(|signature| signature.parameter_information.as_ref()?.label_offset_support)),
            has_show_document: window
                .and_then(|window| window.show_document.as_ref())
                .is_some_and(|capabilities| capabilities.support),
            has_configuration: is(workspace.and_then(|workspace| workspace.configuration)),
            can_register_watchers: is(watchers.and_then(|watchers| watchers.dynamic_registration)),
            has_line_folding_only: is(text.and_then(|text| text.folding_range.as_ref()?.line_folding_only)),
            can_refresh_hints: is(
                workspace.and_then(|workspace| workspace.inlay_hint.as_ref()?.refresh_support)
            ),
            can_refresh_tokens: is(
                workspace.and_then(|workspace| workspace.semantic_tokens.as_ref()?.refresh_support)
            ),
            has_apply_edit: is(workspace.and_then(|workspace| workspace.apply_edit)),
        }
    }
}

fn is(flag: Option<bool>) -> bool {
    flag.unwrap_or_default()
}
