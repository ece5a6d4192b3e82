//! Slips of TOML: a line that the reader of TOML refuses, and the line that is meant.
//!
//! Each repair changes the line in one way that people get wrong. The first after which the line is TOML is the one that is
//! meant.
use toml::Table;

/// A repair: what is wrong, and the value or the line put right; `None` if the line isn't wrong in this way.
type Repair = (&'static str, fn(&str) -> Option<String>);

/// Repairs of a value.
const OF_VALUE: [Repair; 15] = [
    ("a minus is the sign - of the keyboard", keyboard_minus),
    ("text has straight quotes on both sides", straight_quotes),
    ("a line ends without a comma", |value| value.strip_suffix(',').map(|rest| rest.trim().to_owned())),
    ("a number has a point, not a comma", decimal_point),
    ("a number does not begin with 0", without_leading_zeros),
    ("a number has a digit on both sides of its point", digits_at_point),
    ("a number has no letter or sign before it", without_mark),
    ("a fraction is written as a decimal", decimal_fraction),
    ("a line ends without ';'", without_semicolon),
    ("a comment begins with #", with_comment),
    ("a number has no unit", without_unit),
    ("'=' stands once", |value| value.strip_prefix('=').map(|rest| rest.trim().to_owned())),
    ("a number has a point, not a comma", decimal_points_in_brackets),
    ("what is in brackets is separated by commas, and text has quotes", in_brackets),
    ("text has quotes on both sides", with_quotes),
];

/// Returns what is wrong with the line that the reader of TOML refuses, with the line that is right; the error may show in the
/// next line only.
pub(super) fn syntax_slip(text: &str, line: usize) -> Option<(usize, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let at = |line: usize| lines.get(line.checked_sub(1)?).copied().filter(|line| !line.trim().is_empty());
    let before = (1..line).rev().find(|line| at(*line).is_some());
    std::iter::once(line).chain(before).find_map(|line| {
        let slip = || Some((line, of_line(at(line)?, section(&lines[..line]))?));
        doubled_table(&lines, line).or_else(slip)
    })
}

/// Returns the table in which a line stands, as a prefix of its keys.
fn section(lines: &[&str]) -> String {
    let header = lines.iter().rev().find_map(|line| line.trim().strip_prefix('['));
    let name = header.and_then(|rest| rest.trim_start_matches('[').split(']').next());
    name.map(|name| format!("{}.", name.trim())).unwrap_or_default()
}

/// Returns the slip of a header of a table that is there twice, with its line: a list has double brackets in all of them.
fn doubled_table(lines: &[&str], line: usize) -> Option<(usize, String)> {
    let header = |line: &str| line.split('#').next().map(|head| head.trim().to_owned());
    let own = header(lines.get(line.checked_sub(1)?)?).filter(|own| own.starts_with('['))?;
    let (name, is_list) = match own.strip_prefix("[[").and_then(|rest| rest.strip_suffix("]]")) {
        Some(name) => (name.to_owned(), true),
        None => (own.strip_prefix('[')?.strip_suffix(']')?.to_owned(), false),
    };
    let (single, double) = (format!("[{name}]"), format!("[[{name}]]"));
    let place = |of: &str| lines[..line - 1].iter().position(|other| header(other).as_deref() == Some(of));
    let slip = |line: usize, fault: &str, remedy: &str| Some((line, format!("{single} {fault}: {remedy}")));
    let of_list = format!("a table of a list has double brackets; write {double}");
    let one = format!("put its keys below one {single}; in a list of several each is {double}");
    match (is_list, place(&single), place(&double)) {
        (true, Some(other), _) => slip(other + 1, &format!("is {double} in line {line}"), &of_list),
        (false, Some(_), _) => slip(line, "is there twice", &one),
        (false, None, Some(other)) => slip(line, &format!("is {double} in line {}", other + 1), &of_list),
        _ => None,
    }
}

/// Returns the slip of one line.
fn of_line(line: &str, section: String) -> Option<String> {
    let line = line.trim();
    if is_toml(line) {
        return None;
    }
    if line.starts_with('[') {
        let (head, _) = line.split_once('#').unwrap_or((line, ""));
        if let Some(quoted) = quoted_header(head.trim()) {
            return Some(format!("{}: a name with a space has quotes; write {quoted}", head.trim()));
        }
        let brackets = if line.starts_with("[[") { "]]" } else { "]" };
        let closed = format!("{}{brackets}", head.trim().trim_end_matches(']'));
        return is_toml(&closed)
            .then(|| format!("{}: a table ends with its bracket; write {closed}", head.trim()));
    }
    if let Some((key, value)) = line.split_once('=')
        && key.contains(['/', '\\'])
        && !key.contains('"')
    {
        let right = format!("\"{}\" = {}", key.trim().replace('\\', "/"), value.trim());
        return is_toml(&right).then(|| format!("{}: a path has quotes; write {right}", key.trim()));
    }
    let is_key = |key: &str| {
        !key.is_empty()
            && key.chars().all(|c| c.is_ascii_alphanumeric() || ['_', '-', '.', '#', '"', ' '].contains(&c))
    };
    let Some((key, value)) = line.split_once('=').filter(|(key, _)| is_key(key.trim())) else {
        // `key: value` and `key value`.
        let (key, value) = line.split_once([':', ' ', '\t']).filter(|(key, _)| is_key(key.trim()))?;
        let right = format!("{} = {}", key.trim(), value.trim().trim_start_matches([':', '=']).trim());
        return is_toml(&right).then(|| format!("key '{section}{}' has no '='; write {right}", key.trim()));
    };
    let (key, value) = (key.trim(), value.trim());
    if value.is_empty() || value.starts_with('#') {
        return Some(format!("key '{section}{key}' has no value"));
    }
    let right = |value: &str| Some(format!("{key} = {value}")).filter(|line| is_toml(line));
    let (code, _) = value.split_once(" #").unwrap_or((value, ""));
    let code = code.trim();
    let repaired = OF_VALUE.iter().find_map(|(fault, repair)| {
        let right = right(&repair(code)?)?;
        Some(format!("key '{section}{key}' is {code}: {fault}; write {right}"))
    });
    let repaired = repaired.or_else(|| {
        let (first, second) = two_keys(code)?;
        let first = right(first)?;
        Some(format!("key '{section}{key}' is {code}: each key has a line of its own; write {first} and below it {second}"))
    });
    repaired.or_else(|| {
        let number = spoilt_number(code)?;
        let which = if number == code { "it" } else { number };
        Some(format!("key '{section}{key}' is {code}: {which} is no number; write its digits without a gap, with one point"))
    })
}

/// Returns the value, or the first item of a list, that is meant as a number and is none.
fn spoilt_number(value: &str) -> Option<&str> {
    let items = value.strip_prefix('[').map(|rest| rest.trim_end_matches([']', ' ']));
    let mut items = items.map_or(vec![value], |items| items.split(',').map(str::trim).collect()).into_iter();
    items.find(|item| is_meant_as_number(item) && !is_toml(&format!("k = {item}")))
}

/// Returns true for text of a digit and other characters of numbers, or those typed among them.
fn is_meant_as_number(text: &str) -> bool {
    let is_of_number = |c: char| {
        c.is_ascii_digit()
            || matches!(c, '+' | '-' | '.' | ',' | ' ' | '_' | 'e' | 'E' | 'x' | 'X' | 'o' | 'O')
    };
    text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.'))
        && text.contains(|c: char| c.is_ascii_digit())
        && text.chars().all(is_of_number)
}

/// Returns the header of a work offset with its name in quotes: `[offsets."G54.1 P1"]`.
fn quoted_header(head: &str) -> Option<String> {
    let inside = head.strip_prefix('[')?.strip_suffix(']')?;
    let (table, name) = inside.split_once('.').filter(|(_, name)| name.contains(' '))?;
    Some(format!("[{}.\"{}\"]", table.trim(), name.trim())).filter(|right| is_toml(right))
}

/// Returns the lines that two keys on one line are meant to be: `X = 1.0` and `Y = 2.0`.
fn two_keys(value: &str) -> Option<(&str, String)> {
    let (first, rest) = value.split_once(char::is_whitespace)?;
    let (key, second) = rest.split_once('=')?;
    let is_name =
        |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    is_name(key.trim()).then(|| (first.trim_end_matches(','), format!("{} = {}", key.trim(), second.trim())))
}

fn is_toml(line: &str) -> bool {
    line.parse::<Table>().is_ok()
}

fn straight_quotes(value: &str) -> Option<String> {
    let is_curly = |c: char| matches!(c, '“' | '”' | '„' | '«' | '»' | '‘' | '’' | '＂');
    value.contains(is_curly).then(|| value.replace(is_curly, "\""))
}

/// Returns a value with the minus of a keyboard in place of a typographic one or a dash.
fn keyboard_minus(value: &str) -> Option<String> {
    let is_minus = |c: char| matches!(c, '−' | '–' | '—');
    let right = value.replace(is_minus, "-");
    let right = decimal_point(&right).unwrap_or_else(|| whole(&right));
    value.contains(is_minus).then_some(right)
}

/// Returns a number with its comma as a point: 300,0 and 1,5e-3.
fn decimal_point(value: &str) -> Option<String> {
    let right = value.replacen(',', ".", 1);
    (right != value && right.parse::<f64>().is_ok()).then(|| whole(&right))
}

/// Returns a whole number without the zeros before it, `01`.
fn without_leading_zeros(value: &str) -> Option<String> {
    let digits = value.trim_start_matches('0');
    let is_whole = !value.is_empty() && value.chars().all(|c| c.is_ascii_digit());
    is_whole.then(|| if digits.is_empty() { "0".to_owned() } else { digits.to_owned() })
}

/// Returns a number without the sign of a diameter, or the letter of a tool or offset before it: Ø6.8, T1.
fn without_mark(value: &str) -> Option<String> {
    let number = value.strip_prefix(['Ø', 'ø', 'Φ', 'φ', '⌀', '∅', 'T', 'H', 'D', 'R'])?.trim();
    let number = decimal_point(number).unwrap_or_else(|| whole(number));
    let begins = |c: char| c.is_ascii_digit() || c == '-';
    (number.starts_with(begins) && number.parse::<f64>().is_ok()).then_some(number)
}

/// Returns a fraction as a decimal: 1/4 is 0.25.
fn decimal_fraction(value: &str) -> Option<String> {
    let (above, below) = value.split_once('/')?;
    let whole_number = |text: &str| text.trim().parse::<u16>().ok();
    let (above, below) = (whole_number(above)?, whole_number(below).filter(|below| *below > 0)?);
    Some(format!("{:?}", f64::from(above) / f64::from(below)))
}

fn digits_at_point(value: &str) -> Option<String> {
    value.parse::<f64>().is_ok().then(|| whole(value))
}

/// Returns a number with digits on both sides of its point.
fn whole(number: &str) -> String {
    let right = match number.split_once('.') {
        Some((before, after)) if !after.starts_with(|c: char| c.is_ascii_digit()) => {
            format!("{before}.0{after}")
        }
        _ => number.to_owned(),
    };
    let unsigned = right.trim_start_matches(['+', '-']);
    if unsigned.starts_with('.') { right.replacen('.', "0.", 1) } else { right }
}

fn without_unit(value: &str) -> Option<String> {
    let number =
        value.trim_end_matches(|c: char| c.is_alphabetic() || ['°', '"', '\'', ' ', '/'].contains(&c));
    let number = decimal_point(number).unwrap_or_else(|| whole(number));
    (number.len() < value.len() && number.parse::<f64>().is_ok()).then_some(number)
}

fn without_semicolon(value: &str) -> Option<String> {
    value.strip_suffix(';').map(|rest| rest.trim().to_owned())
}

fn with_comment(value: &str) -> Option<String> {
    let start = [" (", " //", " ;", ";"].iter().filter_map(|mark| value.find(mark)).min()?;
    let comment = value[start..].trim().trim_start_matches(['(', '/', ';']).trim_end_matches(')').trim();
    Some(format!("{} # {comment}", value[..start].trim()))
}

/// Returns an inline table or a list with commas, quotes round its words, and its closing bracket.
fn in_brackets(value: &str) -> Option<String> {
    let closing = match value.chars().next()? {
        '{' => '}',
        '[' => ']',
        _ => return None,
    };
    let inside = value[1..].trim_end_matches([closing, ' ']);
    let item = |item: &str| {
        let (key, value) =
            item.split_once('=').map_or((None, item), |(key, value)| (Some(key.trim()), value));
        let value = value.trim();
        let value = if is_toml(&format!("k = {value}")) { value.to_owned() } else { with_quotes(value)? };
        Some(key.map_or(value.clone(), |key| format!("{key} = {value}")))
    };
    let items: Option<Vec<String>> = inside.split([',', ';']).map(item).collect();
    let items = items?.join(", ");
    Some(if closing == '}' { format!("{{ {items} }}") } else { format!("[{items}]") })
}

/// Returns an inline table with a point in each number that has a comma: `{ diameter = 125,5, holes = 8 }`.
fn decimal_points_in_brackets(value: &str) -> Option<String> {
    let inside = value.strip_prefix('{')?.strip_suffix('}')?;
    let is_whole = |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit());
    let mut items: Vec<String> = Vec::new();
    let mut is_changed = false;
    for item in inside.split(',').map(str::trim) {
        match items.last_mut() {
            Some(last)
                if is_whole(item)
                    && last
                        .split_once('=')
                        .is_some_and(|(_, value)| is_whole(value.trim().trim_start_matches('-'))) =>
            {
                last.push('.');
                last.push_str(item);
                is_changed = true;
            }
            _ => items.push(item.to_owned()),
        }
    }
    is_changed.then(|| format!("{{ {} }}", items.join(", ")))
}

