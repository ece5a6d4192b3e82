//! Files that begin as programs and have another ending than those of programs: they are no cases, and are named.
#![expect(clippy::disallowed_methods, reason = "the command line reads files")]

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use gcode_session::files::{PROGRAM_ENDINGS, begins_program};

/// Endings of other files, and of copies that editors keep.
const OTHERS: [&str; 24] = [
    "toml", "lock", "json", "csv", "tsv", "xml", "log", "svg", "png", "jpg", "md", "html", "htm", "snap",
    "pdf", "zip", "rs", "new", "ps", "txt", "bak", "old", "orig", "tmp",
];

/// Number of bytes that are read of a file.
const HEAD: u64 = 4096;

/// Returns the files among the entries of a folder that begin as programs and have no ending of programs.
pub(super) fn programs_of_other_endings(entries: &[PathBuf]) -> Vec<PathBuf> {
    let is_other = |path: &&PathBuf| {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or("").to_ascii_lowercase();
        let is_known = ending.is_empty()
            || ending.ends_with('~')
            || OTHERS.contains(&ending.as_str())
            || PROGRAM_ENDINGS.contains(&ending.as_str());
        !is_known && path.is_file() && head(path).is_some_and(|head| begins_with_blocks(&head))
    };
    entries.iter().filter(is_other).cloned().collect()
}

/// Returns the first bytes of a file; `None` if it can't be read.
fn head(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(HEAD).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// Returns true for the head of a program: `O1234`, or `%` and behind it blocks. PDF and PostScript have `%` too.
fn begins_with_blocks(text: &[u8]) -> bool {
    let text = text.trim_ascii_start();
    let Some(rest) = text.strip_prefix(b"%") else {
        return text.first() != Some(&b'<') && begins_program(text);
    };
    let line = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
    let (of_line, behind) = rest.split_at(line);
    let first = behind.trim_ascii_start();
    let is_block = match first {
        [b'(' | b':' | b'/', ..] => true,
        [letter, next, ..] => letter.is_ascii_alphabetic() && (next.is_ascii_digit() || *next == b'#'),
        _ => false,
    };
    of_line.iter().all(|byte| byte.is_ascii_alphanumeric() || byte.is_ascii_whitespace()) && is_block
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_head_of_a_program_is_known() {
        for head in ["O1\n", "%\nO0001(PLATE)\n", "%\r\n(PLATE)\r\nG21", "%\nN10 G21\n", ":1\n", "%\n/1 G0"] {
            assert!(begins_with_blocks(head.as_bytes()), "{head}");
        }
        for head in [
            "",
            "%PDF-1.4\n%a",
            "%!PS-Adobe\n%%T",
            "<html>",
            "Offset 1\n",
            "% a comment in TeX.\n",
            "%\n%\n",
            "1;2\n",
        ] {
            assert!(!begins_with_blocks(head.as_bytes()), "{head}");
        }
    }
}
