//! Semantic tokens: the legend, and the tokens of a text in the protocol's relative form.
use gcode_ide::{FileId, TextRange, TokenKind};
use lsp_types::{
    Position, Range, SemanticToken, SemanticTokenModifier, SemanticTokenType, SemanticTokens,
    SemanticTokensLegend, SemanticTokensParams, SemanticTokensRangeParams, SemanticTokensRangeResult,
    SemanticTokensResult,
};

use crate::failure::Failure;
use crate::snapshot::Snapshot;

/// Modifiers in the order of their bits.
const MODIFIERS: [SemanticTokenModifier; 2] =
    [SemanticTokenModifier::DECLARATION, SemanticTokenModifier::MODIFICATION];

/// Largest text whose tokens are answered all at once, bytes: in JSON they are ten times as long. Of a longer one a client asks
/// for those of the lines that it shows.
const MAX_TEXT: usize = 2 << 20;

/// Returns the names of the tokens: those of the protocol where it has one, own ones for motions and scopes.
pub(crate) fn legend() -> SemanticTokensLegend {
    let token_types = TokenKind::ALL.map(token_type).to_vec();
    SemanticTokensLegend { token_types, token_modifiers: MODIFIERS.to_vec() }
}

fn token_type(kind: TokenKind) -> SemanticTokenType {
    match kind {
        TokenKind::Comment => SemanticTokenType::COMMENT,
        TokenKind::Number => SemanticTokenType::NUMBER,
        TokenKind::Text => SemanticTokenType::STRING,
        TokenKind::Keyword => SemanticTokenType::KEYWORD,
        TokenKind::Operator => SemanticTokenType::OPERATOR,
        TokenKind::Function => SemanticTokenType::FUNCTION,
        TokenKind::LocalVariable => SemanticTokenType::new("localVariable"),
        TokenKind::CommonVariable => SemanticTokenType::new("commonVariable"),
        TokenKind::SystemVariable => SemanticTokenType::new("systemVariable"),
        TokenKind::SequenceNumber => SemanticTokenType::new("sequenceNumber"),
        TokenKind::Program => SemanticTokenType::new("program"),
        TokenKind::RapidMotion => SemanticTokenType::new("rapidMotion"),
        TokenKind::FeedMotion => SemanticTokenType::new("feedMotion"),
        TokenKind::ArcMotion => SemanticTokenType::new("arcMotion"),
        TokenKind::CycleMotion => SemanticTokenType::new("cycleMotion"),
        TokenKind::Call => SemanticTokenType::new("call"),
        TokenKind::GCode => SemanticTokenType::new("gCode"),
        TokenKind::MCode => SemanticTokenType::new("mCode"),
        TokenKind::Address => SemanticTokenType::new("address"),
        TokenKind::Mark => SemanticTokenType::new("mark"),
    }
}

pub(crate) fn full(
    snapshot: &Snapshot,
    params: SemanticTokensParams,
) -> Result<Option<SemanticTokensResult>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    if MAX_TEXT < snapshot.text_of(file)?.bytes().len() {
        return Ok(None);
    }
    Ok(Some(SemanticTokensResult::Tokens(tokens(snapshot, file, None)?)))
}

pub(crate) fn range(
    snapshot: &Snapshot,
    params: SemanticTokensRangeParams,
) -> Result<Option<SemanticTokensRangeResult>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let (start, end) = snapshot.text_of(file)?.offsets(params.range);
    let tokens = tokens(snapshot, file, Some(TextRange::new(start, end)))?;
    Ok(Some(SemanticTokensRangeResult::Tokens(tokens)))
}

/// Returns tokens, each with its distance from the one before.
fn tokens(snapshot: &Snapshot, file: FileId, range: Option<TextRange>) -> Result<SemanticTokens, Failure> {
    let text = snapshot.text_of(file)?;
    let (mut line, mut character) = (0, 0);
    // Place of the token before.
    let mut last = (0, Position::new(0, 0));
    let mut data = Vec::new();
    for token in snapshot.project.semantic_tokens(file, range) {
        let start = text.position_behind(last, token.range.start);
        last = (token.range.start, start);
        let range = Range::new(start, text.position_behind(last, token.range.end));
        // A token of the protocol is part of one line.
        if range.start.line != range.end.line || range.start == range.end {
            continue;
        }
        let delta_line = range.start.line - line;
        let from = if delta_line == 0 { character } else { 0 };
        let is = |flag: bool, bit: u32| if flag { 1 << bit } else { 0 };
        data.push(SemanticToken {
            delta_line,
            delta_start: range.start.character - from,
            length: range.end.character - range.start.character,
            token_type: TokenKind::ALL.iter().position(|kind| *kind == token.kind).unwrap_or_default() as u32,
            token_modifiers_bitset: is(token.is_declaration, 0) | is(token.is_written, 1),
        });
        (line, character) = (range.start.line, range.start.character);
    }
    Ok(SemanticTokens { result_id: None, data })
}
