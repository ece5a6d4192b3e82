//! Typing errors behind alarms: a letter O for a zero, a comma for a point, a sign copied from a PDF.
use std::ops::RangeInclusive;

use super::{Alarm, lacking_code_help};
use crate::source::{Sources, Span};

/// Returns the remedy for an alarm: the one its text suggests, otherwise the one in the table.
pub fn remedy(alarm: &Alarm, span: Span, sources: &Sources) -> Option<String> {
    let source = sources.get(span.source);
    let at = source.line_column(span.start);
    let from = (span.start + 1 - at.column) as usize;
    let line = source.bytes[from..].split(|byte| matches!(byte, b'\n' | b'\r')).next().unwrap_or_default();
    let (before, rest) = line.split_at((at.column as usize - 1).min(line.len()));
    let [before, rest] = [before, rest].map(|bytes| without_comments(&String::from_utf8_lossy(bytes)));
    let rest = rest.trim_matches(' ');
    let whole = format!("{before}{rest}");
    let line = AlarmLine { whole: &whole, before: &before, rest, text: &sources.text(span) };
    let rules = [
        foreign_character,
        letter_o,
        number_with_n,
        misplaced_comma,
        exponent,
        named_variable,
        unclosed_bracket,
        missing_operator,
        function_without_brackets,
        else_case,
        two_signs,
        zero_divisor,
        radius_without_point,
        dwell_with_two_times,
        work_offset_range,
        protected_program,
        lacking_code,
        vacant_target,
        prose_for_value,
        vacant_feed,
        vacant_divisor,
        end_of_if,
        zero_for_o,
    ];
    rules.into_iter().find_map(|rule| rule(alarm, &line)).or_else(|| alarm.row().help)
}

/// Returns what to do about a missing program that a control protects: it is on the control, and in no folder.
fn protected_program(alarm: &Alarm, _: &AlarmLine<'_>) -> Option<String> {
    let Alarm::ProgramNotFound { number, read_error: None } = alarm else { return None };
    missing_macro_help(*number)
}

/// Returns what to do about M98 P whose digits are repeats and a missing program, and a program that is there.
pub fn repeats_in_p_help(digits: u32) -> String {
    let (repeats, number) = (digits / 10_000, digits % 10_000);
    format!(
        "P{digits} calls O{number:04} {repeats} times; to call O{digits}, write L behind it, M98 P{digits} L1, or give --control REPEATS-IN-P=0"
    )
}

/// Explains a G code that the control lacks.
fn lacking_code(alarm: &Alarm, _: &AlarmLine<'_>) -> Option<String> {
    let Alarm::ImproperGCode { code, other } = alarm else { return None };
    Some(lacking_code_help(code, *other))
}

/// Detects `GOTO#1` with a vacant #1.
fn vacant_target(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let is_computed = alarm_line.text.contains('#');
    (*alarm == Alarm::SequenceNumberRange { number: 0 } && is_computed).then(|| {
        format!("check {}: a vacant variable counts as 0; write 1 to 99999999", alarm_line.text.trim())
    })
}

/// Detects `Z (Move to Z depth)`: words behind an address that has no number, and no expression in round brackets.
fn prose_for_value(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    const IN_EXPRESSIONS: [&str; 20] = [
        "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "SQRT", "ABS", "BIN", "BCD", "ROUND", "FIX", "FUP",
        "LN", "EXP", "POW", "MOD", "AND", "OR", "XOR",
    ];
    let comment = alarm_line.text.split(')').next()?;
    let words = comment.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| 1 < word.len());
    let mut words = words.filter(|word| !IN_EXPRESSIONS.contains(&word.to_ascii_uppercase().as_str()));
    let has_value = matches!(alarm, Alarm::RoundBracketsForValue | Alarm::RoundBrackets { .. });
    (has_value && words.next().is_some())
        .then(|| "write a number before the comment, or remove the letter".to_owned())
}

