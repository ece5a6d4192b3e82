//! Proofs of other families: the job's programs run with all values of some arguments of their macros at once.
//!
//! No reference is compared: what is proved is that no alarm but those of the macros' remarks stops a run.
use std::collections::BTreeSet;

use gcode_inspect::machine::Machine;
use gcode_prove::{Ask, ClaimVerdict, Watch, prove};
use gcode_session::Request;

use super::ProofRequest;
use super::controls::Controls;
use super::quantity_range::{check_order, parse_limits};
use super::report::{CaseReport, ClaimReport, JobProof, ranges_of};
use super::statements::Statements;
use crate::package::{Program, stem};

/// An argument of a macro with its limits: `O8301.A=1..10`.
#[derive(Clone, Debug, PartialEq)]
struct ArgumentRange {
    program: u32,
    letter: char,
    low: f64,
    high: f64,
}

impl ArgumentRange {
    fn parse(text: &str) -> Result<Self, String> {
        let unreadable =
            || format!("--over {text}: write a macro, its argument and the limits, 'O8301.A=1..10'");
        let parsed = text.split_once('=').and_then(|(name, limits)| {
            let (program, letter) = name.trim().strip_prefix('O')?.split_once('.')?;
            let [low, high] = parse_limits(limits)?;
            let mut letters = letter.chars();
            let letter = letters.next().filter(|letter| letter.is_ascii_uppercase() && *letter != 'P')?;
            let range = Self { program: program.parse().ok()?, letter, low, high };
            letters.next().is_none().then_some(range)
        });
        let range = parsed.ok_or_else(unreadable)?;
        check_order(text, [range.low, range.high])?;
        Ok(range)
    }

    fn key(&self) -> String {
        format!("{}.{}", stem(self.program), self.letter)
    }
}

/// Proves that no alarm but those of the remarks stops the job's programs.
///
/// # Errors
/// The reason why the request can't be used.
pub(super) fn prove_arguments(request: &ProofRequest<'_>) -> Result<JobProof, String> {
    let overs = request.over.iter().map(|text| ArgumentRange::parse(text)).collect::<Result<Vec<_>, _>>()?;
    if overs.is_empty() {
        return Err(
            "nothing is left open: give --over, a macro's argument such as 'O8301.A=1..10'".to_owned()
        );
    }
    if let Some(twice) =
        overs.iter().enumerate().find(|(index, over)| overs[..*index].iter().any(|o| o.key() == over.key()))
    {
        return Err(format!("--over {}: this argument already has a range: keep one of them", twice.1.key()));
    }
    let package = request.package;
    let mains: Vec<&Program> = package.mains.iter().filter_map(|number| package.program(*number)).collect();
    let mut cases = Vec::new();
    let mut is_used = vec![false; overs.len()];
    for main in mains {
        let free = free_locals(&main.text);
        let variables: Vec<u32> = overs.iter().zip(free).map(|(_, variable)| variable).collect();
        if variables.len() < overs.len() {
            return Err(format!(
                "{}: more arguments than free local variables: give fewer --over",
                stem(main.number)
            ));
        }
        let (text, used) = opened(&main.text, &overs, &variables);
        if used.contains(&true) {
            is_used.iter_mut().zip(&used).for_each(|(all, here)| *all |= here);
            let ranges = overs.iter().zip(&variables).zip(used).filter(|(_, used)| *used);
            let ranges: Vec<_> = ranges.map(|(range, _)| range).collect();
            cases.push(prove_main(request, main, text, &ranges)?);
        }
    }
    if let Some((unused, _)) = overs.iter().zip(is_used).find(|(_, is_used)| !is_used) {
        return Err(format!("--over {}: no call of the job's programs has this argument", unused.key()));
    }
    let ranges = overs.iter().map(|over| (over.key(), [over.low, over.high])).collect();
    let not_proved = vec![
        "where the tool goes: prove knows the geometry of pin holes alone; emit and verify compare this job's with the part".to_owned(),
    ];
    Ok(JobProof::new(ranges, cases, not_proved, (request.clock)().as_secs_f64()))
}

