//! Reads the files that the user names: programs, jobs, references, machine files. Errors are one sentence.
#![expect(clippy::disallowed_methods, reason = "the command line reads files")]

use std::io::Read;
use std::path::{Path, PathBuf};

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};

use super::UsageError;
use gcode_lang::source::Bytes;
pub use gcode_session::files::folder_of;

/// Largest input, bytes; no control holds a larger program.
const LARGEST: u64 = 1 << 30;

/// Reads a file's bytes; `-` is standard input.
pub fn bytes(path: &Path) -> Result<Vec<u8>, UsageError> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        return match std::io::stdin().lock().take(LARGEST).read_to_end(&mut bytes) {
            Ok(_) => Ok(bytes),
            Err(error) => Err(UsageError::new(format!("standard input cannot be read: {error}"))),
        };
    }
    let unreadable = |error: std::io::Error| UsageError::unreadable(path, error);
    let about = std::fs::metadata(path).map_err(unreadable)?;
    if about.is_dir() {
        return Err(UsageError::new(format!("{} is a folder; name a file in it", path.display())));
    }
    if about.len() > LARGEST {
        return Err(UsageError::new(format!("{} is larger than 1 GiB", path.display())));
    }
    std::fs::read(path).map_err(unreadable)
}

/// Signatures of files that are not programs, and their kinds.
const OTHERS: [(&[u8], &str); 7] = [
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "an archive or an office document"),
    (b"{\\rtf", "a word processor's document"),
    (b"<!", "a web page"),
    (b"<?xml", "an XML document"),
];

/// Reads a program as UTF-8 text; refuses files of another kind, and text that is no program.
pub fn program(path: &Path) -> Result<Bytes, UsageError> {
    let program = program_text(path)?;
    match not_a_program(&program) {
        Some(why) => Err(UsageError::new(format!("{} is not a program: {why}", path.display()))),
        None => Ok(program),
    }
}

/// Reads a file that may hold called programs as UTF-8 text; refuses files of another kind.
pub(super) fn program_text(path: &Path) -> Result<Bytes, UsageError> {
    let bytes = bytes(path)?;
    let name = path.display();
    if let Some((_, what)) = OTHERS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(UsageError::new(format!("{name} is {what}, not a program")));
    }
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        return Err(UsageError::new(format!(
            "{name} is a job or a machine file, not a program: give it with --reference or --machine"
        )));
    }
    Ok(match has_even_parity(&bytes) {
        true => Bytes::converted(bytes.iter().map(|byte| char::from(byte & 0x7f)).collect(), bytes),
        false => to_utf8(bytes),
    })
}

/// Returns true for a tape in ISO code: the eighth bit of a byte makes the number of its ones even, which no other text does.
fn has_even_parity(bytes: &[u8]) -> bool {
    bytes.iter().any(|byte| *byte >= 0x80) && bytes.iter().all(|byte| byte.count_ones() % 2 == 0)
}

/// Lines at the beginning of a file in which blocks are looked for.
const FIRST_LINES: usize = 200;

/// Returns the reason why bytes are no program: zero bytes, or lines of which hardly one begins as a block does, or from the first that does
/// on not a third.
fn not_a_program(bytes: &[u8]) -> Option<String> {
    // The leader and the trailer of a tape are zeros, and the pauses between its lines.
    let bytes = without_zeros(bytes);
    let ends_line = |byte: &u8| matches!(byte, b'\n' | b'\r');
    let first_lines = bytes[..bytes.len().min(1 << 16)].split(ends_line).map(without_zeros);
    if first_lines.flatten().filter(|byte| **byte == 0).count() > 1 {
        return Some("it has zero bytes; a program is text".to_owned());
    }
    let lines = bytes.split(ends_line).map(|line| without_zeros(line).trim_ascii());
    let lines: Vec<&[u8]> = lines.filter(|line| !line.is_empty()).take(FIRST_LINES).collect();
    let blocks = lines.iter().filter(|line| begins_as_block(line)).count();
    // A transfer can have text in front of the program.
    let program = lines.iter().skip_while(|line| !begins_as_block(line)).count();
    let first = lines.first().filter(|_| blocks * 10 < lines.len() || blocks * 3 < program)?;
    let start = String::from_utf8_lossy(&first[..first.len().min(60)]);
    Some(format!("its first lines are no blocks; the first is '{}'", start.escape_debug()))
}

/// Returns a text without the zeros at its ends.
fn without_zeros(text: &[u8]) -> &[u8] {
    let start = text.iter().position(|byte| *byte != 0).unwrap_or(text.len());
    let end = text.iter().rposition(|byte| *byte != 0).map_or(start, |last| last + 1);
    &text[start..end]
}

