//! The result of `prove`, as text and as data.
use std::collections::BTreeMap;
use std::fmt::Write;

use gcode_prove::ClaimVerdict;
use schemars::JsonSchema;
use serde::Serialize;

use super::quantity_range::QuantityRange;

/// Values of quantities.
pub(super) type Point = BTreeMap<String, f64>;

/// Ranges of quantities.
pub(super) type RangeReport = BTreeMap<String, [f64; 2]>;

/// Verdicts on the claims of a job's macro for all values of the quantities left open.
#[derive(Debug, Serialize, JsonSchema)]
pub struct JobProof {
    /// `proved`, `refuted` or `undecided`: the worst of the claims'.
    pub verdict: ClaimVerdict,
    /// Ranges of the quantities left open.
    pub over: BTreeMap<String, [f64; 2]>,
    /// One case for each direction and tool of the job's holes.
    pub cases: Vec<CaseReport>,
    /// What this family's proofs leave out; empty if its geometry is proved.
    pub not_proved: Vec<String>,
    /// Duration, seconds.
    pub seconds: f64,
}

/// Claims of one call of the macro.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CaseReport {
    /// Direction of the holes and the tool.
    pub holes: String,
    /// The call with variables for the job's quantities.
    pub call: String,
    /// The claims.
    pub claims: Vec<ClaimReport>,
}

/// Verdict on one claim.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct ClaimReport {
    /// The claim.
    pub claim: String,
    /// Its verdict.
    pub verdict: ClaimVerdict,
    /// Share of the values for which it is proved.
    pub proved_share: f64,
    /// The bound that is proved, mm; null for a claim without one.
    pub bound: Option<f64>,
    /// Where the bound is largest, or the largest part of the values that is left undecided.
    pub worst: Option<RangeReport>,
    /// Values at which the claim fails.
    pub counterexample: Option<Point>,
    /// The largest position deviation of the single holes that were verified, and its values.
    pub found: Option<(f64, Point)>,
    /// What isn't followed.
    pub reasons: Vec<String>,
}

impl JobProof {
    pub(super) fn new(
        over: RangeReport,
        cases: Vec<CaseReport>,
        not_proved: Vec<String>,
        seconds: f64,
    ) -> Self {
        let verdicts = cases.iter().flat_map(|case| case.claims.iter().map(|claim| claim.verdict));
        Self { verdict: verdicts.max().unwrap_or_default(), over, cases, not_proved, seconds }
    }

    /// Formats the result for a terminal.
    pub(crate) fn text(&self) -> String {
        let ranges = self.over.iter().map(|(key, [low, high])| format!("{key} {low}..{high}"));
        let mut text = format!("for all {}\n", ranges.collect::<Vec<_>>().join(", "));
        for case in &self.cases {
            let _ = writeln!(text, "\n{}\n{}", case.holes, case.call);
            case.claims.iter().for_each(|claim| claim.write(&mut text));
        }
        for what in &self.not_proved {
            let _ = writeln!(text, "\nnot proved: {what}");
        }
        let _ = writeln!(text, "\n{:.1} s; proved of the simulated control: see docs/prove.md", self.seconds);
        text
    }
}

impl CaseReport {
    pub(super) fn new(holes: String, call: String, claims: Vec<ClaimReport>) -> Self {
        Self { holes, call, claims }
    }
}

impl ClaimReport {
    fn write(&self, text: &mut String) {
        let verdict = match self.verdict {
            ClaimVerdict::Proved => "proved   ",
            ClaimVerdict::Undecided => "undecided",
            ClaimVerdict::Refuted => "REFUTED  ",
        };
        let _ = write!(text, "  {verdict}  {}", self.claim);
        if self.verdict == ClaimVerdict::Undecided {
            let _ = write!(text, ": proved for {}", percent(self.proved_share));
        }
        text.push('\n');
        let ranges = self.worst.iter().map(|worst| {
            let ranges = worst.iter().map(|(key, [low, high])| format!("{key} {low}..{high}"));
            ranges.collect::<Vec<_>>().join(", ")
        });
        for ranges in ranges {
            let word = if self.verdict == ClaimVerdict::Undecided { "left" } else { "worst" };
            let _ = writeln!(text, "             {word}: {ranges}");
        }
        if let Some((phi, point)) = &self.found {
            let what = if phi.is_finite() { format!("Φ{phi:.5}") } else { "no hole there".to_owned() };
            let _ = writeln!(text, "             verified: {what} at {}", words(point));
        } else if let Some(point) = &self.counterexample {
            let _ = writeln!(text, "             at {}", words(point));
        }
        for reason in &self.reasons {
            let _ = writeln!(text, "             not followed: {reason}");
        }
    }
}

fn words(point: &Point) -> String {
    point.iter().map(|(key, value)| format!("{key} {value}")).collect::<Vec<_>>().join(", ")
}

/// Returns `hole.radius 3, surface.a 500`.
pub(super) fn named(overs: &[QuantityRange], values: &[f64]) -> String {
    let all = overs.iter().zip(values).map(|(over, value)| format!("{} {value}", over.quantity.key()));
    all.collect::<Vec<_>>().join(", ")
}

/// Returns `MC3001–MC3015, MC3017`.
pub(super) fn ranges_of(codes: &[String]) -> String {
    let numbers: Vec<u32> = codes.iter().filter_map(|code| code[2..].parse().ok()).collect();
    let runs = numbers.chunk_by(|one, next| next - one == 1);
    let runs = runs.filter_map(|run| match run {
        [one] => Some(format!("{one}")),
        [first, .., last] => Some(format!("{first}–{last}")),
        [] => None,
    });
    runs.collect::<Vec<_>>().join(", ")
}

/// Returns a share in percent, never rounded up to all.
fn percent(share: f64) -> String {
    let percent = (share * 1e5).floor() / 1e3;
    format!("{percent} % of the values")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_never_rounded_up() {
        assert_eq!(percent(0.999_999_9), "99.999 % of the values");
        assert_eq!(percent(0.25), "25 % of the values");
    }

    #[test]
    fn the_worst_claim_decides() {
        let claim = |verdict: ClaimVerdict| ClaimReport { verdict, ..ClaimReport::default() };
        let case = |verdicts: &[ClaimVerdict]| {
            let claims = verdicts.iter().map(|verdict| claim(*verdict)).collect();
            JobProof::new(
                RangeReport::new(),
                vec![CaseReport::new(String::new(), String::new(), claims)],
                Vec::new(),
                0.0,
            )
            .verdict
        };
        assert_eq!(case(&[ClaimVerdict::Proved, ClaimVerdict::Proved]), ClaimVerdict::Proved);
        assert_eq!(case(&[ClaimVerdict::Proved, ClaimVerdict::Undecided]), ClaimVerdict::Undecided);
        assert_eq!(
            case(&[ClaimVerdict::Undecided, ClaimVerdict::Refuted, ClaimVerdict::Proved]),
            ClaimVerdict::Refuted
        );
    }

    #[test]
    fn neighbouring_alarms_are_one_range() {
        let codes = ["MC3001", "MC3002", "MC3003", "MC3017"].map(str::to_owned);
        assert_eq!(ranges_of(&codes), "3001–3003, 3017");
    }
}