/// Detects `G01 X1. F#513` with a vacant or zero #513.
fn vacant_feed(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let (_, feed) = alarm_line.whole.split_once("F#").filter(|_| *alarm == Alarm::FeedZero)?;
    let number = leading(feed, |c| c.is_ascii_digit());
    (!number.is_empty())
        .then(|| format!("set #{number} above 0 before this block: vacant or 0 it is no feed"))
}

/// Detects `#1=5/#2` with a vacant or zero #2.
fn vacant_divisor(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let (_, divisor) = alarm_line.text.rsplit_once("/#").filter(|_| *alarm == Alarm::DivideByZero)?;
    let number = leading(divisor, |c| c.is_ascii_digit());
    (!number.is_empty()).then(|| format!("check #{number}: a vacant variable counts as 0"))
}

/// Detects `ENDIF`.
fn end_of_if(_: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    alarm_line.whole.replace(' ', "").starts_with("ENDIF").then(|| {
        "write IF[…]GOTO with the opposite condition past the blocks: a control has no ENDIF".to_owned()
    })
}

/// Detects `#[RADIUS]` and `#<radius>`.
fn named_variable(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let before = alarm_line.before.trim_end();
    let is_name = before.ends_with("#[") || before.ends_with('#') && alarm_line.rest.starts_with('<');
    let name = alarm_line.rest.trim_start_matches('<');
    let name = leading(name, |c| c.is_ascii_alphanumeric() || c == '_').to_ascii_uppercase();
    (is_read_failure(alarm) && is_name && name.starts_with(|c: char| c.is_ascii_alphabetic()))
        .then(|| format!("write [#{name}] for a variable that SETVN names, or its number"))
}

/// Detects `00001` in place of a program number.
fn zero_for_o(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let digits = leading(alarm_line.whole.trim(), |c| c.is_ascii_digit());
    let is_number = alarm_line.before.trim().is_empty() && digits.starts_with('0') && 4 < digits.len();
    (matches!(alarm, Alarm::NotAWord { .. }) && is_number)
        .then(|| format!("write O{}: a program number begins with the letter O", &digits[1..]))
}

/// Program numbers that a control can protect: macros of the machine builder and of the probe's maker.
const PROTECTED_PROGRAMS: RangeInclusive<u32> = 8000..=9999;

/// Returns what to do about a missing program, if it has the number of a macro on the control.
pub fn missing_macro_help(number: u32) -> Option<String> {
    PROTECTED_PROGRAMS.contains(&number).then(|| {
        format!(
            "a macro of the control or the probe: save O{number:04} and the macros that it calls from the control to a folder, and give that with --lib or as libraries in gcode.toml; for a run without it, put a stub there (O{number:04} and M99); check lists all that are missing"
        )
    })
}

/// Returns what to do about several such macros, of which one is named.
pub fn missing_macros_help(first: &str) -> String {
    format!(
        "macros of the control or the probe: save them and the macros that they call from the control to a folder, and give that with --lib or \
         as libraries in gcode.toml; for a run without them, put a stub there for each, as {first} and M99"
    )
}

/// Line of an alarm, without its comments.
struct AlarmLine<'a> {
    whole: &'a str,
    before: &'a str,
    /// Text from the alarm to the end of the line.
    rest: &'a str,
    text: &'a str,
}

fn without_comments(text: &str) -> String {
    let mut is_in_comment = false;
    let is_kept = |c: &char| {
        is_in_comment = (is_in_comment || *c == '(') && *c != ')';
        !is_in_comment && *c != ')'
    };
    text.chars().filter(is_kept).collect()
}

/// Returns the start of a text up to the first other character.
fn leading(text: &str, fits: fn(char) -> bool) -> &str {
    &text[..text.len() - text.trim_start_matches(fits).len()]
}

