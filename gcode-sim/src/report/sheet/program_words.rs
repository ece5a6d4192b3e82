//! What a program itself says to the person who sets it up: its name, comments on its tools, and the switches of the panel that it uses.
use gcode_control::Note;
use gcode_lang::source::Span;
use gcode_session::Run;

use crate::report::run::comments;

/// Returns the program's comment on a tool: behind its change, else of a line that begins with the tool, `(T6 - THREAD MILL)`.
pub(super) fn tool_comment(run: &Run, tool: u32, change: Option<Span>) -> Option<String> {
    let sources = run.control.memory().sources();
    let of_change = change.map(|block| comments(&sources.text(block))).filter(|text| !text.is_empty());
    of_change.or_else(|| sources.iter().find_map(|(_, source)| comment_in_list(source.lines(), tool)))
}

/// Returns the comment on a tool in a list of tools, as many programs have it at the head.
fn comment_in_list(lines: impl Iterator<Item = String>, tool: u32) -> Option<String> {
    lines.filter(|line| line.trim_start().starts_with('(')).find_map(|line| {
        let comment = comments(&line);
        let rest = comment.strip_prefix(['T', 't'])?;
        let digits = rest.find(|sign: char| !sign.is_ascii_digit()).unwrap_or(rest.len());
        let words = rest[digits..].trim_start_matches([' ', '-', '=', ':', '.']);
        // `.240` is a diameter.
        let point = rest[digits..].trim_start_matches([' ', '-', '=', ':']);
        let is_size =
            point.strip_prefix('.').is_some_and(|rest| rest.starts_with(|sign: char| sign.is_ascii_digit()));
        let words = if is_size { point } else { words };
        (rest[..digits].parse() == Ok(tool) && !words.is_empty()).then(|| words.to_owned())
    })
}

/// Returns the switches on which the run depends, each with its state in the run and the first block that has it.
pub(super) fn switches(run: &Run, first_m01: Option<Span>) -> Vec<[String; 3]> {
    let place = |block: Span| {
        let (program, line) = run.locate(block);
        format!("{program} line {line}")
    };
    let skips = run.control.notes().filter_map(|(note, block)| match note {
        Note::BlockSkip { switch, is_on } => {
            let name = if switch == 1 { "block skip".to_owned() } else { format!("block skip {switch}") };
            let state = if is_on { "on: the blocks are skipped" } else { "off: the blocks are executed" };
            Some([name, state.to_owned(), place(block)])
        }
        _ => None,
    });
    let mut all: Vec<[String; 3]> = Vec::new();
    for row in skips {
        if all.iter().all(|known| known[0] != row[0]) {
            all.push(row);
        }
    }
    let stop = first_m01.map(|block| ["optional stop".to_owned(), "on: M01 stops".to_owned(), place(block)]);
    all.extend(stop);
    all
}

/// Returns the comment in the heading of the main program: in a dump of its part, else of the first file.
pub(super) fn main_comment<L: Iterator<Item = String>>(
    sources: impl Iterator<Item = L>,
    number: Option<u32>,
) -> Option<String> {
    let mut of_first = None;
    for (index, lines) in sources.enumerate() {
        let lines: Vec<String> = lines.collect();
        let own = lines.iter().position(|line| number.is_some() && number_of_line(line) == number);
        if let Some(start) = own {
            return heading(&lines[start..]);
        }
        if index == 0 {
            let start = lines.iter().position(|line| !matches!(line.trim(), "" | "%")).unwrap_or(0);
            of_first = heading(&lines[start..]);
        }
    }
    of_first
}

/// Returns the comment of a program's first line, or of a line of its own directly behind it. Others are of their blocks, as that
/// of an M00.
fn heading(lines: &[String]) -> Option<String> {
    let [first, rest @ ..] = lines else { return None };
    let own = first
        .split_once('(')
        .filter(|(before, _)| before.trim().is_empty() || number_of_line(before).is_some());
    let behind = || number_of_line(first).and(rest.first()?.trim_start().strip_prefix('('));
    let text = own.map(|(_, text)| text).or_else(behind)?;
    Some(text.split(')').next()?.trim().to_owned())
}

/// Returns the number of a line that begins a program: `O1520`, `:1520`.
fn number_of_line(line: &str) -> Option<u32> {
    let digits = line.trim_start().strip_prefix(['O', 'o', ':'])?;
    let end = digits.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(digits.len());
    digits[..end].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::{comment_in_list, main_comment};

    #[test]
    fn a_program_is_named_by_the_comment_of_its_heading() {
        let named = |text: &str, number| main_comment([text.lines().map(str::to_owned)].into_iter(), number);
        for (text, number, name) in [
            ("%\nO1(PLATE)\nM00(CHECK)\n", Some(1), Some("PLATE")),
            ("%\nO0001\n(PLATE)\nM00(CHECK)\n", Some(1), Some("PLATE")),
            ("%\nO1\nG21\nM00(CHECK #500 ON SCREEN)\n", Some(1), None),
            ("%\nO1\nM00(CHECK)\n", Some(1), None),
            ("(OTHER)\nO2(TWO)\nM99\nO1\n(ONE)\n", Some(1), Some("ONE")),
            ("%\n\n(PLATE)\nG21\n", None, Some("PLATE")),
            ("%\nG21(UNIT)\n(PLATE)\n", None, None),
        ] {
            assert_eq!(named(text, number).as_deref(), name, "{text}");
        }
    }

    #[test]
    fn a_list_of_tools_at_the_head_names_them() {
        let text = "%\nO1(T6 PLATE)\n(T1 - SPOT DRILL)\n(T06 - .240 THREAD MILL)\n(T12=DRILL 6.8)\n(T7)\n(TURN IT)\nG0 (T8 X)\n";
        for (tool, words) in [
            (1, Some("SPOT DRILL")),
            (6, Some(".240 THREAD MILL")),
            (12, Some("DRILL 6.8")),
            (2, None),
            (7, None),
            (8, None),
        ] {
            assert_eq!(comment_in_list(text.lines().map(str::to_owned), tool).as_deref(), words, "T{tool}");
        }
    }
}
