//! Requests: ranges of variables, conditions on them, claims, variables whose bounds are wanted.
use gcode_control::symbolic::compile_condition;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::Bytecode;
use gcode_lang::similar;

/// Range of a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    /// Number of a local or common variable.
    pub variable: u32,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
}

/// Text of a request that can't be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RequestError {
    /// A range is unreadable.
    #[error("--range {0}: write a variable and its limits, '#1=0.1..9.9'")]
    Range(String),
    /// The lower limit is above the upper one.
    #[error("--range {0}: the lower limit is above the upper one: exchange them")]
    EmptyRange(String),
    /// A variable has two ranges.
    #[error("--range {0}: this variable already has a range: keep one of them")]
    RangeTwice(String),
    /// A variable can't have a range.
    #[error("--range #{0}: only local and common variables have ranges: {1}")]
    Variable(u32, String),
    /// A condition is unreadable.
    #[error("--where {0}: {1}; write a condition as in IF, '#3 LE #1'")]
    Condition(String, String),
    /// A claim is unreadable.
    #[error(
        "--claim {0}: {1}; write a condition as in IF, '#100 LE 12.1', or no-alarm, 'alarm MC3001|MC3002', 'blocks LE 500', \
         'travel 1320=X100.'"
    )]
    Claim(String, String),
    /// A variable whose bounds are wanted is unreadable.
    #[error("--bounds {0}: write a variable, '#100'")]
    Bounds(String),
    /// A variable can't have bounds.
    #[error("--bounds #{0}: only local and common variables have bounds: {1}")]
    BoundsVariable(u32, String),
    /// The conditions exclude every value.
    #[error("--where: no value of the ranges satisfies the conditions: widen a range or correct a condition")]
    NothingLeft,
    /// The arithmetic is off by too much.
    #[error("--widen {0}: a part of each result from 0 to 0.001, such as 1e-9")]
    Widening(String),
    /// Nothing is asked.
    #[error("nothing to prove: give --claim or --bounds")]
    NoQuestion,
}

impl Range {
    /// Parses `#1=0.1..9.9`.
    ///
    /// # Errors
    /// [`RequestError`] for another text, or limits in the wrong order.
    pub(crate) fn parse(text: &str) -> Result<Self, RequestError> {
        let unreadable = || RequestError::Range(text.to_owned());
        let parsed = text.trim().strip_prefix('#').and_then(|rest| {
            let (number, limits) = rest.split_once('=')?;
            // Of three points any could be a decimal point.
            let (low, high) = limits.split_once("..").filter(|_| !limits.contains("..."))?;
            let limit = |limit: &str| limit.trim().parse::<f64>().ok().filter(|limit| limit.is_finite());
            // A negative zero is the zero that a control has.
            Some(Self {
                variable: number.trim().parse().ok()?,
                low: limit(low)? + 0.0,
                high: limit(high)? + 0.0,
            })
        });
        let range = parsed.ok_or_else(unreadable)?;
        if range.low > range.high {
            return Err(RequestError::EmptyRange(text.to_owned()));
        }
        Ok(range)
    }
}

/// Property that every run is claimed to have.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Claim {
    /// Condition at the end of a run, if it ends without an alarm.
    Condition(Bytecode),
    /// No alarm stops the run.
    NoAlarm,
    /// No alarm but these stops the run.
    OnlyAlarms(Vec<String>),
    /// The run ends after at most this number of blocks.
    Blocks(u64),
    /// With these settings no move leaves the stroke.
    Travel(Vec<(String, String)>),
}

impl Claim {
    /// Parses a claim.
    ///
    /// # Errors
    /// [`RequestError::Claim`] for a text that is none.
    pub(crate) fn parse(text: &str) -> Result<Self, RequestError> {
        let refused = |why: &str| RequestError::Claim(text.to_owned(), why.to_owned());
        let trimmed = text.trim();
        let (word, rest) = trimmed.split_once(char::is_whitespace).unwrap_or((trimmed, ""));
        let rest = rest.trim();
        match word.to_ascii_lowercase().as_str() {
            "no-alarm" if rest.is_empty() => Ok(Self::NoAlarm),
            "alarm" => {
                let codes: Vec<String> =
                    rest.split('|').map(|code| code.trim().to_ascii_uppercase()).collect();
                match codes.iter().find(|code| !is_alarm_code(code)) {
                    Some(code) => {
                        Err(refused(&format!("'{code}' is no alarm code such as MC3001 or PS0112")))
                    }
                    None => Ok(Self::OnlyAlarms(codes)),
                }
            }
            "blocks" => {
                let limit = rest.split_once(char::is_whitespace).and_then(|(relation, limit)| {
                    let limit: u64 = limit.trim().parse().ok()?;
                    match relation.to_ascii_uppercase().as_str() {
                        "LE" | "<=" => Some(limit),
                        "LT" | "<" => limit.checked_sub(1),
                        _ => None,
                    }
                });
                limit.map(Self::Blocks).ok_or_else(|| refused("the number of blocks is missing"))
            }
            "travel" => {
                let settings = rest.split_whitespace().map(|setting| {
                    let (key, value) = setting.split_once('=')?;
                    (matches!(key, "1320" | "1321") && !value.is_empty())
                        .then(|| (key.to_owned(), value.to_owned()))
                });
                let settings: Option<Vec<_>> = settings.collect();
                let settings = settings.filter(|settings| !settings.is_empty());
                settings
                    .map(Self::Travel)
                    .ok_or_else(|| refused("the limits are missing: 1320=X100. 1321=X-5."))
            }
            _ if trimmed.is_empty() => Err(refused("the claim is empty")),
            _ => condition(trimmed).map(Self::Condition).map_err(|why| match similar(word, WORDS) {
                Some(meant) => refused(&format!("did you mean '{meant}'?")),
                None => refused(&why),
            }),
        }
    }
}

