//! Meanings of keywords, operators and functions.

/// Word of the language with its meaning.
pub(crate) struct LanguageRow {
    pub word: &'static str,
    /// How it is written.
    pub form: &'static str,
    pub text: &'static str,
    pub is_function: bool,
}

const fn function(word: &'static str, form: &'static str, text: &'static str) -> LanguageRow {
    LanguageRow { word, form, text, is_function: true }
}

const fn keyword(word: &'static str, form: &'static str, text: &'static str) -> LanguageRow {
    LanguageRow { word, form, text, is_function: false }
}

/// All words of the language.
pub(crate) const WORDS: &[LanguageRow] = &[
    function("SIN", "SIN[a]", "sine of degrees"),
    function("COS", "COS[a]", "cosine of degrees"),
    function("TAN", "TAN[a]", "tangent of degrees"),
    function("ASIN", "ASIN[a]", "arc sine, degrees"),
    function("ACOS", "ACOS[a]", "arc cosine, degrees"),
    function("ATAN", "ATAN[a]/[b]", "arc tangent of a/b, degrees; the signs give the quadrant"),
    function("SQRT", "SQRT[a]", "square root"),
    function("ABS", "ABS[a]", "absolute value"),
    function("ROUND", "ROUND[a]", "nearest whole number; in a word, nearest increment of the address"),
    function("FIX", "FIX[a]", "whole number towards zero"),
    function("FUP", "FUP[a]", "whole number away from zero"),
    function("LN", "LN[a]", "natural logarithm"),
    function("EXP", "EXP[a]", "power of e"),
    function("POW", "POW[a,b]", "a to the power of b"),
    function("BIN", "BIN[a]", "binary-coded decimal to number"),
    function("BCD", "BCD[a]", "number to binary-coded decimal"),
    function("ADP", "ADP[#n]", "argument with a decimal point added"),
    function("PRM", "PRM[n,bit]/[axis]", "parameter of the control"),
    function("AXNUM", "AXNUM[X]", "number of an axis"),
    keyword("IF", "IF[a EQ b]GOTO n, IF[a EQ b]THEN #1=c", "does what follows if the condition holds"),
    keyword("THEN", "IF[a EQ b]THEN #1=c", "one statement, done if the condition holds"),
    keyword(
        "GOTO",
        "GOTO n",
        "continues at sequence number n of the same program: the next one, otherwise the first",
    ),
    keyword("WHILE", "WHILE[a LT b]DO1 … END1", "repeats the blocks to END while the condition holds"),
    keyword("DO", "DO1 … END1", "begins loop 1, 2 or 3"),
    keyword("END", "END1", "ends loop 1, 2 or 3"),
    keyword(
        "DPRNT",
        "DPRNT[TEXT#1[44]]",
        "prints text, and variables with digits before and after the point",
    ),
    keyword("BPRNT", "BPRNT[TEXT#1[4]]", "prints text, and variables in binary"),
    keyword("POPEN", "POPEN", "opens the output of DPRNT"),
    keyword("PCLOS", "PCLOS", "closes the output of DPRNT"),
    keyword("SETVN", "SETVN 510[A,B]", "names common variables"),
    keyword("AX", "AX[n]=value", "word of the axis with number n"),
    keyword("EQ", "a EQ b", "equal; `#1 EQ #0` tests for vacant"),
    keyword("NE", "a NE b", "not equal"),
    keyword("GT", "a GT b", "greater"),
    keyword("GE", "a GE b", "greater or equal"),
    keyword("LT", "a LT b", "less"),
    keyword("LE", "a LE b", "less or equal"),
    keyword("AND", "a AND b", "both conditions; the common bits of two numbers"),
    keyword("OR", "a OR b", "one of two conditions; the bits of either number"),
    keyword("XOR", "a XOR b", "one of two conditions, not both; bits likewise"),
    keyword("MOD", "a MOD b", "remainder"),
];

/// Returns the row of a word.
pub(crate) fn language_row(word: &str) -> Option<&'static LanguageRow> {
    WORDS.iter().find(|row| row.word.eq_ignore_ascii_case(word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lexer::{FUNCTIONS, KEYWORDS, OPERATORS};

    #[test]
    fn every_word_of_the_lexer_has_its_meaning() {
        for word in KEYWORDS.iter().chain(&OPERATORS) {
            assert!(language_row(word).is_some_and(|row| !row.is_function), "{word}");
        }
        for word in FUNCTIONS {
            assert!(language_row(word).is_some_and(|row| row.is_function), "{word}");
        }
        assert_eq!(WORDS.len(), KEYWORDS.len() + OPERATORS.len() + FUNCTIONS.len());
    }
}
