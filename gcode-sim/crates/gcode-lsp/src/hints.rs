//! Inlay hints of a run: single values of variables, and deviations of holes at their calls.
use std::sync::Arc;

use gcode_control::Progress;
use gcode_ide::{TextRange, VariableScope};
use gcode_lang::control::Settings;
use gcode_lang::source::SourceId;
use gcode_lang::syntax::ast::{Expr, ExprKind, Item, Statement};
use gcode_lang::syntax::block_at;
use gcode_session::{ExecutedBlock, VariableRole, VariableValues};
use lsp_types::{InlayHint, InlayHintLabel, InlayHintParams, InlayHintTooltip};

use crate::background_run;
use crate::failure::Failure;
use crate::run_facts::{HolesOfLine, RunFacts, value_text};
use crate::snapshot::Snapshot;
use crate::text_document::TextDocument;

/// Largest number of variables in a hint.
const MAX_VALUES: usize = 4;

pub(crate) fn inlay_hints(
    snapshot: &Snapshot,
    params: InlayHintParams,
    _: &Arc<Progress>,
) -> Result<Option<Vec<InlayHint>>, Failure> {
    let file = snapshot.file(&params.text_document)?;
    let text = snapshot.text_of(file)?;
    let facts = background_run::facts(snapshot, file)?;
    // Values of a run that is cut off may still change.
    if facts.is_cut_off {
        return Ok(Some(Vec::new()));
    }
    let (start, end) = text.offsets(params.range);
    let range = TextRange::new(start, end);
    let mut hints = value_hints(&text, &facts, range, snapshot.project.settings());
    let first = params.range.start.line.saturating_add(1);
    let last = params.range.end.line.saturating_add(1);
    for (line, holes) in facts.holes.range(first..=last.max(first)) {
        let errors = holes.errors.iter().map(|error| format!(", FAIL {error}"));
        let tooltip =
            format!("Position of the hole against the reference (ISO 1101){}", errors.collect::<String>());
        hints.push(hint(&text, *line, holes_text(holes), &tooltip));
    }
    hints.sort_by_key(|hint| hint.position);
    Ok(Some(hints))
}

fn value_hints(
    text: &TextDocument,
    facts: &RunFacts,
    range: TextRange,
    settings: &Settings,
) -> Vec<InlayHint> {
    let is_in =
        |executed: &&ExecutedBlock| range.start <= executed.block.start && executed.block.start <= range.end;
    let hints = facts.blocks.iter().filter(is_in).filter_map(|executed| {
        let label = values_of_block(text, executed, settings)?;
        let line = text.position(executed.block.start).line + 1;
        Some(hint(text, line, label, "Value in the run, the same at each execution"))
    });
    hints.collect()
}

/// Returns the hint of a block: the variables with one value in all its executions, an assigned one alone.
fn values_of_block(text: &TextDocument, executed: &ExecutedBlock, settings: &Settings) -> Option<String> {
    let assigned: Vec<_> = of_role(executed, VariableRole::Assigned).collect();
    let block = &text.bytes()[executed.block.start as usize..executed.block.end as usize];
    if !assigned.is_empty() && assigns_literal(block) {
        return None;
    }
    let shown: Vec<_> = match assigned.is_empty() {
        true => of_role(executed, VariableRole::Read).collect(),
        false => assigned,
    };
    let is_own = |values: &&VariableValues| {
        matches!(VariableScope::of(values.number, settings), VariableScope::Local | VariableScope::Common)
    };
    let single = shown.into_iter().filter(is_own).filter(|values| has_one_value(values));
    let labels: Vec<_> = single.map(label).take(MAX_VALUES).collect();
    (!labels.is_empty()).then(|| labels.join(", "))
}

fn label(values: &VariableValues) -> String {
    let VariableValues { number, last, .. } = values;
    if last.is_vacant() { format!("#{number} vacant") } else { format!("#{number} = {}", value_text(*last)) }
}

fn of_role(executed: &ExecutedBlock, role: VariableRole) -> impl Iterator<Item = &VariableValues> {
    executed.values.iter().filter(move |values| values.role == role)
}

fn has_one_value(values: &VariableValues) -> bool {
    match values.range {
        Some((low, high)) => low == high && !values.has_been_vacant,
        None => true,
    }
}

/// Returns true for a block of assignments that show their values: `#1=2.5`.
fn assigns_literal(block: &[u8]) -> bool {
    let Some(block) = block_at(SourceId::default(), block, 0) else { return false };
    block.items.iter().all(|item| match item {
        Item::Statement(statement) => match &statement.node {
            Statement::Assign { value, .. } => is_literal(value),
            _ => true,
        },
        _ => true,
    })
}

fn is_literal(value: &Expr) -> bool {
    match &value.kind {
        ExprKind::Literal(_) => true,
        ExprKind::Negate(value) | ExprKind::Plus(value) => is_literal(value),
        _ => false,
    }
}

/// Returns `Φ0.019 of Φ0.1`, with the errors that this hides and the number of holes that the reference lacks.
fn holes_text(holes: &HolesOfLine) -> String {
    let HolesOfLine { worst, count, errors, extra } = holes;
    let Some((phi, tolerance)) = worst else { return "no hole of the reference here".to_owned() };
    let mut text = format!("Φ{phi:.3} of Φ{tolerance}");
    if 1 < *count {
        text += &format!(", worst of {count} holes");
    }
    // A position out of tolerance says it itself, as far as three decimals show it.
    if *phi < tolerance + 0.0005 && !errors.is_empty() {
        text += &format!(", FAIL {}", errors.iter().copied().collect::<Vec<_>>().join(", "));
    }
    match extra {
        0 => text,
        1 => text + ", 1 extra hole",
        _ => text + &format!(", {extra} extra holes"),
    }
}

/// Returns a hint behind the text of a line, counted from 1.
fn hint(text: &TextDocument, line: u32, label: String, tooltip: &str) -> InlayHint {
    let content = text.line(line as usize - 1).trim_ascii_end();
    let mut position =
        text.position(text.offset(lsp_types::Position::new(line - 1, 0)) + content.len() as u32);
    position.line = line - 1;
    InlayHint {
        position,
        label: InlayHintLabel::String(label),
        kind: None,
        text_edits: None,
        tooltip: Some(InlayHintTooltip::String(tooltip.to_owned())),
        padding_left: Some(true),
        padding_right: None,
        data: None,
    }
}
