//! Answers that lead to places: definition, references, symbols, the call hierarchy, links and folds.
use std::str::FromStr;

use gcode_ide::{
    Access, CallItem, DocumentSymbol as Symbol, FileId, FoldingKind, NavigationTarget, ProgramKey,
    SymbolKind as Kind, TextRange,
};
use lsp_types::{
    CallHierarchyIncomingCall, CallHierarchyIncomingCallsParams, CallHierarchyItem,
    CallHierarchyOutgoingCall, CallHierarchyOutgoingCallsParams, CallHierarchyPrepareParams,
    DocumentHighlight, DocumentHighlightKind, DocumentHighlightParams, DocumentLink, DocumentLinkParams,
    DocumentSymbol, DocumentSymbolParams, DocumentSymbolResponse, FoldingRange, FoldingRangeKind,
    FoldingRangeParams, GotoDefinitionParams, GotoDefinitionResponse, Location, ReferenceParams,
    SymbolInformation, SymbolKind, TextDocumentIdentifier, Uri, WorkspaceSymbolParams,
    WorkspaceSymbolResponse,
};

use crate::document_uri;
use crate::failure::Failure;
use crate::snapshot::Snapshot;
use crate::text_document::TextDocument;

/// Largest number of symbols of a query.
const MAX_SYMBOLS: usize = 1000;

pub(crate) fn definition(
    snapshot: &Snapshot,
    params: GotoDefinitionParams,
) -> Result<Option<GotoDefinitionResponse>, Failure> {
    let (file, offset) = snapshot.place(&params.text_document_position_params)?;
    let Some(found) = snapshot.project.definition(file, offset) else { return Ok(None) };
    let targets = found.targets.iter().filter_map(|target| location_of(snapshot, target));
    Ok(Some(GotoDefinitionResponse::Array(targets.collect())))
}

fn location_of(snapshot: &Snapshot, target: &NavigationTarget) -> Option<Location> {
    snapshot.location(gcode_ide::Location { file: target.file, range: target.selection })
}

pub(crate) fn references(
    snapshot: &Snapshot,
    params: ReferenceParams,
) -> Result<Option<Vec<Location>>, Failure> {
    let (file, offset) = snapshot.place(&params.text_document_position)?;
    let found = snapshot.project.references(file, offset, params.context.include_declaration);
    let mut places = PlaceConverter::new(snapshot);
    Ok(Some(found.iter().filter_map(|reference| places.location(reference.location)).collect()))
}

pub(crate) fn highlights(
    snapshot: &Snapshot,
    params: DocumentHighlightParams,
) -> Result<Option<Vec<DocumentHighlight>>, Failure> {
    let (file, offset) = snapshot.place(&params.text_document_position_params)?;
    let text = snapshot.text_of(file)?;
    let highlight = |reference: &gcode_ide::Reference| DocumentHighlight {
        range: range(&text, reference.location.range),
        kind: Some(match reference.access {
            Access::Declaration => DocumentHighlightKind::TEXT,
            Access::Read => DocumentHighlightKind::READ,
            Access::Write => DocumentHighlightKind::WRITE,
        }),
    };
    Ok(Some(snapshot.project.highlights(file, offset).iter().map(highlight).collect()))
}

/// Converts places, those of one file after the other.
struct PlaceConverter<'a> {
    snapshot: &'a Snapshot,
    last: Option<(FileId, std::sync::Arc<TextDocument>)>,
}

impl<'a> PlaceConverter<'a> {
    fn new(snapshot: &'a Snapshot) -> Self {
        Self { snapshot, last: None }
    }

    fn location(&mut self, place: gcode_ide::Location) -> Option<Location> {
        if self.last.as_ref().is_none_or(|(file, _)| *file != place.file) {
            self.last = Some((place.file, self.snapshot.text(place.file)?));
        }
        let (_, text) = self.last.as_ref()?;
        Some(Location { uri: self.snapshot.uri(place.file)?.clone(), range: range(text, place.range) })
    }
}

fn range(text: &TextDocument, range: TextRange) -> lsp_types::Range {
    text.range(range.start, range.end)
}