/// Returns the end of a text after the last other character.
fn trailing(text: &str, fits: fn(char) -> bool) -> &str {
    &text[text.trim_end_matches(fits).len()..]
}

/// Returns true for an alarm about notation.
fn is_read_failure(alarm: &Alarm) -> bool {
    matches!(
        alarm,
        Alarm::NotAWord { .. }
            | Alarm::NoDataAfterAddress { .. }
            | Alarm::Expression { .. }
            | Alarm::MixedStatements
            | Alarm::MissingEquals
            | Alarm::ImproperAddress { .. }
            | Alarm::MissingCloseBracket
            | Alarm::IfFormat
            | Alarm::WhileFormat
    )
}

/// Detects a character that resembles one of a control: from a word processor, a PDF or another keyboard.
fn foreign_character(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let found = alarm_line.rest.chars().find(|c| !c.is_ascii()).filter(|_| is_read_failure(alarm))?;
    let replacement = match found {
        // Bytes of another encoding; the character is unknown.
        '\u{fffd}' => return None,
        '\u{2010}'..='\u{2015}' | '\u{2212}' => "the minus '-'".to_owned(),
        '\u{a0}' | '\u{2000}'..='\u{200b}' | '\u{202f}' | '\u{3000}' | '\u{feff}' => "a space".to_owned(),
        '\u{ff01}'..='\u{ff5e}' => {
            let plain = char::from_u32(u32::from(found) - 0xfee0).unwrap_or(found);
            format!("'{plain}' in half width")
        }
        '×' => "'*'".to_owned(),
        '÷' => "'/'".to_owned(),
        _ => {
            let number = u32::from(found);
            return Some(format!("'{found}' (U+{number:04X}) is not a character of a control: retype it"));
        }
    };
    Some(format!(
        "the character U+{:04X} is not a character of a control: type {replacement}",
        u32::from(found)
    ))
}

/// Detects a letter O in a number: `GO1`, `M3O`, `X1O.`.
fn letter_o(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    if !is_read_failure(alarm) && !matches!(alarm, Alarm::ImproperGCode { .. }) {
        return None;
    }
    let chars: Vec<char> = alarm_line.whole.chars().collect();
    let in_word = letter_o_in_word(&chars);
    in_word
        .or_else(|| letter_o_in_number(&chars))
        .map(|(wrong, right)| format!("'{wrong}' has the letter O instead of a zero: write {right}"))
}

/// Returns a word with a letter O in its number, and the right one: `GO1`, `M3O`, `GO X5.`.
fn letter_o_in_word(chars: &[char]) -> Option<(String, String)> {
    (0..chars.len()).find_map(|at| {
        let letter = chars[at];
        if !letter.is_ascii_uppercase() || letter == 'O' || at > 0 && chars[at - 1].is_ascii_alphabetic() {
            return None;
        }
        let is_number = |c: &&char| matches!(c, '0'..='9' | 'O' | '.' | '-');
        let number: String = chars[at + 1..].iter().take_while(is_number).collect();
        let behind = chars.get(at + 1 + number.len());
        let is_word = behind.is_none_or(|c| !c.is_ascii_alphabetic());
        // DO1, GO TO 10 and GO 10 are statements; GO X5. is none.
        let mut next = chars[at + 1 + number.len()..].iter().skip_while(|c| **c == ' ');
        let is_before_axis = next.next().is_some_and(|c| c.is_ascii_uppercase() && *c != 'T');
        let is_statement = match letter {
            'D' => number.starts_with('O'),
            'G' => number == "O" && !is_before_axis,
            'T' => number == "O",
            _ => false,
        };
        (number.contains('O') && is_word && !is_statement)
            .then(|| (format!("{letter}{number}"), format!("{letter}{}", number.replace('O', "0"))))
    })
}