/// Returns true for a line that begins as a block or a statement does: `%`, a comment, `/`, a letter with its number, `#`, IF.
fn begins_as_block(line: &[u8]) -> bool {
    const STATEMENTS: [&str; 13] =
        ["IF", "WHILE", "DO", "END", "GOTO", "THEN", "DPRNT", "BPRNT", "POPEN", "PCLOS", "SETVN", "PRM", "<"];
    let is_value = |byte: &u8| byte.is_ascii_digit() || b"+-.#[".contains(byte);
    let text = line.to_ascii_uppercase();
    match text.as_slice() {
        [b'%' | b'(' | b'/' | b':' | b';' | b'&' | b'\'' | b'!' | b'$', ..] => true,
        // A heading of a text has a space behind it.
        [b'#', next, ..] => next.is_ascii_digit() || matches!(next, b'[' | b'#' | b'_'),
        [letter, rest @ ..]
            if letter.is_ascii_alphabetic() && rest.trim_ascii_start().first().is_some_and(is_value) =>
        {
            true
        }
        _ => STATEMENTS.iter().any(|word| text.starts_with(word.as_bytes())),
    }
}

/// Converts the text of a program to UTF-8. UTF-16 is recognised by its byte order mark or by its zero bytes; any other
/// encoding is guessed from the comments, in which alone it matters.
fn to_utf8(bytes: Vec<u8>) -> Bytes {
    let encoding = match bytes[..] {
        [0xff, 0xfe, ..] => UTF_16LE,
        [0xfe, 0xff, ..] => UTF_16BE,
        [low, 0, next, 0, ..] if low != 0 && next != 0 => UTF_16LE,
        [0, high, 0, next, ..] if high != 0 && next != 0 => UTF_16BE,
        _ if std::str::from_utf8(&bytes).is_ok() => return bytes.into(),
        _ if is_western(&bytes) => WINDOWS_1252,
        _ => {
            let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
            detector.feed(&bytes, true);
            detector.guess(None, Utf8Detection::Deny)
        }
    };
    let text = encoding.decode_with_bom_removal(&bytes).0.into_owned();
    Bytes::converted(text, bytes)
}

/// Returns true for a text with few letters beyond ASCII that all stand alone and are those of drawings and of German and Danish
/// headers in Windows-1252, such as `Ø` and `ä`. So few bytes are too few for a guess.
fn is_western(bytes: &[u8]) -> bool {
    const LETTERS: &[u8] = &[
        0xd8, 0xf8, 0xdf, 0xe4, 0xf6, 0xfc, 0xc4, 0xd6, 0xdc, 0xc5, 0xe5, 0xe6, 0xc6, 0xe9, 0xe8, 0xb0, 0xb1,
        0xb5,
    ];
    let mut before = 0u8;
    bytes.iter().all(|byte| {
        let is_alone = byte.is_ascii() || before.is_ascii() && LETTERS.contains(byte);
        before = *byte;
        is_alone
    })
}

/// Returns the entries of a folder, sorted by name.
pub fn folder(path: &Path) -> Result<Vec<PathBuf>, UsageError> {
    let unreadable = |error: std::io::Error| UsageError::unreadable(path, error);
    let entries = std::fs::read_dir(path).map_err(unreadable)?;
    let mut paths =
        entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    paths.sort();
    Ok(paths)
}

/// Returns the canonical path of a folder, with links resolved.
pub fn canonical(path: &Path) -> Result<PathBuf, UsageError> {
    path.canonicalize().map_err(|error| UsageError::unreadable(path, error))
}

/// Reads a file's text, which must be UTF-8 (jobs, machine files, references; programs are bytes).
pub fn text(path: &Path) -> Result<String, UsageError> {
    let text = String::from_utf8(bytes(path)?).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
        UsageError::in_file(path, format!("line {line}: not UTF-8 text"))
    })?;
    Ok(text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned))
}

