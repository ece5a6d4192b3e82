//! Bytes without which a line is one block and has no comment: most lines of long files needn't be read to know that.

/// Whether a line with this byte may be more than one block without comments: it may begin a comment or a remark, end a
/// block before its line does (`%`, `O`, `:`, `<`), or be of DO, END or EN, or of a folder line (`&`). Written so that many
/// bytes are looked at together, and so shortly that a few others count as such.
const fn divides(byte: u8) -> bool {
    let of_words = byte & 0xde == b'D';
    let slash_or_o = byte & 0x9f == b'/' & 0x9f;
    of_words
        | slash_or_o
        | (byte.wrapping_sub(b'%') <= b'(' - b'%')
        | (byte.wrapping_sub(b':') <= b'<' - b':')
}

/// The same for single bytes, looked up.
const DIVIDES: [bool; 256] = {
    let mut all = [false; 256];
    let mut byte = 0;
    while byte < all.len() {
        all[byte] = divides(byte as u8);
        byte += 1;
    }
    all
};

/// How far a text has no byte, from a place on, that [`divides`] its line.
#[inline(never)]
pub(super) fn find_divider(bytes: &[u8], from: usize) -> usize {
    let text = &bytes[from..];
    let divided = |chunk: &[u8; 32]| chunk.iter().fold(false, |any, byte| any | divides(*byte));
    let plain = 32 * text.as_chunks().0.iter().take_while(|chunk| !divided(chunk)).count();
    let found = text[plain..].iter().position(|byte| DIVIDES[usize::from(*byte)]);
    found.map_or(bytes.len(), |place| from + plain + place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_divides_a_line_is_passed_over() {
        for byte in *b"(;/%Oo:<DdEe&" {
            for place in 0..80 {
                let mut text = b"N10 G1 X-1.5 Y+2. Z#3 F[100*2]=,\tgzAKQ@\n\r9".repeat(3);
                text[place] = byte;
                assert_eq!(find_divider(&text, 0), place);
                assert_eq!(find_divider(&text, place), place);
                assert_eq!(find_divider(&text, place + 1), text.len());
            }
        }
    }
}
