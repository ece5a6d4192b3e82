//! What `verify` has to find in a program, in the words of a case's `expect.txt`.
//!
//! Each line is one thing; a line that begins with `#` explains how its numbers were worked out.
//!
//! | line | holds when |
//! |---|---|
//! | `machine grinder.toml` | the machine file in `suite/verify/` that the program runs on |
//! | `reference burr.toml` | the reference there that it is compared with |
//! | `FAIL 16 of 28, 12 missing, 16 extra, 28 folded` | the verdict; how many wanted holes are good, or how many flutes there are; the counts that aren't 0; folded are the findings on single holes for which one on several of them stands |
//! | `error row-group at O5:6 with 4.069 9.069` | the next finding: its severity, its code, its line, the calls that led there (`from O1:7`), its hole (`of r1h0`); its message or its notes have these numbers and names |
//! | `missing r3h0 r3h1` | these holes are missing, in the order of the reference |
//! | `hole r1h0 phi=0.70 depth=+1.000` | deviations of that hole: `phi`, `entry`, `bottom`, `tilt`, `depth`, `dx`, `dy`, `dz`; `hole *` is every one that was found |
//! | `neighbours six=7 inner=12 nearest=18.138` | how many of the inner holes have six neighbours; least and greatest distance (`farthest`) |
//! | `burr index=0.300 passes=5` | of flutes: `contact`, `helix_min`, `helix_max`, `index`, `speed_min`, `speed_max`, `nearest`, `passes`, `moves` |
//! | `made x=10.000 … depth=7.000 at O1:8 by T1` | without a reference: the next hole, by `x`, `y`, `z`, `i`, `j`, `k`, `depth` |
//! | `not-checked with Z 29` | a line on what isn't checked has these numbers and names |
//! | `layout` | all of it, printed for people, is `verdict.snap` |
//!
//! The findings and the holes made are all there are, in this order. A number agrees to half a unit of its last decimal, one
//! without a point exactly.

/// What came out of a run.
pub(crate) struct Outcome {
    /// Verdict and counts; none without a reference.
    pub(crate) summary: Option<String>,
    pub(crate) findings: Vec<FindingLine>,
    pub(crate) missing: Vec<String>,
    pub(crate) not_checked: Vec<String>,
    /// Numbers by what they are of.
    pub(crate) facts: Vec<(String, Facts)>,
    /// The holes of a program without a reference: place and numbers.
    pub(crate) made: Vec<(String, Facts)>,
}

type Facts = Vec<(&'static str, f64)>;

/// A finding: severity, code and place as a line of `expect.txt` has them, and message and notes.
pub(crate) struct FindingLine {
    pub(crate) head: String,
    pub(crate) text: String,
}

/// What a case expects.
pub(crate) struct Expectation<'a> {
    summary: Option<&'a str>,
    /// Each with the numbers and names that its message must have.
    findings: Vec<(&'a str, Vec<&'a str>)>,
    missing: Option<Vec<&'a str>>,
    facts: Vec<(&'a str, Vec<&'a str>)>,
    made: Vec<&'a str>,
    not_checked: Vec<Vec<&'a str>>,
    /// Whether there is a printed layout to compare with.
    pub(crate) layout: bool,
}

