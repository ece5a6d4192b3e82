//! Answers with explanations: hover with values of the run, completion, signatures of macro calls.
use std::sync::Arc;

use gcode_control::Progress;
use gcode_ide::{CompletionKind, FileId, Symbol, TextRange, VariableScope};
use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionList, CompletionParams, CompletionResponse,
    CompletionTextEdit, Documentation, Hover, HoverContents, HoverParams, InsertTextFormat, MarkupContent,
    MarkupKind, ParameterInformation, ParameterLabel, SignatureHelp, SignatureHelpParams,
    SignatureInformation, TextEdit,
};

use crate::background_run;
use crate::failure::Failure;
use crate::run_facts::{RunFacts, number_text, value_text};
use crate::snapshot::Snapshot;

pub(crate) fn hover(
    snapshot: &Snapshot,
    params: HoverParams,
    _: &Arc<Progress>,
) -> Result<Option<Hover>, Failure> {
    let (file, offset) = snapshot.place(&params.text_document_position_params)?;
    let Some(found) = snapshot.project.hover(file, offset) else { return Ok(None) };
    let text = snapshot.text_of(file)?;
    let mut markdown = found.markdown;
    if let Some(Symbol::Variable { number, scope, .. }) = found.symbol
        && let Ok(facts) = background_run::facts(snapshot, file)
    {
        let value = value_in_run(&facts, found.range, number, scope);
        if !markdown.is_empty() {
            markdown.push_str("\n\n");
        }
        markdown.push_str(&value);
    }
    if markdown.is_empty() {
        return Ok(None);
    }
    let contents = HoverContents::Markup(markup(markdown, snapshot.client.has_markdown_hover));
    Ok(Some(Hover { contents, range: Some(text.range(found.range.start, found.range.end)) }))
}

/// Returns the sentence on the value of a variable in the run.
fn value_in_run(facts: &RunFacts, range: TextRange, number: u32, scope: VariableScope) -> String {
    let run = match (facts.main.as_str(), &facts.stop) {
        ("", stop) => return format!("No run: {}.", stop.as_deref().unwrap_or("there is no program")),
        (main, None) => format!("run of {main}"),
        (main, Some(stop)) => format!("run of {main}, which stops with {stop}"),
    };
    if let Some(values) = facts.in_block(range, number) {
        let range = values.range.filter(|(low, high)| low != high);
        let spread = range.map_or_else(String::new, |(low, high)| {
            format!(" ({} times, {} to {})", values.count, number_text(low), number_text(high))
        });
        return match values.last.is_vacant() {
            true => format!("`#{number}` is **vacant** here{spread}; {run}."),
            false => {
                format!("`#{number}` = **{}**, the last value here{spread}; {run}.", value_text(values.last))
            }
        };
    }
    match facts.commons.get(&number) {
        Some(value) => format!("`#{number}` = **{}** at the end; {run}.", number_text(*value)),
        None if scope == VariableScope::Common => format!("`#{number}` is **vacant** at the end; {run}."),
        None if facts.is_executed(range.start) => format!("No value of `#{number}` is recorded; {run}."),
        None => format!("This block is not executed; {run}."),
    }
}

/// Returns Markdown as the client can show it.
fn markup(markdown: String, has_markdown: bool) -> MarkupContent {
    if has_markdown {
        return MarkupContent { kind: MarkupKind::Markdown, value: markdown };
    }
    let is_mark = |c: char| matches!(c, '`' | '*');
    MarkupContent { kind: MarkupKind::PlainText, value: markdown.replace(is_mark, "") }
}

pub(crate) fn completion(
    snapshot: &Snapshot,
    params: CompletionParams,
) -> Result<Option<CompletionResponse>, Failure> {
    let (file, offset) = snapshot.place(&params.text_document_position)?;
    let text = snapshot.text_of(file)?;
    let found = snapshot.project.completions(file, offset).into_iter().enumerate();
    let items = found.map(|(order, completion)| {
        let range = text.range(completion.replace.start, completion.replace.end);
        CompletionItem {
            filter_text: Some(completion.insert.clone()),
            label: completion.label,
            kind: Some(match completion.kind {
                CompletionKind::Argument => CompletionItemKind::PROPERTY,
                CompletionKind::Number => CompletionItemKind::REFERENCE,
                CompletionKind::Program => CompletionItemKind::MODULE,
                CompletionKind::Variable => CompletionItemKind::VARIABLE,
                CompletionKind::GCode | CompletionKind::MCode => CompletionItemKind::ENUM_MEMBER,
                CompletionKind::Function => CompletionItemKind::FUNCTION,
                CompletionKind::Keyword => CompletionItemKind::KEYWORD,
            }),
            detail: Some(completion.detail).filter(|detail| !detail.is_empty()),
            sort_text: Some(format!("{order:05}")),
            insert_text_format: Some(InsertTextFormat::PLAIN_TEXT),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit { range, new_text: completion.insert })),
            ..CompletionItem::default()
        }
    });
    Ok(Some(CompletionResponse::List(CompletionList { is_incomplete: false, items: items.collect() })))
}

pub(crate) fn signature_help(
    snapshot: &Snapshot,
    params: SignatureHelpParams,
) -> Result<Option<SignatureHelp>, Failure> {
    let (file, offset): (FileId, u32) = snapshot.place(&params.text_document_position_params)?;
    let Some(found) = snapshot.project.signature_help(file, offset) else { return Ok(None) };
    let client = &snapshot.client;
    let documentation = |text: String| {
        let text = Some(text).filter(|text| !text.is_empty())?;
        Some(Documentation::MarkupContent(markup(text, client.has_markdown_signatures)))
    };
    let label = &found.label;
    // The protocol counts the characters of a label in UTF-16 units, whatever the encoding of positions.
    let units = |end: u32| label[..end as usize].encode_utf16().count() as u32;
    let parameters = found.parameters.into_iter().map(|parameter| {
        let range = parameter.label;
        let label = match client.has_label_offsets {
            true => ParameterLabel::LabelOffsets([units(range.start), units(range.end)]),
            false => ParameterLabel::Simple(label[range.start as usize..range.end as usize].to_owned()),
        };
        ParameterInformation { label, documentation: documentation(parameter.documentation) }
    });
    let parameters: Vec<_> = parameters.collect();
    let active_parameter = found.active.map(|active| active as u32);
    Ok(Some(SignatureHelp {
        signatures: vec![SignatureInformation {
            label: found.label,
            documentation: documentation(found.documentation),
            parameters: Some(parameters),
            active_parameter,
        }],
        active_signature: Some(0),
        active_parameter,
    }))
}
