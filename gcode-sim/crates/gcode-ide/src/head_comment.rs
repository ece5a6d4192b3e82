//! Head of a program: its title, and the meaning of its variables as its comments state them.
use gcode_lang::program::argument_letter;

use crate::entry::EntryKind;
use crate::file_index::FileIndex;
use crate::text::{TextRange, line_range, lossy};

/// Meaning of a variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct VariableMeaning {
    pub number: u32,
    /// Letter of the argument that sets it, as the comment states it.
    pub letter: Option<char>,
    pub text: String,
    /// Comment.
    pub range: TextRange,
}

/// Most bytes of a head.
const MAX_HEAD: u32 = 16 * 1024;

/// Returns the title of a program: the comment behind its O word, or the comment at its start.
pub(crate) fn title(index: &FileIndex, program: usize) -> Option<String> {
    let outline = index.programs().get(program)?;
    let line = line_range(index.text(), outline.name_range.end);
    let behind = TextRange::new(outline.name_range.end, line.end);
    let text = lossy(behind.of(index.text()));
    let inside = text.trim_start().strip_prefix('(')?;
    Some(inside.split(')').next().unwrap_or(inside).trim().to_owned())
}

/// Returns the letters that `(ARGUMENTS, ALL NEEDED BUT K AND Q)` excepts; `None` for a head without such a line.
pub(crate) fn optional_letters(index: &FileIndex, program: usize) -> Option<Vec<char>> {
    let outline = index.programs().get(program)?;
    let end = outline.range.end.min(outline.range.start + MAX_HEAD);
    let mut comments = index.entries(TextRange::new(outline.range.start, end));
    comments.find_map(|entry| {
        let text = lossy(entry.range.of(index.text())).to_ascii_uppercase();
        let (_, behind) = text.split_once("ALL NEEDED").filter(|(before, _)| before.contains("ARGUMENTS"))?;
        let excepted = behind.split([',', ')']).next().unwrap_or_default();
        let letters = excepted.split(' ').filter(|word| word.len() == 1);
        (entry.kind == EntryKind::Comment).then(|| letters.filter_map(|word| word.chars().next()).collect())
    })
}

/// Returns the meanings of variables that the comments of a program state.
///
/// `(A #1  RADIUS)`, `(A = RADIUS)`, `(#1 = X START)`, `(A = #1 RADIUS)`, `(#24-#29 RESULTS)`, `(#4 #5 MODES, #6 FEED)`, and the
/// comment behind an assignment, `#101=5. (FEED)`.
pub(crate) fn meanings(index: &FileIndex, program: usize) -> Vec<VariableMeaning> {
    let mut found = Vec::new();
    let Some(outline) = index.programs().get(program) else { return found };
    let end = outline.range.end.min(outline.range.start + MAX_HEAD);
    let head = TextRange::new(outline.range.start, end);
    let mut continued: Option<usize> = None;
    let mut by_letter = Vec::new();
    for entry in index.entries(head).filter(|entry| entry.kind == EntryKind::Comment) {
        let text = lossy(entry.range.of(index.text()));
        let text = text.trim_start_matches(['(', ';', '/']).trim_end_matches(')');
        let before = found.len();
        collect(text, entry.range, &mut found);
        if found.len() > before {
            continued = Some(before);
        } else if let Some(first) = continued.filter(|_| text.starts_with("   ")) {
            // An indented line goes on with the one before.
            for meaning in &mut found[first..] {
                meaning.text = format!("{} {}", meaning.text, text.trim());
            }
        } else {
            continued = None;
            by_letter.extend(text.split([';', ',']).filter_map(|part| letter_meaning(part, entry.range)));
        }
    }
    // A comment that names the variable precedes one that names its letter.
    by_letter.retain(|meaning| found.iter().all(|other| other.number != meaning.number));
    found.extend(by_letter);
    found
}

/// Returns the meaning in `A = RADIUS`, `A: RADIUS`, `A - RADIUS` or `A.....RADIUS`, unless it is a formula.
fn letter_meaning(comment: &str, range: TextRange) -> Option<VariableMeaning> {
    let letter = comment.trim_start().chars().next()?.to_ascii_uppercase();
    let behind = comment.trim_start().get(1..)?.trim_start();
    let sign = behind.chars().next().filter(|c| matches!(c, ':' | '=' | '-' | '.'))?;
    let words = behind.trim_start_matches(sign).trim();
    let number = (1..=26).find(|local| argument_letter(*local) == Some(letter))?;
    let is_text =
        words.len() > 2 && !words.contains(['=', '*', '[', '#']) && words.starts_with(char::is_alphabetic);
    is_text.then(|| VariableMeaning {
        number: number as u32,
        letter: Some(letter),
        text: words.to_owned(),
        range,
    })
}

