//! A finding or an alarm as text: the fault, its line underlined, the calls that led to it, and the remedy.
use annotate_snippets::{Annotation, AnnotationKind, Level, Renderer, Snippet};

use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Backtrace, CallChain};
use gcode_lang::source::{Sources, Span};

/// Number of calls of a chain that are shown; the others are counted.
const CALLS_SHOWN: usize = 6;

/// Formats a diagnostic with ANSI colours; the output stream removes them if it is not a terminal.
pub fn render(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let level = match diagnostic.severity {
        Severity::Alarm => Level::ERROR.with_name("alarm"),
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group = level
        .primary_title(escape(&diagnostic.message))
        .id(diagnostic.code())
        .elements(Vec::<Snippet<'_, Annotation<'_>>>::new());
    if let Some(backtrace) = &diagnostic.backtrace {
        group = group.element(snippet(sources, diagnostic.span.unwrap_or(backtrace.block)));
        for call in calls(backtrace, sources) {
            group = group.element(Level::NOTE.no_name().message(call));
        }
    }
    for (span, label) in &diagnostic.labels {
        group = group.element(Level::NOTE.message(format!("{}: {label}", format_location(sources, *span))));
    }
    for note in &diagnostic.notes {
        group = group.element(Level::NOTE.message(escape(note)));
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(escape(help)));
    }
    let mut text = Renderer::styled().term_width(110).render(&[group]);
    text.push('\n');
    text
}

/// Replaces control characters: a program's comment may contain any bytes, which a terminal must not
/// interpret.
fn escape(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

/// Returns `O8101.nc:12`.
pub fn format_location(sources: &Sources, span: Span) -> String {
    format!("{}:{}", sources.get(span.source).name, sources.line_column(span).line)
}

/// Returns the chain of calls, innermost first, one line each.
fn calls(backtrace: &Backtrace, sources: &Sources) -> Vec<String> {
    let mut lines = Vec::new();
    let mut left = 0;
    let mut next: &CallChain = &backtrace.calls;
    while let Some(call) = next {
        if lines.len() < CALLS_SHOWN {
            lines.push(format!(
                "called from {}: {}",
                format_location(sources, call.calling_block),
                escape(sources.text(call.calling_block).trim())
            ));
        } else {
            left += 1;
        }
        next = &call.outer_calls;
    }
    if left > 0 {
        lines.push(format!("… and {left} more calls"));
    }
    lines
}

/// Returns the line in which `span` begins, with the span underlined.
fn snippet(sources: &Sources, span: Span) -> Snippet<'static, Annotation<'static>> {
    let source = sources.get(span.source);
    let at = source.line_column(span.start);
    let bytes = &source.bytes;
    let start = (span.start + 1 - at.column) as usize;
    let end =
        bytes[start..].iter().position(|b| matches!(b, b'\n' | b'\r')).map_or(bytes.len(), |n| start + n);
    let from = (span.start as usize).clamp(start, end);
    let to = (span.end as usize).clamp(from, end);
    // Bytes that are not UTF-8 become longer replacement characters, so each piece is converted separately.
    let text = |bytes: &[u8]| escape(&String::from_utf8_lossy(bytes));
    let (before, marked, after) = (text(&bytes[start..from]), text(&bytes[from..to]), text(&bytes[to..end]));
    let range = before.len()..before.len() + marked.len();
    Snippet::source(format!("{before}{marked}{after}"))
        .line_start(at.line as usize)
        .path(source.name.clone())
        .annotation(AnnotationKind::Primary.span(range))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use gcode_lang::alarm::kinds::PS0112;
    use gcode_lang::motion::Call;

    #[test]
    fn a_message_names_line_call_and_remedy() {
        let mut sources = Sources::default();
        let main = sources.add("O0001.nc", *b"O1\nG65 P2 A1.\nM30\n");
        let called = sources.add("O0002.nc", *b"O2(\xb0\xa1)\n#1=#2/0 (\xb0)\nM99\n");
        let from = Span { source: main, start: 3, end: 13 };
        let block = Span { source: called, start: 7, end: 18 };
        let mut diagnostic = Diagnostic::new(&PS0112, "division by zero")
            .with_backtrace(Backtrace {
                block,
                calls: Some(Arc::new(Call { calling_block: from, outer_calls: None })),
            })
            .help("check the divisor: a vacant variable counts as 0");
        diagnostic.span = Some(Span { source: called, start: 10, end: 14 });
        let text = anstream::adapter::strip_str(&render(&diagnostic, &sources)).to_string();
        let expected = "\
alarm[PS0112]: division by zero
 --> O0002.nc:2:4
  |
2 | #1=#2/0 (\u{fffd})
  |    ^^^^
  |
  = called from O0001.nc:2: G65 P2 A1.
  = help: check the divisor: a vacant variable counts as 0
";
        assert_eq!(text, expected);
    }
}
