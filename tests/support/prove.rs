//! Cases of kind `prove`: programs, the ranges of their variables, and the verdict that was worked out for each claim.
//!
//! `cases.txt` has, after a sentence on what it is about, cases of the form
//!
//! ```text
//! == a root without a guard
//! #100=SQRT[#1]
//! M30
//! -- range #1=-5..5 #2=0..1; where #2 LE #1; call G65 P2 A#1
//! -- refuted: no-alarm
//! -- proved: alarm PS0119
//! -- bounds #100: 0 2.236
//! ```
//!
//! Lines that begin with `# ` are remarks. A program that doesn't begin with O is O0001. `where`, `call`, `max-blocks N`,
//! `control KEY=VALUE` and `widen PART` may be left out. `bounds` has the least and the largest value that a run gives: the bounds must hold both, and be wider by 5 % at most. The counterexample of a refuted claim must lie in the
//! ranges, and the control must refute the claim when it runs that point alone.
use std::time::{Duration, Instant};

use gcode_control::Control;
use gcode_inspect::machine::Machine;
use gcode_lang::program::NoLibrary;
use gcode_prove::{Ask, ClaimVerdict, ProofAnswer, Setup, Watch, prove};
use gcode_session::{Request, set_up};

use crate::Case;

/// Time that a case may take; each is decided far sooner.
const LIMIT: Duration = Duration::from_secs(60);

/// Time for a case with a claim that isn't decided.
const SHORT: Duration = Duration::from_secs(3);

/// Controls of a case.
struct Controls {
    request: Request,
    call: Option<String>,
}

impl Setup for Controls {
    type Library = NoLibrary;

    fn control(&self, settings: &[(String, String)]) -> Result<Control, String> {
        let request = self.request.with_settings(settings).map_err(|error| error.to_string())?;
        set_up(&request, self.call.as_deref()).map_err(|error| error.to_string())
    }

    fn library(&self) -> NoLibrary {
        NoLibrary
    }
}

/// Rows of a case.
#[derive(Default)]
struct Rows<'t> {
    ask: Ask,
    call: Option<String>,
    /// Setting of the control with its value.
    setting: Option<(&'t str, &'t str)>,
    verdicts: Vec<&'t str>,
    bounds: Vec<(f64, f64)>,
}

impl<'t> Rows<'t> {
    fn of(lines: impl Iterator<Item = &'t str>) -> Self {
        let mut rows = Self::default();
        for line in lines {
            match line.split_once(' ').unwrap() {
                ("range", rest) => rows.conditions(rest),
                ("bounds", rest) => {
                    let (variable, range) = rest.split_once(": ").unwrap();
                    let (low, high) = range.split_once(' ').unwrap();
                    rows.ask.bounds.push(variable.to_owned());
                    rows.bounds.push((low.parse().unwrap(), high.parse().unwrap()));
                }
                (verdict @ ("proved:" | "refuted:" | "undecided:"), claim) => {
                    rows.ask.claims.push(claim.to_owned());
                    rows.verdicts.push(verdict.trim_end_matches(':'));
                }
                _ => panic!("{line}: no row of a case"),
            }
        }
        rows
    }

    fn conditions(&mut self, text: &'t str) {
        let mut parts = text.split("; ");
        self.ask.ranges = parts.next().unwrap().split(' ').map(str::to_owned).collect();
        for part in parts {
            match part.split_once(' ').unwrap() {
                ("where", condition) => self.ask.conditions.push(condition.to_owned()),
                ("call", call) => self.call = Some(call.to_owned()),
                ("max-blocks", blocks) => self.ask.max_blocks = blocks.parse().unwrap(),
                ("control", setting) => self.setting = setting.split_once('='),
                ("widen", widening) => self.ask.widening = widening.parse().unwrap(),
                _ => panic!("{part}: neither where, call, max-blocks, control nor widen"),
            }
        }
    }