/// Collects the meanings of one comment.
fn collect(comment: &str, range: TextRange, found: &mut Vec<VariableMeaning>) {
    let letter = stated_letter(comment);
    let mut pending: Vec<u32> = Vec::new();
    let mut is_first = true;
    let mut rest = comment;
    while let Some(at) = rest.find('#') {
        let between = &rest[..at];
        let digits = rest[at + 1..].bytes().take_while(u8::is_ascii_digit).count();
        let Ok(number) = rest[at + 1..at + 1 + digits].parse::<u32>() else {
            rest = &rest[at + 1..];
            continue;
        };
        let words = between.trim().trim_matches(|c| matches!(c, '=' | ',' | ':' | '-' | '.' | ' '));
        match pending.last() {
            Some(last) if between.trim() == "-" && number > *last && number - last < 1000 => {
                pending.extend(last + 1..number);
            }
            Some(_) if words.is_empty() || words.eq_ignore_ascii_case("AND") => {}
            Some(_) => flush(&mut pending, words, None, range, found),
            None => {}
        }
        pending.push(number);
        rest = &rest[at + 1 + digits..];
        is_first &= pending.len() == 1 && found.last().is_none_or(|last| last.range != range);
    }
    let words = rest.trim().trim_matches(|c| matches!(c, '=' | ',' | ':' | '-' | ' '));
    // `(RADIUS = #1)`, `(R = RADIUS #18)`: the meaning stands before.
    let before = comment
        .split('#')
        .next()
        .unwrap_or_default()
        .trim_matches(|c| matches!(c, '=' | ',' | ':' | '-' | ' '));
    let words = if words.is_empty() && is_first { before } else { words };
    flush(&mut pending, words, letter.filter(|_| is_first), range, found);
}

fn flush(
    pending: &mut Vec<u32>,
    words: &str,
    letter: Option<char>,
    range: TextRange,
    found: &mut Vec<VariableMeaning>,
) {
    for number in pending.drain(..).filter(|_| !words.is_empty()) {
        let (letter, words) = match letter_behind(number, words) {
            Some((own, words)) => (Some(own), words),
            None => (letter, words),
        };
        found.push(VariableMeaning { number, letter, text: words.to_owned(), range });
    }
}

/// Returns the letter of a local's argument and the meaning in the words behind its number: `#1 A = RADIUS`, `#1: A - RADIUS`.
fn letter_behind(number: u32, words: &str) -> Option<(char, &str)> {
    let letter = argument_letter(number as usize)?;
    let behind = words.strip_prefix([letter, letter.to_ascii_lowercase()])?.trim_start();
    let meaning = behind.strip_prefix(['=', ':', '-', ','])?.trim();
    (!meaning.is_empty()).then_some((letter, meaning))
}

/// Returns the letter at the start of a comment about an argument: `A #1`, `A = #1`, `(A) #1`.
fn stated_letter(comment: &str) -> Option<char> {
    let text = comment.trim_start();
    let letter = text.chars().next().filter(char::is_ascii_alphabetic)?;
    let behind = text[1..].trim_start_matches([' ', '=', ':', ')', ',', '-']);
    behind.starts_with('#').then(|| letter.to_ascii_uppercase())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::control::Settings;

    fn stated(text: &str) -> Vec<String> {
        let index = FileIndex::new(text.as_bytes(), &Settings::default());
        let shown = meanings(&index, 0).into_iter();
        shown
            .map(|m| format!("#{}{} {}", m.number, m.letter.map(String::from).unwrap_or_default(), m.text))
            .collect()
    }

    #[test]
    fn heads_state_their_variables() {
        assert_eq!(
            stated("O1(T)\n(A #1  RADIUS)\n(B #2  ABOVE)\n(      THE PART)\nG0\n"),
            ["#1A RADIUS", "#2B ABOVE THE PART"]
        );
        assert_eq!(stated("O1\n(#1 = X START)\n(#2: DEPTH)\n"), ["#1 X START", "#2 DEPTH"]);
        assert_eq!(stated("O1\n(#1 A = RADIUS)\n(#2: B - DEPTH)\n"), ["#1A RADIUS", "#2B DEPTH"]);
        // #2 is the local of B; A without a sign is a word.
        assert_eq!(stated("O1\n(#2 A = RADIUS)\n(#1 A RADIUS)\n"), ["#2 A = RADIUS", "#1 A RADIUS"]);
        assert_eq!(stated("O1\n(A = #1 RADIUS)\n(RADIUS = #18)\n"), ["#1A RADIUS", "#18 RADIUS"]);
        assert_eq!(
            stated("O1\n(VARIABLES #4 #5 MODES, #24-#26 RESULTS)\n(          #141 READ)\n"),
            ["#4 MODES", "#5 MODES", "#24 RESULTS", "#25 RESULTS", "#26 RESULTS", "#141 READ"]
        );
        assert_eq!(stated("O1\n(R = RADIUS)\n(D: DEPTH)\n(#18 OTHER)\n"), ["#18 OTHER", "#7D DEPTH"]);
        assert_eq!(
            stated("O1\n(R=RADIUS; A=ANGLE)\n(D....DEPTH)\n"),
            ["#18R RADIUS", "#1A ANGLE", "#7D DEPTH"]
        );
        assert_eq!(stated("O1\n(X = R, Y = B*2)\n(B - 2)\n(P = PITCH)\n(NOTE: SLOW)\n"), [""; 0]);
        assert_eq!(stated("O1\n(SET HEAD TO #140)\nX#1\n(NO MEANING #)\n"), ["#140 SET HEAD TO"]);
    }

    #[test]
    fn the_title_stands_behind_the_o_word() {
        let index = FileIndex::new(*b"O1 (ONE HOLE) (X)\nO2\n", &Settings::default());
        assert_eq!((title(&index, 0).as_deref(), title(&index, 1)), (Some("ONE HOLE"), None));
    }
}
