//! Texts of programs that can read values from outside: a scan without a run, which finds too many rather than too few.
use gcode_control::slice::StatedValues;

/// Returns true if a text has a block skip, `#` before anything but a local or a harmless system variable, PRM, or a tool
/// offset whose value the machine file does not state.
pub(super) fn names_outside(text: &[u8], stated: &StatedValues, has_moves: bool) -> bool {
    let mut rest = text;
    // Most lines of a long file are numbers alone.
    while let Some(found) = find_outside_sign(rest) {
        let start = rest[..found].iter().rposition(is_line_end).map_or(0, |end| end + 1);
        let end = rest[found..].iter().position(is_line_end).map_or(rest.len(), |length| found + length);
        if line_names_outside(&rest[start..end], stated, has_moves) {
            return true;
        }
        rest = &rest[end..];
    }
    false
}

fn is_line_end(byte: &u8) -> bool {
    *byte == b'\n'
}

/// Returns 0 for the bytes at which a line can name an outside value: `#`, `/`, `[`, H and D. Without branches, so that
/// many bytes are tested at once.
fn outside_sign(byte: u8) -> u8 {
    let letter = byte & 0xdf;
    (byte ^ b'#').min(byte ^ b'/').min(byte ^ b'[').min(letter ^ b'H').min(letter ^ b'D')
}

/// Returns the offset of the first byte that [`outside_sign`] finds.
#[inline(never)]
fn find_outside_sign(text: &[u8]) -> Option<usize> {
    let least = |chunk: &[u8; 64]| chunk.iter().fold(u8::MAX, |least, byte| least.min(outside_sign(*byte)));
    let without = 64 * text.as_chunks().0.iter().take_while(|chunk| least(chunk) != 0).count();
    text[without..].iter().position(|byte| outside_sign(*byte) == 0).map(|offset| without + offset)
}

/// Returns [`names_outside`] for one line.
fn line_names_outside(line: &[u8], stated: &StatedValues, has_moves: bool) -> bool {
    let (mut is_in_comment, mut has_assignment, mut open_brackets) = (false, false, 0);
    line.iter().enumerate().any(|(at, byte)| match byte.to_ascii_uppercase() {
        bracket @ (b'(' | b')') => {
            is_in_comment = bracket == b'(';
            false
        }
        _ if is_in_comment => false,
        b'=' => {
            has_assignment = true;
            false
        }
        b'[' => {
            open_brackets += 1;
            // No other function of one argument ends with M.
            line[..at].trim_ascii_end().last().is_some_and(|byte| byte.eq_ignore_ascii_case(&b'M'))
        }
        b']' => {
            open_brackets -= 1;
            false
        }
        // Behind `=` or inside brackets a slash divides.
        b'/' => !has_assignment && open_brackets <= 0,
        b'#' => !matches!(number_behind(line, at), Some(0..=33 | 3000 | 3006 | 3100..=3102)),
        letter @ (b'H' | b'D') if has_moves => is_open_offset(line, at, letter, stated),
        _ => false,
    })
}

/// Returns true if the letter H or D at a place of a text can name an offset that nothing states.
fn is_open_offset(text: &[u8], at: usize, letter: u8, stated: &StatedValues) -> bool {
    // END1, AND, ROUND: part of a word.
    if at.checked_sub(1).is_some_and(|before| text[before].is_ascii_alphabetic()) {
        return false;
    }
    let stated = if letter == b'D' { &stated.radii } else { &stated.lengths };
    match number_behind(text, at) {
        Some(number) => number != 0 && !stated.contains(&number),
        // DO1, DPRNT: the beginning of a word.
        None => !text[at + 1..].trim_ascii_start().first().is_some_and(u8::is_ascii_alphabetic),
    }
}

/// Returns the number behind a byte of a text.
fn number_behind(text: &[u8], at: usize) -> Option<u32> {
    let behind = text[at + 1..].trim_ascii_start();
    let digits = behind.iter().take_while(|byte| byte.is_ascii_digit()).count();
    std::str::from_utf8(&behind[..digits]).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_run_is_needed_only_for_texts_that_can_read_outside_values() {
        let stated = StatedValues { lengths: [1].into(), ..StatedValues::default() };
        for (text, with_holes, without) in [
            ("G0 X1. Y2.\nM30\n", false, false),
            ("#1=2\nX#[1+1] Y[COS[#2]] (#510 / H2)\n", true, true),
            ("#1=2\nX#2 Y[COS[#2]] (#510 / H2)\n", false, false),
            ("#1=#5041\n", true, true),
            ("#1=#4003\n", true, true),
            ("G43 H1\nWHILE[#1LT2]DO1\nIF[[#1GT1]AND[#2LT3]]GOTO3\n#2=ROUND[#3]\nEND1\n", false, false),
            ("G43 H2\n", true, false),
            ("G41d3\n", true, false),
            ("G43 H#1\n", true, false),
            ("X#510\n", true, true),
            ("#4=ATAN[#2]/[#3]\nX[#4/2]\n", false, false),
            ("(A) /X1.\n", true, true),
            ("X[#4/2] /2 Y1.\n", true, true),
            ("#1=PRM[20]\n", true, true),
        ] {
            let found = [true, false].map(|has_moves| names_outside(text.as_bytes(), &stated, has_moves));
            assert_eq!(found, [with_holes, without], "{text}");
        }
    }
}
