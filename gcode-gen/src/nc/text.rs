//! Texts in programs: upper-case letters and the characters that every control can display.

/// Converts `text` to characters allowed in a comment, at most `most`: brackets would end the comment, `%`
/// the whole file.
pub fn displayable(text: &str, most: usize) -> String {
    text.chars().map(displayed).take(most).collect()
}

fn displayed(c: char) -> char {
    let c = c.to_ascii_uppercase();
    if c.is_ascii_uppercase() || c.is_ascii_digit() || " .,+-*/=#[]".contains(c) { c } else { '-' }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_leaves_the_comment() {
        assert_eq!(displayable("h1) M30 (\n%", 40), "H1- M30 ---");
        assert_eq!(displayable("孔1", 40), "-1");
        assert_eq!(displayable("abcdef", 3), "ABC");
    }
}
