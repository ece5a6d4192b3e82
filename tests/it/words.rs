//! Literal words of NC programs, each changed by a small step: what a hurried edit does.
use std::ops::Range;

/// One word of a text written otherwise.
#[derive(Clone, Debug)]
pub(crate) struct Slip {
    /// Counted from 0.
    pub line: usize,
    pub letter: char,
    /// The words of a call are the macro's.
    pub is_argument: bool,
    /// The block as it is now.
    pub block: String,
}

/// Every word of a text that has a number and can be changed by a small step.
pub(crate) fn slips(text: &str) -> Vec<Slip> {
    let blocks = text.lines().enumerate();
    blocks
        .flat_map(|(line, block)| of_block(block).into_iter().map(move |slip| Slip { line, ..slip }))
        .collect()
}

/// The text with a slip in it.
pub(crate) fn with(text: &str, slip: &Slip) -> String {
    let line =
        |(line, block): (usize, &str)| if line == slip.line { slip.block.clone() } else { block.to_owned() };
    text.lines().enumerate().map(|one| line(one) + "\n").collect()
}

fn of_block(block: &str) -> Vec<Slip> {
    let code = block.split('(').next().unwrap();
    let is_other = |words: &[&str]| words.iter().any(|word| code.contains(word));
    // Statements have no words, and what N and O say isn't done.
    if is_other(&["=", "IF", "WHILE", "END", "GOTO", "PRNT", "POPEN", "PCLOS"])
        || code.starts_with(['%', 'O', ':'])
    {
        return Vec::new();
    }
    let words = words(code);
    let has =
        |wanted: &str| words.iter().any(|(letter, at)| format!("{letter}{}", &code[at.clone()]) == wanted);
    let is_call = ["G65", "G66", "G66.1", "M98"].iter().any(|call| has(call));
    let is_dwell = ["G4", "G04"].iter().any(|dwell| has(dwell));
    let changed = |(letter, at): &(char, Range<usize>)| {
        let number = &code[at.clone()];
        let new = match letter {
            'G' | 'M' if is_call => None,
            'P' | 'L' | 'K' if is_call || *letter == 'P' && has("G10") => None,
            'M' => code_changed(number),
            'G' => system_changed(number),
            'N' | 'O' => None,
            'X' | 'U' | 'P' if is_dwell => stepped(number, 0.1, 100.0),
            'T' | 'H' | 'D' if !is_call => stepped(number, 1.0, 1.0),
            'L' | 'K' if !number.contains('.') => stepped(number, 1.0, 1.0),
            'P' => stepped(number, 0.1, 100.0),
            'F' | 'S' => {
                number.parse().ok().map(|value: f64| format!("{}", (value * 1250.0).round() / 1000.0))
            }
            // Without a point thousandths.
            _ => stepped(number, 0.01, 10.0),
        };
        let new = new?;
        let start = if new.is_empty() { at.start - 1 } else { at.start };
        let block = format!("{}{new}{}", &block[..start], &block[at.end..]);
        Some(Slip { line: 0, letter: *letter, is_argument: is_call, block })
    };
    words.iter().filter_map(changed).collect()
}

/// The letters and numbers of a block; none in brackets.
fn words(code: &str) -> Vec<(char, Range<usize>)> {
    let mut depth = 0;
    let mut words = Vec::new();
    let mut before = ' ';
    for (at, letter) in code.char_indices() {
        depth += i32::from(letter == '[') - i32::from(letter == ']');
        let rest = &code[at + 1..];
        let is_word =
            depth == 0 && letter.is_ascii_uppercase() && !before.is_ascii_uppercase() && before != ',';
        let digits = rest.find(|c: char| !(c.is_ascii_digit() || ".-".contains(c))).unwrap_or(rest.len());
        let is_whole = digits > 0 && !rest[digits..].starts_with(['[', '#']);
        if is_word && is_whole {
            words.push((letter, at + 1..at + 1 + digits));
        }
        before = letter;
    }
    words
}

/// As many digits as it has, and no fewer than four.
fn stepped(number: &str, fine: f64, whole: f64) -> Option<String> {
    let value: f64 = number.parse().ok()?;
    Some(if number.contains('.') { format!("{:.4}", value + fine) } else { format!("{}", value + whole) })
}

/// The other sense, a lost stop or coolant.
fn code_changed(number: &str) -> Option<String> {
    let new = match number.parse::<u32>().ok()? {
        0 | 1 | 8 => "",
        3 => "04",
        4 => "03",
        _ => return None,
    };
    Some(new.to_owned())
}

/// The next work offset.
fn system_changed(number: &str) -> Option<String> {
    let code: u32 = number.parse().ok()?;
    (54..59).contains(&code).then(|| (code + 1).to_string())
}

#[test]
fn each_word_is_changed_once() {
    let text =
        "O1\nN10 G54 G0 X1.5 Y#1 Z[2.+3.] M8 (X9.)\n#1=5.\nG65 P9 A1. H0.\nG4 P500\nX10 R-.5\nS500 M3\n";
    let blocks: Vec<String> =
        slips(text).into_iter().map(|slip| format!("{} {}", slip.line, slip.block)).collect();
    let expected = [
        "1 N10 G55 G0 X1.5 Y#1 Z[2.+3.] M8 (X9.)",
        "1 N10 G54 G0 X1.5100 Y#1 Z[2.+3.] M8 (X9.)",
        "1 N10 G54 G0 X1.5 Y#1 Z[2.+3.]  (X9.)",
        "3 G65 P9 A1.0100 H0.",
        "3 G65 P9 A1. H0.0100",
        "4 G4 P600",
        "5 X20 R-.5",
        "5 X10 R-0.4900",
        "6 S625 M3",
        "6 S500 M04",
    ];
    assert_eq!(blocks, expected);
}