/// Returns a number with a letter O that no address precedes, and the right one: `#1OO`, `=1O.`, `GOTO 1O`.
fn letter_o_in_number(chars: &[char]) -> Option<(String, String)> {
    (0..chars.len()).find_map(|at| {
        let before = chars[..at].iter().rfind(|c| **c != ' ').copied();
        let is_joined = at > 0 && (chars[at - 1].is_ascii_alphanumeric() || chars[at - 1] == '.');
        let is_start = match chars[at] {
            '0'..='9' | '.' => !is_joined,
            'O' => matches!(before, Some('#' | '=' | '[' | '+' | '-' | '*' | '/')),
            _ => false,
        };
        let number: String = chars[at..].iter().take_while(|c| matches!(c, '0'..='9' | 'O' | '.')).collect();
        let is_number = number.contains('O') && number.contains(|c: char| c.is_ascii_digit());
        let behind = chars.get(at + number.len());
        let is_whole = behind.is_none_or(|c| !c.is_ascii_alphabetic());
        (is_start && is_number && is_whole).then(|| (number.clone(), number.replace('O', "0")))
    })
}

/// Detects `GOTO N10`.
fn number_with_n(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let number =
        alarm_line.rest.strip_prefix('N').filter(|_| matches!(alarm, Alarm::Expression { .. }))?.trim_start();
    let digits = leading(number, |c| c.is_ascii_digit());
    (alarm_line.before.trim_end().ends_with("GOTO") && !digits.is_empty())
        .then(|| format!("write GOTO {digits}, without N"))
}

/// Detects `X10,5` and `X10., Y5.`.
fn misplaced_comma(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let behind = alarm_line
        .rest
        .strip_prefix(',')
        .filter(|_| is_read_failure(alarm) || matches!(alarm, Alarm::CornerWords))?;
    let is_digit = |c: char| c.is_ascii_digit();
    let (whole, part) = (trailing(alarm_line.before, is_digit), leading(behind, is_digit));
    if !part.is_empty() && !whole.is_empty() {
        return Some(format!("write {whole}.{part}: the decimal separator is a point"));
    }
    let next = behind.trim_start().chars().next()?;
    let is_word = next.is_ascii_alphabetic() && !matches!(next, 'R' | 'C');
    is_word.then(|| "remove the comma: words are not separated by commas".to_owned())
}

/// Detects `1E3`.
fn exponent(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    if !matches!(alarm, Alarm::MixedStatements | Alarm::ImproperAddress { letter: 'E' }) {
        return None;
    }
    let line = alarm_line.whole;
    line.match_indices('E').find_map(|(at, _)| {
        let mantissa = trailing(&line[..at], |c| matches!(c, '0'..='9' | '.'));
        let power = leading(&line[at + 1..], |c| matches!(c, '0'..='9' | '-' | '+'));
        let written = format!("{mantissa}E{power}");
        let value: f64 = written.parse().ok().filter(|_| !mantissa.is_empty())?;
        Some(format!("write {value} for {written}: numbers have no exponent"))
    })
}

/// Detects `X[#1+5. Y0`.
fn unclosed_bracket(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let next = alarm_line.rest.chars().next().filter(|_| matches!(alarm, Alarm::Expression { .. }))?;
    let count = |bracket: char| alarm_line.before.matches(bracket).count();
    (next.is_ascii_alphabetic() && count('[') > count(']'))
        .then(|| format!("write ']' before {}", leading(alarm_line.rest, |c| !c.is_whitespace())))
}

/// Detects `#1=5#2`.
fn missing_operator(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    if *alarm != Alarm::MissingEquals {
        return None;
    }
    let line = alarm_line.whole;
    let at = line.rfind('#')?;
    let before = line[..at].trim_end();
    let is_value = before.ends_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | ']'));
    (is_value && before.contains('='))
        .then(|| format!("check for a missing + - * or / before {}", &line[at..]))
}