fn with_quotes(value: &str) -> Option<String> {
    let word = value.trim_matches(['"', '\'']);
    let is_number = word.starts_with(|c: char| c.is_ascii_digit()) && word.contains([' ', '.']);
    let is_word = !word.is_empty()
        && !is_number
        && !is_meant_as_number(word)
        && !word.contains(['"', '{', '}', '[', ']', '=', ',', '\\']);
    is_word.then(|| format!("\"{word}\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_named_with_the_line_that_is_right() {
        let cases = [
            (
                "length = 300,0",
                "key 'drill.length' is 300,0: a number has a point, not a comma; write length = 300.0",
            ),
            (
                "length = 300,0  # mm",
                "key 'drill.length' is 300,0: a number has a point, not a comma; write length = 300.0",
            ),
            (
                "length = .5",
                "key 'drill.length' is .5: a number has a digit on both sides of its point; write length = 0.5",
            ),
            (
                "length = -5.",
                "key 'drill.length' is -5.: a number has a digit on both sides of its point; write length = -5.0",
            ),
            (
                "Z = −450.0",
                "key 'drill.Z' is −450.0: a minus is the sign - of the keyboard; write Z = -450.0",
            ),
            (
                "origin = [–300,0]",
                "key 'drill.origin' is [–300,0]: a minus is the sign - of the keyboard; write origin = [-300,0]",
            ),
            (
                "Z = −450,5",
                "key 'drill.Z' is −450,5: a minus is the sign - of the keyboard; write Z = -450.5",
            ),
            ("Z = -400.0,", "key 'drill.Z' is -400.0,: a line ends without a comma; write Z = -400.0"),
            ("number = 01", "key 'drill.number' is 01: a number does not begin with 0; write number = 1"),
            (
                "number = T1",
                "key 'drill.number' is T1: a number has no letter or sign before it; write number = 1",
            ),
            (
                "diameter = Ø6,8",
                "key 'drill.diameter' is Ø6,8: a number has no letter or sign before it; write diameter = 6.8",
            ),
            (
                "diameter = 1/4",
                "key 'drill.diameter' is 1/4: a fraction is written as a decimal; write diameter = 0.25",
            ),
            (
                "X=-300.0 Y=-200.0",
                "key 'drill.X' is -300.0 Y=-200.0: each key has a line of its own; write X = -300.0 and below it \
                 Y = -200.0",
            ),
            (
                "[offsets.G54.1 P1]",
                "[offsets.G54.1 P1]: a name with a space has quotes; write [offsets.\"G54.1 P1\"]",
            ),
            ("length = 300 mm", "key 'drill.length' is 300 mm: a number has no unit; write length = 300"),
            ("length = 12,5mm", "key 'drill.length' is 12,5mm: a number has no unit; write length = 12.5"),
            (
                "length = 300.0;",
                "key 'drill.length' is 300.0;: a line ends without ';'; write length = 300.0",
            ),
            (
                "length = 300.0 (OF IT)",
                "key 'drill.length' is 300.0 (OF IT): a comment begins with #; write length = 300.0 # OF IT",
            ),
            (
                "length = 300.0 // of it",
                "key 'drill.length' is 300.0 // of it: a comment begins with #; write length = 300.0 # of it",
            ),
            ("length == 300.0", "key 'drill.length' is = 300.0: '=' stands once; write length = 300.0"),
            ("length =", "key 'drill.length' has no value"),
            ("length: 300.0", "key 'drill.length' has no '='; write length = 300.0"),
            ("length 300.0", "key 'drill.length' has no '='; write length = 300.0"),
            (
                "kind = drill\"",
                "key 'drill.kind' is drill\": text has quotes on both sides; write kind = \"drill\"",
            ),
            (
                "kind = \"drill",
                "key 'drill.kind' is \"drill: text has quotes on both sides; write kind = \"drill\"",
            ),
            (
                "kind = spot-drill",
                "key 'drill.kind' is spot-drill: text has quotes on both sides; write kind = \"spot-drill\"",
            ),
            (
                "kind = “drill”",
                "key 'drill.kind' is “drill”: text has straight quotes on both sides; write kind = \"drill\"",
            ),
            (
                "rotary = { letter = B; sign = 1 }",
                "key 'drill.rotary' is { letter = B; sign = 1 }: what is in brackets is separated by commas, and text has \
                 quotes; write rotary = { letter = \"B\", sign = 1 }",
            ),
            (
                "length = -5 0.0",
                "key 'drill.length' is -5 0.0: it is no number; write its digits without a gap, with one point",
            ),
            (
                "length = -30x0.0",
                "key 'drill.length' is -30x0.0: it is no number; write its digits without a gap, with one point",
            ),
            (
                "length = 16-0.0",
                "key 'drill.length' is 16-0.0: it is no number; write its digits without a gap, with one point",
            ),
            (
                "length = 1.234,5",
                "key 'drill.length' is 1.234,5: it is no number; write its digits without a gap, with one point",
            ),
            (
                "origin = [-400. 0, -250.0, 3]",
                "key 'drill.origin' is [-400. 0, -250.0, 3]: -400. 0 is no number; write its digits without a gap, with one \
                 point",
            ),
            (
                "circle = { diameter = 125,5, holes = 8 }",
                "key 'drill.circle' is { diameter = 125,5, holes = 8 }: a number has a point, not a comma; write circle = \
                 { diameter = 125.5, holes = 8 }",
            ),
            (
                "parts/O1001.nc = \"drawings/O1001.csv\"",
                "parts/O1001.nc: a path has quotes; write \"parts/O1001.nc\" = \"drawings/O1001.csv\"",
            ),
            ("[tool", "[tool: a table ends with its bracket; write [tool]"),
            ("[[tool]", "[[tool]: a table ends with its bracket; write [[tool]]"),
        ];
        for (line, expected) in cases {
            let text = format!("[drill]\n{line}\n");
            assert!(text.parse::<Table>().is_err(), "{line}");
            assert_eq!(syntax_slip(&text, 2), Some((2, expected.to_owned())), "{line}");
        }
    }

    /// The reader of TOML notices an open bracket in the next line, and a second table where it begins.
    #[test]
    fn a_slip_of_the_line_before_and_a_doubled_table_are_named() {
        let text = "rotary = { letter = \"B\", sign = 1\n\nlength = 3\n";
        let (line, slip) = syntax_slip(text, 3).unwrap();
        assert_eq!(
            (line, slip.ends_with("write rotary = { letter = \"B\", sign = 1 }")),
            (1, true),
            "{slip}"
        );
        let text = "[hole] # first\nx = 1\n[hole]\nx = 2\n";
        let slip =
            "[hole] is there twice: put its keys below one [hole]; in a list of several each is [[hole]]";
        assert_eq!(syntax_slip(text, 3), Some((3, slip.to_owned())));
        let text = "\n[hole] # first\nx = 1\n[[hole]]\nx = 2\n";
        let slip = "[hole] is [[hole]] in line 4: a table of a list has double brackets; write [[hole]]";
        assert_eq!(syntax_slip(text, 4), Some((2, slip.to_owned())));
        let text = "[[hole]]\nx = 1\n[hole]\nx = 2\n";
        let slip = "[hole] is [[hole]] in line 1: a table of a list has double brackets; write [[hole]]";
        assert_eq!(syntax_slip(text, 3), Some((3, slip.to_owned())));
    }

    #[test]
    fn a_line_without_a_likely_slip_is_left_to_the_reader_of_toml() {
        for line in ["length = 3", "= 5", "length = {{", "  1, 2 ],"] {
            assert_eq!(syntax_slip(&format!("{line}\n"), 1), None, "{line}");
        }
    }
}