impl<'a> Expectation<'a> {
    pub(crate) fn parse(text: &'a str) -> Self {
        let mut expected = Self {
            summary: None,
            findings: Vec::new(),
            missing: None,
            facts: Vec::new(),
            made: Vec::new(),
            not_checked: Vec::new(),
            layout: false,
        };
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
            match word {
                "machine" | "reference" => {}
                "PASS" | "FAIL" => {
                    assert!(expected.summary.replace(line).is_none(), "a second verdict: {line}");
                }
                "alarm" | "error" | "warning" | "note" => {
                    let (head, words) = line.split_once(" with ").unwrap_or((line, ""));
                    expected.findings.push((head, words.split_whitespace().collect()));
                }
                "missing" => expected.missing = Some(rest.split_whitespace().collect()),
                "hole" | "neighbours" | "burr" => {
                    let (subject, facts) =
                        line.split_at(line.find('=').and_then(|at| line[..at].rfind(' ')).unwrap());
                    expected.facts.push((subject, facts.split_whitespace().collect()));
                }
                "made" => expected.made.push(rest),
                "not-checked" => {
                    let words = rest.strip_prefix("with ").unwrap();
                    expected.not_checked.push(words.split_whitespace().collect());
                }
                "layout" => expected.layout = true,
                _ => panic!("no line of expect.txt: {line}"),
            }
        }
        expected
    }

    /// What differs, one line each.
    pub(crate) fn differences(&self, outcome: &Outcome) -> Vec<String> {
        let mut wrong = Vec::new();
        let found = outcome.summary.as_deref();
        if found != self.summary {
            let [expected, found] = [self.summary, found].map(|summary| summary.unwrap_or("no verdict"));
            wrong.push(format!("{found}; expected is {expected}"));
        }
        self.compare_findings(&outcome.findings, &mut wrong);
        if self.missing.as_ref().is_some_and(|missing| *missing != outcome.missing) {
            wrong.push(format!("missing {}", outcome.missing.join(" ")));
        }
        for (subject, facts) in &self.facts {
            let of_subject = |found: &&(String, Facts)| {
                *subject == "hole *" && found.0.starts_with("hole ") || found.0 == *subject
            };
            let mut found = outcome.facts.iter().filter(of_subject).peekable();
            if found.peek().is_none() {
                wrong.push(format!("there is no {subject}"));
            }
            for (name, numbers) in found {
                compare(name, facts, numbers, &mut wrong);
            }
        }
        self.compare_made(&outcome.made, &mut wrong);
        for words in &self.not_checked {
            let holds = |line: &String| words.iter().all(|word| mentions(line, word));
            if !outcome.not_checked.iter().any(holds) {
                wrong.push(format!("nothing is listed as not checked with {}", words.join(" ")));
            }
        }
        wrong
    }

    fn compare_findings(&self, found: &[FindingLine], wrong: &mut Vec<String>) {
        let expected: Vec<&str> = self.findings.iter().map(|(head, _)| *head).collect();
        let heads: Vec<&str> = found.iter().map(|finding| finding.head.as_str()).collect();
        if heads != expected {
            let [found, expected] = [heads, expected].map(|all| match all.is_empty() {
                true => "nothing".to_owned(),
                false => all.join("\n  "),
            });
            wrong.push(format!("found is\n  {found}\nexpected is\n  {expected}"));
            return;
        }
        for ((head, words), finding) in self.findings.iter().zip(found) {
            for word in words.iter().filter(|word| !mentions(&finding.text, word)) {
                wrong.push(format!("{head} doesn't have {word}: {}", finding.text.trim()));
            }
        }
    }

    fn compare_made(&self, made: &[(String, Facts)], wrong: &mut Vec<String>) {
        if self.made.len() != made.len() {
            wrong.push(format!("{} holes are made; expected are {}", made.len(), self.made.len()));
        }
        for (expected, (place, numbers)) in self.made.iter().zip(made) {
            let (facts, at) = expected.split_once(" at ").unwrap();
            let facts: Vec<&str> = facts.split_whitespace().collect();
            if at != place {
                wrong.push(format!("the hole at {at} is made at {place}"));
            }
            compare(&format!("the hole at {at}"), &facts, numbers, wrong);
        }
    }
}

/// `facts` are of the form `key=number`.
fn compare(subject: &str, facts: &[&str], found: &[(&'static str, f64)], wrong: &mut Vec<String>) {
    for fact in facts {
        let (key, number) = fact.split_once('=').unwrap();
        match found.iter().find(|(name, _)| *name == key) {
            Some((_, value)) if agrees(*value, number) => {}
            Some((_, value)) => wrong.push(format!("{subject}: {key} is {value}, expected is {number}")),
            None => wrong.push(format!("{subject} has no {key}")),
        }
    }
}

/// Whether a value is the stated number, to half a unit of its last decimal.
fn agrees(value: f64, stated: &str) -> bool {
    let number: f64 = stated.parse().unwrap_or_else(|_| panic!("{stated} is no number"));
    let decimals = stated.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let half = if decimals == 0 { 0.0 } else { 0.5 * 10_f64.powi(-(decimals as i32)) };
    (value - number).abs() <= half + 1e-9
}

/// Whether a text has a number, or a name such as `T1`.
fn mentions(text: &str, stated: &str) -> bool {
    if stated.parse::<f64>().is_ok() {
        return numbers(text).iter().any(|number| agrees(*number, stated));
    }
    text.split(|c: char| !(c.is_alphanumeric() || ".-#".contains(c)))
        .any(|word| word.trim_end_matches('.') == stated)
}

/// The numbers in a text, with the signs that stand right before them.
fn numbers(text: &str) -> Vec<f64> {
    let mut all = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let digits = &rest[at..];
        let length = digits.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(digits.len());
        let sign = if rest[..at].ends_with(['-', '−']) { -1.0 } else { 1.0 };
        if let Ok(number) = digits[..length].trim_end_matches('.').parse::<f64>() {
            all.push(sign * number);
        }
        rest = &digits[length..];
    }
    all
}