/// Reads the text of a list, which a spreadsheet may write in the encoding of its system.
pub(super) fn table(path: &Path) -> Result<String, UsageError> {
    let bytes = bytes(path)?;
    if let Some((_, kind)) = OTHERS.iter().find(|(signature, _)| bytes.starts_with(signature)) {
        let message = "which is neither a list of holes nor a job file: save a table as CSV";
        return Err(UsageError::new(format!("{} is {kind}, {message}", path.display())));
    }
    let text = String::from_utf8_lossy(&to_utf8(bytes)).into_owned();
    Ok(text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> String {
        String::from_utf8(to_utf8(bytes.to_vec()).to_vec()).unwrap()
    }

    #[test]
    fn utf_16_is_read_in_both_byte_orders_with_and_without_a_mark() {
        let program = "%\r\nO1(\u{c4}NDERUNG)\r\nM30\r\n";
        let units: Vec<u16> = program.encode_utf16().collect();
        let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
        let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
        assert_eq!(text(&little), program);
        assert_eq!(text(&big), program);
        assert_eq!(text(&[&[0xff, 0xfe], &little[..]].concat()), program);
        assert_eq!(text(&[&[0xfe, 0xff], &big[..]].concat()), program);
    }

    #[test]
    fn what_is_no_text_or_has_hardly_a_block_is_no_program() {
        let why = |text: &str| not_a_program(text.as_bytes());
        for text in [
            "",
            "\n\n",
            "%\nO1\nM30\n%\n",
            "(ONE)\n",
            "g0 x1\n",
            "N 10 G0\n",
            "<PART>\nM30\n",
            "WHILE[1]DO1\nEND1\n",
            "&F=/CNC/\n",
        ] {
            assert_eq!(why(text), None, "{text}");
        }
        // One line in ten is enough: a transfer can have text in front of the program.
        let header = "Machine 7, program of today\n".repeat(9);
        assert_eq!(why(&format!("{header}G0X1.\n")), None);
        assert!(why(&format!("{header}{header}G0X1.\n")).is_some());
        // A text in which some lines look like blocks: from the first of them on, 2 of 7.
        let text =
            "# Plates\nO8101 for each hole\nand so on\nas it is\nM30 ends it\nwhere it is\nas said\nhere\n";
        assert!(why(text).is_some());
        assert_eq!(why("# Plates\nO8101 for each hole\nand so on\nas it is\nM30 ends it\n"), None);
        assert_eq!(
            why("Dear colleague,\nhere it is\n").unwrap(),
            "its first lines are no blocks; the first is 'Dear colleague,'"
        );
        assert!(why("\x7fELF\0\0\0\0X").unwrap().starts_with("it has zero bytes"));
        assert_eq!(why("%\n\0\0O1\n\0\0M30\0\n\0\0%\n"), None, "pauses between the lines");
        assert!(why("%\nO1\nG0\0X1.\0\nG0\0Z1.\n").unwrap().starts_with("it has zero bytes"));
        assert_eq!(why("\0\0\0%\nO1\nM30\n%\n\0\0\0"), None, "a tape with leader and trailer");
    }

    /// `O` is 4F hex with five ones, CF with six; `G` is 47 with four.
    #[test]
    fn a_tape_with_even_parity_is_read() {
        assert!(has_even_parity(&[0xcf, 0x47]));
        assert!(!has_even_parity(&[0x4f, 0x47]), "without the bit");
        assert!(!has_even_parity(&[0x47, 0x30]), "no bit is set");
    }

    #[test]
    fn a_page_is_no_program_and_a_program_with_a_name_is_none_of_the_others() {
        let what = |text: &str| {
            let other = OTHERS.iter().find(|(start, _)| text.as_bytes().starts_with(start));
            other.map(|(_, what)| *what)
        };
        assert_eq!(what("<!DOCTYPE html><html>"), Some("a web page"));
        assert_eq!(what("<?xml version=\"1.0\"?>"), Some("an XML document"));
        assert_eq!(what("<HTML>\nM30\n"), None);
    }

    /// 钻孔加工程序 in GBK, 穴あけ加工のプログラム in Shift-JIS: tables of the two standards.
    #[test]
    fn comments_in_gbk_and_shift_jis_become_readable() {
        let gbk = b"O1(\xd7\xea\xbf\xd7\xbc\xd3\xb9\xa4\xb3\xcc\xd0\xf2)\nG0X1.\nM30\n";
        assert_eq!(text(gbk), "O1(\u{94bb}\u{5b54}\u{52a0}\u{5de5}\u{7a0b}\u{5e8f})\nG0X1.\nM30\n");
        let shift_jis = b"O1(\x8c\x8a\x82\xa0\x82\xaf\x89\xc1\x8d\x48\x82\xcc\x83\x76\x83\x8d\x83\x4f\x83\x89\x83\x80)\nM30\n";
        assert_eq!(
            text(shift_jis),
            "O1(\u{7a74}\u{3042}\u{3051}\u{52a0}\u{5de5}\u{306e}\u{30d7}\u{30ed}\u{30b0}\u{30e9}\u{30e0})\nM30\n"
        );
    }

    #[test]
    fn utf_8_is_taken_as_it_is_and_other_bytes_never_fail() {
        assert_eq!(text("O1(\u{d8}10)\nM30".as_bytes()), "O1(\u{d8}10)\nM30");
        assert!(text(b"O1(\xff\xfe\x80)\nM30").ends_with(")\nM30"));
        assert!(text(b"O1(DIA \xd810)\nG0X1.").contains("G0X1."), "Latin-1");
    }

    #[test]
    fn the_content_of_the_file_is_kept() {
        let bytes = b"O1(\xd7\xea)\nM30\n";
        assert_eq!(to_utf8(bytes.to_vec()).file_content(), bytes);
    }
}