    /// Returns what differs from an answer.
    fn differences(&self, answer: &ProofAnswer, controls: &Controls) -> Vec<String> {
        assert_eq!(answer.claims.len(), self.verdicts.len(), "each claim has an answer");
        assert_eq!(answer.bounds.len(), self.bounds.len(), "each bounds row has an answer");
        let mut wrong = Vec::new();
        for (claim, expected) in answer.claims.iter().zip(&self.verdicts) {
            let verdict = match claim.verdict {
                ClaimVerdict::Proved => "proved",
                ClaimVerdict::Refuted => "refuted",
                ClaimVerdict::Undecided => "undecided",
            };
            if verdict != *expected {
                let (point, share) = (&claim.counterexample, answer.undecided_share);
                wrong.push(format!(
                    "{} is {verdict}: {point:?}, share {share:e}, {:?}",
                    claim.claim, answer.unfollowed
                ));
            }
            match &claim.counterexample {
                Some(point) if !self.is_refuted(&claim.claim, point, controls) => {
                    wrong.push(format!("{}: the control doesn't refute it at {point:?}", claim.claim));
                }
                None if claim.verdict == ClaimVerdict::Refuted => {
                    wrong.push(format!("{} has no counterexample", claim.claim));
                }
                _ => {}
            }
        }
        for (bounds, (low, high)) in answer.bounds.iter().zip(&self.bounds) {
            let found = bounds.range.unwrap_or((f64::NAN, f64::NAN));
            // The value worked out has ten digits.
            let slack = (high - low) * 1e-8;
            let encloses = found.0 <= low + slack && found.1 >= high - slack;
            // Bounds that are missing enclose nothing.
            if !encloses || found.1 - found.0 > 1.05 * (high - low) {
                wrong.push(format!("#{} from {found:?}, expected {low} to {high}", bounds.variable));
            }
        }
        wrong
    }

    /// Returns true if the control refutes a claim at a point, alone.
    fn is_refuted(&self, claim: &str, point: &[(u32, f64)], controls: &Controls) -> bool {
        let ranges = point.iter().map(|(variable, value)| format!("#{variable}={value}..{value}"));
        let ask = Ask {
            ranges: ranges.collect(),
            claims: vec![claim.to_owned()],
            bounds: Vec::new(),
            ..self.ask.clone()
        };
        let is_within = |(range, (variable, value)): (&String, &(u32, f64))| {
            let (name, range) = range.split_once('=').unwrap();
            let (low, high) = range.split_once("..").unwrap();
            *name == format!("#{variable}")
                && (low.parse::<f64>().unwrap()..=high.parse::<f64>().unwrap()).contains(value)
        };
        let is_inside =
            self.ask.ranges.len() == point.len() && self.ask.ranges.iter().zip(point).all(is_within);
        let answer = prove(controls, &ask, &Watch::new(&|| Duration::ZERO, LIMIT)).unwrap();
        is_inside && answer.verdict == ClaimVerdict::Refuted
    }
}

pub(crate) fn run(case: &Case) {
    let text = case.text("cases.txt");
    let (mut wrong, mut count) = (String::new(), 0);
    for entry in text.split("\n== ").skip(1) {
        let (name, rest) = entry.split_once('\n').unwrap();
        let rows = Rows::of(rest.lines().filter_map(|line| line.strip_prefix("-- ")));
        let blocks = rest
            .lines()
            .filter(|line| !line.is_empty() && !line.starts_with("-- ") && !line.starts_with("# "));
        let blocks: Vec<_> = blocks.collect();
        let head = if blocks[0].starts_with('O') { "" } else { "O0001\n" };
        let program = format!("{head}{}\n", blocks.join("\n"));
        let mut request = Request::new("case.nc", program.into_bytes(), Machine::default());
        if let Some((key, value)) = rows.setting {
            request.settings.set(key, value).unwrap();
        }
        let controls = Controls { request, call: rows.call.clone() };
        let start = Instant::now();
        let clock = || start.elapsed();
        count += 1;
        // What can't be decided takes all the time.
        let limit = if rows.verdicts.contains(&"undecided") { SHORT } else { LIMIT };
        match prove(&controls, &rows.ask, &Watch::new(&clock, limit)) {
            Ok(answer) => {
                for difference in rows.differences(&answer, &controls) {
                    wrong.push_str(&format!("{name}: {difference}\n"));
                }
            }
            Err(error) => wrong.push_str(&format!("{name}: {error}\n")),
        }
    }
    assert!(count > 0, "{}: no cases", case.name());
    assert!(wrong.is_empty(), "{}:\n{wrong}", case.name());
}