fn kind(kind: Kind) -> SymbolKind {
    match kind {
        Kind::Program => SymbolKind::FUNCTION,
        Kind::Number => SymbolKind::KEY,
        Kind::Loop => SymbolKind::NAMESPACE,
    }
}

pub(crate) fn document_symbols(
    snapshot: &Snapshot,
    params: DocumentSymbolParams,
) -> Result<Option<DocumentSymbolResponse>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let text = snapshot.text_of(file)?;
    let symbols = snapshot.project.document_symbols(file);
    if snapshot.client.has_hierarchical_symbols {
        let nested = symbols.into_iter().map(|symbol| nested(&text, symbol)).collect();
        return Ok(Some(DocumentSymbolResponse::Nested(nested)));
    }
    let mut flat = Vec::new();
    for symbol in symbols {
        flatten(&text, &params.text_document.uri, symbol, None, &mut flat);
    }
    Ok(Some(DocumentSymbolResponse::Flat(flat)))
}

#[expect(deprecated, reason = "the type has a field that the protocol has given up")]
fn nested(text: &TextDocument, symbol: Symbol) -> DocumentSymbol {
    let children: Vec<_> = symbol.children.into_iter().map(|child| nested(text, child)).collect();
    DocumentSymbol {
        name: symbol.name,
        detail: Some(symbol.detail).filter(|detail| !detail.is_empty()),
        kind: kind(symbol.kind),
        tags: None,
        deprecated: None,
        range: range(text, symbol.range),
        selection_range: range(text, symbol.selection),
        children: Some(children).filter(|children| !children.is_empty()),
    }
}

#[expect(deprecated, reason = "the type has a field that the protocol has given up")]
fn flatten(
    text: &TextDocument,
    uri: &Uri,
    symbol: Symbol,
    container_name: Option<String>,
    flat: &mut Vec<SymbolInformation>,
) {
    let location = Location { uri: uri.clone(), range: range(text, symbol.range) };
    let (name, kind) = (symbol.name, kind(symbol.kind));
    let inner = Some(name.clone());
    flat.push(SymbolInformation { name, kind, tags: None, deprecated: None, location, container_name });
    for child in symbol.children {
        flatten(text, uri, child, inner.clone(), flat);
    }
}

#[expect(deprecated, reason = "the type has a field that the protocol has given up")]
pub(crate) fn workspace_symbols(
    snapshot: &Snapshot,
    params: WorkspaceSymbolParams,
) -> Result<Option<WorkspaceSymbolResponse>, Failure> {
    let mut places = PlaceConverter::new(snapshot);
    let found = snapshot.project.workspace_symbols(&params.query, MAX_SYMBOLS);
    let symbols = found.into_iter().filter_map(|symbol| {
        Some(SymbolInformation {
            location: places.location(symbol.location)?,
            name: symbol.name,
            kind: kind(symbol.kind),
            tags: None,
            deprecated: None,
            container_name: Some(symbol.container).filter(|name| !name.is_empty()),
        })
    });
    Ok(Some(WorkspaceSymbolResponse::Flat(symbols.collect())))
}

pub(crate) fn prepare_call_hierarchy(
    snapshot: &Snapshot,
    params: CallHierarchyPrepareParams,
) -> Result<Option<Vec<CallHierarchyItem>>, Failure> {
    let (file, offset) = snapshot.place(&params.text_document_position_params)?;
    let item = snapshot.project.call_item(file, offset);
    Ok(item.and_then(|item| call_item(snapshot, item)).map(|item| vec![item]))
}

fn call_item(snapshot: &Snapshot, item: CallItem) -> Option<CallHierarchyItem> {
    let text = snapshot.text(item.key.file)?;
    Some(CallHierarchyItem {
        name: item.name,
        kind: SymbolKind::FUNCTION,
        tags: None,
        detail: Some(item.detail).filter(|detail| !detail.is_empty()),
        uri: snapshot.uri(item.key.file)?.clone(),
        range: range(&text, item.range),
        selection_range: range(&text, item.selection),
        data: None,
    })
}

