//! Numbers as tables show them: rounded, signed, counted.

/// Rounds to `places` decimals; never returns "-0.000".
pub fn rounded(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|b| b == b'0' || b == b'.') => zero.to_owned(),
        _ => text,
    }
}

/// Formats with a sign and four decimals: `+0.1200`.
pub fn signed(value: f64) -> String {
    signed_to(value, 4)
}

/// Formats with a sign, which 0 has not, and `places` decimals.
pub fn signed_to(value: f64, places: usize) -> String {
    let text = rounded(value, places);
    match value > 0.0 && text.bytes().any(|b| b.is_ascii_digit() && b != b'0') {
        true => format!("+{text}"),
        false => text,
    }
}

/// Formats with a sign and three decimals, as on a drawing: `+0.120`, `−1.500`.
pub fn with_sign(value: f64) -> String {
    signed_to(value, 3).replace('-', "−")
}

/// Formats `1 hole`, `5 holes`.
pub fn count<N: std::fmt::Display + PartialEq + From<u8>>(number: N, what: &str) -> String {
    format!("{number} {what}{}", if number == N::from(1) { "" } else { "s" })
}

/// Formats with up to six decimals: `6`, `5.9`, `66.132`.
pub fn short(value: f64) -> String {
    rounded(value, 6).trim_end_matches('0').trim_end_matches('.').to_owned()
}