/// Proves a main program whose calls have variables.
fn prove_main(
    request: &ProofRequest<'_>,
    main: &Program,
    text: String,
    ranges: &[(&ArgumentRange, &u32)],
) -> Result<CaseReport, String> {
    let package = request.package;
    let machine = Machine::parse(&package.machine).map_err(|error| error.to_string())?;
    let calls: Vec<_> = text.lines().filter(|line| called(line).is_some() && line.contains('#')).collect();
    let calls = calls.join("\n");
    let run = Request::new(format!("{}.nc", stem(main.number)), text.into_bytes(), machine);
    let controls = Controls { request: run, call: None, programs: package };
    let alarms = Statements::of(package).alarms;
    let ask = Ask {
        ranges: ranges
            .iter()
            .map(|(range, variable)| format!("#{variable}={}..{}", range.low, range.high))
            .collect(),
        // The second claim asks whether any run ends: without one the first says nothing.
        claims: vec![format!("alarm {}", alarms.join("|")), "1 EQ 1".to_owned()],
        threads: request.threads,
        ..Ask::default()
    };
    let watch = Watch::new(request.clock, request.limit);
    let answer = prove(&controls, &ask, &watch).map_err(|error| error.to_string())?;
    let claim = &answer.claims[0];
    let mut reasons = answer.unfollowed.clone();
    let mut verdict = claim.verdict;
    if verdict == ClaimVerdict::Proved && answer.never_ends {
        verdict = ClaimVerdict::Undecided;
        reasons
            .push("every run is stopped by an alarm, so that the rest of the macro isn't reached".to_owned());
    }
    let is_open = verdict == ClaimVerdict::Undecided;
    let key_of = |variable: u32| {
        let found = ranges.iter().find(|(_, own)| **own == variable);
        found.map_or_else(|| format!("#{variable}"), |(range, _)| range.key())
    };
    let report = ClaimReport {
        claim: format!("no alarms but those of the remarks, {}", ranges_of(&alarms)),
        verdict,
        proved_share: match (verdict, answer.never_ends) {
            (ClaimVerdict::Proved, _) => 1.0,
            (_, true) => 0.0,
            _ => 1.0 - answer.undecided_share,
        },
        counterexample: claim
            .counterexample
            .as_ref()
            .map(|values| values.iter().map(|(variable, value)| (key_of(*variable), *value)).collect()),
        reasons: if is_open { reasons } else { Vec::new() },
        ..ClaimReport::default()
    };
    Ok(CaseReport::new(format!("the program {}", stem(main.number)), calls, vec![report]))
}

/// Returns the number of the macro that a line calls.
fn called(line: &str) -> Option<u32> {
    let code = line.split('(').next()?;
    let (_, rest) = code.split_once("G65 P")?;
    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

/// Returns a program whose calls have variables for arguments, and which arguments are found.
fn opened(text: &str, overs: &[ArgumentRange], variables: &[u32]) -> (String, Vec<bool>) {
    let mut used = vec![false; overs.len()];
    let mut line_of = |line: &str| {
        let Some(number) = called(line) else { return line.to_owned() };
        let (code, remark) = line.split_at(line.find('(').unwrap_or(line.len()));
        let words = code.split(' ').map(|word| {
            let found = overs.iter().position(|over| over.program == number && word.starts_with(over.letter));
            match found {
                Some(place) => {
                    used[place] = true;
                    format!("{}#{}", overs[place].letter, variables[place])
                }
                None => word.to_owned(),
            }
        });
        words.collect::<Vec<_>>().join(" ") + remark
    };
    let lines: Vec<_> = text.lines().map(&mut line_of).collect();
    (lines.join("\n") + "\n", used)
}

/// Iterates over local variables that a program doesn't name, the highest first.
fn free_locals(text: &str) -> impl Iterator<Item = u32> {
    let number =
        |rest: &str| rest.split(|c: char| !c.is_ascii_digit()).next().and_then(|digits| digits.parse().ok());
    let named: BTreeSet<u32> = text.split('#').skip(1).filter_map(number).collect();
    (1..=33).rev().filter(move |variable| !named.contains(variable))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_names_a_macro_and_its_argument() {
        let range = ArgumentRange::parse("O8301.A=1..10").unwrap();
        assert_eq!(range, ArgumentRange { program: 8301, letter: 'A', low: 1.0, high: 10.0 });
        assert_eq!(range.key(), "O8301.A");
        for text in ["A=1..10", "O8301.=1..2", "O8301.AB=1..2", "O8301.P=1..2", "O8301.A=1", "O8301.A=2..1"] {
            assert!(ArgumentRange::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn calls_have_variables_for_what_is_left_open() {
        let text = "O1\n#33=1\nN10 G65 P8301 D500. A5. Z12. (A HOLE)\nG65 P8302 A5.\nX1.\n";
        let overs =
            [ArgumentRange::parse("O8301.A=1..2").unwrap(), ArgumentRange::parse("O8301.Q=1..2").unwrap()];
        let variables: Vec<u32> = free_locals(text).take(2).collect();
        assert_eq!(variables, [32, 31]);
        let (opened, used) = opened(text, &overs, &variables);
        assert_eq!(opened, "O1\n#33=1\nN10 G65 P8301 D500. A#32 Z12. (A HOLE)\nG65 P8302 A5.\nX1.\n");
        assert_eq!(used, [true, false]);
    }
}