/// Detects `#1=SIN30` and `#1=ABS-#2`.
fn function_without_brackets(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    if *alarm != Alarm::MissingOpenBracket {
        return None;
    }
    let before = alarm_line.before.trim_end();
    let name = &before[before.rfind(|c: char| !c.is_ascii_alphabetic()).map_or(0, |at| at + 1)..];
    let rest = alarm_line.rest;
    let end = rest.find(|c: char| !matches!(c, '0'..='9' | '.' | '#' | '-')).unwrap_or(rest.len());
    (!name.is_empty() && end > 0).then(|| format!("write {name}[{}]", &rest[..end]))
}

/// Detects `IF[…]THEN #1=2 ELSE #1=3`.
fn else_case(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let is_else =
        matches!(alarm, Alarm::NoDataAfterAddress { letter: 'E' }) && alarm_line.rest.starts_with("ELSE");
    is_else.then(|| {
        "write a second IF with the opposite condition, or GOTO past it: a control has no ELSE".to_owned()
    })
}

/// Detects `Z--5`.
fn two_signs(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let Alarm::TwoSigns { letter } = alarm else { return None };
    let value = alarm_line.rest.strip_prefix('-').filter(|_| alarm_line.before.trim_end().ends_with('-'))?;
    let value = leading(value, |c| matches!(c, '0'..='9' | '.'));
    Some(format!("write one sign: {letter}-{value}, or {letter}-[-{value}]"))
}

/// Detects a written zero divisor, `10/0`.
fn zero_divisor(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let (_, divisor) = alarm_line.text.rsplit_once('/').filter(|_| *alarm == Alarm::DivideByZero)?;
    let is_zero = divisor.chars().all(|c| matches!(c, '0' | '.' | ' ')) && divisor.contains('0');
    is_zero.then(|| "correct the divisor: it is written as 0".to_owned())
}

/// Detects `R5` instead of `R5.`.
fn radius_without_point(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let Alarm::RadiusTooSmall { radius, .. } = alarm else { return None };
    let number = alarm_line.text.strip_prefix('R')?.trim();
    let written: f64 = number.parse().ok().filter(|_| !number.contains('.'))?;
    let is_other = (written.abs() - radius).abs() > 1e-9;
    is_other.then(|| format!("write R{number}.: R{number} without a decimal point is {radius} mm here"))
}

/// Detects two times in one dwell, `G04 X1.5 P500`.
fn dwell_with_two_times(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let Alarm::WordNotSimulated(_) = alarm else { return None };
    let line = alarm_line.whole;
    let is_dwell = line.split(|c: char| !c.is_ascii_alphanumeric()).any(|word| matches!(word, "G4" | "G04"));
    (is_dwell && line.contains('P'))
        .then(|| "write one time for a dwell: X in seconds or P in milliseconds".to_owned())
}

/// Detects the P of G10 L2 or of an additional work coordinate system, whose ranges differ from those of H and D.
fn work_offset_range(alarm: &Alarm, alarm_line: &AlarmLine<'_>) -> Option<String> {
    let Alarm::OffsetNumber { number } = alarm else { return None };
    let line = alarm_line.whole.replace(' ', "").to_ascii_uppercase();
    let has = |letter: char, number: f64| {
        let mut texts = line.split(letter).skip(1);
        texts.any(|text| leading(text, |c| c.is_ascii_digit() || c == '.').parse() == Ok(number))
    };
    if !has('P', *number as f64) {
        return None;
    }
    if has('G', 10.0) && has('L', 2.0) {
        return Some(
            "write P0 for the external offset, P1 to P6 for G54 to G59; L20 P1 is G54.1 P1".to_owned(),
        );
    }
    let is_additional = has('G', 54.0) || has('G', 54.1) || has('G', 154.0) || has('L', 20.0);
    is_additional.then(|| {
        "write P1 to P300 (P48 on a 0i-F, P99 on a Haas; --control WORK-SYSTEMS=… sets the number)".to_owned()
    })
}

#[cfg(test)]
mod tests;
