//! Properties of the state after random edits.
use std::sync::Arc;

use lsp_types::{Position, Range, TextDocumentContentChangeEvent};
use proptest::prelude::*;

use crate::testing::opened;
use crate::text_document::TextDocument;

/// Texts of edits, among them ends of lines, heads of programs and characters of two and four bytes.
fn text() -> impl Strategy<Value = String> {
    let pieces =
        ["\n", "\r\n", "\r", "O2\n", "N10 ", "G65P2A1.\n", "GOTO10", "#1=", "(\u{d8}\u{1f600})", "[", "%"];
    prop::collection::vec(prop::sample::select(pieces.to_vec()), 0..6).prop_map(|pieces| pieces.concat())
}

fn change() -> impl Strategy<Value = TextDocumentContentChangeEvent> {
    let position = || (0..8_u32, 0..9_u32).prop_map(|(line, character)| Position::new(line, character));
    let range = prop::option::weighted(0.95, (position(), position()));
    (range, text()).prop_map(|(range, text)| TextDocumentContentChangeEvent {
        range: range.map(|(start, end)| Range::new(start, end)),
        range_length: None,
        text,
    })
}

proptest! {
    /// After any edits the state is that of a client that opens the text which they leave.
    #[test]
    fn edits_leave_the_state_of_a_fresh_start(
        start in text(),
        notifications in prop::collection::vec(prop::collection::vec(change(), 1..4), 1..6),
    ) {
        let (mut edited, files) = opened(&[("O1.nc", &start)]);
        let mut expected = start;
        for (version, changes) in (2..).zip(notifications) {
            for change in &changes {
                let fresh = TextDocument::new(expected.as_bytes(), edited.client.encoding);
                match change.range {
                    None => expected = change.text.clone(),
                    Some(range) => {
                        let (start, end) = fresh.offsets(range);
                        expected.replace_range(start as usize..end as usize, &change.text);
                    }
                }
            }
            edited.change(files[0], version, changes);
        }
        let (fresh, _) = opened(&[("O1.nc", &expected)]);
        let documents = [&edited, &fresh].map(|snapshot| Arc::clone(&snapshot.documents[&files[0]].text));
        prop_assert_eq!(&documents[0].bytes()[..], expected.as_bytes());
        for offset in (0..=expected.len()).filter(|at| expected.is_char_boundary(*at)) {
            let at = offset as u32;
            prop_assert_eq!(documents[0].position(at), documents[1].position(at));
        }
        let symbols = [&edited, &fresh].map(|snapshot| snapshot.project.document_symbols(files[0]));
        prop_assert_eq!(&symbols[0], &symbols[1]);
        let tokens = [&edited, &fresh].map(|snapshot| snapshot.project.semantic_tokens(files[0], None));
        prop_assert_eq!(&tokens[0], &tokens[1]);
    }
}
