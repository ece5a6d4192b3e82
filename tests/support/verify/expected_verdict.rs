//! Expected verdict of `verify` on a program, in the words of a case's `expect.txt`.
//!
//! Each line is one item; a line that begins with `#` explains how its numbers are computed.
//!
//! | line | holds when |
//! |---|---|
//! | `start X=0 Z=250` | always: these axes stand there before the program, as with `--start` |
//! | `machine grinder.toml` | always: the program runs on this machine file in `suite/verify/` |
//! | `reference burr.toml` | always: the program is compared with this reference there |
//! | `reference none` | always: the motion alone is judged, as by `verify` without a reference |
//! | `FAIL 16 of 28, 12 missing, 16 extra, 28 folded` | the verdict, the number of good nominal holes or of flutes, and the counts other than 0 agree; folded findings are those on single holes that one on several holes replaces |
//! | `error row-group at O5:6 with 4.069 9.069` | the next finding: its severity, its code, its line, the calls that led there (`from O1:7`), its hole (`of r1h0`); its message or its notes have these numbers and names; the words behind `help` are in its help |
//! | `missing r3h0 r3h1` | these holes are missing, in the order of the reference |
//! | `hole r1h0 phi=0.70 depth=+1.000` | deviations of that hole: `phi`, `entry`, `bottom`, `tilt`, `depth`, `dx`, `dy`, `dz`; `hole *` is every one that was found |
//! | `neighbours six=7 inner=12 nearest=18.138` | the nominal number of inner holes, and the number of those that are drilled and have six neighbours; least and greatest distance (`farthest`) |
//! | `burr index=0.300 passes=5` | numbers of the flutes: `contact`, `helix_min`, `helix_max`, `index`, `speed_min`, `speed_max`, `nearest`, `passes`, `moves` |
//! | `made x=10.000 … depth=7.000 at O1:8 by T1` | without a reference: the next hole, by `x`, `y`, `z`, `i`, `j`, `k`, `depth`, `diameter` |
//! | `not-checked with Z 29` | a line on what isn't checked has these numbers and names |
//! | `checked milling` | no line on what isn't checked has this number or name |
//! | `assumes G55 at O1:7 decides 1 2` | the assumptions are these lines, in this order; `assumes nothing`: there is none |
//! | `layout` | the printed verdict is `verdict.snap` |
//!
//! The findings and the holes made are all there are, in this order. A number agrees to half a unit of its last decimal, one
//! without a point exactly.

/// Verdict of a run, in the form of the lines of `expect.txt`.
pub(crate) struct ActualVerdict {
    /// Verdict and counts; `None` without a reference.
    pub(crate) summary: Option<String>,
    pub(crate) findings: Vec<FindingLine>,
    pub(crate) missing: Vec<String>,
    pub(crate) not_checked: Vec<String>,
    /// Assumptions, in the form of the lines of `expect.txt`.
    pub(crate) assumptions: Vec<String>,
    /// Numbers by subject.
    pub(crate) facts: Vec<(String, Facts)>,
    /// Holes of a program without a reference: block and numbers.
    pub(crate) made: Vec<(String, Facts)>,
}

