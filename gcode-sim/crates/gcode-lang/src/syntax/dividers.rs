//! Search for bytes that may divide a line into several blocks. Lines without one need not be read.

/// Returns true for a byte of a line that may be more than one block without comments.
///
/// The byte may begin a comment or a remark, end a block before its line does (`%`, `O`, `:`, `<`), or belong
/// to DO, END or EN or to a folder line (`&`). The test is branch-free, so that many bytes are tested at
/// once; a few other bytes match too.
const fn divides(byte: u8) -> bool {
    let of_words = byte & 0xde == b'D';
    let slash_or_o = byte & 0x9f == b'/' & 0x9f;
    of_words
        | slash_or_o
        | (byte.wrapping_sub(b'%') <= b'(' - b'%')
        | (byte.wrapping_sub(b':') <= b'<' - b':')
}

/// Lookup table of [`divides`] for single bytes.
const DIVIDES: [bool; 256] = {
    let mut all = [false; 256];
    let mut byte = 0;
    while byte < all.len() {
        all[byte] = divides(byte as u8);
        byte += 1;
    }
    all
};

/// Returns the offset of the next byte from `from` on that [`divides`] its line, or the length of the text.
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
    fn every_divider_is_found() {
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