/// Words with which a claim begins that is no condition.
const WORDS: [&str; 4] = ["no-alarm", "alarm", "blocks", "travel"];

/// Returns true for a code as the control displays it.
fn is_alarm_code(code: &str) -> bool {
    let letters = code.bytes().take_while(u8::is_ascii_uppercase).count();
    let digits = &code[letters..];
    (2..=3).contains(&letters) && digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Compiles a condition, or says why it is none.
pub(crate) fn condition(text: &str) -> Result<Bytecode, String> {
    compile_condition(text).map_err(|alarm: Alarm| {
        let row = alarm.row();
        format!("{}: {}", alarm.code(), row.message)
    })
}

/// Parses `#100`.
///
/// # Errors
/// [`RequestError::Bounds`] for a text that is none.
pub(crate) fn parse_variable(text: &str) -> Result<u32, RequestError> {
    let number = text.trim().strip_prefix('#').and_then(|digits| digits.parse().ok());
    number.ok_or_else(|| RequestError::Bounds(text.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_limits_in_order() {
        assert_eq!(Range::parse("#1=0.1..9.9"), Ok(Range { variable: 1, low: 0.1, high: 9.9 }));
        assert_eq!(Range::parse(" #101 = -5 .. -5 "), Ok(Range { variable: 101, low: -5.0, high: -5.0 }));
        for unreadable in
            ["1=0..1", "#1=0", "#1=0..", "#x=0..1", "#1=0..inf", "#1=nan..1", "#1=0...1", "#1=..", ""]
        {
            assert_eq!(Range::parse(unreadable), Err(RequestError::Range(unreadable.to_owned())));
        }
        assert_eq!(Range::parse("#1=2..1"), Err(RequestError::EmptyRange("#1=2..1".to_owned())));
    }

    #[test]
    fn a_misspelt_claim_is_named_with_the_one_that_is_meant() {
        for (text, meant) in [
            ("no-alarms", "no-alarm"),
            ("noalarm", "no-alarm"),
            ("alarms MC3001", "alarm"),
            ("block LE 5", "blocks"),
            ("travels 1320=X1.", "travel"),
        ] {
            let error = Claim::parse(text).unwrap_err().to_string();
            assert!(error.contains(&format!("did you mean '{meant}'?")), "{error}");
        }
        let error = Claim::parse("#100 LE").unwrap_err().to_string();
        assert!(error.contains("PS1125") && !error.contains("did you mean"), "{error}");
    }

    #[test]
    fn claims_are_words_or_conditions() {
        assert_eq!(Claim::parse("no-alarm"), Ok(Claim::NoAlarm));
        assert_eq!(Claim::parse("blocks LE 500"), Ok(Claim::Blocks(500)));
        assert_eq!(Claim::parse("blocks LT 500"), Ok(Claim::Blocks(499)));
        let codes = ["MC3001", "PS0112"].map(str::to_owned).to_vec();
        assert_eq!(Claim::parse("alarm MC3001| PS0112"), Ok(Claim::OnlyAlarms(codes)));
        let limit = vec![("1320".to_owned(), "X100.,Y5".to_owned())];
        assert_eq!(Claim::parse("travel 1320=X100.,Y5"), Ok(Claim::Travel(limit)));
        assert!(matches!(Claim::parse("[#1 LE 2]AND[#2 GT 3]"), Ok(Claim::Condition(_))));
        for unreadable in
            ["alarm", "alarm 3001", "blocks 5", "travel", "travel 1300=X1", "#100 LE", "#100", "", "x"]
        {
            assert!(matches!(Claim::parse(unreadable), Err(RequestError::Claim(..))), "{unreadable}");
        }
    }
}