type Facts = Vec<(&'static str, f64)>;

/// A finding: severity, code and block as in a line of `expect.txt`, message and notes, and help.
pub(crate) struct FindingLine {
    pub(crate) head: String,
    pub(crate) text: String,
    pub(crate) help: String,
}

/// Returns true if `expect.txt` has the line `layout`.
pub(crate) fn has_layout(expected: &str) -> bool {
    expected.lines().any(|line| line == "layout")
}

impl ActualVerdict {
    /// Returns the differences from the lines of `expect.txt`, one line each.
    pub(crate) fn differences(&self, expected: &str) -> Vec<String> {
        let mut wrong = Vec::new();
        let (mut verdicts, mut findings, mut made) = (Vec::new(), Vec::new(), Vec::new());
        let mut assumptions = Vec::new();
        for line in expected.lines().filter(|line| !line.starts_with('#')) {
            let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
            match word {
                "machine" | "reference" | "start" | "layout" => {}
                "PASS" | "FAIL" => verdicts.push(line),
                "alarm" | "error" | "warning" | "note" => {
                    findings.push(line.split_once(" with ").unwrap_or((line, "")));
                }
                "missing" if rest.split_whitespace().eq(&self.missing) => {}
                "missing" => wrong.push(format!("missing {}", self.missing.join(" "))),
                "hole" | "neighbours" | "burr" => {
                    let (subject, facts) =
                        line.split_at(line.find('=').and_then(|at| line[..at].rfind(' ')).unwrap());
                    self.compare_facts(subject, facts, &mut wrong);
                }
                "made" => made.push(rest),
                "assumes" => assumptions.push(rest),
                "checked" => {
                    let about = self.not_checked.iter().filter(|line| mentions(line, rest));
                    wrong.extend(about.map(|line| format!("not checked: {line}")));
                }
                "not-checked" => {
                    let words = rest.strip_prefix("with ").unwrap();
                    let is_met = |line: &String| words.split_whitespace().all(|word| mentions(line, word));
                    if !self.not_checked.iter().any(is_met) {
                        wrong.push(format!("nothing is listed as not checked with {words}"));
                    }
                }
                _ => panic!("no line of expect.txt: {line}"),
            }
        }
        if verdicts != Vec::from_iter(self.summary.as_deref()) {
            let found = self.summary.as_deref().unwrap_or("no verdict");
            wrong.push(format!("{found}; expected is {}", verdicts.join(" and ")));
        }
        self.compare_findings(&findings, &mut wrong);
        self.compare_made(&made, &mut wrong);
        let found =
            if self.assumptions.is_empty() { "nothing".to_owned() } else { self.assumptions.join("\n  ") };
        if !assumptions.is_empty() && found != assumptions.join("\n  ") {
            wrong.push(format!("assumed is\n  {found}\nexpected is\n  {}", assumptions.join("\n  ")));
        }
        wrong
    }

    /// Compares the facts of a subject; `hole *` is every hole.
    fn compare_facts(&self, subject: &str, facts: &str, wrong: &mut Vec<String>) {
        let is_meant = |found: &&(String, Facts)| {
            subject == "hole *" && found.0.starts_with("hole ") || found.0 == subject
        };
        let mut found = self.facts.iter().filter(is_meant).peekable();
        if found.peek().is_none() {
            wrong.push(format!("there is no {subject}"));
        }
        found.for_each(|(name, numbers)| compare(name, facts, numbers, wrong));
    }

    fn compare_findings(&self, expected: &[(&str, &str)], wrong: &mut Vec<String>) {
        let [found, heads]: [Vec<&str>; 2] = [
            self.findings.iter().map(|finding| finding.head.as_str()).collect(),
            expected.iter().map(|(head, _)| *head).collect(),
        ];
        if found != heads {
            let [found, heads] = [found, heads].map(|all| match all.is_empty() {
                true => "nothing".to_owned(),
                false => all.join("\n  "),
            });
            wrong.push(format!("found is\n  {found}\nexpected is\n  {heads}"));
            return;
        }
        for ((head, words), finding) in expected.iter().zip(&self.findings) {
            let (words, help) = words.split_once(" help ").unwrap_or((words, ""));
            for (words, text) in [(words, &finding.text), (help, &finding.help)] {
                for word in words.split_whitespace().filter(|word| !mentions(text, word)) {
                    wrong.push(format!("{head} doesn't have {word}: {}", text.trim()));
                }
            }
        }
    }

    fn compare_made(&self, expected: &[&str], wrong: &mut Vec<String>) {
        if expected.len() != self.made.len() {
            wrong.push(format!("{} holes are made; expected are {}", self.made.len(), expected.len()));
        }
        for (expected, (place, numbers)) in expected.iter().zip(&self.made) {
            let (facts, at) = expected.split_once(" at ").unwrap();
            if at != place {
                wrong.push(format!("the hole at {at} is made at {place}"));
            }
            compare(&format!("the hole at {at}"), facts, numbers, wrong);
        }
    }
}

/// Compares numbers with `facts` of the form `key=number`.
fn compare(subject: &str, facts: &str, found: &[(&'static str, f64)], wrong: &mut Vec<String>) {
    for fact in facts.split_whitespace() {
        let (key, number) = fact.split_once('=').unwrap();
        match found.iter().find(|(name, _)| *name == key) {
            Some((_, value)) if agrees(*value, number) => {}
            Some((_, value)) => wrong.push(format!("{subject}: {key} is {value}, expected is {number}")),
            None => wrong.push(format!("{subject} has no {key}")),
        }
    }
}

/// Returns true if a value is the stated number, to half a unit of its last decimal.
fn agrees(value: f64, stated: &str) -> bool {
    let number: f64 = stated.parse().unwrap_or_else(|_| panic!("{stated} is no number"));
    let decimals = stated.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let half = if decimals == 0 { 0.0 } else { 0.5 / gcode_lang::units::POWERS[decimals] };
    (value - number).abs() <= half + 1e-9
}

/// Returns true if a text has a number, or a name such as `T1`.
fn mentions(text: &str, stated: &str) -> bool {
    if stated.parse::<f64>().is_ok() {
        return numbers(text).iter().any(|number| agrees(*number, stated));
    }
    text.split(|c: char| !(c.is_alphanumeric() || ".-#".contains(c)))
        .any(|word| word.trim_end_matches('.') == stated)
}

/// Returns the numbers in a text, each with the sign directly before it.
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
