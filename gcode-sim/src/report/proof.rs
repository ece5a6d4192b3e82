//! The answer of `prove` as JSON and as text.
use std::collections::BTreeMap;
use std::fmt::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::count;
use gcode_prove::{ClaimAnswer, ClaimVerdict, ProofAnswer};

/// Verdicts on claims for all values of the ranges, and bounds of variables.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct ProofReport {
    /// `proved`, `refuted` or `undecided`: the worst of the claims'.
    verdict: ClaimVerdict,
    /// In the order given.
    claims: Vec<ClaimRow>,
    /// Bounds of variables at the end of all runs; null if no run gives one, or something isn't followed.
    bounds: BTreeMap<String, Option<[f64; 2]>>,
    /// Share of the values for which a claim isn't decided.
    undecided_share: f64,
    /// Number of boxes examined.
    boxes: u64,
    /// Number of single runs.
    runs: u64,
    seconds: f64,
    /// What depends on the ranges and isn't followed.
    unfollowed: Vec<String>,
    /// No run is known to end without an alarm: a condition at the end says nothing then.
    never_ends: bool,
    /// Variables with a range that no run reads, where every claim is proved.
    unread: Vec<String>,
    /// Text of the counterexamples, in the order of the claims.
    #[serde(skip)]
    counterexamples: Vec<String>,
}

/// How a counterexample is run.
pub(crate) trait Counterexample {
    /// Returns the block that is run instead of the program.
    fn call(&self) -> Option<&str>;

    /// Returns the command that runs the program with these variables, `#1=2`, and these settings of the control.
    fn command(&self, sets: &[String], settings: &[String]) -> String;
}

#[derive(Debug, Serialize, JsonSchema)]
struct ClaimRow {
    claim: String,
    verdict: ClaimVerdict,
    /// Values at which the claim fails, by variable.
    counterexample: Option<BTreeMap<String, f64>>,
}

fn row(answer: &ClaimAnswer) -> ClaimRow {
    let values = answer.counterexample.as_ref();
    let named = |(variable, value): &(u32, f64)| (format!("#{variable}"), *value);
    ClaimRow {
        claim: answer.claim.clone(),
        verdict: answer.verdict,
        counterexample: values.map(|values| values.iter().map(named).collect()),
    }
}

impl ProofReport {
    /// Returns the report.
    pub(crate) fn new(answer: &ProofAnswer, seconds: f64, rerun: impl Counterexample) -> Self {
        let bounds = answer
            .bounds
            .iter()
            .map(|bounds| (format!("#{}", bounds.variable), bounds.range.map(|(low, high)| [low, high])));
        Self {
            verdict: answer.verdict,
            claims: answer.claims.iter().map(row).collect(),
            bounds: bounds.collect(),
            undecided_share: answer.undecided_share,
            boxes: answer.boxes,
            runs: answer.runs,
            seconds,
            unfollowed: answer.unfollowed.clone(),
            never_ends: answer.never_ends,
            unread: answer.unread.iter().map(|variable| format!("#{variable}")).collect(),
            counterexamples: answer.claims.iter().map(|claim| counterexample(claim, &rerun)).collect(),
        }
    }

    /// Returns the report as text.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        for (row, counterexample) in self.claims.iter().zip(&self.counterexamples) {
            let verdict = match row.verdict {
                ClaimVerdict::Proved => "proved   ",
                ClaimVerdict::Refuted => "REFUTED  ",
                ClaimVerdict::Undecided => "undecided",
            };
            _ = writeln!(text, "{verdict}  {}", row.claim);
            text.push_str(counterexample);
        }
        for (variable, range) in &self.bounds {
            _ = match range {
                Some([low, high]) => writeln!(text, "{variable} from {} to {}", short(*low), short(*high)),
                None if self.unfollowed.is_empty() => {
                    writeln!(text, "{variable} has no bounds: no run gives it a value")
                }
                None => writeln!(text, "{variable} has no bounds that are found"),
            };
        }
        if self.undecided_share > 0.0 {
            _ = writeln!(text, "undecided: {} of the values", percent(self.undecided_share));
        }
        for what in &self.unfollowed {
            _ = writeln!(text, "not followed: {what}");
        }
        if self.never_ends {
            text.push_str(
                "no run is known to end without an alarm: a condition at the end says nothing then\n",
            );
        }
        for variable in &self.unread {
            _ = writeln!(text, "{variable} is read by no run: its --range decides nothing");
        }
        let boxes = if self.boxes == 1 { "box" } else { "boxes" };
        let runs = count(self.runs as usize, "run");
        _ = writeln!(text, "{} {boxes} and {runs}, {:.2} s", self.boxes, self.seconds);
        text
    }
}

/// Returns the settings of a claim on stroke limits.
fn settings_of(claim: &str) -> Vec<String> {
    let mut words = claim.split_whitespace();
    let is_travel = words.next().is_some_and(|word| word.eq_ignore_ascii_case("travel"));
    words.filter(|_| is_travel).map(str::to_owned).collect()
}

/// Returns a counterexample as a program to run, and as the command that runs it.
fn counterexample(claim: &ClaimAnswer, rerun: &impl Counterexample) -> String {
    let Some(values) = &claim.counterexample else { return String::new() };
    let mut text = String::new();
    if let Some(call) = rerun.call()
        && values.iter().all(|(_, value)| digits(*value) <= MAX_DIGITS)
    {
        for (variable, value) in values {
            _ = writeln!(text, "             #{variable}={}", number(*value));
        }
        _ = writeln!(text, "             {call}\n             M30");
    }
    let sets: Vec<_> =
        values.iter().map(|(variable, value)| format!("#{variable}={}", short(*value))).collect();
    _ = writeln!(text, "           {}", rerun.command(&sets, &settings_of(&claim.claim)));
    text
}

/// Returns a number with an exponent where its digits would fill a line.
fn short(value: f64) -> String {
    let magnitude = value.abs();
    let is_long = magnitude != 0.0 && !(1e-6..1e15).contains(&magnitude);
    if is_long { format!("{value:e}") } else { value.to_string() }
}

/// Largest number of digits of a number in an expression (PS0003).
const MAX_DIGITS: usize = 12;

/// Returns the number of digits of a number as a program writes it.
fn digits(value: f64) -> usize {
    number(value).bytes().filter(u8::is_ascii_digit).count()
}

/// Returns a number as a program writes it, always with a point.
fn number(value: f64) -> String {
    let text = value.to_string();
    if text.contains('.') { text } else { text + "." }
}

/// Returns a share in percent, never rounded to nothing.
fn percent(share: f64) -> String {
    let percent = share * 100.0;
    if percent < 0.01 { "less than 0.01 %".to_owned() } else { format!("{percent:.2} %") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_never_rounded_to_nothing() {
        assert_eq!(percent(0.25), "25.00 %");
        assert_eq!(percent(1e-9), "less than 0.01 %");
        assert_eq!(
            (short(1e300), short(5e-324), short(-0.5)),
            ("1e300".into(), "5e-324".into(), "-0.5".into())
        );
        assert_eq!(settings_of("travel 1320=X50. 1321=X-5."), ["1320=X50.", "1321=X-5."]);
        assert!(settings_of("#100 LE 5").is_empty());
        assert_eq!(number(3.0), "3.");
        assert_eq!(number(-0.25), "-0.25");
        assert_eq!((digits(-12345678901.5), digits(1e-12)), (12, 13));
    }
}