/// Returns the program of an item that the client hands back.
fn program(snapshot: &Snapshot, item: &CallHierarchyItem) -> Result<ProgramKey, Failure> {
    let file = snapshot.file(&TextDocumentIdentifier { uri: item.uri.clone() })?;
    let offset = snapshot.text_of(file)?.offset(item.selection_range.start);
    let key = snapshot.project.program_at(file, offset);
    key.ok_or_else(|| Failure::params(format!("{} has no program at this place", item.uri.as_str())))
}

pub(crate) fn incoming_calls(
    snapshot: &Snapshot,
    params: CallHierarchyIncomingCallsParams,
) -> Result<Option<Vec<CallHierarchyIncomingCall>>, Failure> {
    let key = program(snapshot, &params.item)?;
    let calls = snapshot.project.incoming_calls(key).into_iter().filter_map(|group| {
        let text = snapshot.text(group.item.key.file)?;
        let from_ranges = group.places.iter().map(|place| range(&text, *place)).collect();
        Some(CallHierarchyIncomingCall { from: call_item(snapshot, group.item)?, from_ranges })
    });
    Ok(Some(calls.collect()))
}

pub(crate) fn outgoing_calls(
    snapshot: &Snapshot,
    params: CallHierarchyOutgoingCallsParams,
) -> Result<Option<Vec<CallHierarchyOutgoingCall>>, Failure> {
    let key = program(snapshot, &params.item)?;
    let text = snapshot.text_of(key.file)?;
    let calls = snapshot.project.outgoing_calls(key).into_iter().filter_map(|group| {
        let from_ranges = group.places.iter().map(|place| range(&text, *place)).collect();
        Some(CallHierarchyOutgoingCall { to: call_item(snapshot, group.item)?, from_ranges })
    });
    Ok(Some(calls.collect()))
}

pub(crate) fn document_links(
    snapshot: &Snapshot,
    params: DocumentLinkParams,
) -> Result<Option<Vec<DocumentLink>>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let text = snapshot.text_of(file)?;
    let programs = snapshot.project.document_links(file).into_iter().map(|link| {
        let target = link_target(snapshot, &link.target);
        (link.range, target, format!("Open {}", link.label))
    });
    let pages = snapshot.project.page_links(file).into_iter().map(|link| {
        let page = snapshot.files.host().explanation(link.code);
        let target = page.and_then(|page| document_uri::of_path(&page));
        (link.range, target, format!("Explain {}", link.code))
    });
    let links = programs.chain(pages).filter(|(_, target, _)| target.is_some());
    let links = links.map(|(place, target, tooltip)| DocumentLink {
        range: range(&text, place),
        target,
        tooltip: Some(tooltip),
        data: None,
    });
    Ok(Some(links.collect()))
}

/// Returns the URI of a program; with its line, if other programs of the file stand before it.
fn link_target(snapshot: &Snapshot, target: &NavigationTarget) -> Option<Uri> {
    let uri = snapshot.uri(target.file)?;
    let first = snapshot.project.file(target.file)?.programs().first()?;
    if first.range.start == target.range.start {
        return Some(uri.clone());
    }
    let line = snapshot.text(target.file)?.position(target.selection.start).line + 1;
    Uri::from_str(&format!("{}#L{line}", uri.as_str())).ok()
}

pub(crate) fn folding_ranges(
    snapshot: &Snapshot,
    params: FoldingRangeParams,
) -> Result<Option<Vec<FoldingRange>>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let text = snapshot.text_of(file)?;
    let has_characters = !snapshot.client.has_line_folding_only;
    let folds = snapshot.project.folding_ranges(file).into_iter().map(|fold| {
        let range = range(&text, fold.range);
        FoldingRange {
            start_line: range.start.line,
            start_character: has_characters.then_some(range.start.character),
            end_line: range.end.line,
            end_character: has_characters.then_some(range.end.character),
            kind: Some(match fold.kind {
                FoldingKind::Comment => FoldingRangeKind::Comment,
                FoldingKind::Program | FoldingKind::Loop | FoldingKind::If => FoldingRangeKind::Region,
            }),
            collapsed_text: None,
        }
    });
    Ok(Some(folds.collect()))
}
